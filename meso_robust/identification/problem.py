"""What is fitted to what: residuals at given values, their derivatives, and steps."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from meso_robust.identification.bordered_normal_equations import Arrow
from meso_robust.identification.fitted import Fits, Settings
from meso_robust.identification.forward import predicted
from meso_robust.identification.models.model import Model
from meso_robust.identification.prepared import Prepared
from meso_robust.types import Flags as Bools, Floats

_SHIFT = 0.3  # σ: root mean square change of what is seen over the step of a difference
_SPANS = (1e-5, 2e-2)  # least and largest step of a coordinate


@dataclass(frozen=True, slots=True, eq=False)
class Problem:
    """What is fitted to what."""

    prepared: Prepared
    model: Model
    settings: Settings

    def at(self, values: Floats, starts: Floats, offsets: Floats) -> Fits:
        """Fits as they stand at given values; starts are freed of the tips."""
        found = predicted(
            self.prepared,
            self.model,
            values,
            starts=starts,
            offsets=offsets,
            workers=self.settings.workers,
        )
        residuals = np.nan_to_num((self.prepared.seen - found.poses) / self.settings.sigma)
        chi2 = np.sum(residuals**2, axis=(1, 2, 3))
        if self.settings.offset:
            chi2 = chi2 + np.sum((offsets / self.settings.offset) ** 2, axis=(1, 2))
        freed = starts.copy()
        freed[..., :2] += found.shifts
        return Fits(
            values=values,
            starts=freed,
            offsets=offsets,
            chi2=np.asarray(chi2),
            residuals=residuals,
            outcomes=found.outcomes,
        )

    def arrow(self, fits: Fits, jacobian: Floats) -> Arrow:
        """Normal equations from derivatives (B, R, 3 T, n + d) and present residuals."""
        n, units = len(self.model.parameters), self.settings.units
        turned = np.swapaxes(jacobian, -1, -2)
        normal = turned @ jacobian
        slope = (turned @ fits.residuals.reshape(*jacobian.shape[:3], 1))[..., 0]
        if self.settings.offset:
            own = np.arange(n + 3, n + len(units))
            normal[..., own, own] += 1.0
            slope[..., own] -= fits.offsets / self.settings.offset
        return Arrow(normal=normal, slope=slope, parameters=n)

    def jacobian(self, fits: Fits, spans: Floats, free: Bools) -> Floats:
        """Derivatives (B, R, 3 T, n + d) by differences over steps (B, n) of the coordinates."""
        sides = (1.0, -1.0) if self.settings.central else (1.0,)
        shared = [k for k in range(free.shape[1]) if np.any(free[:, k])]
        moves = [self._moved(fits, spans, k, side) for k in shared for side in sides]
        d = len(self.settings.units)
        moves += [self._shifted(fits, k, side) for k in range(d) for side in sides]
        values, starts, offsets, ways = (np.concatenate(part) for part in zip(*moves, strict=True))
        residuals = self.at(values, starts, offsets).residuals
        table = residuals.reshape(-1, len(sides), *fits.residuals.shape)
        way = ways.reshape(-1, len(sides), len(fits))
        if self.settings.central:
            rise, run = table[:, 1] - table[:, 0], way[:, 0] - way[:, 1]
        else:
            rise, run = fits.residuals - table[:, 0], way[:, 0]
        with np.errstate(divide="ignore", invalid="ignore"):
            slopes = np.where(
                run[..., None, None, None] > 0.0, rise / run[..., None, None, None], 0.0
            )
        size = (*fits.residuals.shape[:2], -1)
        jacobian = np.zeros((*fits.residuals.shape[:2], slopes[0, 0, 0].size, free.shape[1] + d))
        columns = [*shared, *range(free.shape[1], free.shape[1] + d)]
        for column, slope in zip(columns, slopes, strict=True):
            jacobian[..., column] = slope.reshape(size)
        return jacobian

    def _moved(
        self, fits: Fits, spans: Floats, k: int, side: float
    ) -> tuple[Floats, Floats, Floats, Floats]:
        """A coordinate moved by its span where that is valid; and by how much it was."""
        coordinates = self.model.coordinates(fits.values)
        coordinates[:, k] += side * spans[:, k]
        values = fits.values.copy()
        values[:, k] = self.model.values(coordinates)[:, k]
        valid = self.model.valid(values)
        values[~valid] = fits.values[~valid]
        return values, fits.starts, fits.offsets, np.where(valid, side * spans[:, k], 0.0)

    def _shifted(self, fits: Fits, k: int, side: float) -> tuple[Floats, Floats, Floats, Floats]:
        """A nuisance moved by a part of its unit, in all recordings."""
        starts, offsets = fits.starts.copy(), fits.offsets.copy()
        way = side * _SHIFT
        if k < 3:
            starts[..., k] += way * self.settings.units[k]
        else:
            offsets[..., k - 3] += way * self.settings.units[k]
        return fits.values, starts, offsets, np.full(len(fits), way)

    def tried(self, fits: Fits, steps: Floats, nuisances: Floats, free: Bools) -> Fits:
        """Fits after a step; χ² is infinite where the values would not be valid."""
        values = self.model.values(self.model.coordinates(fits.values) + steps)
        low, high = self.ends
        values = np.where(free, np.clip(values, low, high), fits.values)
        valid = self.model.valid(values)
        values[~valid] = fits.values[~valid]
        starts = fits.starts + nuisances[..., :3] * self.settings.sigma
        offsets = fits.offsets
        if self.settings.offset:
            offsets = offsets + nuisances[..., 3:] * self.settings.offset
        found = self.at(values, starts, offsets)
        return replace(found, chi2=np.where(valid, found.chi2, np.inf))

    @property
    def ends(self) -> tuple[Floats, Floats]:
        """(n,) least and largest values."""
        parameters = self.model.parameters
        return np.array([p.low for p in parameters]), np.array([p.high for p in parameters])

    def spans(self, arrow: Arrow) -> Floats:
        """(B, n) steps of the differences that change what is seen by a part of the noise."""
        squares = np.einsum("brii->bi", arrow.normal)[:, : arrow.parameters]
        seen = float(self.prepared.counts.sum())
        span = _SHIFT * np.sqrt(seen / np.maximum(squares, 1e-12))
        return np.asarray(np.clip(span, *_SPANS))

    def moving(self, fits: Fits, pull: Floats, free: Bools) -> Bools:
        """(B, n) parameters that are free and not pressed against an end of their range."""
        low, high = self.ends
        stuck = ((fits.values <= low) & (pull < 0.0)) | ((fits.values >= high) & (pull > 0.0))
        return np.asarray(free & ~stuck)
