"""A rotation that jams: from somewhere on, no motion of the part lets the active tip go on.

Names are those of ``grip.py``. Let both contacts be on their edges, D press whatever the ratios, and
neither tip be left (``rotate.py``). Then every motion has a divisor ``N > 0``; forces and slips, times
``N``, are linear in either ratio. Both slips grow with ``u``. Let the part slip forward over D where it
does not slip over S, as it does until the contacts have passed each other. What is left of Coulomb's law
is a walk of both ratios from ``(-mu, -mu)`` over ``(-mu, mu)`` to ``(mu, mu)`` in five modes:

    =================================  ===========  ==================================================
    the part slips                     ratios       no motion if
    =================================  ===========  ==================================================
    forward over both                  -mu, -mu     the slip over S is negative there, times N
    forward over D, S sticks           -mu, any     and ``p - r < (e_D + e_S) mu_D``
    forward over D, backward over S    -mu, mu      N is not positive there
    D sticks, backward over S          any, mu      ``p - r < (e_D + e_S) mu_S``, and
    backward over both                 mu, mu       the slip over D is positive there, times N
    =================================  ===========  ==================================================

In the second row the slip over S changes with S's ratio in the sense of ``p - r - (e_D + e_S) mu_D``, and in
the fourth that over D against D's ratio likewise, whatever the film and the angle between the edges
(``derivations/jam.py``): where the line through both contacts is within both cones of friction, no ratio
between brings it to zero.

Where all rows hold in a stretch of the travel, however short, no motion passes it: the part jams there or
before. Nothing is asked of motions before it but where they can be. From the touch of both tips until
shortly before the grip can close that is the tube of ``slide.py``; from there on the first and the last row
are shown to hold, so that the part gets ahead no faster than it does while S sticks and no slower
than while D sticks, even where the grip closes.
"""

from __future__ import annotations

import dataclasses
import functools
import math

from flint import arb

from meso_robust.checker.approach import Approach
from meso_robust.checker.dual import Dual, Point
from meso_robust.checker.film import EVEN
from meso_robust.checker.grip import D, Real, S
from meso_robust.checker.ids import Objection, named
from meso_robust.checker.inputs import PoseBox
from meso_robust.checker.passage import Passage
from meso_robust.checker.pushing import UNIT, passes
from meso_robust.checker.ranges import (
    ZERO,
    Formula,
    Side,
    component,
    hull,
    positive,
    shift,
    side_of,
    span,
)
from meso_robust.checker.refusal import Refused
from meso_robust.checker.rotate import (
    AHEAD,
    Held,
    Landing,
    Spares,
    Turn,
    landing,
    prove_all,
    turn_until,
)
from meso_robust.checker.scene import Scene
from meso_robust.checker.slide import Cubic, Curve, Piece, beyond, grip_of

ROOM = 5e-7
"""m of travel between the end of the tube and where the grip can close."""
NEAR = 2e-8
"""m of travel: how closely that place is looked for, and how long the stretch is in which no motion is left."""
CUTS = 20
"""Cuts of a box there; what comes out is a guess."""
SLID = 0.6
"""Of the width between the pushed edges: how far the part is thought to slide until then."""
ANY = (-2.0, 2.0)
"""Rates of the slide that are thought to hold all."""
MORE = 1e-2
"""By how much its bounds are steeper than any motion."""
CLOSE, CLOSE_BY = 1e-3, 1e-8
"""How closely the rates of sticking tips are bounded; and places, m (and rad)."""
TIPS = (D, S)


def check_jam(scene: Scene) -> Passage:
    """Prove that every motion of a counter-clockwise rotation jams between both tips.

    Parameters
    ----------
    scene
        The move, from poses and with errors for all of which it is proved.

    Returns
    -------
    Passage
        All poses until then; ``post`` holds those in which the part can get stuck.

    Raises
    ------
    Refused
        It does not follow.
    """
    land = landing(scene)
    h_end = span(land.pair.h_end, land.pair.box)[1]
    top, landed = beyond(land.h[1], 1), beyond(land.h[0], -1)
    opened = _opened(land, top, max(float(h_end), 0.0))
    pieces: tuple[Piece, ...] = ()
    if opened + ROOM < landed:
        first = opened + ROOM
        pieces = turn_until(land, side_of(arb(first))).pieces
        ahead = _ahead_at(land, pieces[-1], first)
    else:
        first = top
        ahead = functools.reduce(hull, map(_ahead_at_touch, land.touching))
    shut = _shut(land, min(opened, landed), h_end)
    if not shut - NEAR > h_end:
        raise Refused(named(Objection.JAMS), shut, h_end)
    last = _last(land, (first, shut - NEAR), ahead)
    _no_motion(land, last, shut)
    turn = Turn(land, (*pieces, last), (arb(last.last), land.h[1]))
    idle = (
        passes("before_touch", (turn.flight(),)),
        passes("early_in_turn", tuple(map(turn.early, land.stages))),
        passes("late_in_turn", tuple(map(turn.idle, turn.pieces))),
    )
    prove_all(idle)
    return Passage(
        does=named(Objection.JAMS),
        post=_where(turn),
        requirements=(*land.before, *land.during, *idle),
        swept=(*(one.swept() for one in land.stages), *turn.swept()),
    )


def _opened(land: Landing, top: float, bottom: float) -> float:
    """About the least h above which the grip cannot close; infinite if it can when both tips touch.

    A guess, as is :func:`_shut`.
    """
    if not _is(_divisor, land, top):
        return math.inf
    while top - bottom > NEAR:
        middle = (top + bottom) / 2
        if _is(_divisor, land, middle):
            top = middle
        else:
            bottom = middle
    return top


def _shut(land: Landing, below: float, h_end: arb) -> float:
    """An h below which the grip is closed for a while.

    Raises
    ------
    Refused
        There is none before the end of the travel.
    """
    closed = [functools.partial(_closed, k) for k in range(len(TIPS) + 1)]
    step = 2 * NEAR
    while not all(_is(of, land, below - step) for of in closed):
        step *= 2
        if not below - step - NEAR > h_end:
            raise Refused(named(Objection.JAMS), "a closed grip", "none before the end")
    return below - step


def _is(of: Formula, land: Landing, h: float) -> bool:
    """Whether something is positive wherever the part can be between tips at a distance ``h``."""
    low, high = functools.reduce(hull, map(_ahead_at_touch, land.touching))
    slid = (land.box["depth"][1] + land.box["depth_far"][1]) * SLID
    box = {**land.box, "h": side_of(arb(h)), AHEAD: (low - slid, high + slid)}
    return positive(of, box, cuts=CUTS)


def _divisor(at: Point) -> Dual:
    """That of the grip where the part slips forward over D and backward over S."""
    found: Dual = Held(grip_of(at, at["h"], S, at[AHEAD]), at).forces(-1, 1).divisor
    return found


def _closed(k: int, at: Point) -> Dual:
    found: Dual = _closings(Held(grip_of(at, at["h"], S, at[AHEAD]), at), ZERO)[k]()
    return found


def _ahead_at_touch(stage: Approach) -> Side:
    """How far the part is ahead of S at the touch of both tips."""
    return span(lambda at: stage.state(at).ahead, stage.box_at_touch(), within=CLOSE_BY)


def _ahead_at(land: Landing, piece: Piece, h: float) -> Side:
    """The same in a piece of the tube."""
    box = {**land.box, "share": UNIT}
    return span(lambda at: -piece.grip_at(Dual(arb(h)), at).b, box, within=CLOSE_BY)


def _last(land: Landing, h: tuple[float, float], ahead: Side) -> Piece:
    """The stretch from where the part can be ``ahead`` to where no motion is left.

    Raises
    ------
    Refused
        A motion is not shown to keep both tips on their edges, or between the rates at which a tip sticks.
    """
    wide = _piece(h, ahead, ANY)
    box = {**land.box, "done": UNIT, "share": UNIT}
    rates = functools.reduce(
        hull, (span(functools.partial(_stick, wide, tip), box, within=CLOSE) for tip in TIPS)
    )
    last = _piece(h, ahead, (min(float(rates[0]), 0.0) - MORE, max(float(rates[1]), 0.0) + MORE))
    turn = Turn(land, (last,), (arb(h[1]), arb(h[0])))
    slower = functools.partial(_slower, last)
    turn.hold(*turn.kept, (Objection.JAMS, (_between,)), (Objection.SLIDE_IN_TUBE, (slower,)))
    return last


def _piece(h: tuple[float, float], ahead: Side, rates: tuple[float, float]) -> Piece:
    """Between two lines; what is constant during the run is left out."""
    first, last = h

    def line(side: int, start: arb, rate: float) -> Curve:
        through = Cubic((beyond(start, side), rate * (first - last), 0.0, 0.0))
        return Curve(first, last, S, through, {}, {})

    lower, upper = (line(*one) for one in zip((-1, 1), ahead, rates, strict=True))
    return Piece(first, last, lower, upper)


def _stick(piece: Piece, tip: int, at: Point) -> Dual:
    found: Dual = piece.grip(at).stick(tip)
    return found


def _slower(piece: Piece, held: Held, bound: arb) -> Spares:
    """While either tip sticks the part gets ahead by less than the upper line, and more than the lower."""

    def spare(curve: Curve, side: int, tip: int) -> Real:
        return (curve.rate(arb(0), {}) - held.grip.stick(tip)) * side - bound

    lines = ((piece.lower, -1), (piece.upper, 1))
    return [functools.partial(spare, *line, tip) for line in lines for tip in TIPS]


def _between(held: Held, bound: arb) -> Spares:
    """The part slips neither forward over both tips nor backward; and what that rests on."""
    grip = held.grip
    arm = grip.e_moving + grip.e_resting

    def leant(by: Real) -> Real:
        return grip.apart if grip.tilt is EVEN else grip.apart - grip.tilt * by

    def slip(sign: int, tip: int) -> Real:
        return held.forces(sign, sign).slips[tip] * sign

    comes, grow = grip.g, (leant(grip.e_resting), grip.apart, leant(arm))
    closer = grip.g * arm + grip.f * grip.apart
    plain = (functools.partial(_less, one, bound) for one in (comes, *grow, closer))
    return [*plain, lambda: slip(-1, S) - bound, lambda: slip(1, D) - bound]


def _less(value: Real, bound: arb) -> Real:
    return value - bound


def _no_motion(land: Landing, last: Piece, shut: float) -> None:
    """Prove that none is left at the end of the last stretch.

    Raises
    ------
    Refused
        It does not follow.
    """
    end = dataclasses.replace(last, first=shut)
    turn = Turn(land, (end,), (arb(end.last), arb(end.first)))
    turn.hold((Objection.JAMS, (_closings,)))


def _closings(held: Held, bound: arb) -> Spares:
    """The rows of the table between the first and the last."""
    grip = held.grip
    mu_D, mu_S = held.ratios
    arm = grip.e_moving + grip.e_resting

    def spare(ratio: Real) -> Real:
        return arm * ratio - grip.apart - bound

    return [
        lambda: held.forces(-1, 1).divisor * -1 - bound,
        functools.partial(spare, mu_D),
        functools.partial(spare, grip.ratio_S(mu_S)),
    ]


def _where(turn: Turn) -> PoseBox:
    """All poses in the last stretch, in the axes of the move."""
    last = turn.swept()[-1]
    x, y, theta = (span(component(last.pose, k), last.box, within=CLOSE_BY) for k in range(3))
    return PoseBox(x=x, y=y, theta=shift(theta, turn.scene.turn))
