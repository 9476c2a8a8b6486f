"""No collision with the slot: the part over its tube, and the tips over their ways.

Two convex sets are apart when they are apart along some direction (separating axis); for two
polygons the directions of their sides are enough (of a part that is not convex, its convex hull is
taken). Over a box of poses the distance along
every direction is bounded from below; a box that none of them decides is split.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable, Iterator

from meso_robust.bounds import Interval, arithmetic as ia
from meso_robust.bounds.interval import cos, sin
from meso_robust.primitives.move import MoveRule, Point
from meso_robust.primitives.names import Inequality, ObligationId, about
from meso_robust.primitives.obligation import Knot, Obligation, require_order
from meso_robust.primitives.outline import Polygon
from meso_robust.primitives.setup import Block, PoseBox, Setup
from meso_robust.primitives.tips import HALF, astray

MOST_SPLITS = 400  # of one slice against one wall; beyond it the pair stays undecided
TOLD = 0.999  # of a polygon's distance: where a corner passes its highest point, another careful
# enclosure of the same distance is a little smaller


def stands_clear(setup: Setup) -> bool:
    """Whether the part is proved to touch no wall at its start.

    Parameters
    ----------
    setup
        Of a task.

    Returns
    -------
    bool
        True without walls.
    """
    return all(_separation(setup.start, block, setup) > 0.0 for block in setup.blocks)


def part_clear(tube: Iterable[Knot], setup: Setup) -> Obligation:
    """The part touches no wall anywhere in its tube (world frame); undecided if there is no tube."""
    distance = math.inf
    box: PoseBox | None = None
    for knot, block in itertools.product(tube, setup.blocks):
        apart = _separation(knot.box, block, setup)
        if apart < distance:
            distance, box = apart, knot.box
        if distance == -math.inf:
            break
    if box is None:
        distance = -math.inf
    return require_order(
        about(ObligationId.PART_CLEAR_OF_WALLS),
        Inequality.PART_TO_WALL,
        Interval(distance, math.inf),
        {} if box is None else {"x": box.x, "y": box.y, "theta": box.theta},
    )


def tips_clear(rule: MoveRule, pre: PoseBox, setup: Setup) -> Obligation:
    """The tips touch no wall between start and end of their travel.

    Parameters
    ----------
    rule
        The move.
    pre, setup
        All poses before it and the task, in the axes of the move (the walls in the world's).
    """
    ways = [(*rule.frame.point_to_world(x, y), radius) for x, y, radius in _ways(rule, pre, setup)]
    found = [
        (float(ia.down(_beside(x, y, block) - radius.hi)), x, y)
        for x, y, radius in ways
        for block in setup.blocks
    ]
    distance, x, y = min(found, key=lambda one: one[0])
    return require_order(
        about(ObligationId.TIPS_CLEAR_OF_WALLS),
        Inequality.TIP_TO_WALL,
        Interval(distance, math.inf),
        {"x": x, "y": y},
    )


def _ways(
    rule: MoveRule, pre: PoseBox, setup: Setup
) -> Iterator[tuple[Interval, Interval, Interval]]:
    """Boxes that hold every way of the centre of every tip, in the axes of the move, and its radius."""
    u = setup.uncertainty
    sensed, off = u.sensed_position, u.probe_position + u.probe_wander
    short_x, astray_y = astray(rule, pre, setup)
    first = rule.dual.x.place(pre.x, sensed, off)
    last = rule.dual_end.place(pre.x, sensed, off) + short_x
    y = rule.dual.y.place(pre.y, sensed, off)
    for side in (1.0, -1.0):
        up = Interval.point(side) * HALF * setup.spacing
        lag = up * sin(u.misalignment) / cos(u.misalignment)
        yield first.hull(last) - lag, y.hull(y + astray_y) + up, u.tip_radius
    if rule.single is not None:
        yield (*_place(rule.single, pre, setup), u.passive_tip_radius)


def _place(point: Point, pre: PoseBox, setup: Setup) -> tuple[Interval, Interval]:
    sensed, off = setup.uncertainty.sensed_position, setup.uncertainty.probe_position
    return point.x.place(pre.x, sensed, off), point.y.place(pre.y, sensed, off)


def _beside(x: Interval, y: Interval, block: Block) -> float:
    """Lower bound of the distance of a point from a wall along x or y, m."""
    return max(_gap(x, block.x).lo, _gap(y, block.y).lo)


def _gap(one: Interval, other: Interval) -> Interval:
    """Distance of two ranges where positive: from ``one`` (any of its numbers) to all of ``other``."""
    above = one - Interval.point(other.hi)
    below = Interval.point(other.lo) - one
    return above if above.lo >= below.lo else below


def _separation(box: PoseBox, block: Block, setup: Setup) -> float:
    """Lower bound of the distance along the best direction over all poses, m; -inf if undecided."""
    open_, least, splits = [box], math.inf, 0
    while open_:
        one = open_.pop()
        apart = _apart(one, block, setup)
        if apart > 0.0:
            least = min(least, apart)
            continue
        splits += 1
        if splits > MOST_SPLITS or not _size(one) < math.inf:
            return -math.inf
        if not _apart(_centre(one), block, setup) > 0.0:
            return -math.inf  # no part of the box that holds this pose can be proved
        open_ += _halves(one, setup)
    return least


def _apart(box: PoseBox, block: Block, setup: Setup) -> float:
    """Lower bound of the largest of the distances that holds for a whole box, m."""
    part = setup.body
    if isinstance(part, Polygon):
        found = max(_beyond_wall(box, block, part), _beyond_part(box, block, part))
        return found * TOLD if found > 0.0 else found
    a, b, c, s = part.half_length, part.half_width, cos(box.theta), sin(box.theta)
    along, across = _size_of(c), _size_of(s)
    reach_x, reach_y = a * along + b * across, a * across + b * along
    half_x, half_y = _half(block.x), _half(block.y)
    x, y = box.x - _middle(block.x), box.y - _middle(block.y)
    forward = _size_of(x * c + y * s) - a - (half_x * along + half_y * across)
    sideways = _size_of(y * c - x * s) - b - (half_x * across + half_y * along)
    distances = (
        _size_of(x) - half_x - reach_x,
        _size_of(y) - half_y - reach_y,
        forward,
        sideways,
    )
    return max(distance.lo for distance in distances)


def _beyond_wall(box: PoseBox, block: Block, part: Polygon) -> float:
    """Lower bound of how far all corners of the part are beyond the best side of the wall, m."""
    c, s = cos(box.theta), sin(box.theta)
    xs = [box.x + c * x - s * y for x, y in part.hull]
    ys = [box.y + s * x + c * y for x, y in part.hull]
    return max(
        min(side.lo for side in sides)
        for wall, places in ((block.x, xs), (block.y, ys))
        for sides in (
            [place - Interval.point(wall.hi) for place in places],
            [Interval.point(wall.lo) - place for place in places],
        )
    )


def _beyond_part(box: PoseBox, block: Block, part: Polygon) -> float:
    """Lower bound of how far all corners of the wall are off the best side of the part's hull, m."""
    corners = [
        (Interval.point(x) - box.x, Interval.point(y) - box.y)
        for x in (block.x.lo, block.x.hi)
        for y in (block.y.lo, block.y.hi)
    ]
    distances = []
    for line in part.lines:
        angle = line.angle(box.theta)
        c, s = cos(angle), sin(angle)
        distances.append(min((s * x - c * y - line.depth).lo for x, y in corners))
    return max(distances)


def _middle(range_: Interval) -> Interval:
    return HALF * (Interval.point(range_.lo) + Interval.point(range_.hi))


def _half(range_: Interval) -> Interval:
    return HALF * (Interval.point(range_.hi) - Interval.point(range_.lo))


def _size_of(value: Interval) -> Interval:
    """Absolute value."""
    if value.lo >= 0.0:
        return value
    return -value if value.hi <= 0.0 else Interval(0.0, max(-value.lo, value.hi))


def _centre(box: PoseBox) -> PoseBox:
    x, y, theta = (Interval.point(side.mid) for side in (box.x, box.y, box.theta))
    return PoseBox(x=x, y=y, theta=theta)


def _size(box: PoseBox) -> float:
    return max(box.x.width, box.y.width, box.theta.width)


def _halves(box: PoseBox, setup: Setup) -> list[PoseBox]:
    """A box cut in two where it is widest for the corners of the part."""
    turn = box.theta.width * setup.outline.reach
    if turn >= max(box.x.width, box.y.width):
        return [PoseBox(x=box.x, y=box.y, theta=half) for half in _cut(box.theta)]
    if box.x.width >= box.y.width:
        return [PoseBox(x=half, y=box.y, theta=box.theta) for half in _cut(box.x)]
    return [PoseBox(x=box.x, y=half, theta=box.theta) for half in _cut(box.y)]


def _cut(range_: Interval) -> tuple[Interval, Interval]:
    middle = min(max(range_.mid, range_.lo), range_.hi)
    return Interval(range_.lo, middle), Interval(middle, range_.hi)
