"""Least squares with an arrow: parameters that all recordings share, nuisances that one has."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from meso_robust.types import Flags as Bools, Floats

_FLOOR = 1e-9  # of a damping, so that a direction without any information does not move


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Arrow:
    """Normal equations of B fits, R recordings, n parameters and d nuisances a recording.

    Attributes
    ----------
    normal
        (B, R, n + d, n + d) ``JᵀJ`` of each recording, J the derivatives of its prediction over σ.
    slope
        (B, R, n + d) ``Jᵀr`` of each recording, r its residuals over σ.
    parameters
        n.
    """

    normal: Floats
    slope: Floats
    parameters: int

    def step(self, damping: Floats, moving: Bools) -> tuple[Floats, Floats]:
        """Damped step of Levenberg and Marquardt.

        Parameters
        ----------
        damping
            (B,) share of the diagonal that is added to it.
        moving
            (B, n) which parameters may move.

        Returns
        -------
        (B, n), (B, R, d)
            Steps of the parameters and of the nuisances.
        """
        schur, right, weight, own = self._reduced(damping)
        diagonal = np.einsum("brii->bi", self.normal)[:, : self.parameters]
        matrix = np.where(moving[:, :, None] & moving[:, None, :], schur, 0.0)
        more = np.where(moving, damping[:, None] * diagonal + _FLOOR, 1.0)
        matrix = matrix + more[..., None] * np.eye(self.parameters)
        force = np.where(moving, right, 0.0)[..., None]
        shared = np.linalg.solve(matrix, force)[..., 0]
        free = np.linalg.solve(own, self.slope[..., self.parameters :, None])[..., 0]
        return shared, free - np.einsum("brdi,bi->brd", weight, shared)

    def fall(self, shared: Floats, own: Floats) -> Floats:
        """(B,) fall of χ² that a step (B, n), (B, R, d) would bring if predictions were linear."""
        recordings = self.normal.shape[1]
        whole = np.concatenate([np.repeat(shared[:, None], recordings, axis=1), own], axis=2)
        linear = 2.0 * np.sum(self.slope * whole, axis=(1, 2))
        return np.asarray(linear - np.einsum("bri,brij,brj->b", whole, self.normal, whole))

    def information(self) -> Floats:
        """(B, n, n) about the parameters, the nuisances unknown (Schur complement)."""
        return self._reduced(np.zeros(len(self.normal)))[0]

    def gradients(self) -> Floats:
        """(B, R, n) slope along the parameters of each recording, its nuisances following."""
        n = self.parameters
        weight = self._reduced(np.zeros(len(self.normal)))[2]
        return np.asarray(
            self.slope[..., :n] - np.einsum("brdi,brd->bri", weight, self.slope[..., n:])
        )

    def pull(self) -> Floats:
        """(B, n) sum of the gradients of the recordings."""
        return np.asarray(self.gradients().sum(axis=1))

    def _reduced(self, damping: Floats) -> tuple[Floats, Floats, Floats, Floats]:
        """Schur complement (B, n, n), its right side (B, n), D⁻¹Cᵀ (B, R, d, n) and D (B, R, d, d)."""
        n = self.parameters
        own, cross = self.normal[..., n:, n:], self.normal[..., :n, n:]
        size = np.einsum("brii->bri", own)
        more = damping[:, None, None] * size + _FLOOR
        own = own + more[..., None] * np.eye(own.shape[-1])
        weight = np.linalg.solve(own, np.swapaxes(cross, -1, -2))
        schur = self.normal[..., :n, :n].sum(axis=1) - np.einsum("brid,brdj->bij", cross, weight)
        right = self.slope[..., :n].sum(axis=1)
        right = right - np.einsum("brdi,brd->bi", weight, self.slope[..., n:])
        return 0.5 * (schur + np.swapaxes(schur, 1, 2)), right, weight, own
