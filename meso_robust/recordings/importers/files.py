"""Finding and reading the files of a format."""

from __future__ import annotations

import gzip
import io
import zlib
from collections.abc import Callable, Sequence
from pathlib import Path

from meso_robust.errors import InputError
from meso_robust.reading import LARGEST_DATA, MIB, bytes_of


def files_of(path: Path, mine: Callable[[Path], bool], form: str) -> tuple[Path, ...]:
    """Files of one format: the file itself, or those in a folder, by name.

    Parameters
    ----------
    path
        A file or a folder; folders in the folder are not searched.
    mine
        Whether a file is of the format.
    form
        Description of the files for the message.

    Raises
    ------
    InputError
        If there is none.
    """
    found = tuple(file for file in candidates(path) if mine(file))
    if not found:
        raise InputError(
            f"{path}: no file of this format; must be a file or hold files such as {form}; "
            "give the folder of one part"
        )
    return found


def candidates(path: Path) -> tuple[Path, ...]:
    """The file itself or the files in a folder, by name; none if the path cannot be read."""
    try:
        found = [path] if path.is_file() else sorted(path.iterdir())
        return tuple(file for file in found if file.is_file())
    except OSError:
        return ()


def one_kind(path: Path, kinds: Sequence[str], what: str) -> str:
    """Take the one kind that all files share.

    Raises
    ------
    InputError
        If they differ: a set holds one part.
    """
    differing = sorted(set(kinds))
    if len(differing) > 1:
        raise InputError(
            f"{path}: {what} {', '.join(differing)}; a recording set holds one; "
            "put the files of each into a folder of its own"
        )
    return differing[0]


def text_of(file: Path) -> str:
    """Text of a file in UTF-8, plain or packed by gzip.

    Raises
    ------
    InputError
        If it cannot be read or unpacked.
    """
    data = bytes_of(file, "give a file that can be read")
    try:
        return (_unpacked(file, data) if file.suffix == ".gz" else data).decode("utf-8")
    except OSError as error:  # of gzip: not packed by it
        raise InputError(f"{file}: cannot be read ({error}); give a readable file") from error
    except (EOFError, zlib.error) as error:
        raise InputError(f"{file}: cannot be unpacked ({error}); download it again") from error
    except UnicodeDecodeError as error:
        raise InputError(f"{file}: is not text in UTF-8 ({error}); give a text file") from error


def _unpacked(file: Path, data: bytes) -> bytes:
    """What was packed, refused if it is too large: a small file can hold a very large one."""
    with gzip.GzipFile(fileobj=io.BytesIO(data)) as packed:
        content = packed.read(LARGEST_DATA + 1)
    if len(content) > LARGEST_DATA:
        raise InputError(
            f"{file}: holds more than {LARGEST_DATA // MIB} MiB, the limit for such a "
            "file; give a smaller one"
        )
    return content
