"""What would settle a plan that is not certified, by stable names."""

from __future__ import annotations

from enum import StrEnum


class Remedy(StrEnum):
    """What a user can do."""

    NARROW_ALL = "narrow_all"
    """About ``scale``: a robust plan was found with all uncertainties scaled by it."""
    NARROW_ONE = "narrow_one"
    """About ``uncertainty``, ``scale`` and ``range``, what that leaves of it: with that one alone."""
    SEARCH_LONGER = "search_longer"
    """About ``scale`` and ``seconds``: the search for the task as stated gave up after that."""
    SEARCH_LONGER_OR_NARROW = "search_longer_or_narrow"
    """About ``uncertainty`` and ``range`` as well."""
    LEAVE_SLOT = "leave_slot"
    """The plan is robust away from the slot."""
    RAISE_CAP = "raise_cap"
    """About ``force_un``, a bound of all contact forces of a plan that is robust without a cap."""
    CHANGE_MOVE = "change_move"
    """Of a plan that someone else made."""
    CLEAR_STAGE = "clear_stage"
    BOUND_EFFECT = "bound_effect"
    WITHOUT_EFFECT = "without_effect"
    """About ``effect`` and ``claim``, the key in the register of what rests on its absence."""
    CALIBRATE_CAMERA = "calibrate_camera"
    NEXT_PUSH = "next_push"
    """Of recordings that several models explain, or none."""
    DIAGNOSE = "diagnose"
    """Of recordings that reject the model."""
