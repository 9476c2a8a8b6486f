"""Invariances of the plain model, tested on the recordings alone: no simulator.

A rigid part on an even, centred, memoryless film, pushed by rigid tips, moves about its own frame in
the same way at any speed, place and heading, later, mirrored and turned; it rests while no tip
touches it and when the tip retracts; a tip in contact stays at its radius from the outline. Pairs of
pushes that coincide in the frame of the part, and single pushes, test that. What they may differ by
is the noise, and the unequal starts of a pair times how much a push makes of them: of a contact
that is elsewhere by ``a``, an angle of about ``S a / k²`` after a way S, k the radius of gyration of
the outline.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass, fields
from typing import Literal

import numpy as np
from scipy.stats import chi2 as chi2_law

from meso_robust.diagnosis.runs import FEWEST, SINGLES, Run, from_start, longer, offered, runs_of
from meso_robust.identification.models.model import centroid
from meso_robust.identification.prepared import Prepared
from meso_robust.recordings.outline import gyration
from meso_robust.types import Flags, Floats

_SAME = 1e-6  # of the size: how well corners must fall on corners
_ALIKE = 5e-6  # m: contacts and paths that are farther apart are not the same push
_SHORTEST = 80e-6  # m: of a common way
_GRID = 10e-6  # m: between places where two paths are compared
_SPEED = 1.2  # ratio of speeds that counts as another speed
_PLACE = 100e-6  # m
_HEADING = np.radians(10.0)
_LATER = 1.0  # s
_DEGREE = 3  # of the polynomial in the way of the tip that a motion is smoothed by
_SHARE = 0.3  # of the largest sensitivity to the place, that is never relied on to vanish


@dataclass(frozen=True, slots=True, eq=False)
class Symmetry:
    """``x → A x + t`` in the frame of the part, with an orthogonal A (2, 2) and t (2,) in m."""

    matrix: Floats
    offset: Floats
    kind: Literal["same", "turn", "mirror"]

    def of_points(self, points: Floats) -> Floats:
        """Images of points (…, 2)."""
        return np.asarray(points @ self.matrix.T + self.offset)

    def of_motion(self, motion: Floats) -> Floats:
        """Image of a motion (3,): displacement of the reference point, and angle.

        A mirrored part turns the other way; the reference point need not be the centre.
        """
        angle = motion[2] * np.linalg.det(self.matrix)
        cos, sin = np.cos(angle), np.sin(angle)
        turned = np.array([[cos, -sin], [sin, cos]]) @ self.offset
        moved = self.matrix @ motion[:2] + self.offset - turned
        return np.array([*moved, angle])


def symmetries(outline: Floats) -> tuple[Symmetry, ...]:
    """All symmetries of an outline (V, 2), the identity first."""
    centre, count = centroid(outline), len(outline)
    away = outline - centre
    size = float(np.hypot(*away.T).max())
    found = []
    for mirrored in (False, True):
        corners = away[::-1] * [1.0, -1.0] if mirrored else away
        for shift in range(count):
            image = np.roll(corners, -shift, axis=0)
            angle = _angle(image[0], away[0])
            cos, sin = np.cos(angle), np.sin(angle)
            matrix = np.array([[cos, -sin], [sin, cos]])
            if np.abs(image @ matrix.T - away).max() > _SAME * size:
                continue
            matrix = matrix @ np.diag([1.0, -1.0]) if mirrored else matrix
            same = not mirrored and abs(angle) < 1e-9
            kind: Literal["same", "turn", "mirror"] = "mirror" if mirrored else "turn"
            found.append(Symmetry(matrix, centre - matrix @ centre, "same" if same else kind))
    return tuple(sorted(found, key=lambda one: one.kind != "same"))


def _angle(start: Floats, end: Floats) -> float:
    """Angle from a direction (2,) to another, −π … π."""
    cross = start[0] * end[1] - start[1] * end[0]
    return float(np.arctan2(cross, start @ end))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Expected:
    """Two pushes that should coincide, or one that should keep to something (first = second).

    Attributes
    ----------
    invariance
        What should make no difference: of pairs ``speed``, ``place``, ``heading``, ``later``,
        ``reversal``, ``mirror``, ``turn``, several joined by ``+``, or ``repeat``; of single pushes
        ``untouched`` (drift before contact), ``rest`` (drift after the push), ``retract`` (motion
        as the tip leaves), ``onset`` (gap of a tip in contact) and ``metric`` (its change).
    first, second
        Files.
    tolerance
        (3,) standard deviation that noise and unequal starts explain of a difference in x, y (m) and
        θ (rad), in the frame of the first part at its start; zero where the test says nothing.
    way
        Travel of the tip at which motions are compared, m; zero for single pushes.
    symmetry
        Of the outline, that takes the second push to the first.
    """

    invariance: str
    first: str
    second: str
    tolerance: Floats
    way: float
    symmetry: Symmetry


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Pair(Expected):
    """What should coincide, and by how much it does not.

    Attributes
    ----------
    difference
        (3,) x, y in m and θ in rad, as `tolerance`; of a gap in x only.
    """

    difference: Floats

    @property
    def sigma(self) -> float:
        """Length of the difference in standard deviations."""
        return float(np.sqrt(self._squares.sum()))

    @property
    def p_value(self) -> float:
        """Probability of a longer one by chance."""
        return float(chi2_law.sf(self._squares.sum(), len(self._squares)))

    @property
    def _squares(self) -> Floats:
        used = self.tolerance > 0.0
        return np.asarray((self.difference[used] / self.tolerance[used]) ** 2)


def pairs(prepared: Prepared, sigma: Floats, correlation: float = 0.0) -> tuple[Pair, ...]:
    """Test every invariance that the recordings offer.

    Parameters
    ----------
    prepared
        R recordings.
    sigma, correlation
        (3,) standard deviations of x, y (m) and θ (rad), and φ of the noise.
    """
    runs, poses = runs_of(prepared, sigma, correlation), prepared.seen
    noise = sigma * np.sqrt(longer(correlation))
    found = [
        pair for run in runs for name in SINGLES if (pair := _single(prepared, run, name, noise))
    ]
    known = symmetries(prepared.outline)
    for first, second in itertools.combinations(runs, 2):
        for symmetry in known:
            expected = _coinciding(prepared, first, second, symmetry, noise)
            if expected is not None:
                found.append(_measured(prepared, expected, first, second, poses))
    return tuple(found)


def compared(
    prepared: Prepared,
    found: Sequence[Pair],
    poses: Floats,
    sigma: Floats,
    correlation: float = 0.0,
) -> tuple[Pair, ...]:
    """The same tests on other poses (R, T, 3) of the same commands, such as a model's predictions.

    Frames, ways and tolerances are those of the recordings, so that `Pair.sigma` can be held against
    theirs.
    """
    runs = {run.file: run for run in runs_of(prepared, sigma, correlation)}
    shown = np.where(np.isfinite(prepared.seen), poses, np.nan)
    return tuple(
        _measured(prepared, pair, runs[pair.first], runs[pair.second], shown) for pair in found
    )


def _measured(
    prepared: Prepared, expected: Expected, first: Run, second: Run, poses: Floats
) -> Pair:
    """With the difference that some poses show."""
    if expected.invariance in SINGLES:
        test = SINGLES[expected.invariance]
        difference = test(prepared, first, poses[first.recording], np.ones(3))[0]
    else:
        one = _moved(prepared, first, poses[first.recording], expected.way)
        other = _moved(prepared, second, poses[second.recording], expected.way)
        difference = one - expected.symmetry.of_motion(other)
    same = {field.name: getattr(expected, field.name) for field in fields(Expected)}
    return Pair(**same, difference=difference)


def _coinciding(
    prepared: Prepared, first: Run, second: Run, symmetry: Symmetry, noise: Floats
) -> Expected | None:
    """The pair with its tolerance, if the second push is the symmetric image of the first."""
    if first.tip != second.tip:
        return None
    apart = first.point - symmetry.of_points(second.point)
    blur = float(np.hypot(_blur(prepared, first), _blur(prepared, second)))
    if np.hypot(*apart) > _ALIKE + 3.0 * blur:
        return None
    way = min(first.length, second.length)
    grid = np.arange(0.0, way + 0.5 * _GRID, _GRID)
    paths = first.tips_at(grid) - symmetry.of_points(second.tips_at(grid))
    # probes that are parked play no part
    off = np.hypot(*np.moveaxis(paths, -1, 0))[:, _present(prepared, first)].max(axis=1)
    alike = off <= _ALIKE + 3.0 * blur + 0.02 * grid
    if not np.all(alike):
        way = float(grid[int(np.argmin(alike))]) - _GRID
    if way < _SHORTEST:
        return None
    names = _differing(first, second, symmetry)
    last = paths[int(way / _GRID), first.tip] - paths[0, first.tip]
    tolerance = _tolerance(prepared, first, second, way, apart, last, noise)
    if tolerance is None:
        return None
    return Expected(
        invariance="+".join(names) or "repeat",
        first=first.file,
        second=second.file,
        tolerance=tolerance,
        way=way,
        symmetry=symmetry,
    )


def _tolerance(
    prepared: Prepared,
    first: Run,
    second: Run,
    way: float,
    apart: Floats,
    paths: Floats,
    noise: Floats,
) -> Floats | None:
    """(3,) what noise and unequal starts explain, m and rad; None with too few frames.

    `apart` (2,) is between the contacts, `paths` (2,) how far the tips have come apart after the way.
    """
    shares = [_smoothed(prepared, run, way) for run in (first, second)]
    if shares[0] is None or shares[1] is None:
        return None
    square = noise**2 * sum(float(share @ share) for share in shares if share is not None)
    starts = first.start_sigma**2 + second.start_sigma**2
    square = square + starts
    square[:2] += way**2 * starts[2]
    along = np.array([-first.normal[1], first.normal[0]])
    reach, angle = float(np.hypot(*first.point)), float(np.hypot(*paths)) / way
    place = np.sqrt((apart @ along) ** 2 + (reach * angle) ** 2 + starts[0] + reach**2 * starts[2])
    centre = centroid(prepared.outline)
    x, y = first.point - centre
    arm, k = x * first.normal[1] - y * first.normal[0], gyration(prepared.outline - centre)
    slope = way * (abs(k**2 - arm**2) / (k**2 + arm**2) ** 2 + _SHARE / k**2)
    square[2] += (slope * place) ** 2
    square[:2] += (reach * slope * place) ** 2 + (way * angle) ** 2
    return np.asarray(np.sqrt(square))


def _differing(first: Run, second: Run, symmetry: Symmetry) -> list[str]:
    """What two pushes that coincide about the part differ by."""
    ratio = max(first.speed, second.speed) / min(first.speed, second.speed)
    normals = [np.arctan2(run.normal[1], run.normal[0]) + run.start[2] for run in (first, second)]
    turned = abs((normals[0] - normals[1] + np.pi) % (2.0 * np.pi) - np.pi)
    differs = {
        symmetry.kind: symmetry.kind != "same",
        "speed": ratio > _SPEED,
        "place": float(np.hypot(*(first.start - second.start)[:2])) > _PLACE,
        "heading": turned > _HEADING,
        "later": abs(first.contact_s - second.contact_s) > _LATER,
        "reversal": first.reversals != second.reversals,
    }
    return [name for name, does in differs.items() if does]


def _blur(prepared: Prepared, run: Run) -> float:
    """σ in m of a place of the outline at the start."""
    return float(np.hypot(run.start_sigma[0], prepared.length * run.start_sigma[2]))


def _present(prepared: Prepared, run: Run) -> Flags:
    """(P,) whether a recording has a probe."""
    away = prepared.waypoints[run.recording] == -prepared.parked
    return ~np.all(away, axis=(0, 2))


def _smoothed(prepared: Prepared, run: Run, way: float) -> Floats | None:
    """Weights of the pushed frames (n,) in the motion at a way of the tip: a cubic fitted to it."""
    travel = run.travel_at(prepared.instants[run.recording, run.pushed]) / way
    kept = travel <= 1.0
    if int(kept.sum()) < FEWEST + _DEGREE:
        return None
    powers = np.vander(travel[kept], _DEGREE + 1)
    weights = np.zeros(len(travel))
    weights[kept] = np.ones(_DEGREE + 1) @ np.linalg.pinv(powers)
    return weights


def _moved(prepared: Prepared, run: Run, poses: Floats, way: float) -> Floats:
    """(3,) motion in the frame of the start after a way of the tip, m and rad."""
    weights = _smoothed(prepared, run, way)
    if weights is None:
        raise AssertionError("a pair has enough frames")
    return from_start(weights @ poses[run.pushed], poses[run.still].mean(axis=0))


def _single(prepared: Prepared, run: Run, name: str, noise: Floats) -> Pair | None:
    """A test of one push, if it has the frames."""
    if not offered(prepared, run, name, noise):
        return None
    poses = prepared.seen[run.recording]
    expected = Expected(
        invariance=name,
        first=run.file,
        second=run.file,
        tolerance=SINGLES[name](prepared, run, poses, noise)[1],
        way=0.0,
        symmetry=symmetries(prepared.outline)[0],
    )
    return _measured(prepared, expected, run, run, prepared.seen)
