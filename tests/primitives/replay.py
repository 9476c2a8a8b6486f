"""A whole plan replayed by force balance for sampled poses, errors and parameters."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from meso_robust.bounds import Interval
from meso_robust.primitives.move import Aim, Anchor, MoveRule
from meso_robust.primitives.setup import Setup
from tests.motion.first_principles import Floats, State, push
from tests.motion.sticking_reference import after, needed

STEP = 4e-6


@dataclass(frozen=True)
class World:
    """True values, one entry a sample."""

    x: Floats
    y: Floats
    theta: Floats
    rho: Floats
    mu: Floats
    beta: Floats


class Draws:
    """Values from ranges: most of them at an end, the rest anywhere."""

    def __init__(self, count: int, seed: int) -> None:
        self.rng, self.count = np.random.default_rng(seed), count

    def __call__(self, side: Interval) -> Floats:
        inside = side.lo + self.rng.random(self.count) * (side.hi - side.lo)
        ends = np.where(self.rng.random(self.count) < 0.5, side.lo, side.hi)
        found: Floats = np.clip(
            np.where(self.rng.random(self.count) < 0.8, ends, inside), side.lo, side.hi
        )
        return found


def begin(setup: Setup, draw: Draws) -> World:
    u, start = setup.uncertainty, setup.start
    return World(
        x=draw(start.x),
        y=draw(start.y),
        theta=draw(start.theta),
        rho=draw(u.film_ratio),
        mu=draw(u.friction),
        beta=draw(u.misalignment),
    )


@dataclass(frozen=True)
class Tips:
    """Where the tips are before the travel, and how far the active ones go."""

    upper: tuple[Floats, Floats]
    lower: tuple[Floats, Floats]
    passive: tuple[Floats, Floats] | None
    travel: Floats


def place(rule: MoveRule, world: World, setup: Setup, draw: Draws) -> Tips:
    u = setup.uncertainty
    sensed_x, sensed_y = world.x + draw(u.sensed_position), world.y + draw(u.sensed_position)

    def command(aim: Aim, sensed: Floats) -> Floats:
        base = sensed if aim.anchor is Anchor.PART else np.zeros_like(sensed)
        return base + aim.offset_um * 1e-6

    x = command(rule.dual.x, sensed_x) + draw(u.probe_position)
    y = command(rule.dual.y, sensed_y) + draw(u.probe_position)
    end = command(rule.dual_end, sensed_x) + draw(u.probe_position)
    up = 0.5 * setup.spacing.mid
    lag = up * np.tan(world.beta)
    passive = None
    if rule.single is not None:
        passive = (
            command(rule.single.x, sensed_x) + draw(u.probe_position),
            command(rule.single.y, sensed_y) + draw(u.probe_position),
        )
    return Tips(upper=(x - lag, y + up), lower=(x + lag, y - up), passive=passive, travel=x - end)


def _edge(theta: float, setup: Setup) -> tuple[float, float]:
    """Quarter turns of the pushed edge, and its depth."""
    quarter = round(theta / (math.pi / 2)) - 1
    depth = setup.half_width if quarter % 2 == 0 else setup.half_length
    return quarter * math.pi / 2, depth.mid


def _meets(tip: tuple[float, float], angle: float, depth: float) -> tuple[float, float]:
    """Distance of a tip (seen from the centre) from the edge along x, and the offset d2 there."""
    x = (depth + tip[1] * math.cos(angle)) / math.sin(angle)
    return tip[0] - x, x * math.cos(angle) + tip[1] * math.sin(angle)


def stick(rule: MoveRule, world: World, tips: Tips, setup: Setup) -> World:
    """Tilt or straighten: the first tip sticks, up to the alignment with both tips or the end."""
    x, y, theta = world.x.copy(), world.y.copy(), world.theta.copy()
    for k in range(x.size):
        turn, depth = _edge(theta[k], setup)
        angle = theta[k] - turn
        seen = [
            _meets((tip[0][k] - x[k], tip[1][k] - y[k]), angle, depth)
            for tip in (tips.upper, tips.lower)
        ]
        if rule.action == "tilt":
            free, offset = seen[1] if rule.side > 0 else seen[0]
        else:
            free, offset = min(seen)
        left = tips.travel[k] - free
        aligned = math.pi / 2 + world.beta[k]
        to_align = math.inf
        if rule.action == "straighten":
            to_align = needed(angle, aligned, depth, offset, world.rho[k])
            assert 0.0 <= to_align <= left, "the second tip is not reached"
        dx, dy, end = after(angle, min(left, to_align), depth, offset, world.rho[k])
        x[k] += dx - max(left - to_align, 0.0)
        y[k] += dy
        theta[k] = end + turn
    return replace(world, x=x, y=y, theta=theta)


def rotate(world: World, tips: Tips, setup: Setup) -> World:
    """The lower tip pushes alone until the part rests on the passive one; then both turn it."""
    rng = np.random.default_rng(9)
    depth = np.full_like(world.x, setup.half_width.mid)
    assert tips.passive is not None
    active_x, active_y = tips.lower
    reach = (depth + (active_y - world.y) * np.cos(world.theta)) / np.sin(world.theta)
    left = tips.travel - (active_x - world.x - reach)
    state = State(
        x=world.x,
        y=world.y,
        theta=world.theta,
        active_x=world.x + reach,
        active_y=active_y,
        passive_x=tips.passive[0],
        passive_y=tips.passive[1],
    )
    alone = state.passive_gap(depth) > 0.0
    assert alone.all(), "the passive tip starts in contact"
    while alone.any():
        step = np.where(alone, STEP, 0.0)
        gap = state.passive_gap(depth)
        trial = push(state, world.rho, world.mu, 1, step, rng)
        beyond = trial.passive_gap(depth)
        touched = alone & (beyond <= 0.0)
        share = np.where(touched, gap / np.where(touched, gap - beyond, 1.0), 1.0)
        state = push(state, world.rho, world.mu, 1, step * share, rng)
        left = left - step * share
        alone &= ~touched
    while (left > 0.0).any():
        step = np.clip(left, 0.0, STEP)
        state = push(state, world.rho, world.mu, 2, step, rng)
        left = left - step
    return replace(world, x=state.x, y=state.y, theta=state.theta)


def play(rule: MoveRule, world: World, setup: Setup, draw: Draws) -> World:
    """One move."""
    tips = place(rule, world, setup, draw)
    return (
        rotate(world, tips, setup) if rule.action == "rotate" else stick(rule, world, tips, setup)
    )
