"""The kinds of campaigns; a kind is its own file or folder, and one line here."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from importlib import import_module
from typing import Any

from meso_robust.campaigns.kind import Kind, Section

KINDS: Mapping[str, tuple[str, str]] = {
    "monte-carlo": ("monte_carlo.kind.MONTE_CARLO", "monte_carlo.section.MonteCarloSection"),
    "falsify": ("falsify.kind.FALSIFY", "falsify.section.FalsifySection"),
    "property": ("property.kind.PROPERTY", "property.section.PropertySection"),
    "mutation": ("mutation.kind.MUTATION", "mutation.section.MutationSection"),
    "blind": ("blind.kind.BLIND", "blind.section.BlindSection"),
}
"""Where each is, and its keys, below this package. Imported when asked for: a worker needs but one of
them, and a wrong key is refused before compiled code is imported."""


@cache
def kind_of(name: str) -> Kind:
    """A kind of campaign.

    Parameters
    ----------
    name
        One of ``KINDS``.

    Returns
    -------
    Kind
        Its functions; the module is imported on the first call.
    """
    found: Kind = _imported(KINDS[name][0])
    return found


def section_of(name: str) -> type[Section]:
    """The keys of a part of the kind of a name of ``KINDS``."""
    found: type[Section] = _imported(KINDS[name][1])
    return found


def _imported(place: str) -> Any:
    module, name = place.rsplit(".", 1)
    return getattr(import_module(f"{__package__}.{module}"), name)
