"""What every certificate takes for granted, by stable names; a laboratory that breaks one has no proof."""

from __future__ import annotations

from enum import StrEnum

from meso_robust.task import POINT_TIPS, Task


class Premise(StrEnum):
    """A premise of the proof; its sentence is in ``meso_robust.certificates.words``."""

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


SCHEMA_1 = tuple(Premise)[:12]
"""Of a task of point tips and an exact part."""
_SWAPPED = {
    Premise.FILM_DRAG: Premise.FILM_LINEAR,
    Premise.COULOMB_FRICTION: Premise.COULOMB_EACH_TIP,
    Premise.PART_KNOWN: Premise.PART_WITHIN_TOLERANCE,
    Premise.TRAVEL_STRAIGHT: Premise.TRAVEL_WITHIN_BOUNDS,
    Premise.TRAVEL_TO_SCALE: Premise.TRAVEL_WITHIN_BOUNDS,
    Premise.POINT_TIPS: Premise.TIPS_ARE_DISCS,
    Premise.TIP_SPACING_EXACT: Premise.ERRORS_BOUNDED,
}
"""What a task of schema 2 has in the place of a premise of schema 1."""


def premise_of(task: Task, premise: Premise) -> Premise:
    """What stands for a premise of schema 1 in the certificate of a task.

    Parameters
    ----------
    task
        Its schema and what it states decide.
    premise
        One of ``SCHEMA_1``.

    Returns
    -------
    Premise
        The same for a task of schema 1.
    """
    if task.schema_ == POINT_TIPS:
        return premise
    if premise is Premise.COULOMB_FRICTION and task.uncertainty.friction_common:
        return premise
    if premise is Premise.FILM_DRAG and task.uncertainty.drag_centre_moves:
        return Premise.FILM_AT_EACH_INSTANT
    if premise is Premise.PROBES_RIGID and task.probe.max_force_un is not None:
        return Premise.PROBES_RIGID_BELOW_CAP
    return _SWAPPED.get(premise, premise)


def premises(task: Task) -> tuple[Premise, ...]:
    """What a proof for a task takes for granted.

    Parameters
    ----------
    task
        Its schema and what it states decide.

    Returns
    -------
    tuple
        In the order of certificates.
    """
    return tuple(dict.fromkeys(premise_of(task, one) for one in SCHEMA_1))
