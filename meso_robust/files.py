"""Writing results so that a killed run leaves no half file."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterable, Mapping
from pathlib import Path

from meso_robust.errors import InputError


def write_all(
    folder: Path, contents: Mapping[str, str], inputs: Iterable[Path | None] = ()
) -> None:
    """Write all files into ``folder`` (made if needed), each under a temporary name and renamed.

    Parameters
    ----------
    folder
        Where to.
    contents
        Texts by the names of their files, which may lie in folders below.
    inputs
        Files that are not to be replaced.

    Raises
    ------
    InputError
        If the folder or a file cannot be written, or one would replace an input; then none is.
    """
    check_folder(folder, contents, inputs)
    drafts: dict[str, str] = {}
    try:
        for name, text in contents.items():
            (folder / name).parent.mkdir(parents=True, exist_ok=True)
            drafts[name] = _draft((folder / name).parent, text)
        for name in contents:
            os.replace(drafts[name], folder / name)
            del drafts[name]
    except OSError as error:
        raise InputError(
            f"--out {folder}: cannot be written ({error.strerror}); give a writable folder"
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


def check_folder(
    folder: Path,
    written: Iterable[str] = (),
    inputs: Iterable[Path | None] = (),
    option: str = "--out ",
) -> None:
    """Refuse a result folder that cannot be one, before any work is done.

    Parameters
    ----------
    folder
        For the results; it need not be there.
    written
        Names of the files that will be written into it.
    inputs
        Files that the results come from.
    option
        What the folder is given by, for messages.

    Raises
    ------
    InputError
        If ``folder`` is not a folder, or cannot be one, or cannot be written to; if a result would
        replace an input, or has the name of a folder.
    """
    try:
        nearest = _nearest(folder)
    except (OSError, ValueError) as error:  # too long, or with a NUL
        raise InputError(
            f"{option}{folder}: cannot be a folder ({why(error)}); give another one"
        ) from error
    try:
        # tried, not asked: for an administrator every folder is said to be writable
        with tempfile.TemporaryDirectory(prefix=".", dir=nearest):
            pass
    except OSError as error:
        raise InputError(
            f"{option}{folder}: {nearest} is not a writable folder ({error.strerror}); "
            "give another one"
        ) from error
    sources = [source for source in inputs if source is not None]
    for name in written:
        _check_target(folder, name, sources)


def _nearest(folder: Path) -> Path:
    """The folder, or the first above it that is there."""
    way = (folder, *folder.absolute().parents)
    known = next(k for k, path in enumerate(way) if _is_there(path))
    for path in way[:known]:  # each name below must be one that a folder can have
        _is_there(way[known] / path.name)
    return way[known]


def _is_there(path: Path) -> bool:
    """Whether there is anything of this name, be it a link that leads nowhere."""
    try:
        path.lstat()
    except (FileNotFoundError, NotADirectoryError, PermissionError):
        return False
    return True


def _check_target(folder: Path, name: str, inputs: Iterable[Path]) -> None:
    """Refuse a result that would replace an input, or a folder."""
    target = folder / name
    if os.path.isdir(target) and not target.is_symlink():
        raise InputError(
            f"--out {folder}: {name} is a folder, but a file of that name must be written; "
            "give another folder"
        )
    for source in inputs:
        if os.path.exists(target) and os.path.exists(source) and target.samefile(source):
            raise InputError(
                f"--out {folder}: {name} would replace {source}, which must not be overwritten; "
                "give another folder"
            )


def why(error: Exception) -> str:
    """The reason in an error, without the name of the file.

    Parameters
    ----------
    error
        The outcome of writing or reading a file.

    Returns
    -------
    str
        In the words of the system.
    """
    return getattr(error, "strerror", None) or str(error)
