"""The factor at which an adversary first succeeds."""

from __future__ import annotations

import numpy as np
import pytest

from meso_robust.campaigns.falsify import executing, threshold as module
from meso_robust.campaigns.falsify.kind import FALSIFY
from meso_robust.campaigns.falsify.section import Wanted
from meso_robust.campaigns.falsify.threshold import (
    Breaking,
    Threshold,
    attack,
    breaking_at,
    threshold,
)
from meso_robust.laboratory.ascent import Effort
from meso_robust.laboratory.claim_ids import CARRIED_OUT, Claim, ClaimId
from meso_robust.laboratory.replay import Feedback, limits
from meso_robust.primitives.setup import setup_of
from tests.campaigns.falsify.parts import paper_ready, part_of
from tests.conftest import paper_task
from tests.laboratory.paper import exactly

QUICK = Effort(corners=200, reaches=(1.0,), elite=2, generations=0)


def test_what_fails_first_beyond_the_certified_margin() -> None:
    """Certified up to 1.20; contacts slip at 1.30 and not at 1.24, and the part jams only from 1.35 on."""
    rng = np.random.default_rng(0)
    assert breaking_at(exactly(1.2), 1.2, Wanted.ANY_MOTION, rng, QUICK)[0] is None
    assert breaking_at(exactly(1.24), 1.24, Wanted.ANY_MOTION, rng, QUICK)[0] is None
    slip, _ = breaking_at(exactly(1.3), 1.3, Wanted.ANY_MOTION, rng, QUICK)
    assert slip is not None
    assert slip.claims == (Claim(ClaimId.CONTACTS, 4),)
    corners_only = Effort(corners=400, reaches=(), elite=2, generations=0)
    assert breaking_at(exactly(1.3), 1.3, Wanted.ANY_MOTION, rng, corners_only)[0] is not None
    assert breaking_at(exactly(1.3), 1.3, Wanted.OUTCOME, rng, corners_only)[0] is None
    jam, executions = breaking_at(exactly(1.45), 1.45, Wanted.OUTCOME, rng, QUICK)
    assert jam is not None
    assert jam.claims == (CARRIED_OUT,)
    low, high = limits(exactly(1.45))
    assert (jam.row >= low).all()
    assert (jam.row <= high).all()
    assert executions > 600


def test_threshold_is_bracketed(monkeypatch: pytest.MonkeyPatch) -> None:
    """Bisection against a failure that is known: everything fails from 1.37 on."""

    def fails(player: Feedback, factor: float, *_: object) -> tuple[Breaking | None, int]:
        width = player.setup.uncertainty.friction.width
        assert width == pytest.approx(0.06 * factor)
        breaking = Breaking(factor=factor, claims=(CARRIED_OUT,), row=np.zeros(1))
        return (breaking if factor >= 1.37 else None), 10

    monkeypatch.setattr(module, "breaking_at", fails)
    found = threshold(exactly(), lambda f: setup_of(paper_task(), f), Wanted.OUTCOME)

    assert found.breaking is not None
    assert found.holds < 1.37 <= found.breaking.factor <= found.holds * 1.003
    assert found.executions % 10 == 0
    assert found.executions > 80


def test_a_threshold_as_a_chunk(monkeypatch: pytest.MonkeyPatch) -> None:
    """What is found beyond the part's uncertainty is told, and breaks nothing."""
    asked = []

    def coarse(player: Feedback, *_: object, seed: int, largest: float) -> Threshold:
        assert largest == 3.0  # the paper's friction would bear eleven times
        asked.append((player.engine, seed))
        row = np.array([0.25, -1.0])
        breaking = Breaking(factor=1.5, claims=(CARRIED_OUT,), row=row)
        return Threshold(holds=1.25, breaking=breaking, executions=123)

    monkeypatch.setattr(executing, "threshold", coarse)
    part = part_of(methods=("threshold",), engine="stepper")

    found = FALSIFY.execute(paper_ready(), part, 1)

    assert asked == [("events", 7)]
    assert (found.runs, found.failed, found.failures) == (123, 0, ())
    assert found.values["wanted"] == Wanted.OUTCOME.value
    # of the paper's plan; see reports/paper_task
    assert found.values["certified"] == pytest.approx(1.2, abs=0.02)
    assert [found.values[k] for k in ("holds", "breaks", "claims")] == [
        1.25,
        1.5,
        [CARRIED_OUT.words],
    ]
    assert found.values["row"] == ["0x1.0000000000000p-2", "-0x1.0000000000000p+0"]


def test_an_attack_reaches_the_ends_of_tight_boxes_and_leaves_none() -> None:
    """Orientations after straightening and rotating are kinematic: their boxes are 1 % wider a side."""
    ready = paper_ready()
    named = [t for t in ready.targets if "theta low" in t.name or "move 2: box, y" in t.name]

    reached = attack(ready.player, named, np.random.default_rng(1), QUICK)

    values = {one.target.name: one.summit.value for one in reached}
    assert all(value <= 1.0 + 1e-9 for value in values.values())
    for k in (2, 3, 4):
        assert values[f"move {k}: box, theta low"] > 0.97
    assert values["move 2: box, y low"] > 0.8
    rows = {one.target.name: one.summit.row for one in reached}
    ends = [rows[f"move 2: box, y {side}"] for side in ("low", "high")]
    y = exactly().run(np.array(ends)).moves[1].after[:, 1]
    assert y[1] - y[0] > 15e-6
