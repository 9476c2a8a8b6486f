"""Moves of polygons: tubes against simulated runs, tips that pass too close, rectangles told anew."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from meso_robust.bounds import Interval, Verdict
from meso_robust.certificates.chain import certify
from meso_robust.errors import NotApplicableError
from meso_robust.laboratory.claims import outside
from meso_robust.laboratory.draws import draw
from meso_robust.laboratory.making import outline
from meso_robust.laboratory.running import run
from meso_robust.motion import sticking
from meso_robust.planning.compose import compose
from meso_robust.planning.y_translation import y_translation
from meso_robust.primitives.certify import certify_move
from meso_robust.primitives.frame import Frame
from meso_robust.primitives.move import MoveRule, Point, from_part, in_world
from meso_robust.primitives.names import ObligationId
from meso_robust.primitives.obligation import Knot
from meso_robust.primitives.outline import outline_of
from meso_robust.primitives.setup import Block, PoseBox, Setup, setup_of
from meso_robust.primitives.walls import part_clear
from meso_robust.simulator import Push, simulate
from meso_robust.task import PolygonPart, Task, parse_task
from meso_robust.tasks import HEXAGON, PAPER
from meso_robust.units import UM
from tests.polygons import SHIPPED, inside, planned, values_of

RUNS = 120
ROUNDING = np.array([[1e-9, 1e-9, 1e-6]])  # m, m, rad: of the event-driven engine
PHASES = {"tilt": 2, "straighten": 3}  # free, one tip sticks, both do


@pytest.mark.parametrize("name", SHIPPED)
def test_the_shipped_task_is_proved_with_a_y_translation(name: str) -> None:
    _, rules, chain = planned(name)
    assert chain.verdict is Verdict.PROVED
    assert [rule.action for rule in rules] == ["tilt", "straighten", "straighten"]


@pytest.mark.parametrize("name", SHIPPED)
def test_every_simulated_run_keeps_to_tube_box_and_contacts(name: str) -> None:
    _, rules, chain = planned(name)
    draws = draw(chain.setup, len(rules), RUNS, np.random.default_rng(5))  # half of them at corners
    runs = run(rules, chain.setup, draws, record=24, engine="events")
    assert runs.completed.all()
    for step, move in zip(chain.steps, runs.moves, strict=True):
        tube = np.array([knot.box.ends for knot in step.tube])
        assert step.post is not None
        assert not outside(move.path, tube, ROUNDING).any()
        assert not outside(move.after, step.post.ends[None], ROUNDING).any()
        assert move.phases is not None
        assert (move.phases <= PHASES[step.rule.action]).all()  # a slip would be one more


@pytest.mark.parametrize("name", SHIPPED)
def test_the_boxes_are_not_much_larger_than_what_happens(name: str) -> None:
    _, rules, chain = planned(name)
    draws = draw(chain.setup, len(rules), RUNS, np.random.default_rng(6))
    runs = run(rules, chain.setup, draws, engine="events")
    for step, move in zip(chain.steps, runs.moves, strict=True):
        assert step.post is not None
        low, high = step.post.ends
        assert (np.ptp(move.after, axis=0) > 0.2 * (high - low)).all()


# ------------------------------------------------------------------------- the idle tip

SHALLOW = [
    [400.0, -200.0], [400.0, 200.0], [360.0, 349.3], [-400.0, 349.3], [-400.0, -349.3],
    [360.0, -349.3],
]  # fmt: skip
"""Next to the pushed edge lie edges that turn away by 15 deg only."""


def shallow(theta_deg: float, rise_um: float) -> tuple[Setup, MoveRule]:
    """A tilt of that part, and its task: the idle tip is beyond the end of the pushed edge.

    The lower tip pushes ``rise_um`` above the centre.
    """
    values = values_of(HEXAGON)
    values["part"] = {"polygon_um": SHALLOW}
    values["start"] |= {"x_um": 900.0, "y_um": 0.0, "theta_deg": theta_deg}
    values["probe"]["tip_spacing_um"] = 220.0
    values["uncertainty"] |= {
        "film_ratio_um2": 90000.0, "sensed_position_um": 1.0, "probe_position_um": 1.0,
    }  # fmt: skip
    rule = MoveRule(
        step=1,
        primitive="y_translation",
        action="tilt",
        side=1,
        dual=Point(x=from_part(600.0), y=from_part(rise_um + 110.0)),
        dual_end=from_part(330.0),
    )
    return setup_of(parse_task(values, "shallow")), rule


def first_touches(setup: Setup, rule: MoveRule) -> list[bool]:
    """Whether the upper and the lower tip touch during the nominal run of a move."""
    pose = np.array([setup.start.mid])
    commands = rule.commands(pose, setup.spacing.mid, np.zeros(1))
    push = Push.straight(
        vertices=outline(setup),
        poses=pose,
        tips=commands.tips,
        travel=commands.travel,
        friction=np.array([0.33]),
        film_ratio=np.array([setup.uncertainty.film_ratio.mid]),
        step=0.5 * UM,
    )
    modes = simulate(push, record=200).modes[0]
    return [bool((modes[:, tip] > 0).any()) for tip in (0, 1)]


def test_a_tip_that_clears_the_next_edge_is_proved_to() -> None:
    setup, rule = shallow(0.0, 100.0)
    step = certify_move(rule, setup.start, setup)
    assert [o.name for o in step.obligations if o.proof.verdict is not Verdict.PROVED] == []
    assert first_touches(setup, rule) == [False, True]


def test_a_tip_that_meets_the_next_edge_is_not() -> None:
    setup, rule = shallow(-7.0, 10.0)
    edge = setup.edge(setup.start.theta.mid)
    # the idle tip is beyond the end of the edge, which would be enough for a rectangle
    lower = sticking.contact_offset(
        edge.angle(setup.start.theta), edge.depth, Interval(8e-6, 12e-6)
    )
    assert lower.lo > edge.first.hi
    assert lower.hi < edge.last.lo < lower.lo + setup.spacing.lo * np.cos(np.radians(7.2))
    assert first_touches(setup, rule)[0]
    step = certify_move(rule, setup.start, setup)
    passing = [o for o in step.obligations if o.name.id is ObligationId.IDLE_TIP_PASSES]
    assert passing
    assert all(o.proof.verdict is not Verdict.PROVED for o in passing[:1])
    assert step.verdict is not Verdict.PROVED


# ----------------------------------------------------------------- what is not offered


def test_a_turn_of_a_hexagon_is_refused_by_name() -> None:
    """Its flats are 900 um apart: 520 um are too few for tips that cannot jam."""
    values = values_of(HEXAGON)
    values["goal"]["theta_deg"] = 60.0
    with pytest.raises(NotApplicableError, match=r"lie opposite each other over 520 um only"):
        compose(parse_task(values, "turned"))


def test_a_start_with_a_corner_towards_the_probe_is_refused() -> None:
    values = values_of(SHIPPED["L-shape"])
    values["start"]["theta_deg"] = values["goal"]["theta_deg"] = 130.0
    with pytest.raises(NotApplicableError, match=r"stands 40\.0 deg from upright"):
        compose(parse_task(values, "corner"))


def test_a_stated_rotation_of_a_polygon_is_undecided() -> None:
    setup = setup_of(planned("hexagon")[0])
    rule = replace(
        shallow(0.0, 100.0)[1],
        action="rotate",
        single=Point(x=from_part(-460.0), y=in_world(-100.0)),
    )
    step = certify_move(rule, setup.start, setup)
    assert step.verdict is Verdict.UNKNOWN
    assert step.post is None


# ------------------------------------------------------------------- rectangles told anew


def upright_paper(part: dict[str, object]) -> Task:
    """The paper's task without the quarter turn, so that it needs no rotation."""
    values = values_of(PAPER)
    values["part"] = part
    values["start"]["theta_deg"] = 180.0
    return parse_task(values, "upright")


def test_a_rectangle_told_as_a_polygon_moves_the_same() -> None:
    one = upright_paper({"length_um": 1616.0, "width_um": 837.0})
    a, b = 808.0, 418.5
    two = upright_paper({"polygon_um": [[-a, -b], [a, -b], [a, b], [-a, b]]})
    found = [y_translation(setup_of(task).start, setup_of(task), -8e-6, 1) for task in (one, two)]
    assert found[0] is not None
    assert found[1] is not None
    rules = [step.rule for step in found[0]]
    for rule, same in zip(rules, (step.rule for step in found[1]), strict=True):
        assert same.action == rule.action
        # commands are rounded to 0.1 um, and the travel that is needed hangs on them
        assert same.dual.y.offset_um == pytest.approx(rule.dual.y.offset_um, abs=0.11)
        assert same.dual_end.offset_um == pytest.approx(rule.dual_end.offset_um, abs=5.0)
    chains = [certify(rules, setup_of(task)) for task in (one, two)]
    for first, second in zip(chains[0].steps, chains[1].steps, strict=True):
        assert first.post is not None
        assert second.post is not None
        assert first.verdict is second.verdict is Verdict.PROVED
        near = first.post.ends - second.post.ends
        assert np.abs(near).max() < 1.1e-9  # one step of the grid on which boxes are told


@pytest.mark.parametrize("name", SHIPPED)
def test_a_mirrored_plan_of_a_mirrored_part_is_proved_alike(name: str) -> None:
    task, rules, chain = planned(name)
    assert isinstance(task.part, PolygonPart)
    setup = Frame(mirrored=True).setup(chain.setup)
    corners = tuple((x, -y) for x, y in reversed(task.part.polygon_um))
    setup = replace(setup, outline=outline_of(PolygonPart(polygon_um=corners)))
    told = [replace(rule, frame=replace(rule.frame, mirrored=True)) for rule in rules]
    mirrored = certify(told, setup)
    assert mirrored.verdict is Verdict.PROVED
    for one, other in zip(mirrored.steps, chain.steps, strict=True):
        assert one.post is not None
        assert other.post is not None
        assert one.post.y.lo == pytest.approx(-other.post.y.hi, abs=1.1e-9)
        assert one.post.theta.hi == pytest.approx(-other.post.theta.lo, abs=1e-8)


# ------------------------------------------------------------------------------- walls


def test_a_polygon_that_is_clear_of_a_wall_has_no_point_in_it() -> None:
    setup, rng, decided = planned("L-shape")[2].setup, np.random.default_rng(2), 0
    body = outline(setup)
    own = np.array(np.meshgrid(*(np.linspace(-0.8e-3, 0.8e-3, 33),) * 2)).reshape(2, -1).T
    own = np.concatenate([body, own[inside(own, body)]])
    block = Block(x=Interval(-3e-4, 3e-4), y=Interval(-2e-4, 2e-4))
    walled = replace(setup, blocks=(block,))
    for _ in range(16):
        x, y, theta = rng.uniform([-1.5e-3, -1.5e-3, -3.1], [1.5e-3, 1.5e-3, 3.1])
        wide = rng.uniform(0.0, [2e-5, 2e-5, 0.02])
        box = PoseBox(
            x=Interval(x, x + wide[0]),
            y=Interval(y, y + wide[1]),
            theta=Interval(theta, theta + wide[2]),
        )
        found = part_clear([Knot(stage="", box=box)], walled).proof
        if found.verdict is not Verdict.PROVED:
            continue
        decided += 1
        at = np.array([x, y, theta]) + rng.random(3) * wide
        c, s = np.cos(at[2]), np.sin(at[2])
        points = own @ np.array([[c, s], [-s, c]]) + at[:2]
        gap = np.maximum(np.abs(points[:, 0]) - 3e-4, np.abs(points[:, 1]) - 2e-4)
        assert gap.min() > 0.0
    assert decided > 6
