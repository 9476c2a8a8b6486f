"""The search of the margin: fewer proofs, and the factors that a bisection by proofs alone finds."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

from meso_robust.bounds import Verdict
from meso_robust.certificates import margin as searched
from meso_robust.certificates.chain import begins, certify
from meso_robust.certificates.margin import margin
from meso_robust.planning.compose import compose
from meso_robust.primitives.setup import setup_of
from meso_robust.task import load_task
from meso_robust.tasks import HEXAGON
from tests.strategies import paper_chain, paper_task

RULES = [step.rule for step in paper_chain().steps]
LAST, FIRST = 1.37, 1.42


def bisected(bears: float, good: float, first: float) -> tuple[float, float | None]:
    return searched._bisect(lambda factor: factor <= bears, good, first)


@pytest.mark.parametrize("first_moves", [FIRST, 1.2, 7.9, 100.0])
@pytest.mark.parametrize("all_moves", [LAST, 1.0, 3.3, 100.0])
@pytest.mark.parametrize("only", [None, "friction"])
def test_the_factors_are_those_of_a_bisection_by_proofs(
    monkeypatch: pytest.MonkeyPatch, first_moves: float, all_moves: float, only: str | None
) -> None:
    """A plan whose first moves bear one factor and all of whose moves bear another."""
    proofs = []

    def proved(_: Any, factor: float, **__: Any) -> Any:
        proofs.append(factor)
        holds = factor <= min(first_moves, all_moves)
        return SimpleNamespace(verdict=Verdict.PROVED if holds else Verdict.UNKNOWN)

    monkeypatch.setattr(searched, "setup_of", lambda _, factor, only: factor)
    monkeypatch.setattr(searched, "begins", lambda _, factor: factor <= first_moves)
    monkeypatch.setattr(searched, "certify", proved)

    found = searched._search(RULES, paper_task(), only, 1.0, 2.0)

    assert found == bisected(min(first_moves, all_moves), 1.0, 2.0)
    assert found[0] == 1.0 or found[0] in proofs
    if first_moves < all_moves:
        assert len(proofs) == 1


def test_a_plan_that_is_not_proved_bears_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(searched, "begins", lambda *_: True)
    unknown = SimpleNamespace(verdict=Verdict.UNKNOWN)
    monkeypatch.setattr(searched, "certify", lambda *_, **__: unknown)
    assert searched._search(RULES, paper_task(), None, 1.0, 1.25) == (0.0, 1.0)


def test_what_does_not_begin_is_not_proved() -> None:
    """At these factors the shipped plan is refused in its first move, its second, at its rotation's start, and never."""
    task, begun = paper_task(), []
    for factor, only in ((2.4, "friction"), (1.3, None), (1.7, "probe_position"), (1.0, None)):
        setup = setup_of(task, factor, only)
        begun.append(begins(RULES, setup))
        assert begun[-1] or certify(RULES, setup, whole=False).verdict is Verdict.UNKNOWN
    assert begun == [False, False, False, True]
    assert [
        len(certify(RULES, setup_of(task, *at), whole=False).steps)
        for at in ((2.4, "friction"), (1.3,), (1.7, "probe_position"))
    ] == [1, 2, 3]


def test_a_radius_that_is_stated_exactly_has_a_range_in_place_of_a_factor() -> None:
    """What the file may state instead, for the same plan; a part that no passive tip touches says nothing of that."""
    task = load_task(HEXAGON)
    plan = compose(task).rules

    found = margin(plan, task).radii

    assert set(found) == {"tip_radius"}
    low, high = found["tip_radius"]
    assert (low + high, low < 12.5 < high) == (25.0, True)
    for out, verdict in ((0.0, Verdict.PROVED), (0.2, Verdict.UNKNOWN)):
        ends = (low - out, high + out)
        probe = task.probe.model_copy(
            update={"tip_radius_um": ends, "passive_tip_radius_um": (12.5, 12.5)}
        )
        stated = setup_of(task.model_copy(update={"probe": probe}))
        assert certify(plan, stated).verdict is verdict
