"""What the plans of the paper's Section VII are tried with: errors, success, exact intervals."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from meso_robust import units
from meso_robust.reproduction import printed
from meso_robust.reproduction.bench import START, Place, Plan, Runs, follow, succeeded
from meso_robust.types import Flags, Floats

Range = tuple[float, float]


@dataclass(frozen=True, slots=True, kw_only=True)
class Errors:
    """Ranges of what is uncertain, drawn uniformly; the default has no error, on p1*.

    Attributes
    ----------
    position, tip
        Half widths in x and y of the peg's start and of the tip's offset, m.
    orientation
        Half width of the peg's start, rad.
    friction
        μ between tip and peg, from and to.
    share
        Share of the weight on p2* instead of p1*, from and to.
    film_ratio
        ρ in m² of a film in place of the points, from and to.
    """

    position: Range = (0.0, 0.0)
    orientation: float = 0.0
    tip: Range = (0.0, 0.0)
    friction: Range = (printed.TIP_FRICTION["p1*"],) * 2
    share: Range = (0.0, 0.0)
    film_ratio: Range | None = None


POSE = Errors(position=(5e-6, 5e-6), orientation=0.3 * units.DEG)
"""Section IX-A."""
PROBE = Errors(tip=(5e-6, 5e-6))
"""Section IX-A."""
MU = Errors(friction=(printed.TIP_FRICTION["p2*"], printed.TIP_FRICTION["p1*"]))
"""Between the two of Table I."""
SUPPORT = Errors(share=(0.0, 1.0))
"""p1*, p2* and their blends."""
ALL = replace(POSE, tip=PROBE.tip, friction=MU.friction, share=SUPPORT.share)
ON_FILM = replace(
    POSE,
    tip=PROBE.tip,
    friction=printed.FRICTION,
    film_ratio=(0.95 * printed.FILM_RATIO, 1.05 * printed.FILM_RATIO),
)
"""As `ALL`, on the film of Section X-A, whose ρ is known to 5 %."""
REPORTED = Errors(position=(26e-6, 74e-6), orientation=3.0 * units.DEG, tip=(11e-6, 21e-6))
"""Largest differences among the trials of the scripted plan, Section VII."""


def drawn(errors: Errors, runs: int, rng: np.random.Generator, place: Place) -> Runs:
    """Runs with errors; starts that would stand in a wall are drawn again.

    Parameters
    ----------
    errors
        Ranges.
    runs
        How many.
    rng
        Source of the draws.
    place
        The slot.
    """
    poses = _starts(errors, runs, rng)
    while not (free := place.free(poses)).all():
        poses[~free] = _starts(errors, int(np.sum(~free)), rng)
    film = errors.film_ratio
    return Runs(
        poses=poses,
        tips=rng.uniform(-1.0, 1.0, (runs, 2)) * errors.tip,
        friction=rng.uniform(*errors.friction, runs),
        share=rng.uniform(*errors.share, runs),
        film_ratio=None if film is None else rng.uniform(*film, runs),
    )


def _starts(errors: Errors, runs: int, rng: np.random.Generator) -> Floats:
    half = np.array([*errors.position, errors.orientation])
    return np.asarray(START + rng.uniform(-1.0, 1.0, (runs, 3)) * half)


def successes(
    plan: Plan,
    runs: int,
    errors: Errors,
    rng: np.random.Generator,
    *,
    place: Place | None = None,
    step: float = 2e-6,
) -> Flags:
    """(runs,) whether a plan, run open loop with errors, ends with the peg in the slot.

    Parameters
    ----------
    plan
        Strokes of the tip.
    runs
        How many.
    errors
        Ranges of what is uncertain.
    rng
        Source of the draws.
    place
        The slot; the default place by default.
    step
        Of the simulation, m.
    """
    at = place or Place()
    return succeeded(follow(plan, drawn(errors, runs, rng, at), at, step=step), at)
