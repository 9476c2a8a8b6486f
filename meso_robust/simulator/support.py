"""The viscous film under the part.

The drag about the centre of the part is ``E = diag(e_x, e_x, e_θ)``, and the quasi-static balance
of the contact wrenches is ``E v = Σ_i (w_n^i λ_n^i + w_t^i λ_t^i)``. Multiplying every force by
``e_x`` leaves the motion as it is, so that only the film ratio ``ρ = e_θ / e_x`` (m²) matters.

With the angle measured as the length ``√ρ θ`` the drag is the identity: a unit force at the lever
arm ``a`` then has the third component ``a / √ρ``, and the part moves by exactly the sum of the
wrenches. The simulator works in these coordinates throughout.
"""

import numpy as np
import numpy.typing as npt
from numba import njit


@njit(cache=True, error_model="numpy")
def arm_scale(film_ratio: float) -> float:
    """Inverse drag of the angle, split evenly between wrench and motion.

    Parameters
    ----------
    film_ratio
        ρ = e_θ / e_x in m².

    Returns
    -------
    float
        1/√ρ in 1/m: turns a lever arm (m) into the third component of a wrench, and the third
        component of a motion (m) into an angle (rad).
    """
    return 1.0 / np.sqrt(film_ratio)


def check_film_ratio(film_ratio: npt.NDArray[np.float64]) -> None:
    """Refuse a film ratio that is not positive.

    Parameters
    ----------
    film_ratio
        (N,) values of ρ in m².

    Raises
    ------
    ValueError
        If a value is zero or negative: the film would not resist rotation.
    """
    wrong = np.flatnonzero(~(film_ratio > 0.0))
    if wrong.size:
        run = int(wrong[0])
        raise ValueError(
            f"film_ratio: run {run} has {film_ratio[run]:g} m²; "
            "e_θ/e_x must be positive; give the ratio of rotational to translational drag in m²"
        )
