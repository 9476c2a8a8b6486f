"""What is known of a rotation where the room between tips and part is known."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pytest

from meso_robust.bounds import Interval, enclose, enclose_where
from meso_robust.motion.two_sided import Line, cut
from meso_robust.planning.reading import read_plan
from meso_robust.planning.rules import rules_of
from meso_robust.primitives import rotation
from meso_robust.primitives.grasp import on_line
from meso_robust.primitives.setup import setup_of
from meso_robust.task import load_task
from meso_robust.types import Floats

REAL_PAPER = Path(__file__).parents[2] / "reports" / "real_paper"
COUNT, CELLS = 20_000, 24
SLIDE = Interval(-100e-6, 100e-6)
"""m; as at the end of a turn."""


def drawn(box: Mapping[str, Interval]) -> dict[str, Floats]:
    """Half at ends, half anywhere."""
    rng = np.random.default_rng(2)

    def draw(side: Interval) -> Floats:
        ends = rng.choice([side.lo, side.hi], COUNT // 2)
        return np.concatenate([ends, rng.uniform(side.lo, side.hi, COUNT - COUNT // 2)])

    return {name: draw(side) for name, side in box.items()}


def room_of(at: Mapping[str, Floats]) -> Floats:
    """Both tips from the sensed part, the passive one's y in the world: their way apart across the travel."""
    along = at["dual_x"] + at["probe_x"] + 0.5 * at["spacing"] * np.tan(at["beta"])
    along = along - at["single_x"] - at["passive_x"]
    across = at["dual_y"] + at["probe_y"] - 0.5 * at["spacing"] - at["single_y"] - at["passive_y"]
    apart = across * np.cos(at["direction"]) - along * np.sin(at["direction"])
    return apart - at["depth"] - at["depth_far"] - at["radius_lower"] - at["radius_passive"]


@pytest.fixture(name="move", scope="module")
def move_of_real_paper() -> rotation.Move:
    """The rotation of the real paper's plan, from the plan's start."""
    task = load_task(REAL_PAPER / "task.toml")
    setup = setup_of(task)
    rules = rules_of(read_plan(REAL_PAPER / "plan.json", task))
    rule = next(rule for rule in rules if rule.action == "rotate")
    own, there = rule.frame.from_world(setup.start), rule.frame.setup(setup)
    return rotation._move(rule, own, there.edge(own.theta.mid), there)


def test_a_cell_leaves_out_only_what_has_another_room(move: rotation.Move) -> None:
    at = drawn({name: side for name, side in move.box.items() if side.width < np.inf})
    room = room_of(at)
    assert move.room.lo <= room.min()
    assert room.max() <= move.room.hi
    bounding = rotation._bounding(move)
    narrower = []
    cells = cut(move.grip, CELLS)
    for cell, known in zip(cells, rotation.within(move, cells), strict=True):
        inside = (room >= cell.lo) & (room <= cell.hi)
        for name in bounding:
            side = known.box[name]
            assert side.lo <= at[name][inside].min(initial=np.inf)
            assert at[name][inside].max(initial=-np.inf) <= side.hi
        narrower.append(min(known.box[n].width / move.box[n].width for n in bounding))
    assert {"probe_y", "passive_y", "radius_lower", "radius_passive"} <= set(bounding)
    assert max(narrower[0], narrower[-1]) < 0.75  # the tips stand far in, or far out


@pytest.mark.parametrize("which", [0, CELLS // 2, CELLS - 1])
def test_poses_at_the_end_are_held_where_the_room_is_known(move: rotation.Move, which: int) -> None:
    cell = cut(move.grip, CELLS)[which]
    (known,) = rotation.within(move, [cell])
    line = Line(first=0.0, value=0.0, rate=0.0, spread={}, drift={}, rest=SLIDE)
    box = {**known.box, "turned": Interval.point(0.1), "room": cell, **on_line(line, {})}
    at = drawn({name: side for name, side in box.items() if side.width < np.inf})
    room = room_of(at)
    inside = (room >= cell.lo) & (room <= cell.hi)
    assert inside.any()
    # what is compared with knows no room: it is what the tips' places make it
    for of, side in zip(move.of.end[:2], enclose_where(move.of.placed, box), strict=True):
        points = np.array([at[name][inside] for name in of.inputs])
        values = np.array(of.function.map(points.shape[1])(points))
        assert side.lo <= values.min()
        assert values.max() <= side.hi
        (loose,) = enclose(of, box, boxes=256)
        # where the room is at an end of its range the other bound has less to vary as well
        assert which != CELLS // 2 or side.width < 0.95 * loose.width
