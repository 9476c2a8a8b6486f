"""The answer of a part on a film to a force at a contact.

Generated from derivations/contact_response.py by `meso-robust derive`; do not edit.
Every function takes `ops`, the arithmetic to use (casadi, numpy, ...), and returns a tuple.
"""

from __future__ import annotations

from typing import Any


def velocity(ops: Any, x: Any, y: Any, x_f: Any, y_f: Any, f_x: Any, f_y: Any, rho: Any, stretch: Any, shear: Any) -> tuple[Any, ...]:
    """Return velocity of the part's point (x, y) where a force (f_x, f_y), over e_x, acts at (x_f, y_f); both from the centre of drag, in axes of the part."""
    x0 = (-f_x*y_f + f_y*x_f)/rho
    x1 = 1/(-shear**2 - stretch**2 + 1)
    return (
        -x0*y + x1*(f_x*(1 - stretch) - f_y*shear),
        x*x0 + x1*(-f_x*shear + f_y*(stretch + 1)),
    )


def turning(ops: Any, x_f: Any, y_f: Any, f_x: Any, f_y: Any, rho: Any) -> tuple[Any, ...]:
    """Return rate of the turn under that force."""
    return (
        (-f_x*y_f + f_y*x_f)/rho,
    )
