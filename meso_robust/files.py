"""Writing results so that a killed run leaves no half file."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Mapping
from pathlib import Path

from meso_robust.errors import InputError


def write_all(folder: Path, contents: Mapping[str, str]) -> None:
    """Write all files into ``folder`` (made if needed), each under a temporary name and renamed.

    Raises
    ------
    InputError
        If the folder or a file cannot be written.
    """
    drafts: dict[str, str] = {}
    try:
        folder.mkdir(parents=True, exist_ok=True)
        for name, text in contents.items():
            drafts[name] = _draft(folder, text)
        for name in contents:
            os.replace(drafts[name], folder / name)
            del drafts[name]
    except OSError as error:
        raise InputError(
            f"--out {folder}: cannot be written ({error.strerror}); give a folder that can"
        ) from error
    finally:
        for draft in drafts.values():  # a full disk and Ctrl-C leave no draft behind
            Path(draft).unlink(missing_ok=True)


def _draft(folder: Path, text: str) -> str:
    with tempfile.NamedTemporaryFile(
        "w", encoding="utf-8", dir=folder, prefix=".", suffix=".part", delete=False
    ) as file:
        try:
            file.write(text)
            file.flush()
            os.chmod(file.name, 0o644)
        except BaseException:
            Path(file.name).unlink()
            raise
    return file.name


def check_folder(folder: Path) -> None:
    """Refuse a result folder that cannot be one, before any work is done.

    Raises
    ------
    InputError
        If ``folder`` exists and is not a folder, or cannot be written to.
    """
    nearest = next(path for path in (folder, *folder.resolve().parents) if _exists(path))
    try:
        # tried, not asked: for an administrator every folder is said to be writable
        with tempfile.TemporaryDirectory(prefix=".", dir=nearest):
            return
    except OSError as error:
        raise InputError(
            f"--out {folder}: {nearest} is not a writable folder ({error.strerror}); give another one"
        ) from error


def _exists(path: Path) -> bool:
    try:
        return path.exists()
    except OSError:  # may not be looked at
        return False
