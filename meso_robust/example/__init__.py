"""The example of the tutorial: a laboratory's task, its videos of pushes, its calibration grid.

The videos are drawn by the synthetic microscope from motion that a generator of its own makes
(``reports/example``); the true parameters are not given here.
"""

from __future__ import annotations

import shutil
import tempfile
from pathlib import Path

from meso_robust.errors import InputError
from meso_robust.files import check_folder, why
from meso_robust.guide import FOR_USERS, GUIDE
from meso_robust.tasks import PAPER

EXAMPLE = Path(__file__).parent
"""Folder of the shipped files."""
FILES = ("task.toml", "grid.png", "videos")
"""What of it is the laboratory's."""


def copy_example(folder: Path) -> None:
    """Copy the guide, the example and all shipped tasks into a new folder, whole or not at all.

    Parameters
    ----------
    folder
        Made; its parents too.

    Raises
    ------
    InputError
        It already exists and is not empty, or cannot be written.
    """
    try:
        if folder.exists() and (not folder.is_dir() or any(folder.iterdir())):
            raise InputError(
                f"{folder}: already exists; refusing to overwrite it; give a new folder"
            )
        target = folder.resolve()
        check_folder(target, option="")
        target.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(dir=target.parent, prefix=".", suffix=".part") as scratch:
            draft = Path(scratch) / "example"
            _fill(draft)
            if target.exists():
                target.rmdir()
            draft.rename(target)
    except InputError:
        raise
    except (OSError, ValueError, RuntimeError) as error:  # a name with a NUL, a link to itself
        raise InputError(
            f"{folder}: cannot be written ({why(error)}); give a writable folder"
        ) from error


def _fill(folder: Path) -> None:
    (folder / "tasks").mkdir(parents=True)
    for page in FOR_USERS:
        shutil.copyfile(GUIDE / page, folder / page)
    for name in FILES:
        source = EXAMPLE / name
        (shutil.copytree if source.is_dir() else shutil.copyfile)(source, folder / name)
    for task in sorted(PAPER.parent.glob("*.toml")):
        shutil.copyfile(task, folder / "tasks" / task.name)
