"""Certificates of schema 1, which told everything in sentences: read as if they named it.

A sentence that is not exactly one of those below names nothing, so that it is rejected like any
other name that the checker does not know. What schema 1 left unsaid (the tips' spacing, scale,
rigidity, the sign of the misalignment) it took for granted as well.
"""

from __future__ import annotations

import itertools
import json
import math
from collections.abc import Mapping
from typing import Annotated, Any, Literal

from flint import ctx
from pydantic import Field, FiniteFloat

from meso_robust.checker.document import (
    BoxDocument,
    Certificate,
    ExactBox,
    HexPair,
    Model,
    Over,
    RuleDocument,
    SimulationDocument,
    Word,
)
from meso_robust.checker.ids import Claim, Must, Property, premises
from meso_robust.checker.inputs import given, uncertainties
from meso_robust.checker.ranges import Side
from meso_robust.checker.statement import STATEMENTS
from meso_robust.task import Part, Task

SCHEMA = "meso-robust/certificate/1"
BITS = 80
Name = tuple[str, dict[str, str]]

_TIPS = ("upper", "lower", "pushing", "active", "passive")
_TURNS = ("counter-clockwise", "clockwise")
_WHEN = {
    "before the touch": "before_touch",
    "while it turns": "while_turning",
    "early in the turn": "early_in_turn",
    "late in the turn": "late_in_turn",
    "on withdrawal": "on_withdrawal",
}
_WITHDRAWS = {"pushing tip comes": "pushing", "pair comes": "pair", "two tips come": "both"}
_OF_A_TIP = {
    "the {} tip is free of contact at the start": Must.TIP_FREE_AT_START,
    "the {} tip touches the edge": Must.TIP_ON_EDGE,
    "the {} tip pushes": Must.TIP_PUSHES,
    "the {} tip sticks": Must.TIP_STICKS,
    "no slipping motion is possible beside the sticking one ({} tip)": Must.NO_SLIPPING,
    "the {} tip stays clear of the part on its way": Must.TIP_CLEAR_OF_PART,
}
_ALONE = {
    "the tip reaches the part": Must.TIP_REACHES_PART,
    "the pair of tips sticks": Must.PAIR_STICKS,
    "both tips push": Must.PAIR_PUSHES,
    "the second tip touches before the probe stops": Must.SECOND_TIP_TOUCHES,
    "the grasp cannot close: the motion exists (no jam)": Must.NO_JAM,
    "the active tip pushes until the part rests on both": Must.PUSHES_UNTIL_REST,
    "its motion, sticking or slipping, is unique until then": Must.UNIQUE_UNTIL_REST,
    "the part rests on the passive tip before the push ends": Must.RESTS_BEFORE_END,
    "both tips stay in contact: the active one alone would press the part on the other": Must.BOTH_TIPS_TOUCH,
    "both tips stay on their edges": Must.BOTH_TIPS_ON_EDGES,
    "the part stays clear of the slot's walls": Must.PART_CLEAR_OF_WALLS,
    "the tips stay clear of the slot's walls": Must.TIPS_CLEAR_OF_WALLS,
}
OBLIGATIONS: Mapping[str, Name] = {
    **{text: (id_, {}) for text, id_ in _ALONE.items()},
    **{
        text.format(tip): (id_, {"tip": tip})
        for (text, id_), tip in itertools.product(_OF_A_TIP.items(), _TIPS)
    },
    **{
        f"the {tip} tip turns the part {turn}": (
            Must.TIP_TURNS_PART,
            {"tip": tip, "turn": turn.replace("-", "_")},
        )
        for tip, turn in itertools.product(_TIPS, _TURNS)
    },
    **{
        f"the other tip passes the part ({text})": (Must.IDLE_TIP_PASSES, {"when": when})
        for text, when in _WHEN.items()
    },
    **{
        f"the {text} free of contact on withdrawal": (Must.WITHDRAWS_FREE, {"tips": tips})
        for text, tips in _WITHDRAWS.items()
    },
}
PROPERTIES: Mapping[str, Name] = {
    **{
        f"one tip sticks all the way and turns the part {turn}; the motion is unique": (
            Property.TURNS_PART,
            {"turn": turn.replace("-", "_")},
        )
        for turn in _TURNS
    },
    "one tip sticks until the other one touches, then both stick and the part translates with the "
    "probe; the motion is unique": (Property.STRAIGHTENS, {}),
    "both tips stay in contact and the part turns to nearly horizontal without jamming; its slide "
    "stays in the tube although the motion need not be unique": (Property.TURNS_BETWEEN_TIPS, {}),
    "the probes travel clear of the part, which stays at rest": (Property.PART_RESTS, {}),
}
_EVERY = {
    "sticking_motion.clearance": "theta, d1, dx, dy",
    "one_point_sticking.normal_force": "theta, d1, d2, rho",
    "one_point_sticking.friction_margin": "theta, d1, d2, rho, mu",
    "one_point_sticking.turning": "theta, d1, d2, side",
    "one_point_sticking.only_solution": "d1, d2, rho, mu",
    "two_point_sticking.friction_margin": "beta, mu",
    "two_point_sticking.normal_forces": "beta, d1, d2, d4",
    "two_sided_rotation.no_jam": "V, d1, mu",
}
_TEXTS = {
    **{id_: f"{id_}({inputs}): every value > 0" for id_, inputs in _EVERY.items()},
    "sticking_motion.beside": "sticking_motion.beside(theta, d2, half, dx, dy, side): at least one of "
    "its values > 0",
    "travel": "travel > 0",
    "within_edge": "half - |d2| > 0",
    "between_corners": "d2 - first > 0 and last - d2 > 0",
    "travel_to_spare": "travel in contact > longest travel of the turn",
    "touch_before_end": "h at the touch > h at the end",
    "faces_back": "sin(theta) > 0 at the end",
    "two_sided_rotation.passive_force": "two_sided_rotation.passive_force > 0 over the tube",
    "two_sided_rotation.ends_of_edges": "half - |T/2 -+ sigma| > 0 over the tube",
    "part_to_wall": "distance of part and wall along one of their sides > 0 over the tube",
    "tip_to_wall": "distance of tip and wall along x or y > 0 over the travel",
}
_OUTCOMES = {
    "the last pose misses the goal": "misses_goal",
    "a probe would start inside the part": "starts_inside",
    "the part jammed: no contact mode balances the support while the tips keep moving; the pose is that of "
    "the last step taken": "jam",
}
"""Those that the checker finds as well; of others it takes no position on what they are called."""
_ENCLOSURES = "interval arithmetic on the enclosures above"
INEQUALITIES: Mapping[str, str] = {
    f"{text} [{STATEMENTS[id_].derivation or _ENCLOSURES}]": id_ for id_, text in _TEXTS.items()
}
_ASSUMPTIONS = (
    "quasi-static motion: inertia is neglected",
    "the film's drag is diag(e_x, e_x, e_theta) about the part's centre; only rho = e_theta/e_x enters",
    "Coulomb friction at point contacts; at every instant mu is the same at all tips",
    "the part is the stated {outline}, rigid and exactly known; nothing but the probes touches it",
    "each error keeps within its bound; a probe's position error is constant during a move (and may "
    "differ in the next), and the two tips of the active probe share it",
    "the active probe travels exactly along an axis of the task's frame, as each move states; tips are "
    "points",
    "the part rests between moves, and probes are lifted without disturbing it",
)


class _Obligation(Model):
    claim: str
    inequality: str
    derivation: str
    verdict: Word
    lower_bound: str | None
    boxes: int
    over: Over


class _Step(Model):
    step: int
    primitive: str
    action: str
    property: str
    verdict: Word
    pre: BoxDocument
    pre_exact: ExactBox
    post: BoxDocument | None
    post_exact: ExactBox | None
    obligations: tuple[_Obligation, ...]


class _Claim(Model):
    words: str
    assumptions: tuple[str, ...]
    inequalities: tuple[str, ...]


class _Undecided(Model):
    move: int
    step: int
    action: str
    claim: str
    inequality: str
    fails: bool
    over: Over
    settled_by: str


class _Witness(Model):
    outcome: str
    start: tuple[str, str, str]
    friction: str
    film_ratio_m2: str
    misalignment_rad: str
    sensing: tuple[tuple[str, str, str], ...]
    dual_probe: tuple[HexPair, ...]
    single_probe: tuple[HexPair, ...]


class _Margin(Model):
    factor: FiniteFloat
    refused_at: FiniteFloat | None
    binds_first: str | None
    each_alone: dict[str, FiniteFloat]
    limit: str | None


class CertificateOne(Model):
    """A certificate of schema 1."""

    schema_: Annotated[Literal["meso-robust/certificate/1"], Field(alias="schema")]
    digest: str
    verdict: Word
    task: str
    task_hash: str
    claim: _Claim
    goal: BoxDocument
    goal_exact: ExactBox
    policy: tuple[RuleDocument, ...]
    steps: tuple[_Step, ...]
    undecided: _Undecided | None
    witness: _Witness | None
    margin: _Margin
    simulation: SimulationDocument
    made_with: dict[str, str]


def certificate_of(old: CertificateOne, task: Task) -> Certificate:
    """The same certificate by names; ``digest`` stays that of the file.

    Parameters
    ----------
    old
        As read.
    task
        The task that it is about, by its hash.

    Raises
    ------
    ValidationError
        A number is none that a certificate can have.
    """
    values = old.model_dump(mode="json", by_alias=True)
    values["schema"] = "meso-robust/certificate/2"
    values["claim"] = _claim(old, task)
    for step in values["steps"]:
        step["property"] = _named(*PROPERTIES.get(step["property"], (step["property"], {})))
        step["obligations"] = [_obligation(one) for one in step["obligations"]]
    if values["undecided"] is not None:
        values["undecided"]["reason"] = _named(values["undecided"].pop("claim"))
        values["undecided"]["settled_by"] = _named(values["undecided"]["settled_by"])
    if values["witness"] is not None:
        outcome = values["witness"]["outcome"].removeprefix("move ").lstrip("0123456789: ")
        values["witness"] |= {"move": None, "outcome": _OUTCOMES.get(outcome, outcome)}
    limit = values["margin"]["limit"]
    if limit is not None:
        values["margin"]["limit"] = {**_named(limit), "step": 1, "action": ""}
    values["reading"] = {}
    return Certificate.model_validate_json(json.dumps(values))


def _named(id_: str, about: Mapping[str, str] | None = None) -> dict[str, Any]:
    return {"id": id_, "about": dict(about or {})}


def _obligation(old: dict[str, Any]) -> dict[str, Any]:
    claim, inequality = old.pop("claim"), f"{old['inequality']} [{old.pop('derivation')}]"
    old["inequality"] = INEQUALITIES.get(inequality, inequality)
    return {**_named(*OBLIGATIONS.get(claim, (claim, {}))), **old}


def _claim(old: CertificateOne, task: Task) -> dict[str, Any]:
    moves, stated = len(old.policy), old.claim
    own = Claim.ENDS_IN_GOAL if task.slot is None else Claim.ENDS_IN_GOAL_CLEAR_OF_WALLS
    outline = "rectangle"
    if not isinstance(task.part, Part):
        outline = "polygon, its reference point the centre of drag"
    taken = tuple(one.format(outline=outline) for one in _ASSUMPTIONS)
    listed = [INEQUALITIES.get(one, one) for one in stated.inequalities]
    with ctx.workprec(BITS):
        ranges = {key: _outward(side) for key, side in uncertainties(given(task)).items()}
    return {
        "id": own if stated.words == _words(task, moves) else stated.words,
        "moves": moves,
        "premises": list(premises(task))
        if stated.assumptions == taken
        else list(stated.assumptions),
        "uncertainties": ranges,
        "inequalities": {
            # what is listed twice is another name, so that it is rejected
            id_ if listed.index(id_) == k else f"{id_}, again": _derivation(id_)
            for k, id_ in enumerate(listed)
        },
    }


def _derivation(id_: str) -> str | None:
    return STATEMENTS[id_].derivation if id_ in STATEMENTS else None


def _outward(side: Side) -> HexPair:
    """The next doubles beyond a range that was stated by the task alone."""
    low, high = float(side[0].lower()), float(side[1].upper())
    return math.nextafter(low, -math.inf).hex(), math.nextafter(high, math.inf).hex()


def _words(task: Task, moves: int) -> str:
    """The sentence of the claim, as it was compared."""
    u, start, goal = task.uncertainty, task.start, task.goal
    walls = "" if task.slot is None else " and neither the part nor a tip touches the slot's walls"
    return (
        f"From every start within {u.sensed_position_um} um and {u.sensed_orientation_deg} deg of "
        f"({start.x_um} um, {start.y_um} um, {start.theta_deg} deg), whatever the sensing errors "
        f"(same bounds, before each move), the probe errors (within {u.probe_position_um} um), "
        f"mu in {list(u.friction)}, film ratio within {u.film_ratio_percent} % of "
        f"{u.film_ratio_um2} um^2 and tip misalignment in {list(u.tip_misalignment_deg)} deg, the "
        f"plan's policy of {moves} moves can be carried out, and every motion of the quasi-static "
        f"model ends with the part within {goal.position_tolerance_um} um and "
        f"{goal.orientation_tolerance_deg} deg of ({goal.x_um} um, {goal.y_um} um, "
        f"{goal.theta_deg} deg){walls}."
    )
