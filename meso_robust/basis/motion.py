"""A basis over a time interval: the motion is enclosed and the basis proved all along it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import casadi as ca
import numpy as np

from meso_robust.basis.boxes import split, stuck
from meso_robust.basis.bulk import exclude_many
from meso_robust.basis.contact import Contact, Mode, Part, Tip
from meso_robust.basis.flow import THETA, Flow, step
from meso_robust.basis.layout import layout
from meso_robust.basis.problem import ANGLE, assemble, drift
from meso_robust.basis.prove import MOST_BOXES, check, exclude_others, undecided_proof, unsound
from meso_robust.basis.support import Support
from meso_robust.bounds import Box, Verdict
from meso_robust.errors import InputError
from meso_robust.types import Floats, Ints

MOST_PIECES = 256
"""The box of starts is cut into no more pieces."""
TRIED = 4
"""So many pieces that were not proved are tried for a counterexample."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class MotionProof:
    """What was found out about one combination of modes over a time interval.

    Attributes
    ----------
    verdict
        PROVED: from every start and for all parameters in the box, also parameters that change in
        time within it, there is a motion over the whole duration that keeps these modes. REFUTED:
        from no start in `box` do the modes last.
    unique
        PROVED: no other modes solve the contact problem anywhere on the tube, so that this motion is
        the only one.
    box
        The whole box of starts; REFUTED, UNKNOWN: the piece of it that was refuted or is undecided.
    reason
        What is undecided or violated; empty if both verdicts are PROVED.
    names
        Columns of the tube: displacement ``x``, ``y`` of the reference point from its start (m,
        world), ``theta`` (rad), and ``drift i`` of each tip that slips along its edge (m).
    times
        (steps + 1,) when the tube is cut.
    tube
        (steps + 1, columns, 2) all states at these times; empty unless PROVED.
    swept
        (steps, columns, 2) all states between two of them.
    pieces
        Into how many pieces the box of starts was cut.
    boxes
        How many boxes of the tube were proved, and bounded for `unique`.
    """

    verdict: Verdict
    unique: Verdict
    box: Box
    reason: str
    names: tuple[str, ...]
    times: Floats
    tube: Floats
    swept: Floats
    pieces: int
    boxes: tuple[int, int]


def prove_motion(
    part: Part,
    contacts: Sequence[Contact],
    support: Support,
    modes: Sequence[Mode],
    box: Box,
    duration: float,
    *,
    steps: int = 64,
    unique: bool = True,
) -> MotionProof:
    """Prove that contact modes last from every start in a box, and enclose the motion.

    Parameters
    ----------
    part, contacts, support
        What is pushed, by what, on what; the movers keep their velocities.
    modes
        One mode for each contact, not OPEN: state the contacts that last.
    box
        An interval for ``theta`` at the start in rad and for every parameter that is named; where a
        tip touches (`Tip.at`) is its place at the start.
    duration
        In the unit of time of the velocities.
    steps
        A power of two, so that the steps add up to the duration exactly.
    unique
        Whether to exclude all other combinations as well.

    Raises
    ------
    InputError
        As :func:`~meso_robust.basis.prove.prove_basis`; or if a mode is OPEN, or duration or steps
        break their rule.
    """
    check(contacts, modes)
    _check_motion(contacts, modes, duration, steps)
    slipping = tuple(
        i
        for i, (contact, mode) in enumerate(zip(contacts, modes, strict=True))
        if isinstance(contact, Tip) and mode is not Mode.STICK
    )
    problem = assemble(part, contacts, support, box, (ANGLE, *map(drift, slipping)))
    flow = Flow(problem, layout([modes], problem.movers), slipping)
    nothing = _nothing(flow, box)
    refusal = unsound(problem, problem.lo, problem.hi, support)
    if refusal:
        return replace(nothing, reason=refusal)
    plan = _Plan(flow, support, tuple(modes), duration / steps, steps, unique)
    return _march(plan, nothing)


def _check_motion(
    contacts: Sequence[Contact], modes: Sequence[Mode], duration: float, steps: int
) -> None:
    for i, contact in enumerate(contacts):
        at = contact.at if isinstance(contact, Tip) else 0.0
        if (isinstance(at, str) and at == ANGLE) or (
            isinstance(at, ca.SX) and ANGLE in {v.name() for v in ca.symvar(at)}
        ):
            raise InputError(
                f"contact {i} at: depends on theta; must be a place of the start, which theta is "
                "not once the part turns; name the angle of the start otherwise"
            )
    if Mode.OPEN in modes:
        raise InputError("modes: OPEN; must persist for the whole duration; leave the contact out")
    if not 0.0 < duration < np.inf:
        raise InputError(f"duration: {duration}; must be positive and finite; correct the value")
    if steps < 1 or steps & (steps - 1):
        raise InputError(f"steps: {steps}; must be a power of two; try 64")


def _nothing(flow: Flow, box: Box) -> MotionProof:
    """The answer when nothing is known yet."""
    names = ("x", "y", ANGLE, *map(drift, flow.slipping))
    return MotionProof(
        verdict=Verdict.UNKNOWN,
        unique=Verdict.UNKNOWN,
        box=box,
        reason="",
        names=names,
        times=np.empty(0),
        tube=np.empty((0, len(names), 2)),
        swept=np.empty((0, len(names), 2)),
        pieces=1,
        boxes=(0, 0),
    )


@dataclass(slots=True, eq=False)
class _Tubes:
    """Tubes of the pieces that were followed to the end: lists of (N, steps (+ 1), columns, 2)."""

    knots: list[Floats]
    swept: list[Floats]
    rest: list[Floats]


@dataclass(frozen=True, slots=True, eq=False)
class _Plan:
    """What is to be proved, and how."""

    flow: Flow
    support: Support
    modes: tuple[Mode, ...]
    h: float
    steps: int
    unique: bool


def _march(plan: _Plan, nothing: MotionProof) -> MotionProof:
    """Follow the whole box of starts; cut the pieces that cannot be followed to the end."""
    flow, lo, hi, pieces = plan.flow, plan.flow.problem.lo[None], plan.flow.problem.hi[None], 1
    done = _Tubes([], [], [])
    whole = np.maximum(hi - lo, np.finfo(float).tiny)
    while True:
        failed, refuted = _follow(flow, lo, hi, plan.h, plan.steps, done)
        if not len(failed):
            return _finished(plan, done, replace(nothing, pieces=pieces))
        if refuted is None:
            lo, hi = lo[failed], hi[failed]
            refuted = _counterexample(plan, lo, hi)
        if refuted is not None:
            return replace(
                nothing,
                verdict=Verdict.REFUTED,
                box=flow.problem.named(*refuted),
                reason="the modes end before the duration from every start in the box",
                pieces=pieces,
            )
        pieces += len(lo)
        if pieces > MOST_PIECES or stuck(lo, hi):
            return replace(
                nothing,
                box=flow.problem.named(lo[0], hi[0]),
                reason="the modes could not be proved to last from this piece of the box",
                pieces=pieces,
            )
        lo, hi = split(lo, hi, (hi - lo) / whole)


_Piece = tuple[Floats, Floats]


def _counterexample(plan: _Plan, lo: Floats, hi: Floats) -> _Piece | None:
    """The middle of one of the first pieces, if the modes are proved to end from there."""
    middle = 0.5 * (lo[:TRIED] + hi[:TRIED])
    return _follow(plan.flow, middle, middle, plan.h, plan.steps, _Tubes([], [], []))[1]


def _follow(
    flow: Flow, lo: Floats, hi: Floats, h: float, steps: int, done: _Tubes
) -> tuple[Ints, _Piece | None]:
    """Follow all pieces (N, parameters); keep the tubes of those that arrive.

    Returns the numbers of those that do not, and a piece for which the modes are proved to end.
    """
    whole = np.stack([lo, hi], axis=-1)
    rest = whole[:, flow.size - THETA :]
    state = np.concatenate([np.zeros((len(lo), 2, 2)), whole[:, : flow.size - THETA]], axis=1)
    alive, held = np.ones((2, len(lo)), dtype=np.bool_)
    knots, swept = [state], []
    for _ in range(steps):
        taken = step(flow, state[alive], rest[alive], h)
        now = np.flatnonzero(alive)
        alive[now], held[now] = taken.known, held[now] & taken.holds
        over = state.copy()
        state = state.copy()
        over[now], state[now] = taken.swept, taken.end
        knots.append(state)
        swept.append(over)
        ended = _ended(flow, state, rest, np.flatnonzero(alive & ~held))
        if ended is not None:
            return np.flatnonzero(~held), (lo[ended], hi[ended])
        if not alive.any():
            break
    held &= alive
    if held.any():
        done.knots.append(np.stack([knot[held] for knot in knots], axis=1))
        done.swept.append(np.stack([box[held] for box in swept], axis=1))
        done.rest.append(rest[held])
    return np.flatnonzero(~held), None


def _ended(flow: Flow, state: Floats, rest: Floats, doubtful: Ints) -> int | None:
    """A piece that, had the modes lasted, would now be where they have no solution at all."""
    if not len(doubtful):
        return None
    box = flow.box(state[doubtful], rest[doubtful])
    where = np.flatnonzero(exclude_many(flow.problem, flow.of, *box).states[:, 0] == 1)
    return int(doubtful[where[0]]) if where.size else None


def _hull(of: Floats) -> Floats:
    """Hull over the first axis."""
    return np.stack([of[..., 0].min(axis=0), of[..., 1].max(axis=0)], axis=-1)


def _finished(plan: _Plan, done: _Tubes, nothing: MotionProof) -> MotionProof:
    """The proof for a tube on which the basis holds."""
    flow = plan.flow
    knots, swept = np.concatenate(done.knots), np.concatenate(done.swept)
    steps = swept.shape[1]
    rest = np.repeat(np.concatenate(done.rest), steps, axis=0)
    lo, hi = flow.box(swept.reshape(-1, flow.size, 2), rest)
    refusal = unsound(flow.problem, lo.min(axis=0), hi.max(axis=0), plan.support)
    if refusal:
        return replace(nothing, reason=refusal)
    proof = undecided_proof("other modes were not looked at", nothing.box, len(lo))
    if plan.unique:
        proof = exclude_others(flow.problem, plan.modes, lo, hi, proof, MOST_BOXES + 2 * len(lo))
    return replace(
        nothing,
        verdict=Verdict.PROVED,
        unique=proof.unique,
        reason=proof.reason,
        times=plan.h * np.arange(steps + 1),
        tube=_hull(knots),
        swept=_hull(swept),
        boxes=(len(lo), proof.unique_boxes),
    )
