"""Fits as values: how to fit, where parameters and starts stand, and what was found."""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np
import numpy.typing as npt

from meso_robust.types import Flags as Bools, Floats, Ints


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
    workers: int | None = None

    @property
    def sigma(self) -> Floats:
        """(3,) σ of x, y and θ."""
        return np.array([self.position, self.position, self.orientation])

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
        (B, R, T, 3) seen less predicted over σ, zero where not seen.
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

    def of(self, rows: Ints | Bools | list[int]) -> Fits:
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
    converged: Bools
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
