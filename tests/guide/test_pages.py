"""What the guide names exists, and what is made from the code is what the code says."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path
from typing import Any

import pytest
import typer

import meso_robust
from meso_robust.certificates.premise import Premise
from meso_robust.certificates.words import PREMISES, words
from meso_robust.cli import app
from meso_robust.cli.schema import documents
from meso_robust.guide import GUIDE
from meso_robust.planning.compose import Found
from meso_robust.primitives.names import Reason, about
from meso_robust.reporting.words import QUANTITIES
from meso_robust.tasks import HEXAGON, SLOT, TWO_PROBES
from reports.guide.pages import FORMATS, GLOSSARY, OTHERS, formats, with_symbols
from tests.strategies import paper_chain
from tests.test_task_real import GIVEN

ROOT = Path(meso_robust.__file__).parent.parent
PAGES = sorted(GUIDE.glob("*.md"))
NAMES = [page.name for page in PAGES]
KINDS = ("*.md", "*.py", "*.j2")
_TO_MAKE = {"<name>", "two_drags", "/area.py"}
"""What stands for a file that a reader is to write."""
ADDED = "area"
"""The verb that a reader of `extending.md` adds."""


def text(name: str) -> str:
    return (GUIDE / name).read_text(encoding="utf-8")


def anchors(page: str) -> set[str]:
    """Anchors of a page's headings."""
    heads = re.findall(r"^#+ (.+)$", page, re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", head.lower()).replace(" ", "-") for head in heads}


def test_the_guide_is_whole() -> None:
    whole = [
        "architecture", "campaigns", "certificate", "extending", "formats", "glossary", "live", "paper",
        "recordings", "simulator", "tutorial", "your_task",
    ]  # fmt: skip

    assert [page.stem for page in PAGES] == whole


def test_formats_are_those_of_the_code() -> None:
    assert FORMATS.read_text(encoding="utf-8") == formats()


def test_formats_have_every_document_and_every_key() -> None:
    page = text("formats.md")
    for name, model in documents().items():
        section = re.split(r"(?m)^## ", page.split(f"\n## {name}\n")[1])[0]
        for key in model.model_json_schema(by_alias=True)["properties"]:
            assert f"| `{key}` |" in section, f"{name}.{key}"
    assert "Sum" not in page
    assert "The pose as sensed before the first move." in page  # a meaning, from the class


def test_every_key_of_every_document_has_a_meaning() -> None:
    rows = re.findall(r"^\| `[^`]+` \|.*$", text("formats.md"), re.MULTILINE)

    assert len(rows) > 500
    for row in rows:
        assert re.split(r"(?<!\\)\|", row)[-2].strip(), row
    for name, model in OTHERS.items():
        section = re.split(r"(?m)^## ", text("formats.md").split(f"\n## {name}\n")[1])[0]
        for key, field in model.model_fields.items():
            assert f"| `{field.serialization_alias or key}` |" in section, f"{name}.{key}"


def test_symbols_are_those_of_the_reports() -> None:
    page = GLOSSARY.read_text(encoding="utf-8")

    assert page == with_symbols(page)
    for name, quantity in QUANTITIES.items():
        assert f"| `{name}` | {quantity.meaning} |" in page


@pytest.mark.parametrize("name", NAMES)
def test_links_lead_somewhere(name: str) -> None:
    for link in re.findall(r"\]\(([^)\s]+)\)", text(name)):
        file, _, anchor = link.partition("#")
        target = GUIDE / file if file else GUIDE / name
        assert target.exists(), link
        assert not anchor or anchor in anchors(target.read_text(encoding="utf-8")), link


@pytest.mark.parametrize("name", NAMES)
def test_files_that_are_named_exist(name: str) -> None:
    named = re.findall(r"`((?:meso_robust|derivations|tests)/[\w./<>-]+)`", text(name))
    for file in named:
        if not any(one in file for one in _TO_MAKE):
            assert (ROOT / file).exists(), file


def test_commands_have_the_options_that_are_named() -> None:
    """In the README, the guide, messages, and what the pages tell the reader to type."""
    group: Any = typer.main.get_command(app)
    folders = (ROOT / "meso_robust", ROOT / "derivations", ROOT / "reports")
    files = [*ROOT.glob("*.md")]
    files += [file for folder in folders for kind in KINDS for file in folder.rglob(kind)]
    named = 0
    for file in files:
        text = file.read_text(encoding="utf-8")
        for verb, rest in re.findall(r"(?<!\.)meso-robust ([a-z]+)\b([^`\"<\n|]*)", text):
            if verb == ADDED:
                continue
            assert verb in group.list_commands(None), f"{file}: meso-robust {verb}{rest}"
            options = set(re.findall(r"(?<![\w-])--[a-z][\w-]*", rest))
            command = group.get_command(None, verb)
            known = {each for option in command.params for each in option.opts}
            assert options <= known | {"--help"}, f"{file}: meso-robust {verb}{rest}"
            named += len(options)
    assert named > 50


def test_keys_of_a_task_that_are_explained_are_all_its_keys() -> None:
    """Together these tasks have every key that there is."""
    values: dict[str, dict[str, object]] = {}
    for task in (SLOT, TWO_PROBES, HEXAGON):
        for section, of in tomllib.loads(task.read_text(encoding="utf-8")).items():
            values.setdefault(section, {}).update(of if isinstance(of, dict) else {})
    for key, value in GIVEN.items():
        section, _, name = key.partition(".")
        values.setdefault(section, {})[name] = value
    explained = set(re.findall(r"`(\w+\.[\w…]+)`", text("your_task.md")))
    for section, keys in values.items():
        wanted = {f"{section}.{key}" for key in keys}
        assert wanted <= explained or f"{section}.…" in explained, section
    table = text("your_task.md").split("## Measuring")[0]
    for key in re.findall(r"^\| `(\w+)\.(\w+)`", table, re.MULTILINE):
        assert key[1] in values[key[0]], key


def test_what_a_verdict_is_said_to_tell_is_told_by_the_code() -> None:
    claims = {words(one.name) for step in paper_chain().steps for one in step.obligations}
    found = [
        Found(rules=(), scale=0.21, only="friction", range="0.26 … 0.29"),
        Found(rules=(), scale=0.1),
    ]
    settled = " or ".join(words(one.settled_by) for one in found)
    goal = words(about(Reason.ENDS_IN_GOAL))
    told = re.findall(r"^\| \*([^*]+)\*", text("your_task.md"), re.MULTILINE)
    assert len(told) >= 6
    for quoted in told:
        settles = quoted.removesuffix("s") in settled
        assert settles or quoted in {*claims, goal}, quoted


def test_the_certificate_page_shows_the_friction_of_the_tutorials_last_plan() -> None:
    edit = re.findall(r"^sed .*/friction = \[(.+), (.+)\]/'", text("tutorial.md"), re.MULTILINE)
    (stated,) = [[float(end) for end in one] for one in edit]
    page = text("certificate.md")
    shown = re.findall(r'"uncertainties": \{"friction": \["(\S+)", "(\S+)"\]', page)

    assert [[float.fromhex(end) for end in one] for one in shown] == [
        pytest.approx(stated, abs=1e-15)
    ]
    assert re.findall(r"mu in (\[.+?\])", page) == [str(stated)]


def test_premises_that_the_certificate_page_tells_are_all() -> None:
    told = re.findall(r"^\| `(\w+)` \| (.+) \|$", text("certificate.md"), re.MULTILINE)
    assert {id_: said for id_, said in told if id_ in list(Premise)} == PREMISES
