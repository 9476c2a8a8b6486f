"""The push by one tip until the part rests on the other, against an integration from the forces."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import pytest

from meso_robust.bounds import Interval
from meso_robust.primitives.approach import Touch, approach
from meso_robust.primitives.rotation import _move
from meso_robust.primitives.setup import PoseBox, setup_of
from meso_robust.primitives.tips import tip_of
from meso_robust.types import Floats
from tests.strategies import paper_chain, paper_task

STEP = 0.25e-6  # m of travel
NEAR = 2e-9  # m and rad: what the steps leave of error
FRICTION = Interval(0.25, 0.45)


@dataclass(frozen=True)
class Plant:
    """A part of two parallel edges on an even film; D moves along -x, S rests; SI."""

    depth: float
    rho: float
    resting: Floats
    """Place of S."""

    def rates(self, state: Floats, mu: float) -> Floats:
        """Per travel, of x, y, the edge's direction, and D's x, by balance and Coulomb's law."""
        a, n = self.edge(state[2])
        arm = np.array([state[3], state[4]]) - state[:2]
        tip = np.array([-1.0, 0.0])

        def twist(force: Floats) -> Floats:
            return np.array([*force, (arm[0] * force[1] - arm[1] * force[0]) / self.rho])

        def there(moves: Floats) -> Floats:
            return moves[:2] + moves[2] * np.array([-arm[1], arm[0]])

        found = []
        for ratio in (-mu, mu):
            moves = twist(ratio * a - n)
            moves *= (tip @ n) / (there(moves) @ n)
            if ratio * ((there(moves) - tip) @ a) <= 0.0:
                found.append(moves)
        if not found:  # it sticks
            across = np.array([[there(twist(f)) @ e for f in (a, n)] for e in (a, n)])
            along, out = np.linalg.solve(across, [tip @ a, tip @ n])
            found = [twist(along * a + out * n)]
        (moves,) = found
        return np.array([*moves, *tip])

    @staticmethod
    def edge(angle: float) -> tuple[Floats, Floats]:
        """Its direction and outward normal."""
        a = np.array([np.cos(angle), np.sin(angle)])
        return a, np.array([a[1], -a[0]])

    def gap(self, state: Floats) -> float:
        """How far the far edge is from S."""
        return float((self.resting - state[:2]) @ -self.edge(state[2])[1]) - self.depth

    def touches(self, state: Floats, mu: float) -> Floats:
        """The state in which the part comes to rest on S."""

        def after(h: float) -> Floats:
            k1 = self.rates(state, mu)
            k2 = self.rates(state + 0.5 * h * k1, mu)
            k3 = self.rates(state + 0.5 * h * k2, mu)
            k4 = self.rates(state + h * k3, mu)
            return state + h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4)

        while self.gap(ahead := after(STEP)) > 0.0:
            state = ahead
        low, high = 0.0, STEP
        for _ in range(30):
            half = 0.5 * (low + high)
            low, high = (half, high) if self.gap(after(half)) > 0.0 else (low, half)
        return after(high)


def _beyond_the_line(touch: Touch, h: float, q: float, turned: float) -> float:
    """What a slide has beyond the affine function of the start, everything but the turn in its middle."""
    start = touch.start
    line = start.value + start.rate * (start.h.hi - h)
    return q - line - start.spread["turned"] * (turned - start.labels["turned"].mid)


@pytest.mark.parametrize("off", [0.0, 60e-6])
def test_touches_at_every_friction_are_enclosed_and_hardly_more(off: float) -> None:
    """All else is known, so the creep by friction alone is what the enclosure must hold."""
    step, exact = paper_chain().steps[2], setup_of(paper_task(), 0.0)
    setup = replace(exact, uncertainty=replace(exact.uncertainty, friction=FRICTION))
    middle = {key: Interval.point(getattr(step.pre, key).mid) for key in ("x", "y", "theta")}
    middle["y"] = middle["y"] + Interval.point(off)
    pre = PoseBox(**middle)
    edge = setup.edge(pre.theta.mid)
    move = _move(step.rule, pre, edge, setup)
    touch = approach(move.box, move.grip, move.labels, move.first_gap, edge, move.of)
    assert touch is not None
    assert step.rule.single is not None

    zero = Interval.point(0.0)
    rise = tip_of(step.rule, -1, pre, setup).rise.mid
    single = step.rule.single
    resting = [side.ahead_of(at, zero, zero).mid for side, at in
               ((single.x, pre.x), (single.y, pre.y))]  # fmt: skip
    rho = setup.uncertainty.film_ratio.mid
    plant = Plant(depth=edge.depth.mid, rho=rho, resting=np.array(resting))
    angle = edge.angle(pre.theta).mid
    reach = (plant.depth + rise * np.cos(angle)) / np.sin(angle)
    seen = []
    for mu in np.linspace(FRICTION.lo, FRICTION.hi, 5):
        end = plant.touches(np.array([0.0, 0.0, angle, reach, rise]), float(mu))
        a, _ = plant.edge(end[2])
        h, q, turned = end[3] - resting[0], (end[:2] - plant.resting) @ a, end[2] - angle
        assert touch.start.h.lo - NEAR <= h <= touch.start.h.hi + NEAR
        assert touch.start.labels["turned"].lo - NEAR <= turned
        assert turned <= touch.start.labels["turned"].hi + NEAR
        seen.append(_beyond_the_line(touch, h, float(q), turned))
    rest = touch.start.rest
    assert rest.lo - NEAR <= min(seen)
    assert max(seen) <= rest.hi + NEAR
    assert max(seen) - min(seen) > 0.5 * rest.width
