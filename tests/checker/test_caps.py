"""The cap of contact forces: proved with what a certificate may state, refused where it is exceeded."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import pytest
from flint import arb, ctx

from meso_robust.checker.force import force_below_cap
from meso_robust.checker.inputs import given
from meso_robust.checker.moves import verify_move
from meso_robust.checker.refusal import Refused
from meso_robust.checker.verdict import BITS
from meso_robust.task import Task
from tests.checker.test_turns import FULL, TILT, rule, task

SPEED_UM_S = 75.0
DRAG = 2.0
"""uN per um/s."""
MOST = 1.0 + 0.025 * 2**0.5
"""Largest eigenvalue of the drag over its mean: both entries that differ at 2.5 %."""


@pytest.fixture(autouse=True)
def precision() -> Iterator[None]:
    with ctx.workprec(BITS):
        yield


def capped(cap_un: float, wander_um: float = 0.0) -> Task:
    values = task(FULL).to_dict()
    values["uncertainty"]["probe_wander_um"] = wander_um
    values["probe"] |= {"max_force_un": cap_un, "speed_um_s": SPEED_UM_S}
    values["film"] = {"drag_un_s_per_um": DRAG}
    return Task.from_dict(values)


@pytest.mark.parametrize(
    ("wander_um", "faster"), [(0.0, 1.0), (0.2, 1.002 * (1.0 + 0.002**2) ** 0.5)]
)
def test_a_push_stays_below_the_drag_of_its_speed(wander_um: float, faster: float) -> None:
    """1.005 times the commanded speed, 0.5 % being the error of the scale, and what a tip strays along and across."""
    most = MOST * DRAG * SPEED_UM_S * 1.005 * faster
    enough, less = (given(capped(most * share, wander_um)) for share in (1.001, 0.999))
    scene, passage = verify_move(rule("tilt", TILT), enough.start, enough, None)
    stated: Any = passage.requirements[-1]
    assert stated.name.id == "force_below_cap"

    def holds(high: float, bound: float, key: str = "force") -> bool:
        return bool(stated.verify({key: (arb(0), arb(high * 1e-6))}, arb(bound * 1e-6)))

    assert holds(most * 1.0001, most * 0.0005)
    assert not holds(most * 0.9999, 0.0)  # more is reached
    assert not holds(most * 1.0001, most * 0.002)  # less to spare
    with pytest.raises(Refused):
        holds(most, 0.0, "mu")
    with pytest.raises(Refused):
        force_below_cap(scene, less, passage_without(passage))


def passage_without(passage: Any) -> Any:
    """The same before anything was proved of forces."""
    return replace(passage, requirements=passage.requirements[:-1])
