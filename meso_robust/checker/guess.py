"""Where barriers are looked for, in plain floating point: no proof rests on this file.

A barrier is looked for as the path of a motion whose friction and drag are always those that take it
farthest, and how that path changes with each constant of the run.
"""

from __future__ import annotations

import itertools
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from meso_robust.checker.film import MOVING
from meso_robust.checker.grip import D, Drag, Grip, S, Sides

Values = Mapping[str, Any]
"""Numbers, or arrays of one shape, by name."""
NEAR = 1e-3
"""Step of a difference, of the width between the pushed edges."""
RIVALS = 4
"""Corners of what may change at every instant that are looked at beside the worst one."""
SAMPLES = 16
"""Values of the constants at which a barrier is tried, besides those where one differs from its middle."""
INSTANT = ("rho", "stretch", "shear", "bend", *MOVING.values(), "mu", "mu_lower", "mu_passive")
"""What may change at every instant."""


@dataclass(frozen=True)
class Guess:
    """A barrier at one place: how far the part is ahead of a tip."""

    tip: int
    ahead: float
    slopes: dict[str, float]
    """Change of that per change of each constant."""

    def moved(self, rates: Guess, length: float) -> Guess:
        """It goes on at some rates."""
        slopes = {name: value + length * rates.slopes[name] for name, value in self.slopes.items()}
        return Guess(self.tip, self.ahead + length * rates.ahead, slopes)


@dataclass(frozen=True)
class Flow:
    """The motion that gains most (side = 1) or least (-1)."""

    middle: Values
    reach: Values
    """Half the width of every range that has one."""
    side: int

    @property
    def width(self) -> float:
        """Between the edges that are pushed, m: lengths of the search are shares of it."""
        return float(self.middle["depth"] + self.middle["depth_far"])

    def corners(self) -> Values:
        """All that friction, drag and path can be at their ends."""
        names = [name for name in INSTANT if name in self.reach]
        signs = np.array(list(itertools.product((-1.0, 1.0), repeat=len(names)))).T
        return {n: self.middle[n] + signs[k] * self.reach[n] for k, n in enumerate(names)}

    def worst(self, h: float, at: Guess, corners: Values) -> Values:
        """The corner at which the part gains most on the path."""
        strayed = at.slopes.get("stray", 0.0)
        gain = rate(h, at.tip, at.ahead, {**self.middle, **corners})
        best = int(np.argmax(self.side * (gain - strayed * corners.get("bend", 0.0))))
        return {name: float(ends[best]) for name, ends in corners.items()}

    def rivals(self, h: Any, tip: int, ahead: Any, corners: Values) -> Any:
        """(N, few) the corners at which the part gains most, at each of N places on paths."""
        gain = rate(h, tip, ahead, {**self.middle, **corners})
        return np.argsort(-self.side * np.asarray(gain), axis=1)[:, : 1 + RIVALS]

    def change(self, h: float, at: Guess, corner: Values) -> Guess:
        """Derivative of a barrier with the travel."""
        there, names = {**self.middle, **corner}, list(at.slopes)
        # no change, then each name up, then each name down
        signs = np.vstack([np.zeros(len(names)), np.eye(len(names)), -np.eye(len(names))])
        off = {name: signs[:, k] * self.reach[name] for k, name in enumerate(names)}
        ahead = at.ahead + sum(off[name] * at.slopes[name] for name in names)
        moved = np.asarray(
            rate(h, at.tip, ahead, {**there, **{n: there[n] + off[n] for n in names}})
        ).reshape(-1)
        up, down = moved[1 : len(names) + 1], moved[len(names) + 1 :]
        strayed = at.slopes.get("stray", 0.0) * corner.get("bend", 0.0)
        slopes = {
            name: float(up[k] - down[k]) / (2 * self.reach[name]) for k, name in enumerate(names)
        }
        return Guess(at.tip, float(moved[0]) - strayed, slopes)

    def tried(self) -> Values:
        """Values of the constants, in rows: some corners, and each alone at either end."""
        names = [name for name in self.reach if name not in INSTANT]
        corners = np.random.default_rng(0).choice([-1.0, 1.0], (SAMPLES, len(names)))
        signs = np.vstack([corners, np.eye(len(names)), -np.eye(len(names))])
        return {n: self.middle[n] + signs[:, k] * self.reach[n] for k, n in enumerate(names)}

    def drift(self, h: float, at: Guess, corner: Values) -> float:
        """Change of the rate with how far the part is ahead, 1/m."""
        there = {**self.middle, **corner}
        step = NEAR * self.width
        low, high = rate(h, at.tip, at.ahead + np.array([-step, step]), there)
        return float(high - low) / (2 * step)

    def step(self, h: float, length: float, at: Guess, rates: Guess, corner: Values) -> Guess:
        """The barrier one step on, by the rates at its start and half way (second order)."""
        half = at.moved(rates, length / 2)
        return at.moved(self.change(h - length / 2, half, corner), length)

    def ahead_of(self, tip: int, h: float, at: Guess) -> Guess:
        """The same barrier ahead of another tip."""

        def seen(name: str, sign: int) -> float:
            off = sign * self.reach[name]
            there = {**self.middle, name: self.middle[name] + off}
            return other_tip(h, at.tip, at.ahead + off * at.slopes[name], there)

        slopes = {n: (seen(n, 1) - seen(n, -1)) / (2 * self.reach[n]) for n in at.slopes}
        return Guess(tip, other_tip(h, at.tip, at.ahead, self.middle), slopes)

    def sticks(self, h: float, at: Guess, corner: Values) -> int:
        """The tip that sticks, or else S."""
        there = {**self.middle, **corner}
        grip = _grip(h, at.tip, at.ahead, there)
        return D if float(grip.stick(D)) == float(rate(h, at.tip, at.ahead, there)) else S


def _grip(h: float, tip: int, ahead: Any, at: Values) -> Grip:
    sides = Sides(
        at["depth"], at["depth_far"], at["radius"], at["radius_far"],
        at.get("tilt", 0.0), *(at.get(name, at.get(MOVING[name], 0.0)) for name in MOVING),
    )  # fmt: skip
    return Grip.at(sides, h, at["V"] + at.get("stray", 0.0), tip, ahead, at.get("bend", 0.0))


def rate(h: float, tip: int, ahead: Any, at: Values) -> Any:
    """The rate at which the part gets ahead of a tip, or one of them."""
    grip = _grip(h, tip, ahead, at)
    drag = Drag(at["rho"], at.get("stretch", 0.0), at.get("shear", 0.0))
    mu_D = at["mu"] if "mu" in at else at["mu_lower"]
    mu_S = at["mu"] if "mu" in at else at["mu_passive"]

    def slip(at_D: int, at_S: int) -> Any:
        return grip.rate(drag, at_D * mu_D, at_S * mu_S)

    at_D, at_S = grip.stick(D), grip.stick(S)
    low, high = np.minimum(at_D, at_S), np.maximum(at_D, at_S)
    between = np.where(at_D < at_S, slip(-1, 1), slip(1, -1))
    found = np.where(between < low, np.minimum(slip(1, 1), low), between)
    return np.where(between > high, np.maximum(slip(-1, -1), high), found)


def other_tip(h: float, tip: int, ahead: float, at: Values) -> float:
    """How far the part is ahead of the other tip."""
    grip = _grip(h, tip, ahead, at)
    return float(ahead - grip.T if tip == S else ahead + grip.T)


def first_ahead(h: float, at: Values) -> float:
    """How far it is ahead of S when its reference point is ``Z`` above the centre of S."""
    ahead = 0.0
    for _ in range(3):  # with parallel edges the first is exact
        grip = _grip(h, S, ahead, at)
        ahead = (at["Z"] + grip.out_resting * grip.c) / grip.s
    return float(ahead)
