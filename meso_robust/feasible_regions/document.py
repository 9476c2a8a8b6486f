"""``admissible.json``: the maps as lists of cells with exact ends."""

from __future__ import annotations

import json
from collections.abc import Sequence

from meso_robust.bounds import Interval
from meso_robust.feasible_regions.maps import Map
from meso_robust.feasible_regions.paving import Axis, Region
from meso_robust.task import Task

SCHEMA = "meso-robust/admissible/1"
MEANING = {
    Region.CERTIFIED.name: "every point of the cell succeeds for all uncertainties",
    Region.IMPOSSIBLE.name: "at every point some admissible value of the uncertainties breaks it",
    Region.UNDECIDED.name: "nothing is proved",
}


def document(task: Task, maps: Sequence[Map]) -> str:
    """All maps of a task as JSON text.

    Parameters
    ----------
    task, maps
        The task, and its maps.

    Returns
    -------
    str
        A cell is its region and four numbers of edges (first and last across, first and last up); the
        edges are hexadecimal doubles in m or rad, so neighbours share them exactly.
    """
    body = {
        "schema": SCHEMA,
        "task": task.name,
        "task_hash": task.hash,
        "regions": MEANING,
        "maps": [_map(found) for found in maps],
    }
    return json.dumps(body) + "\n"


def _map(found: Map) -> dict[str, object]:
    paving = found.paving
    return {
        "primitive": found.primitive,
        "move": found.step,
        "across": _axis(paving.across, paving.count, found.plan[0]),
        "up": _axis(paving.up, paving.count, found.plan[1]),
        "share": {region.name: paving.share(region) for region in Region},
        "cells": [
            [Region(int(region)).name, *map(int, cell)]
            for region, cell in zip(paving.regions, paving.cells, strict=True)
        ],
    }


def _axis(axis: Axis, count: int, plan: Interval) -> dict[str, object]:
    return {
        "name": axis.name,
        "unit": "m" if axis.unit == "um" else "rad",
        "edges": [float(edge).hex() for edge in axis.edges(count)],
        "plan": [plan.lo.hex(), plan.hi.hex()],
    }
