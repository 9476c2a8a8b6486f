"""What callers give by value or by name: tasks, files and folders."""

from __future__ import annotations

from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING

from meso_robust.api.options import StrPath
from meso_robust.errors import InputError

if TYPE_CHECKING:
    from meso_robust.task import Task


def task_of(task: Task | StrPath) -> Task:
    """A task, read if it is named.

    Raises
    ------
    InputError
        The file cannot be read, or a value breaks a rule.
    """
    from meso_robust.task import load_task

    return load_task(Path(task)) if isinstance(task, str | PathLike) else task


def path_of(path: StrPath | None) -> Path | None:
    """The path, if there is one."""
    return None if path is None else Path(path)


def files_of(*given: object) -> tuple[Path, ...]:
    """Those of what is given that are files by their names."""
    return tuple(Path(one) for one in given if isinstance(one, str | PathLike))


def keep_apart(folder: Path, source: Path | None) -> None:
    """Refuse to write results over what they come from.

    Parameters
    ----------
    folder
        For the results.
    source
        The recordings; None if they come from no folder.

    Raises
    ------
    InputError
        Both are one folder.
    """
    if source is not None and folder.resolve() == source.resolve():
        raise InputError(f"--out {folder}: is the folder of the recordings; give another folder")
