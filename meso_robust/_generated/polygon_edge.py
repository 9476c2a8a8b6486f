"""Edges of a convex polygon: direction, distance from the centre of drag, offsets.

Generated from derivations/polygon_edge.py by `meso-robust derive`; do not edit.
Every function takes `ops`, the arithmetic to use (casadi, numpy, ...), and returns a tuple.
"""

from __future__ import annotations

from typing import Any


def edge_direction(ops: Any, x0: Any, y0: Any, x1: Any, y1: Any) -> tuple[Any, ...]:
    """Return cos and sin of the direction of the edge from (x0, y0) to (x1, y1) in the part frame; vertices counter-clockwise about the centre of drag."""
    x2 = -x0 + x1
    x3 = -y0 + y1
    x4 = 1/ops.sqrt(x2**2 + x3**2)
    return (
        x2*x4,
        x3*x4,
    )


def edge_offsets(ops: Any, x0: Any, y0: Any, x1: Any, y1: Any) -> tuple[Any, ...]:
    """Return d1 of the edge from (x0, y0) to (x1, y1), then d2 at its first and at its second vertex, m; d1 is positive where the centre of drag is inside of the edge."""
    x2 = 1/ops.sqrt((-x0 + x1)**2 + (-y0 + y1)**2)
    x3 = x0*x1
    x4 = y0*y1
    return (
        x2*(x0*y1 - x1*y0),
        x2*(-x0**2 + x3 + x4 - y0**2),
        x2*(x1**2 - x3 - x4 + y1**2),
    )


def end_offset(ops: Any, d1: Any, d1_next: Any, exterior: Any, rounding: Any) -> tuple[Any, ...]:
    """Return d2, m, where the straight part of an edge at d1 ends that meets the line at d1_next, turned from it by the exterior angle, in a corner rounded with this radius."""
    x0 = 1/ops.sin(exterior)
    x1 = ops.cos(exterior)
    return (
        -rounding*x0*(1 - x1) + x0*(-d1*x1 + d1_next),
    )
