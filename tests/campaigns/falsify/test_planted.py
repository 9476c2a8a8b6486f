"""Rare defects planted in the claims about the paper's plan: searches find them, draws do not."""

from __future__ import annotations

import json
import math
from dataclasses import replace
from functools import cache

import numpy as np
import numpy.typing as npt
import pytest

from meso_robust.campaigns.falsify.failures import smallest
from meso_robust.campaigns.falsify.kind import FALSIFY
from meso_robust.campaigns.falsify.ready import Ready
from meso_robust.campaigns.falsify.section import Search, work_of
from meso_robust.campaigns.falsify.views import pooled
from meso_robust.campaigns.kind import MOST_FAILURES, Failure, Part, Result
from meso_robust.laboratory.claim_ids import CARRIED_OUT
from meso_robust.laboratory.judging import judge
from meso_robust.laboratory.replay import limits, nominal_row
from meso_robust.laboratory.witness_file import WitnessFile, row_of
from tests.campaigns.falsify.parts import claiming, paper_ready, part_of, with_side
from tests.laboratory.paper import exactly

Floats = npt.NDArray[np.float64]

CORNER = "move 4: box, y high"
BUDGET = 2_000
HOLE = np.array([0.1e-6, 0.1e-6, math.radians(0.005)])
"""Half sides; poses after the first move spread over 14.5 x 15.5 um and 1.3 deg."""


def searched(ready: Ready, method: str, target: str, budget: int = BUDGET) -> Result:
    """The first restart of a search, as a chunk."""
    part = part_of(methods=(method,), restarts=1, evaluations=budget)
    part = replace(part, given={**part.given, "targets": [t.name for t in ready.targets]})
    names = list(part.given["targets"])
    chunk = names.index(target)
    assert work_of(part, chunk) == Search(method=method, target=target, restart=0)  # type: ignore[arg-type]
    return FALSIFY.execute(ready, part, chunk)


def drawn(ready: Ready, method: str, count: int) -> Result:
    return FALSIFY.execute(ready, part_of(methods=(method,), executions=count), 0)


def broken(found: Result) -> set[str]:
    counts = found.values.get("broken") or found.values["totals"]["broken"]
    return {name for name, count in counts.items() if count}


@cache
def nearest() -> float:
    """Share of the last box's half width in y, a ten-thousandth less than a long search reaches."""
    return float(searched(paper_ready(), "corner-walk", CORNER, 5_000).values["highest"]) - 2e-4


def too_small() -> Ready:
    """The last box, y: its upper side where only a ten-thousandth of its width is left outside."""
    ready = paper_ready()
    box = ready.claims.posts[3]
    assert box is not None
    middle, half = box[:, 1].mean(), 0.5 * np.ptp(box[:, 1])
    return with_side(ready, 3, 1, 1, float(middle + nearest() * half))


@pytest.mark.parametrize(
    ("method", "budget"), [("corner-walk", 1_000), ("face-walk", 2_000), ("cma-es", 10_000)]
)
def test_a_box_too_small_by_a_ten_thousandth_of_its_width_is_left(method: str, budget: int) -> None:
    found = searched(too_small(), method, CORNER, budget)

    assert found.failed == 1
    assert broken(found) == {"move 4: ends in its box"}
    assert found.values["highest"] > 1.0
    assert found.values["evaluations"] <= budget
    assert found.runs == found.values["evaluations"] + 1
    assert [one.what for one in found.failures] == ["move 4: ends in its box"]


@pytest.mark.parametrize("method", ["uniform", "corners"])
def test_as_many_draws_do_not_leave_it(method: str) -> None:
    assert drawn(too_small(), method, 10_000).failed == 0


def test_the_box_as_it_is_certified_is_not_left() -> None:
    """Nothing is found where nothing is planted."""
    found = searched(paper_ready(), "corner-walk", CORNER)

    assert found.failed == 0
    assert not found.failures
    assert 0.6 < found.values["highest"] < 1.0


def with_a_hole() -> Ready:
    """The first move's tube made of six boxes around a hole: a pose that no corner ends at."""
    ready = paper_ready()
    off = nominal_row(exactly())
    off[0, :3] += (1.0e-6, -0.7e-6, math.radians(0.04))
    middle = exactly().run(off).moves[0].after[0]
    slabs = []
    for axis in range(3):
        for side in (0, 1):
            slab = np.array([[-1.0] * 3, [1.0] * 3]) * [0.01, 0.01, 15.0]
            slab[1 - side, axis] = middle[axis] + (1 if side else -1) * HOLE[axis]
            slabs.append(slab if side == 0 else np.sort(slab, axis=0))
    tubes = (np.array(slabs), *ready.claims.tubes[1:])
    return claiming(ready, replace(ready.claims, tubes=tubes))


@pytest.mark.parametrize("method", ["face-walk", "cma-es"])
def test_a_hole_inside_of_a_tube_is_found(method: str) -> None:
    found = searched(with_a_hole(), method, "move 1: tube", 3 * BUDGET)

    assert broken(found) == {"move 1: stays in its tube"}
    row = np.array([float.fromhex(value) for value in found.values["row"]])
    low, high = limits(exactly())
    bear = [0, 1, 2, 3, 4, 6, 7]  # what bears on the first move and its end
    assert ((row > low) & (row < high))[bear].any()


def test_neither_draws_nor_corners_end_in_the_hole() -> None:
    ready = with_a_hole()

    assert drawn(ready, "uniform", 2 * BUDGET).failed == 0
    assert drawn(ready, "corners", BUDGET).failed == 0
    assert searched(ready, "corner-walk", "move 1: tube").failed == 0


def test_splitting_measures_a_planted_probability() -> None:
    """After the second move the part is parallel to the tips: its angle is the misalignment.

    So a box that ends 1e-5 of the range of the misalignment early is left with probability 1e-5.
    """
    ready = paper_ready()
    low, high = limits(ready.player)
    at = 0.5 * math.pi + high[5] - 1e-5 * (high[5] - low[5])
    planted = with_side(ready, 1, 2, 1, at)
    target = "move 2: box, theta high"
    part = part_of(methods=("splitting",), restarts=3, evaluations=8_000)
    names = part.given["targets"]

    found = [FALSIFY.execute(planted, part, names.index(target) + k * len(names)) for k in range(3)]

    share, variation = pooled([one.values["rare"] for one in found])
    assert abs(share / 1e-5 - 1.0) < variation < 1.0
    assert drawn(planted, "uniform", BUDGET).failed == 0


# beyond the certified uncertainty


def stressed() -> tuple[Part, Ready, Result]:
    part = part_of(factor=1.5, methods=("corners",), executions=120)
    ready = paper_ready(1.5)
    return part, ready, FALSIFY.execute(ready, part, 0)


def read_back(ready: Ready, failure: Failure) -> Floats:
    witness = WitnessFile.model_validate_json(failure.files["witness.json"], strict=True)
    assert witness.breaks == (failure.what,)
    assert (witness.factor, witness.engine) == (1.5, "events")
    return row_of(witness, ready.player, "witness.json")


def test_at_half_as_much_more_uncertainty_claims_are_broken_by_small_witnesses() -> None:
    part, ready, found = stressed()

    assert FALSIFY.tell(part, FALSIFY.total(part, [found])).verdict == "measured"
    assert 0 < found.failed < 120
    assert len(found.failures) == MOST_FAILURES == len({one.what for one in found.failures})
    middle = nominal_row(ready.player)[0]
    for failure in found.failures:
        row = read_back(ready, failure)
        off = np.flatnonzero(row[0] != middle)
        assert 1 <= off.size <= 6
        found_again = judge(ready.player, ready.claims, row).broken
        (claim,) = [claim for claim in found_again if claim.words == failure.what]
        assert found_again[claim][0]
        # not one of them is to spare, nor can one be a thousandth nearer to its middle
        less = np.repeat(row, 2 * off.size, axis=0)
        less[np.arange(off.size), off] = middle[off]
        near = off.size + np.arange(off.size)
        less[near, off] = middle[off] + 0.999 * (row[0, off] - middle[off])
        kept = judge(ready.player, ready.claims, less).broken[claim]
        assert not kept[: off.size].any()
        assert not kept[off.size :].all()


def test_a_jam_takes_three_coordinates_and_the_friction_of_the_closed_form() -> None:
    """The grasp locks where ``sqrt(1 + mu**2)`` times the width is the distance of the tips."""
    ready = paper_ready(1.5)
    names = [column.name for column in ready.player.columns]
    off = ["friction", "move 3 dtp y_m", "move 3 stp y_m"]
    _, high = limits(ready.player)
    row = nominal_row(ready.player)[0]
    where = [names.index(name) for name in off]
    row[where] = high[where] * [1.0, -1.0, 1.0]
    row[names.index("start x_m")] = high[0]  # of no use to a jam

    small = smallest(ready, CARRIED_OUT, row)

    middle = nominal_row(ready.player)[0]
    assert [names[k] for k in np.flatnonzero(small != middle)] == off
    move = ready.player.run(small[None]).moves[2]
    apart = abs(float(move.tips[0, 1, 1] - move.tips[0, 2, 1]))  # when they pass each other
    locks = math.sqrt((apart / 837e-6) ** 2 - 1.0)
    assert locks < small[where[0]] < 1.01 * locks


def test_files_of_a_failure_are_a_task_and_a_plan_and_the_run() -> None:
    _, ready, found = stressed()
    files = found.failures[0].files

    assert set(files) == {"task.toml", "plan.json", "witness.json"}
    assert json.loads(files["plan.json"])["task_hash"] == ready.plan.task.hash
    assert found.failures[0].detail.startswith(f"{found.failures[0].what}: broken at ")
    assert "all else at its middle; found by corners draws, events" in found.failures[0].detail
