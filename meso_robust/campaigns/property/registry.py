"""The properties; a new one is its own file below ``laws``, and one line here."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import cache
from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from meso_robust.campaigns.property.law import Property

_PLACES = {
    "formula-values": "formulas.VALUES",
    "formula-intervals": "formulas.INTERVALS",
    "formula-balls": "formulas.BALLS",
    "sticking-turn": "sticking.STICKING",
    "two-sided-rotation": "two_sided.ROTATION",
    "stepper-converges": "convergence.CONVERGENCE",
    "scaled-drag": "same_path.DRAG",
    "other-units-move": "same_path.UNITS",
    "mirrored-move": "same_path.MIRRORED",
    "certified-is-kept": "certified.CERTIFIED",
    "failing-is-not-certified": "certified.FAILING",
    "planned-is-kept": "certified.PLANNED",
    "mirrored-certificate": "mirrored_task.CERTIFICATE",
    "mirrored-plan": "mirrored_task.PLAN",
    "other-units-certificate": "certified_units.UNITS",
}


class _Laws(Mapping[str, "Property"]):
    """Properties by name, imported when looked up: a campaign file is checked by the names alone."""

    def __getitem__(self, name: str) -> Property:
        return _law(_PLACES[name])

    def __contains__(self, name: object) -> bool:
        return name in _PLACES  # that of Mapping looks the name up, which imports

    def __iter__(self) -> Iterator[str]:
        return iter(_PLACES)

    def __len__(self) -> int:
        return len(_PLACES)


@cache
def _law(place: str) -> Property:
    module, constant = place.split(".")
    found: Property = getattr(import_module(f"{__package__}.laws.{module}"), constant)
    return found


PROPERTIES: Mapping[str, Property] = _Laws()
