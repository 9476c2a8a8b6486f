"""Files that users give: text, JSON and TOML, read as data within limits of size, depth and value.

A task, a plan or a recording may come from anybody. Nothing in it is run, and a file that is too large
or nested too deeply is refused before it can fill the memory or the stack.
"""

from __future__ import annotations

import json
import stat
import tomllib
from collections.abc import Iterable
from pathlib import Path
from typing import Annotated, Any

from pydantic import Field, FiniteFloat

from meso_robust.errors import InputError

MIB = 2**20
LARGEST_STATED = 4 * MIB
"""Bytes of a file that somebody writes by hand: task, set.toml, model.toml, campaign."""
LARGEST_DATA = 64 * MIB
"""Bytes of a file that a program writes: plan, policy, certificate, witness, table."""
DEEPEST = 64
"""Lists and sections within each other."""
LONGEST_SHOWN = 60
"""Characters of a wrong value in a message."""


# Numbers of documents that programs write. A limit is far beyond all that is written in earnest; it
# is there since nothing else may look at a number that no proof rests on.
Count = Annotated[int, Field(ge=0, le=10**15)]
Seed = Annotated[int, Field(ge=0, le=10**80)]
PaperStep = Annotated[int, Field(ge=1, le=4)]
"""Of the paper's algorithm."""
MoveNumber = Annotated[int, Field(ge=1, le=1000)]
Um = Annotated[FiniteFloat, Field(ge=-1e7, le=1e7)]
Distance = Annotated[FiniteFloat, Field(ge=0, le=1e7)]
"""um or deg"""
Deg = Annotated[FiniteFloat, Field(ge=-3600, le=3600)]
Percent = Annotated[FiniteFloat, Field(ge=0, le=100)]
Factor = Annotated[FiniteFloat, Field(ge=0, le=10)]
"""Of uncertainties; 0: of a plan that is not proved."""


def bytes_of(path: Path, advice: str, largest: int = LARGEST_DATA) -> bytes:
    """Content of a file.

    Parameters
    ----------
    path
        The file.
    advice
        What to give instead of one that cannot be read.
    largest
        Bytes that it may have.

    Raises
    ------
    InputError
        There is no such file, it is a folder or no file at all (a device, a pipe), it cannot be read,
        or it is too large.
    """
    try:
        if not stat.S_ISREG(path.stat().st_mode) and not path.is_dir():
            # of a pipe or a device nobody knows the size, and reading it may never end
            raise InputError(f"{path}: cannot be read (not a plain file); {advice}")
        with path.open("rb") as file:
            content = file.read(largest + 1)
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror}); {advice}") from error
    except ValueError as error:  # a name that no file can have
        raise InputError(f"{path}: cannot be read ({error}); {advice}") from error
    if len(content) > largest:
        raise InputError(
            f"{path}: is larger than {largest // MIB} MiB, the most that is read of such a file; "
            f"{advice}"
        )
    return content


def text_of(path: Path, advice: str, form: str, largest: int = LARGEST_DATA) -> str:
    """Text of a file in UTF-8, without the mark that some editors begin it with.

    Parameters
    ----------
    path, advice, largest
        As for :func:`bytes_of`.
    form
        What the file should be, such as "a JSON file".

    Raises
    ------
    InputError
        As for :func:`bytes_of`, or the file is not in UTF-8.
    """
    try:
        return bytes_of(path, advice, largest).decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise InputError(f"{path}: is not {form} in UTF-8 ({error}); {advice}") from error


def json_values(text: str, source: str) -> Any:
    """Values of a JSON text; ``source`` names it in messages.

    Raises
    ------
    InputError
        The text is not JSON, gives a key twice in one place, or is nested too deeply.
    """
    try:
        values = json.loads(text, object_pairs_hook=each_once)
        _check_depth(values)
    except (ValueError, RecursionError) as error:
        raise InputError(
            f"{source}: is not a JSON file in UTF-8 ({error}); write it anew or mend it"
        ) from error
    return values


def toml_values(text: str, source: str) -> dict[str, Any]:
    """Values of a TOML text; ``source`` names it in messages.

    Raises
    ------
    InputError
        The text is not TOML, has a number too long for Python, or is nested too deeply.
    """
    try:
        values = tomllib.loads(text)
        _check_depth(values)
    except (ValueError, RecursionError) as error:
        raise InputError(
            f"{source}: is not a TOML file in UTF-8 ({error}); mend the place"
        ) from error
    return values


def shown(value: object) -> str:
    """A wrong value as a message shows it, cut where it is long."""
    text = repr(value)
    return text if len(text) <= LONGEST_SHOWN else f"{text[:LONGEST_SHOWN]}…"


def each_once(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    """The section that JSON gives as pairs.

    Raises
    ------
    ValueError
        A key is given twice.
    """
    found = dict(pairs)
    if len(found) < len(pairs):
        names = [name for name, _ in pairs]
        twice = next(name for name in names if names.count(name) > 1)
        raise ValueError(f"key {twice} is given twice; give it once")
    return found


def _check_depth(values: Any) -> None:
    """Refuse values that are nested too deeply, level by level: recursion is what must not happen."""
    level = [values]
    for _ in range(DEEPEST):
        level = [inner for value in level for inner in _within(value)]
        if not level:
            return
    raise ValueError(f"lists or sections are nested more than {DEEPEST} deep")


def _within(value: Any) -> Iterable[Any]:
    """The lists and sections that lie directly in one."""
    inner = value.values() if isinstance(value, dict) else value if isinstance(value, list) else ()
    return (one for one in inner if isinstance(one, dict | list))
