"""A part pushed along a slot against all contact modes, solved one by one in the part's own axes."""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from meso_robust._generated import slot_walls
from meso_robust.types import Floats


@dataclass(frozen=True)
class Place:
    """A part in a slot, lengths over the distance of the rear edge; axes (ahead, up), turn positive front up."""

    offset: float
    ahead: float
    half: float
    ratio: float
    mu: float
    wall: float
    lean: float
    path: float
    """By how much the tip's path leads up from the slot's axis, rad."""

    @classmethod
    def random(cls, rng: np.random.Generator) -> Place:
        half = rng.uniform(0.3, 0.9)
        return cls(
            offset=rng.uniform(0.05, half), ahead=rng.uniform(-0.9, 0.9), half=half, ratio=rng.uniform(0.2, 1.5),
            mu=rng.uniform(0.05, 0.7), wall=rng.uniform(0.0, 0.7), lean=rng.uniform(1e-3, 0.3),
            path=rng.uniform(-0.2, 0.2),
        )  # fmt: skip

    @property
    def tip(self) -> Floats:
        """The tip's velocity."""
        angle = self.path - self.lean
        return np.array([np.cos(angle), np.sin(angle)])

    def contacts(self, kind: str) -> list[tuple[Floats, Floats, Floats, float]]:
        """Place, normal, velocity and friction of the tip and of what else touches."""
        still = np.zeros(2)
        tip = (np.array([-1.0, self.offset]), np.array([1.0, 0.0]), self.tip, self.mu)
        edge = (np.array([self.ahead, -self.half]), np.array([0.0, 1.0]), still, self.wall)
        down = -np.array([np.sin(self.lean), np.cos(self.lean)])
        corner = (np.array([1.0, self.half]), down, still, self.wall)
        return {"free": [tip], "edge": [tip, edge], "corner": [tip, corner]}[kind]

    def motions(self, kind: str) -> Iterator[tuple[Floats, Floats]]:
        """Velocity (ahead, up, turn) and forces (normal, tangential each) of every mode that Coulomb's law allows."""
        contacts = self.contacts(kind)
        size = 3 + 2 * len(contacts)
        for modes in itertools.product((-1, 0, 1), repeat=len(contacts)):
            rows, right = np.zeros((size, size)), np.zeros(size)
            rows[0, 0], rows[1, 1], rows[2, 2] = 1.0, 1.0, self.ratio
            for k, ((place, normal, speed, mu), mode) in enumerate(
                zip(contacts, modes, strict=True)
            ):
                across = np.array([-normal[1], normal[0]])
                at = [
                    np.array([d[0], d[1], place[0] * d[1] - place[1] * d[0]])
                    for d in (normal, across)
                ]
                n, t = 3 + 2 * k, 4 + 2 * k
                rows[:3, n], rows[:3, t] = -at[0], -at[1]
                rows[n, :3], right[n] = at[0], normal @ speed
                if mode == 0:
                    rows[t, :3], right[t] = at[1], across @ speed
                else:
                    rows[t, t], rows[t, n] = 1.0, mode * mu
            if abs(np.linalg.det(rows)) < 1e-9:
                continue
            solved: Floats = np.linalg.solve(rows, right).astype(np.float64)
            if self._allowed(contacts, modes, solved):
                yield solved[:3], solved[3:]

    @staticmethod
    def _allowed(
        contacts: list[tuple[Floats, Floats, Floats, float]], modes: tuple[int, ...], solved: Floats
    ) -> bool:
        for k, ((place, normal, speed, mu), mode) in enumerate(zip(contacts, modes, strict=True)):
            force, along = solved[3 + 2 * k : 5 + 2 * k]
            across = np.array([-normal[1], normal[0]])
            v = solved[:2] + solved[2] * np.array([-place[1], place[0]])
            slip = across @ (v - speed)
            if force < 0.0 or (mode == 0 and abs(along) > mu * force) or mode * slip < 0.0:
                return False
        return True


def both(values: tuple[float, ...]) -> bool:
    return all(value > 0.0 for value in values)


def test_every_motion_turns_back_where_the_conditions_hold() -> None:
    rng = np.random.default_rng(0)
    held, broken = dict.fromkeys(("free", "edge", "corner"), 0), 0
    for _ in range(900):
        one = Place.random(rng)
        bears = both(slot_walls.bears(np, 1.0, one.offset, one.ahead, one.half, one.mu, one.wall))
        steers = both(slot_walls.steers(np, 1.0, one.offset, one.lean - one.path))
        turns = both(slot_walls.corner(np, 1.0, one.half, one.wall, one.lean))
        stiff = both(slot_walls.stiff(np, one.ratio, one.half, one.wall))
        given = {"free": steers, "corner": steers and turns, "edge": bears and stiff}
        for kind, holds in given.items():
            for velocity, _ in one.motions(kind):
                if holds:
                    held[kind] += 1
                    assert velocity[2] < 0.0
                elif kind == "edge":
                    broken += velocity[2] > 0.0
    assert min(held.values()) > 25
    assert broken > 25  # not for nothing


def test_a_motion_exists_and_its_force_on_the_edge_is_that_of_the_closed_form() -> None:
    rng, seen = np.random.default_rng(1), 0
    for _ in range(600):
        one = Place.random(rng)
        if not both(slot_walls.no_jam(np, one.mu, one.wall, one.lean)):
            continue
        free = [v for v, _ in one.motions("free")]
        assert free
        # what is free is so where it does not move into the edge
        apart = any(v[1] + v[2] * one.ahead >= 0.0 for v in free)
        on_edge = list(one.motions("edge"))
        assert apart or on_edge
        for velocity, (push, up, bearing, _) in on_edge:
            tau = up / push
            resist = one.wall if velocity[0] + one.half * velocity[2] > 0.0 else -one.wall
            stiff = one.ratio + one.ahead**2 - resist * one.half * one.ahead
            by_hand = push * (one.ahead * one.offset - tau * (one.ratio - one.ahead)) / stiff
            if abs(velocity[0] + one.half * velocity[2]) > 1e-9:
                np.testing.assert_allclose(bearing, by_hand, rtol=1e-9)
                seen += 1
    assert seen > 50


def test_a_leaning_part_spans_what_its_corners_do() -> None:
    lean, half, front, ahead = 0.2, 0.4, 1.0, -0.3
    corner = front * np.sin(lean) + half * np.cos(lean)
    side = ahead * np.sin(lean) - half * np.cos(lean)
    (spare,) = slot_walls.one_wall(np, half, 2.0, front - ahead, lean)
    np.testing.assert_allclose(spare, 2.0 - (corner - side))
