"""The three primitives of Tables III to V as single moves, run as the laboratory would measure them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cache

import numpy as np

from meso_robust import units
from meso_robust.bounds import HALF_PI, Interval
from meso_robust.conditions import values
from meso_robust.laboratory.draws import Draws, nominal
from meso_robust.laboratory.running import PlanRun, rectangle, run
from meso_robust.planning.nominal import sticks, straightens
from meso_robust.planning.y_translation import LARGEST_TILT
from meso_robust.primitives.move import MoveRule, Point, from_part
from meso_robust.primitives.setup import PoseBox, Setup, setup_of
from meso_robust.reproduction.certified import trials
from meso_robust.simulator import Push
from meso_robust.simulator.exact import exact
from meso_robust.task import load_task
from meso_robust.tasks import PAPER
from meso_robust.types import Flags, Floats

WIDTH_UM = 837.0  # of the part, Section IX-A
GAP_UM = 20.0
"""Commanded distance of a tip from the edge: more than the errors of sensing and control together."""
ROOM = 2e-6  # m: travel on top of what a turn needs
SPACINGS = (480e-6, 640e-6)
"""m; the spacings of the shipped task's comment, of which all certify."""


@cache
def paper_setup() -> Setup:
    """The paper's task; its start is the upright part."""
    return setup_of(load_task(PAPER))


def lying(setup: Setup) -> Setup:
    """The same with the part a quarter turn further, its short edge facing the probe."""
    start = replace(setup.start, theta=setup.start.theta + HALF_PI)
    return replace(setup, start=start)


def rotation(
    separation_um: float, push_um: float, setup: Setup, gap_um: float = GAP_UM
) -> MoveRule:
    """The rotation with both tips centred about the upright part (Section X-C).

    Parameters
    ----------
    separation_um
        Of the lower tip of the active probe from the passive one, across the push.
    push_um
        Travel from where the two tips are as far apart along the push as the part is wide.
    setup
        The task.
    gap_um
        Commanded distance of both tips from the part before the move.
    """
    near = 0.5 * WIDTH_UM + gap_um
    above = 0.5 * (separation_um + units.to_um(setup.spacing.mid))
    return MoveRule(
        step=2,
        primitive="rotation",
        action="rotate",
        side=1,
        dual=Point(x=from_part(near), y=from_part(above)),
        dual_end=from_part(WIDTH_UM - near - push_um),
        single=Point(x=from_part(-near), y=from_part(-0.5 * separation_um)),
    )


def x_translation(push_um: float, setup: Setup, height_um: float = 0.0) -> MoveRule:
    """A t² push of ``push_um`` on the edge that faces the probe, counted from the touch.

    ``height_um`` is that of the pair's middle above the part's centre.
    """
    depth = units.to_um(setup.edge(setup.start.theta.mid).depth.mid)
    return MoveRule(
        step=4,
        primitive="x_translation",
        action="straighten",
        side=0,
        dual=Point(x=from_part(depth + GAP_UM), y=from_part(height_um)),
        dual_end=from_part(depth - push_um),
    )


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Measured:
    """Net displacements of N trials; um, um, deg, positive along the push and counter-clockwise."""

    true: Floats
    """(N, 3)"""
    seen: Floats
    """(N, 3) from the poses that the camera gives before and after."""
    completed: Flags
    """(N,) runs that neither jammed nor ended early in another way."""


def measured(rules: Sequence[MoveRule], setup: Setup, runs: int, seed: int) -> Measured:
    """Trials of moves over all stated uncertainties, with the camera's errors before and after."""
    found, u = trials(rules, setup, runs, seed), setup.uncertainty
    rng = np.random.default_rng((seed, 1))
    at_most = np.array([u.sensed_position.hi, u.sensed_position.hi, u.sensed_orientation.hi])
    error = at_most * rng.uniform(-1.0, 1.0, (runs, 3))
    first = found.moves[0]
    return Measured(
        true=shown(found.final - first.before),
        seen=shown(found.final + error - first.sensed),
        completed=found.completed,
    )


def shown(moved: Floats) -> Floats:
    """(N, 3) displacements in m and rad as the tables print them: um and deg, the push positive."""
    return moved / np.array([-units.UM, units.UM, units.DEG])


def nominal_runs(
    rule: MoveRule, setup: Setup, *, friction: Sequence[float] = (), record: int = 0
) -> PlanRun:
    """A move without errors, at each of the friction coefficients; at the middle one without any."""
    one = nominal(setup, 1)
    at = np.array(friction or one.friction)
    repeated = {
        name: np.repeat(getattr(one, name), len(at), axis=0)
        for name in ("start", "film_ratio", "misalignment", "sensing", "dual", "single")
    }
    return run([rule], setup, Draws(friction=at, **repeated), record=record, engine="events")


def net(rule: MoveRule, setup: Setup, friction: Sequence[float] = ()) -> Floats:
    """(N, 3) net displacements of `nominal_runs`, as `shown`."""
    found = nominal_runs(rule, setup, friction=friction)
    return shown(found.final - found.moves[0].before)


def turned_deg(push_um: Floats | float, separation_um: Floats | float) -> Floats:
    """Turn in deg from upright while both tips touch opposite long edges, after a push (um)."""
    cosine, sine = values("two_sided_rotation", "orientation")(
        h=(WIDTH_UM - np.asarray(push_um)) * units.UM,
        V=np.asarray(separation_um) * units.UM,
        d1=paper_setup().half_width.mid,
    )
    return np.asarray(np.degrees(np.arctan2(sine, cosine)) - 90.0)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class YTranslations:
    """N Y-translations without errors, each with inputs of its own; um and deg."""

    arm_um: Floats
    """(N,) l_AB, from the contact of the tilt to that of the straightening."""
    tilt_deg: Floats
    """(N,) phi."""
    theory_um: Floats
    """(N,) net rise by the closed form."""
    net: Floats
    """(N, 3) net displacement in the simulator; X with the shortest push that rights the part."""


def y_translations(setup: Setup, count: int, seed: int) -> YTranslations:
    """Simulate Y-translations over the inputs that the paper does not print.

    Tilt from 2 deg to the largest the planner takes, contact of the tilt anywhere above the middle,
    spacing within ``SPACINGS``, height of the pair within half the part's width; those of ``count``
    draws are kept of which every contact sticks.
    """
    rng = np.random.default_rng(seed)
    tilt = rng.uniform(math.radians(2.0), LARGEST_TILT, count)
    offset = rng.uniform(0.0, setup.half_length.mid, count)
    spacing, height = (
        rng.uniform(*SPACINGS, count),
        setup.half_width.mid * rng.uniform(-1, 1, count),
    )
    keep = [_works(setup, *given) for given in zip(tilt, offset, spacing, height, strict=True)]
    return _pushed(setup, tilt[keep], offset[keep], spacing[keep], height[keep])


def _works(setup: Setup, tilt: float, offset: float, spacing: float, height: float) -> bool:
    upright = HALF_PI.mid
    leaning = PoseBox(x=setup.start.x, y=setup.start.y, theta=Interval.point(upright + float(tilt)))
    there = replace(setup, stated_spacing=Interval.point(float(spacing)))
    depth = setup.half_width.mid
    return sticks(upright, upright + tilt, offset, depth, setup) and straightens(
        height, leaning, there
    )


def _pushed(
    setup: Setup, tilt: Floats, offset: Floats, spacing: Floats, height: Floats
) -> YTranslations:
    depth, ratio, right = setup.half_width.mid, setup.uncertainty.film_ratio.mid, HALF_PI.mid
    travel, reach = values("sticking_motion", "travel"), values("sticking_motion", "contact_reach")
    (first,) = travel(theta_start=right, theta_end=right + tilt, d1=depth, d2=offset, rho=ratio)
    start = np.column_stack([np.zeros_like(tilt), np.zeros_like(tilt), np.full_like(tilt, right)])
    one = np.stack([np.full_like(tilt, depth), offset], axis=1)[:, None]
    tilted = _push(setup, start, one, first)
    rises = height - 0.5 * spacing, height + 0.5 * spacing
    (lower,) = reach(theta=right + tilt, d1=depth, rise=rises[0])
    pair = np.stack([np.stack([lower, rise], axis=1) for rise in rises], axis=1)
    pair += tilted[:, None, :2]
    (back,) = values("sticking_motion", "contact_offset")(
        theta=right + tilt, d1=depth, rise=rises[0]
    )
    (second,) = travel(theta_start=right + tilt, theta_end=right, d1=depth, d2=back, rho=ratio)
    righted = _push(setup, tilted, pair, second + ROOM)
    (theory,) = values("y_translation", "gain")(
        theta_0=right, theta_1=right + tilt, theta_2=right, d1=depth, d2=offset, d2_back=back
    )
    return YTranslations(
        arm_um=(offset - back) / units.UM,
        tilt_deg=np.degrees(tilt),
        theory_um=theory / units.UM,
        net=shown(righted - start),
    )


def _push(setup: Setup, poses: Floats, tips: Floats, travel: Floats) -> Floats:
    """(N, 3) poses after pushes along -x by tips that touch already."""
    way = np.zeros_like(tips)
    way[..., 0] = -travel[:, None]
    away = np.array([1e-9, 0.0])  # a tip that rounding has put inside the part could not start
    u = setup.uncertainty
    push = Push.straight(
        vertices=rectangle(setup),
        poses=poses,
        tips=tips + away,
        travel=way,
        friction=np.full(len(poses), u.friction.mid),
        film_ratio=np.full(len(poses), u.film_ratio.mid),
        step=2e-6,
    )
    return exact(push).poses
