"""Where the two-sided rotation has no solution at all: every contact mode tried, by linear solves.

``D`` moves along -x on one long edge, ``S`` rests on the opposite one; ``(h, V)`` is the vector from
S to D. At every place the two contacts stick, slip either way, or S separates; each mode is four
linear equations for the contact forces. Nothing of the derived limit enters. Lengths in mm, forces
over the film's drag: of order 1.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]
Flags = npt.NDArray[np.bool_]
Mode = Literal["stick", "slip along a", "slip against a", "apart"]

AT_D: tuple[Mode, ...] = (
    "stick",
    "slip along a",
    "slip against a",
)  # D cannot part: it comes closer
AT_S: tuple[Mode, ...] = (*AT_D, "apart")
SINGULAR = 1e-12


@dataclass(frozen=True, slots=True)
class Contact:
    """One contact at N places at once, in the edge frame (a, n)."""

    point: Floats
    """(N, 2, 4): velocity of the part's point along a and n, by force."""
    tip: Floats
    """(N, 2): velocity of the tip along a and n."""
    normal: int
    """Which of the four forces presses on the part here; the next one acts along a."""


def jams(V: Floats, h: Floats, mu: Floats, width: float, rho: float, slide: float = 0.0) -> Flags:
    """Whether no contact mode has a solution at each place.

    Parameters
    ----------
    V, h
        (N,) separation of the tips across and along the push, mm; both tips touch.
    mu
        (N,) coefficient of friction.
    width, rho
        Width of the part, mm, and its ratio of rotational to translational drag, mm^2.
    slide
        Place of the part's centre along a from the middle of both contacts, mm.
    """
    at_D, at_S = contacts(V, h, width, rho, slide)
    solved = np.zeros(V.shape, dtype=bool)
    for mode_D in AT_D:
        for mode_S in AT_S:
            solved |= _has_solution(((at_D, mode_D), (at_S, mode_S)), mu)
    return ~solved


def contacts(
    V: Floats, h: Floats, width: float, rho: float, slide: float
) -> tuple[Contact, Contact]:
    """Both contacts of the part at the only orientation at which both tips touch."""
    T = np.sqrt(h**2 + V**2 - width**2)
    # (h, V) = T a + width n with a = (c, s), n = (s, -c)
    c, s = (T * h - width * V) / (T**2 + width**2), (width * h + T * V) / (T**2 + width**2)
    p_D, p_S, d1 = T / 2 - slide, -T / 2 - slide, width / 2
    one, none = np.ones_like(T), np.zeros_like(T)
    # motion of the part along a, along n and about its centre, by the forces (n, t at D; n, t at S)
    motion = np.stack(
        [
            np.stack([none, one, none, one], axis=-1),
            np.stack([-one, none, one, none], axis=-1),
            np.stack([p_D, d1 * one, -p_S, -d1 * one], axis=-1) / rho,
        ],
        axis=-2,
    )

    def point(along: Floats, out: float) -> Floats:
        turn = motion[:, 2]
        return np.stack([motion[:, 0] + out * turn, motion[:, 1] - along[:, None] * turn], axis=-2)

    moves = np.stack([-c, -s], axis=-1)  # (-1, 0) in the edge frame
    return (
        Contact(point(p_D, d1), moves, normal=0),
        Contact(point(p_S, -d1), np.zeros_like(moves), normal=2),
    )


def _has_solution(modes: tuple[tuple[Contact, Mode], ...], mu: Floats) -> Flags:
    rows, sides = zip(*(_equations(contact, mode, mu) for contact, mode in modes), strict=True)
    matrix, side = np.concatenate(rows, axis=1), np.concatenate(sides, axis=1)
    regular = np.abs(np.linalg.det(matrix)) > SINGULAR
    matrix = np.where(regular[:, None, None], matrix, np.eye(4))
    forces = np.linalg.solve(matrix, side[..., None])[..., 0]
    for contact, mode in modes:
        for condition in _conditions(contact, mode, forces, mu):
            regular &= condition
    return regular


def _equations(contact: Contact, mode: Mode, mu: Floats) -> tuple[Floats, Floats]:
    """(N, 2, 4) and (N, 2): the two linear equations of a contact in a mode."""
    rows, side = contact.point.copy(), contact.tip.copy()
    if mode == "stick":
        return rows, side
    if mode == "apart":
        rows[:], side[:] = 0.0, 0.0
        rows[:, 0, contact.normal] = rows[:, 1, contact.normal + 1] = 1.0
        return rows, side
    # the point follows the tip along n only; friction opposes its slip along a
    rows[:, 0], side[:, 0] = 0.0, 0.0
    rows[:, 0, contact.normal] = mu if mode == "slip along a" else -mu
    rows[:, 0, contact.normal + 1] = 1.0
    return rows, side


def _conditions(contact: Contact, mode: Mode, forces: Floats, mu: Floats) -> Iterator[Flags]:
    """What a solution in a mode must satisfy besides its equations."""
    press, shear = forces[:, contact.normal], forces[:, contact.normal + 1]
    slip, lift = np.moveaxis(np.einsum("nij,nj->ni", contact.point, forces) - contact.tip, 1, 0)
    yield press >= 0.0
    if mode == "stick":
        yield np.abs(shear) <= mu * press
    elif mode == "apart":
        yield lift >= 0.0  # S is on the side that n points away from
    else:
        yield slip > 0.0 if mode == "slip along a" else slip < 0.0


def jam_map(mu: Floats, V: Floats, h: Floats, width: float, rho: float) -> Flags:
    """(V, mu) whether the rotation jams somewhere along ``h``, the part centred between the tips."""
    grid = np.meshgrid(V, mu, h, indexing="ij")
    flat = [axis.ravel() for axis in grid]
    found = jams(flat[0], flat[2], flat[1], width, rho)
    return np.asarray(found.reshape(grid[0].shape).any(axis=-1))
