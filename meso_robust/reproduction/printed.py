"""What the paper prints about part, supports, fixture and probes; SI."""

from __future__ import annotations

import numpy as np

from meso_robust.recordings import Rectangle
from meso_robust.simulator import Film, ThreePoints
from meso_robust.types import Floats
from meso_robust.units import DEG, UM

SHOWN = np.array([UM, UM, DEG])
"""SI over the units of the paper's tables: um, um, deg."""
PART = Rectangle(length=1616e-6, width=837e-6)
"""Section IX-A."""
SLOT_WIDTH = 974e-6
"""m; Section VII: 137 um wider than the part."""
SPEED = 75e-6
"""m/s; the middle one of the three of Section V."""
TIP_RADIUS = 12.5e-6
"""m; half the 25 um side of the probe, Section V."""
FILM_RATIO = 0.3769e-6
"""m²; e_θ/e_x of Section X-A, read as 0.3769 mm² (printed in units that do not go together)."""
FRICTION = (0.30, 0.36)
"""Section X-A, between probe and part on the film."""


def _own(table_um: list[tuple[float, float]]) -> Floats:
    """Points of Table I in the part's frame: there the long axis is y, the part standing at 90 deg."""
    x, y = 1e-6 * np.array(table_um).T
    return np.column_stack([y, -x])


POINTS = {
    "p1*": _own([(411.3, -563.3), (-409.1, 605.9), (-273.2, -102.1)]),
    "p2*": _own([(-412.4, 794.0), (-217.8, 774.5), (278.8, -538.8)]),
}
"""(3, 2) support points of Table I, m, part frame."""
TIP_FRICTION = {"p1*": 0.666, "p2*": 0.536}
"""μ_t of Table I."""
SURFACE_FRICTION = {"p1*": 0.757, "p2*": 0.013}
"""μ_s of Table I."""


def three_points(name: str) -> ThreePoints:
    """The support of a column of Table I."""
    return ThreePoints(points=POINTS[name], friction=SURFACE_FRICTION[name])


def film(runs: int = 1) -> Film:
    """The film of Section X-A."""
    return Film.ratio(np.full(runs, FILM_RATIO))
