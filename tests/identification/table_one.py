"""The paper's Table I and numbers around it, in the package's frame and units."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from meso_robust.identification.experiment import Bench, standard_tests
from meso_robust.identification.models import three_point, viscous
from meso_robust.identification.rollout import Setting
from meso_robust.recordings import Rectangle

F = npt.NDArray[np.float64]

PART = Rectangle(length=1616e-6, width=837e-6)
BENCH = Bench()
TESTS = standard_tests(PART, BENCH)
FILM = Setting(part=PART, bench=BENCH, model=viscous(PART.outline))
POINTS = Setting(part=PART, bench=BENCH, model=three_point(PART.outline))

VISCOUS = np.array([0.3769e-6, 0.33])
"""ρ of Section IX and the middle of the range of μ."""


def _own(table_um: list[tuple[float, float]]) -> F:
    """Points of the table in the part's frame: there the long axis is y, the part standing at 90°."""
    x, y = 1e-6 * np.array(table_um).T
    return np.column_stack([y, -x])


P1_POINTS = _own([(411.3, -563.3), (-409.1, 605.9), (-273.2, -102.1)])
P2_POINTS = _own([(-412.4, 794.0), (-217.8, 774.5), (278.8, -538.8)])
P1 = np.array([0.666, 0.757, *P1_POINTS.ravel()])
P2 = np.array([0.536, 0.013, *P2_POINTS.ravel()])
"""μ_t, μ_s and the points, as the model orders them."""

CASES = {"film": (FILM, VISCOUS), "p1*": (POINTS, P1), "p2*": (POINTS, P2)}
