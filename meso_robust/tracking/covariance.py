"""How uncertain a pose is, errors along an outline or across a surface being correlated."""

from __future__ import annotations

import numpy as np

from meso_robust.types import Floats, Ints

SIDE_SIGMA = 0.05
"""px; how far one side as a whole may seem displaced or tilted by texture, halo and background: the
value assumed before the residuals are seen, worth SIDE_COUNT observations."""
SIDE_COUNT = 4.0
SIDE_TILT = 1.3
"""Displacement of a side's ends by its tilt, relative to that of the side as a whole."""
LAMP_SIGMA = 0.5
"""px; by how much oblique light displaces a part, along each axis, before the image is seen."""
LAMP_FLOOR = 0.025
"""px; what remains of a displacement towards the lamp however small it was found."""
LAMP_SHARE = 0.05
"""And the share of it that the rim model (:mod:`meso_robust.tracking.rim`) gets wrong."""
LAMP_SCATTER = 2.5
"""And how many of the standard deviations of that model's fit, whose misfit is not independent."""


def clustered(design: Floats, weight: Floats, residual: Floats, starts: Ints) -> Floats:
    """Covariance (k, k) of a weighted least-squares solution whose errors come in clusters.

    The sandwich (XᵀWX)⁻¹ (Σ s sᵀ) (XᵀWX)⁻¹ with the scores s = Σ w r x summed within each cluster
    (Liang and Zeger, doi:10.1093/biomet/73.1.13): right however errors are correlated within one.

    Parameters
    ----------
    design, weight, residual
        (N, k), (N,), (N,), sorted by cluster.
    starts
        (G,) index of each cluster's first row, G > k.
    """
    bread = _bread(design, weight)
    scores = np.add.reduceat((weight * residual)[:, None] * design, starts, axis=0)
    used = int(np.count_nonzero(np.add.reduceat(weight, starts) > 0.0))
    few = used / max(used - design.shape[1], 1)  # a fit to few clusters hides their scatter
    return few * bread @ (scores.T @ scores) @ bread


def side_modes(side: Ints) -> Floats:
    """(2 S, N) a displacement by 1 px and a tilt by SIDE_TILT px, of each side, at every point."""
    modes = []
    for name in np.unique(side):
        on = side == name
        along = np.linspace(-1.0, 1.0, int(on.sum())) if on.sum() > 1 else np.zeros(1)
        for shape in (np.ones(len(along)), SIDE_TILT * along):
            mode = np.zeros(len(side))
            mode[on] = shape
            modes.append(mode)
    return np.array(modes)


def systematic(design: Floats, weight: Floats, residual: Floats, modes: Floats) -> Floats:
    """Covariance (k, k) from sides displaced or tilted as a whole (:func:`side_modes`).

    What the fit could not absorb of such displacements shows in the residuals; their variance is
    taken together with SIDE_SIGMA, as that many observations more.
    """
    weighted, squared = modes * weight, modes**2
    response = weighted @ design @ _bread(design, weight)
    power = squared @ weight
    seen = weighted @ residual / np.maximum(power, 1e-9)
    used = power > 0.05 * squared.sum(axis=1)
    freedom = max(int(used.sum()) - design.shape[1], 0)
    total = SIDE_COUNT * SIDE_SIGMA**2 + float(np.sum(seen[used] ** 2))
    return total / (SIDE_COUNT + freedom) * response.T @ response


def lamp_estimate(displacement: Floats, fit: Floats) -> tuple[Floats, Floats]:
    """Displacement (2,) px towards the lamp given its least squares, and the covariance (3, 3).

    ``fit`` (2, 2) is the covariance that the least squares state. Where they can hardly tell, the
    displacement is drawn to what it is beforehand: zero, give or take LAMP_SIGMA.
    """
    sigma = np.hypot(LAMP_FLOOR, LAMP_SHARE * np.hypot(*displacement))
    stated = sigma**2 * np.eye(2) + LAMP_SCATTER**2 * fit
    gain = LAMP_SIGMA**2 * np.linalg.inv(LAMP_SIGMA**2 * np.eye(2) + stated)
    full = np.zeros((3, 3))
    full[:2, :2] = gain @ stated
    return gain @ displacement, full


def fused(a: Floats, cov_a: Floats, b: Floats, cov_b: Floats) -> tuple[Floats, Floats]:
    """Two independent estimates (k,) weighted by their information, and the covariance."""
    gain = cov_a @ np.linalg.inv(cov_a + cov_b)
    return a + gain @ (b - a), cov_a - gain @ cov_a


def turned(covariance: Floats, rotation: Floats) -> Floats:
    """(3, 3) covariance of (u, v, angle) after ``rotation`` (2, 2) of the first two axes."""
    full = np.eye(3)
    full[:2, :2] = rotation
    return full @ covariance[:3, :3] @ full.T


def _bread(design: Floats, weight: Floats) -> Floats:
    """(k, k) inverse of the normal matrix; of what is not determined, a very large variance."""
    normal = design.T @ (weight[:, None] * design)
    scale = 1.0 / np.sqrt(np.maximum(np.diag(normal), 1e-12))
    unit = normal * scale[:, None] * scale
    unit[np.diag_indices(len(unit))] += 1e-9
    return np.linalg.inv(unit) * scale[:, None] * scale
