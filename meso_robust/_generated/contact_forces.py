"""Bounds of contact forces.

Generated from derivations/contact_forces.py by `meso-robust derive`; do not edit.
Every function takes `ops`, the arithmetic to use (casadi, numpy, ...), and returns a tuple.
"""

from __future__ import annotations

from typing import Any


def carrying_force(ops: Any, stretch: Any, shear: Any, mu: Any, bend: Any) -> tuple[Any, ...]:
    """Return most that one of two tips on one edge presses on a part while the probe's path has the slope bend against its straight line, over e_x and the speed along that line; with mu = 0: one tip alone, sticking."""
    return (
        ops.sqrt(bend**2 + 1)*ops.sqrt(mu**2 + 1)*(ops.sqrt(shear**2 + stretch**2) + 1),
    )
