"""Two tips of different friction, and bounds of forces, against all contact modes one by one."""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import pytest

from derivations._derivation import Derivation
from meso_robust._generated.contact_forces import carrying_force
from meso_robust.types import Floats

MODES = ("up", "stick", "down")
"""Which way the part slips over a tip, along its edge."""


@dataclass(frozen=True)
class Place:
    """A part of half width 1 between two tips."""

    angle: float
    along: float
    """Between the contacts."""
    resting: float
    """The resting contact from the centre's foot."""
    ratio: float
    frictions: tuple[float, float]

    @property
    def closing(self) -> float:
        return float(self.along * np.cos(self.angle) + 2 * np.sin(self.angle))

    def motions(self) -> Iterator[tuple[Floats, Floats]]:
        """Velocity along the edge and turn, and the four contact forces, of every possible motion.

        In the frame (a, n): unknowns are v_a, v_n, omega, and N and R at either tip.
        """
        arms = (self.resting + self.along, 1.0), (self.resting, -1.0)
        pushed = np.array([-np.cos(self.angle), -np.sin(self.angle)])
        for mode in itertools.product(MODES, repeat=2):
            rows, right = np.zeros((7, 7)), np.zeros(7)
            rows[0, 0] = rows[1, 1] = 1.0
            rows[2, 2] = self.ratio
            for k, (p, e) in enumerate(arms):
                inward = -1.0 if k == 0 else 1.0
                normal, tangential = 3 + 2 * k, 4 + 2 * k
                rows[0, tangential] = rows[1, normal] = -1.0
                rows[1, normal] = -inward
                rows[2, tangential], rows[2, normal] = -e, p * inward
                rows[3 + 2 * k, 1:3] = 1.0, -p
                right[3 + 2 * k] = pushed[1] if k == 0 else 0.0
                if mode[k] == "stick":
                    rows[4 + 2 * k, 0], rows[4 + 2 * k, 2] = 1.0, e
                    right[4 + 2 * k] = pushed[0] if k == 0 else 0.0
                else:
                    rows[4 + 2 * k, tangential] = 1.0
                    sign = -1.0 if mode[k] == "up" else 1.0
                    rows[4 + 2 * k, normal] = -sign * self.frictions[k]
            if abs(np.linalg.det(rows)) < 1e-12:
                continue
            found = np.asarray(np.linalg.solve(rows, right), dtype=np.float64)
            if all(self.obeys(found, mode[k], k, arms[k], pushed) for k in (0, 1)):
                yield found[[0, 2]], found[3:]

    def obeys(
        self, found: Floats, way: str, k: int, arm: tuple[float, float], pushed: Floats
    ) -> bool:
        normal, tangential = found[3 + 2 * k], found[4 + 2 * k]
        slip = found[0] + found[2] * arm[1] - (pushed[0] if k == 0 else 0.0)
        if normal < 0:
            return False
        if way == "stick":
            return bool(abs(tangential) <= self.frictions[k] * normal)
        return bool(slip > 0) if way == "up" else bool(slip < 0)

    @property
    def both_press(self) -> bool:
        moving, resting = self.frictions
        p = self.resting
        return all(
            self.ratio + p * (p + sign * resting) > 0
            and self.ratio + p * (p + self.along + sign * moving) > 0
            for sign in (-1, 1)
        )


def places(seed: int, count: int) -> Iterator[Place]:
    rng = np.random.default_rng(seed)
    while count:
        found = Place(
            angle=rng.uniform(0.3, 3.0),
            along=rng.uniform(0.1, 2.5),
            resting=rng.uniform(-2.0, 1.0),
            ratio=rng.uniform(0.05, 2.0),
            frictions=(rng.uniform(0.05, 1.0), rng.uniform(0.05, 1.0)),
        )
        if found.both_press:
            count -= 1
            yield found


@pytest.mark.parametrize("name", ["unequal_friction", "jam", "contact_forces"])
def test_everything_is_new_and_proved(name: str, derived: tuple[Derivation, ...]) -> None:
    (claims,) = (one.claims for one in derived if one.name == name)
    assert {claim.verdict.words for claim in claims} == {"NEW"}


def test_how_many_motions_there_are() -> None:
    seen = dict.fromkeys(("unique", "exists", "three", "jam", "two", "past"), 0)
    for place in places(0, 4000):
        count = len(list(place.motions()))
        moving, resting = place.frictions
        T = place.along
        if place.closing < 0:
            if abs(moving - resting) < T:
                assert count == 1
                seen["past"] += 1
            continue
        if 2 * min(moving, resting) > T:
            assert count in (0, 2)
            seen["two" if count else "jam"] += 1
            continue
        assert count >= 1
        seen["exists"] += 1
        if 2 * max(moving, resting) < T or (moving >= resting and np.cos(place.angle) <= 0):
            assert count == 1
            seen["unique"] += 1
        seen["three"] += count == 3
    assert all(seen.values()), seen


def test_forces_stay_below_the_bound_of_the_separation() -> None:
    tightest = np.inf
    for place in places(1, 3000):
        mu, T, p = max(place.frictions), place.along, place.resting
        V = T * np.sin(place.angle) - 2 * np.cos(place.angle)
        least = np.sqrt(max(V * V - 4.0, 0.0))
        if not V > 2 or not least > 2 * mu:
            continue
        longest = max(place.ratio + p * p, place.ratio + p * (p + T)) + mu * abs(p)
        bound = 2 / (V + least) * longest / (least - 2 * mu)
        for _, forces in place.motions():
            assert max(forces[0], forces[2]) <= bound
            assert forces[0] - forces[2] == pytest.approx(-p * np.sin(place.angle) / T)
            tightest = min(tightest, bound / max(forces[0], forces[2]))
    assert tightest < 3.0


def test_a_sticking_tip_presses_no_harder_than_a_part_that_cannot_turn() -> None:
    rng = np.random.default_rng(2)
    fullest = 0.0
    for _ in range(300):
        stretch, shear = rng.uniform(-0.4, 0.4, 2)
        mobility = np.linalg.inv(np.array([[1 + stretch, shear], [shear, 1 - stretch]]))
        p, e, angle = *rng.uniform(-3, 3, 2), rng.uniform(0, 2 * np.pi)
        lever = np.array([e, -p])  # moment of a force, and velocity of the contact per turn
        compliance = mobility + np.outer(lever, lever) / rng.uniform(0.01, 20.0)
        force = np.linalg.norm(np.linalg.solve(compliance, [np.cos(angle), np.sin(angle)]))
        (bound,) = carrying_force(np, stretch, shear, 0.0, 0.0)
        assert force <= bound
        fullest = max(fullest, force / bound)
    assert fullest > 0.9
