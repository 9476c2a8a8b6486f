"""Proofs that a push fails: at one admissible value of the uncertainties, for a whole cell.

Each test takes the motion that the primitive claims, encloses it for all pushes and poses of the
cell at one value of the uncertainties, and looks for a place where it violates the laws of contact
for all of them. There it contradicts itself, so the claim is false at every point of the cell.
Conditions that are merely sufficient (uniqueness, monotony) are never held against a push.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence

from meso_robust.bounds import HALF_PI, Box, Interval, enclose, enclose_rows
from meso_robust.bounds.interval import cos
from meso_robust.conditions import condition
from meso_robust.feasible_regions.cells import Corner
from meso_robust.motion import sticking
from meso_robust.primitives.move import MoveRule
from meso_robust.primitives.outline import Edge
from meso_robust.primitives.setup import PoseBox, Setup
from meso_robust.primitives.tips import one_contact, second_tip, tip_of, touch, touching

POINTS_TO_THE_END = 4


def violated(module: str, name: str, boxes: Sequence[Box]) -> bool:
    """Whether some output of a generated condition is negative at every point of one of some boxes."""
    of = condition(module, name)
    rows = [{key: box[key] for key in of.inputs} for box in boxes]
    found = enclose_rows(of, {}, rows, boxes=8) if rows else []
    return any(output.hi < 0.0 for row in found for output in row)


def misses(offset: Interval, edge: Edge) -> bool:
    """Whether every offset lies beyond an end of the edge."""
    return offset.lo > edge.half.hi or offset.hi < -edge.half.hi


def slips(contacts: Sequence[Box]) -> bool:
    """Whether one of some contacts (`tips.one_contact`) cannot push, stick and turn the part to its side."""
    return any(
        violated("one_point_sticking", name, contacts)
        for name in ("friction_margin", "turning", "normal_force")
    )


def tilt_fails(rule: MoveRule, pre: PoseBox, points: Sequence[Corner]) -> bool:
    """Whether one of the ``points`` breaks the tilt for all commands of ``rule`` from ``pre``.

    The end of the push, which takes longer to enclose, is looked at for the first points only.
    """
    # errors along the push, which every second point changes, do not matter at the touch
    return any(_fails_at_touch(rule, pre, at) for at in points[::2]) or any(
        _fails_at_end(rule, pre, at) for at in points[:POINTS_TO_THE_END]
    )


def _fails_at_touch(rule: MoveRule, pre: PoseBox, at: Corner) -> bool:
    side, edge, setup = rule.side, at.setup.edge(pre.theta.mid), at.setup
    start = edge.angle(pre.theta)
    offset, _ = touch(tip_of(rule, -side, pre, setup), start, edge)
    return (
        misses(offset, edge)
        or slips([one_contact(start, offset, side, edge, setup)])
        or _struck(start, offset, side, edge, setup)
    )


def _fails_at_end(rule: MoveRule, pre: PoseBox, at: Corner) -> bool:
    side, edge, setup = rule.side, at.setup.edge(pre.theta.mid), at.setup
    offset, _ = touch(tip_of(rule, -side, pre, setup), edge.angle(pre.theta), edge)
    end = tilt_end(rule, pre, at)
    return end is not None and (
        slips([one_contact(end, offset, side, edge, setup)])
        or _struck(end, offset, side, edge, setup)
    )


def tilt_end(rule: MoveRule, pre: PoseBox, at: Corner) -> Interval | None:
    """Angles of the edge after the tilt, if it keeps its claim; None if they cannot be enclosed."""
    side, edge = rule.side, at.setup.edge(pre.theta.mid)
    pusher, start = tip_of(at.rule(rule), -side, pre, at.setup), edge.angle(pre.theta)
    offset, reach = touch(pusher, start, edge)
    travel, ratio = reach - pusher.ahead_end, at.setup.uncertainty.film_ratio
    widest = start.hull(start + Interval.point(side * sticking.LARGEST_TURN))
    if not travel.lo > 0.0:
        return None
    if not sticking.travel_monotone(widest, side, edge.depth, offset, ratio):
        return None
    end = sticking.turned(start, travel, side, edge.depth, offset, ratio)
    return end if end.width < math.inf else None


def _struck(angle: Interval, offset: Interval, side: int, edge: Edge, setup: Setup) -> bool:
    """Whether the idle tip of a tilt is inside the part: behind the edge's line, between its ends."""
    dx, dy = second_tip(-side, setup)
    box = {
        "theta": angle,
        "d2": offset,
        "half": edge.half,
        "dx": dx,
        "dy": dy,
        "side": Interval.point(float(side)),
    }
    behind, beyond = enclose(condition("sticking_motion", "beside"), box, boxes=8)
    on_edge = (Interval.point(float(side)) * offset).lo > -edge.half.lo
    return on_edge and behind.hi < 0.0 and beyond.hi < 0.0


def straighten_fails(rule: MoveRule, cases: Iterable[tuple[PoseBox, Corner]]) -> bool:
    """Whether a t^2 push fails for all commands of ``rule``, from some pose and at some of what is uncertain."""
    leaning: list[tuple[Interval, int, Edge, Setup]] = []
    places: list[Box] = []
    for pre, at in cases:
        setup, edge = at.setup, at.setup.edge(pre.theta.mid)
        start = edge.angle(pre.theta)
        aligned = HALF_PI + setup.uncertainty.misalignment
        side = int(start.hi < aligned.lo) - int(start.lo > aligned.hi)
        if side == 0:
            continue  # either tip can be first
        leaning.append((start, side, edge, setup))
        places.append(touching(rule, side, pre, start, edge, setup))
    alone: list[Box] = []
    together: list[Box] = []
    offsets = sticking.contact_offsets(places) if places else []
    for offset, (start, side, edge, setup) in zip(offsets, leaning, strict=True):
        beta = setup.uncertainty.misalignment
        other = offset - Interval.point(float(side)) * (setup.spacing / cos(beta))
        if misses(offset, edge) or misses(other, edge):
            return True
        angles = start, HALF_PI + beta
        alone += [one_contact(angle, offset, side, edge, setup) for angle in angles]
        together.append(
            {
                "beta": beta,
                "mu": setup.uncertainty.friction,
                "d1": edge.depth,
                "d2": offset if side > 0 else other,
                "d4": setup.spacing,
            }
        )
    return (
        slips(alone)
        or violated("two_point_sticking", "normal_forces", together)
        or violated("two_point_sticking", "friction_margin", together)
    )
