"""Polygons between two tips: tubes against simulated runs, and what is not claimed."""

from __future__ import annotations

import math

import numpy as np
import pytest

from meso_robust.bounds import HALF_PI, Interval, Verdict
from meso_robust.errors import NotApplicableError
from meso_robust.laboratory.claims import outside
from meso_robust.laboratory.draws import draw
from meso_robust.laboratory.running import run
from meso_robust.planning.compose import compose
from meso_robust.primitives.certify import certify_move
from meso_robust.primitives.move import MoveRule
from meso_robust.primitives.names import ObligationId
from meso_robust.primitives.obligation import Step
from meso_robust.primitives.rotation import opposite
from meso_robust.primitives.setup import Setup, setup_of
from meso_robust.task import parse_task
from meso_robust.tasks import PAPER
from meso_robust.units import UM
from tests.polygons import values_of
from tests.strategies import paper_chain
from tests.turned_polygons import LONG_L, TURNED, changed, turned

RUNS = 80
ROUNDING = np.array([[1e-9, 1e-9, 1e-6]])  # m, m, rad: of the event-driven engine
ACTIONS = {
    "long L": ["rotate", "straighten"],
    "cut peg": ["tilt", "straighten", "rotate", "straighten"],
}


def rotation(name: str) -> MoveRule:
    return next(rule for rule in turned(name)[1] if rule.action == "rotate")


def unproved(step: Step) -> set[str]:
    return {one.name.key for one in step.obligations if one.proof.verdict is not Verdict.PROVED}


@pytest.mark.parametrize("name", TURNED)
def test_a_turn_between_two_tips_is_planned_and_proved(name: str) -> None:
    _, rules, chain = turned(name)
    assert [rule.action for rule in rules] == ACTIONS[name]
    assert chain.verdict is Verdict.PROVED
    assert chain.end is not None
    assert chain.end.within(chain.setup.goal)


@pytest.mark.parametrize("name", TURNED)
def test_every_simulated_run_keeps_to_tube_and_box(name: str) -> None:
    _, rules, chain = turned(name)
    draws = draw(chain.setup, len(rules), RUNS, np.random.default_rng(8))  # half of them at corners
    runs = run(rules, chain.setup, draws, record=24, engine="events")
    assert runs.completed.all()
    for step, move in zip(chain.steps, runs.moves, strict=True):
        tube = np.array([knot.box.ends for knot in step.tube])
        assert step.post is not None
        assert not outside(move.path, tube, ROUNDING).any()
        assert not outside(move.after, step.post.ends[None], ROUNDING).any()


def test_a_rectangle_told_as_a_polygon_turns_the_same() -> None:
    """Bounds differ by the room that is left for others only, which is never less."""
    steps = paper_chain().steps
    values, a, b = values_of(PAPER), 808.0, 418.5
    values["part"] = {"polygon_um": [[-a, -b], [a, -b], [a, b], [-a, b]]}
    setup = setup_of(parse_task(values, "told"))
    before = next(step for step in steps if step.rule.action == "rotate")
    one, two = (
        certify_move(before.rule, before.pre, own, whole=False)
        for own in (paper_chain().setup, setup)
    )
    assert one.verdict is two.verdict is Verdict.PROVED
    assert one.post is not None
    assert two.post is not None
    ends = np.abs(one.post.ends - two.post.ends)
    assert (ends[:, 2] < 1e-9).all()
    assert (ends[:, :2] < 8 * UM).all()
    assert (two.post.ends[0] <= one.post.ends[0] + 1e-12).all()
    assert (two.post.ends[1] >= one.post.ends[1] - 1e-12).all()
    for first, second in zip(one.obligations, two.obligations, strict=True):
        assert first.name == second.name
        less = 8 * UM if first.name.id is ObligationId.BOTH_TIPS_ON_EDGES else 1e-9
        assert first.proof.lower - less < second.proof.lower < first.proof.lower * (1 + 1e-6)


# ------------------------------------------------------------------------- what is asked of the outline


def altered(**corners: list[float]) -> Setup:
    """The L with some corners elsewhere."""
    told = [list(corner) for corner in LONG_L]
    for key, place in corners.items():
        told[int(key[1:])] = place
    return setup_of(changed("long L", part={"polygon_um": told}))


def test_what_reaches_past_the_end_of_the_pushed_edge_is_in_the_idle_tips_way() -> None:
    """The pushed edge ends where it did, and the part goes on behind its line."""
    told = [*LONG_L[:2], [1400.0, -320.0], *LONG_L[2:]]
    setup = setup_of(changed("long L", part={"polygon_um": told}))
    rule, start = rotation("long L"), setup.start
    assert setup.edge(start.theta.mid).last.mid == pytest.approx(933.3 * UM, rel=1e-9)
    assert "idle_tip_passes/before_touch" in unproved(certify_move(rule, start, setup))


def test_a_far_edge_that_is_too_short_for_the_slide_is_not_enough() -> None:
    setup = altered(c3=[-250.0, 66.7], c4=[-250.0, 466.7])
    step = certify_move(rotation("long L"), setup.start, setup)
    assert step.verdict is Verdict.UNKNOWN
    assert "both_tips_on_edges/off_edge" in unproved(step)


WEDGE = {"polygon_um": [[400.0, -500.0], [400.0, 500.0], [-800.0, 0.0]]}
"""um; no edge of it is less than 60 deg out of parallel to another one."""


def test_edges_far_from_parallel_are_no_opposite_ones() -> None:
    task = changed("long L", part=WEDGE, start={"theta_deg": 0.0}, goal={"theta_deg": 90.0})
    setup = setup_of(task)
    step = certify_move(rotation("long L"), setup.start, setup)
    assert step.post is None
    assert unproved(step) == {ObligationId.EDGES_OPPOSITE}
    with pytest.raises(NotApplicableError, match="about parallel to the pushed one"):
        compose(task)


@pytest.mark.parametrize(
    ("lean_deg", "friction", "squareness_deg", "are"),
    [
        (40.0, 1.18, None, True),
        (40.0, 1.20, None, False),  # 1 / tan(40 deg) = 1.1918
        (-40.0, 1.20, None, False),
        (40.0, 1.18, 0.3, False),  # each of both edges by 0.3 deg: 1 / tan(40.6 deg) = 1.1667
        (0.0, 3.0, None, True),
        (44.9, 0.36, None, True),
        (45.1, 0.36, None, False),
    ],
)
def test_a_force_in_the_far_cone_of_friction_faces_the_pushed_edge(
    lean_deg: float, friction: float, squareness_deg: float | None, are: bool
) -> None:
    part = {} if squareness_deg is None else {"squareness_deg": squareness_deg}
    setup = setup_of(changed("long L", part=part, uncertainty={"friction": [0.3, friction]}))
    assert opposite(Interval.point(np.radians(lean_deg)), setup) == are


def test_an_edge_beside_which_the_part_may_stick_out_cannot_be_pushed() -> None:
    """A foot that is 2 um shorter than the pushed one, of parts that are made to 4 um."""
    feet = {
        "polygon_um": [
            [-700.0, -300.0], [-100.0, -300.0], [-100.0, 0.0], [500.0, 0.0], [500.0, -298.0],
            [700.0, -298.0], [700.0, 400.0], [-700.0, 400.0],
        ]
    }  # fmt: skip
    exact = setup_of(changed("long L", part=feet))
    assert exact.edge(exact.start.theta.mid).name == "edge 0"
    made = setup_of(changed("long L", part=feet | {"size_tolerance_um": 4.0}))
    assert made.edge(made.start.theta.mid).name != "edge 0"


def test_the_opposite_edge_and_the_reach_by_hand() -> None:
    setup = turned("long L")[2].setup
    edge = setup.edge(HALF_PI.mid)
    far, lean = setup.opposite(edge)
    assert (edge.name, far.name, lean) == ("edge 0", "edge 4", Interval.point(0.0))
    assert far.depth.mid == pytest.approx(466.7 * UM, rel=1e-12)
    # run from (133.3, 466.7) to (-666.7, 466.7)
    assert (far.first.mid, far.last.mid) == pytest.approx((-133.3 * UM, 666.7 * UM), rel=1e-9)
    assert setup.reach_along(edge).hi == pytest.approx(933.3 * UM, rel=1e-9)
    leaning = altered(c4=[133.3, 456.7])  # 10 um in 800: clockwise, run from left to right
    far, lean = leaning.opposite(leaning.edge(HALF_PI.mid))
    assert far.name == "edge 4"
    assert lean.mid == pytest.approx(-math.atan(10.0 / 800.0), rel=1e-9)
    assert lean.width < 1e-12
