"""All items by name, in the order of the paper, and making them again."""

from __future__ import annotations

import importlib
import time
from collections.abc import Mapping, Sequence
from dataclasses import replace

from meso_robust.errors import InputError
from meso_robust.reproduction.document import Made
from meso_robust.reproduction.item import Item, Setting

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

    Parameters
    ----------
    name
        Of an item, or None for all.

    Returns
    -------
    sequence of str
        Names in the order of the paper.

    Raises
    ------
    InputError
        If there is none of this name.
    """
    if name is None:
        return tuple(ITEMS)
    item(name)
    return (name,)


def reproduced(names: Sequence[str], setting: Setting) -> dict[str, Made]:
    """The items of these names, in their order; each has the seed of the setting.

    Parameters
    ----------
    names
        Of items.
    setting
        Size, seed, and who is told of progress.

    Returns
    -------
    dict
        The outcome of each, in the same order.
    """
    made = {}
    for name in names:
        chosen = item(name)
        begun = time.perf_counter()

        def told(what: str, done: int, of: int, of_item: str = name) -> None:
            setting.told(f"{of_item}: {what}", done, of)

        told("begins", 0, 1)
        found = chosen.run(replace(setting, told=told))
        made[name] = Made(name=name, item=chosen, found=found, seconds=time.perf_counter() - begun)
    return made
