"""Calibration from the points of a stage grid, by least squares with intervals."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt
from scipy.optimize import least_squares
from scipy.stats import t as student

from meso_robust.errors import InputError
from meso_robust.tracking.calibration import MOST_K1, Calibration, Interval
from meso_robust.tracking.grid import LEAST_POINTS, GridPoints, find_grid
from meso_robust.types import Flags, Floats

_MOST_RMS = 0.5  # px; beyond it the points are no plane grid of equal pitch seen from above
_OUTLIER = 5.0  # standard deviations; dust on a dot, a damaged corner
_SIGNIFICANT = 5.0  # standard deviations of k1 from 0, before its centre is asked for
_LEVEL = 0.975  # of a two-sided 95 % interval


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class GridFit:
    """A calibration and what speaks for it.

    Attributes
    ----------
    calibration
        With the world's origin at the middle of the image.
    points
        What was found.
    kept
        (N,) which points the fit used; the others lie off by more than five standard deviations.
    rms
        Root mean square of the residuals of the kept points, px, each coordinate.
    """

    calibration: Calibration
    points: GridPoints
    kept: Flags
    rms: float


def calibrate(image: npt.NDArray[np.uint8], pitch: float) -> GridFit:
    """Calibrate from a grey image (H, W) of a chessboard or dot grid that is aligned with the stage.

    Parameters
    ----------
    image
        Grey values.
    pitch
        Side of a square, or distance of neighbouring dots, m.

    Returns
    -------
    GridFit
        The turn of the camera is taken to be within ±45°: a grid looks alike every 90°.

    Raises
    ------
    InputError
        No grid is found, or what is found is no plane grid of equal pitch.
    """
    if not 0.0 < pitch < math.inf:
        raise InputError(f"--pitch-um {pitch * 1e6}: must be positive; give the grid's pitch")
    points = find_grid(image)
    size = (image.shape[1], image.shape[0])
    kept = np.ones(len(points.seen), dtype=bool)
    fit = _fit(points, kept, pitch, size)
    kept = _inliers(fit.residuals)
    if kept.sum() < max(LEAST_POINTS, 0.8 * len(kept)):
        raise InputError(
            f"--grid: {int((~kept).sum())} of {len(kept)} points do not lie on a grid of equal "
            "pitch; give an image of a plane grid seen from straight above"
        )
    fit = _fit(points, kept, pitch, size)
    if fit.rms > _MOST_RMS:
        raise InputError(
            f"--grid: points miss a grid of equal pitch by {fit.rms:.2f} px (rms); must be at most "
            f"{_MOST_RMS} px; give an image of a plane grid seen from straight above"
        )
    return GridFit(calibration=fit.calibration, points=points, kept=kept, rms=fit.rms)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Fit:
    calibration: Calibration
    residuals: Floats  # (N, 2) px, of all points
    rms: float


def _fit(points: GridPoints, kept: Flags, pitch: float, size: tuple[int, int]) -> _Fit:
    """Fit with the centre of distortion in the middle, and free where the data tell it."""
    plain = _solved(points, kept, pitch, size, free_centre=False)
    interval = plain.calibration.interval
    if interval is None or abs(plain.calibration.k1) < _SIGNIFICANT / 1.96 * interval.k1:
        return plain
    free = _solved(points, kept, pitch, size, free_centre=True)
    known = free.calibration.interval
    told = known is not None and max(known.k1_centre) < free.calibration.half_diagonal
    return free if told else plain


def _solved(
    points: GridPoints,
    kept: Flags,
    pitch: float,
    size: tuple[int, int],
    free_centre: bool,
) -> _Fit:
    start = _start(points, pitch, size)
    stage = np.asarray(points.index * pitch, dtype=np.float64)

    def camera(x: Floats) -> Calibration:
        about = tuple((start.middle + 100.0 * x[5:7]).tolist()) if free_centre else None
        return replace(
            start,
            pixel_size=start.pixel_size * math.exp(x[0]),
            rotation=start.rotation + x[1],
            centre=(start.centre[0] + x[2] * pitch, start.centre[1] + x[3] * pitch),
            k1=float(np.clip(x[4], -MOST_K1, MOST_K1)),
            k1_centre=None if about is None else (about[0], about[1]),
        )

    def miss(x: Floats) -> Floats:
        return _expected(camera(x), stage, points.radius) - points.seen

    count = 7 if free_centre else 5
    found = least_squares(lambda x: miss(x)[kept].ravel(), np.zeros(count), x_scale="jac")
    residuals = miss(found.x)
    freedom = 2 * int(kept.sum()) - count
    variance = float(np.sum(residuals[kept] ** 2)) / freedom
    spread = np.sqrt(variance * np.diag(np.linalg.pinv(found.jac.T @ found.jac)))
    half = student.ppf(_LEVEL, freedom) * spread
    best = camera(found.x)
    about = (100.0 * half[5], 100.0 * half[6]) if free_centre else (math.inf, math.inf)
    interval = Interval(
        pixel_size=float(best.pixel_size * half[0]),
        rotation=float(half[1]),
        k1=float(half[4]),
        k1_centre=(float(about[0]), float(about[1])),
    )
    # the grid's own origin is arbitrary: the world's is put at the middle of the image
    calibration = replace(best, centre=(0.0, 0.0), interval=interval)
    return _Fit(calibration=calibration, residuals=residuals, rms=math.sqrt(variance))


def _expected(camera: Calibration, stage: Floats, radius: float) -> Floats:
    """Where corners, or centroids of dots of a radius in px, are seen (N, 2).

    A lens stretches the outer half of a dot more than the inner one: to first order in k1 the centroid
    of a disc lies 3 k1 radius² / h² of its distance from the centre of distortion further out than the
    image of its middle (half the Laplacian, and the gradient of the area, times radius² / 4).
    """
    ideal = camera.world_to_ideal(stage)
    about = camera.middle if camera.k1_centre is None else np.array(camera.k1_centre)
    out = 3.0 * camera.k1 * (radius / camera.half_diagonal) ** 2
    return camera.to_image(ideal) + out * (ideal - about)


def _start(points: GridPoints, pitch: float, size: tuple[int, int]) -> Calibration:
    """Similarity through the points, without distortion, as the first guess."""
    index = points.index.astype(float)
    seen = points.seen * np.array([1.0, -1.0])  # v up, so that the map turns and does not mirror
    a, b = index - index.mean(axis=0), seen - seen.mean(axis=0)
    dot = float(np.sum(a * b))
    cross = float(np.sum(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]))
    scale = math.hypot(dot, cross) / float(np.sum(a**2))  # px a step
    plain = Calibration(pixel_size=pitch / scale, size=size, rotation=-math.atan2(cross, dot))
    shift = np.mean(points.index * pitch - plain.to_world(points.seen), axis=0)
    return replace(plain, centre=(float(shift[0]), float(shift[1])))


def _inliers(residuals: Floats) -> Flags:
    """(N,) points within five standard deviations, measured by the median."""
    size = np.linalg.norm(residuals, axis=1)
    sigma = np.median(size) / 1.1774  # of a Rayleigh distribution
    return size <= _OUTLIER * max(float(sigma), 1e-3)
