"""``plan.json`` read back, checked against the task it was made for."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from pydantic import BaseModel, ValidationError

from meso_robust.errors import InputError
from meso_robust.planning.plan_file import MoveDocument, PlanDocument, RuleDocument
from meso_robust.reading import first_fault, json_values, text_of
from meso_robust.task import Task
from meso_robust.wording import counted

LARGEST_UM = 1e6  # as for the coordinates of a task: catches a slip of the unit
MOST_MOVES = 1000  # of a file that may come from anybody; plans have a handful
MOST_PROBES = 6  # of one move, as many as the simulator takes


def read_plan(path: Path, task: Task) -> PlanDocument:
    """Read a plan and check that it was made for a task.

    Parameters
    ----------
    path
        The file.
    task
        What the plan must have been made for.

    Returns
    -------
    PlanDocument
        Every value within its rule.

    Raises
    ------
    InputError
        The file cannot be read, is not JSON, a value breaks a rule, or the plan was made for
        another task; the message names file, key, value and rule.
    """
    text = read_text(path)
    try:
        plan = PlanDocument.model_validate_json(text, strict=True)
    except ValidationError as error:
        raise InputError(f"{path}: {first_of(error, PlanDocument, 'plan')}") from error
    if "schema" not in json.loads(text):
        raise InputError(f"{path}: key schema is missing; `meso-robust schema plan` lists all keys")
    return _accepted(plan, str(path), task)


def accepted_plan(plan: PlanDocument, source: str, task: Task) -> PlanDocument:
    """A plan that is no file, checked like one: pydantic's copies can hold values that break a rule.

    Parameters
    ----------
    plan
        The plan.
    source
        Names it in messages.
    task
        What the plan must have been made for.

    Returns
    -------
    PlanDocument
        Every value within its rule.

    Raises
    ------
    InputError
        A value breaks a rule, or the plan was made for another task.
    """
    try:
        values = plan.model_dump(by_alias=True, warnings=False)
        return _accepted(PlanDocument.model_validate(values, strict=True), source, task)
    except ValidationError as error:
        raise InputError(f"{source}: {first_of(error, PlanDocument, 'plan')}") from error


def _accepted(plan: PlanDocument, source: str, task: Task) -> PlanDocument:
    """The plan, if it keeps the rules that its types do not have, and was made for the task."""
    wrong = next(_wrong(plan), None)
    if wrong is not None:
        raise InputError(f"{source}: key {wrong}")
    if plan.task_hash != task.hash:
        raise InputError(
            f"{source}: key task_hash = {plan.task_hash!r}: must be the hash {task.hash!r} of the "
            f"task; the plan was made for another task ({plan.task!r}), plan again for this task"
        )
    wrong = next(wrong_headings(plan.policy, task, "policy"), None)
    if wrong is not None:
        raise InputError(f"{source}: key {wrong}")
    return plan


def read_text(path: Path) -> str:
    """Text of a JSON file in UTF-8.

    Parameters
    ----------
    path
        The file.

    Returns
    -------
    str
        JSON that gives no key twice in one place.

    Raises
    ------
    InputError
        The file cannot be read or is not JSON.
    """
    text = text_of(path, "give a JSON file", "a JSON file")
    json_values(text, str(path))
    return text


def first_of(error: ValidationError, model: type[BaseModel], document: str) -> str:
    """The first thing that is wrong with a document.

    Parameters
    ----------
    error
        Everything that is wrong.
    model
        What it was checked against.
    document
        Its name for ``meso-robust schema``.

    Returns
    -------
    str
        Key, value, rule and advice.
    """
    keys = f"`meso-robust schema {document}`"
    return first_fault(error, model, whole=document, keys=keys)


def _wrong(plan: PlanDocument) -> Iterator[str]:
    """What is wrong with a plan beyond its types: key, value, rule and advice."""
    yield from _wrong_numbers(plan.model_dump(), "")
    for key, found in (("policy", plan.policy), ("moves", plan.moves)):
        if len(found) > MOST_MOVES:
            yield f"{key}: {len(found)} of them; must be at most {MOST_MOVES}; split the plan"
    if not plan.policy and not plan.moves:
        yield "moves = []: must contain a move, because there is no policy"
    if plan.policy and len(plan.moves) != len(plan.policy):
        yield (
            f"moves: {counted(len(plan.moves), 'move')}; must be {len(plan.policy)}, one for each rule of "
            "policy; leave policy empty for an open-loop plan"
        )
    yield from wrong_rules(plan.policy, "policy")
    for k, move in enumerate(plan.moves):
        yield from _wrong_move(move, f"moves.{k}")


def wrong_rules(rules: Sequence[RuleDocument], key: str) -> Iterator[str]:
    """What is wrong with rules beyond their types.

    Parameters
    ----------
    rules
        The moves of a policy.
    key
        Below which they stand in their file.

    Returns
    -------
    Iterator
        Key, value and rule of each fault.
    """
    for k, rule in enumerate(rules):
        yield from _wrong_numbers(rule.model_dump(), f"{key}.{k}")
        yield from _wrong_rule(rule, f"{key}.{k}")


def wrong_headings(rules: Sequence[RuleDocument], task: Task, key: str) -> Iterator[str]:
    """Which rules push in a direction that the task has no probe for.

    Parameters
    ----------
    rules, task
        The moves of a policy, and its task.
    key
        Below which they stand in their file.

    Returns
    -------
    Iterator
        Key, value and rule of each fault.
    """
    stated = task.probe.headings
    for k, rule in enumerate(rules):
        if stated is not None and rule.heading not in stated:
            yield (
                f"{key}.{k}.heading = {rule.heading!r}: must be one of {list(stated)}, the task's "
                "probe.headings; plan the task again, or add a probe that pushes that way"
            )


def _wrong_numbers(values: Any, inside: str) -> Iterator[str]:
    for key, value in _numbers(values, inside):
        if not math.isfinite(value):
            yield f"{key} = {value}: must be finite"
        elif "_um" in key and not abs(value) <= LARGEST_UM:
            yield f"{key} = {value}: must lie within {LARGEST_UM:g}; give lengths in um"


def _numbers(value: Any, key: str) -> Iterator[tuple[str, float]]:
    """Key and value of every number of a document."""
    if isinstance(value, float):
        yield key, value
    elif isinstance(value, dict | tuple):
        items = value.items() if isinstance(value, dict) else enumerate(value)
        for name, item in items:
            yield from _numbers(item, f"{key}.{name}" if key else str(name))


def _wrong_rule(rule: RuleDocument, key: str) -> Iterator[str]:
    if (rule.single_x is None) != (rule.single_y is None):
        absent = "single_x" if rule.single_x is None else "single_y"
        yield f"{key}.{absent} = null: must be given with the other one, or both null"
    yield from _wrong_for_action(rule, key)


def _wrong_for_action(rule: RuleDocument, key: str) -> Iterator[str]:
    """What the certified motion of the rule's action is not made for."""
    sides = {"tilt": (-1, 1), "rotate": (1,)}.get(rule.action, (0,))
    if rule.side not in sides:
        yield f"{key}.side = {rule.side}: must be one of {list(sides)} for action {rule.action!r}"
    if (rule.single_x is not None) != (rule.action == "rotate"):
        yield f"{key}.single_x: action {rule.action!r} needs it for a rotation, and null otherwise"
    elif rule.single_x is not None and rule.single_x.relative_to != rule.dual_end_x.relative_to:
        yield (
            f"{key}.single_x.relative_to = {rule.single_x.relative_to!r}: must be that of dual_end_x, "
            f"{rule.dual_end_x.relative_to!r}, since their distance decides how far the part turns"
        )


def _wrong_move(move: MoveDocument, key: str) -> Iterator[str]:
    names = [probe.name for probe in move.probes]
    if not 1 <= len(names) <= MOST_PROBES:
        yield f"{key}.probes: {counted(len(names), 'probe')}; must be 1 to {MOST_PROBES}"
    elif not all(names) or len(set(names)) < len(names):
        yield f"{key}.probes: names {names}; every probe must have its own name"
    elif all(probe.passive for probe in move.probes):
        yield f"{key}.probes: all are passive; at least one must travel"
    if not move.speed_um_s > 0.0:
        yield f"{key}.speed_um_s = {move.speed_um_s}: must be positive"
    if move.expect is not None:
        for name, (low, high) in move.expect.model_dump().items():
            if not low <= high:
                yield f"{key}.expect.{name} = {[low, high]}: the lower end must not exceed the upper"
