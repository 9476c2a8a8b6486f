"""Stable names of what a certificate proves: they are compared, kept in files and never reworded.

Words for people are rendered from them in one place, ``meso_robust.certificates.words``.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from enum import StrEnum


@dataclass(frozen=True, slots=True)
class Named:
    """A stable id and the data that tells apart what bears the same one."""

    id: StrEnum
    about: Mapping[str, str] = field(default_factory=dict)
    """Always in the same order of keys for one id."""

    @property
    def key(self) -> str:
        """Both as one text, such as ``tip_sticks/pushing``: a key of tables."""
        return "/".join((self.id, *self.about.values()))


class Which(StrEnum):
    """A tip, or the tips, that an obligation is about."""

    UPPER = "upper"
    LOWER = "lower"
    PUSHING = "pushing"
    ACTIVE = "active"
    PASSIVE = "passive"
    PAIR = "pair"
    """Both tips of the active probe."""
    BOTH = "both"
    """The active and the passive tip of a rotation."""


class Turning(StrEnum):
    """Which way a part turns, in the axes of the move."""

    COUNTER_CLOCKWISE = "counter_clockwise"
    CLOCKWISE = "clockwise"


class When(StrEnum):
    """While what of a move the idle tip passes the part."""

    BEFORE_TOUCH = "before_touch"
    WHILE_TURNING = "while_turning"
    EARLY_IN_TURN = "early_in_turn"
    LATE_IN_TURN = "late_in_turn"
    ON_WITHDRAWAL = "on_withdrawal"


class ObligationId(StrEnum):
    """What must hold for a move to do what it is for."""

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
    # what stays undecided where no enclosure was found; a PROVED certificate has none of these
    EDGES_OPPOSITE = "edges_opposite"
    ACTIVE_ABOVE_PASSIVE = "active_above_passive"
    COMES_TO_REST = "comes_to_rest"
    END_ENCLOSED = "end_enclosed"
    GUIDE_COVERED = "guide_covered"


class Inequality(StrEnum):
    """What is to be positive; one with a dot is the generated function of that name."""

    CLEARANCE = "sticking_motion.clearance"
    BESIDE = "sticking_motion.beside"
    NORMAL_FORCE = "one_point_sticking.normal_force"
    FRICTION_MARGIN = "one_point_sticking.friction_margin"
    TURNING = "one_point_sticking.turning"
    TURNS_ANY_WAY = "drag_tensor.turns_any_way"
    TURNS_BACK = "drag_tensor.turns_back"
    SLIPS_ONE_WAY = "drag_tensor.slips_one_way"
    CREEPS_LESS = "drag_tensor.creeps_less"
    ONLY_SOLUTION = "one_point_sticking.only_solution"
    PAIR_FRICTION = "two_point_sticking.friction_margin"
    PAIR_FORCES = "two_point_sticking.normal_forces"
    NO_JAM = "opposite_edges.no_jam"
    NO_JAM_OF_POINTS = "two_sided_rotation.no_jam"
    """The same of point tips, as older certificates name it: read, and no longer written."""
    BEARS = "slot_walls.bears"
    STEERS = "slot_walls.steers"
    CORNER_TURNS = "slot_walls.corner"
    STIFF = "slot_walls.stiff"
    ONE_WALL = "slot_walls.one_wall"
    NO_JAM_IN_SLOT = "slot_walls.no_jam"
    PASSIVE_FORCE = "two_sided_rotation.passive_force"
    ENDS_OF_EDGES = "two_sided_rotation.ends_of_edges"
    TRAVEL = "travel"
    WITHIN_EDGE = "within_edge"
    BETWEEN_CORNERS = "between_corners"
    TRAVEL_TO_SPARE = "travel_to_spare"
    TOUCH_BEFORE_END = "touch_before_end"
    FACES_BACK = "faces_back"
    PART_TO_WALL = "part_to_wall"
    TIP_TO_WALL = "tip_to_wall"
    FORCE = "force_to_spare"
    IN_SLOT = "in_slot"
    NONE = "undecided"
    """Nothing could be bounded."""

    @property
    def derivation(self) -> str | None:
        """File that derives it; None: interval arithmetic on enclosures."""
        module, dot, _ = self.partition(".")
        return f"derivations/{module}.py" if dot else None

    @property
    def any_value(self) -> bool:
        """Whether it is enough that one of its values is positive."""
        return self is Inequality.BESIDE


class Property(StrEnum):
    """What a move is proved to do."""

    TURNS_PART = "turns_part"
    STRAIGHTENS = "straightens"
    TURNS_BETWEEN_TIPS = "turns_between_tips"
    PART_RESTS = "part_rests"
    GUIDED_BY_WALLS = "guided_by_walls"


class Reason(StrEnum):
    """Why nothing is claimed of a plan whose moves leave no obligation open."""

    ENDS_IN_GOAL = "ends_in_goal"
    PREMISE_KEPT = "premise_kept"
    EFFECT_BOUNDED = "effect_bounded"
    WITHIN_BOUNDS = "within_bounds"


_PUSHING = (Which.PUSHING, Which.UPPER, Which.LOWER)
DATA: Mapping[ObligationId, Mapping[str, tuple[StrEnum, ...]]] = {
    ObligationId.TIP_FREE_AT_START: {"tip": (Which.UPPER, Which.LOWER, Which.PASSIVE)},
    ObligationId.TIP_ON_EDGE: {"tip": (*_PUSHING, Which.ACTIVE)},
    ObligationId.TIP_PUSHES: {"tip": _PUSHING},
    ObligationId.TIP_STICKS: {"tip": _PUSHING},
    ObligationId.TIP_TURNS_PART: {"tip": _PUSHING, "turn": tuple(Turning)},
    ObligationId.NO_SLIPPING: {"tip": _PUSHING},
    ObligationId.SLIP_BOUNDED: {"tip": (Which.UPPER, Which.LOWER)},
    ObligationId.IDLE_TIP_PASSES: {"when": tuple(When)},
    ObligationId.WITHDRAWS_FREE: {"tips": (Which.PUSHING, Which.PAIR, Which.BOTH)},
    ObligationId.TIP_CLEAR_OF_PART: {"tip": (Which.UPPER, Which.LOWER)},
    ObligationId.EDGE_TURNS_BACK: {"tip": (Which.UPPER, Which.LOWER)},
    ObligationId.TIP_STEERS: {"tip": (Which.UPPER, Which.LOWER)},
}
"""The data that obligations are about, and what it can be; all others have none."""


def every_obligation() -> Iterator[Named]:
    """Every name that an obligation can have.

    Returns
    -------
    Iterator[Named]
        Ids in the order of `ObligationId`, each with all of its data.
    """
    for id_ in ObligationId:
        data = DATA.get(id_, {})
        for values in itertools.product(*data.values()):
            yield Named(id_, dict(zip(data, values, strict=True)))


SIDES = {1: Which.UPPER, -1: Which.LOWER}
TURNS = {1: Turning.COUNTER_CLOCKWISE, -1: Turning.CLOCKWISE}


def about(id_: StrEnum, **data: str) -> Named:
    """A name with its data.

    Parameters
    ----------
    id_
        Of an obligation, a property or a reason.
    **data
        What tells apart those that bear the same id, always in the same order of keys.

    Returns
    -------
    Named
        Both together.
    """
    return Named(id_, data)
