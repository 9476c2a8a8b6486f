"""Does the part come into the slot with real tips, and a real part? ``python -m reports.walls.real``

The shipped task of the slot with each key of `real_paper` by itself, and with several. ``--work FOLDER`` keeps
certificates, and goes on from those that are there.
"""

from __future__ import annotations

import argparse
import json
import tempfile
import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import meso_robust
from meso_robust.files import write_all
from meso_robust.task import Task, parse_task
from meso_robust.tasks import PAPER

SLOT = PAPER.with_name("slot.toml")
Keys = Mapping[str, Mapping[str, Any]]
REAL: Mapping[str, Keys] = {
    "tips of 2.5 to 12.5 um": {"probe": {"tip_radius_um": [2.5, 12.5]}},
    "size ± 2 um": {"part": {"size_tolerance_um": 2.0}},
    "squareness ± 0.1°": {"part": {"squareness_deg": 0.1}},
    "direction of travel ± 0.1°": {"uncertainty": {"travel_direction_deg": [-0.1, 0.1]}},
    "centre of drag ± 20 um": {"uncertainty": {"drag_centre_um": 20.0}},
    "anisotropy 5 %": {"uncertainty": {"drag_anisotropy_percent": 5.0}},
}
SEVERAL: Mapping[str, tuple[str, ...]] = {"all of these but the tips": tuple(list(REAL)[1:])}
SEARCH_S = 400.0
HEAD = """# Into the slot with real tips and a real part

From the paper's own start into its slot of 976 um, with the shipped task's tips of 12.5 um and all its errors, and in
addition what is named. Written by `python -m reports.walls.real`; a search gives up after {limit:.0f} s of computing.

| in addition | verdict | margin | binds first |
|---|---|---|---|
"""


def changed(keys: tuple[Keys, ...]) -> Task:
    """The slot's task with some keys set.

    Parameters
    ----------
    keys
        Values by section and name, in the units of a task file.
    """
    stated = tomllib.loads(SLOT.read_text(encoding="utf-8"))
    for one in keys:
        for section, values in one.items():
            stated[section].update(values)
    return parse_task(stated, SLOT.name)


def planned(name: str, task: Task, work: Path) -> Mapping[str, Any]:
    """The certificate of a task, found or kept."""
    kept = work / f"{name.replace(' ', '_')}.json"
    if not kept.exists():
        found = meso_robust.plan(task, search_s=SEARCH_S, samples=100)
        document = found.certificate.model_dump(mode="json", by_alias=True)
        write_all(work, {kept.name: json.dumps(document)})
    answer: Mapping[str, Any] = json.loads(kept.read_text(encoding="utf-8"))
    return answer


def row(name: str, certificate: Mapping[str, Any]) -> str:
    """One line of the table."""
    if certificate["verdict"] != "PROVED":
        return f"| {name} | no plan found | – | – |\n"
    margin = certificate["margin"]
    return f"| {name} | PROVED | {margin['factor']:.2f} × | `{margin['binds_first']}` |\n"


def main() -> None:
    """Plan, and write the page anew after each task."""
    parser = argparse.ArgumentParser(prog="python -m reports.walls.real", description=__doc__)
    parser.add_argument("--work", type=Path)
    given = parser.parse_args()
    with tempfile.TemporaryDirectory() as place:
        work, text = given.work or Path(place), HEAD.format(limit=SEARCH_S)
        asked = {"nothing": (), **{name: (name,) for name in REAL}, **SEVERAL}
        for name, keys in asked.items():
            text += row(name, planned(name, changed(tuple(REAL[key] for key in keys)), work))
            write_all(Path(__file__).parent, {"real.md": text})
            print(text.splitlines()[-1], flush=True)


if __name__ == "__main__":
    main()
