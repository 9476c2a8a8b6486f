"""The interactive view of a plan: what its script is given.

The script (``view*.js``) runs the plan by the closed forms of the derivations
(``_generated/formulas.js``) for any values of what is uncertain, and evaluates the inequalities of
the certificate along that run. Nothing of it enters a verdict.
"""

from __future__ import annotations

import itertools
import math
import re
from fractions import Fraction
from pathlib import Path
from typing import Any

from markupsafe import Markup

from meso_robust import units
from meso_robust.bounds import Interval
from meso_robust.certificates.document import MarginDocument, StepDocument, name_of
from meso_robust.certificates.words import words
from meso_robust.corners import hull
from meso_robust.laboratory.draws import is_open
from meso_robust.motion.one_tip import CREEP_MOST
from meso_robust.pipeline import Planned
from meso_robust.planning.document import BoxDocument, names_of
from meso_robust.primitives.names import Inequality, every_obligation
from meso_robust.primitives.outline import Outline
from meso_robust.primitives.setup import Setup
from meso_robust.reporting.animation import embedded
from meso_robust.reporting.words import factor

Json = dict[str, Any]

FORMULAS = Path(__file__).parents[1] / "_generated" / "formulas.js"
ENGINE = ("view_geometry.js", "view_modes.js", "view_grip.js", "view_conditions.js", "view_run.js")
"""Files of this folder that make a run; they need the formulas and no page."""


def engine() -> Markup:
    """The script that makes a run: its generated formulas and what carries out a plan by them."""
    own = [(Path(__file__).parent / name).read_text(encoding="utf-8") for name in ENGINE]
    return Markup(_formulas("".join(own)) + "".join(own))


def _formulas(script: str) -> str:
    """Of the generated formulas those that a script calls: a page carries no others."""
    kept: list[str] = []
    function: list[str] = []
    for line in FORMULAS.read_text(encoding="utf-8").splitlines(keepends=True):
        if not line.startswith(" " * 4):  # of a module
            kept.append(line)
            continue
        function.append(line)
        if line == "    },\n":
            name = next(found[1] for line in function if (found := _HEAD.match(line)))
            kept += function if f".{name}(" in script else []
            function = []
    return "".join(kept)


_HEAD = re.compile(r" {4}(\w+)\(")
"""The first line of a generated function."""


def view(result: Planned) -> Markup:
    """The data of the view as JSON for a script element."""
    return embedded(data(result))


def held(setup: Setup) -> tuple[str, ...]:
    """What the promise covers and no slider moves, with what it is in the view's runs."""
    u = setup.uncertainty
    uneven = is_open(u.drag_anisotropy)
    every = (
        (is_open(u.probe_wander), "a probe that strays from its path (here it goes straight)"),
        (not setup.friction_common, "friction that changes during a move (here it stays)"),
        (setup.drag_centre_moves, "a centre of drag that moves (here it stays)"),
        (uneven, "drag that differs with a direction of the stage (here one of the part)"),
        (
            setup.corner_radius.hi > 0.0,
            "corners sharper than the largest radius (here they have it)",
        ),
    )
    return tuple(words for stated, words in every if stated)


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
        "rules": [
            {**rule.model_dump(mode="json"), **_shown_otherwise(step)}
            for rule, step in itertools.zip_longest(certificate.policy, certificate.steps)
        ],
        "start": [*map(units.to_um, setup.start.mid[:2]), setup.start.mid[2]],
        "ranges": _ranges(setup),
        "friction_common": setup.friction_common,
        "probes": list(dict.fromkeys(name for move in moves for name in move["probes"])),
        "moves": moves,
        "words": {name.key: words(name) for name in every_obligation()},
        "verdict": certificate.verdict,
        "margin": _margin(certificate.margin),
    }


def _shown_otherwise(step: StepDocument | None) -> Json:
    """What of a move is not proved as of a contact that sticks.

    The obligations that are proved whichever way a contact slips, and of each tip that may slip while
    it turns the part how far, by its ``creep`` in um.
    """
    listed = () if step is None else step.obligations
    slips = [one for one in listed if one.inequality == Inequality.CREEPS_LESS]
    any_way = [name_of(one).key for one in listed if one.inequality == Inequality.TURNS_ANY_WAY]
    creeps = {
        one.about["tip"]: units.to_um(float.fromhex(one.over[CREEP_MOST][1])) for one in slips
    }
    return {"any_way": any_way, "creep": creeps}


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
        "hull": list(_hull(setup.outline)),
        "corner_radius": _um(setup.corner_radius),
        "spacing": _um(setup.stated_spacing),
        "walls": [
            [units.to_um(end) for end in (block.x.lo, block.x.hi, block.y.lo, block.y.hi)]
            for block in setup.blocks
        ],
    }


def _hull(outline: Outline) -> tuple[int, ...]:
    """Which corners are those of the convex hull, counter-clockwise."""
    corners = [tuple(Fraction(end.mid) for end in corner) for corner in outline.corners]
    return hull([(x, y) for x, y in corners])


def _um(length: Interval) -> float:
    """The middle in um, to 1e-9 um: a page is short without the digits that units leave."""
    return round(units.to_um(length.mid), 9)


def _ranges(setup: Setup) -> dict[str, list[float]]:
    """Ends of every uncertainty in um, deg, um^2 or none."""
    u = setup.uncertainty

    def ends(range_: Interval, unit: float) -> list[float]:
        return [range_.lo / unit, range_.hi / unit]

    scales = {
        **dict.fromkeys(
            ("sensed_orientation", "misalignment", "squareness", "travel_direction"), units.DEG
        ),
        **dict.fromkeys(("friction", "travel_scale", "drag_anisotropy"), 1.0),
        "film_ratio": units.UM**2,
    }
    return {name: ends(range_, scales.get(name, units.UM)) for name, range_ in u.stated.items()}


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
