"""PROVED means: the simulator shows these modes wherever in the box it starts."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import numpy.typing as npt
import pytest

from meso_robust.basis import BasisProof, Corner, Tip
from meso_robust.basis.contact import Quantity
from meso_robust.bounds import Interval, Verdict
from meso_robust.simulator import Film, Fixture, LimitSurface, Outcome, Push, PushResult, simulate
from tests.basis.examples import Example, examples

F = npt.NDArray[np.float64]
RUNS = 48
TRAVEL = 2e-7  # m per unit of speed
AWAY = 1e-10  # m between part and obstacle at the start
WITHOUT_MIXTURE = [example for example in examples() if example.support.surface is None]


def draw(box: Mapping[str, Interval], rng: np.random.Generator) -> dict[str, F]:
    return {name: rng.uniform(side.lo, side.hi, RUNS) for name, side in box.items()}


def number(quantity: Quantity, at: Mapping[str, F], rng: np.random.Generator) -> F:
    if isinstance(quantity, str):
        return at[quantity]
    if isinstance(quantity, Interval):
        return rng.uniform(quantity.lo, quantity.hi, RUNS)
    if isinstance(quantity, int | float):
        return np.full(RUNS, float(quantity))
    return at["d2"] - at["d4"]  # the only expression in the examples


def support(e: Example, at: Mapping[str, F], rng: np.random.Generator) -> Film | LimitSurface:
    xx, xy, xt, yy, yt, tt = (number(entry, at, rng) for entry in e.support.film)
    drag = np.array([[xx, xy, xt], [xy, yy, yt], [xt, yt, tt]]).transpose(2, 0, 1)
    return LimitSurface(drag) if e.support.dry else Film(drag)


def touching(e: Example, tip: Tip, at: Mapping[str, F], rng: np.random.Generator) -> F:
    """(RUNS, 2) place of a tip just off its edge, world axes from the reference point."""
    corners = np.array(e.part.vertices)
    first, last = corners[tip.edge], corners[(tip.edge + 1) % len(corners)]
    along = (last - first) / np.hypot(*(last - first))
    out = np.array([along[1], -along[0]])
    r = number(tip.at, at, rng)[:, None] * along + (first @ out + AWAY) * out
    c, s = np.cos(at["theta"]), np.sin(at["theta"])
    return np.column_stack([c * r[:, 0] - s * r[:, 1], s * r[:, 0] + c * r[:, 1]])


def start(e: Example, at: dict[str, F], rng: np.random.Generator) -> PushResult:
    """Push a little from points of the box; the part is placed so that its corner is at the wall."""
    tips = [contact for contact in e.contacts if isinstance(contact, Tip)]
    poses = np.column_stack([np.zeros(RUNS), np.zeros(RUNS), at["theta"]])
    fixture, wall = Fixture(), [contact for contact in e.contacts if isinstance(contact, Corner)]
    if wall:
        x, y = e.part.vertices[wall[0].corner]
        poses[:, 1] = -AWAY - (np.sin(at["theta"]) * x + np.cos(at["theta"]) * y)
        block = np.array([[-5e-3, 0.0], [5e-3, 0.0], [5e-3, 1e-3], [-5e-3, 1e-3]])
        at["wall"] = np.full(RUNS, at["wall"][0])
        fixture = Fixture((block,), float(at["wall"][0]))
    places = np.stack([touching(e, tip, at, rng) for tip in tips], axis=1) + poses[:, None, :2]
    speeds = [np.column_stack([number(v, at, rng) for v in tip.mover.velocity]) for tip in tips]
    return simulate(
        Push.straight(
            vertices=np.array(e.part.vertices),
            poses=poses,
            tips=places,
            travel=TRAVEL * np.stack([speeds[0]] * len(tips), axis=1),
            friction=np.column_stack([number(tip.friction, at, rng) for tip in tips]),
            support=support(e, at, rng),
            fixture=fixture,
            step=TRAVEL / 8,
        ),
        record=4,
    )


@pytest.mark.parametrize("e", WITHOUT_MIXTURE, ids=lambda e: e.name)
def test_the_simulator_shows_the_proved_modes(
    e: Example, proofs: dict[str, tuple[Example, BasisProof, BasisProof]]
) -> None:
    assert proofs[e.name][1].verdict is Verdict.PROVED
    rng = np.random.default_rng(3)
    result = start(e, draw(e.box, rng), rng)
    assert np.all(result.outcomes == Outcome.COMPLETED)
    shown = result.modes[:, -1]
    if shown.shape[1] < len(e.contacts):
        shown = np.column_stack([shown, result.fixture_modes[:, -1]])
    assert np.all(shown == np.array([int(mode) for mode in e.modes]))
