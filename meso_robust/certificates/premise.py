"""What every certificate takes for granted, by stable names; a laboratory that breaks one has no proof."""

from __future__ import annotations

from enum import StrEnum


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
