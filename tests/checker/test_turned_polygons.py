"""Certificates of polygons that are turned between two tips: verified, and rejected for another part or plan."""

from __future__ import annotations

import copy
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
from flint import arb, ctx

from meso_robust.bounds import Verdict
from meso_robust.certificates.chain import certify
from meso_robust.checker import outline as own
from meso_robust.checker.verdict import BITS, Answer
from meso_robust.primitives.setup import setup_of
from meso_robust.task import PolygonPart, Task
from tests.checker.test_check import checked
from tests.nightly import at_night
from tests.polygons import certificate
from tests.turned_polygons import LONG_L, changed, turned

Document = dict[str, Any]


@pytest.fixture(scope="module", autouse=True)
def _as_the_checker_computes() -> Iterator[None]:
    with ctx.workprec(BITS):
        yield


def document() -> Document:
    return certificate(*turned("long L"))


def refusal(found: Answer) -> str:
    assert found.verdict == "REJECTED"
    assert found.refused is not None
    return found.refused.name.key


def test_a_turn_of_a_polygon_is_verified() -> None:
    found = checked(document(), turned("long L")[0])
    assert found.verdict == "VERIFIED", found.refused


def altered(corner: int, by: tuple[float, float]) -> Task:
    told = [list(one) for one in LONG_L]
    told[corner] = [value + step for value, step in zip(told[corner], by, strict=True)]
    return changed("long L", part={"polygon_um": told})


# the pushed edge runs from corner 0 to 1, where the idle tip passes; the passive tip holds that from 4 to 5
ALTERED = {
    "the pushed edge ends below the active tip": (1, (-560.0, 0.0)),
    "a corner beyond the pushed edge reaches into the idle tip's way": (2, (400.0, 0.0)),
    "the far edge begins too late": (4, (-500.0, 0.0)),
    "the far edge leans": (4, (0.0, 3.0)),
}


@pytest.mark.parametrize("what", ALTERED)
def test_another_part_is_rejected(what: str) -> None:
    refusal(checked(document(), altered(*ALTERED[what])))


@at_night
def test_edges_out_of_parallel_are_verified_as_such() -> None:
    """The far edge leans by 0.4 deg, as stated: another task, and a certificate of its own for the same plan."""
    task, rules = altered(4, (0.0, -6.0)), turned("long L")[1]
    chain = certify(rules, setup_of(task))
    assert chain.verdict is Verdict.PROVED
    found = checked(certificate(task, rules, chain), task)
    assert found.verdict == "VERIFIED", found.refused


@at_night
def test_a_notch_that_nothing_rests_on_may_be_deeper() -> None:
    assert checked(document(), altered(3, (-4.0, -4.0))).verdict == "VERIFIED"


MOVED = {
    "the passive tip on another edge": ("single_x", -300.0),
    "the passive tip beyond the end of its edge": ("single_y", 400.0),
    "tips that jam": ("single_y", 25.0),
}


@pytest.mark.parametrize("what", MOVED)
def test_another_plan_is_rejected(what: str) -> None:
    key, by = MOVED[what]
    told = copy.deepcopy(document())
    told["policy"][0][key]["offset_um"] += by
    refusal(checked(told, turned("long L")[0]))


@pytest.mark.parametrize("when", ["before_touch", "late_in_turn"])
def test_more_room_for_the_idle_tip_than_there_is_is_not_believed(when: str) -> None:
    told = copy.deepcopy(document())
    one = next(
        one
        for one in told["steps"][0]["obligations"]
        if (one["id"], one["about"].get("when")) == ("idle_tip_passes", when)
    )
    one["lower_bound"] = (8.0 * float.fromhex(one["lower_bound"])).hex()
    assert refusal(checked(told, turned("long L")[0])) == f"idle_tip_passes/{when}: lower_bound"


# ------------------------------------------------------------------------ its own outline


def near(ball: arb, value: float) -> bool:
    return bool(abs(ball - arb(value)) < 1e-12)


def test_the_opposite_edge_and_the_extent_by_hand() -> None:
    """A trapezoid, legs 4 up on 3 across and upright, in um; the far side is parallel, a leg is not."""
    part = PolygonPart(polygon_um=((-60.0, -20.0), (30.0, -20.0), (30.0, 20.0), (-30.0, 20.0)))
    found = own.outline(part)
    base = found.facing(arb.pi() / 2)
    assert (base.name, near(base.d1, 20e-6)) == (0, True)
    far, askew = found.opposite(base)
    assert (far.name, bool(askew == 0)) == (2, True)
    along, across = found.extent(base)
    assert near(along, 30e-6)
    assert near(across, 20e-6)
    upright = found.facing(arb(0))
    leg, askew = found.opposite(upright)
    assert leg.name == 3
    # run from bottom to top the leg has the direction (30, 40)
    assert near(askew, float(-np.arctan2(30.0, 40.0)))


def test_a_part_that_may_stick_out_beside_an_edge_is_seen() -> None:
    """Feet that differ by 2 um, each to 1 um: a tip on one of them may meet the other one."""
    feet = ((-60.0, -30.0), (-10.0, -30.0), (-10.0, 0.0), (10.0, 0.0), (10.0, -28.0), (60.0, -28.0), (60.0, 40.0), (-60.0, 40.0))  # fmt: skip
    found = own.outline(PolygonPart(polygon_um=feet))
    edge = found.facing(arb.pi() / 2)
    assert edge.name == 0
    none = (arb(0), arb(0))
    assert found.holds(edge, none, none)
    assert not found.holds(edge, (arb(-1e-6), arb(1e-6)), none)
    assert found.holds(edge, (arb(-2e-7), arb(2e-7)), none)
    assert not found.holds(edge, none, (arb(-0.03), arb(0.03)))
