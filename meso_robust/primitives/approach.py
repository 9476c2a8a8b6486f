"""The start of a two-sided rotation: the active tip alone pushes the part onto the passive one.

The distance of the passive tip from its edge is the clock. The part turns by a rate per closed gap, and
the active tip's contact creeps along its edge by a rate per turn, that lie in intervals over all states on
the way; so the turn is the first gap times a mean rate out of its interval, and the creep the turn times
one. The gap is closed in a few stages. That the creep is told per turn matters: how far the part turns
depends much on the film, where its contact is at a given turn hardly does.
"""

from __future__ import annotations

import functools
import itertools
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np

from meso_robust.bounds import HALF_PI, Bounded, Interval, enclose
from meso_robust.motion.two_sided import Grip, Start, parameters_of, rate_at
from meso_robust.primitives.grasp import LINE, STATE, Relations, on_line
from meso_robust.primitives.names import Inequality, ObligationId, about
from meso_robust.primitives.obligation import Obligation, require_order
from meso_robust.primitives.outline import Edge
from meso_robust.primitives.setup import ZERO, PoseBox

# Choices of speed against tightness: a stage too long leaves a rotation undecided, never wrong.
STAGES = 4
GUESSES = 10
SMALL_TURN = 0.01  # rad; for a slope, which is a guess
BOXES = 16
MOST_BOXES = 256  # for the slide at the touch, from which the whole turn starts
GAP = 1.0 / 105.0  # of the part's width: first gaps that are closed together
STATED = Interval.point(0.9)
"""Share of a proved bound that is stated: others, whose enclosures differ, are to meet it."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Touch:
    """Everything the part can be like when it comes to rest on the passive tip."""

    start: Start
    first: Interval
    """Direction of the pushed edge as stated before, in the move's axes, rad."""
    poses: PoseBox
    """From the start to the touch."""
    path: Interval
    """Directions of the pushed edge from the start to the touch, in the move's axes, rad."""
    active_offset: Interval
    """p_D from the start to the touch, m."""
    obligations: tuple[Obligation, ...]


def approach(
    box: Mapping[str, Interval],
    grip: Grip,
    labels: Mapping[str, Interval],
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
        Ranges of `grasp.LABELS`.
    edge
        The pushed edge.
    of
        The functions of the rotation.

    Returns
    -------
    Touch or None
        None where no bound of the rates could be confirmed.
    """
    box = _bowed({**box, **labels}, grip.mu, of)
    gap = labels["first_gap"]
    width = grip.depth.mid + grip.depth_far.mid
    count = max(1, math.ceil(gap.width / (GAP * width)))
    ends = np.linspace(gap.lo, gap.hi, count + 1).tolist()
    ends[0], ends[-1] = gap.lo, gap.hi
    cells = []
    for low, high in itertools.pairwise(ends):
        cell = _closed({**box, "first_gap": Interval(low, high)}, grip.mu, of)
        if cell is None:
            return None
        cells.append(cell)
    path, offset, x, y, pushes, unique = (
        functools.reduce(Interval.hull, sides)
        for sides in zip(*(cell.seen for cell in cells), strict=True)
    )
    return Touch(
        start=_start([cell.box for cell in cells], grip, labels, of),
        first=edge.angle(box["theta"]),
        path=path,
        poses=PoseBox(x=x, y=y, theta=edge.orientation(path - box["kappa"])),
        active_offset=offset,
        obligations=(
            _stated(ObligationId.PUSHES_UNTIL_REST, Inequality.NORMAL_FORCE, pushes, box),
            _stated(ObligationId.UNIQUE_UNTIL_REST, Inequality.ONLY_SOLUTION, unique, box),
        ),
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class _Closed:
    """A part of the range of first gaps, closed."""

    box: dict[str, Interval]
    """With the mean rates."""
    seen: tuple[Interval, ...]
    """Direction of the edge, p_D, x, y, how the tip presses, how stiff it is."""


def _closed(box: dict[str, Interval], friction: Interval, of: Relations) -> _Closed | None:
    turned = crept = ZERO
    seen, turns, creeps = [], [], []
    for stage in range(STAGES):
        state = {**box, "begun": Interval.point(stage / STAGES), "turned": turned, "crept": crept}
        found = _stage(state, friction, of)
        if found is None:
            return None
        state, margins = found
        seen.append((*enclose(of.path, state, boxes=BOXES), *margins))
        turn = state["turn_rate"] * Interval.point(1.0 / STAGES)
        turns.append(turn)
        creeps.append(state["creep_rate"])
        turned, crept = turned + turn, crept + state["creep_rate"] * turn
    return _Closed(
        box={**box, "turned": turned, "crept": _mean(creeps, turns)},
        seen=tuple(functools.reduce(Interval.hull, sides) for sides in zip(*seen, strict=True)),
    )


def _bowed(box: Mapping[str, Interval], friction: Interval, of: Relations) -> dict[str, Interval]:
    """With a guess of how the creep per turn changes with the turn."""
    upright = Interval.point(HALF_PI.mid)
    still = dict.fromkeys(("begun", "part", "turned", "crept", "turn_rate", "creep_rate"), ZERO)
    box = {**box, **still, "bow": ZERO, "upright": upright}
    creeps = []
    for off in (SMALL_TURN, -SMALL_TURN):
        turned = _middle({**box, "theta": box["theta"] + Interval.point(off)})
        rates = _rates(turned, Interval.point(friction.mid), of)
        creeps.append(0.0 if rates is None else rates[1].mid)
    return {**box, "bow": Interval.point((creeps[0] - creeps[1]) / (2.0 * SMALL_TURN))}


def _mean(values: list[Interval], weights: list[Interval]) -> Interval:
    """Mean of values, each anywhere in its range, as are the positive weights."""
    middle = Interval.point(sum(value.mid for value in values) / len(values))
    total = middle
    for k, (value, weight) in enumerate(zip(values, weights, strict=True)):
        rest = functools.reduce(Interval.__add__, (w for j, w in enumerate(weights) if j != k))
        # weight/(weight + rest) grows with the weight and falls with the rest
        low, high = Interval.point(weight.lo), Interval.point(weight.hi)
        share = Interval(
            (low / (low + Interval.point(rest.hi))).lo, (high / (high + Interval.point(rest.lo))).hi
        )
        total = total + share * (value - middle)
    return total


def _stated(
    id_: ObligationId, inequality: Inequality, margin: Interval, box: Mapping[str, Interval]
) -> Obligation:
    over = {"rho": box["rho"]}
    return require_order(about(id_), inequality, margin * STATED, over)


def _stage(
    state: dict[str, Interval], friction: Interval, of: Relations
) -> tuple[dict[str, Interval], tuple[Interval, Interval]] | None:
    """One stage with confirmed rates, and how the tip presses and how stiff it is at worst.

    Rates are guessed and kept if those of all states that follow from them lie among them.
    """
    at_first = {**state, "part": ZERO, "turn_rate": ZERO, "creep_rate": ZERO}
    rates = _rates(_middle(at_first), Interval.point(friction.mid), of)
    if rates is None:
        return None
    guess = rates[:2]
    for _ in range(GUESSES):
        trial = {
            **state,
            "part": Interval(0.0, 1.0 / STAGES),
            "turn_rate": guess[0],
            "creep_rate": guess[1],
        }
        rates = _rates(trial, friction, of)
        if rates is None:
            return None
        turn, creep, pushes, unique = rates
        if turn.within(guess[0]) and creep.within(guess[1]):
            return {**trial, "turn_rate": turn, "creep_rate": creep}, (pushes, unique)
        guess = _inflated(turn), _inflated(creep)
    return None


def _middle(state: Mapping[str, Interval]) -> dict[str, Interval]:
    return {name: Interval.point(side.mid) for name, side in state.items()}


def _inflated(range_: Interval) -> Interval:
    # any guess is sound, as it is kept only if the rates stay in it; 3 % is enough for the next try
    reach = 0.03 * (range_.hi - range_.lo)
    return Interval(range_.lo - reach, range_.hi + reach)


def _rates(
    state: dict[str, Interval], friction: Interval, of: Relations
) -> tuple[Interval, Interval, Interval, Interval] | None:
    """Turn and creep per closed gap, what the tip presses with and its least stiffness."""
    now = [enclose(part, state, boxes=BOXES)[0] for part in of.state]
    state = {**state, **dict(zip(STATE, now, strict=True))}
    stick, pressing = enclose(of.sticking, state, boxes=BOXES)
    if not pressing.lo > 0.0:
        return None
    stiffness = [
        enclose(of.rates, {**state, "tau": side}, boxes=1)[3] for side in (friction, -friction)
    ]
    least = Interval(min(k.lo for k in stiffness), max(k.hi for k in stiffness))
    state = {**state, "tau": _clipped(stick, friction)}
    turn, creep, closing, _ = enclose(of.rates, state, boxes=BOXES)
    if not (closing.lo > 0.0 and least.lo > 0.0 and turn.lo > 0.0):
        return None
    return turn, creep, pressing, least


def _clipped(stick: Interval, mu: Interval) -> Interval:
    """Force along the edge over normal force of one contact: the sticking ratio, clipped to +-mu."""
    low = max(stick.lo, -mu.hi) if stick.lo < 0.0 else min(stick.lo, mu.lo)
    high = min(stick.hi, mu.hi) if stick.hi > 0.0 else max(stick.hi, -mu.lo)
    return Interval(low, high)


def _start(
    cells: list[dict[str, Interval]], grip: Grip, labels: Mapping[str, Interval], of: Relations
) -> Start:
    """The slide at the touch as an affine function; its slopes are those at the middle, as a guess."""
    no_line = dict.fromkeys(LINE, ZERO)
    h = functools.reduce(
        Interval.hull, (enclose(of.touch, cell | no_line, boxes=BOXES)[0] for cell in cells)
    )
    box = {**cells[len(cells) // 2], **no_line, **labels}
    middle, slope = _at_middle(of.touch, box), _slopes(of.touch, box)
    rate = rate_at(grip, middle["h"], middle["q"])

    def beside(name: str) -> float:
        return slope("q", name) + rate * slope("h", name)

    # a higher active tip gives room; a higher passive one takes it, and lowers the label
    spread = {"first_gap": beside("first_gap"), "room": beside("dual_y")}
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
    rests = (enclose(of.touch, cell | coefficients, boxes=MOST_BOXES)[2] for cell in cells)
    return replace(start, rest=functools.reduce(Interval.hull, rests))


TOUCH = ("h", "q")
"""The first results of `Relations.touch`."""


def _at_middle(of: Bounded, box: Mapping[str, Interval], **off: float) -> dict[str, float]:
    """Values in the middle of a box, in plain numbers."""
    at = np.array([box[name].mid + off.get(name, 0.0) for name in of.inputs])
    return dict(zip(TOUCH, np.array(of.function(at)).ravel().tolist(), strict=False))


def _slopes(of: Bounded, box: Mapping[str, Interval]) -> Callable[[str, str], float]:
    """Slopes there, by divided differences: what follows is a guess."""

    def slope(result: str, name: str) -> float:
        small = 1e-8  # m or rad: far below what curves, far above what is rounded
        ends = [_at_middle(of, box, **{name: side})[result] for side in (small, -small)]
        return (ends[0] - ends[1]) / (2.0 * small)

    return slope


PART_OF_CONSTANT = {
    "d_D": "depth", "d_S": "depth_far", "r_D": "radius_lower", "r_S": "radius_passive",
    "kappa": "kappa_far", "drag_a": "drag_a", "drag_n": "drag_n",
}  # fmt: skip
"""What each constant of a grip but its room is among the parameters of a move."""
TAKES_ROOM = ("d_D", "d_S", "r_D", "r_S")
