"""Choosing a Y-translation: where to push for the tilt, how far, and where to straighten."""

from __future__ import annotations

import math
from functools import lru_cache

from meso_robust import units
from meso_robust.bounds import Verdict
from meso_robust.conditions import condition
from meso_robust.planning import nominal
from meso_robust.planning.clearance import errors_across, rise_of, start_ahead_um
from meso_robust.planning.sampling import REFINED, best_robust
from meso_robust.planning.x_translation import upright
from meso_robust.primitives.move import MoveRule, Point, from_part
from meso_robust.primitives.obligation import Step
from meso_robust.primitives.setup import PoseBox, Setup
from meso_robust.primitives.tilt import certify_tilt

GUESSED_BACK = 0.4  # share of the half depth at which the straightening push is first expected
LARGEST_TILT = 0.5  # rad


@lru_cache(maxsize=64)  # other plans begin with the same one
def y_translation(pre: PoseBox, setup: Setup, gain: float, step: int) -> tuple[Step, Step] | None:
    """The robust tilt and straightening that move the part across the push.

    Parameters
    ----------
    pre, setup
        All poses before them, and the task, in its axes.
    gain
        In y, about, m.
    step
        Of the paper's algorithm.

    Returns
    -------
    tuple or None
        Both moves, certified; None if none is found.
    """
    side = 1 if gain > 0.0 else -1
    back = GUESSED_BACK * setup.edge(pre.theta.mid).depth.mid
    found = None
    for refined in (0, REFINED):  # the second round knows where the straightening push lands
        tilted = _tilt(pre, setup, abs(gain), side, back, step, refined)
        if tilted is None or tilted.post is None:
            return None
        straight = upright(
            tilted.post,
            setup,
            step=step,
            primitive="y_translation",
            before=tilted.leaves,
            refined=refined,
        )
        if straight is None:
            return None
        back = _pushed_at(straight, tilted.post, setup, side)
        found = tilted, straight
    return found


def _tilt(
    pre: PoseBox, setup: Setup, gain: float, side: int, back: float, step: int, refined: int
) -> Step | None:
    """The robust tilt whose contact lies farthest from the middle: it needs the least travel."""
    edge = setup.edge(pre.theta.mid)
    spacing, half = setup.spacing.mid, edge.last.mid if side > 0 else -edge.first.mid

    def attempt(offset: float) -> tuple[float, Step] | None:
        cosine = 1.0 - gain / (offset + back)
        if not math.cos(LARGEST_TILT) < cosine < 1.0:
            return None
        tilt, start = math.acos(cosine), edge.angle(pre.theta).mid
        if not nominal.may_stick(
            (start, start + side * tilt), side * offset, edge.depth.mid, setup
        ):
            return None
        rule = _tilt_rule(offset, tilt, side, pre, setup, step)
        tilted = certify_tilt(rule, pre, setup, whole=False)
        return (offset, tilted) if tilted.verdict is Verdict.PROVED else None

    smallest = max(setup.uncertainty.probe_position.hi, 1e-6)
    return best_robust(max(half - spacing, 0.0), half, smallest, attempt, refined)


def _tilt_rule(
    offset: float, tilt: float, side: int, pre: PoseBox, setup: Setup, step: int
) -> MoveRule:
    edge, u = setup.edge(pre.theta.mid), setup.uncertainty
    y = from_part(units.to_um(side * (offset + 0.5 * setup.spacing.mid)))
    around = y.offset + errors_across(setup)
    ahead = start_ahead_um(tuple((s, rise_of(around, s, setup)) for s in (1, -1)), pre, setup)
    start = edge.angle(pre.theta).mid
    nominal = [start, start + side * tilt, edge.depth.mid, side * offset, u.film_ratio.mid]
    travel = float(condition("sticking_motion", "travel").function(nominal))
    return MoveRule(
        step=step,
        primitive="y_translation",
        action="tilt",
        side=side,
        dual=Point(x=from_part(ahead), y=y),
        dual_end=from_part(units.to_um(edge.depth.mid + u.tip_radius.mid - travel)),
    )


def _pushed_at(straight: Step, tilted: PoseBox, setup: Setup, side: int) -> float:
    """Distance from the middle, m, at which the straightening push touches first (nominal)."""
    edge = setup.edge(tilted.theta.mid)
    angle = edge.angle(tilted.theta).mid
    tip = -side * 0.5 * setup.spacing.mid
    rise = straight.rule.dual.y.offset.mid + tip
    out = edge.depth.mid + setup.uncertainty.tip_radius.mid
    touch = condition("sticking_motion", "contact_offset").function([angle, out, rise])
    return -side * float(touch)
