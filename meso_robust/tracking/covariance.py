"""How uncertain a pose is, errors along an outline or across a surface being correlated."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from meso_robust.types import Floats, Ints

SIDE_GROWTH = 2.2
"""Variance by which one side as a whole may seem displaced or tilted by texture, halo and background, over
what the residuals of points along a side share: assumed before the sides are seen, worth SIDE_COUNT observations.
The noise of pixels, which is all there is to a side lit through the slide, is shared by none of them."""
SIDE_LEAST = 0.05
"""Share of the residuals' variance that counts as shared besides: few points do not tell that nothing is."""
SIDE_COUNT = 4.0
SIDE_TILT = 1.3
"""Displacement of a side's ends by its tilt, relative to that of the side as a whole."""
LAMP_SIGMA = 0.5
"""px; by how much oblique light displaces a part, along each axis, before the image is seen."""
LAMP_FLOOR = 0.015
"""px; what the rim model (:mod:`meso_robust.tracking.rim`) gets wrong however well it fits."""


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
    from meso_robust.tracking.covariance_kernels import clustered as summed

    return summed(design, weight, residual, starts)


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


class Systematic(NamedTuple):
    """Sides displaced or tilted as a whole (:func:`side_modes`).

    Attributes
    ----------
    sigma
        (2 S,) px; standard deviation of each mode.
    response
        (2 S, k) by how much each displaces the solution, a px: the pose (u, v, angle) in the part's axes
        first.
    """

    sigma: Floats
    response: Floats

    def covariance(self, turn: Floats, known: Floats | None) -> Floats:
        """(3, 3) in the image's axes, with ``turn`` (2, 2) from the part's to them.

        ``known`` (2 S, 2) are displacements by the modes that were measured and are taken off: what
        is left of them is how much they differ from those of the present frame.
        """
        moved = self.response[:, :3].copy()
        moved[:, :2] = self.displacement(turn) - (0.0 if known is None else known)
        scaled = moved * self.sigma[:, None]
        return scaled.T @ scaled

    def displacement(self, turn: Floats) -> Floats:
        """(2 S, 2) px of the part in the image's axes, a px of each mode."""
        return self.response[:, :2] @ turn.T


def systematic(design: Floats, weight: Floats, residual: Floats, modes: Floats) -> Systematic:
    """How far sides may be displaced or tilted as a whole, and what that does to the pose.

    What the fit could not absorb of such displacements shows in the residuals. Those by light, which
    displace sides without tilting them, say nothing of tilts: the two kinds are told apart.
    """
    from meso_robust.tracking.covariance_kernels import displaced

    assumed = SIDE_GROWTH, SIDE_LEAST, SIDE_COUNT
    return Systematic(*displaced(design, weight, residual, modes, assumed))


def lamp_covariance(fit: Floats) -> Floats:
    """(3, 3) of the pose from the covariance (2, 2) px² of the displacement by oblique light."""
    full = np.zeros((3, 3))
    full[:2, :2] = fit + LAMP_FLOOR**2 * np.eye(2)
    return full


def fused(a: Floats, cov_a: Floats, b: Floats, cov_b: Floats) -> tuple[Floats, Floats]:
    """Two independent estimates (k,) weighted by their information, and the covariance."""
    gain = cov_a @ np.linalg.inv(cov_a + cov_b)
    return a + gain @ (b - a), cov_a - gain @ cov_a


def turned(covariance: Floats, rotation: Floats) -> Floats:
    """(3, 3) covariance of (u, v, angle) after ``rotation`` (2, 2) of the first two axes."""
    full = np.eye(3)
    full[:2, :2] = rotation
    return full @ covariance[:3, :3] @ full.T
