"""What callers give: tasks and files by value or by name, and numbers that have a least value."""

from __future__ import annotations

from numbers import Integral
from os import PathLike
from pathlib import Path
from typing import TypeAlias

from meso_robust.errors import InputError
from meso_robust.task import Task

StrPath: TypeAlias = str | PathLike[str]


def task_of(task: Task | StrPath) -> Task:
    """A task, read if it is named.

    Raises
    ------
    InputError
        The file cannot be read, or a value breaks a rule.
    """
    return task if isinstance(task, Task) else Task.load(task)


def path_of(path: StrPath | None) -> Path | None:
    """The path, if there is one."""
    return None if path is None else Path(path)


def files_of(*given: object) -> tuple[Path, ...]:
    """Those of what is given that are files by their names."""
    return tuple(Path(one) for one in given if isinstance(one, str | PathLike))


def at_least(least: int, **numbers: int) -> None:
    """Refuse a number below ``least``.

    Raises
    ------
    InputError
        There is one, or it is not a whole number.
    """
    for name, value in numbers.items():
        if not isinstance(value, Integral):
            raise InputError(f"{name} = {value!r}: must be a whole number; give {least} or more")
        if value < least:
            raise InputError(f"{name} = {value}: must be at least {least}; give a larger number")


def within(least: int, most: int, **numbers: int) -> None:
    """Refuse a number below ``least`` or above ``most``.

    Raises
    ------
    InputError
        There is one, or it is not a whole number.
    """
    at_least(least, **numbers)
    for name, value in numbers.items():
        if value > most:
            raise InputError(f"{name} = {value}: must be at most {most:,}; give a smaller number")


def keep_apart(folder: Path, source: Path | None) -> None:
    """Refuse to write results over what they come from.

    Raises
    ------
    InputError
        Both are one folder.
    """
    if source is not None and folder.resolve() == source.resolve():
        raise InputError(f"--out {folder}: is the folder of the recordings; give another folder")
