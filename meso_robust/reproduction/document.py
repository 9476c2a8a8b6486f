"""``reproduction.json``: every item with its rows, for other programs."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass

from meso_robust import __version__
from meso_robust.reproduction.item import Found, Item, Row, Setting

SCHEMA = "meso-robust/reproduction/1"


@dataclass(frozen=True, slots=True, kw_only=True)
class Made:
    """An item that was made again.

    Attributes
    ----------
    name, item, found
        What was asked for, and what came of it.
    seconds
        That it took.
    """

    name: str
    item: Item
    found: Found
    seconds: float


def document(made: Mapping[str, Made], setting: Setting) -> dict[str, object]:
    """The document of some items, plain values only.

    Parameters
    ----------
    made, setting
        The items by name, and what they were made with.

    Returns
    -------
    dict
        Numbers, texts, lists and mappings; see `SCHEMA`.
    """
    return {
        "schema": SCHEMA,
        "meso_robust": __version__,
        "seed": setting.seed,
        "quick": setting.quick,
        "items": {name: _item(one) for name, one in made.items()},
    }


def text(values: Mapping[str, object]) -> str:
    """The document as it is written; a number that is not finite is refused by `json`.

    Parameters
    ----------
    values
        Of `document`.

    Returns
    -------
    str
        JSON.
    """
    return json.dumps(values, indent=2, ensure_ascii=False, allow_nan=False) + "\n"


def _item(made: Made) -> dict[str, object]:
    return {
        "title": made.item.title,
        "where": made.item.where,
        "answer": made.found.answer,
        "missing": list(made.found.missing),
        "rows": [_row(row) for row in made.found.rows],
        "data": _plain(made.found.data),
        "seconds": round(made.seconds, 2),
    }


def _plain(value: object) -> object:
    """Data as JSON can hold it; a number that does not exist, such as of a run that jams, is null."""
    if isinstance(value, Mapping):
        return {str(key): _plain(one) for key, one in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(one) for one in value]
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value


def _row(row: Row) -> dict[str, object]:
    agreement = row.agreement
    return asdict(row) | {
        "difference": row.difference,
        "agreement": None if agreement is None else agreement.name.lower(),
    }
