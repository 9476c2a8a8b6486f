"""What is said of a part and a film that are not those of an even film, and by how much."""

from __future__ import annotations

import json
import math
from fractions import Fraction
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner

from meso_robust.cli import app
from meso_robust.even_film import even_film, remarks
from meso_robust.task import Task
from meso_robust.tasks import PAPER

PLAN = Path(__file__).parents[1] / "reports/paper_task/plan.json"
HEXAGON = PAPER.with_name("hexagon.toml")
L = [(0, 0), (6, 0), (6, 2), (2, 2), (2, 5), (0, 5)]  # 6 x 2 and, above it, 2 x 3


def exact(corners: Any) -> list[tuple[Fraction, Fraction]]:
    return [(Fraction(x), Fraction(y)) for x, y in corners]


def changed(file: Path, section: str, **values: Any) -> Task:
    stated = Task.load(file).to_dict()
    stated[section] |= values
    return Task.from_dict(stated)


def test_an_l_is_the_sum_of_its_rectangles() -> None:
    pieces = [((3.0, 1.0), 6.0, 2.0), ((1.0, 3.5), 2.0, 3.0)]  # centre, sides
    area = sum(w * h for _, w, h in pieces)
    x, y = (sum(w * h * c[k] for c, w, h in pieces) / area for k in (0, 1))
    polar = sum(w * h * ((w * w + h * h) / 12 + (c[0] - x) ** 2 + (c[1] - y) ** 2) for c, w, h in pieces)  # fmt: skip

    even = even_film(exact(L))

    assert even.centre_um == pytest.approx((x, y), abs=1e-12)
    assert even.ratio_um2 == pytest.approx(polar / area, rel=1e-12)


@pytest.mark.parametrize(("x", "y"), [(0, 0), (44, 0), (-31, 17)])
def test_the_ratio_is_about_the_centroid_wherever_the_origin_is(x: int, y: int) -> None:
    even = even_film(exact([(a + x, b + y) for a, b in [(9, 4), (-9, 4), (-9, -4), (9, -4)]]))
    assert even.centre_um == (x, y)
    assert even.ratio_um2 == pytest.approx((18**2 + 8**2) / 12, rel=1e-12)


def test_an_even_film_is_no_word_worth() -> None:
    l, w = 1616.0, 837.0  # noqa: E741
    assert remarks(changed(PAPER, "uncertainty", film_ratio_um2=(l * l + w * w) / 12)) == ()
    assert remarks(Task.load(HEXAGON)) == ()


def test_an_origin_off_the_centroid_is_told_in_um_and_as_a_ratio() -> None:
    corners = [[x + 44.0, y] for x, y in Task.load(HEXAGON).to_dict()["part"]["polygon_um"]]

    (said,) = remarks(changed(HEXAGON, "part", polygon_um=corners))

    assert "44.0 um from the centroid" in said
    assert f"{44.0 / math.sqrt(112497.0):.2g} of" in said  # the task's comment has the square


@pytest.mark.parametrize(
    ("ratio", "times", "more"),
    [(1.0, "3.62e-06 x", False), (376900.0, "1.37 x", False), (9e5, "3.26 x", True)],
)
def test_a_film_ratio_is_told_beside_the_even_one(ratio: float, times: str, more: bool) -> None:
    (said,) = remarks(changed(PAPER, "uncertainty", film_ratio_um2=ratio))

    assert times in said
    assert "276002 um^2" in said  # (1616^2 + 837^2) / 12
    assert ("any drag under this part can have, 828006 um^2" in said) is more


def test_it_is_told_beside_the_verdict_and_in_the_report(tmp_path: Path) -> None:
    words = ["certify", str(PAPER), str(PLAN), "--samples", "1", "--out", str(tmp_path), "--json"]

    done = CliRunner().invoke(app, words)

    assert done.exit_code == 0
    assert json.loads(done.stdout)["verdict"] == "PROVED"
    assert done.stderr.count("meso-robust: note: uncertainty.film_ratio_um2 = 376900") == 1
    page = (tmp_path / "report.html").read_text(encoding="utf-8")
    assert "1.37 x that of an even film under this outline, 276002 µm²" in page
