"""A witness read back number for number: of a REFUTED certificate, or a file of its own."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from pydantic import BaseModel, ValidationError

from meso_robust.bounds import VerdictWord
from meso_robust.certificates.document import CertificateDocument, WitnessDocument
from meso_robust.errors import InputError
from meso_robust.laboratory.draws import nominal
from meso_robust.laboratory.engines import Engine
from meso_robust.laboratory.replay import Feedback, Player, limits
from meso_robust.laboratory.witness_file import hex_double, row_of
from meso_robust.laboratory.witness_form import WitnessFile, parse_witness
from meso_robust.planning.document import PlanDocument, RuleDocument
from meso_robust.planning.reading import first_of, read_text
from meso_robust.primitives.setup import setup_of
from meso_robust.task import Task
from meso_robust.types import Floats

_OWN = ("start", "friction", "film_ratio", "misalignment", "sensing", "dual", "single")
"""Fields of draws that have keys of their own in a certificate's witness."""
ROUNDING = 1e-15  # m and rad; of the first sensing error, which follows from the start


_ONE = "meso-robust/certificate/1"


class _CertificateOne(BaseModel):
    """What a replay takes from a certificate of schema 1; `check` reads all of it."""

    task_hash: str
    policy: tuple[RuleDocument, ...]
    verdict: VerdictWord
    witness: WitnessDocument | None


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Witness:
    """A run to be replayed."""

    row: Floats
    """(1, D) in the order of the player's columns."""
    engine: Engine = "stepper"
    """That made it."""
    breaks: tuple[str, ...] = ()
    """What it is said to break."""
    factor: float = 1.0
    """Of all uncertainties; scaling may round their middles."""


def read_witness(path: Path, task: Task, plan: PlanDocument, player: Player) -> Witness:
    """Read a witness for this task and plan: ``witness.json``, or a certificate that has one.

    Parameters
    ----------
    path
        The file.
    task, plan, player
        What it must be about.

    Returns
    -------
    Witness
        The run, to the last bit, and the engine that made it.

    Raises
    ------
    InputError
        The file cannot be read, breaks a rule, is about another task or plan, is a certificate that
        is not REFUTED, or its run lies outside the bounds it must keep.
    """
    text = read_text(path)
    found = parse_witness(text, str(path))
    if found is not None:
        return _of_a_file(found, str(path), task, plan, player)
    return _of_a_certificate(text, str(path), task, plan, player)


def _of_a_file(
    found: WitnessFile, path: str, task: Task, plan: PlanDocument, player: Player
) -> Witness:
    _check_task(found.task_hash, path, task, "witness")
    if found.plan_hash != plan.hash:
        raise InputError(
            f"{path}: key plan_hash = {found.plan_hash!r}: must be the hash of the plan; give "
            "the plan next to the witness"
        )
    scaled = replace(player, setup=setup_of(task, found.factor))  # type: ignore[type-var]
    return Witness(
        row=row_of(found, scaled, path),
        engine=found.engine,
        breaks=found.breaks,
        factor=found.factor,
    )


def _check_task(found: str, path: str, task: Task, what: str) -> None:
    if found != task.hash:
        raise InputError(
            f"{path}: key task_hash = {found!r}: must be the hash {task.hash!r} of the task; give "
            f"the {what} of this task"
        )


def _of_a_certificate(
    text: str, path: str, task: Task, plan: PlanDocument, player: Player
) -> Witness:
    model = _CertificateOne if json.loads(text).get("schema") == _ONE else CertificateDocument
    try:
        found = model.model_validate_json(text, strict=True)
    except ValidationError as error:
        raise InputError(
            f"{path}: {first_of(error, CertificateDocument, 'certificate')}"
        ) from error
    _check_task(found.task_hash, path, task, "certificate")
    if found.policy != plan.policy or not isinstance(player, Feedback):
        raise InputError(
            f"{path}: key policy: must be the policy of the plan; give the certificate of this plan"
        )
    if found.verdict != "REFUTED" or found.witness is None:
        raise InputError(
            f"{path}: key verdict = {found.verdict!r}: must be 'REFUTED' with a witness; only such "
            "a certificate holds a run to replay"
        )
    return Witness(row=witness_row(found.witness, player, path), breaks=(found.witness.outcome,))


def more_of(player: Feedback, row: Floats) -> dict[str, str]:
    """What a certificate holds of a run beside what has a key of its own there.

    Parameters
    ----------
    player
        The plan.
    row
        (D,) the run, in the order of the player's columns, SI.

    Returns
    -------
    dict
        Hexadecimal doubles by the names of the columns.
    """
    slots = zip(player.slots, row, strict=True)
    return {one.column.name: float(value).hex() for one, value in slots if one.field not in _OWN}


def witness_row(witness: WitnessDocument, player: Feedback, source: str) -> Floats:
    """The run of a certificate's witness.

    Parameters
    ----------
    witness, player
        The witness, and the plan it belongs to.
    source
        Names the certificate in messages.

    Returns
    -------
    Floats
        (1, D) in the order of the player's columns, SI.

    Raises
    ------
    InputError
        A number is not a finite hexadecimal double, there are not as many as moves, or one lies
        outside its bounds (then it would break nothing that was claimed).
    """
    moves = len(player.rules)
    stated = nominal(player.setup, moves)
    draws = replace(
        stated,
        start=_numbers([witness.start], f"{source}: key witness.start"),
        friction=_numbers([[witness.friction]], f"{source}: key witness.friction")[0],
        film_ratio=_numbers([[witness.film_ratio_m2]], f"{source}: key witness.film_ratio_m2")[0],
        misalignment=_numbers(
            [[witness.misalignment_rad]], f"{source}: key witness.misalignment_rad"
        )[0],
        sensing=_per_move(witness.sensing, moves, f"{source}: key witness.sensing"),
        dual=_per_move(witness.dual_probe, moves, f"{source}: key witness.dual_probe"),
        single=_per_move(witness.single_probe, moves, f"{source}: key witness.single_probe"),
    )
    row = player.rows_of(draws)
    others = {s.column.name: k for k, s in enumerate(player.slots) if s.field not in _OWN}
    for name in sorted({*others} ^ {*witness.more}):
        what = "unknown: the task leaves nothing of that name open"
        if name in others:
            what = "missing: the task leaves it open"
        raise InputError(
            f"{source}: key witness.more.{name} is {what}; plan the task again, or give a witness.json"
        )
    for name, k in others.items():
        row[0, k] = hex_double(witness.more[name], f"{source}: key witness.more.{name}")
    _check_bounds(row[0], player, source)
    implied = np.array(player.setup.start.mid) - draws.start[0]
    if not np.abs(draws.sensing[0, 0] - implied).max() <= ROUNDING:
        raise InputError(
            f"{source}: key witness.sensing.0 = {list(witness.sensing[0])}: must be the task's start "
            "minus witness.start, as the first pose is sensed as the task states it"
        )
    return row


def _check_bounds(row: Floats, player: Feedback, source: str) -> None:
    low, high = limits(player)
    outside = np.flatnonzero(~((low <= row) & (row <= high)))
    if outside.size:
        column = player.columns[int(outside[0])]
        raise InputError(
            f"{source}: key witness: {column.name} = {row[outside[0]]:g}; must lie within "
            f"[{column.low:g}, {column.high:g}], the bounds of the task"
        )


def _per_move(values: Sequence[Sequence[str]], moves: int, key: str) -> Floats:
    if len(values) != moves:
        raise InputError(f"{key}: {len(values)} entries; must be {moves}, one for each move")
    return _numbers(values, key)[None]


def _numbers(values: Sequence[Sequence[str]], key: str) -> Floats:
    return np.array([[hex_double(value, key) for value in row] for row in values])
