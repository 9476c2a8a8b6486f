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
    try:
        folder.mkdir(parents=True, exist_ok=True)
        drafts = {name: _draft(folder, text) for name, text in contents.items()}
        for name, draft in drafts.items():
            os.replace(draft, folder / name)
    except OSError as error:
        raise InputError(
            f"--out {folder}: cannot be written ({error.strerror}); give a folder that can"
        ) from error


def _draft(folder: Path, text: str) -> str:
    with tempfile.NamedTemporaryFile(
        "w", encoding="utf-8", dir=folder, prefix=".", suffix=".part", delete=False
    ) as file:
        file.write(text)
    os.chmod(file.name, 0o644)
    return file.name


def check_folder(folder: Path) -> None:
    """Refuse a result folder that cannot be one, before any work is done.

    Raises
    ------
    InputError
        If ``folder`` exists and is not a folder, or cannot be written to.
    """
    nearest = next(path for path in (folder, *folder.resolve().parents) if path.exists())
    if not nearest.is_dir() or not os.access(nearest, os.W_OK):
        raise InputError(f"--out {folder}: {nearest} is not a writable folder; give another one")
