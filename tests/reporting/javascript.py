"""Running the pages' JavaScript in V8, without a browser."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
from py_mini_racer import MiniRacer

from meso_robust import units
from meso_robust.laboratory.draws import Draws
from meso_robust.reporting.slim import slim
from meso_robust.reporting.view import engine

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


def draw_of(draws: Draws, row: int, spacing: float = 580e-6, edges: int = 4) -> Json:
    """One row of draws as the script takes it, um and rad; what it does not have is exact."""
    scale = np.array([units.UM, units.UM, 1.0])
    moves = draws.sensing.shape[1]
    return {
        "start": (draws.start[row] / scale).tolist(),
        "friction": [float(draws.friction[row])] * 3,
        "film_ratio": float(draws.film_ratio[row]) / units.UM**2,
        "misalignment": float(draws.misalignment[row]),
        "sensing": (draws.sensing[row] / scale).tolist(),
        "dual": (draws.dual[row] / units.UM).tolist(),
        "single": (draws.single[row] / units.UM).tolist(),
        "spacing": spacing / units.UM,
        "radius": [0.0] * 3,
        "size": [0.0] * edges,
        "squareness": [0.0] * edges,
        "direction": [0.0] * moves,
        "scale": [0.0] * moves,
        **dict.fromkeys(("centre", "bearing", "anisotropy", "axis"), 0.0),
    }
