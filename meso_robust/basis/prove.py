"""The basis certificate: one complementarity basis solves the contact problem over a whole box.

What PROVED says, for every choice of pose and parameters in the box: the contact problem of that
instant has a solution in the stated modes, with every force strictly inside its range and every
relative speed strictly of its sign, and its twist is the only one in these modes. The forces are
unique too, unless two contacts of one solid stick: then they are a line along the internal force,
and it is proved that some of them are strictly inside both cones. With `unique` PROVED no other
combination of modes has a solution, so that neither stick-slip nor take-off can occur: all
solutions have this twist and these modes.

The contacts given are all there are, and they are closed at the instant.

Source: the paper, Section XI ("the LCP solutions ... use the same complementarity basis").
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from meso_robust.basis.boxes import split, stuck, widest
from meso_robust.basis.bulk import exclude_many, hold_many
from meso_robust.basis.contact import Contact, Mode, Part
from meso_robust.basis.layout import FREE, Layout, layout, others
from meso_robust.basis.problem import Problem, assemble
from meso_robust.basis.support import Support
from meso_robust.bounds import Box, Interval, Verdict, prove_positive
from meso_robust.errors import InputError
from meso_robust.types import Floats

MOST_BOXES = 20_000
MOST_CONTACTS = 4


@dataclass(frozen=True, slots=True, kw_only=True)
class BasisProof:
    """What was found out about one combination of modes over one box."""

    verdict: Verdict
    """Whether the modes solve the contact problem at every point of the box."""
    unique: Verdict
    """Whether no other modes do: PROVED or UNKNOWN; UNKNOWN also if it was not asked for."""
    box: Box
    """PROVED: the whole box; REFUTED: a point at which these modes have no solution; UNKNOWN: an
    undecided box."""
    reason: str
    """What is undecided or violated; empty if both verdicts are PROVED."""
    boxes: int
    """How many boxes were bounded for `verdict` ..."""
    unique_boxes: int
    """... and for `unique`."""


def prove_basis(
    part: Part,
    contacts: Sequence[Contact],
    support: Support,
    modes: Sequence[Mode],
    box: Box,
    *,
    unique: bool = True,
    most_boxes: int = MOST_BOXES,
) -> BasisProof:
    """Prove that one combination of contact modes holds over a box of poses and parameters.

    Parameters
    ----------
    part, contacts, support
        What is pushed, by what, on what.
    modes
        One mode for each contact.
    box
        An interval for ``theta`` in rad and for every parameter that is named.
    unique
        Whether to exclude all other combinations as well.
    most_boxes
        Bisection gives up, UNKNOWN, when so many boxes were bounded; for each of the two verdicts.

    Raises
    ------
    InputError
        If modes and contacts differ in number, there are none or more than four, or the box lacks
        a parameter.

    Examples
    --------
    >>> from meso_robust.basis.support import diagonal_film
    >>> from meso_robust.basis import Mover, Tip
    >>> tip = Tip(edge=0, at="d2", friction="mu", mover=Mover((-1.0, 0.0)))
    >>> box = {"theta": Interval(1.7, 1.8), "d2": Interval(3.4e-4, 3.6e-4),
    ...        "mu": Interval(0.3, 0.36), "rho": Interval(3.5e-7, 4.0e-7)}
    >>> proof = prove_basis(Part.rectangle(1.616e-3, 8.37e-4), [tip], diagonal_film("rho"),
    ...                     [Mode.STICK], box)
    >>> proof.verdict.word, proof.unique.word
    ('PROVED', 'PROVED')
    """
    check(contacts, modes)
    problem = assemble(part, contacts, support, box)
    refusal = unsound(problem, problem.lo, problem.hi, support)
    if refusal:
        return undecided_proof(refusal, box, 0)
    lo, hi = problem.lo[None], problem.hi[None]
    first = _hold(problem, modes, lo, hi, most_boxes)
    if first.verdict is not Verdict.PROVED or not unique:
        return first
    return exclude_others(problem, modes, lo, hi, first, most_boxes)


def check(contacts: Sequence[Contact], modes: Sequence[Mode]) -> None:
    """Refuse a combination that does not fit the contacts.

    Raises
    ------
    InputError
        If modes and contacts differ in number, or there are none or more than four.
    """
    if len(modes) != len(contacts) or not 1 <= len(contacts) <= MOST_CONTACTS:
        raise InputError(
            f"modes: {len(modes)} for {len(contacts)} contacts; must be one for each of 1 to "
            f"{MOST_CONTACTS} contacts; state the contacts that touch"
        )


def unsound(problem: Problem, lo: Floats, hi: Floats, support: Support) -> str:
    """Why nothing can be proved over the box with ends (parameters,); empty if something can."""
    if support.missing:
        return f"the support has no enclosure: {support.missing}"
    box = dict(zip(problem.names, map(Interval, lo.tolist(), hi.tolist()), strict=True))
    if prove_positive(problem.sound, box).verdict is not Verdict.PROVED:
        return "the drag may not be positive definite, or a friction coefficient not positive"
    pushed = prove_positive(problem.pushing, box, any_output=True).verdict is Verdict.PROVED
    on_edge = prove_positive(problem.inside, box).verdict is Verdict.PROVED
    if not on_edge:
        return "a tip may lie beyond the end of its edge"
    if support.dry and not pushed:
        return "the part may rest under dry friction: no obstacle surely moves into it"
    return ""


def undecided_proof(reason: str, box: Box, boxes: int) -> BasisProof:
    """Nothing is proved, for a reason."""
    return BasisProof(
        verdict=Verdict.UNKNOWN,
        unique=Verdict.UNKNOWN,
        box=box,
        reason=reason,
        boxes=boxes,
        unique_boxes=0,
    )


def _hold(problem: Problem, modes: Sequence[Mode], lo: Floats, hi: Floats, most: int) -> BasisProof:
    """Bisect until the modes hold on every box, fail at a point, or too many boxes are spent."""
    of, spent = layout([modes], problem.movers), 0
    while True:
        found = hold_many(problem, of, lo, hi)
        spent += len(lo)
        open_ = found.states[:, 0] != 1
        lo, hi, smear, unknowns = lo[open_], hi[open_], found.smear[open_], found.unknowns[open_]
        if not len(lo):
            return BasisProof(
                verdict=Verdict.PROVED,
                unique=Verdict.UNKNOWN,
                box=problem.named(problem.lo, problem.hi),
                reason="other modes were not looked at",
                boxes=spent,
                unique_boxes=0,
            )
        refuted = _refuted(problem, of, lo, hi)
        if refuted is not None:
            return BasisProof(
                verdict=Verdict.REFUTED,
                unique=Verdict.UNKNOWN,
                box=refuted,
                reason=f"no solution in the modes {_words(modes)} at this point",
                boxes=spent,
                unique_boxes=0,
            )
        if stuck(lo, hi) or spent + 2 * len(lo) > most:
            k = widest(lo, hi)
            return undecided_proof(undecided(of, unknowns[k]), problem.named(lo[k], hi[k]), spent)
        lo, hi = split(lo, hi, smear)


def _refuted(problem: Problem, of: Layout, lo: Floats, hi: Floats) -> Box | None:
    """The middle of a box at which the combination is proved to have no solution, if any."""
    middle = 0.5 * (lo + hi)
    where = np.flatnonzero(exclude_many(problem, of, middle, middle).states[:, 0] == 1)
    return problem.named(middle[where[0]], middle[where[0]]) if where.size else None


def exclude_others(
    problem: Problem,
    modes: Sequence[Mode],
    lo: Floats,
    hi: Floats,
    held: BasisProof,
    most: int,
) -> BasisProof:
    """Add to a proof that all other modes are excluded on the boxes (N, parameters), if they are."""
    rest = others(modes)
    of, spent = layout(rest, problem.movers), 0
    done = np.zeros((len(lo), len(rest)), dtype=np.int8)
    verdict, reason = Verdict.PROVED, ""
    while True:
        done, _, _, smear = exclude_many(problem, of, lo, hi, done)
        spent += len(lo)
        open_ = (done != 1).any(axis=1)
        lo, hi, smear, done = lo[open_], hi[open_], smear[open_], done[open_]
        if not len(lo):
            break
        if stuck(lo, hi) or spent + 2 * len(lo) > most:
            k = widest(lo, hi)
            left = rest[int(np.flatnonzero(done[k] != 1)[0])]
            verdict = Verdict.UNKNOWN
            reason = (
                f"the modes {_words(left)} are not excluded near {_place(problem, lo[k], hi[k])}"
            )
            break
        lo, hi = split(lo, hi, smear)
        done = np.concatenate([done, done])
    return BasisProof(
        verdict=held.verdict,
        unique=verdict,
        box=held.box,
        reason=reason,
        boxes=held.boxes,
        unique_boxes=spent,
    )


def undecided(of: Layout, unknowns: Floats) -> str:
    """Which unknowns (n, 2) of the first combination are not proved to be positive."""
    least = unknowns[:, 0]
    if not np.isfinite(least).all():
        return "the system may be singular"
    low = [i for i in range(len(least)) if of.kind[0, i] != FREE and not least[i] > 0.0]
    return "undecided: " + ", ".join(
        _unknown_of(Mode(int(of.modes[0, (i - 3) // 2])), i) for i in low
    )


_UNKNOWNS = {
    Mode.OPEN: ("gap speed", "speed along t"),
    Mode.STICK: ("force on the + edge of the cone", "force on the - edge of the cone"),
    Mode.SLIP_PLUS: ("force", "slip speed"),
    Mode.SLIP_MINUS: ("force", "slip speed"),
}


def _unknown_of(mode: Mode, i: int) -> str:
    return f"{_UNKNOWNS[mode][(i - 3) % 2]} of contact {(i - 3) // 2}"


def _words(modes: Sequence[Mode]) -> str:
    return ", ".join(Mode(mode).name for mode in modes)


def _place(problem: Problem, lo: Floats, hi: Floats) -> str:
    middle = 0.5 * (lo + hi)
    named = zip(problem.names[: problem.varying], middle.tolist(), strict=False)
    return ", ".join(f"{name} = {value:.6g}" for name, value in named)
