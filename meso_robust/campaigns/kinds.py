"""The kinds of campaigns; a kind is its own file or folder, and one line here."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from importlib import import_module

from meso_robust.campaigns.kind import Kind

KINDS: Mapping[str, str] = {
    "monte-carlo": "monte_carlo.MONTE_CARLO",
    "falsify": "falsify.kind.FALSIFY",
    "property": "property.kind.PROPERTY",
    "mutation": "mutation.kind.MUTATION",
    "blind": "blind.kind.BLIND",
}
"""Where each is, below this package. Imported when asked for: a worker needs but one of them."""


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
    module, value = KINDS[name].rsplit(".", 1)
    found: Kind = getattr(import_module(f"{__package__}.{module}"), value)
    return found
