"""Formulas over NumPy arrays: many points at once, in plain floating point."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import numpy.typing as npt

from meso_robust.conditions.formula import formula
from meso_robust.types import Floats


def values(module: str, name: str) -> Callable[..., tuple[Floats, ...]]:
    """The generated function ``module.name`` over arrays.

    Parameters
    ----------
    module, name
        As for :func:`meso_robust.conditions.condition`.

    Returns
    -------
    Callable
        Takes the arguments by name, as numbers or arrays that broadcast, and returns one array of
        the common shape a result; not finite where a formula is undefined.

    Examples
    --------
    >>> (margin,) = values("two_sided_rotation", "no_jam")(V=[3.0, 4.0], d1=1.0, mu=1.0)
    >>> margin
    array([1., 8.])
    """
    function = formula(module, name)

    def evaluate(**arguments: npt.ArrayLike) -> tuple[Floats, ...]:
        arrays = {key: np.asarray(value, dtype=np.float64) for key, value in arguments.items()}
        shape = np.broadcast_shapes(*(array.shape for array in arrays.values()))
        with np.errstate(all="ignore"):
            results = function(np, **arrays)
        return tuple(np.array(np.broadcast_to(result, shape)) for result in results)

    return evaluate
