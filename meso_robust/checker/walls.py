"""No collision with the slot: every pose of a move, and every way of a tip, is beside each wall.

Two convex polygons are apart if all corners of one lie beyond a side of the other; of a part that is
not convex its convex hull is taken. A part that is not as stated lies within as much around it as a
corner can be astray, a tip within its radius around its centre. What is swept is enclosed in boxes of poses, from the checker's own path of the move; a box
that no side decides is cut.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator
from functools import partial

from flint import arb

from meso_robust.checker import statement as st
from meso_robust.checker.contact import off_line
from meso_robust.checker.dual import Dual, Point
from meso_robust.checker.ids import Must, Named, named
from meso_robust.checker.inputs import Block, Given, PoseBox
from meso_robust.checker.outline import Edge
from meso_robust.checker.passage import Passage, Sweep
from meso_robust.checker.pushing import UNIT
from meso_robust.checker.ranges import (
    ZERO,
    Box,
    Formula,
    Side,
    halved,
    least,
    positive,
    side_of,
    span,
    whole,
)
from meso_robust.checker.refusal import Refused
from meso_robust.checker.requirement import Requirement
from meso_robust.checker.scene import Scene

CUTS = 6
"""Cuts for a side of a box; it may be too wide."""
PIECES = 400
"""Pieces of a box that are looked at before a question stays open."""
FEW = 8
"""The same while the box may still be too wide since its stage has not been cut enough."""
STAGE = 64
"""Boxes of a stage of a move that are looked at before its question stays open."""
POINTS = 8
"""Poses along a stage with which a stated bound is compared."""
NEAR = 1e-7
"""How closely the sides of a box are bounded, m and rad."""
SIGNS = (-1, 1)
Way = tuple[Side, Side]
"""Where the centre of a tip can be on its way, x and y in world axes, m."""
Verify = Callable[[Box, arb], bool]


def clear_of_walls(scene: Scene, passage: Passage, given: Given) -> tuple[Requirement, ...]:
    """Prove that neither the part nor a tip touches a wall during a move; of a guided one that no tip does.

    Parameters
    ----------
    scene, passage, given
        The move, what was verified of it, and the task.

    Returns
    -------
    tuple[Requirement, ...]
        What was proved, as a certificate lists it; nothing if there is no wall.

    Raises
    ------
    Refused
        It does not follow.
    """
    if not given.blocks:
        return ()
    sweeps, ways = (_rest(scene), *passage.swept), _ways(scene)
    radius = given.radius[1].max(given.passive_radius[1])
    certain = [box for sweep in sweeps if sweep.exact for box in _nominal(scene, sweep)]

    def part_apart(boxes: list[Box], above: arb) -> bool:
        return all(apart(box, block, given, above) for box in boxes for block in given.blocks)

    def tips_apart(ways: list[Way], above: arb) -> bool:
        return all(beside(way, block, radius + above) for way in ways for block in given.blocks)

    if not passage.guided:
        _expect(
            named(Must.PART_CLEAR_OF_WALLS),
            all(_passes(scene, one, given) for one in sweeps),
        )
    _expect(named(Must.TIPS_CLEAR_OF_WALLS), tips_apart(ways, ZERO))
    part = _requirement(
        named(Must.PART_CLEAR_OF_WALLS),
        st.PART_CLEAR,
        ("x", "y", "theta"),
        lambda box, bound: part_apart([*certain, box], bound),
    )
    tips = _requirement(
        named(Must.TIPS_CLEAR_OF_WALLS),
        st.TIPS_CLEAR,
        ("x", "y"),
        lambda box, bound: tips_apart([*ways, (box["x"], box["y"])], bound),
    )
    return (tips,) if passage.guided else (part, tips)


def meets_a_wall(scene: Scene, passage: Passage, given: Given) -> bool:
    """Whether a pose that the part takes for certain has a corner of the part within a wall.

    Only of stages whose every point is a motion that can be; as corner and wall are apart at first,
    the part then touches the wall.
    """
    poses = (
        _in_world(scene, sweep, {**sweep.box, sweep.along: now})
        for sweep in passage.swept
        if sweep.exact
        for now in _instants(sweep)
    )
    return any(_enters(box, block, given) for box in poses for block in given.blocks)


def _enters(box: Box, block: Block, given: Given) -> bool:
    """Whether a corner of the convex hull, which is one of the part, is within a wall at each pose."""
    sides = list(_block_sides(block, given))
    corners = zip(*sides, strict=True)  # of each corner, how far it is beyond the four sides

    astray = _astray(given)

    def short(of: Formula) -> Formula:
        return lambda at: -of(at) - astray

    return any(all(positive(short(of), box) for of in beyond) for beyond in corners)


def _expect(must: Named, holds: bool) -> None:
    if not holds:
        raise Refused(must, "apart from each wall", "not shown")


def _requirement(
    must: Named, statement: st.Statement, keys: tuple[str, ...], verify: Verify
) -> Requirement:
    def named(box: Box, bound: arb) -> bool:
        if set(box) != set(keys):
            raise Refused(must.value("over"), sorted(box), sorted(keys))
        return verify(box, bound)

    return Requirement(name=must, statement=statement, parts=(), verify=named)


def _rest(scene: Scene) -> Sweep:
    """All poses before the move."""
    return Sweep(lambda at: (at["x"], at["y"], at["theta"]), scene.box, "theta", exact=True)


def _passes(scene: Scene, sweep: Sweep, given: Given) -> bool:
    """Whether the part is apart from each wall during a stage."""
    left = [sweep.box]
    for _ in range(STAGE):
        if not left:
            return True
        piece = left.pop()
        if not _is_apart(scene, sweep, piece, given):
            if not _is_apart(scene, sweep, _middle(piece), given):
                return False  # no cut would help
            left += halved(piece, sweep.along)
    return not left


def _is_apart(scene: Scene, sweep: Sweep, piece: Box, given: Given) -> bool:
    box = _in_world(scene, sweep, piece)
    return all(apart(box, block, given, pieces=FEW) for block in given.blocks)


def _middle(box: Box) -> Box:
    return {name: side_of(((low + high) / 2).mid()) for name, (low, high) in box.items()}


def _nominal(scene: Scene, sweep: Sweep) -> Iterator[Box]:
    """Poses that the part does take, with all errors in the middle of their ranges.

    They show a stated bound to be too large; nothing else rests on them.
    """
    for now in _instants(sweep):
        yield _in_world(scene, sweep, {**_middle(sweep.box), sweep.along: now})


def _instants(sweep: Sweep) -> Iterator[Side]:
    """Values of the variable along a stage, from its start to its end."""
    low, high = sweep.box[sweep.along]
    for k in range(POINTS + 1):
        yield side_of(low + (high - low) * k / POINTS)


def _world(scene: Scene, sweep: Sweep, at: Point) -> Point:
    """A pose in world axes."""
    x, y, edge = sweep.pose(at)
    theta = edge + scene.turn
    if scene.frame.mirrored:
        y, theta = -y, -theta
    for _ in range(scene.frame.quarters):
        x, y, theta = -y, x, theta + arb.pi() / 2
    return {"x": x, "y": y, "theta": theta}


def _in_world(scene: Scene, sweep: Sweep, box: Box) -> Box:
    """Poses in world axes, as a box."""

    def coordinate(key: str, at: Point) -> Dual:
        return _world(scene, sweep, at)[key]

    return {key: _around(partial(coordinate, key), box) for key in ("x", "y", "theta")}


def _around(of: Formula, box: Box) -> Side:
    """Bounds of a formula, close enough."""
    low = least(of, box, within=NEAR, cuts=CUTS)
    return low, -least(lambda at: -of(at), box, within=NEAR, cuts=CUTS)


def _ways(scene: Scene) -> list[Way]:
    """Where the tips can be, both tips of the active probe on their travel and the passive one."""
    box = {**scene.box, "share": UNIT}

    def place(side: int, axis: int, at: Point) -> Dual:
        first = scene.ahead(at, side)
        x = first + at["share"] * (scene.ahead_end(at, side) - first)
        return at["xy"[axis]] + scene.from_travel(at, x, scene.rise(at, side))[axis]

    def placed(x: Formula, y: Formula) -> Way:
        own = PoseBox(x=span(x, box), y=span(y, box), theta=side_of(ZERO))
        world = scene.frame.world(own)
        return world.x, world.y

    ways = [placed(partial(place, side, 0), partial(place, side, 1)) for side in SIGNS]
    if scene.rule.single_x is not None:
        passive_x: Formula = lambda at: at["x"] + scene.passive_ahead(at)  # noqa: E731
        ways.append(placed(passive_x, lambda at: at["y"] + scene.passive_rise(at)))
    return ways


def beside(way: Way, block: Block, above: arb) -> bool:
    """Whether a whole way is farther than ``above`` from a wall, along x or along y."""
    gaps = [gap for one, other in zip(way, block, strict=True) for gap in _gaps(one, other)]
    return any(gap > above for gap in gaps)


def _gaps(one: Side, other: Side) -> tuple[arb, arb]:
    return one[0] - other[1], other[0] - one[1]


def apart(box: Box, block: Block, given: Given, above: arb = ZERO, *, pieces: int = PIECES) -> bool:
    """Whether the part is farther than ``above`` from a wall, along one side of either, at each pose.

    Parameters
    ----------
    box
        Poses of the part: ``x``, ``y`` and ``theta``, world axes.
    block, given
        The wall and the task.
    above
        A distance, m.
    pieces
        How many parts of the box may be looked at.
    """
    if not all(end.is_finite() for side in box.values() for end in side):
        return False
    sides, above = [*_block_sides(block, given), *_part_sides(block, given)], above + _astray(given)
    left = [box]
    for _ in range(pieces):
        if not left:
            return True
        piece = left.pop()
        if not any(_beyond(corners, piece, above) for corners in sides):
            left += halved(piece, _widest(piece, given))
    return not left


def _astray(given: Given) -> arb:
    """How far outside its stated outline the part can be, m."""
    return given.outline.astray(given.size, given.squareness) if _varies(given) else ZERO


def _varies(given: Given) -> bool:
    return not all(end == 0 for end in (*given.size, *given.squareness))


def _beyond(corners: list[Formula], box: Box, above: arb) -> bool:
    def spare(of: Formula, at: Point) -> Dual:
        return of(at) - above

    return all(positive(partial(spare, of), box, cuts=0) for of in corners)


def _block_sides(block: Block, given: Given) -> Iterator[list[Formula]]:
    """How far each corner of the part is beyond a side of the wall; one list a side."""

    def beyond(axis: int, sign: int, corner: tuple[arb, arb], at: Point) -> Dual:
        s, c = at["theta"].sin_cos()
        along, across = corner
        place = (at["x"] + c * along - s * across, at["y"] + s * along + c * across)
        return (place[axis] - block[axis][(sign + 1) // 2]) * sign

    corners = given.outline.hull
    for axis, sign in itertools.product((0, 1), SIGNS):
        yield [partial(beyond, axis, sign, corner) for corner in corners]


def _part_sides(block: Block, given: Given) -> Iterator[list[Formula]]:
    """How far each corner of the wall is beyond a side of the part; one list a side."""

    def beyond(side: Edge, corner: tuple[arb, arb], at: Point) -> Dual:
        s, c = (at["theta"] - side.turn).sin_cos()
        return off_line(c, s, corner[0] - at["x"], corner[1] - at["y"]) - side.d1

    corners = list(itertools.product(*block))
    for side in given.outline.sides(given.outline.facing(arb(0))):
        yield [partial(beyond, side, corner) for corner in corners]


def _widest(box: Box, given: Given) -> str:
    """Along which variable a corner of the part moves most."""
    arm = {"x": arb(1), "y": arb(1), "theta": given.outline.reach}
    return max(box, key=lambda name: float((whole(box[name]).rad() * arm[name]).mid()))
