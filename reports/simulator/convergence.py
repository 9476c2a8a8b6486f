"""Convergence of the time stepper to the event-driven engine, mode by mode.

``python -m reports.simulator.convergence --out reports/simulator/convergence.md``
"""

from __future__ import annotations

import argparse
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Literal

import numpy as np
import numpy.typing as npt

from meso_robust.simulator import Film, Outcome, Point, Push, Round, exact, simulate
from meso_robust.simulator.fixture import Fixture
from meso_robust.simulator.tips import Tip
from tests.simulator.problems import HALF_SHORT, RHO, UM, one_point, rectangle, two_sided

F = npt.NDArray[np.float64]

STEPS_UM = (8.0, 4.0, 2.0, 1.0, 0.5, 0.25)
SAMPLES = 64
FLOOR = 1e-11  # m: errors below this are rounding
L_SHAPE = np.array([[-300, -300], [600, -300], [600, 0], [0, 0], [0, 600], [-300, 600]]) * UM


def _push(
    tips: list[tuple[float, float]],
    travel: list[tuple[float, float]],
    *,
    vertices: F | None = None,
    angle: float = np.pi / 2,
    mu: float = 0.33,
    shapes: tuple[Tip, ...] = (),
    fixture: Fixture | None = None,
    drag: F | None = None,
) -> Push:
    """One run with tips and travel in µm, world frame, the part's reference point at the origin."""
    return Push.straight(
        vertices=rectangle() if vertices is None else vertices,
        poses=np.array([[0.0, 0.0, angle]]),
        tips=np.array([tips]) * UM,
        travel=np.array([travel]) * UM,
        friction=np.array([mu]),
        support=Film.ratio(RHO) if drag is None else Film(drag),
        shapes=shapes,
        fixture=Fixture() if fixture is None else fixture,
        step=1 * UM,
    )


def cases() -> Mapping[str, Push]:
    """A push for every kind of contact mode and of mode change."""
    edge = HALF_SHORT / UM
    floor = Fixture(
        (np.array([[-4000, -900], [4000, -900], [4000, -808], [-4000, -808]]) * UM,), 0.2
    )
    turned = rectangle() @ np.array(
        [[np.cos(t := np.radians(100)), np.sin(t)], [-np.sin(t), np.cos(t)]]
    )
    low = Fixture((floor.outlines[0] + [0.0, 808 * UM + turned[:, 1].min()],), 0.2)
    skew = np.array([[1.0, 0.1, 8e-5], [0.1, 1.2, -5e-5], [8e-5, -5e-5, 1.1 * RHO]])
    return {
        "one point sticks": one_point(200 * UM, 300 * UM, UM),
        "one point slips": one_point(700 * UM, 400 * UM, UM, mu=0.1),
        "one point sticks, then slips": one_point(350 * UM, 900 * UM, UM),
        "one point slips off the end of an edge": one_point(700 * UM, 900 * UM, UM, mu=0.1),
        "approach, then one point sticks": _push([(edge + 50.3, 150)], [(-400, 0)]),
        "two points on one edge stick": _push([(edge, 250), (edge, -400)], [(-500, 0), (-500, 0)]),
        "one point, then two": _push([(edge, 300), (edge + 60, -300)], [(-500, 0), (-500, 0)]),
        "two sides, both slip": two_sided([930 * UM], 1000 * UM, UM),
        "one round tip sticks": _push(
            [(edge + 12.5, 200)], [(-300, 0)], shapes=(Round(12.5 * UM),)
        ),
        "a round tip at a corner": _push(
            [(edge + 100, 928)], [(-400, 0)], shapes=(Round(150 * UM),), mu=0.2
        ),
        "full drag matrix, sticks": _push([(edge, 200)], [(-300, 60)], drag=skew),
        "full drag matrix, slips": _push([(edge, 500)], [(-300, 200)], drag=skew, mu=0.1),
        "corner of the part slides on a wall": _push(
            [(600, 100)], [(-500, 0)], angle=np.radians(100), mu=0.3, fixture=low
        ),
        "part translates along a wall": _push([(edge, 300)], [(-400, 0)], mu=0.8, fixture=floor),
        "edge of the part lies on a wall": _push(
            [(edge, -700)], [(-400, 0)], mu=0.6, fixture=floor
        ),
        "re-entrant corner, two edges": _push(
            [(5, 300)], [(-10, -500)], vertices=L_SHAPE, angle=0.0, shapes=(Point(),)
        ),
    }


def errors(push: Push, frame: Literal["middle", "start"]) -> F:
    """(len(STEPS_UM), 2) largest error of position (m) and angle (rad) over the path, by step."""
    truth = exact(push, samples=SAMPLES)
    if truth.outcomes[0] != Outcome.COMPLETED:
        raise RuntimeError(
            f"the event-driven engine ends as {Outcome(int(truth.outcomes[0])).name}"
        )
    rows = []
    for step in STEPS_UM:
        run = simulate(replace(push, step=step * UM, frame=frame), record=SAMPLES)
        if run.outcomes[0] != Outcome.COMPLETED:
            raise RuntimeError(f"the stepper ends as {Outcome(int(run.outcomes[0])).name}")
        miss = run.path[0] - truth.path[0]
        rows.append([np.hypot(miss[:, 0], miss[:, 1]).max(), np.abs(miss[:, 2]).max()])
    return np.array(rows)


def order(column: F) -> float:
    """Slope of log error over log step; NaN where the errors are rounding."""
    if column.max() < FLOOR:
        return float("nan")
    kept = column > FLOOR
    if kept.sum() < 3:
        return float("nan")
    return float(np.polyfit(np.log(np.array(STEPS_UM)[kept]), np.log(column[kept]), 1)[0])


def table() -> str:
    """Markdown of the errors and orders."""
    head = "| push | frame | " + " | ".join(f"h = {h:g} µm" for h in STEPS_UM) + " | order |\n"
    lines = [head, "|" + "---|" * (len(STEPS_UM) + 3) + "\n"]
    for name, push in cases().items():
        for frame in ("start", "middle"):
            found = errors(push, frame)
            cells = " | ".join(f"{p / UM:.2g} µm, {np.degrees(a):.1g}°" for p, a in found)
            slope = order(found[:, 0])
            shown = "exact" if np.isnan(slope) else f"{slope:.2f}"
            lines.append(f"| {name} | {frame} | {cells} | {shown} |\n")
    return "".join(lines)


TEXT = """# Convergence of the time stepper to the event-driven engine

Largest error of the path (position of the reference point, angle) against the event-driven engine, which
solves sticking and translation in closed form, integrates sliding to about 1e-12 of the travel and finds
mode changes as roots. *Frame* is where in a step displacements are turned between world and body: at its
start as in eq. (2) of the paper, or about its middle (the default). The *order* is the slope of log error
over log step. A contact that slides, and an instant at which the mode changes, are placed to the first
order of the step whatever the frame.

Command: `python -m reports.simulator.convergence --out reports/simulator/convergence.md`

"""


def main() -> None:
    """Write the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=Path, required=True)
    arguments = parser.parse_args()
    arguments.out.parent.mkdir(parents=True, exist_ok=True)
    arguments.out.write_text(TEXT + table(), encoding="utf-8")


if __name__ == "__main__":
    main()
