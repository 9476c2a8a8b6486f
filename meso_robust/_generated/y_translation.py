"""Net displacement of the Y-translation (paper, Section IX-E).

Generated from derivations/y_translation.py by `meso-robust derive`; do not edit.
Every function takes `ops`, the arithmetic to use (casadi, numpy, ...), and returns a tuple.
"""

from __future__ import annotations

from typing import Any


def gain(ops: Any, theta_0: Any, theta_1: Any, theta_2: Any, d1: Any, d2: Any, d2_back: Any) -> tuple[Any, ...]:
    """Return m: rise of the centre over tilt and straightening."""
    x0 = ops.sin(theta_1)
    return (
        -d1*(ops.cos(theta_0) - ops.cos(theta_2)) + d2*(-x0 + ops.sin(theta_0)) + d2_back*(x0 - ops.sin(theta_2)),
    )
