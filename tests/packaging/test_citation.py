"""CITATION.cff names this version and the paper as it was printed."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path

from meso_robust import __version__

ROOT = Path(__file__).parents[2]


def test_the_version_is_the_same_everywhere() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    cited = (ROOT / "CITATION.cff").read_text(encoding="utf-8")

    assert project["version"] == __version__
    assert re.search(r"(?m)^version: (.+)$", cited)[1] == __version__  # type: ignore[index]
    assert f"## {__version__}" in (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")


def test_the_paper_is_named_as_printed() -> None:
    cited = (ROOT / "CITATION.cff").read_text(encoding="utf-8")
    for told in (
        "Automated Assembly for Mesoscale Parts",
        "IEEE Transactions on Automation Science and Engineering",
        "volume: 8",
        "issue: 3",
        "year: 2011",
        "start: 598",
        "end: 613",
    ):
        assert told in cited
    names = re.findall(r"family-names: (\w+)", cited)
    assert names == ["Cappelleri", "Cheng", "Fink", "Gavrea", "Kumar"]
