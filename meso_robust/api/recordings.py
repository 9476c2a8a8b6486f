"""``recordings``: recorded pushes read, checked, repaired, or imported from another format."""

from __future__ import annotations

import json
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, TypeAlias, Union

from meso_robust.api.call import call
from meso_robust.api.options import Option, StrPath
from meso_robust.api.progress import SILENT, Progress
from meso_robust.api.result import Result
from meso_robust.errors import InputError

if TYPE_CHECKING:
    from meso_robust.recordings import RecordingSet
    from meso_robust.recordings.loose import Lines
    from meso_robust.recordings.problem import Problem
    from meso_robust.recordings.repair import Repair
    from meso_robust.recordings.summary import Checked
    from meso_robust.recordings.usable import Usable

RecordingsGiven: TypeAlias = Annotated[
    Union["RecordingSet", "Recordings", str, PathLike[str]],
    Option(words="Recording set (folder)."),
]
FOLDER = "recordings"
"""Where a set that was repaired or imported is written, below the results."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Recordings(Result):
    """A recording set with everything that is wrong with it.

    Attributes
    ----------
    checked
        The set, problems, repairs, and where it is from.
    rewritten
        Whether the set is not that on disk: it was repaired or imported, and ``save`` writes it.
    """

    checked: Checked
    rewritten: bool

    @property
    def verdict(self) -> str:
        """CLEAN, USABLE WITH CARE (warnings remain) or NOT USABLE AS IT IS (errors remain)."""
        return self.checked.verdict

    @property
    def set(self) -> RecordingSet:
        """The recordings, SI units; the repaired ones if they were repaired."""
        return self.checked.recordings

    @property
    def problems(self) -> tuple[Problem, ...]:
        """Errors and warnings that remain."""
        return self.checked.matters

    @property
    def repairs(self) -> tuple[Repair, ...]:
        """What was repaired."""
        return self.checked.repairs

    @property
    def positive(self) -> bool:
        """Whether nothing is wrong."""
        return not self.problems

    @property
    def document(self) -> dict[str, Any]:
        """The content of ``summary.json``."""
        from meso_robust.recordings.summary import document

        return document(self.checked)

    def __str__(self) -> str:
        from meso_robust.recordings.summary import answer

        return answer(self.checked)

    def __repr__(self) -> str:
        return f"<Recordings {self.verdict}: {len(self.set.recordings)} of {self.checked.source}>"

    def _repr_html_(self) -> str:
        from meso_robust.reporting.cards import recordings_card

        return recordings_card(self.checked, str(self))

    def text(self) -> str:
        """The text of ``summary.json``."""
        return json.dumps(self.document, indent=2, allow_nan=False) + "\n"

    def files(self) -> dict[str, str]:
        """The texts of the result files by name; of a set that was repaired or imported, its own too."""
        from meso_robust.recordings.writing import set_files
        from meso_robust.reporting.recordings import recordings_report

        rewritten = set_files(self.set) if self.rewritten else {}
        return {
            **{f"{FOLDER}/{name}": text for name, text in rewritten.items()},
            "summary.json": self.text(),
            "report.html": recordings_report(self.checked),
        }

    @property
    def shown(self) -> dict[str, str]:
        """The report, and the set if it was repaired or imported."""
        return {"report": "report.html"} | ({"recording set": FOLDER} if self.rewritten else {})

    def check_folder(self, folder: Path) -> None:
        """Refuse a folder in which the set would overwrite the original recordings.

        Raises
        ------
        InputError
            It would.
        """
        sub, source = folder / FOLDER, Path(self.checked.source).resolve()
        if self.rewritten and sub.resolve() in (source, source.parent):
            raise InputError(
                f"--out {folder}: would overwrite the recordings in {sub}, which must stay as "
                "they were made; give another folder"
            )


@call
def read_recordings(
    path: StrPath,
    *,
    format: str | None = None,  # noqa: A002  # as the command line calls it
    repair: bool = False,
    outline: StrPath | None = None,
    progress: Progress = SILENT,
) -> Recordings:
    """Read recordings, list what is wrong with them, and on request repair what can be repaired.

    Parameters
    ----------
    path
        Recording set, or recordings in another format.
    format
        ``set`` or the name of another format; detected by default.
    repair
        Repair what can be repaired without inventing data.
    outline
        TOML file with ``[part]`` as in ``set.toml``, for a format that does not state the outline.
    progress
        Shows what is being done.

    Returns
    -------
    Recordings
        A result even if the recordings cannot be used as they are.

    Raises
    ------
    InputError
        Nothing can be read, the format is unknown, or the repair would leave nothing.

    Examples
    --------
    A simulation of the plan of :func:`meso_robust.plan`'s example, as a camera sees it:

    >>> import tempfile
    >>> simulated = mr.simulate(task, planned, samples=1)
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     simulated.record(folder, runs=1)
    ...     recordings = mr.read_recordings(folder)
    >>> recordings.set.recordings[0].file, recordings.set.recordings[0].probe_names
    ('run_00_move_1.csv', ('dtp_top', 'dtp_bottom'))
    >>> recordings.verdict
    'CLEAN'
    """
    from meso_robust.recordings.checking import OWN, checked
    from meso_robust.recordings.reading import read_outline

    with progress.doing("reading and checking"):
        part = None if outline is None else read_outline(Path(outline))
        found = checked(Path(path), format, repair, part)
    return Recordings(checked=found, rewritten=repair or found.format != OWN)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Given:
    """Recordings that somebody gave, and what could not be read of them.

    Attributes
    ----------
    recordings, read, lines
        As `usable.usable_set` takes them.
    source
        Where they are from; None of a set in memory.
    """

    recordings: RecordingSet
    read: tuple[Problem, ...] = ()
    lines: Lines | None = None
    source: Path | None = None

    def usable(self, allowed: frozenset[str] = frozenset()) -> Usable:
        """What a fit takes of them, for one that can do with some kinds of errors.

        Raises
        ------
        InputError
            They cannot be used.
        """
        from meso_robust.recordings.usable import usable_set

        return usable_set(self.recordings, self.read, self.lines, allowed)


def given_of(recordings: RecordingsGiven) -> Given:
    """A set with what could not be read of it, so that a bad row or file is left out and told.

    Raises
    ------
    InputError
        Nothing of it can be read.
    """
    if isinstance(recordings, Recordings):
        checked = recordings.checked
        read = () if checked.repairs else checked.unread
        return Given(
            recordings=recordings.set, read=read, lines=checked.lines, source=Path(checked.source)
        )
    if isinstance(recordings, str | PathLike):
        from meso_robust.recordings.loose import read_loosely

        loose = read_loosely(Path(recordings))
        return Given(
            recordings=loose.recordings,
            read=loose.problems,
            lines=loose.lines,
            source=Path(recordings),
        )
    return Given(recordings=recordings)


def set_of(recordings: RecordingsGiven) -> tuple[RecordingSet, Path | None]:
    """A set, read strictly if it is named, and where it is from.

    Raises
    ------
    InputError
        It cannot be read, or a value breaks a rule.
    """
    if isinstance(recordings, Recordings):
        return recordings.set, Path(recordings.checked.source)
    if isinstance(recordings, str | PathLike):
        from meso_robust.recordings import read_set

        return read_set(Path(recordings)), Path(recordings)
    return recordings, None


def name_of(source: Path | None) -> str:
    """What a report calls a set."""
    return "recordings" if source is None else str(source)
