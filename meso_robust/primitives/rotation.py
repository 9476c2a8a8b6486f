"""Two-sided rotation: from an upright part to a nearly horizontal one (paper, Fig. 11 left).

The lower tip of the active probe pushes the right-hand edge above the middle, the passive tip holds
the left-hand one below it. First the active tip alone pushes until the part rests on the passive
one; then both touch, the orientation is kinematic and the slide is enclosed although the motion
need not be unique (``meso_robust.motion.two_sided``).
"""

from __future__ import annotations

import functools
import itertools
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from meso_robust.bounds import (
    HALF_PI,
    Bounded,
    Interval,
    Verdict,
    enclose,
    enclose_rows,
    enclose_where,
)
from meso_robust.bounds.interval import arcsin, cos, sin
from meso_robust.motion import one_tip
from meso_robust.motion.two_sided import (
    Cell,
    Grip,
    Line,
    SlideTube,
    TubeStatus,
    cut,
    enclose_slide,
)
from meso_robust.primitives.approach import STATED, Touch, approach
from meso_robust.primitives.base import base_box, free_at_start, stated
from meso_robust.primitives.force import squeeze_below_cap
from meso_robust.primitives.grasp import Relations, aims_of, on_line, ranges, relations
from meso_robust.primitives.move import Anchor, MoveRule
from meso_robust.primitives.names import (
    Inequality,
    Named,
    ObligationId,
    Property,
    When,
    Which,
    about,
)
from meso_robust.primitives.obligation import Knot, Obligation, Step, require, require_order
from meso_robust.primitives.outline import Edge
from meso_robust.primitives.setup import ZERO, PoseBox, Setup
from meso_robust.primitives.tips import comes_free, second_tip

PI = HALF_PI + HALF_PI
EARLY = 4  # slices in which the idle tip is beyond the end of the edge rather than off its line
CELL = 1.0 / 360.0
"""Of the part's width: room of the tips that is followed together; more is looser."""
ROUGH, LONGER = 4.0, 2.0
"""Times that for rough bounds, and longer steps where each tip has its own friction: a fifth of the work."""
AT_END = 4096
"""Boxes for the pose at the end."""
ROOM, ROOM_WIDE = 0.02, 0.55
"""Share of a side of the pose at the end, on top of that of all moves: at least, and per range of the room over
the part's width. A checker's barriers are as close where the room alone is uncertain, but for terms of second
order in it: 0.019 was needed for the paper's task, 0.027 where the room's range is 0.052 of the width."""
ROOM_ROUND, ROOM_ROUND_ASIDE = 0.04, 0.06
"""The same at least of round tips, along and across the push: 0.027 and 0.042 were needed of a long part
whose friction is known to 1 %."""
ROOM_ELSE, ROOM_AHEAD = 0.09, 0.14
"""The same where other constants are uncertain as well, across and along the push, where the slide is all that
is uncertain. 0.05 and 0.104 were seen of tubes that were up to 4 % wider."""
WIDE_ROOM, PARTS = 0.05, 24
"""Where the room of the tips is uncertain by more, over the part's width, where a rotation ends is bounded more
closely, with the room in so many parts."""
PLACED_AHEAD, PLACED_ASIDE = (0.28, 0.03), (0.03, 0.23)
"""The same at either end of what is found so, along and across the push. A checker's barriers are without parts of
the room: the one that the slide does not fall below lies much farther out, the other one hardly. They do not always need
as much: 0.11 ahead and 0.02 aside for a plate and tips of 1 to 15 um."""
ROOM_LEAST, ROOM_LEAST_AHEAD = 0.001, 0.008
"""The same of a polygon at least, over the part's width: what barriers differ by where friction is known closely.
0.0007 and 0.0053 were seen."""
ROOM_CLOSE, ROOM_WITHIN, ROOM_ON_EDGE = 0.0103, 0.4, 0.0015
"""The same where the slide alone is uncertain, and closely known: along the push at least, over the part's width,
less a share of how wide the tube gets; and then of the tube. What barriers differ by shows there: 3.4, 3.6, 4.3
and 4.5 um were needed of tubes of 13, 9, 6 and 4.5 um, of a part of 837 um, and 1.2 um of a tube."""
EXACT = 1e-12
"""m, or rad: a width that is rounding only."""
BEYOND = 0.03
"""Of the first h: how much farther out others may put the first grip."""
NARROWED = 4
"""Times that either end of what the room depends on is cut off, where the room is known."""
UNCHECKED = 1  # knots; see `two_sided.CHECKED`
SLICES = 24  # of the tube that is told: a slice then turns by about 4 deg, so boxes stay narrow
IDLE = 1  # the upper tip of the active probe touches nothing
MOST_LEAN = 0.5 * HALF_PI.lo  # rad out of parallel, beyond which two edges are no opposite ones


@dataclass(frozen=True, slots=True, kw_only=True)
class Move:
    """A rotation to be proved."""

    box: Mapping[str, Interval]
    """What is known of it (`grasp.ranges`)."""
    of: Relations
    edge: Edge
    far: Edge
    """The edge that the passive tip holds."""
    lean: Interval
    """Its direction less that of the pushed edge as stated, rad."""
    setup: Setup
    V: Interval
    """Distance of both tips across the travel, m."""
    room: Interval
    """V less both radii and depths, m."""
    labels: Mapping[str, Interval]
    """y of the part minus y of the passive tip (m) and the angle of the pushed edge, before the move."""
    h_end: Interval
    first_gap: Interval
    """Of the passive tip to its edge, m."""
    flight: Interval
    """Travel of the active tip before it touches, m."""
    travel: Interval
    """All of its travel, m."""

    @property
    def squareness(self) -> Interval:
        """By how much an edge is turned from its stated direction, rad."""
        return self.setup.uncertainty.squareness

    @property
    def grip(self) -> Grip:
        """What is known while both tips turn the part."""
        box, setup = self.box, self.setup
        return Grip(
            room=self.room,
            depth=box["depth"],
            depth_far=box["depth_far"],
            ends=(self.edge.first, self.edge.last),
            # run the other way
            ends_far=(-self.far.last, -self.far.first),
            rho=box["rho"],
            mu=setup.uncertainty.friction,
            common=setup.friction_common,
            radius=box["radius_lower"],
            radius_far=box["radius_passive"],
            kappa=box["kappa_far"] - box["kappa"]
            if (box["kappa_far"], box["kappa"]) != (ZERO, ZERO)
            else ZERO,
            **{
                name: box[name]
                for name in (
                    "drag_a",
                    "drag_n",
                    *one_tip.CENTRE,
                    "stretch",
                    "shear",
                    "bend",
                    "sway",
                )
            },
        )


def certify_rotation(rule: MoveRule, pre: PoseBox, setup: Setup, *, rough: bool = False) -> Step:
    """Certify a counter-clockwise two-sided rotation from every pose in ``pre``.

    Parameters
    ----------
    rule, pre, setup
        The move (``side`` = 1, with a passive tip), all poses before it, the task; all in the
        move's axes.
    rough
        Whether looser bounds will do, at a fifth of the work, and nothing but whether all is proved is asked.

    Returns
    -------
    Step
        In the move's axes; without a ``post`` where the motion could not be enclosed.

    Raises
    ------
    ValueError
        If the rule is not a counter-clockwise rotation with a passive tip.
    """
    move, obligations = as_begun(rule, pre, setup)
    hasty, grip, edge = rough, move.grip, move.edge
    if not (opposite(move.lean, setup) and move.V.lo > 0.0) or (
        hasty and not all_proved(obligations)
    ):
        return _step(rule, pre, None, obligations)
    touch = approach(move.box, grip, move.labels, move.first_gap, edge, move.of)
    if touch is None:
        return _step(rule, pre, None, [*obligations, _undecided(ObligationId.COMES_TO_REST)])
    h_start = touch.start.h
    rests = require_order(
        about(ObligationId.RESTS_BEFORE_END),
        Inequality.TOUCH_BEFORE_END,
        before_end(h_start, move.h_end) * STATED,
        {"h_start": h_start + Interval(-h_start.width, h_start.width), "h_end": move.h_end},
    )
    obligations += [*touch.obligations, rests]
    if not all_proved(obligations if hasty else [rests]):
        return _step(rule, pre, None, obligations)
    alone = _alone(grip)
    rough = rough or not alone
    tube, parts = _tube(move, touch, rough=rough)
    if tube.status is not TubeStatus.COMPLETE:
        return _step(rule, pre, None, [*obligations, *_tube_obligations(tube, move)])
    (at_end,) = _held(move.of.end, parts, tube, [move.h_end], AT_END)
    if at_end is None:
        obligations += [*_tube_obligations(tube, move), _undecided(ObligationId.END_ENCLOSED)]
        return _step(rule, pre, None, obligations)
    ahead, aside, wider = _for_others(move, tube, at_end.pose, rough=rough)
    obligations += _tube_obligations(tube, move, wider)
    slices = _slices(parts, tube)
    obligations += idle_tip_clear(move, touch, slices, at_end)
    faced = facing(move, at_end.edge_angle)
    faced = faced.hull(faced + move.lean)
    obligations.append(_of_move(move, comes_free(Which.BOTH, faced)))
    obligations += squeeze_below_cap(max(touch.largest_force, tube.largest_force), setup)
    knots = Knot(stage="the active tip pushes alone", box=touch.poses.hull(pre))
    pose = at_end.pose
    post = replace(pose, x=_roomy(pose.x, ahead, ahead), y=_roomy(pose.y, aside, aside))
    if not (hasty or alone) and grip.room.width > WIDE_ROOM * _width(grip):
        post = _placed(move, touch, post)
    return _step(rule, pre, post, obligations, (knots, *_knots(slices)))


def _alone(grip: Grip) -> bool:
    """Whether nothing but the room of the tips is uncertain of all that is constant."""
    return all(side.width <= EXACT for name, side in grip.constants().items() if name != "room")


def _width(grip: Grip) -> float:
    """Of the part, m."""
    return grip.depth.mid + grip.depth_far.mid


def _for_others(
    move: Move, tube: SlideTube, pose: PoseBox, *, rough: bool
) -> tuple[float, float, float]:
    """What others, who enclose the slide by other barriers, need: shares of x and y at the end; m of the tube."""
    grip, width = move.grip, _width(move.grip)
    alone, wide = _alone(grip), ROOM_WIDE * grip.room.width / width
    round_tips = not grip.radius == grip.radius_far == ZERO
    least = (ROOM_ROUND, ROOM_ROUND_ASIDE) if round_tips else (ROOM, ROOM)
    ahead, aside = [max(wide, one) for one in least] if alone else (ROOM_AHEAD, ROOM_ELSE)
    # rough tubes are wider than those of others
    wider = 0.0 if rough else ahead * tube.widest
    close = (ROOM_CLOSE * width - ROOM_WITHIN * tube.widest) / pose.x.width
    if alone and close > ahead:
        ahead, wider = close, max(wider, ROOM_ON_EDGE * width)
        aside = max(aside, ROOM_LEAST * width / pose.y.width)
    if move.edge.beyond:
        wider = max(wider, ROOM_LEAST_AHEAD * width)
        ahead = max(ahead, ROOM_LEAST_AHEAD * width / pose.x.width)
        aside = max(aside, ROOM_LEAST * width / pose.y.width)
    return ahead, aside, wider


def before_end(h_start: Interval, h_end: Interval) -> Interval:
    """How far the tips travel on after both touch, less the range of where they do."""
    return h_start - h_end - Interval(0.0, h_start.width)


def rotation_begins(rule: MoveRule, pre: PoseBox, setup: Setup) -> bool:
    """Whether what must hold of a rotation before its tips touch is proved.

    Parameters
    ----------
    rule, pre, setup
        As of `certify_rotation`.

    Returns
    -------
    bool
        It takes little time.

    Raises
    ------
    ValueError
        If the rule is not a counter-clockwise rotation with a passive tip.
    """
    return all_proved(as_begun(rule, pre, setup)[1])


def as_begun(rule: MoveRule, pre: PoseBox, setup: Setup) -> tuple[Move, list[Obligation]]:
    """The move, and what must hold before its tips touch."""
    if rule.single is None or rule.side != 1:
        raise ValueError(f"rotation rule needs side = 1 and a passive tip, got {rule}")
    edge = setup.edge(pre.theta.mid)
    move = _move(rule, pre, edge, setup)
    if not opposite(move.lean, setup):
        return move, [_undecided(ObligationId.EDGES_OPPOSITE)]
    box = base_box(rule, pre, setup, edge)
    obligations = [*free_at_start((-IDLE, IDLE), box, edge), *_before(move)]
    if not move.V.lo > 0.0:  # what the conditions are derived for; they square it
        obligations.append(_undecided(ObligationId.ACTIVE_ABOVE_PASSIVE))
    return move, obligations


def all_proved(obligations: Sequence[Obligation]) -> bool:
    """Whether nothing is left open."""
    return all(one.proof.verdict is Verdict.PROVED for one in obligations)


def opposite(lean: Interval, setup: Setup) -> bool:
    """Whether two edges may be held between two tips as opposite ones.

    Parameters
    ----------
    lean
        By how much they are out of parallel as stated, rad.
    setup
        The task.

    Returns
    -------
    bool
        Where they are by half a right angle or more, nothing is claimed; nor where a force on the far edge, on the
        side of its cone of friction, may point away from the pushed one: then the axes of that are none for it.
    """
    u = setup.uncertainty
    tilt = lean + u.squareness - u.squareness
    if not (tilt.lo > -MOST_LEAN and tilt.hi < MOST_LEAN):
        return False
    along = u.friction * sin(tilt) / cos(tilt)
    return along.lo > -1.0 and along.hi < 1.0


def held_poses(step: Step) -> list[PoseBox]:
    """Poses in which a rotation holds the part between both tips.

    Parameters
    ----------
    step
        A rotation as certified.

    Returns
    -------
    list[PoseBox]
        Boxes that hold all of them, world frame; none where the motion could not be enclosed.
    """
    return [one.box for one in step.tube[2:]]  # after rest and the active tip alone


def _tube(
    move: Move, touch: Touch, *, rough: bool, coarse: float = 1.0
) -> tuple[SlideTube, list[Move]]:
    """The tube, and the move as it is in each of its cells."""
    grip = move.grip
    cell = (ROUGH if rough else 1.0) * CELL * _width(grip)
    moves = within(move, cut(grip, max(1, math.ceil(grip.room.width / cell))))
    if rough and not grip.common:
        coarse *= LONGER
    parts = [(one.grip, {**touch.start.labels, **one.labels}) for one in moves]
    tube = enclose_slide(grip, touch.start, move.h_end.lo, coarse=coarse, parts=parts)
    return tube, moves


def _bounding(move: Move) -> list[str]:
    """What the room depends on."""
    wide = [name for name in move.of.begin.inputs if move.box[name].width > 0.0]
    return [
        name
        for name in wide
        if _room(move, {name: Interval.point(move.box[name].mid)}).width < move.room.width
    ]


def _room(move: Move, known: Mapping[str, Interval]) -> Interval:
    return enclose(move.of.begin, {**move.box, **known}, boxes=1)[1]


def apart(one: Interval, other: Interval) -> bool:
    """Whether two ranges have nothing in common."""
    return one.hi < other.lo or one.lo > other.hi


def within(move: Move, rooms: Sequence[Interval]) -> list[Move]:
    """The move if the room is in each of some ranges: the tips and the part cannot be anywhere then."""
    sides = {name: [move.box[name]] * len(rooms) for name in _bounding(move)}

    def rows() -> list[dict[str, Interval]]:
        return [dict(zip(sides, row, strict=True)) for row in zip(*sides.values(), strict=True)]

    for name, end in itertools.product(tuple(sides), (0, 1)):
        shares = [0.5] * len(rooms)
        for _ in range(NARROWED):
            halves = [_cut_off(*pair, end) for pair in zip(sides[name], shares, strict=True)]
            outer = [{**row, name: gone} for row, (gone, _) in zip(rows(), halves, strict=True)]
            there = [row[1] for row in enclose_rows(move.of.begin, move.box, outer, boxes=1)]
            for k, (_, rest) in enumerate(halves):
                if apart(there[k], rooms[k]):
                    sides[name][k] = rest
                else:
                    shares[k] *= 0.5
    found = []
    for room, row in zip(rooms, rows() or [{}] * len(rooms), strict=True):
        box = {**move.box, **row}
        _, _, label, angle, *_ = enclose(move.of.begin, box, boxes=16)
        labels = {"label": label, "first_angle": angle}
        found.append(replace(move, box=box, room=room, labels=labels))
    return found


def _cut_off(side: Interval, share: float, end: int) -> tuple[Interval, Interval]:
    """A share of a side at its lower end (0) or its upper one, and the rest."""
    at = side.lo + (share if end == 0 else 1.0 - share) * side.width
    lower, upper = Interval(side.lo, at), Interval(at, side.hi)
    return (upper, lower) if end else (lower, upper)


@dataclass(frozen=True, slots=True, kw_only=True)
class Reach:
    """How far a push can go."""

    h: float
    """x of the active tip less that of the passive one, the nearest that is commanded, m."""
    slide: float
    """The slide there, in the middle, m."""


def reach(rule: MoveRule, pre: PoseBox, setup: Setup, coarse: float) -> Reach | None:
    """How far a rotation may go, roughly.

    Parameters
    ----------
    rule, pre, setup
        As of `certify_rotation`; the push as long as it may be.
    coarse
        Factor on the steps.

    Returns
    -------
    Reach or None
        None where it does not begin or does not get past the passive tip.
    """
    edge = setup.edge(pre.theta.mid)
    move = _move(rule, pre, edge, setup)
    touch = approach(move.box, move.grip, move.labels, move.first_gap, edge, move.of)
    if touch is None or not move.h_end.hi < touch.start.h.lo:
        return None
    tube, _ = _tube(move, touch, rough=True, coarse=coarse)
    # the last knots are bounded, but not checked
    ends = [int(np.isfinite(cell.upper).sum()) - 1 - UNCHECKED for cell in tube.cells]
    last = min(ends)
    if last < 1 or tube.h[last] > 0.0:
        return None
    cell = tube.cells[len(tube.cells) // 2]
    slide = float(cell.centre[last] + 0.5 * (cell.lower[last] + cell.upper[last]))
    return Reach(h=float(tube.h[last]) + 0.5 * move.h_end.width, slide=slide)


def _roomy(side: Interval, below: float, above: float) -> Interval:
    """A side of what is stated: others enclose the slide by other barriers, and are to meet it."""
    return side + Interval(-below * side.width, above * side.width)


def _move(rule: MoveRule, pre: PoseBox, edge: Edge, setup: Setup) -> Move:
    far, lean = setup.opposite(edge)
    box = ranges(rule, pre, edge, far, setup)
    if lean != ZERO:
        box["kappa_far"] = box["kappa_far"] + lean
    exact = frozenset(name for name, side in box.items() if side == ZERO)
    exact |= _idle_lines(exact)
    from_part = frozenset(name for name, aim in aims_of(rule).items() if aim.anchor is Anchor.PART)
    of = relations(exact, from_part)
    V, room, label, first_angle, h_end, gap, flight, travel = enclose(of.begin, box, boxes=16)
    return Move(
        box=box,
        of=of,
        edge=edge,
        far=far,
        lean=lean,
        setup=setup,
        V=V,
        room=room,
        labels={"label": label, "first_angle": first_angle},
        h_end=h_end,
        first_gap=gap,
        flight=flight,
        travel=travel,
    )


def _idle_lines(exact: frozenset[str]) -> set[str]:
    """Inputs of an affine bound, and of what is told of the creep, that belong to what is exactly zero."""
    gone = {
        "r_D": ("radius_lower",), "r_S": ("radius_passive",), "kappa": ("kappa", "kappa_far"),
        "drag_a": ("drag_a",), "drag_n": ("drag_n",),
    }  # fmt: skip
    kinds = ("middle", "spread", "drift", "by", "at")
    return {f"{kind}_{name}" for name, of in gone.items() if exact.issuperset(of) for kind in kinds}


def _before(move: Move) -> list[Obligation]:
    """What holds of the passive tip before any touches."""
    box = move.box
    gap = move.first_gap * STATED
    return [
        require_order(
            about(ObligationId.TIP_FREE_AT_START, tip=Which.PASSIVE),
            Inequality.CLEARANCE,
            gap,
            {name: box[name] for name in ("theta", "passive_x", "passive_y")},
        ),
        require(
            about(ObligationId.NO_JAM),
            Inequality.NO_JAM,
            {
                "V": move.V + box["sway"],
                "width": box["depth"] + box["depth_far"],
                "radii": box["radius_lower"] + box["radius_passive"],
                "mu": move.setup.uncertainty.friction,
            },
        ),
    ]


def _tube_obligations(tube: SlideTube, move: Move, wider: float = 0.0) -> list[Obligation]:
    """What holds all the way, for others as well whose tube is wider by so much, m."""
    # there is no grip beyond the first one; others may put that a little farther out
    beyond = BEYOND * float(tube.h[0])
    box = {
        "h": Interval(float(tube.h[-1]) - beyond, float(tube.h[0]) + beyond),
        "V": move.V + move.box["sway"],
    }
    done = tube.status is TubeStatus.COMPLETE
    # how far the tube came tells two failures apart; a proved obligation has nothing to tell
    why = {} if done else {"status": tube.status.name.lower()}
    wanted = (
        (ObligationId.BOTH_TIPS_TOUCH, Inequality.PASSIVE_FORCE, tube.force_margin),
        (ObligationId.BOTH_TIPS_ON_EDGES, Inequality.ENDS_OF_EDGES, tube.edge_margin - wider),
    )
    return [
        require_order(
            Named(id_, why),
            inequality,
            Interval(margin, math.inf) * STATED if done else Interval(-math.inf, 0.0),
            box,
        )
        for id_, inequality, margin in wanted
    ]


@dataclass(frozen=True, slots=True, kw_only=True)
class Held:
    """The part between both tips."""

    pose: PoseBox
    edge_angle: Interval
    """Of the pushed edge as stated, in the move's axes, rad."""
    active_offset: Interval
    """m"""

    def hull(self, other: Held) -> Held:
        """Both."""
        return Held(
            pose=self.pose.hull(other.pose),
            edge_angle=self.edge_angle.hull(other.edge_angle),
            active_offset=self.active_offset.hull(other.active_offset),
        )


def _held(
    of: tuple[Bounded, ...],
    parts: list[Move],
    tube: SlideTube,
    spans: Sequence[Interval],
    boxes: int,
) -> list[Held | None]:
    """All poses while the distance of the tips along the travel is in a range, for each of some ranges."""
    lines = zip(*(tube.lines(h) for h in spans), strict=True)
    found = [
        poses(of, part, cell, spans, own, boxes)
        for part, cell, own in zip(parts, tube.cells, lines, strict=True)
    ]
    return [functools.reduce(joined, same) for same in zip(*found, strict=True)]


def _placed(move: Move, touch: Touch, post: PoseBox) -> PoseBox:
    """Poses at the end with room for others, x and y by a closer tube and bounds of second order."""
    cells = within(move, cut(move.grip, PARTS))
    parts = [(one.grip, {**touch.start.labels, **one.labels}) for one in cells]
    tube = enclose_slide(move.grip, touch.start, move.h_end.lo, parts=parts)
    if tube.status is not TubeStatus.COMPLETE:
        return post
    sides: list[tuple[Interval, ...]] = []
    for part, cell, line in zip(cells, tube.cells, tube.lines(move.h_end), strict=True):
        box = {**part.box, "room": part.room, "turned": cell.parameters["turned"]}
        sides.append(enclose_where(move.of.placed, {**box, **on_line(line, cell.parameters)}))
    x, y = (functools.reduce(Interval.hull, side) for side in zip(*sides, strict=True))
    x, y = _roomy(x, *PLACED_AHEAD), _roomy(y, *PLACED_ASIDE)
    return replace(post, x=post.x.common(x), y=post.y.common(y))


def unknown() -> Held:
    """Anywhere."""
    anywhere = Interval(-math.inf, math.inf)
    pose = PoseBox(x=anywhere, y=anywhere, theta=anywhere)
    return Held(pose=pose, edge_angle=anywhere, active_offset=anywhere)


def joined(one: Held | None, other: Held | None) -> Held | None:
    """Both; None where one is not enclosed."""
    return None if one is None or other is None else one.hull(other)


def poses(
    of: tuple[Bounded, ...],
    part: Move,
    cell: Cell,
    spans: Sequence[Interval],
    lines: Sequence[Line],
    boxes: int,
    known: Mapping[str, Interval] | None = None,
) -> list[Held | None]:
    """The same where the room is in the range of one cell, and ``known`` of the move."""
    box = {**part.box, **(known or {}), "turned": cell.parameters["turned"]}
    rows = [
        {**on_line(line, cell.parameters), "h": h} for line, h in zip(lines, spans, strict=True)
    ]
    sides = (enclose_rows(one, box, rows, boxes=boxes, slack=0.002) for one in of)
    return [_pose(part, *each) for each in zip(*sides, strict=True)]


def _pose(
    part: Move,
    x: tuple[Interval, ...],
    y: tuple[Interval, ...],
    direction: tuple[Interval, ...],
    offset: tuple[Interval, ...],
) -> Held | None:
    c, s = direction
    # sin(theta) > 0 throughout; the inverse is taken of the coordinate that is far from +-1
    angle = PI - arcsin(s) if c.hi < -0.7 else HALF_PI - arcsin(c)
    if not angle.width < math.inf:
        return None
    return Held(
        pose=PoseBox(x=x[0], y=y[0], theta=part.edge.orientation(angle)),
        edge_angle=angle,
        active_offset=offset[0],
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class Slice:
    """A stretch of the turn."""

    h: Interval
    held: Held


def _slices(parts: list[Move], tube: SlideTube) -> list[Slice]:
    ends = [float(end) for end in np.linspace(float(tube.h[0]), float(tube.h[-1]), SLICES + 1)]
    ends[0], ends[-1] = float(tube.h[0]), float(tube.h[-1])
    spans = [Interval(low, high) for high, low in itertools.pairwise(ends)]
    held = _held(parts[0].of.during, parts, tube, spans, 1)
    return [Slice(h=h, held=one or unknown()) for h, one in zip(spans, held, strict=True)]


def _knots(slices: list[Slice]) -> tuple[Knot, ...]:
    return tuple(
        Knot(stage=f"tips {1e6 * part.h.mid:.0f} um apart in x", box=part.held.pose)
        for part in slices
    )


def idle_tip_clear(
    move: Move, touch: Touch, slices: list[Slice], at_end: Held
) -> tuple[Obligation, ...]:
    """The upper tip passes the end of the edge at first, and is off the edge's line later."""
    lean = move.squareness
    early, late = (
        _hull_of([part.held for part in part_of]) for part_of in (slices[:EARLY], slices[EARLY:])
    )
    before = touch.first + lean, touch.active_offset
    in_turn = touch.path.hull(early[0] + lean), early[1].hull(touch.active_offset)
    later = late[0] + lean, late[1]
    end = at_end.edge_angle + lean, at_end.active_offset
    in_flight, back = (Interval(0.0, max(0.0, way.hi)) for way in (move.flight, move.travel))
    early_on = _passes(move, *in_turn, ZERO, When.EARLY_IN_TURN)
    later_on = _passes(move, *later, ZERO, When.LATE_IN_TURN)
    # to others it may be late as soon as both tips touch
    if early_on.proof.verdict is later_on.proof.verdict is Verdict.PROVED:
        least = min(early_on.proof.lower, later_on.proof.lower)
        later_on = replace(later_on, proof=replace(later_on.proof, lower=least))
    return (
        _passes(move, *before, in_flight, When.BEFORE_TOUCH),
        early_on,
        later_on,
        _passes(move, *end, back, When.ON_WITHDRAWAL),
    )


def _hull_of(held: list[Held]) -> tuple[Interval, Interval]:
    angles, offsets = (
        [getattr(part, name) for part in held] for name in ("edge_angle", "active_offset")
    )
    return functools.reduce(Interval.hull, angles), functools.reduce(Interval.hull, offsets)


def _passes(
    move: Move, path: Interval, offset: Interval, short: Interval, when: When
) -> Obligation:
    """While the active tip is ``short`` of its place on the edge, the idle one is clear of the part."""
    u, box = move.setup.uncertainty, move.box
    theta = path - u.travel_direction
    x, y = second_tip(-IDLE, move.setup)
    c, s = cos(u.travel_direction), sin(u.travel_direction)
    # round tips: the idle one must be off the line by the difference of the radii
    more = box["radius_lower"] - u.tip_radius
    # off the line of the pushed edge, or beyond one across it, the whole part is on the other side
    half = move.setup.reach_along(move.edge)
    beside = {
        "theta": theta,
        "d2": offset,
        "half": half.hull(half + u.tip_radius),
        "dx": x * c + y * s + short + sin(theta) * more,
        "dy": y * c - x * s - cos(theta) * more,
        "side": Interval.point(float(IDLE)),
    }
    about_it = about(ObligationId.IDLE_TIP_PASSES, when=when)
    return _of_move(move, require(about_it, Inequality.BESIDE, beside))


def _of_move(move: Move, obligation: Obligation) -> Obligation:
    """What was proved over enclosures, as a statement about everything that the move can be like.

    Others enclose turn and slide a little differently: they are to meet the bound, not these boxes.
    """
    proof = obligation.proof
    if proof.verdict is not Verdict.PROVED:
        return obligation
    lower = (Interval.point(proof.lower) * STATED).lo
    over = stated({name: move.box[name] for name in ("beta", "spacing")})
    return replace(obligation, proof=replace(proof, lower=lower, box=over))


def facing(move: Move, angle: Interval) -> Interval:
    """Directions of an edge as stated, of the real ones against the travel of a probe."""
    return angle + move.squareness - move.setup.uncertainty.travel_direction


def _undecided(id_: ObligationId) -> Obligation:
    return require_order(about(id_), Inequality.NONE, Interval(-math.inf, 0.0), {})


def _step(
    rule: MoveRule,
    pre: PoseBox,
    post: PoseBox | None,
    obligations: list[Obligation],
    tube: tuple[Knot, ...] = (),
) -> Step:
    return Step(
        rule=rule,
        claim=about(Property.TURNS_BETWEEN_TIPS),
        pre=pre,
        post=post,
        obligations=tuple(obligations),
        tube=(Knot(stage="at rest", box=pre), *tube),
    )
