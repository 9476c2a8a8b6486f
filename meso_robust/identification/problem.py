"""Least squares of recordings: how to fit, residuals and derivatives at given values, and a step.

Parameters are shared by all recordings, nuisances (a start, an offset of the tips) belong to one
each, so that the normal matrix is an arrow.
"""

from __future__ import annotations

from dataclasses import dataclass, fields, replace

import numpy as np
import numpy.typing as npt

from meso_robust.identification.forward import predicted
from meso_robust.identification.models.model import Model
from meso_robust.identification.prepared import Prepared
from meso_robust.types import Flags, Floats, Ints

_FLOOR = 1e-9  # of a damping, so that a direction without any information does not move
_SHIFT = 0.3  # σ: root mean square change of what is seen over the step of a difference
_SPANS = (1e-5, 2e-2)  # least and largest step of a coordinate


@dataclass(frozen=True, slots=True, kw_only=True)
class Settings:
    """How to fit.

    Attributes
    ----------
    position, orientation
        σ of a seen coordinate in m and rad.
    offset
        σ of an offset of the tips in x and y at the first and at the last instant, m; zero: they are
        where they are said to be.
    most
        Most iterations.
    central
        Whether differences are central; one-sided ones cost half and see kinks from one side.
    flat
        Fall of χ² in one iteration below which a fit has converged.
    chord
        Whether old derivatives will do as long as χ² falls: cheap, where the first are good.
    closing
        Whether a fit ends by derivatives taken where it ends, which it then has. Otherwise old ones that
        promise no fall will do, and it has those.
    workers
        Threads; all cores by default.
    """

    position: float
    orientation: float
    offset: float = 0.0
    most: int = 40
    central: bool = True
    flat: float = 1e-2
    chord: bool = False
    closing: bool = True
    workers: int | None = None

    @property
    def sigma(self) -> Floats:
        """(3,) σ of x, y and θ."""
        return np.array([self.position, self.position, self.orientation])

    def by_chord(self, most: int, flat: float) -> Settings:
        """For fits that are many or begin near their end: derivatives are one-sided, and do for long.

        Parameters
        ----------
        most, flat
            As the attributes.
        """
        return replace(self, chord=True, closing=False, central=False, most=most, flat=flat)

    @property
    def units(self) -> Floats:
        """(d,) units of the nuisances: of the start, and of the offset if there is one."""
        return np.append(self.sigma, [self.offset] * 4) if self.offset else self.sigma


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Fits:
    """B fits of a model with n parameters to R recordings.

    Attributes
    ----------
    values
        (B, n) in SI.
    starts, offsets
        (B, R, 3) poses at the first instants in m and rad, and (B, R, 4) offsets of the tips in m: x
        and y at the first instant, x and y at the last.
    chi2
        (B,) squared residuals over σ², with those of the offsets.
    residuals
        (B, R, T, 3) seen less predicted over σ, times the weight of the frame; zero where not seen.
    outcomes
        (B, R) of the runs.
    """

    values: Floats
    starts: Floats
    offsets: Floats
    chi2: Floats
    residuals: Floats
    outcomes: npt.NDArray[np.int8]

    def __len__(self) -> int:
        """Number of fits."""
        return len(self.values)

    def of(self, rows: Ints | Flags | list[int]) -> Fits:
        """Some of the fits."""
        return Fits(**{item.name: getattr(self, item.name)[rows] for item in fields(self)})


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Fitted:
    """What a search for the maximum of B likelihoods has found.

    Attributes
    ----------
    fits
        The B fits.
    information
        (B, n, n) about the coordinates of the parameters (`Model.coordinates`), the starts unknown;
        zero for what was not fitted.
    gradients
        (B, R, n) slope of −χ²/2 along the coordinates, by recording.
    jacobian
        (B, R, 3 T, n + d) derivatives of the predictions over σ along coordinates and nuisances.
    converged
        (B,) whether χ² stopped falling.
    iterations
        Of the longest search.
    """

    fits: Fits
    information: Floats
    gradients: Floats
    jacobian: Floats
    converged: Flags
    iterations: int

    def of(self, row: int) -> Fitted:
        """One of the B fits."""
        return Fitted(
            fits=self.fits.of([row]),
            information=self.information[[row]],
            gradients=self.gradients[[row]],
            jacobian=self.jacobian[[row]],
            converged=self.converged[[row]],
            iterations=self.iterations,
        )


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

    def step(self, damping: Floats, moving: Flags) -> tuple[Floats, Floats]:
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
        if self.prepared.weights is not None:
            residuals = residuals * self.prepared.weights[..., None]
        freed = starts.copy()
        freed[..., :2] += found.shifts
        return self._fits(values, freed, offsets, residuals, found.outcomes)

    def part(self, fits: Fits, rows: Ints) -> Fits:
        """Fits to recordings of which ``rows`` are those of this problem, as they stand for these alone."""
        own = (
            getattr(fits, name)[:, rows] for name in ("starts", "offsets", "residuals", "outcomes")
        )
        return self._fits(fits.values.copy(), *own)

    def _fits(
        self,
        values: Floats,
        starts: Floats,
        offsets: Floats,
        residuals: Floats,
        outcomes: npt.NDArray[np.int8],
    ) -> Fits:
        with np.errstate(over="ignore"):  # of a search far out; it is not taken
            chi2 = np.sum(residuals**2, axis=(1, 2, 3))
        if self.settings.offset:
            chi2 = chi2 + np.sum((offsets / self.settings.offset) ** 2, axis=(1, 2))
        return Fits(
            values=values,
            starts=starts,
            offsets=offsets,
            chi2=np.asarray(chi2),
            residuals=residuals,
            outcomes=outcomes,
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

    def jacobian(self, fits: Fits, spans: Floats, free: Flags) -> Floats:
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

    def tried(self, fits: Fits, steps: Floats, nuisances: Floats, free: Flags) -> Fits:
        """Fits after a step; χ² is infinite where the values would not be valid, or the step is no number."""
        told = np.isfinite(np.sum(steps, axis=-1) + np.sum(nuisances, axis=(-2, -1)))
        steps = np.where(told[:, None], steps, 0.0)
        nuisances = np.where(told[:, None, None], nuisances, 0.0)
        values = self.model.values(self.model.coordinates(fits.values) + steps)
        low, high = self.ends
        values = np.where(free, np.clip(values, low, high), fits.values)
        valid = self.model.valid(values) & told
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

    def moving(self, fits: Fits, pull: Floats, free: Flags) -> Flags:
        """(B, n) parameters that are free and not pressed against an end of their range."""
        low, high = self.ends
        stuck = ((fits.values <= low) & (pull < 0.0)) | ((fits.values >= high) & (pull > 0.0))
        return np.asarray(free & ~stuck)
