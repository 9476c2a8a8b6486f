"""Running the pages' JavaScript in V8, without a browser."""

from __future__ import annotations

import json
from dataclasses import replace
from typing import Any

import numpy as np
from py_mini_racer import MiniRacer

from meso_robust import units
from meso_robust.laboratory.draws import Draws
from meso_robust.reporting.slim import slim
from meso_robust.reporting.view import engine
from meso_robust.types import Floats

Json = dict[str, Any]


class Script:
    """A script that is loaded once and called."""

    def __init__(self, source: str) -> None:
        self._racer = MiniRacer()
        self._racer.eval(source)

    def call(self, function: str, *values: Any) -> Any:
        """What a function answers; values and answer go through JSON (NaN becomes None)."""
        given = ", ".join(json.dumps(value) for value in values)
        answer = self._racer.eval(f"JSON.stringify({function}({given}))")
        assert isinstance(answer, str)
        return json.loads(answer)


TOLD = """
const told = (task, rules, draw) => {
  const run = runPlan(task, rules, draw);
  return { ...run, moves: run.moves.map((move) =>
    ({ ...move, conditions: Object.fromEntries(move.conditions) })) };
};
"""


def runs_script(more: str = "") -> Script:
    """What the page runs, with ``told(task, rules, draw)``: its conditions as an object."""
    return Script(slim(str(engine()) + TOLD + more))


def steady(draws: Draws) -> Draws:
    """The same draws with the friction of the first moment for good: the page's does not change."""
    if draws.tip_friction is None:
        return draws
    first = draws.tip_friction[:, :1, :1]
    return replace(draws, tip_friction=np.broadcast_to(first, draws.tip_friction.shape).copy())


def draw_of(draws: Draws, row: int, spacing: float = 580e-6, edges: int = 4) -> Json:
    """One row of draws as the script takes it, um and rad; friction that does not change on the way."""
    scale = np.array([units.UM, units.UM, 1.0])
    exact = np.zeros(draws.sensing.shape[1])

    def given(values: Floats | None, otherwise: Floats | float) -> Floats:
        return np.asarray(otherwise if values is None else values[row], dtype=np.float64)

    made = given(draws.edges, np.zeros((edges, 2)))
    friction = given(draws.tip_friction, np.full((1, 1, 3), draws.friction[row]))
    centre, lay = given(draws.drag_centre, np.zeros(2)), given(draws.lay, np.zeros(3))
    assert np.ptp(friction, axis=(0, 1)).max() == 0.0
    assert lay[2] == 0.0
    return {
        "start": (draws.start[row] / scale).tolist(),
        "friction": friction[0, 0].tolist(),
        "film_ratio": float(draws.film_ratio[row]) / units.UM**2,
        "misalignment": float(draws.misalignment[row]),
        "sensing": (draws.sensing[row] / scale).tolist(),
        "dual": (draws.dual[row] / units.UM).tolist(),
        "single": (draws.single[row] / units.UM).tolist(),
        "spacing": float((spacing + given(draws.spacing, 0.0)) / units.UM),
        "radius": (given(draws.radii, np.zeros(3)) / units.UM).tolist(),
        "size": (made[:, 0] / units.UM).tolist(),
        "squareness": made[:, 1].tolist(),
        "direction": given(draws.direction, exact).tolist(),
        "scale": given(draws.scale, exact).tolist(),
        "centre": float(np.hypot(*centre)) / units.UM,
        "bearing": float(np.arctan2(centre[1], centre[0])),
        "anisotropy": 2.0 * float(np.hypot(lay[0], lay[1])),
        "axis": 0.5 * float(np.arctan2(lay[1], lay[0])),
    }
