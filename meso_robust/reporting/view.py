"""The interactive view of a plan: what its script is given.

The script (``view*.js``) runs the plan by the closed forms of the derivations
(``_generated/formulas.js``) for any values of what is uncertain, and evaluates the inequalities of
the certificate along that run. Nothing of it enters a verdict.
"""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

from markupsafe import Markup

from meso_robust import units
from meso_robust.bounds import HALF_PI, Interval
from meso_robust.certificates.document import MarginDocument, name_of
from meso_robust.certificates.words import words
from meso_robust.pipeline import Planned
from meso_robust.planning.document import BoxDocument, names_of
from meso_robust.primitives.names import every_obligation
from meso_robust.primitives.outline import Edge, Line, Outline, Polygon
from meso_robust.primitives.setup import Setup
from meso_robust.reporting.animation import embedded
from meso_robust.reporting.words import factor

Json = dict[str, Any]

FORMULAS = Path(__file__).parents[1] / "_generated" / "formulas.js"
ENGINE = ("view_geometry.js", "view_modes.js", "view_grip.js", "view_conditions.js", "view_run.js")
"""Files of this folder that make a run; they need the formulas and no page."""


def engine() -> Markup:
    """The script that makes a run: the generated formulas and what carries out a plan by them."""
    files = [FORMULAS, *(Path(__file__).parent / name for name in ENGINE)]
    return Markup("".join(file.read_text(encoding="utf-8") for file in files))


def view(result: Planned) -> Markup:
    """The data of the view as JSON for a script element."""
    return embedded(data(result))


def data(result: Planned) -> Json:
    """What the view shows: lengths in um, orientations of poses and boxes for reading in deg.

    What a run is made from (``task``, ``rules``, ``start``) is in um and rad.
    """
    setup, goal, certificate = result.setup, result.task.goal, result.certificate
    moves, told = _moves(result), task(setup)
    return {
        "arm": 0.55 * max(y for _, y in told["corners"]),
        "goal": {
            "x": goal.x_um,
            "y": goal.y_um,
            "theta": goal.theta_deg,
            "dx": goal.position_tolerance_um,
            "dy": goal.position_tolerance_um,
            "dtheta": goal.orientation_tolerance_deg,
        },
        "task": told,
        "rules": [rule.model_dump(mode="json") for rule in certificate.policy],
        "start": [*map(units.to_um, setup.start.mid[:2]), setup.start.mid[2]],
        "ranges": _ranges(setup),
        "probes": list(dict.fromkeys(name for move in moves for name in move["probes"])),
        "moves": moves,
        "words": {name.key: words(name) for name in every_obligation()},
        "verdict": certificate.verdict,
        "margin": _margin(certificate.margin),
    }


def _margin(margin: MarginDocument) -> Json:
    """Factors, and how they are worded."""
    each = margin.each_alone
    return {
        "all": margin.factor,
        "alone": each,
        "told": factor(margin.factor),
        "toldAlone": {name: factor(value) for name, value in each.items()},
    }


def task(setup: Setup) -> Json:
    """What a run is made from besides the rules and a draw, um and rad."""
    return {
        "corners": [[_um(end) for end in corner] for corner in setup.outline.corners],
        "lines": [_line(line) for line in _hull(setup.outline)],
        "spacing": units.to_um(setup.spacing.mid),
        "walls": [
            [units.to_um(end) for end in (block.x.lo, block.x.hi, block.y.lo, block.y.hi)]
            for block in setup.blocks
        ],
    }


def _hull(outline: Outline) -> tuple[Line, ...]:
    """The sides of the convex hull; those that are edges of the part as such."""
    if not isinstance(outline, Polygon):
        return tuple(outline.edge(k * HALF_PI.mid) for k in (1, 2, 3, 4))
    edges = {edge.turn: edge for edge in outline.edges}
    return tuple(edges.get(line.turn, line) for line in outline.lines)


def _um(length: Interval) -> float:
    """The middle in um, to 1e-9 um: a page is short without the digits that units leave."""
    return round(units.to_um(length.mid), 9)


def _line(line: Line) -> dict[str, float | None]:
    """Turn in rad; depth and the ends of an edge in um, no ends where no edge is."""
    edge = line if isinstance(line, Edge) else None
    return {
        "turn": line.turn.mid,
        "depth": _um(line.depth),
        "first": None if edge is None else _um(edge.first),
        "last": None if edge is None else _um(edge.last),
    }


def _ranges(setup: Setup) -> dict[str, list[float]]:
    """Ends of every uncertainty in um, deg, um^2 or none."""
    u = setup.uncertainty

    def ends(range_: Interval, unit: float) -> list[float]:
        return [range_.lo / unit, range_.hi / unit]

    return {
        "friction": ends(u.friction, 1.0),
        "film_ratio": ends(u.film_ratio, units.UM**2),
        "misalignment": ends(u.misalignment, units.DEG),
        "sensed_position": ends(u.sensed_position, units.UM),
        "sensed_orientation": ends(u.sensed_orientation, units.DEG),
        "probe_position": ends(u.probe_position, units.UM),
    }


def _moves(result: Planned) -> list[Json]:
    """Names, probes and duration of every move, and what the certificate says of it."""
    steps = result.certificate.steps
    found = []
    for k, (move, rule) in enumerate(
        zip(result.plan.moves, result.certificate.policy, strict=True)
    ):
        step = steps[k] if k < len(steps) else None
        found.append(
            {
                "name": f"{move.primitive.replace('_', ' ')} · {rule.action}",
                "probes": list(names_of(result.found.rules[k])),
                "passive": [probe.passive for probe in move.probes],
                "seconds": max(round(math.hypot(*move.travel_um) / move.speed_um_s, 3), 0.001),
                "box": None if step is None else _box(step.post),
                "proved": bool(step is not None and step.verdict == "PROVED"),
                "obligations": []
                if step is None
                else [
                    [
                        name_of(one).key,
                        None if one.lower_bound is None else float.fromhex(one.lower_bound),
                    ]
                    for one in step.obligations
                ],
            }
        )
    return found


def _box(box: BoxDocument | None) -> list[tuple[float, float]] | None:
    return None if box is None else [box.x_um, box.y_um, box.theta_deg]
