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


SCHEMA_1 = tuple(Premise)[:12]
"""Of a task of point tips and an exact part."""


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
    if task.schema_ == POINT_TIPS:
        return SCHEMA_1
    return (
        Premise.QUASI_STATIC,
        Premise.FILM_LINEAR,
        Premise.COULOMB_FRICTION if task.uncertainty.friction_common else Premise.COULOMB_EACH_TIP,
        Premise.PART_WITHIN_TOLERANCE,
        Premise.ERRORS_BOUNDED,
        Premise.TRAVEL_WITHIN_BOUNDS,
        Premise.TIPS_ARE_DISCS,
        Premise.MISALIGNMENT_SIGN,
        Premise.PROBES_RIGID if task.probe.max_force_un is None else Premise.PROBES_RIGID_BELOW_CAP,
        Premise.PART_RESTS,
    )
