"""One meaning of the tips' names and of the sign of their misalignment, for every heading.

Expected are the two tip centres by hand: of a push along ``heading`` the right-hand tip is half the
spacing to the right, and ``tan(beta)`` times that ahead.
"""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest
from flint import arb

from meso_robust.checker.document import RuleDocument
from meso_robust.checker.dual import Dual
from meso_robust.checker.inputs import PoseBox, given
from meso_robust.checker.ranges import point_of, side_of
from meso_robust.checker.scene import scene_of
from meso_robust.laboratory.draws import nominal
from meso_robust.laboratory.open_loop import OpenLoop
from meso_robust.laboratory.replay import Feedback, nominal_row
from meso_robust.planning.document import MoveDocument, PlanDocument, names_of, plan_document
from meso_robust.primitives.frame import Frame
from meso_robust.primitives.setup import setup_of
from tests.turned import FRAMES, tips_by_hand, turned_rules, turned_task

BETA = np.radians(0.2)
SPACING = 580e-6
LARGER = {"-x": (1, 1), "+x": (1, -1), "-y": (0, -1), "+y": (0, 1)}
"""In which coordinate, and by which sign, dtp_top differs from dtp_bottom."""
each_frame = pytest.mark.parametrize("frame", FRAMES, ids=str)


def plan(frame: Frame) -> PlanDocument:
    task, rules = turned_task(frame), turned_rules(frame)
    sensed = np.array(setup_of(task).start.mid)
    return plan_document(task, rules, [sensed] * len(rules), [None] * len(rules))


def first_move(frame: Frame) -> MoveDocument:
    return plan(frame).moves[0]


def middle_of(move: MoveDocument) -> np.ndarray:
    starts = [np.array(probe.start_um) * 1e-6 for probe in move.probes if not probe.passive]
    return np.mean(starts, axis=0)


@each_frame
def test_a_name_is_that_of_the_same_tip_in_every_heading(frame: Frame) -> None:
    move = first_move(frame)
    at = {probe.name: np.array(probe.start_um) for probe in move.probes}
    assert list(at) == ["dtp_top", "dtp_bottom"]
    axis, sign = LARGER[frame.heading]
    apart = at["dtp_top"] - at["dtp_bottom"]
    assert np.allclose(apart, np.eye(2)[axis] * sign * SPACING * 1e6, atol=1e-3)


@each_frame
@pytest.mark.parametrize("beta", [BETA, -BETA])
@pytest.mark.parametrize("kind", ["stepper", "events", "open loop"])
def test_tips_are_where_a_hand_calculation_puts_them(frame: Frame, beta: float, kind: str) -> None:
    task, rules, move = turned_task(frame), turned_rules(frame), first_move(frame)
    setup = setup_of(task)
    if kind == "open loop":
        player: OpenLoop | Feedback = OpenLoop(moves=(move,), setup=setup)
    else:
        player = Feedback(rules=rules[:1], setup=setup, engine=kind)  # type: ignore[arg-type]
    row = nominal_row(player)
    row[0, [one.name for one in player.columns].index("misalignment_rad")] = beta
    made = player.run(row).moves[0].tips[0]

    by_name = dict(zip(player.probes[0], made, strict=False))
    right, left = tips_by_hand(frame, middle_of(move), SPACING, beta)
    assert by_name["dtp_top"] == pytest.approx(right, abs=1e-9)
    assert by_name["dtp_bottom"] == pytest.approx(left, abs=1e-9)


@each_frame
def test_the_same_error_in_other_axes_is_the_same_motion(frame: Frame) -> None:
    """Both engines: in the mirror, a pair whose right-hand tip is ahead has its left-hand tip ahead."""
    plain, sign = Frame(), -1.0 if frame.mirrored else 1.0
    ends = []
    for axes, beta in ((plain, BETA), (frame, sign * BETA)):
        setup, rules = setup_of(turned_task(axes)), turned_rules(axes)
        draws = replace(nominal(setup, len(rules)), misalignment=np.array([beta]))
        player = Feedback(rules=rules, setup=setup, engine="events")
        ends.append(axes.sensed(player.run(player.rows_of(draws)).final)[0])
    turns = (ends[1][2] - ends[0][2]) / (2.0 * np.pi)
    assert ends[1][:2] == pytest.approx(ends[0][:2], abs=1e-9)
    assert turns == pytest.approx(round(turns), abs=1e-9)


@each_frame
@pytest.mark.parametrize("beta", [0.2, -0.2])
def test_the_checker_puts_them_there_too(frame: Frame, beta: float) -> None:
    task = turned_task(frame, uncertainty__tip_misalignment_deg=[beta, beta])
    told = plan(frame)
    rule = RuleDocument.model_validate(json.loads(told.policy[0].model_dump_json()), strict=False)
    known, mid = given(task), setup_of(task).start.mid
    start = PoseBox(**dict(zip(("x", "y", "theta"), (side_of(arb(v)) for v in mid), strict=True)))
    scene = scene_of(rule, start, known)
    zero = side_of(arb(0))
    point = point_of(
        {**scene.box, **dict.fromkeys(("sensed_x", "sensed_y", "probe_x", "probe_y"), zero)}
    )

    def at(side: int) -> np.ndarray:
        found: list[Dual] = [
            point["x"] + scene.ahead(point, side),
            point["y"] + scene.rise(point, side),
        ]
        return frame.matrix @ [float(one.value) for one in found]

    tips = dict(zip(names_of(turned_rules(frame)[0]), (at(1), at(-1)), strict=True))
    right, left = tips_by_hand(frame, middle_of(told.moves[0]), SPACING, np.radians(beta))
    assert tips["dtp_top"] == pytest.approx(right, abs=1e-9)
    assert tips["dtp_bottom"] == pytest.approx(left, abs=1e-9)
