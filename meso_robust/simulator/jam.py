"""Why a run jammed: the contacts that close it, and the friction at which they begin to.

The jam is proved once more, by another route than the kernels': each combination of contact modes is
a system of equations in non-negative unknowns, which Lawson and Hanson's method (SciPy) solves or shows
to have none.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import numpy as np

from meso_robust.simulator.arrange import prepare
from meso_robust.simulator.batch import run_range
from meso_robust.simulator.outcome import Outcome
from meso_robust.simulator.outline import refuse
from meso_robust.simulator.push import Push
from meso_robust.simulator.tables import CONTACT_COLUMNS, CONTACTS, MAX_CONTACTS
from meso_robust.types import Floats

_RESIDUAL = 1e-9  # of a sum that equals q, relative to q
_HALVINGS = 30  # of the share of the friction, to 1e-9
_MOST = 5  # contacts: 4^5 combinations of modes

# Of (λ_n, λ_f+, λ_f−, γ) of a contact, those that may be positive; their complements otherwise.
_MODES = ((3,), (0, 1, 2), (0, 1, 3), (0, 2, 3))  # separate, stick, slip +, slip −


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Jam:
    """A step that no contact mode solves."""

    pose: Floats
    """(3,) pose at which the part jams: m, m, rad."""
    obstacles: tuple[str, ...]
    """What each contact is with: ``probe k`` or ``fixture k``."""
    points: Floats
    """(C, 2) points of contact, m, world frame."""
    normals: Floats
    """(C, 2) normals into the part, world frame."""
    friction: Floats
    """(C,) friction coefficient of each contact."""
    closing_share: float
    """Share of all friction coefficients from which on the part jams here."""

    @property
    def closing_angle(self) -> float:
        """Largest friction angle of a contact at which the part begins to jam here, rad."""
        return float(np.arctan(self.closing_share * np.max(self.friction)))

    @property
    def message(self) -> str:
        """The reason in a sentence."""
        where = " and ".join(self.obstacles)
        return (
            f"{where} hold the part: its friction cones close from "
            f"{np.degrees(self.closing_angle):.2f} deg on, "
            f"and the friction is {np.degrees(np.arctan(np.max(self.friction))):.2f} deg"
        )


def explain_jam(push: Push, run: int) -> Jam:
    """Tell why a run jammed.

    Parameters
    ----------
    push
        The move.
    run
        Row of a run whose outcome is a jam.

    Returns
    -------
    Jam
        The contacts of the step without a solution.

    Raises
    ------
    ValueError
        If the run does not jam, or has more contacts than can be tried.
    """
    inputs, outputs = prepare(push)
    outputs = outputs._replace(ended=np.zeros((len(push.poses), MAX_CONTACTS, CONTACT_COLUMNS + 1)))
    run_range(inputs, run, run + 1, outputs)
    outcome = Outcome(int(outputs.outcomes[run]))
    if outcome is not Outcome.JAM:
        refuse("run", f"{run} ended as {outcome.name}", "must be a jam", "choose another run")
    table = outputs.ended[run]
    who = table[:, CONTACT_COLUMNS].astype(int)
    # Contacts that do not close in the step are no part of the jam.
    near = np.flatnonzero((who >= 0) & (table[:, CONTACTS.qn] < 1.0))
    table, who = table[near], who[near]
    if len(table) > _MOST or not _jams(table, 1.0):
        refuse("run", f"{run} has {len(table)} contacts", f"must have 1 to {_MOST}", "see its path")
    pose = outputs.poses[run].copy()
    turn = np.exp(1j * pose[2])
    probes = len(push.shapes)
    return Jam(
        pose=pose,
        obstacles=tuple(f"probe {k}" if k < probes else f"fixture {k - probes}" for k in who),
        points=_turned(turn, table[:, CONTACTS.px : CONTACTS.px + 2]) + pose[:2],
        normals=_turned(turn, -table[:, CONTACTS.nx : CONTACTS.nx + 2]),
        friction=table[:, CONTACTS.mu].copy(),
        closing_share=_closing_share(table),
    )


def _turned(turn: complex, vectors: Floats) -> Floats:
    z = turn * (vectors[:, 0] + 1j * vectors[:, 1])
    return np.column_stack([z.real, z.imag])


def _closing_share(table: Floats) -> float:
    low, high = 0.0, 1.0
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        low, high = (low, middle) if _jams(table, middle) else (middle, high)
    return high


def _jams(table: Floats, share: float) -> bool:
    """Whether no combination of contact modes solves the step with a share of the friction."""
    from scipy.optimize import nnls

    M, q = _problem(table, share)
    for modes in itertools.product(_MODES, repeat=len(table)):
        basis = [4 * c + k for c, mode in enumerate(modes) for k in mode]
        columns = np.eye(len(q))
        columns[:, basis] = -M[:, basis]
        _, residual = nnls(columns, q)
        if residual <= _RESIDUAL * np.linalg.norm(q):
            return False
    return True


def _problem(table: Floats, share: float) -> tuple[Floats, Floats]:
    """M and q of ``w = M z + q`` for the rows of the contacts."""
    count = len(table)
    wn, wt = table[:, CONTACTS.wn : CONTACTS.wn + 3], table[:, CONTACTS.wt : CONTACTS.wt + 3]
    J = np.stack([wn, wt, -wt, 0.0 * wn], axis=1).reshape(4 * count, 3)
    M = J @ J.T
    for c in range(count):
        block = M[4 * c : 4 * c + 4, 4 * c : 4 * c + 4]
        block[1:3, 3] += 1.0
        block[3, 1:3] -= 1.0
        block[3, 0] += share * table[c, CONTACTS.mu]
    q = np.zeros(4 * count)
    q[0::4], q[1::4], q[2::4] = table[:, CONTACTS.qn], table[:, CONTACTS.qt], -table[:, CONTACTS.qt]
    return M, q
