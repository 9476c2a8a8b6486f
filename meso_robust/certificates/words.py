"""Words for people, rendered from the stable names of a certificate: the only place that has them.

Nothing is decided by these sentences; they may be reworded at any time.
"""

from __future__ import annotations

from collections.abc import Mapping
from enum import StrEnum

from meso_robust.certificates.premise import Premise
from meso_robust.conditions import condition
from meso_robust.motion.two_sided import TubeStatus
from meso_robust.planning.remedy import Remedy
from meso_robust.primitives.names import Inequality, Named, ObligationId, Property, Reason
from meso_robust.task import Task
from meso_robust.wording import counted

Id = ObligationId

PREMISES: Mapping[Premise, str] = {
    Premise.QUASI_STATIC: "quasi-static motion: inertia is neglected",
    Premise.FILM_DRAG: "the film's drag is diag(e_x, e_x, e_theta) about the part's reference point "
    "(of a rectangle: its centre); only rho = e_theta/e_x enters",
    Premise.COULOMB_FRICTION: "Coulomb friction at point contacts; at every instant mu is the same "
    "at all tips",
    Premise.PART_KNOWN: "the part has the task's outline, rigid and exactly known; nothing but the "
    "probes touches it and, in a guided push, the slot's walls, which are as stated and have Coulomb friction",
    Premise.ERRORS_BOUNDED: "each error keeps within its bound; a probe's position error is constant "
    "during a move (and may differ in the next), and the two tips of the active probe share it",
    Premise.TRAVEL_STRAIGHT: "the active probe travels exactly along an axis of the task's frame, as "
    "each move states",
    Premise.TRAVEL_TO_SCALE: "a probe travels exactly as far as it is commanded: no error of scale",
    Premise.POINT_TIPS: "tips are points",
    Premise.TIP_SPACING_EXACT: "the two tips of the active probe are exactly tip_spacing_um apart, "
    "measured square to the push",
    Premise.MISALIGNMENT_SIGN: "a positive tip misalignment turns the line through the two tips of "
    "the active probe counter-clockwise from square to the push: the tip on the right, seen along the "
    "push, is ahead, whatever the heading",
    Premise.PROBES_RIGID: "probes and tips are rigid under any force: no force is bounded, and close "
    "to a jam the forces grow without limit",
    Premise.PART_RESTS: "the part rests between moves, and probes are lifted without disturbing it",
    Premise.FILM_LINEAR: "the film's drag is linear in the motion, symmetric and positive; its centre "
    "is fixed in the part and within its bound, and rho and the anisotropy keep within theirs at every "
    "instant, whether fixed in the part or in the stage",
    Premise.FILM_AT_EACH_INSTANT: "at every instant the drag on the part is that of a film whose drag is "
    "linear in the motion, symmetric and positive; its centre, rho and anisotropy keep within their bounds "
    "and may be others at the next instant",
    Premise.COULOMB_EACH_TIP: "Coulomb friction at point contacts; each tip has its own mu in the range "
    "at every instant",
    Premise.PART_WITHIN_TOLERANCE: "the part is rigid, with straight edges that keep within their "
    "tolerances, and no rounding of its corners is larger than stated; nothing but the probes touches it and, "
    "in a guided push, the slot's walls, which are as stated and have Coulomb friction",
    Premise.TRAVEL_WITHIN_BOUNDS: "the travel of a moving probe keeps within its bounds of direction, "
    "length and wandering; a probe that is not moved rests",
    Premise.TIPS_ARE_DISCS: "tips are discs that do not turn, each with a radius in its range; positions "
    "of probes are those of the centres",
    Premise.PROBES_RIGID_BELOW_CAP: "probes and tips are rigid under every force up to max_force_un",
}

_PROPERTIES: Mapping[StrEnum, str] = {
    Property.TURNS_PART: "one tip sticks all the way and turns the part {turn}; the motion is unique",
    Property.STRAIGHTENS: "one tip sticks until the other one touches, then both stick and the part "
    "translates with the probe; the motion is unique",
    Property.TURNS_BETWEEN_TIPS: "both tips stay in contact and the part turns to nearly horizontal "
    "without jamming; its slide stays in the tube although the motion need not be unique",
    Property.GUIDED_BY_WALLS: "the tips push the part into the slot, whose side walls it may touch: they do "
    "not let it lean more than before, and it does not jam; the motion need not be unique",
    Property.PART_RESTS: "the probes travel clear of the part, which stays at rest",
}

_OBLIGATIONS: Mapping[StrEnum, str] = {
    Id.TIP_FREE_AT_START: "the {tip} tip is free of contact at the start",
    Id.TIP_REACHES_PART: "the tip reaches the part",
    Id.TIP_ON_EDGE: "the {tip} tip touches the edge",
    Id.TIP_PUSHES: "the {tip} tip pushes",
    Id.TIP_STICKS: "the {tip} tip sticks",
    Id.TIP_TURNS_PART: "the {tip} tip turns the part {turn}",
    Id.SLIP_BOUNDED: "the {tip} tip slips no farther than it may",
    Id.NO_SLIPPING: "no slipping motion is possible beside the sticking one ({tip} tip)",
    Id.IDLE_TIP_PASSES: "the other tip passes the part ({when})",
    Id.WITHDRAWS_FREE: "{tips} free of contact on withdrawal",
    Id.PAIR_STICKS: "the pair of tips sticks",
    Id.PAIR_PUSHES: "both tips push",
    Id.SECOND_TIP_TOUCHES: "the second tip touches before the probe stops",
    Id.NO_JAM: "the grasp cannot close: the motion exists (no jam)",
    Id.PUSHES_UNTIL_REST: "the active tip pushes until the part rests on both",
    Id.UNIQUE_UNTIL_REST: "its motion, sticking or slipping, is unique until then",
    Id.RESTS_BEFORE_END: "the part rests on the passive tip before the push ends",
    Id.BOTH_TIPS_TOUCH: "both tips stay in contact: the active one alone would press the part on the "
    "other",
    Id.BOTH_TIPS_ON_EDGES: "both tips stay on their edges",
    Id.TIP_CLEAR_OF_PART: "the {tip} tip stays clear of the part on its way",
    Id.PART_CLEAR_OF_WALLS: "the part stays clear of the slot's walls",
    Id.TIPS_CLEAR_OF_WALLS: "the tips stay clear of the slot's walls",
    Id.FORCE_BELOW_CAP: "no contact force exceeds the largest one that the task allows",
    Id.PART_IN_SLOT: "the front is within the slot and clear of its end, the rear is outside",
    Id.ONE_WALL_AT_A_TIME: "the part is too narrow to touch both walls at once",
    Id.EDGE_TURNS_BACK: "a part that bears on the slot's edge turns back ({tip} tip)",
    Id.WALL_TURNS_BACK: "a wall that presses on a corner of the front turns the part back",
    Id.FILM_TURNS_WITH: "friction at the slot's edge is too small to turn the part against the film",
    Id.TIP_STEERS: "the part turns back where no edge of the slot holds it ({tip} tip)",
    Id.GUIDE_COVERED: "the walls can guide it: a rectangle of right angles and sharp corners on an even film, "
    "leaning little, pushed into the slot, and no cap on forces",
    Id.EDGES_OPPOSITE: "the edge that the passive tip holds is about parallel to the pushed one",
    Id.ACTIVE_ABOVE_PASSIVE: "the active tip is the upper one",
    Id.COMES_TO_REST: "the part comes to rest on both",
    Id.END_ENCLOSED: "the end can be enclosed",
}

_REASONS: Mapping[StrEnum, str] = {
    Reason.ENDS_IN_GOAL: "every final pose lies in the goal",
    Reason.PREMISE_KEPT: "premise: {premise}",
    Reason.EFFECT_BOUNDED: "bounds of {effect}",
    Reason.WITHIN_BOUNDS: "the plan keeps within the places and times, and to the least speeds, that the "
    "effects were bounded for",
}

_REMEDIES: Mapping[StrEnum, str] = {
    Remedy.NARROW_ALL: "a robust plan was found with all uncertainties scaled by {scale} (ranges of "
    "tips and part too): narrow them, or change the task so that more room is left",
    Remedy.NARROW_ONE: "a robust plan was found with the range of {uncertainty} alone scaled by "
    "{scale}, to {range}: narrow it, or change the task so that more room is left",
    Remedy.SEARCH_LONGER: "the search ended after about {seconds} s of computing, with a robust plan for all "
    "uncertainties scaled by {scale} (ranges of tips and part too): look longer (`--search-s`), narrow them, or change "
    "the task so that more room is left",
    Remedy.SEARCH_LONGER_OR_NARROW: "the search ended after about {seconds} s of computing, with a robust plan "
    "for the range of {uncertainty} alone scaled by {scale}, to {range}: look longer (`--search-s`), narrow it, or change "
    "the task so that more room is left",
    Remedy.LEAVE_SLOT: "the plan is robust away from the slot: widen the slot, or start further from "
    "its mouth, so that the part is straight before it enters",
    Remedy.RAISE_CAP: "the plan is robust but for the largest force: allow {force_un} µN ([probe] max_force_un), or "
    "push more slowly ([probe] speed_um_s), as every force grows with the speed",
    Remedy.CHANGE_MOVE: "change the move that is not proved, or let `meso-robust plan` find a plan",
    Remedy.CLEAR_STAGE: "clear away what lies on the stage: the plan is certified without it",
    Remedy.BOUND_EFFECT: "recordings that bound it: `meso-robust identify --design N` proposes pushes",
    Remedy.WITHOUT_EFFECT: "a laboratory without {effect}, or a proof of {claim} that includes it",
    Remedy.NEXT_PUSH: "the push that diagnosis.json proposes next",
    Remedy.DIAGNOSE: "`meso-robust diagnose` on the recordings, and a plan with the model that it writes",
    Remedy.CALIBRATE_CAMERA: "calibrate the camera: its effects grow with the place and the time",
}

_SENTENCES: Mapping[StrEnum, str] = {**_PROPERTIES, **_OBLIGATIONS, **_REASONS, **_REMEDIES}

_DATA: Mapping[str, Mapping[str, str]] = {
    "turn": {"counter_clockwise": "counter-clockwise", "clockwise": "clockwise"},
    "tips": {
        "pushing": "the pushing tip comes",
        "pair": "the pair comes",
        "both": "the two tips come",
    },
    "when": {
        "before_touch": "before the touch",
        "while_turning": "while it turns",
        "early_in_turn": "early in the turn",
        "late_in_turn": "late in the turn",
        "on_withdrawal": "on withdrawal",
    },
    "premise": {one.value: text for one, text in PREMISES.items()},
}
"""Words for the data of a name, where they are not its own with spaces."""

_PLAIN: Mapping[Inequality, str] = {
    Inequality.PASSIVE_FORCE: "two_sided_rotation.passive_force > 0 over the tube",
    Inequality.ENDS_OF_EDGES: "half - |T/2 -+ sigma| > 0 over the tube",
    Inequality.TRAVEL: "travel > 0",
    Inequality.WITHIN_EDGE: "half - |d2| > 0",
    Inequality.BETWEEN_CORNERS: "d2 - first > 0 and last - d2 > 0",
    Inequality.TRAVEL_TO_SPARE: "travel in contact > longest travel of the turn",
    Inequality.TOUCH_BEFORE_END: "h at the touch > h at the end",
    Inequality.FACES_BACK: "sin(theta) > 0 at the end",
    Inequality.PART_TO_WALL: "distance of part and wall along one of their sides > 0 over the tube",
    Inequality.TIP_TO_WALL: "distance of tip and wall along x or y > 0 over the travel",
    Inequality.FORCE: "largest force allowed > bound of all contact forces",
    Inequality.IN_SLOT: "depth of the front, of the rear outside, room at the end and aside > 0",
    Inequality.NONE: "undecided",
}


def words(name: Named) -> str:
    """A stable name as a sentence.

    Parameters
    ----------
    name
        The id of an obligation, a property, a reason or a remedy, and its data.

    Returns
    -------
    str
        For people; nothing compares it.
    """
    data = {key: _data(key, text) for key, text in name.about.items()}
    why = f" ({TubeStatus[data['status']].message})" if "status" in data else ""
    return _SENTENCES[name.id].format(**data) + why


def _data(key: str, text: str) -> str:
    if key == "status":
        return text.upper()
    return _DATA.get(key, {}).get(text, text.replace("_", " ") if key in _NAMES else text)


_NAMES = {"effect", "uncertainty"}
"""Data that are names of something else, with underscores."""


_IDS: Mapping[str, StrEnum] = {id_.value: id_ for id_ in _SENTENCES}


def id_of(text: str) -> StrEnum:
    """The id that a file spells.

    Raises
    ------
    KeyError
        There is none of that spelling.
    """
    return _IDS[text]


def inequality_words(inequality: Inequality) -> str:
    """An inequality in the field's symbols.

    Parameters
    ----------
    inequality
        Its stable name.

    Returns
    -------
    str
        What must be positive, and in which of its values.
    """
    if inequality in _PLAIN:
        return _PLAIN[inequality]
    inputs = ", ".join(condition(*inequality.split(".")).inputs)
    values = "at least one of its values > 0" if inequality.any_value else "every value > 0"
    return f"{inequality}({inputs}): {values}"


def derivation_words(derivation: str | None) -> str:
    """Where an inequality comes from.

    Parameters
    ----------
    derivation
        File of the derivation; None if there is none.

    Returns
    -------
    str
        The file, or what stands in for it.
    """
    return derivation or "interval arithmetic on the enclosures above"


def claim_words(task: Task, moves: int, *, guided: bool = False) -> str:
    """What is claimed of a plan of so many moves, in some of which walls may guide the part."""
    goal, u = task.goal, task.uncertainty
    walls = "" if task.slot is None else " and neither the part nor a tip touches the slot's walls"
    if guided:
        walls = (
            "; no tip touches the slot's walls, and the part only its side walls, in guided pushes"
        )
    real = ", ".join(("", *task.schema_2_values))
    return (
        f"From every start within {u.sensed_position_um} um and {u.sensed_orientation_deg} deg of "
        f"({task.start.x_um} um, {task.start.y_um} um, {task.start.theta_deg} deg), whatever the "
        f"sensing errors (same bounds, before each move), the probe errors (within "
        f"{u.probe_position_um} um), mu in {list(u.friction)}, film ratio within "
        f"{u.film_ratio_percent} % of {u.film_ratio_um2} um^2 and tip misalignment in "
        f"{list(u.tip_misalignment_deg)} deg{real}, the plan's policy of {counted(moves, 'move')} can be "
        f"carried out, and every motion of the quasi-static model ends with the part within "
        f"{goal.position_tolerance_um} um and {goal.orientation_tolerance_deg} deg of "
        f"({goal.x_um} um, {goal.y_um} um, {goal.theta_deg} deg){walls}."
    )
