"""Where the pieces of the contact problem stand in the linear system of one combination of modes.

Unknowns: the twist (3), then two for each contact, by its mode:

=========  ========================  =========================  ==========================
mode       first                     second                     zero
=========  ========================  =========================  ==========================
OPEN       gap speed > 0             speed along t (any)        force
STICK      force along n + mu t > 0  force along n - mu t > 0   both speeds
SLIP_PLUS  force along n + mu t > 0  speed along -t > 0         gap speed
SLIP_MINUS force along n - mu t > 0  speed along +t > 0         gap speed
=========  ========================  =========================  ==========================

Every state of a contact is one of the four if forces may also be zero: the modes divide the
solutions by their relative velocities.

Two sticking contacts of one solid leave one internal force open, and one of their four speed rows
says nothing new. They are written as: the first sticks, the part does not turn (``omega = 0``), and
one linear relation between the four forces, which the kernel chooses.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from meso_robust.basis.contact import Mode
from meso_robust.basis.problem import (
    DRAG,
    MINUS,
    NORMAL,
    PER_CONTACT,
    PLUS,
    SPEED,
    TANGENT,
)
from meso_robust.types import Floats, Ints

FREE, FORCE, MOTION = 0, 1, 2
"""Kinds of unknowns: any sign, a force, a relative speed."""


class Layout(NamedTuple):
    """The systems of M combinations of modes, n = 3 + 2 contacts."""

    modes: Ints
    """(M, contacts)"""
    piece: Ints
    """(M, n, n + 1): which piece stands there, the right side last; -1 for none."""
    sign: Floats
    """(M, n, n + 1): with which sign."""
    constant: Floats
    """(M, n, n + 1): what stands there besides."""
    kind: Ints
    """(M, n): kind of each unknown."""
    pair: Ints
    """(M, 3): the redundant pair of contacts, or -1 twice; and whether there are further pairs."""
    movers: Ints
    """(contacts,): the solid of each."""


_DRAG_PLACES = ((0, 1, 2), (1, 3, 4), (2, 4, 5))


def layout(combinations: Sequence[Sequence[Mode]], movers: Ints) -> Layout:
    """Lay out the systems of some combinations of modes."""
    systems = [_system(modes, movers) for modes in combinations]
    piece, sign, constant, kind, pair = (np.array(each) for each in zip(*systems, strict=True))
    modes = np.array([[int(mode) for mode in modes] for modes in combinations], dtype=np.int64)
    return Layout(modes, piece, sign, constant, kind, pair, movers)


def others(modes: Sequence[Mode]) -> list[tuple[Mode, ...]]:
    """All other combinations for as many contacts."""
    return [every for every in itertools.product(Mode, repeat=len(modes)) if every != tuple(modes)]


def redundant(modes: Sequence[Mode], movers: Ints) -> tuple[int, int, int]:
    """The first two sticking contacts of one solid, or -1 twice; 1 if there are further pairs."""
    stuck = [i for i, mode in enumerate(modes) if mode is Mode.STICK]
    pairs = [(i, j) for i, j in itertools.combinations(stuck, 2) if movers[i] == movers[j]]
    first = pairs[0] if pairs else (-1, -1)
    return (*first, int(len(pairs) > 1))


_System = tuple[Ints, Floats, Floats, Ints, tuple[int, int, int]]


def _system(modes: Sequence[Mode], movers: Ints) -> _System:
    n = 3 + 2 * len(modes)
    piece = np.full((n, n + 1), -1, dtype=np.int64)
    sign, constant = np.ones((n, n + 1)), np.zeros((n, n + 1))
    kind = np.full(n, FREE, dtype=np.int64)
    piece[:3, :3] = _DRAG_PLACES
    for i, mode in enumerate(modes):
        base, at = DRAG + PER_CONTACT * i, 3 + 2 * i
        piece[at, :3] = base + NORMAL + np.arange(3)
        piece[at + 1, :3] = base + TANGENT + np.arange(3)
        piece[at, n], piece[at + 1, n] = base + SPEED, base + SPEED + 1
        forces = {Mode.STICK: (PLUS, MINUS), Mode.SLIP_PLUS: (PLUS,), Mode.SLIP_MINUS: (MINUS,)}
        for k, edge in enumerate(forces.get(mode, ())):
            piece[:3, at + k] = base + edge + np.arange(3)
            sign[:3, at + k] = -1.0
            kind[at + k] = FORCE
        if mode is Mode.OPEN:
            constant[at, at] = constant[at + 1, at + 1] = -1.0
            kind[at] = MOTION
        elif mode is not Mode.STICK:
            constant[at + 1, at + 1] = 1.0 if mode is Mode.SLIP_PLUS else -1.0
            kind[at + 1] = MOTION
    pair = redundant(modes, movers)
    if pair[1] >= 0:
        turn = 3 + 2 * pair[1]
        piece[turn : turn + 2] = -1
        constant[turn, 2] = 1.0
    return piece, sign, constant, kind, pair
