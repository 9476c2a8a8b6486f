"""A straightening whose first tip may slip: against force balance, mode by mode, at corners of its box."""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass

import numpy as np

from meso_robust.bounds import HALF_PI, Interval, Verdict, prove_positive
from meso_robust.motion import one_tip
from meso_robust.planning.x_translation import rule_at
from meso_robust.primitives.move import from_part
from meso_robust.primitives.names import Inequality
from meso_robust.primitives.obligation import Step
from meso_robust.primitives.setup import PoseBox, Setup
from meso_robust.primitives.straighten import (
    CLOSE,
    FOR_OTHERS,
    SLIP_BOXES,
    Pushed,
    certify_straighten,
    is_proved,
)
from meso_robust.types import Floats
from tests.primitives.replay import Draws
from tests.primitives.test_tolerance import DEG, UM, real

RUNS, STEPS = 400, 4000
MIDDLE, END_UM = -130 * UM, -6000.0
PRE = PoseBox(
    x=Interval(1000 * UM, 1140 * UM),
    y=Interval(-76 * UM, 76 * UM),
    theta=Interval(165.2 * DEG, 166.2 * DEG),
)


@functools.cache
def proved() -> tuple[Setup, Step]:
    setup = real(1.0, spacing=580 * UM)
    rule = rule_at(MIDDLE, PRE, setup, from_part(END_UM), step=4, primitive="x_translation")
    return setup, certify_straighten(rule, PRE, setup)


def test_the_verdict_alone_is_that_of_the_step() -> None:
    """Not before its first tip may slip, and not where the pair comes too far off."""
    setup, step = proved()
    assert step.verdict is Verdict.PROVED
    assert is_proved(step.rule, PRE, setup)
    off = rule_at(2.5 * MIDDLE, PRE, setup, from_part(END_UM), step=4, primitive="x_translation")
    assert certify_straighten(off, PRE, setup, whole=False).verdict is not Verdict.PROVED
    assert not is_proved(off, PRE, setup)
    sticks = certify_straighten(step.rule, PRE, setup, whole=False, slipping=False)
    assert sticks.verdict is not Verdict.PROVED


@dataclass
class Part:
    """Runs of a part that one tip pushes; world axes."""

    pose: Floats
    """(runs, 3)"""
    depth: Floats
    kappa: Floats
    drag: Floats
    """(runs, 2) centre of drag along a and n."""
    film: Floats
    """(runs, 3) rho, stretch, shear."""

    def axes(self) -> tuple[Floats, Floats]:
        """Unit vectors along the edge and outward."""
        angle = self.pose[:, 2] - HALF_PI.mid + self.kappa
        return (
            np.stack([np.cos(angle), np.sin(angle)], 1),
            np.stack([np.sin(angle), -np.cos(angle)], 1),
        )

    def gap(self, tip: Floats, radius: Floats) -> Floats:
        _, n = self.axes()
        return np.sum(n * (tip - self.pose[:, :2]), 1) - self.depth - radius

    def moved(self, tip: Floats, velocity: Floats, mu: Floats) -> tuple[Floats, Floats]:
        """Velocity (runs, 3) of the reference point, and how fast the part slides along a over the tip."""
        a, n = self.axes()
        offset = np.sum(a * (tip - self.pose[:, :2]), 1)
        r_a, r_n = offset - self.drag[:, 0], self.depth - self.drag[:, 1]  # from the centre of drag
        rho, stretch, shear = self.film.T
        zero = np.zeros_like(rho)
        drag = np.stack([1 + stretch, shear, zero, shear, 1 - stretch, zero, zero, zero, rho], 1)
        mobility = np.linalg.inv(drag.reshape(-1, 3, 3))
        # a force (f_a, f_n) at the contact; a x n is -1, so its moment is r_n f_a - r_a f_n
        push = np.zeros((len(rho), 3, 2))
        push[:, 0, 0] = push[:, 1, 1] = 1.0
        push[:, 2, 0], push[:, 2, 1] = r_n, -r_a
        # by virtual power the transpose turns a twist into the velocity of the contact
        contact = np.swapaxes(push, 1, 2) @ mobility @ push
        wanted = np.stack([np.sum(a * velocity, 1), np.sum(n * velocity, 1)], 1)
        force = np.linalg.solve(contact, wanted[:, :, None])[:, :, 0]
        assert np.all(force[:, 1] < 0.0)
        # too little friction: at the end of the cone, on the side where it sticks by itself
        for k in np.flatnonzero(np.abs(force[:, 0]) > -mu * force[:, 1]):
            cone = np.array([math.copysign(mu[k], force[k, 0]), -1.0])
            normal = wanted[k, 1] / (contact[k] @ cone)[1]
            assert normal > 0.0
            force[k] = normal * cone
        slide = (contact @ force[:, :, None])[:, 0, 0] - wanted[:, 0]
        twist = (mobility @ push @ force[:, :, None])[:, :, 0]
        # from the centre of drag to the reference point: a turn moves it by omega z x (-drag)
        along, out, omega = twist[:, 0], twist[:, 1], twist[:, 2]
        along, out = along - omega * self.drag[:, 1], out + omega * self.drag[:, 0]
        return np.column_stack([along[:, None] * a + out[:, None] * n, omega]), slide


def runs(setup: Setup, step: Step) -> tuple[Floats, Floats, Floats]:
    """Poses at the end, how far the first tip has slipped, and poses on the way, (instants, runs, 3)."""
    draw, u, rule = Draws(RUNS, 5), setup.uncertainty, step.rule
    part = Part(
        pose=np.stack([draw(PRE.x), draw(PRE.y), draw(PRE.theta)], 1),
        depth=808 * UM + draw(u.size),
        kappa=draw(u.squareness),
        drag=np.stack([draw(u.drag_centre), draw(u.drag_centre)], 1),
        film=np.stack([draw(u.film_ratio), draw(u.drag_anisotropy), draw(u.drag_anisotropy)], 1),
    )
    mu, beta, phi = draw(u.friction), draw(u.misalignment), draw(u.travel_direction)
    radii = draw(u.tip_radius), draw(u.tip_radius)
    sensed = part.pose[:, :2] + np.stack([draw(u.sensed_position), draw(u.sensed_position)], 1)
    start = sensed + np.array([rule.dual.x.offset_um, rule.dual.y.offset_um]) * UM
    start += np.stack([draw(u.probe_position), draw(u.probe_position)], 1)
    up = 0.5 * setup.spacing.mid * np.stack([-np.tan(beta), np.ones(RUNS)], 1)
    tips = [start + up, start - up]
    course = -np.stack([np.cos(phi), np.sin(phi)], 1)
    left = np.full(RUNS, (rule.dual.x.offset_um - END_UM) * UM)
    _, n = part.axes()
    ahead = part.gap(tips[0], radii[0]) / -np.sum(n * course, 1)
    tips = [tip + ahead[:, None] * course for tip in tips]
    left = left - ahead
    assert np.all(part.gap(tips[1], radii[1]) > 0.0)
    slipped, open_ = np.zeros(RUNS), np.ones(RUNS, dtype=bool)
    length, passed = 4000 * UM / STEPS, []
    for k in range(STEPS):
        first, _ = part.moved(tips[0], course, mu)
        middle = Part(
            part.pose + 0.5 * length * first, part.depth, part.kappa, part.drag, part.film
        )
        rate, slide = middle.moved(tips[0] + 0.5 * length * course, course, mu)
        step_by = np.where(open_, length, 0.0)
        part.pose = part.pose + step_by[:, None] * rate
        slipped += step_by * slide
        tips = [tip + step_by[:, None] * course for tip in tips]
        left = left - step_by
        if k % 50 == 0:
            passed.append(part.pose)
        open_ &= part.gap(tips[1], radii[1]) > 0.0
        if not open_.any():
            break
    assert not open_.any()
    assert np.all(left > 0.0)
    end = part.pose.copy()
    end[:, :2] += left[:, None] * course
    return end, slipped, np.array(passed)


def test_every_run_ends_where_it_is_promised_although_the_first_tip_slips() -> None:
    setup, step = proved()
    assert step.verdict.word == "PROVED"
    assert step.post is not None
    end, slipped, passed = runs(setup, step)
    # so far that the ends would not be in a box for a contact that sticks
    assert np.max(slipped) > 40 * UM
    low, high = step.post.ends
    room = np.array([1 * UM, 1 * UM, 0.001])  # a step: the second tip is met only to its length
    boxes, some = np.array([knot.box.ends for knot in step.tube]), passed[:, :, None]
    inside = (some >= boxes[:, 0] - room) & (some <= boxes[:, 1] + room)
    assert inside.all(axis=3).any(axis=2).all()
    assert np.all(end >= low - room)
    assert np.all(end <= high + room)


def test_what_has_slipped_is_bounded_by_what_is_stated() -> None:
    setup, step = proved()
    (bounded,) = (o for o in step.obligations if o.inequality is Inequality.CREEPS_LESS)
    most = bounded.proof.box["creep_most"].hi
    lean = math.cos(PRE.theta.lo - HALF_PI.mid - 0.2 * DEG)
    lean = lean**3 + lean / 256
    _, slipped, _ = runs(setup, step)
    assert np.max(slipped) < most * lean < 2.0 * np.max(slipped)


def test_slip_is_looked_at_only_where_the_first_tip_is_not_proved_to_stick() -> None:
    setup, step = proved()
    held = certify_straighten(step.rule, PRE, setup, slipping=False)
    assert held.verdict.word == "UNKNOWN"
    setup = real(0.2, spacing=580 * UM)
    leaning = PoseBox(x=PRE.x, y=PRE.y, theta=Interval(174.5 * DEG, 175.0 * DEG))
    rule = rule_at(-100 * UM, leaning, setup, from_part(END_UM), step=4, primitive="x_translation")
    steps = [certify_straighten(rule, leaning, setup, slipping=s) for s in (False, True)]
    assert steps[0].verdict.word == "PROVED"
    assert steps[0] == steps[1]


def test_what_is_stated_is_about_the_least_that_is_proved() -> None:
    _, step = proved()
    assert isinstance(step.leaves, Pushed)
    ((side, box),) = step.leaves.cases
    of = one_tip.creeping(side, one_tip.zeros(box))
    less, more = (
        {**box, one_tip.CREEP_MOST: Interval.point(share * box[one_tip.CREEP_MOST].hi)}
        for share in (1.0 / (CLOSE * FOR_OTHERS * 1.001), 1.0 / FOR_OTHERS)
    )
    assert prove_positive(of, more, most=SLIP_BOXES).verdict is Verdict.PROVED
    assert prove_positive(of, less, most=SLIP_BOXES).verdict is not Verdict.PROVED
