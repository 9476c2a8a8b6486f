"""The checker's own words for what it verifies, rendered from names that it understands.

What a certificate says of itself in words is never shown as verified.
"""

from __future__ import annotations

from collections.abc import Mapping
from enum import StrEnum

from meso_robust.checker.ids import Must, Named, Objection, Premise
from meso_robust.task import Task

PREMISES: Mapping[Premise, str] = {
    Premise.QUASI_STATIC: "motion is quasi-static: inertia is neglected",
    Premise.FILM_DRAG: "the film drags by diag(e_x, e_x, e_theta) about the part's reference point "
    "(a rectangle's centre), and only rho = e_theta/e_x matters",
    Premise.COULOMB_FRICTION: "point contacts have Coulomb friction, with one mu at all tips at every "
    "instant",
    Premise.PART_KNOWN: "the part has exactly the task's outline and is rigid; only probes touch it and, in a guided push, the walls of the slot, which are as stated",
    Premise.ERRORS_BOUNDED: "errors keep within their bounds; a probe's position error is constant "
    "during a move, and one for both tips of the active probe",
    Premise.TRAVEL_STRAIGHT: "the active probe travels exactly along an axis of the task's frame",
    Premise.TRAVEL_TO_SCALE: "a probe travels exactly as far as commanded",
    Premise.POINT_TIPS: "tips are points",
    Premise.TIP_SPACING_EXACT: "the tips of the active probe are exactly tip_spacing_um apart, square "
    "to the push",
    Premise.MISALIGNMENT_SIGN: "positive misalignment turns the line through the tips of the active "
    "probe counter-clockwise from square to the push: the tip on the right, seen along the push, is "
    "ahead, whatever the heading",
    Premise.PROBES_RIGID: "probes and tips are rigid under any force; no force is bounded, and forces "
    "grow without limit close to a jam",
    Premise.PART_RESTS: "the part rests between moves; lifting a probe does not disturb it",
    Premise.FILM_LINEAR: "the film drags linearly and symmetrically; its centre is a point of the part "
    "within the bound, rho and anisotropy are within theirs at every instant",
    Premise.FILM_AT_EACH_INSTANT: "the film drags linearly and symmetrically; at every instant its centre, "
    "rho and anisotropy are within their bounds",
    Premise.COULOMB_EACH_TIP: "point contacts have Coulomb friction; each tip has a mu of its own in the "
    "range at every instant",
    Premise.PART_WITHIN_TOLERANCE: "the part is rigid, its edges are straight and within tolerance, its "
    "corners rounded by no more than stated; only probes touch it and, in a guided push, the walls of the slot, "
    "which are as stated",
    Premise.TRAVEL_WITHIN_BOUNDS: "a moving probe keeps within the bounds of direction, length and "
    "wandering; one that is not moved rests",
    Premise.TIPS_ARE_DISCS: "tips are discs of a radius in the range that do not turn; positions are "
    "those of their centres",
    Premise.PROBES_RIGID_BELOW_CAP: "probes and tips are rigid up to max_force_un",
}

_SENTENCES: Mapping[StrEnum, str] = {
    Must.TIP_FREE_AT_START: "the {tip} tip is free of contact at the start",
    Must.TIP_REACHES_PART: "the tip reaches the part",
    Must.TIP_ON_EDGE: "the {tip} tip touches the edge",
    Must.TIP_PUSHES: "the {tip} tip pushes",
    Must.TIP_STICKS: "the {tip} tip sticks",
    Must.TIP_TURNS_PART: "the {tip} tip turns the part {turn}",
    Must.SLIP_BOUNDED: "the {tip} tip slips no farther than it may",
    Must.NO_SLIPPING: "the {tip} tip can only stick, not slip",
    Must.IDLE_TIP_PASSES: "the idle tip passes the part ({when})",
    Must.WITHDRAWS_FREE: "on withdrawal contact is lost at once ({tips})",
    Must.PAIR_STICKS: "the pair of tips sticks",
    Must.PAIR_PUSHES: "both tips push",
    Must.SECOND_TIP_TOUCHES: "the second tip touches before the probe stops",
    Must.NO_JAM: "the grasp cannot close (no jam)",
    Must.PUSHES_UNTIL_REST: "the active tip pushes until the part rests on both",
    Must.UNIQUE_UNTIL_REST: "the motion is unique until the part rests on both",
    Must.RESTS_BEFORE_END: "the part rests on the passive tip before the push ends",
    Must.BOTH_TIPS_TOUCH: "both tips stay in contact",
    Must.BOTH_TIPS_ON_EDGES: "both tips stay on their edges",
    Must.TIP_CLEAR_OF_PART: "the {tip} tip stays clear of the part on its way",
    Must.PART_CLEAR_OF_WALLS: "the part stays clear of the slot's walls",
    Must.TIPS_CLEAR_OF_WALLS: "the tips stay clear of the slot's walls",
    Must.FORCE_BELOW_CAP: "no contact force exceeds the largest one that the task allows",
    Must.PART_IN_SLOT: "the front is within the slot, clear of its end, and the rear outside",
    Must.ONE_WALL_AT_A_TIME: "the part cannot touch both walls at once",
    Must.EDGE_TURNS_BACK: "the slot's edge turns the part back ({tip} tip)",
    Must.WALL_TURNS_BACK: "a wall turns the part back by a corner of its front",
    Must.FILM_TURNS_WITH: "friction at the slot's edge does not turn the part against the film",
    Must.TIP_STEERS: "the {tip} tip turns the part back where no edge of the slot holds it",
    Must.GUIDE_COVERED: "the walls can guide the part",
    Must.ACTIVE_PRESSES: "the active tip presses on the part between both tips",
    Must.ACTIVE_PRESSES_ALONE: "the active tip alone would press on the part",
    Objection.VALUE: "",
    Objection.MOVE_VALUE: "move {move}",
    Objection.DIGEST: "digest: the SHA-256 of all other values",
    Objection.TASK_SECTIONS: "the checker knows every section of the task",
    Objection.GOAL_REACHED: "every final pose lies in the goal",
    Objection.POST_HOLDS: "every pose after move {move} lies in its box",
    Objection.OBLIGATIONS_LISTED: "the list of obligations",
    Objection.MOVE_KNOWN: "the checker knows each move of the policy",
    Objection.SIDE_OF_MOVE: "the side of a {action}",
    Objection.PASSIVE_TIP: "the passive tip of a {action}",
    Objection.EDGES_OPPOSITE: "the two edges that a rotation holds are about parallel, in rad",
    Objection.EDGE_ON_HULL: "an edge of the part belongs to its convex hull",
    Objection.CENTRE_IN_HULL: "the centre lies within the part's convex hull",
    Objection.COMES_TO_REST: "the part comes to rest on both tips",
    Objection.PUSHES_ONTO_PASSIVE: "the active tip pushes the part onto the passive one",
    Objection.RESTS_WELL_BEFORE_END: "the part rests on the passive tip well before the push ends",
    Objection.SLIDE_IN_TUBE: "the slide between both tips stays in the tube",
    Objection.WITNESS_FAILS: "the witness is a run that fails",
    Objection.STARTS_INSIDE: "a probe would start inside the part",
    Objection.MEETS_WALL: "the part meets a wall",
    Objection.JAMS: "the part jams between both tips: no motion goes on",
    Objection.MISSES_GOAL: "the last pose misses the goal",
    Objection.END_UNDECIDED: "the last pose is neither inside nor outside the goal for certain",
}


def sentence(name: Named) -> str:
    """A name in words, with the value of it that is meant."""
    data = {key: text.replace("_", " ") for key, text in name.about.items()}
    said = _SENTENCES[name.id].format(**data)
    return ": ".join(part for part in (said, name.at) if part)


def claim(task: Task, moves: int, *, guided: bool = False) -> str:
    """What is verified of a policy of so many moves, in some of which walls may guide the part."""
    u, start, goal = task.uncertainty, task.start, task.goal
    real = ", ".join(("", *task.schema_2_values))
    return (
        f"From every start within {u.sensed_position_um} um and {u.sensed_orientation_deg} deg of "
        f"({start.x_um} um, {start.y_um} um, {start.theta_deg} deg), whatever the sensing errors "
        f"(same bounds, before each move), the probe errors (within {u.probe_position_um} um), "
        f"mu in {list(u.friction)}, film ratio within {u.film_ratio_percent} % of "
        f"{u.film_ratio_um2} um^2 and tip misalignment in {list(u.tip_misalignment_deg)} deg{real}, the "
        f"plan's policy of {moves} move{'s' * (moves != 1)} can be carried out, and every motion of the quasi-static "
        f"model ends with the part within {goal.position_tolerance_um} um and "
        f"{goal.orientation_tolerance_deg} deg of ({goal.x_um} um, {goal.y_um} um, "
        f"{goal.theta_deg} deg){_walls(task, guided)}."
    )


def _walls(task: Task, guided: bool) -> str:
    if guided:
        return (
            "; no tip touches the slot's walls, and the part only its side walls, in guided pushes"
        )
    return "" if task.slot is None else " and neither the part nor a tip touches the slot's walls"
