"""All items by name, in the order of the paper: one line each."""

from __future__ import annotations

import importlib
from collections.abc import Mapping, Sequence

from meso_robust.errors import InputError
from meso_robust.reproduction.item import Item

ITEMS: Mapping[str, str] = {
    "tests": "manipulation_tests",
    "sensitivity": "sensitivity",
    "table-1": "table_one",
    "rrt": "rrt_baseline",
    "scripted": "scripted",
    "table-2": "printed_lengths",
    "robust-motion": "robust_motion",
    "tables-3-5": "primitives_tables",
    "planned-task": "planned_task",
    "comparison": "comparison",
    "uncertainties": "uncertainties",
    "scales": "scales",
}
"""Name of an item, and its module in this package."""


def item(name: str) -> Item:
    """An item; its module is loaded only now.

    Raises
    ------
    InputError
        If there is none of this name.
    """
    if name not in ITEMS:
        raise InputError(f"ITEM: {name!r}; must be one of {', '.join(ITEMS)}, or none for all")
    found: Item = importlib.import_module(f"{__package__}.{ITEMS[name]}").ITEM
    return found


def asked(name: str | None) -> Sequence[str]:
    """Names of the items that are asked for: one, or all.

    Raises
    ------
    InputError
        If there is none of this name.
    """
    if name is None:
        return tuple(ITEMS)
    item(name)
    return (name,)
