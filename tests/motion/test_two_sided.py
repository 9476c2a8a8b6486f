"""The tube of the two-sided rotation against motions found by force balance alone."""

from __future__ import annotations

import itertools
from dataclasses import replace

import numpy as np
import pytest

from meso_robust.bounds import Interval
from meso_robust.motion.two_sided import (
    Grip,
    SlideTube,
    TubeStatus,
    _mode_bounds,
    _programs,
    enclose_slide,
)
from tests.motion.first_principles import PAIRS, Floats, State, push, solutions

UM = 1e-6
STEP = 4 * UM
TOLERANCE = 0.02 * UM  # of the midpoint rule, over the whole turn


def um(low: float, high: float) -> Interval:
    return Interval(low * UM, high * UM)


GRIP = Grip(
    separation=um(896, 916),
    depth=um(418.4, 418.6),
    half=um(808, 808),
    ratio=Interval(0.358e-6, 0.396e-6),
    friction=Interval(0.30, 0.36),
)
START, END = um(780, 845), -420 * UM
SLIDE = um(-210, -160)


def samples(grip: Grip, start: Interval, slide: Interval, count: int) -> Floats:
    """(V, depth, rho, mu, h, sigma) at all corners and at random points."""
    sides = (grip.separation, grip.depth, grip.ratio, grip.friction, start, slide)
    corners = np.array(list(itertools.product(*((side.lo, side.hi) for side in sides))))
    rng = np.random.default_rng(11)
    lo, hi = np.array([[side.lo, side.hi] for side in sides]).T
    return np.concatenate([corners, lo + rng.random((count, len(sides))) * (hi - lo)])


def gripped(points: Floats) -> State:
    """The part between both tips, the passive one at the origin."""
    V, depth, _, _, h, sigma = points.T
    theta = np.arctan2(V, h) + np.arcsin(2 * depth / np.hypot(h, V))
    zero = np.zeros_like(h)
    return State(
        x=0.5 * h + sigma * np.cos(theta),
        y=0.5 * V + sigma * np.sin(theta),
        theta=theta,
        active_x=h,
        active_y=V,
        passive_x=zero,
        passive_y=zero,
    )


def follow(points: Floats, end: float) -> list[State]:
    """States after every step until h has fallen to ``end`` in all samples."""
    rng = np.random.default_rng(5)
    _, _, rho, mu, _, _ = points.T
    state = gripped(points)
    states = [state]
    while float(state.active_x.min()) - STEP > end:
        state = push(state, rho, mu, 2, STEP, rng)
        states.append(state)
    return states


def leaves(tube: SlideTube, states: list[State]) -> float:
    """How far any motion leaves the tube at worst (negative: the least distance to its walls)."""
    worst = -np.inf
    for state in states:
        h, slide = state.active_x, state.slide
        upper, lower = (np.interp(-h, -tube.h, bound) for bound in (tube.upper, tube.lower))
        worst = max(worst, float((slide - upper).max()), float((lower - slide).max()))
    return worst


@pytest.fixture(scope="module")
def points() -> Floats:
    return samples(GRIP, START, SLIDE, 36)


@pytest.fixture(scope="module")
def motions(points: Floats) -> list[State]:
    return follow(points, END)


@pytest.fixture(scope="module")
def tube() -> SlideTube:
    return enclose_slide(GRIP, START, END, SLIDE)


def test_the_independent_motion_keeps_both_tips_on_the_part(
    motions: list[State], points: Floats
) -> None:
    depth = points[:, 1]
    for state in motions[:: len(motions) // 20]:
        assert np.abs(state.passive_gap(depth)).max() < TOLERANCE
        active = (state.active_arm * state.out).sum(axis=1) - depth
        assert np.abs(active).max() < TOLERANCE


def test_no_motion_leaves_the_tube(tube: SlideTube, motions: list[State]) -> None:
    assert tube.status is TubeStatus.COMPLETE
    assert leaves(tube, motions) < TOLERANCE


def test_the_tube_is_not_much_wider_than_the_motions(tube: SlideTube, motions: list[State]) -> None:
    slide = motions[-1].slide
    sampled = float(np.ptp(slide[np.isclose(motions[-1].active_x, motions[-1].active_x.min())]))
    width = float(tube.upper[-1] - tube.lower[-1])
    assert width < 75 * UM
    assert width < 2.0 * sampled + 10 * UM


@pytest.mark.parametrize(
    "slide", [(-190, -190), (-100, -100), (0, 0)], ids=["shipped", "less", "middle"]
)
def test_known_parameters_give_a_narrow_tube(slide: tuple[float, float]) -> None:
    sharp = Grip(
        separation=um(906, 906),
        depth=um(418.5, 418.5),
        half=um(808, 808),
        ratio=Interval(0.3769e-6, 0.3769e-6),
        friction=Interval(0.33, 0.33),
    )
    start, end = um(837, 837), -150 * UM
    tube = enclose_slide(sharp, start, end, um(*slide))
    assert tube.status is TubeStatus.COMPLETE
    assert leaves(tube, follow(samples(sharp, start, um(*slide), 0), end)) < TOLERANCE
    assert float((tube.upper - tube.lower).max()) < 4 * UM


def test_margins_hold_in_every_motion(
    tube: SlideTube, motions: list[State], points: Floats
) -> None:
    for state in motions[:: len(motions) // 30]:
        for arm in (state.active_arm, state.passive_arm):
            offset = np.abs((arm * state.along).sum(axis=1))
            assert (GRIP.half.lo - offset).min() > tube.edge_margin - TOLERANCE
        _, _, rho, mu, *_ = points.T
        found, valid = solutions(state, rho, mu, 2)
        assert found[:, :, 5][valid].min() > tube.force_margin * (1 - 1e-6)
        # the active tip alone would close the passive gap, whatever it does: contact is kept
        alone, possible = solutions(state, rho, mu, 1)
        for twist, at in zip(alone, possible, strict=True):
            speed = twist[:, 0] * -state.out[:, 0] + twist[:, 1] * -state.out[:, 1]
            arm = state.passive_arm
            turn = arm[:, 0] * -state.out[:, 1] - arm[:, 1] * -state.out[:, 0]
            assert ((speed + twist[:, 2] * turn)[at] > 0.0).all()


def test_a_late_start_is_covered_although_h_starts_anywhere_in_a_range(tube: SlideTube) -> None:
    late = samples(GRIP, Interval.point(START.lo), SLIDE, 0)
    assert leaves(tube, follow(late, END)) < TOLERANCE


def test_a_pair_within_the_friction_cones_is_not_complete() -> None:
    """V = 857 um, w = 837 um, mu = 0.33: V^2 < w^2 (1 + mu^2)."""
    jam = replace(
        GRIP,
        separation=um(857, 857),
        depth=um(418.5, 418.5),
        friction=Interval(0.33, 0.33),
        ratio=Interval.point(0.3769e-6),
    )
    for slide in (-190.0, -100.0, 0.0):
        tube = enclose_slide(jam, um(837, 837), END, um(slide, slide))
        assert tube.status is not TubeStatus.COMPLETE
        assert not np.isfinite(tube.upper).all()
        assert tube.status.message


def test_the_jam_is_real_in_the_independent_motion() -> None:
    """Past the angle at which the line through both contacts enters both cones, forces diverge."""
    point = np.array([[857 * UM, 418.5 * UM, 0.3769e-6, 0.33, 837 * UM, -190 * UM]])
    with pytest.raises(ValueError, match="no contact mode"):
        follow(point, END)


@pytest.mark.parametrize(
    ("change", "status"),
    [
        ({"half": um(600, 600)}, TubeStatus.OFF_EDGE),
        ({"friction": Interval(0.05, 0.9)}, None),
        ({"separation": um(820, 880)}, None),
        ({"ratio": Interval(0.0, 1e-5)}, None),
    ],
    ids=["short edge", "friction", "separation", "film"],
)
def test_what_breaks_the_grip_is_not_complete(
    change: dict[str, Interval], status: TubeStatus | None
) -> None:
    tube = enclose_slide(replace(GRIP, **change), START, END, SLIDE)
    assert tube.status is not TubeStatus.COMPLETE
    assert status in (None, tube.status)


def test_contact_is_lost_where_the_slide_is_large() -> None:
    """The passive tip pushes only while rho > (sigma + T/2)(d1 tau - sigma + T/2)."""
    tube = enclose_slide(replace(GRIP, half=um(4000, 4000)), um(837, 837), END, um(-10, -10))
    far = enclose_slide(replace(GRIP, half=um(4000, 4000)), um(1800, 1800), END, um(-10, -10))
    assert tube.status is TubeStatus.COMPLETE
    assert far.status is TubeStatus.CONTACT_LOST


@pytest.mark.parametrize("half_width", [0.0, 120 * UM], ids=["points", "boxes"])
def test_rates_of_all_modes_lie_between_the_bounds(half_width: float) -> None:
    """Also far from the shipped grip: one sticks, or both slip up, apart or together."""
    rng = np.random.default_rng(21)
    count = 400
    points = np.column_stack(
        [
            rng.uniform(900, 1300, count) * UM,
            np.full(count, 418.5 * UM),
            rng.uniform(0.05e-6, 1.5e-6, count),
            rng.uniform(0.05, 0.36, count),
            rng.uniform(-900, 1800, count) * UM,
            rng.uniform(-700, 700, count) * UM,
        ]
    )
    state = gripped(points)
    V, depth, rho, mu, h, sigma = points.T
    found, valid = solutions(state, rho, mu, 2)
    centred = found[:, :, :2] + np.array([0.5, 0.0])  # less the speed of the pair's middle
    rates = np.einsum("mij,ij->mi", centred, state.along)
    programs = _programs()
    at = np.column_stack([h, V, depth, sigma, rho, mu])
    used = set()
    for k in range(count):
        lo, hi = at[k].copy(), at[k].copy()
        lo[0], hi[0] = lo[0] - half_width * rng.random(), hi[0] + half_width * rng.random()
        least, most = _mode_bounds(programs, lo, hi)
        for mode in np.flatnonzero(valid[:, k]):
            used.add(int(mode))
            assert least - 1e-7 <= rates[mode, k] <= most + 1e-7
    assert {PAIRS[mode] for mode in used} >= {(0, 1), (-1, 1), (1, 0), (1, -1), (1, 1)}
