"""The motion that a fixed basis makes, and verified steps along it.

With the modes fixed the twist is an explicit function of the state ``z = (x, y, theta, drift of
each tip that slips)`` and of the parameters, ``z' = F(z, p)``. One step of length h from all states
in Z, for parameters that may even change in time within P:

1. Picard: a box B with ``Z + [0, h] F(B, P)`` inside B holds every motion during the step;
2. from the mean-value form of F about the middle (m, p_m) over B,
   ``z(h) in m + h F(m, p_m) + (1 + h F_z(B)) (Z - m) + h F_p(B) (P - p_m) + h²/2 F_z(B) F(B)``.

Source: R. J. Lohner 1987; N. S. Nedialkov et al. 1999, doi:10.1016/S0096-3003(98)10083-8 (section 5,
first order with a second-order remainder).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from meso_robust.basis.arrays import inside, meet, minus, plus, point, sine_cosine, times, total
from meso_robust.basis.bulk import hold_many
from meso_robust.basis.contact import Mode
from meso_robust.basis.layout import Layout
from meso_robust.basis.problem import Problem
from meso_robust.types import Flags, Floats

TRIES = 8
X, Y, THETA = 0, 1, 2
"""First columns of the state; then one for each tip that slips."""


@dataclass(frozen=True, slots=True, eq=False)
class Flow:
    """A contact problem with fixed modes.

    The parameters that vary are, in this order: theta, the drifts, all others.
    """

    problem: Problem
    of: Layout
    slipping: tuple[int, ...]
    """Contacts whose drift is part of the state."""

    @property
    def size(self) -> int:
        """Number of columns of the state."""
        return 3 + len(self.slipping)

    def box(self, state: Floats, rest: Floats) -> tuple[Floats, Floats]:
        """Ends (N, parameters) for states (N, size, 2) and all other parameters (N, ., 2)."""
        both = np.concatenate([state[:, THETA:], rest], axis=1)
        return both[..., 0], both[..., 1]


def rates(flow: Flow, state: Floats, unknowns: Floats) -> Floats:
    """F (N, size, 2) from enclosures of the unknowns (N, n, 2)."""
    sine, cosine = sine_cosine(state[:, THETA])
    a, b = unknowns[:, 0], unknowns[:, 1]
    x = minus(times(cosine, a), times(sine, b))
    y = plus(times(sine, a), times(cosine, b))
    drifts = [_drift(flow, contact, unknowns) for contact in flow.slipping]
    return np.stack([x, y, unknowns[:, 2], *drifts], axis=1)


def _drift(flow: Flow, contact: int, unknowns: Floats) -> Floats:
    """A tip moves along its edge as the part slides along t past it."""
    speed = unknowns[:, 4 + 2 * contact]
    if flow.of.modes[0, contact] == Mode.SLIP_PLUS:
        return np.stack([-speed[..., 1], -speed[..., 0]], axis=-1)
    return speed


def rate_slopes(flow: Flow, state: Floats, rate: Floats, slopes: Floats) -> Floats:
    """Derivatives of F by the varying parameters, (N, size, varying, 2)."""
    sine, cosine = (each[:, None] for each in sine_cosine(state[:, THETA]))
    a, b = slopes[:, 0], slopes[:, 1]
    x = minus(times(cosine, a), times(sine, b))
    y = plus(times(sine, a), times(cosine, b))
    x[:, 0] = minus(x[:, 0], rate[:, Y])
    y[:, 0] = plus(y[:, 0], rate[:, X])
    drifts = [_drift(flow, contact, slopes) for contact in flow.slipping]
    return np.stack([x, y, slopes[:, 2], *drifts], axis=1)


@dataclass(frozen=True, slots=True, eq=False)
class Stepped:
    """One step for N pieces."""

    known: Flags
    """(N,) whether the motion that the modes would make is enclosed, whatever its signs."""
    holds: Flags
    """(N,) whether the basis is proved to hold all through the step."""
    end: Floats
    """(N, size, 2) all states at its end, where it is known."""
    swept: Floats
    """(N, size, 2) all states during it, where it is known."""


def step(flow: Flow, state: Floats, rest: Floats, h: float) -> Stepped:
    """Take one step from every state in ``state`` (N, size, 2), for all parameters in ``rest``."""
    swept, enclosed = _picard(flow, state, rest, h)
    found = hold_many(flow.problem, flow.of, *flow.box(swept, rest), slopes=True)
    rate = rates(flow, swept, found.unknowns)
    slopes = rate_slopes(flow, swept, rate, found.slopes)
    short = plus(state, times(point(h), rate))
    end = meet(_far(flow, state, rest, h, rate, slopes), short)
    known = enclosed & (found.states[:, 0] >= 0) & np.isfinite(end).all(axis=(1, 2))
    return Stepped(known, known & (found.states[:, 0] == 1), end, swept)


def _picard(flow: Flow, state: Floats, rest: Floats, h: float) -> tuple[Floats, Flags]:
    """Boxes (N, size, 2) that hold every motion of the step, and whether that is proved."""
    duration = np.array([0.0, h])
    swept = image = state
    good: Flags = np.zeros(len(state), dtype=np.bool_)
    for _ in range(TRIES):
        found = hold_many(flow.problem, flow.of, *flow.box(swept, rest))
        image = plus(state, times(duration, rates(flow, swept, found.unknowns)))
        good = np.all(inside(image, swept), axis=1)
        finite = np.isfinite(image).all(axis=(1, 2))
        if (good | ~finite).all():
            break
        grown = np.where(np.expand_dims(finite, (1, 2)), image, swept)
        reach = 0.05 * (grown[..., 1] - grown[..., 0])[..., None] * np.array([-1.0, 1.0])
        swept = np.where(np.expand_dims(good, (1, 2)), swept, grown + reach)
    return np.where(np.expand_dims(good, (1, 2)), image, swept), good


def _far(flow: Flow, state: Floats, rest: Floats, h: float, rate: Floats, slopes: Floats) -> Floats:
    """End of the step by the mean-value form; see the module's head."""
    lo, hi = flow.box(state, rest)
    middle = 0.5 * (state[..., 0] + state[..., 1])
    point_lo = 0.5 * (lo + hi)
    at = hold_many(flow.problem, flow.of, point_lo, point_lo)
    start = point(middle)
    end = plus(start, times(point(h), rates(flow, start, at.unknowns)))
    reach = minus(np.stack([lo, hi], axis=-1), point(point_lo))[:, : flow.problem.varying]
    own = minus(state, start)
    for i in range(flow.size):
        for k in range(flow.problem.varying):
            factor = times(point(h), slopes[:, i, k])
            if i == THETA + k:
                factor = plus(factor, point(1.0))
            end[:, i] = plus(end[:, i], times(factor, reach[:, k]))
        if i < THETA:
            end[:, i] = plus(end[:, i], own[:, i])
        states = flow.size - THETA
        bend = total(times(slopes[:, i, :states], rate[:, THETA:]))
        end[:, i] = plus(end[:, i], times(times(point(0.5 * h), point(h)), bend))
    return end
