"""The search for the widest margin."""

from __future__ import annotations

import tomllib
from dataclasses import replace
from pathlib import Path

import pytest
from typer.testing import CliRunner

from meso_robust.bounds import Verdict
from meso_robust.certificates import design as searched
from meso_robust.certificates.chain import certify
from meso_robust.certificates.margin import margin
from meso_robust.cli import app
from meso_robust.errors import InputError, NotApplicableError
from meso_robust.primitives.move import MoveRule, from_part
from meso_robust.primitives.setup import setup_of
from meso_robust.task import load_task, with_spacing
from meso_robust.tasks import PAPER
from tests.conftest import paper_task as task_with
from tests.nightly import at_night
from tests.strategies import paper_chain, paper_task


def rules() -> tuple[MoveRule, ...]:
    return tuple(step.rule for step in paper_chain().steps)


@pytest.mark.parametrize(("peak", "start", "step"), [(7.0, 3.0, 1.0), (-4.0, 3.0, 1.0)])
def test_climbing_stops_at_the_top_either_way(peak: float, start: float, step: float) -> None:
    asked: list[float] = []

    def height(at: float) -> float:
        asked.append(at)
        return -abs(at - peak)

    if peak > 0:
        assert searched._climb(start, step, height) == peak
    else:  # a spacing is positive
        assert searched._climb(start, step, height) == 1.0
    assert min(asked) > 0.0


def test_a_move_that_fails_is_repaired_by_its_own_numbers(monkeypatch: pytest.MonkeyPatch) -> None:
    """The straightening push 40 um too high: its tips slip; brought back, not taken from the plan."""
    monkeypatch.setattr(searched, "OFFSET_STEPS_UM", (20.0,))  # twice
    good = rules()
    point = replace(good[1].dual, y=from_part(good[1].dual.y.offset_um + 40.0))
    broken = (good[0], replace(good[1], dual=point), *good[2:])
    assert certify(broken, setup_of(paper_task())).verdict is Verdict.UNKNOWN

    repaired = searched._repaired(broken, paper_task(), 1.0)

    assert repaired is not None
    assert certify(repaired, setup_of(paper_task())).verdict is Verdict.PROVED
    assert repaired[1].dual.y != broken[1].dual.y


def test_what_cannot_be_repaired_is_given_up(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(searched, "OFFSET_STEPS_UM", (24.0,))
    good = rules()
    point = replace(good[0].dual, y=from_part(0.0))  # the tilt would push in the middle
    broken = (replace(good[0], dual=point), *good[1:])
    assert searched._repaired(broken, paper_task(), 1.0) is None


def test_the_factor_is_that_of_the_margin() -> None:
    known = margin(rules(), paper_task())
    factor = searched._bears(rules(), paper_task(), 1.0)
    assert known.refused is not None
    assert known.factor * (1 - searched.RESOLUTION) <= factor < known.refused
    assert searched._bears(rules(), paper_task(), known.refused) == 0.0


def test_the_best_spacing_of_those_tried_is_taken(monkeypatch: pytest.MonkeyPatch) -> None:
    """The shipped plan is made for 580 um; it bears less with tips that are 604 um apart."""
    monkeypatch.setattr(searched, "SPACING_STEPS", (0.04,))
    monkeypatch.setattr(searched, "WORTH", ())
    monkeypatch.setattr(searched, "robust_at", lambda _, scale: rules() if scale == 1.0 else None)
    heard: list[str] = []

    found = searched.design(task_with(probe__tip_spacing_um=604.0), heard.append)

    tried = dict(found.tried)
    assert found.factor == max(tried.values()) > tried[604.0]
    assert found.rules == rules()
    assert found.task.probe.tip_spacing_um == max(tried, key=lambda spacing: tried[spacing])
    setup = setup_of(found.task, found.factor)
    assert certify(found.rules, setup).verdict is Verdict.PROVED
    assert len(heard) == len(tried)


def test_no_plan_at_any_spacing_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(searched, "SPACING_STEPS", ())
    with pytest.raises(NotApplicableError, match=r"tip spacing of 580 ... 580 um"):
        searched.design(task_with(uncertainty__friction=[0.05, 0.9]))


def test_the_task_file_keeps_its_authors_text() -> None:
    text = PAPER.read_text(encoding="utf-8")
    changed = with_spacing(text, 557.5)
    assert tomllib.loads(changed)["probe"]["tip_spacing_um"] == 557.5
    assert [a for a, b in zip(text.splitlines(), changed.splitlines(), strict=True) if a != b] == [
        "tip_spacing_um = 580.0"
    ]
    with pytest.raises(InputError, match="line of its own"):
        with_spacing("probe = {tip_spacing_um = 580.0}\n", 557.5)


@at_night
def test_widest_writes_the_task_of_the_plan(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(searched, "SPACING_STEPS", ())
    monkeypatch.setattr(searched, "WORTH", ())
    monkeypatch.setattr(searched, "GROWTH", 1.1)  # few plans are asked for
    out = tmp_path / "out"

    result = CliRunner().invoke(app, ["plan", "--widest", "--samples", "20", "--out", str(out)])

    assert result.exit_code == 0, result.output
    assert load_task(out / "task.toml").hash in (out / "plan.json").read_text()
