"""What an importer gives, and what it is."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol, TypeAlias

from meso_robust.errors import InputError
from meso_robust.recordings.direct.clocks import Stream
from meso_robust.recordings.outline import Polygon, Rectangle
from meso_robust.recordings.values import RecordingSet

Outline: TypeAlias = Rectangle | Polygon
_SHOWN = 5  # rows named in a line of text; all are in the value


@dataclass(frozen=True, slots=True, kw_only=True)
class Left:
    """Something that stands in a file and was not carried into the set.

    Attributes
    ----------
    file
        Name of the file as it was given.
    place
        What is counted: ``line``, ``push``, or the name of a list in the file.
    rows
        Which of them; lines from 1, all else from 0; empty if the whole file was left out.
    reason
        Why, in words.
    """

    file: str
    place: str
    rows: tuple[int, ...]
    reason: str

    def __str__(self) -> str:
        """One line of text; of many rows the first few."""
        if not self.rows:
            return f"{self.file}: {self.reason}"
        shown = ", ".join(str(row) for row in self.rows[:_SHOWN])
        more = f" … ({len(self.rows)} in all)" if len(self.rows) > _SHOWN else ""
        return f"{self.file}, {self.place} {shown}{more}: {self.reason}"


@dataclass(frozen=True, slots=True, kw_only=True)
class Imported:
    """A recording set made from files of another format.

    Attributes
    ----------
    recordings
        The set, in SI.
    left
        What the files hold and the set does not, in the order of the files.
    streams
        What was sampled by clocks of its own and interpolated into the set.
    """

    recordings: RecordingSet
    left: tuple[Left, ...]
    streams: tuple[Stream, ...] = ()


class Reader(Protocol):
    """What makes a set of a path, with the part's outline where it is given."""

    def __call__(self, path: Path, outline: Outline | None) -> Imported:
        """Make a recording set of a file or a folder of files."""
        ...


@dataclass(frozen=True, slots=True, kw_only=True)
class Importer:
    """Reader of one format.

    Attributes
    ----------
    note
        What is assumed beyond what the files say.
    recognises
        Whether a path (a file, or a folder of files) looks like this format; never raises.
    reader
        What `read` calls.
    """

    note: str
    recognises: Callable[[Path], bool]
    reader: Reader

    def read(self, path: Path, outline: Outline | None = None) -> Imported:
        """Make a recording set of a file or a folder of files.

        Parameters
        ----------
        path
            File or folder.
        outline
            Of the part, where the files do not say it.

        Raises
        ------
        InputError
            The message names file, place, value, rule and what to do; also if the files would make
            a set that breaks a rule of sets, such as two recordings of one name.
        """
        try:
            return self.reader(path, outline)
        except InputError:
            raise
        except ValueError as error:  # of Recording and RecordingSet
            raise InputError(f"{path}: {error}") from error
