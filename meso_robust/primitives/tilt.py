"""Tilt: one tip pushes in sticking contact and turns the part a little (paper, Fig. 13)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from meso_robust.bounds import Interval
from meso_robust.bounds.implicit import Implicit, at_middle, bound
from meso_robust.motion import one_tip
from meso_robust.primitives.base import (
    Wanted,
    base_box,
    free_at_start,
    holds,
    pose_of,
    positive,
)
from meso_robust.primitives.move import MoveRule
from meso_robust.primitives.names import (
    TURNS,
    Inequality,
    ObligationId,
    Property,
    When,
    Which,
    about,
)
from meso_robust.primitives.obligation import Knot, Leaves, Step
from meso_robust.primitives.outline import Edge, Line, Rectangle
from meso_robust.primitives.setup import PoseBox, Setup
from meso_robust.primitives.tube import turn_tube

PASSES = ObligationId.IDLE_TIP_PASSES
GUESS = 0.06
"""rad: a turn from which the search for its end starts."""
ENDS = Interval.point(0.0), Interval.point(1.0)
"""Of the share of a phase: a line may be cleared in its middle and not at its start."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Turn(Leaves):
    """What a tilt leaves behind for the straightening that follows it."""

    side: int
    """1 if it turned the part counter-clockwise, -1 if clockwise."""
    box: Mapping[str, Interval]
    """Its base parameters."""
    edge: Edge
    """The edge that was pushed: after a large tilt another one may face the pair."""


def certify_tilt(rule: MoveRule, pre: PoseBox, setup: Setup, *, whole: bool = True) -> Step:
    """Certify a tilt from every pose in ``pre``.

    The lower tip pushes above the middle (``rule.side`` = 1) or the upper one below it (-1), while
    the other tip passes the end of the edge.

    Parameters
    ----------
    rule, pre, setup
        The move, all poses before it, the task; all in the move's axes.
    whole
        False: nothing but the verdict and the box of poses after a proved move is wanted.

    Returns
    -------
    Step
        In the move's axes; without a ``post`` where the turn could not be enclosed.
    """
    side, edge = rule.side, setup.edge(pre.theta.mid)
    box = base_box(rule, pre, setup, edge)
    zero = one_tip.zeros(box)
    of = one_tip.tilt(side, zero)
    guess = edge.angle(pre.theta).mid + side * GUESS
    box |= _lines(of, box, guess, side, edge, pre, setup)
    margins = [name for name in of.outputs if name not in one_tip.POSE]
    ends = bound(of, box, guess, both=one_tip.POSE, lower=margins, proofs_only=not whole)
    rest = Knot(stage="at rest", box=pre)
    passage: tuple[Knot, ...] = ()
    if ends is not None and whole:
        passage = turn_tube(one_tip.tilt_tube(side, zero), box, ends.end.mid)
        ends = ends if passage else None
    return Step(
        rule=rule,
        claim=about(Property.TURNS_PART, turn=TURNS[side]),
        pre=pre,
        post=None if ends is None else pose_of(ends),
        obligations=(
            *free_at_start((-side, side), box, edge),
            # that the idle tip is off some other line is not asked: nothing refutes that it passes
            *(
                positive(one, of, box, ends, guess if whole and one[0].id is not PASSES else None)
                for one in _wanted(side, edge)
            ),
        ),
        tube=(rest, *passage) if passage else (),
        leaves=None if ends is None else Turn(side=side, box=box, edge=edge),
    )


def _wanted(side: int, edge: Edge) -> list[Wanted]:
    passes = Inequality.CLEARANCE if edge.beyond else Inequality.BESIDE
    return [
        (about(ObligationId.TIP_REACHES_PART), Inequality.TRAVEL, ["reaches"]),
        *holds(Which.PUSHING, side, "pushing", edge),
        *(
            (about(PASSES, when=when), passes, [when.value])
            for when in (When.BEFORE_TOUCH, When.WHILE_TURNING, When.ON_WITHDRAWAL)
        ),
        (
            about(ObligationId.WITHDRAWS_FREE, tips=Which.PUSHING),
            Inequality.FACES_BACK,
            ["withdraws"],
        ),
    ]


def _lines(
    of: Implicit,
    box: Mapping[str, Interval],
    guess: float,
    side: int,
    edge: Edge,
    pre: PoseBox,
    setup: Setup,
) -> dict[str, Interval]:
    """The side of the part's convex hull that the idle tip is farthest off, from first to last."""
    sides = setup.sides(pre.theta.mid)
    if isinstance(setup.outline, Rectangle):  # the next edge the other way round is sides[3]
        sides = (sides[0], sides[3 if side > 0 else 1])
    found: dict[str, tuple[float, dict[str, Interval]]] = {}
    for line in sides:
        trial = {name: value for when in one_tip.LINES for name, value in _line(when, line, edge)}
        ends = [at_middle(of, {**box, **trial, "share": share}, guess) for share in ENDS]
        for when in one_tip.LINES:
            least = min(values[when] for values in ends)
            if when not in found or least > found[when][0]:
                found[when] = least, dict(_line(when, line, edge))
    return {name: value for _, chosen in found.values() for name, value in chosen.items()}


def _line(when: str, line: Line, edge: Edge) -> list[tuple[str, Interval]]:
    return [(f"{when}_turn", line.turn - edge.turn), (f"{when}_depth", line.depth)]
