"""A run that breaks something, as files that ``meso-robust simulate`` replays number for number."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from meso_robust.errors import InputError
from meso_robust.laboratory.engines import Engine
from meso_robust.laboratory.replay import Player, limits
from meso_robust.laboratory.witness_form import SCHEMA as SCHEMA, WitnessFile as WitnessFile
from meso_robust.planning.document import PlanDocument
from meso_robust.task import Task
from meso_robust.toml_files import toml_text
from meso_robust.types import Floats


def replay_files(
    task: Task,
    plan: PlanDocument,
    player: Player,
    row: Floats,
    *,
    factor: float,
    engine: Engine,
    breaks: Sequence[str],
) -> dict[str, str]:
    """Everything that replaying a run takes.

    Parameters
    ----------
    task, plan, player
        The task, the plan, and the same made ready to be run.
    row
        (D,) what is uncertain, in the order of ``player.columns``, SI.
    factor
        Of all uncertainties.
    engine
        That made the run.
    breaks
        What it breaks, in words.

    Returns
    -------
    dict
        Contents of ``task.toml``, ``plan.json`` and ``witness.json``.
    """
    witness = WitnessFile(
        task_hash=plan.task_hash,
        plan_hash=plan.hash,
        factor=factor,
        engine=engine,
        breaks=tuple(breaks),
        row={c.name: float(value).hex() for c, value in zip(player.columns, row, strict=True)},
    )
    return {
        "task.toml": toml_text(task.model_dump(mode="json", by_alias=True, exclude_none=True)),
        "plan.json": plan.model_dump_json(by_alias=True, indent=2) + "\n",
        "witness.json": witness.model_dump_json(by_alias=True, indent=2) + "\n",
    }


def row_of(found: WitnessFile, bounds: Player, source: str) -> Floats:
    """(1, D) the run.

    Parameters
    ----------
    found
        As read.
    bounds
        The plan with the uncertainties that the run must keep.
    source
        Names the file in messages.

    Raises
    ------
    InputError
        A name is missing or unknown, a number is not a finite double, or lies outside its bounds.
    """
    names = [column.name for column in bounds.columns]
    for name in sorted({*names} ^ {*found.row}):
        what = "unknown" if name in found.row else "missing"
        raise InputError(f"{source}: key row.{name} is {what}; must be {', '.join(names)}")
    row = np.array([hex_double(found.row[name], f"{source}: key row.{name}") for name in names])
    low, high = limits(bounds)
    for k in np.flatnonzero(~((low <= row) & (row <= high)))[:1]:
        raise InputError(
            f"{source}: key row.{names[k]} = {row[k]:g}: must lie within [{low[k]:g}, {high[k]:g}], "
            f"the task's uncertainties x {found.factor:g}"
        )
    return row[None]


def hex_double(text: str, key: str) -> float:
    """A finite double from its hexadecimal form; ``key`` names it in messages.

    Raises
    ------
    InputError
        It is none.
    """
    try:
        found = float.fromhex(text)
    except (ValueError, OverflowError):
        found = math.nan
    if not math.isfinite(found):
        raise InputError(f"{key} = {text!r}: must be a finite double in hexadecimal (float.hex)")
    return found
