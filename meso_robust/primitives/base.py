"""What is uncertain by itself in a move, by the names that certificates use, and what follows."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from meso_robust import units
from meso_robust.bounds import Box, Interval, Proof, Verdict, prove_positive
from meso_robust.bounds.implicit import Ends, Implicit, failing_point
from meso_robust.motion import one_tip
from meso_robust.primitives.move import Aim, Anchor, MoveRule
from meso_robust.primitives.names import (
    SIDES,
    TURNS,
    Inequality,
    Named,
    ObligationId,
    Which,
    about,
)
from meso_robust.primitives.obligation import Obligation
from meso_robust.primitives.outline import Edge, Line
from meso_robust.primitives.setup import PoseBox, Setup, Uncertainty

NOTHING, UNIT = Interval.point(0.0), Interval(0.0, 1.0)
BENDING = units.metres(100.0)
"""Length over which a probe's path strays by ``probe_wander`` at most: what bounds its direction."""


def bend_of(u: Uncertainty) -> Interval:
    """Tangent of the angle between a probe's path and its straight line.

    Parameters
    ----------
    u
        Of which the wander counts.

    Returns
    -------
    Interval
        Exactly zero where no probe wanders.
    """
    astray = u.probe_wander
    return astray / BENDING if astray.hi > 0.0 else astray


def base_box(rule: MoveRule, pre: PoseBox, setup: Setup, edge: Edge) -> dict[str, Interval]:
    """The range of everything that a push depends on.

    Parameters
    ----------
    rule, pre, setup
        The move, all poses before it, the task; all in the move's axes.
    edge
        The edge that is pushed.

    Returns
    -------
    dict
        Parameters and constants of :mod:`meso_robust.motion.one_tip`, SI.
    """
    u = setup.uncertainty
    anisotropy, astray = u.drag_anisotropy, u.probe_wander
    drag = {"rho": u.film_ratio, "stretch": anisotropy, "shear": anisotropy, "bend": bend_of(u)}
    drag |= dict.fromkeys(one_tip.CENTRE, setup.moving_centre)
    return {
        "x": pre.x,
        "y": pre.y,
        "theta": pre.theta,
        "sensed_x": u.sensed_position,
        "sensed_y": u.sensed_position,
        "probe_x": u.probe_position,
        "probe_y": u.probe_position,
        "direction": u.travel_direction,
        "scale": u.travel_scale,
        **dict.fromkeys(("wander_x", "wander_y", "wander_x_now", "wander_y_now"), astray),
        "beta": u.misalignment,
        "spacing": setup.spacing,
        "radius_upper": u.tip_radius,
        "radius_lower": u.tip_radius,
        "depth": edge.depth,
        "kappa": u.squareness,
        "drag_a": setup.fixed_centre,
        "drag_n": setup.fixed_centre,
        **drag,
        **{f"{name}_now": range_ for name, range_ in drag.items()},
        "mu_upper_now": u.friction,
        "mu_lower_now": u.friction,
        **dict.fromkeys((one_tip.CREEP, one_tip.CREEP_MOST, one_tip.TURNED), NOTHING),
        one_tip.PROGRESS: UNIT,
        "share": UNIT,
        "turn": edge.turn,
        "part_x": _from_part(rule.dual.x),
        "part_y": _from_part(rule.dual.y),
        "part_end": _from_part(rule.dual_end),
        "offset_x": rule.dual.x.offset,
        "offset_y": rule.dual.y.offset,
        "offset_end": rule.dual_end.offset,
        "first": edge.first,
        "last": edge.last,
        "stray_x": astray + astray,
        "stray_y": astray + astray,
    }


def _from_part(aim: Aim) -> Interval:
    return Interval.point(1.0 if aim.anchor is Anchor.PART else 0.0)


Wanted = tuple[Named, Inequality, list[str]]
"""What is to hold, the inequality that it is, and the outputs that must be positive."""


def holds(which: Which, side: int, contact: str, edge: Edge) -> list[Wanted]:
    """One contact alone is on its edge, pushes, sticks, turns the part to ``side``, and only that.

    Parameters
    ----------
    which
        What the tip is called in the names of obligations.
    side
        Which way it turns the part.
    contact
        What it is called in the names of outputs.
    edge
        The edge that is pushed.
    """
    ends = Inequality.BETWEEN_CORNERS if edge.beyond else Inequality.WITHIN_EDGE
    turn = TURNS[side]
    rows = (
        (about(ObligationId.TIP_ON_EDGE, tip=which), ends, ("below_end", "above_end")),
        (about(ObligationId.TIP_PUSHES, tip=which), Inequality.NORMAL_FORCE, ("pushes",)),
        (
            about(ObligationId.TIP_STICKS, tip=which),
            Inequality.FRICTION_MARGIN,
            ("sticks_up", "sticks_down"),
        ),
        (about(ObligationId.TIP_TURNS_PART, tip=which, turn=turn), Inequality.TURNING, ("turns",)),
        (
            about(ObligationId.NO_SLIPPING, tip=which),
            Inequality.ONLY_SOLUTION,
            ("only_up", "only_down"),
        ),
    )
    return [
        (name, inequality, [f"{contact}_{o}" for o in outputs])
        for name, inequality, outputs in rows
    ]


def free_at_start(tips: Sequence[int], box: Box, edge: Edge) -> tuple[Obligation, ...]:
    """These tips (1: upper, -1: lower) stand clear of the edge's line before the move.

    Parameters
    ----------
    tips, box
        Which tips, and the base parameters of the move.
    edge
        The edge that is pushed.

    Returns
    -------
    tuple[Obligation, ...]
        One a tip.
    """
    start = {**box, "share": NOTHING}
    line = Line(turn=edge.turn - box["kappa"], depth=edge.depth)
    return tuple(off_line(ObligationId.TIP_FREE_AT_START, tip, line, start) for tip in tips)


def off_line(id_: ObligationId, tip: int, line: Line, box: Box) -> Obligation:
    """A tip is off a line on its way, while nothing touches the part.

    Parameters
    ----------
    id_
        What that means for the move.
    tip
        1: the upper one, -1: the lower one.
    line
        A side of the part's convex hull, its own error of direction in its turn.
    box
        The base parameters of the move; ``share`` tells how much of the way.

    Returns
    -------
    Obligation
        Proved or not.
    """
    of = one_tip.passing(tip, one_tip.zeros(box))
    there = {**box, "line_turn": line.turn, "line_depth": line.depth}
    proof = prove_positive(of, {name: there[name] for name in of.inputs})
    return Obligation(
        name=about(id_, tip=SIDES[tip]),
        inequality=Inequality.CLEARANCE,
        proof=replace(proof, box=stated(proof.box)),
    )


def positive(
    wanted: Wanted,
    of: Implicit,
    box: Mapping[str, Interval],
    ends: Ends | None,
    guess: float | None = None,
) -> Obligation:
    """Record that outputs of a motion are proved to be positive over ``box``, or that they are not.

    Parameters
    ----------
    wanted
        What is to be positive.
    of, box, ends
        The motion, its parameters, and what was proved of it; None: nothing.
    guess
        Where the end may be at the middle of the box, from which a point is looked for that refutes
        what is not proved; None: it is not looked for.

    Returns
    -------
    Obligation
        Over those parameters that the outputs depend on and that are not exactly zero.
    """
    name, inequality, outputs = wanted
    least = -float("inf") if ends is None else min(ends.lower[output] for output in outputs)
    uses = np.any(of.uses[[of.outputs.index(output) for output in outputs]], axis=0)
    over = stated({of.parameters[k]: box[of.parameters[k]] for k in np.flatnonzero(uses)})
    proved = least > 0.0
    verdict, at = Verdict.PROVED if proved else Verdict.UNKNOWN, over
    if guess is not None and not proved:
        point = failing_point(of, box, guess, outputs)
        if point is not None:
            verdict, at = Verdict.REFUTED, {key: point[key] for key in over}
    lower = least if proved else -float("inf")
    return Obligation(
        name=name,
        inequality=inequality,
        proof=Proof(verdict=verdict, lower=lower, boxes=1, box=at),
    )


def stated(box: Box) -> Box:
    """Of a box what a certificate states: parameters that are not exactly zero, and no constants.

    Parameters
    ----------
    box
        By the names of :mod:`meso_robust.motion.one_tip`.

    Returns
    -------
    Box
        What is left.
    """
    return {
        name: side
        for name, side in box.items()
        if name in one_tip.PARAMETERS and not side.lo == 0.0 == side.hi
    }


def pose_of(ends: Ends) -> PoseBox:
    """The box of poses that a motion ends in."""
    x, y, theta = (Interval(ends.lower[key], ends.upper[key]) for key in ("x", "y", "theta"))
    return PoseBox(x=x, y=y, theta=theta)
