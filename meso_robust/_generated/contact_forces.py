"""Bounds of contact forces.

Generated from derivations/contact_forces.py by `meso-robust derive`; do not edit.
Every function takes `ops`, the arithmetic to use (casadi, numpy, ...), and returns a tuple.
"""

from __future__ import annotations

from typing import Any


def carrying_force(ops: Any, stretch: Any, shear: Any) -> tuple[Any, ...]:
    """Return most that one sticking tip, or two on one edge together, press on a part, over e_x and the speed of the probe."""
    return (
        ops.sqrt(shear**2 + stretch**2) + 1,
    )
