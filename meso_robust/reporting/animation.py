"""The runs of a simulation as one HTML page that plays them and needs nothing else."""

from __future__ import annotations

import json
import math
from typing import Any

import numpy as np
from markupsafe import Markup

from meso_robust import units
from meso_robust.laboratory.endings import Ending, ending, words
from meso_robust.laboratory.making import outline
from meso_robust.laboratory.replay import miss
from meso_robust.laboratory.running import MoveRun, PlanRun
from meso_robust.laboratory.simulation import Simulated, in_goal, order
from meso_robust.laboratory.simulation_document import SimulationDocument
from meso_robust.laboratory.trajectories import probe_names
from meso_robust.provenance import commit
from meso_robust.reporting import pages
from meso_robust.types import Floats
from meso_robust.wording import counted

Json = dict[str, Any]

RUNS = 20  # shown at most
INSTANTS = 45_000  # of all shown runs together: keeps the page below 1.5 MB
WORST_SHOWN = 6  # samples that are shown because they end worst; the others are chosen evenly
LABELS = {"nominal": "nominal", "worst": "worst found", "witness": "witness of the certificate"}


def animation(found: Simulated, answer: SimulationDocument) -> str:
    """A self-contained HTML page that plays the runs.

    Parameters
    ----------
    found, answer
        What ``simulate`` found out, and its document.

    Returns
    -------
    str
        The page; it asks for nothing from outside.
    """
    moves = len(answer.moves)
    how = "feedback policy" if answer.kind == "feedback" else "open-loop moves"
    return pages.page(
        pages.Report(
            banner=pages.Banner(
                verb="simulate",
                subject=answer.task,
                about=f"{how}, {counted(moves, 'move')}",
                word="ALL IN THE GOAL" if answer.all_in_goal else "NOT ALL IN THE GOAL",
                colour="PROVED" if answer.all_in_goal else "REFUTED",
                meaning=_meaning(answer),
            ),
            lead=pages.prose("animation.html.j2", data=embedded(data(found))).player(),
            sections=(),
            made=pages.made(
                f"meso-robust simulate TASK.toml PLAN.json --seed {answer.seed}",
                ("task hash (SHA-256)", pages.code(answer.task_hash)),
                ("plan hash (SHA-256)", pages.code(answer.plan_hash)),
                after=f" with the files of these hashes; step {answer.step_um:g} µm",
                using={**answer.made_with, "commit": commit(), "seed": str(answer.seed)},
            ),
            styles=("animation.css", "player.css"),
            scripted=True,
        )
    )


def _meaning(answer: SimulationDocument) -> str:
    """How the runs ended, in a sentence; what simulation shows is no proof."""
    said = f"{answer.sampled.in_goal} of {answer.sampled.runs} random runs in the goal"
    if answer.adversary is not None:
        where = "in the goal" if answer.adversary.worst.run.in_goal else "not in the goal"
        said += f"; worst run of {answer.adversary.evaluations} searched: {where}"
    return f"{said}. Evidence, not proof."


def embedded(values: Json) -> Markup:
    """JSON that can stand in a script element: nothing in it can end the element."""
    text = json.dumps(values, separators=(",", ":"), allow_nan=False, ensure_ascii=True)
    for sign in "<>&":
        text = text.replace(sign, f"\\u{ord(sign):04x}")
    return Markup(text)  # the signs that HTML reads are gone


def data(found: Simulated) -> Json:
    """What the page plays: lengths in um to a hundredth, angles in deg to a thousandth."""
    runs = [_run(found, case.runs, 0, LABELS[name]) for name, case in found.cases]
    runs += [_run(found, found.sampled, row, f"sample {row}") for row in _shown(found, len(runs))]
    part = outline(found.player.setup) / units.UM
    goal = found.task.goal
    return {
        "part": [_rounded(corner, 2) for corner in part],
        "arm": round(0.55 * float(part[:, 1].max()), 2),
        "goal": {
            "x": goal.x_um,
            "y": goal.y_um,
            "theta": goal.theta_deg,
            "dx": goal.position_tolerance_um,
            "dy": goal.position_tolerance_um,
        },
        "probes": probe_names(found.player),
        "moves": _moves(found),
        "runs": runs,
        "extent": _extent(runs, float(np.hypot(*part.T).max()), (goal.x_um, goal.y_um)),
    }


def _shown(found: Simulated, taken: int) -> list[int]:
    """Samples that are shown: the worst ones, then others evenly."""
    count = len(found.rows)
    each = sum(move.path.shape[1] for move in found.nominal.runs.moves)
    room = max(min(RUNS, INSTANTS // each) - taken, 0)
    worst = [int(row) for row in order(found.sampled, found.player.setup)[:WORST_SHOWN]]
    even = [int(row) for row in np.linspace(0, count - 1, min(room, count)).astype(int)]
    return list(dict.fromkeys([*worst, *even]))[:room]


def _moves(found: Simulated) -> list[Json]:
    """What all runs share: names, and how long each move takes at the plan's speed."""
    moves = []
    for k, (stated, probes) in enumerate(zip(found.plan.moves, found.player.probes, strict=True)):
        travel = found.nominal.runs.moves[k].travel[0]
        moves.append(
            {
                "name": stated.primitive.replace("_", " "),
                "probes": probes,
                "passive": [not np.any(way) for way in travel],
                "seconds": max(round(math.hypot(*stated.travel_um) / stated.speed_um_s, 3), 0.001),
            }
        )
    return moves


def _run(found: Simulated, runs: PlanRun, row: int, name: str) -> Json:
    end = ending(found.player, runs, row)
    away = float(miss(runs, found.player.setup)[row])
    good = bool(in_goal(runs, found.player.setup)[row])
    how = words(end.outcome, end.touching)
    if end.move is None:
        how = "ends in the goal" if good else "misses the goal"
    last = len(runs.moves) if end.move is None else end.move + 1
    return {
        "name": name,
        "words": how,
        "good": good,
        "miss": None if math.isnan(away) else round(away, 3),
        "moves": [_move(runs.moves[k], row, k, end) for k in range(last)],
    }


def _move(one: MoveRun, row: int, k: int, end: Ending) -> Json:
    path = one.path[row] / np.array([units.UM, units.UM, units.DEG])
    return {
        "x": _rounded(path[:, 0], 2),
        "y": _rounded(path[:, 1], 2),
        "t": _rounded(path[:, 2], 3),
        "tips": [_rounded(tip / units.UM, 2) for tip in one.tips[row]],
        "travel": [_rounded(way / units.UM, 2) for way in one.travel[row]],
        "radii": _rounded(one.radii[row] / units.UM, 2),
        "stop": round(end.share, 4) if k == end.move else 1.0,
        "modes": ["".join(map(str, line)) for line in one.modes[row].T],
    }


def _rounded(values: Floats, digits: int) -> list[float]:
    return [round(float(value), digits) + 0.0 for value in values]


def _extent(runs: list[Json], reach: float, goal: tuple[float, float]) -> list[float]:
    """Left, low, right, high of what is seen: the part wherever it lies, the goal, the tips."""
    xs, ys = [goal[0] - reach, goal[0] + reach], [goal[1] - reach, goal[1] + reach]
    for move in (move for run in runs for move in run["moves"]):
        xs += [min(move["x"]) - reach, max(move["x"]) + reach]
        ys += [min(move["y"]) - reach, max(move["y"]) + reach]
        xs += [tip[0] for tip in move["tips"]]
        ys += [tip[1] for tip in move["tips"]]
    return [round(value, 1) for value in (min(xs), min(ys), max(xs), max(ys))]
