"""Pushes to choose from, and which of them are fit to identify."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from meso_robust.errors import InputError
from meso_robust.identification.experiment import (
    Bench,
    Part,
    PlannedPush,
    blocked,
    check_field,
    edge_push,
)
from meso_robust.identification.rollout import Setting
from meso_robust.identification.sensitivity import Sensitivity, StartBox, sensitivities
from meso_robust.recordings.rules import DEG, UM
from meso_robust.types import Floats


@dataclass(frozen=True, slots=True, kw_only=True)
class Candidates:
    """What pushes to choose from.

    Attributes
    ----------
    places
        Number of places on every edge, evenly between its corner margins.
    angles
        Of the edge's outward normal against the direction of the push, rad.
    lengths
        From first contact on, m.
    repeats
        Most times that one push is chosen.

    Raises
    ------
    InputError
        If there is nothing to choose from.
    """

    places: int = 7
    angles: tuple[float, ...] = (-30.0 * DEG, -15.0 * DEG, 0.0, 15.0 * DEG, 30.0 * DEG)
    lengths: tuple[float, ...] = (700e-6,)
    repeats: int = 3

    def __post_init__(self) -> None:
        """Check the values."""
        if self.places < 1 or self.repeats < 1 or not self.angles or not self.lengths:
            raise InputError(
                f"candidates: {self.places} places, {self.repeats} repeats, {len(self.angles)} "
                f"angles, {len(self.lengths)} lengths; must be at least 1 each; give more"
            )


def candidates(
    part: Part, bench: Bench, choice: Candidates
) -> tuple[tuple[PlannedPush, ...], tuple[tuple[str, str], ...]]:
    """All pushes to choose from, and the names of those that cannot be made, with why."""
    pushes: list[PlannedPush] = []
    left_out: list[tuple[str, str]] = []
    for length in choice.lengths:
        for edge in range(len(part.outline)):
            for place in _places(part, bench, edge, choice.places):
                for angle in choice.angles:
                    own = replace(bench, length=length)
                    name = _name(edge, place, angle, length)
                    push = edge_push(part, own, name=name, edge=edge, place=place, angle=angle)
                    why = _hindrance(part, own, push)
                    if why:
                        left_out.append((name, why))
                    else:
                        pushes.append(push)
    return tuple(pushes), tuple(left_out)


def safe(
    setting: Setting, pushes: Sequence[PlannedPush], values: Floats, box: StartBox
) -> tuple[tuple[PlannedPush, ...], tuple[tuple[str, str], ...]]:
    """The pushes that identify, and the names of the others, with why.

    A push is left out if its start is pathological in the box, or if the tip has lost the part at
    the end.
    """
    judged = sensitivities(setting, pushes, values, box, samples=0)
    reasons = [_unfit(found) for found in judged]
    kept = tuple(push for push, why in zip(pushes, reasons, strict=True) if not why)
    left = tuple((push.name, why) for push, why in zip(pushes, reasons, strict=True) if why)
    return kept, left


def _places(part: Part, bench: Bench, edge: int, count: int) -> Floats:
    corners = part.outline
    length = float(np.hypot(*(corners[(edge + 1) % len(corners)] - corners[edge])))
    most = 0.5 * length - bench.corner_margin
    return np.linspace(-most, most, count) if most > 0.0 and count > 1 else np.zeros(1)


def _name(edge: int, place: float, angle: float, length: float) -> str:
    return f"edge{edge}_{place / UM:+.0f}um_{angle / DEG:+.0f}deg_{length / UM:.0f}um"


def _hindrance(part: Part, bench: Bench, push: PlannedPush) -> str:
    if blocked(part, bench, push):
        return "another edge is in the way of the tip"
    try:
        check_field(part, bench, push)
    except InputError:
        return "may leave the field of view"
    return ""


def _unfit(found: Sensitivity) -> str:
    lost = ("the tip loses the part",) if np.any(found.modes == 0) else ()
    return "; ".join((*found.reasons, *lost))
