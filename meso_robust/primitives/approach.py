"""The start of a two-sided rotation: the active tip alone pushes the part onto the passive one.

The turn since the first touch is the clock. The active tip's contact creeps along its edge by a rate per
turn that lies in an interval over all states on the way; so it has crept the turn times a mean rate out of
that interval. How much the creep depends on constants is told as a guess, and only the rest is an interval.
How long the clock runs depends much on the film: the gap to the passive tip closes by a rate per turn that
is bounded stage by stage, so the turn is known to lie in a range. At a given turn it hardly matters.
"""

from __future__ import annotations

import functools
import itertools
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from meso_robust.bounds import HALF_PI, Bounded, Interval, enclose, enclose_rows
from meso_robust.motion.two_sided import Grip, Start, parameters_of, rate_at
from meso_robust.primitives.grasp import ALONE, CREEPS, LINE, Relations, on_line
from meso_robust.primitives.names import Inequality, ObligationId, Which, about
from meso_robust.primitives.obligation import Obligation, require_order
from meso_robust.primitives.outline import Edge
from meso_robust.primitives.setup import ZERO, PoseBox

# Choices of speed against tightness: a stage too long leaves a rotation undecided, never wrong.
STAGE = 0.02  # rad
MOST_STAGES = 25
GUESSES = 10
TURNS = (0.02, 0.06, 0.1)  # rad; where slopes are taken, which are a guess
ONE = Interval.point(1.0)
# What a length, and a creep per turn, are changed by where slopes are taken, of the part's width: far below
# what curves, far above what is rounded.
SMALL, SMALL_CREEP = 1.0 / 84_000.0, 1.0 / 84.0
SMALL_ANGLE = 1e-8  # rad; the same
BOXES = 16
FINE_BOXES = 256  # for what adds up over the stages
TOUCHES = 8  # parts of the range of turns in which the slide at the touch is enclosed
MOST_BOXES = 64  # for that of each part, from which the whole turn starts
STATED = Interval.point(0.9)
"""Share of a proved bound that is stated: others, whose enclosures differ, are to meet it."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Touch:
    """Everything the part can be like when it comes to rest on the passive tip."""

    start: Start
    box: Mapping[str, Interval]
    """What is known of the rotation then."""
    first: Interval
    """Direction of the pushed edge as stated before, in the move's axes, rad."""
    poses: PoseBox
    """From the start to the touch."""
    path: Interval
    """Directions of the pushed edge from the start to the touch, in the move's axes, rad."""
    active_offset: Interval
    """p_D from the start to the touch, m."""
    largest_force: float
    """Bound of the normal force at the active tip, over the drag and the rate of travel."""
    obligations: tuple[Obligation, ...]


def approach(
    box: Mapping[str, Interval],
    grip: Grip,
    labels: Mapping[str, Interval],
    first_gap: Interval,
    edge: Edge,
    of: Relations,
) -> Touch | None:
    """Enclose the push by the active tip alone, until the part rests on the passive one.

    Parameters
    ----------
    box
        What is known of the rotation (`grasp.ranges`).
    grip
        What is known of the part between both tips.
    labels
        Ranges of `grasp.LABELS` but the turn.
    first_gap
        Of the passive tip to its edge at the first touch of the active one, m.
    edge
        The pushed edge.
    of
        The functions of the rotation.

    Returns
    -------
    Touch or None
        None where no bound of the rates could be confirmed.
    """
    box = _told({**box, **dict.fromkeys(ALONE, ZERO)}, grip.mu, of)
    closed = _closed(box, first_gap, grip.mu, of)
    if closed is None:
        return None
    path, offset, x, y, pushes, unique = closed.seen
    return Touch(
        start=_start(closed.box, grip, {**labels, "turned": closed.box["turned"]}, of),
        box=closed.box,
        first=edge.angle(box["theta"]),
        path=path,
        poses=PoseBox(x=x, y=y, theta=edge.orientation(path - box["kappa"])),
        active_offset=offset,
        # the film yields to a push by its share of what it is stiff
        largest_force=(box["rho"] * (ONE + box["bend"]) / unique).hi,
        obligations=(
            *(
                require_order(about(id_), inequality, margin * STATED, {"rho": box["rho"]})
                for id_, inequality, margin in (
                    (ObligationId.PUSHES_UNTIL_REST, Inequality.NORMAL_FORCE, pushes),
                    (ObligationId.UNIQUE_UNTIL_REST, Inequality.ONLY_SOLUTION, unique),
                )
            ),
            require_order(
                about(ObligationId.TIP_ON_EDGE, tip=Which.ACTIVE),
                Inequality.BETWEEN_CORNERS if edge.beyond else Inequality.WITHIN_EDGE,
                (offset - edge.first).hull(edge.last - offset) * STATED,
                {name: box[name] for name in ("depth", "kappa")},
            ),
        ),
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class _Closed:
    """The gap is closed."""

    box: dict[str, Interval]
    """With the turn that takes and the mean creep."""
    seen: tuple[Interval, ...]
    """Direction of the edge, p_D, x, y, how the tip presses, how stiff it is, on the way."""


def _closed(
    box: dict[str, Interval], gap: Interval, friction: Interval, of: Relations
) -> _Closed | None:
    mean, least, seen = ZERO, None, []
    for start, end in itertools.pairwise(Interval.point(STAGE * k) for k in range(MOST_STAGES)):
        state = {**box, "turned": start.hull(end), "gap": Interval(0.0, gap.hi)}
        found = _stage(state, mean, friction, of)
        if found is None:
            return None
        state["creep"], mean, rate, margins = found
        seen.append((*enclose(of.path, state, boxes=BOXES), *margins, state["creep"]))
        left = gap - rate * (end - start)
        low, high = Interval.point(gap.lo) / rate, Interval.point(gap.hi) / rate
        if least is None and left.lo <= 0.0:
            least, since = max(0.0, (start + low).lo), len(seen) - 1
        if least is not None and left.hi <= 0.0:
            *sides, creep = zip(*seen, strict=True)
            state["creep"] = functools.reduce(Interval.hull, creep[since:])
            return _Closed(
                box={**state, "turned": Interval(least, (start + high).hi), "gap": ZERO},
                seen=tuple(functools.reduce(Interval.hull, side) for side in sides),
            )
        gap = left
    return None


def _stage(
    state: dict[str, Interval], mean: Interval, friction: Interval, of: Relations
) -> tuple[Interval, Interval, Interval, tuple[Interval, Interval]] | None:
    """What a stage adds to the approach.

    Returns the rest of the mean creep at any time in the stage and at its end; how fast the gap closes;
    how the tip presses and how stiff it is at worst. The creep is guessed, and right if that of all
    states that follow from it lies among it.
    """
    start, end = Interval.point(state["turned"].lo), Interval.point(state["turned"].hi)
    middle = {**_middle(state), "creep": Interval.point(mean.mid)}
    guess = _creep(middle, Interval.point(friction.mid), of)
    for _ in range(GUESSES):
        if guess is None:
            return None
        # what both have added, by their shares of the turn
        after = mean * (start / end) + guess * ((end - start) / end)
        during = {**state, "creep": after if start.hi == 0.0 else mean.hull(after)}
        creep = _creep(during, friction, of)
        # strictly inside, so that no motion can be the first to leave it
        if creep is not None and guess.lo < creep.lo and creep.hi < guess.hi:
            margins = _margins(during, friction, of)
            return None if margins is None else (during["creep"], after, *margins)
        guess = None if creep is None else _inflated(guess.hull(creep))
    return None


def _middle(state: Mapping[str, Interval]) -> dict[str, Interval]:
    return {name: Interval.point(side.mid) for name, side in state.items()}


def _inflated(range_: Interval) -> Interval:
    # any guess is sound, as it is kept only if the rates stay in it; 3 % is enough for the next try
    reach = 0.03 * (range_.hi - range_.lo)
    return range_ + Interval(-reach, reach)


def _creep(state: Mapping[str, Interval], friction: Interval, of: Relations) -> Interval | None:
    """What is left of the creep per turn: that of a contact that slips (towards +a of the part) or rolls."""
    stick, pressing = enclose(of.sticking, state, boxes=BOXES)
    slipping, rolling, lever = enclose(of.creep, {**state, "tau": -friction}, boxes=FINE_BOXES)
    if not (pressing.lo > 0.0 and lever.lo > 0.0 and stick.hi < friction.lo):
        return None
    if stick.hi < -friction.hi:
        return slipping
    # the smaller one: it slips only if it then creeps less than it would roll
    return Interval(min(slipping.lo, rolling.lo), min(slipping.hi, rolling.hi))


def _margins(
    state: Mapping[str, Interval], friction: Interval, of: Relations
) -> tuple[Interval, tuple[Interval, Interval]] | None:
    """How much the gap closes per turn; how the tip presses, and its least stiffness."""
    stick, pressing = enclose(of.sticking, state, boxes=BOXES)
    stiffness = [
        enclose(of.stiffness, {**state, "tau": side}, boxes=1)[0] for side in (friction, -friction)
    ]
    least = Interval(min(k.lo for k in stiffness), max(k.hi for k in stiffness))
    rates: list[Interval] = []
    if stick.lo < -friction.lo:  # it may slip
        rates += enclose(of.closing, {**state, "tau": -friction}, boxes=FINE_BOXES)
    if stick.hi >= -friction.hi:
        rate, turns = enclose(of.rolling, state, boxes=FINE_BOXES)
        rates.append(rate if turns.lo > 0.0 else ZERO)
    rate = functools.reduce(Interval.hull, rates)
    return (rate, (pressing, least)) if least.lo > 0.0 and rate.lo > 0.0 else None


PART_OF_CREEP = {
    "d_D": "depth", "r_D": "radius_lower", "drag_a": "drag_a", "drag_n": "drag_n",
}  # fmt: skip
"""What a constant is among the parameters of a move, as those of `PART_OF_CONSTANT`."""


def _told(box: dict[str, Interval], friction: Interval, of: Relations) -> dict[str, Interval]:
    """With a guess of how the creep per turn depends on the angle and on constants, on average."""
    at, width = {**box, "tau": Interval.point(-friction.mid)}, _width(box)

    def changed(name: str, small: float, turned: float) -> tuple[float, float]:
        """Of the creep and of the place of the first contact, per what is changed."""
        ends = []
        for off in (small, -small):
            moved = {**at, "turned": Interval.point(turned)}
            moved[name] = moved[name] + Interval.point(off)
            ends.append((min(_values(of.creep, moved)[:2]), _values(of.constants, moved)[0]))
        creep, first = ((ends[0][k] - ends[1][k]) / (2.0 * small) for k in range(2))
        return creep, first

    def mean(name: str) -> tuple[float, float]:
        creeps, firsts = zip(
            *(changed(name, SMALL * width, turned) for turned in TURNS), strict=True
        )
        return sum(creeps) / len(TURNS), firsts[0]

    # more creep per turn moves the contact by itself times the turn
    small = SMALL_CREEP * width
    by_place = sum(changed("creep", small, turned)[0] / turned for turned in TURNS) / len(TURNS)
    slopes = {"first_p": by_place}
    for name, part in PART_OF_CREEP.items():
        creep, first = mean(part)
        slopes[name] = creep - by_place * first
    middles = dict(zip(CREEPS, _values(of.constants, box), strict=True))
    found = {f"by_{name}": Interval.point(slopes[name]) for name in CREEPS}
    found |= {f"at_{name}": Interval.point(middles[name]) for name in CREEPS}
    halfway = 0.5 * TURNS[-1]
    by_angle, _ = changed("turned", halfway, halfway)
    upright = Interval.point(HALF_PI.mid)
    return {**box, **found, "by_angle": Interval.point(by_angle), "upright": upright}


def _width(box: Mapping[str, Interval]) -> float:
    """Of the part between the two edges, m."""
    return box["depth"].mid + box["depth_far"].mid


def _values(of: Bounded, box: Mapping[str, Interval]) -> list[float]:
    """The results in the middle of a box, in plain numbers."""
    at = np.array([box[name].mid for name in of.inputs])
    return [float(value) for value in np.array(of.function(at)).ravel()]


def _start(
    box: dict[str, Interval], grip: Grip, labels: Mapping[str, Interval], of: Relations
) -> Start:
    """The slide at the touch as an affine function; its slopes are those at the middle, as a guess."""
    parts = [{**box, "turned": turned} for turned in _turns(labels["turned"])]
    box = {**box, **dict.fromkeys(LINE, ZERO)}
    h = functools.reduce(
        Interval.hull, (enclose(of.touch, {**box, **part}, boxes=BOXES)[0] for part in parts)
    )
    middle, slope = _at_middle(of.touch, box), _slopes(of.touch, box)
    rate = rate_at(grip, middle["h"], middle["q"])

    def beside(name: str) -> float:
        return slope("q", name) + rate * slope("h", name)

    # a higher active tip gives room; a higher passive one takes it, and lowers the label
    spread = {"first_angle": beside("theta"), "turned": beside("turned"), "room": beside("dual_y")}
    spread["label"] = -beside("single_y") - spread["room"]
    for name, part in PART_OF_CONSTANT.items():
        # what takes room has that effect already
        spread[name] = beside(part) + (spread["room"] if name in TAKES_ROOM else 0.0)
    start = Start(
        h=h,
        labels=labels,
        value=middle["q"] - rate * (h.hi - middle["h"]),
        rate=rate,
        spread=spread,
        rest=ZERO,
    )
    coefficients = on_line(start.line, parameters_of(grip, labels))
    rests = (enclose(of.touch, part | coefficients, boxes=MOST_BOXES)[2] for part in parts)
    return replace(start, rest=functools.reduce(Interval.hull, rests))


def _turns(turned: Interval) -> list[Interval]:
    ends = np.linspace(turned.lo, turned.hi, TOUCHES + 1).tolist()
    ends[0], ends[-1] = turned.lo, turned.hi
    return [Interval(*pair) for pair in itertools.pairwise(ends)]


def touches(
    touch: Touch, of: Relations, places: Sequence[Mapping[str, Interval]]
) -> list[Interval]:
    """Where the passive tip is touched if more is known of the tips than for the whole.

    Parameters
    ----------
    touch, of
        Of the whole; its functions.
    places
        What is known more closely, all of the same names.

    Returns
    -------
    list[Interval]
        h for each place, m.
    """
    box = {**touch.box, **dict.fromkeys(LINE, ZERO)}
    rows = [{**place, "turned": part} for place in places for part in _turns(touch.box["turned"])]
    found = [h for h, *_ in enclose_rows(of.touch, box, rows, boxes=BOXES)]
    return [
        functools.reduce(Interval.hull, found[k : k + TOUCHES])
        for k in range(0, len(found), TOUCHES)
    ]


TOUCH = ("h", "q")
"""The first results of `Relations.touch`."""


def _at_middle(of: Bounded, box: Mapping[str, Interval], **off: float) -> dict[str, float]:
    """Values in the middle of a box, in plain numbers."""
    at = np.array([box[name].mid + off.get(name, 0.0) for name in of.inputs])
    return dict(zip(TOUCH, np.array(of.function(at)).ravel().tolist(), strict=False))


def _slopes(of: Bounded, box: Mapping[str, Interval]) -> Callable[[str, str], float]:
    """Slopes there, by divided differences: what follows is a guess."""

    def slope(result: str, name: str) -> float:
        small = SMALL_ANGLE if name in ANGLES else SMALL * _width(box)
        ends = [_at_middle(of, box, **{name: side})[result] for side in (small, -small)]
        return (ends[0] - ends[1]) / (2.0 * small)

    return slope


ANGLES = ("theta", "turned", "kappa_far")
"""Parameters that are angles; all others here are lengths."""
PART_OF_CONSTANT = {
    "d_D": "depth", "d_S": "depth_far", "r_D": "radius_lower", "r_S": "radius_passive",
    "kappa": "kappa_far", "drag_a": "drag_a", "drag_n": "drag_n",
}  # fmt: skip
"""What each constant of a grip but its room is among the parameters of a move."""
TAKES_ROOM = ("d_D", "d_S", "r_D", "r_S")
