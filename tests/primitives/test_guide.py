"""A push that the slot's walls guide: by hand, against the event-driven engine, and where it must not be claimed."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from meso_robust.bounds import Interval, Verdict
from meso_robust.laboratory.draws import draw, some
from meso_robust.laboratory.running import run
from meso_robust.primitives.certify import certify_move
from meso_robust.primitives.move import MoveRule, Point, from_part, in_world
from meso_robust.primitives.names import ObligationId as Id
from meso_robust.primitives.obligation import Step
from meso_robust.primitives.setup import PoseBox, setup_of
from meso_robust.simulator import Outcome, Push, exact
from meso_robust.simulator.fixture import Fixture
from meso_robust.simulator.support_models import Film
from meso_robust.types import Floats
from meso_robust.units import UM
from tests.guided import guided_task

LEAN = math.radians(1.5)
CORNERS = np.array([[808, 418.5], [-808, 418.5], [-808, -418.5], [808, -418.5]]) * UM


def guide(ahead_um: float = 870.0) -> MoveRule:
    """The pair on the slot's axis, into the goal."""
    return MoveRule(
        step=4,
        primitive="x_translation",
        action="guide",
        side=0,
        dual=Point(x=from_part(ahead_um), y=in_world(0.0)),
        dual_end=in_world(850.5),
    )


def before(x_um: float = 490.0, y_um: float = 70.0, lean: float = LEAN) -> PoseBox:
    return PoseBox(
        x=Interval(x_um - 8, x_um + 8) * Interval.point(UM),
        y=Interval(-y_um, y_um) * Interval.point(UM),
        theta=Interval(math.pi - lean, math.pi + lean),
    )


def certified(pre: PoseBox, **changes: Any) -> Step:
    return certify_move(guide(), pre, setup_of(guided_task(**changes)))


def open_ones(step: Step) -> set[Any]:
    return {o.name.id for o in step.obligations if o.proof.verdict is not Verdict.PROVED}


def test_where_it_ends_is_plain_geometry() -> None:
    step = certified(before())
    assert step.verdict is Verdict.PROVED
    assert step.post is not None
    # no farther aside than a wall lets it: half of 976 less half of 837, and what a lean adds at the mouth
    assert 69.5 < step.post.y.hi / UM < 69.5 + 320 * math.sin(LEAN)
    assert step.post.theta.hi - math.pi == pytest.approx(LEAN, rel=1e-6)
    # 808 + 12.5 um behind the centre the tips end at 850.5 +- 5 um, and rock 418.5 um aside
    around = 5 + 418.5 * math.sin(LEAN) + 290 * math.tan(math.radians(0.25))
    assert step.post.x.lo / UM == pytest.approx(30 - around, abs=1.5)
    assert step.post.x.hi / UM == pytest.approx(30 + around, abs=1.5)


def room(poses: Floats) -> Floats:
    """(N,) m to the slot's walls: of corners within it, and of its edges beside the part."""
    c, s = np.cos(poses[:, 2, None]), np.sin(poses[:, 2, None])
    x = poses[:, 0, None] + c * CORNERS[:, 0] - s * CORNERS[:, 1]
    y = poses[:, 1, None] + s * CORNERS[:, 0] + c * CORNERS[:, 1]
    within = np.where(x < 300 * UM, 488 * UM - np.abs(y), np.inf)
    off = np.array([[300.0, 488.0], [300.0, -488.0]]) * UM - poses[:, None, :2]
    beside = np.abs(c * off[..., 1] - s * off[..., 0]) - 418.5 * UM
    return np.asarray(np.minimum(within.min(axis=1), beside.min(axis=1)))


def test_every_run_of_the_event_driven_engine_is_guided() -> None:
    """Straight travels up to 3 deg askew, friction of the tips and of the walls, leaning parts at a wall."""
    rng, touched = np.random.default_rng(4), 0
    for changes in (
        {},
        {"uncertainty__travel_direction_deg": [-3.0, 3.0]},
        {"slot__friction": 0.8},
    ):
        setup = setup_of(guided_task(**changes))
        step = certify_move(guide(), before(x_um=400.0), setup)
        assert step.verdict is Verdict.PROVED
        drawn = draw(replace(setup, start=step.pre), 1, 900, rng)
        drawn = some(drawn, np.flatnonzero(room(drawn.start) > 1e-8)[:150])
        drawn = replace(drawn, sensing=rng.uniform(-5 * UM, 5 * UM, drawn.sensing.shape))
        found = run((guide(),), setup, drawn, engine="events", record=8)
        assert (found.outcomes == Outcome.COMPLETED).all()
        (move,) = found.moves
        assert step.post is not None
        for poses, box in ((move.after, step.post), (move.path, step.tube[1].box)):
            low, high = box.ends
            assert ((poses >= low - 1e-9) & (poses <= high + 1e-9)).all()
        touched += int((room(move.path.reshape(-1, 3)).reshape(150, -1) < 1e-9).any(axis=1).sum())
    assert touched > 25


@pytest.mark.parametrize(
    ("pre", "changes", "lacks"),
    [
        (before(x_um=700.0), {}, Id.EDGE_TURNS_BACK),  # the front is 408 um deep only
        (before(), {"uncertainty__friction": [0.3, 0.45]}, Id.EDGE_TURNS_BACK),
        (before(), {"probe__tip_spacing_um": 480.0}, Id.EDGE_TURNS_BACK),
        (before(lean=0.08), {"slot__width_um": 880.0}, Id.ONE_WALL_AT_A_TIME),
        (before(), {"slot__depth_um": 1080.0}, Id.PART_IN_SLOT),
        (before(x_um=1300.0), {}, Id.PART_IN_SLOT),
        (before(y_um=480.0), {}, Id.PART_IN_SLOT),
        (before(), {"probe__tip_spacing_um": 720.0}, Id.TIP_ON_EDGE),
        (before(), {"uncertainty__friction": [0.3, 0.98], "slot__friction": 0.98}, Id.NO_JAM),
        (before(), {"uncertainty__film_ratio_um2": 3000.0}, Id.FILM_TURNS_WITH),
        (before(), {"uncertainty__travel_direction_deg": [-20.0, 20.0]}, Id.TIP_STEERS),
        (before(x_um=15.0), {}, Id.TIP_REACHES_PART),
        (before(), {"part__squareness_deg": 0.1}, Id.GUIDE_COVERED),
        (before(), {"uncertainty__drag_anisotropy_percent": 5.0}, Id.GUIDE_COVERED),
        (before(), {"uncertainty__drag_centre_um": 5.0}, Id.GUIDE_COVERED),
        (before(), {"part__corner_radius_um": 5.0}, Id.GUIDE_COVERED),
        (before(), {"slot__opens": "+y"}, Id.GUIDE_COVERED),
        (before(lean=0.6), {}, Id.GUIDE_COVERED),
    ],
)
def test_it_is_not_claimed_where_a_condition_fails(
    pre: PoseBox, changes: dict[str, Any], lacks: Id
) -> None:
    step = certified(pre, **changes)
    assert step.verdict is Verdict.UNKNOWN
    assert lacks in open_ones(step)


def test_short_of_the_depth_the_edge_turns_the_part_away() -> None:
    """The derivation's witness carried out: 300 um deep on the slot's edge, pushed 290 um above the middle."""

    def lean_after(deep_um: float) -> float:
        lean, b, ahead = 0.05, 418.5 * UM, (808 - deep_um) * UM
        c, s = math.cos(lean), math.sin(lean)
        # the lower side, this far ahead of the centre, on the slot's lower edge; ahead is -x, up is +y
        x = 300 * UM + ahead * c + b * s
        y = -488 * UM - ahead * s + b * c
        tip = np.array([x + 808 * UM * c + 290 * UM * s, y - 808 * UM * s + 290 * UM * c])
        solid = setup_of(guided_task()).slot
        assert solid is not None
        push = Push.along(
            vertices=CORNERS,
            poses=np.array([[x, y, math.pi - lean]]),
            ways=np.array([[[tip], [tip - [20 * UM, 0.0]]]]),
            friction=np.array([0.36]),
            support=Film(drag=np.diag([1.0, 1.0, 0.3769e-6])),
            fixture=Fixture((np.array(solid.outline_um, dtype=float) * UM,), 0.3),
            speed=75e-6,
            step=1e-6,
        )
        return float(math.pi - exact(push).poses[0, 2] - lean)

    assert lean_after(300.0) > 1e-4
    assert lean_after(760.0) < -1e-4
