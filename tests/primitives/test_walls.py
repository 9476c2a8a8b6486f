"""Clearance from the slot's walls, against brute force and the simulator."""

from __future__ import annotations

import math
import tomllib
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest
from hypothesis import given, strategies as st

from meso_robust.bounds import Interval, Verdict
from meso_robust.certificates.chain import Chain, certify
from meso_robust.laboratory.replay import Feedback
from meso_robust.planning.compose import compose
from meso_robust.primitives.names import ObligationId
from meso_robust.primitives.obligation import Knot
from meso_robust.primitives.setup import Block, PoseBox, Setup, setup_of
from meso_robust.primitives.walls import part_clear
from meso_robust.task import Slot, Task, parse_task
from meso_robust.tasks import PAPER
from tests.strategies import REPEATABLE, paper_chain

SLOT = {
    "mouth_x_um": 300.0,
    "mouth_y_um": 0.0,
    "opens": "+x",
    "width_um": 974.0,
    "depth_um": 1130.0,
    "wall_um": 1000.0,
    "friction": 0.3,
}

WALLS = {ObligationId.PART_CLEAR_OF_WALLS, ObligationId.TIPS_CLEAR_OF_WALLS}


def slot_task(start_x_um: float = 3400.0, **changes: Any) -> Task:
    """The paper's task before a slot of its width (clearance 137 um, Section VII)."""
    values = tomllib.loads(PAPER.read_text(encoding="utf-8"))
    values["start"]["x_um"] = start_x_um
    values["slot"] = {**SLOT, **changes}
    return parse_task(values, "slot")


@cache
def rules() -> Any:
    return compose(slot_task()).rules


def chain_of(task: Task) -> Chain:
    return certify(rules(), setup_of(task))


def setup_with(block: Block) -> Setup:
    return replace(paper_chain().setup, blocks=(block,))


def at(x: float, y: float, degrees: float, reach: float = 0.0, turn: float = 0.0) -> PoseBox:
    t = math.radians(degrees)
    return PoseBox(
        x=Interval(x - reach, x + reach),
        y=Interval(y - reach, y + reach),
        theta=Interval(t - turn, t + turn),
    )


def distance(box: PoseBox, block: Block) -> float:
    """The proved distance, -inf if it is undecided."""
    proof = part_clear([Knot(stage="", box=box)], setup_with(block)).proof
    return proof.lower


WALL = Block(x=Interval(-1e-3, 0.0), y=Interval(487e-6, 1487e-6))


@pytest.mark.parametrize(
    ("pose", "wanted_um"),
    [
        (at(0.0, 0.0, 180.0), 68.5),  # half of 974 - 837
        (at(0.0, 68e-6, 0.0), 0.5),
        (at(808e-6 + 9e-6, 1e-3, 0.0), 9.0),
        (at(0.0, 487e-6 - 808e-6 - 3e-6, 90.0), 3.0),
    ],
)
def test_distances_by_hand(pose: PoseBox, wanted_um: float) -> None:
    assert distance(pose, WALL) * 1e6 == pytest.approx(wanted_um, abs=1e-6)


@pytest.mark.parametrize(
    "pose", [at(0.0, 69e-6, 0.0), at(0.0, 0.0, 90.0), at(0.0, 60e-6, 180.0, reach=9e-6)]
)
def test_what_may_touch_is_not_proved(pose: PoseBox) -> None:
    assert distance(pose, WALL) == -math.inf


def test_a_leaning_part_at_a_corner_needs_its_own_axes() -> None:
    # the upper edge of a part at 45 deg passes the wall's lower right corner at 10 um
    off = (418.5e-6 + 10e-6) / math.sqrt(2.0)
    pose = at(0.0 + off, 487e-6 - off, 45.0)
    assert distance(pose, WALL) * 1e6 == pytest.approx(10.0, abs=1e-6)


def corners(x: float, y: float, t: float, a: float, b: float) -> np.ndarray[Any, Any]:
    c, s = math.cos(t), math.sin(t)
    body = np.array([[a, b], [-a, b], [-a, -b], [a, -b]])
    return body @ np.array([[c, s], [-s, c]]) + [x, y]


def overlap(p: np.ndarray[Any, Any], block: Block) -> bool:
    """Whether a convex polygon meets a block, by clipping it (Sutherland and Hodgman)."""
    for axis, sign, end in (
        (0, 1.0, block.x.lo), (0, -1.0, block.x.hi), (1, 1.0, block.y.lo), (1, -1.0, block.y.hi)
    ):  # fmt: skip
        kept: list[np.ndarray[Any, Any]] = []
        for one, two in zip(p, np.roll(p, -1, axis=0), strict=True):
            u, v = sign * (one[axis] - end), sign * (two[axis] - end)
            if u >= 0:
                kept.append(one)
            if u * v < 0:
                kept.append(one + (two - one) * u / (u - v))
        if not kept:
            return False
        p = np.array(kept)
    return True


@REPEATABLE
@given(
    st.floats(-2.5e-3, 2.5e-3), st.floats(-1e-3, 3e-3), st.floats(0.0, 360.0),
    st.floats(0.0, 1e-4), st.floats(0.0, 0.1), st.integers(0, 2**32 - 1),
)  # fmt: skip
def test_no_pose_of_a_box_that_is_proved_clear_touches(
    x: float, y: float, degrees: float, reach: float, turn: float, seed: int
) -> None:
    box, rng = at(x, y, degrees, reach, turn), np.random.default_rng(seed)
    if distance(box, WALL) > 0.0:
        for _ in range(8):
            u = rng.choice([0.0, 1.0, rng.random()], size=3)
            sides = (box.x, box.y, box.theta)
            px, py, pt = (s.lo + v * (s.hi - s.lo) for s, v in zip(sides, u, strict=True))
            assert not overlap(corners(px, py, pt, 808e-6, 418.5e-6), WALL)
    elif reach == turn == 0.0:  # a single pose that does not touch is proved unless it is close
        grown = corners(x, y, math.radians(degrees), 808e-6 + 1e-9, 418.5e-6 + 1e-9)
        assert overlap(grown, WALL)


@pytest.mark.parametrize("opens", ["+x", "+y", "-x", "-y"])
def test_the_walls_are_the_solid_that_the_simulator_sees(opens: str) -> None:
    slot = Slot.model_validate({**SLOT, "opens": opens, "mouth_y_um": 40.0}, strict=True)
    blocks, outline = slot.blocks_um, [(float(x), float(y)) for x, y in slot.outline_um]
    area = 0.5 * sum(
        a[0] * b[1] - a[1] * b[0] for a, b in zip(outline, outline[1:] + outline[:1], strict=True)
    )
    # whole solid less the slot, counter-clockwise
    assert area == pytest.approx((974 + 2000) * (1130 + 1000) - 974 * 1130)
    points = np.random.default_rng(0).uniform(-3000, 3000, (400, 2))
    for x, y in points + np.array([300.0, 40.0]):
        inside = any(b[0] <= x <= b[1] and b[2] <= y <= b[3] for b in blocks)
        assert inside == odd_crossings(x, y, outline)


def odd_crossings(x: float, y: float, outline: list[tuple[float, float]]) -> bool:
    hits = 0
    for (ax, ay), (bx, by) in zip(outline, outline[1:] + outline[:1], strict=True):
        if (ay > y) != (by > y):
            hits += x < ax + (y - ay) * (bx - ax) / (by - ay)
    return hits % 2 == 1


def test_insertion_into_the_papers_slot_is_proved_and_no_run_touches_a_wall() -> None:
    chain = chain_of(slot_task())
    clear = [o for s in chain.steps for o in s.obligations if o.name.id in WALLS]

    assert chain.verdict is Verdict.PROVED
    assert len(clear) == 2 * len(chain.steps)
    player = Feedback(rules=rules(), setup=chain.setup)
    runs = player.run(player.draw(40, np.random.default_rng(1)), record=30)
    assert runs.completed.all()
    half = 0.5 * 974e-6
    for x, y, t in runs.moves[-1].path.reshape(-1, 3):
        inside = [p for p in corners(x, y, t, 808e-6, 418.5e-6) if p[0] < 300e-6]
        assert all(abs(p[1]) < half for p in inside)


@pytest.mark.parametrize(
    "changes",
    [{"width_um": 850.0}, {"mouth_y_um": 60.0}, {"depth_um": 1110.0}, {"mouth_x_um": 1600.0}],
    ids=["too narrow", "beside", "too short", "reached while the part leans"],
)
def test_a_slot_that_the_part_may_touch_is_unknown_and_says_where(changes: dict[str, Any]) -> None:
    changes = {"depth_um": changes.get("mouth_x_um", 300.0) + 830.0, **changes}
    chain = chain_of(slot_task(**changes))

    assert chain.verdict is Verdict.UNKNOWN
    assert chain.open_obligation is not None
    assert chain.open_obligation[1].name.id in WALLS


def test_tips_that_would_hit_a_wall_are_found() -> None:
    # a slot that opens to -x beside the start, its walls where the tips of the first move are
    slot = {"mouth_x_um": 2450.0, "mouth_y_um": 0.0, "opens": "-x", "width_um": 2000.0}
    task = slot_task(2060.4, **{**slot, "depth_um": 60.0})
    chain = certify([step.rule for step in paper_chain().steps], setup_of(task))
    failed = [o.name.id for s in chain.steps for o in s.obligations if o.proof.lower == -math.inf]
    assert ObligationId.TIPS_CLEAR_OF_WALLS in failed


def test_the_plan_from_the_papers_start_jams_in_the_slots_mouth() -> None:
    """Too close to straighten before it enters: UNKNOWN by the proof, and in fact a jam."""
    task = slot_task(2060.4)
    chain = certify([step.rule for step in paper_chain().steps], setup_of(task))
    player = Feedback(rules=tuple(s.rule for s in paper_chain().steps), setup=chain.setup)

    runs = player.run(player.draw(8, np.random.default_rng(2)))

    assert chain.verdict is Verdict.UNKNOWN
    assert not runs.completed.any()


def test_tips_that_reach_a_wall_at_the_end_of_their_travel_only_are_found() -> None:
    # the tips stop about 808 um from the goal's middle, 440 um below it: inside the lower wall
    task = slot_task(mouth_x_um=900.0, width_um=500.0, depth_um=1730.0)
    chain = chain_of(task)
    tips = [
        o
        for s in chain.steps
        for o in s.obligations
        if o.name.id is ObligationId.TIPS_CLEAR_OF_WALLS
    ]
    proved = [o.proof.verdict is Verdict.PROVED for o in tips]
    assert all(proved[:-1])
    assert not proved[-1]


def test_a_way_that_is_not_enclosed_is_not_clear_of_anything() -> None:
    side = Interval(4e-3, 5e-3)
    found = part_clear([], setup_with(Block(x=side, y=side)))
    assert found.proof.verdict is Verdict.UNKNOWN
