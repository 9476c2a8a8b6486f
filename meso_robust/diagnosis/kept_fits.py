"""Fits on disk, by what was fitted."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

from meso_robust.diagnosis.store import Store
from meso_robust.identification.fitted import Fits, Fitted
from meso_robust.types import Floats


def kept_fit(store: Store, name: str, make: Callable[[], Fitted]) -> Fitted:
    """A fit of a name: from disk, or made and put there."""
    return _unpacked(store.kept(name, lambda: _packed(make())))


def _packed(found: Fitted) -> dict[str, Floats]:
    fits = found.fits
    return {
        "values": fits.values,
        "starts": fits.starts,
        "offsets": fits.offsets,
        "chi2": fits.chi2,
        "residuals": fits.residuals,
        "outcomes": fits.outcomes.astype(float),
        "information": found.information,
        "gradients": found.gradients,
        "jacobian": np.asarray(found.jacobian),
        "converged": found.converged.astype(float),
        "iterations": np.array([float(found.iterations)]),
    }


def _unpacked(of: Mapping[str, Floats]) -> Fitted:
    fits = Fits(
        values=of["values"],
        starts=of["starts"],
        offsets=of["offsets"],
        chi2=of["chi2"],
        residuals=of["residuals"],
        outcomes=of["outcomes"].astype(np.int8),
    )
    return Fitted(
        fits=fits,
        information=of["information"],
        gradients=of["gradients"],
        jacobian=of["jacobian"],
        converged=of["converged"] != 0.0,
        iterations=int(of["iterations"][0]),
    )
