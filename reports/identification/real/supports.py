"""Three support points from motion alone, beside the points that the part really stood on."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from meso_robust.identification.models import Model, three_point, viscous, with_effects
from meso_robust.identification.prepared import Prepared, prepare
from meso_robust.recordings import Recording, RecordingSet
from reports.identification.real.fitting import (
    Problem,
    bootstrapped,
    difference,
    errors,
    fitted,
    losses,
    root_mean_square,
)
from reports.identification.real.ladders import OFFSET, RATIO
from reports.identification.real.wrenches import apart, ordered

F = npt.NDArray[np.float64]

POINTS = slice(2, 8)  # columns of the points in the model's values
STEPS = 4.0  # times the model's own step: by far finer than the errors met
EVERY = 8  # of the tool's instants a corner of its path, at 3.3 mm/s 0.8 mm apart
SCALE = 3e-4  # m, as in `fitting.Problem`
SAME = 3e-3  # m: support points closer than this, root mean square, count as one minimum
LOST = 0.02  # m: a part whose tip ends farther from its outline was not where its pose says
_FRICTION = (0.4, 0.3)  # μ_t and μ_s where searches start; the motion does not depend on μ_s


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Candidate:
    """A local minimum.

    Attributes
    ----------
    values
        (n,) of the model with the offset of the reference point, SI.
    cost
        In m².
    away
        Root mean square distance of its points from the known ones, m.
    worse
        (2,) interval of the mean loss above that of the best, in units of the best's mean loss.
    """

    values: F
    cost: float
    away: float
    worse: F

    @property
    def points(self) -> F:
        """(3, 2) m, body frame, in the order of their angle."""
        return ordered(self.values[POINTS].reshape(3, 2))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Recovered:
    """What the motion tells of the supports.

    Attributes
    ----------
    candidates
        Minima, the best first.
    known
        The known points, with friction and offset fitted.
    spread
        (draws, 3, 2) points of the best, refitted to pushes drawn with replacement, m.
    friction
        (draws,) μ_t of the same.
    pushes
        How many pushes were used.
    misfit
        (2,) root mean square error of the last pose, m and rad, of the best.
    film
        As `Candidate.worse`, of a film with the same offset (√ρ, µ_t): an ellipsoidal limit surface.
    """

    candidates: tuple[Candidate, ...]
    known: Candidate
    spread: F
    friction: F
    pushes: int
    misfit: F
    film: F


def usable(recordings: RecordingSet, prefix: str) -> tuple[RecordingSet, tuple[str, ...]]:
    """Pushes of some logs whose last pose has the tip at the part, thinned; and the others' names."""
    own = [r for r in recordings.recordings if r.file.startswith(prefix)]
    wrong = tuple(r.file for r in own if _distance(recordings, r) > LOST)
    kept = tuple(_thinned(r) for r in own if r.file not in wrong)
    return replace(recordings, recordings=kept), wrong


def _distance(recordings: RecordingSet, recording: Recording) -> float:
    """How far the tip is outside the part at the end, m, along the farthest side of a convex part."""
    outline = recordings.part.outline
    side = np.roll(outline, -1, axis=0) - outline
    normal = np.stack([side[:, 1], -side[:, 0]], axis=-1) / np.linalg.norm(side, axis=1)[:, None]
    x, y, theta = recording.poses[-1]
    away = recording.probes[-1, 0] - (x, y)
    cos, sin = np.cos(theta), np.sin(theta)
    own = np.array([cos * away[0] + sin * away[1], cos * away[1] - sin * away[0]])
    return float(np.max(normal @ own - np.sum(normal * outline, axis=1)))


def _thinned(recording: Recording) -> Recording:
    """Every so many instants, and the last: the tool's path is straight."""
    count = len(recording.times)
    rows = np.unique(np.append(np.arange(0, count, EVERY), count - 1))
    return replace(
        recording,
        times=recording.times[rows],
        poses=recording.poses[rows],
        probes=recording.probes[rows],
        forces=None,
    )


def problem_of(recordings: RecordingSet) -> Problem:
    """Three points and the offset of the reference point."""
    base = three_point(recordings.part.outline)
    prepared: Prepared = prepare(recordings, step=STEPS * base.step)
    return Problem(prepared=prepared, model=with_effects(base, OFFSET), scale=SCALE)


def recovered(problem: Problem, known: F, *, starts: int, draws: int, seed: int) -> Recovered:
    """Search from random points, group what is found, and set it beside the known points (3, 2)."""
    rng = np.random.default_rng(seed)
    ends = [fitted(problem, start) for start in _starts(problem.model, rng, starts)]
    ends.sort(key=lambda end: end.cost)
    at_known = np.concatenate([_FRICTION, known.reshape(-1), np.zeros(2)])
    held = np.ones(len(at_known), dtype=bool)
    held[1:8] = False
    truth = fitted(problem, at_known, free=held)
    best = losses(problem, ends[0].values[None])[0]

    def candidate(values: F, cost: float) -> Candidate:
        own = losses(problem, values[None])[0]
        return Candidate(
            values=values,
            cost=cost,
            away=apart(ordered(values[POINTS].reshape(3, 2)), ordered(known)),
            worse=difference(own, best) / best.mean(),
        )

    found: list[Candidate] = []
    for end in ends:
        points = ordered(end.values[POINTS].reshape(3, 2))
        if all(apart(points, other.points) > SAME for other in found):
            found.append(candidate(end.values, end.cost))
    drawn = bootstrapped(problem, ends[0].values, draws, seed)
    return Recovered(
        candidates=tuple(found),
        known=candidate(truth.values, truth.cost),
        spread=np.array([ordered(values[POINTS].reshape(3, 2)) for values in drawn]),
        friction=drawn[:, 0],
        pushes=problem.pushes,
        # of two poses the first is exact, so that the mean over both is half of the last's square
        misfit=np.sqrt(2.0) * root_mean_square(errors(problem, ends[0].values)),
        film=difference(_film(problem), best) / best.mean(),
    )


def _film(problem: Problem) -> F:
    """(R,) losses of the best film with the offset of the reference point."""
    model = with_effects(viscous(problem.prepared.outline), OFFSET)
    film = replace(problem, model=model)
    start = np.array([RATIO * problem.prepared.length**2, _FRICTION[0], 0.0, 0.0])
    return np.asarray(losses(film, fitted(film, start).values[None])[0])


def _starts(model: Model, rng: np.random.Generator, count: int) -> F:
    """(count, n) random points, usual friction, no offset."""
    values = model.draw(rng, count)
    values[:, :2] = _FRICTION
    values[:, POINTS.stop :] = 0.0
    return values
