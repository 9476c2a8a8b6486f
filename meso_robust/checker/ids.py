"""The checker's own list of the stable names that a certificate may use.

A name that is not here is not understood, and the certificate is rejected.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from enum import StrEnum

from meso_robust.task import Task


class Must(StrEnum):
    """What a move must fulfil."""

    TIP_FREE_AT_START = "tip_free_at_start"
    TIP_REACHES_PART = "tip_reaches_part"
    TIP_ON_EDGE = "tip_on_edge"
    TIP_PUSHES = "tip_pushes"
    TIP_STICKS = "tip_sticks"
    TIP_TURNS_PART = "tip_turns_part"
    NO_SLIPPING = "no_slipping"
    SLIP_BOUNDED = "slip_bounded"
    IDLE_TIP_PASSES = "idle_tip_passes"
    WITHDRAWS_FREE = "withdraws_free"
    PAIR_STICKS = "pair_sticks"
    PAIR_PUSHES = "pair_pushes"
    SECOND_TIP_TOUCHES = "second_tip_touches"
    NO_JAM = "no_jam"
    PUSHES_UNTIL_REST = "pushes_until_rest"
    UNIQUE_UNTIL_REST = "unique_until_rest"
    RESTS_BEFORE_END = "rests_before_end"
    BOTH_TIPS_TOUCH = "both_tips_touch"
    BOTH_TIPS_ON_EDGES = "both_tips_on_edges"
    TIP_CLEAR_OF_PART = "tip_clear_of_part"
    PART_CLEAR_OF_WALLS = "part_clear_of_walls"
    TIPS_CLEAR_OF_WALLS = "tips_clear_of_walls"
    FORCE_BELOW_CAP = "force_below_cap"
    PART_IN_SLOT = "part_in_slot"
    ONE_WALL_AT_A_TIME = "one_wall_at_a_time"
    EDGE_TURNS_BACK = "edge_turns_back"
    WALL_TURNS_BACK = "wall_turns_back"
    FILM_TURNS_WITH = "film_turns_with"
    TIP_STEERS = "tip_steers"
    # proved by the checker only: no certificate lists them
    ACTIVE_PRESSES = "active_presses"
    GUIDE_COVERED = "guide_covered"
    ACTIVE_PRESSES_ALONE = "active_presses_alone"


class Property(StrEnum):
    """What a move is proved to do."""

    TURNS_PART = "turns_part"
    STRAIGHTENS = "straightens"
    TURNS_BETWEEN_TIPS = "turns_between_tips"
    PART_RESTS = "part_rests"
    GUIDED_BY_WALLS = "guided_by_walls"


class Premise(StrEnum):
    """What the checker takes for granted, as every certificate must say."""

    QUASI_STATIC = "quasi_static"
    FILM_DRAG = "film_drag"
    COULOMB_FRICTION = "coulomb_friction"
    PART_KNOWN = "part_known"
    ERRORS_BOUNDED = "errors_bounded"
    TRAVEL_STRAIGHT = "travel_straight"
    TRAVEL_TO_SCALE = "travel_to_scale"
    POINT_TIPS = "point_tips"
    TIP_SPACING_EXACT = "tip_spacing_exact"
    MISALIGNMENT_SIGN = "misalignment_sign"
    PROBES_RIGID = "probes_rigid"
    PART_RESTS = "part_rests"
    FILM_LINEAR = "film_linear"
    COULOMB_EACH_TIP = "coulomb_each_tip"
    PART_WITHIN_TOLERANCE = "part_within_tolerance"
    TRAVEL_WITHIN_BOUNDS = "travel_within_bounds"
    TIPS_ARE_DISCS = "tips_are_discs"
    PROBES_RIGID_BELOW_CAP = "probes_rigid_below_cap"
    FILM_AT_EACH_INSTANT = "film_at_each_instant"


EXACT_PARTS = {
    Premise.FILM_DRAG: Premise.FILM_LINEAR,
    Premise.COULOMB_FRICTION: Premise.COULOMB_EACH_TIP,
    Premise.PART_KNOWN: Premise.PART_WITHIN_TOLERANCE,
    Premise.TRAVEL_STRAIGHT: Premise.TRAVEL_WITHIN_BOUNDS,
    Premise.TRAVEL_TO_SCALE: None,
    Premise.POINT_TIPS: Premise.TIPS_ARE_DISCS,
    Premise.TIP_SPACING_EXACT: None,
}
"""Premises of schema 1, and what a task of schema 2 has in their place."""


def premises(task: Task) -> tuple[Premise, ...]:
    """What must be granted for a task, as its certificate must say, in this order."""
    swapped: dict[Premise, Premise | None] = {}
    if task.schema_ != "meso-robust/task/1":
        swapped |= EXACT_PARTS
        if task.uncertainty.friction_common:
            del swapped[Premise.COULOMB_FRICTION]
        if task.uncertainty.drag_centre_moves:
            swapped[Premise.FILM_DRAG] = Premise.FILM_AT_EACH_INSTANT
        if task.probe.max_force_un is not None:
            swapped[Premise.PROBES_RIGID] = Premise.PROBES_RIGID_BELOW_CAP
    old = tuple(Premise)[: tuple(Premise).index(Premise.PART_RESTS) + 1]
    found = (swapped.get(one, one) for one in old)
    return tuple(one for one in found if one is not None)


class Claim(StrEnum):
    """What a certificate is about."""

    ENDS_IN_GOAL = "ends_in_goal"
    ENDS_IN_GOAL_CLEAR_OF_WALLS = "ends_in_goal_clear_of_walls"
    ENDS_IN_GOAL_GUIDED = "ends_in_goal_guided"


class Objection(StrEnum):
    """Why a certificate is rejected, where it is no requirement of a move that does not follow."""

    VALUE = "value"
    MOVE_VALUE = "move_value"
    DIGEST = "digest"
    TASK_SECTIONS = "task_sections"
    GOAL_REACHED = "goal_reached"
    POST_HOLDS = "post_holds"
    OBLIGATIONS_LISTED = "obligations_listed"
    MOVE_KNOWN = "move_known"
    SIDE_OF_MOVE = "side_of_move"
    PASSIVE_TIP = "passive_tip"
    EDGES_OPPOSITE = "edges_opposite"
    EDGE_ON_HULL = "edge_on_hull"
    CENTRE_IN_HULL = "centre_in_hull"
    COMES_TO_REST = "comes_to_rest"
    PUSHES_ONTO_PASSIVE = "pushes_onto_passive"
    RESTS_WELL_BEFORE_END = "rests_well_before_end"
    SLIDE_IN_TUBE = "slide_in_tube"
    # of the run of a REFUTED certificate
    WITNESS_FAILS = "witness_fails"
    STARTS_INSIDE = "starts_inside"
    MEETS_WALL = "meets_wall"
    JAMS = "jams"
    MISSES_GOAL = "misses_goal"
    END_UNDECIDED = "end_undecided"


@dataclass(frozen=True, slots=True)
class Named:
    """A stable name, its data, and which value of it is meant."""

    id: StrEnum
    about: Mapping[str, str] = field(default_factory=dict)
    at: str = ""
    """Key of a certificate, with dots."""

    @property
    def key(self) -> str:
        """All of it as one text, for tables and counts."""
        said = "/".join((self.id, *self.about.values()))
        return f"{said}: {self.at}" if self.at else said

    def value(self, at: str) -> Named:
        """One of its values."""
        return replace(self, at=f"{self.at}.{at}" if self.at else at)


def named(id_: StrEnum, **about: str) -> Named:
    """A name with its data."""
    return Named(id_, about)


def place(at: str) -> Named:
    """A value of the certificate."""
    return Named(Objection.VALUE, at=at)


def of_move(number: int, at: str) -> Named:
    """A value of a move, counted from 0 as in the file."""
    return Named(Objection.MOVE_VALUE, {"move": str(number + 1)}, at)
