"""A changed inequality of one move, held against what the planner proves of the move in its place.

Its box is one of the variables of the move, which the checker lets be wider than it must be by some
last digits only. The task is widened, quantity by quantity, by as much; what the planner then proves
holds over more than that.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from meso_robust.bounds import Interval
from meso_robust.campaigns.mutation.forging import ends_of
from meso_robust.campaigns.mutation.original import Original
from meso_robust.campaigns.mutation.places import Document, Place, at
from meso_robust.primitives.base import BENDING
from meso_robust.primitives.certify import certify_move
from meso_robust.primitives.setup import PoseBox, Setup

FIELDS: Mapping[str, tuple[str, ...]] = {
    "sensed_position": ("sensed_x", "sensed_y"),
    "probe_position": ("probe_x", "probe_y", "passive_x", "passive_y"),
    "friction": ("mu_upper_now", "mu_lower_now", "mu_passive_now"),
    "film_ratio": ("rho", "rho_now"),
    "misalignment": ("beta",),
    "tip_radius": ("radius_upper", "radius_lower"),
    "passive_tip_radius": ("radius_passive",),
    "tip_spacing": ("spacing",),
    "size": ("depth",),
    "squareness": ("kappa",),
    "travel_direction": ("direction",),
    "travel_scale": ("scale",),
    "drag_centre": ("drag_a", "drag_n", "centre_a", "centre_n", "centre_a_now", "centre_n_now"),
    "drag_anisotropy": ("stretch", "shear", "stretch_now", "shear_now"),
    "probe_wander": ("wander_x", "wander_y", "wander_x_now", "wander_y_now", "bend", "bend_now"),
}
"""Of each uncertainty the variables of a move that have its range."""


def proves_too(original: Original, document: Document, where: Place) -> bool:
    """Whether the planner proves a stated inequality over at least its box.

    Parameters
    ----------
    original, document
        The certificate, and a copy in which one inequality is changed.
    where
        Place of the inequality.
    """
    move, number = int(where[1]), int(where[3])
    old, new = at(original.document, where), at(document, where)
    elsewhere = {
        k: ends
        for one in original.document["steps"][move]["obligations"]
        for k, ends in one["over"].items()
    }
    known = {**elsewhere, **old["over"]}
    wider = {name: _excess(known.get(name), ends) for name, ends in new["over"].items()}
    if not set(wider) <= {
        *("x", "y", "theta", "share"),
        *(k for own in FIELDS.values() for k in own),
    }:
        return False
    setup = _widened(original.setup, wider)
    step = certify_move(
        original.rules(document["policy"])[move], _before(original, move, wider), setup
    )
    if number >= len(step.obligations) or str(step.obligations[number].name.id) != new["id"]:
        return False
    return step.obligations[number].proof.lower >= float.fromhex(new["lower_bound"])


def _excess(old: list[str] | None, new: list[str]) -> float:
    """By how much a range reaches beyond another one; a variable that is stated nowhere is exact."""
    low, high = (float.fromhex(end) for end in new)
    first, last = (0.0, 0.0) if old is None else (float.fromhex(end) for end in old)
    return max(first - low, high - last, 0.0)


def _widened(setup: Setup, wider: Mapping[str, float]) -> Setup:
    u = setup.uncertainty
    changes = {}
    for field, names in FIELDS.items():
        more = max(_in_field(name, wider.get(name, 0.0)) for name in names)
        if more > 0.0:
            changes[field] = getattr(u, field) + Interval(-more, more)
    return replace(setup, uncertainty=replace(u, **changes))


def _in_field(name: str, more: float) -> float:
    return more * BENDING.hi if name.startswith("bend") else more


def _before(original: Original, move: int, wider: Mapping[str, float]) -> PoseBox:
    """All poses before a move, as stated, widened along both axes alike."""
    x, y, theta = (
        Interval(*ends) for ends in ends_of(original.document["steps"][move]["pre_exact"])
    )
    most = max(wider.get("x", 0.0), wider.get("y", 0.0))
    place, turn = Interval(-most, most), wider.get("theta", 0.0)
    return PoseBox(x=x + place, y=y + place, theta=theta + Interval(-turn, turn))
