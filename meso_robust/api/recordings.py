"""``recordings``: recorded pushes read, checked, repaired, or imported from another format."""

from __future__ import annotations

import json
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import Any

from meso_robust.api.call import call
from meso_robust.api.inputs import StrPath
from meso_robust.api.progress import SILENT, Progress
from meso_robust.errors import InputError
from meso_robust.files import write_all
from meso_robust.recordings import RecordingSet, read_set, write_set
from meso_robust.recordings.checking import OWN, checked
from meso_robust.recordings.problem import Problem
from meso_robust.recordings.reading import read_outline
from meso_robust.recordings.repair import Repair
from meso_robust.recordings.summary import Checked, answer, document

FOLDER = "recordings"
"""Where a set that was repaired or imported is written, below the results."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Recordings:
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
        """Errors and warnings that are left."""
        return self.checked.matters

    @property
    def repairs(self) -> tuple[Repair, ...]:
        """What was repaired."""
        return self.checked.repairs

    @property
    def document(self) -> dict[str, Any]:
        """The content of ``summary.json``."""
        return document(self.checked)

    def __str__(self) -> str:
        """The answer in a few lines, as the command line prints it."""
        return answer(self.checked)

    def __repr__(self) -> str:
        return f"<Recordings {self.verdict}: {len(self.set.recordings)} of {self.checked.source}>"

    def _repr_html_(self) -> str:
        from meso_robust.reporting.cards import recordings_card

        return recordings_card(self.checked, str(self))

    def files(self) -> dict[str, str]:
        """The texts of the result files by name, without the set itself."""
        from meso_robust.reporting.recordings import recordings_report

        text = json.dumps(self.document, indent=2, allow_nan=False) + "\n"
        return {"summary.json": text, "report.html": recordings_report(self.checked)}

    @call
    def check_save(self, folder: StrPath) -> None:
        """Refuse a folder in which ``save`` would overwrite the original recordings.

        Raises
        ------
        InputError
            It would.
        """
        sub, source = Path(folder) / FOLDER, Path(self.checked.source).resolve()
        if self.rewritten and sub.resolve() in (source, source.parent):
            raise InputError(
                f"--out {folder}: would overwrite the recordings in {sub}, which must stay as "
                "they were made; give another folder"
            )

    @call
    def save(self, folder: StrPath, *, progress: Progress = SILENT) -> None:
        """Write summary, report, and in ``recordings`` the set if it was repaired or imported.

        Raises
        ------
        InputError
            They cannot be written, or the recordings would be overwritten.
        """
        self.check_save(folder)
        with progress.doing("writing the results"):
            files = self.files()
            if self.rewritten:
                write_set(Path(folder) / FOLDER, self.set)
            write_all(Path(folder), files)


@call
def read_recordings(
    path: StrPath,
    *,
    format: str | None = None,  # noqa: A002  # as the command line calls it
    repair: bool = False,
    outline: StrPath | None = None,
    progress: Progress = SILENT,
) -> Recordings:
    """Read recordings, list what is wrong with them, and repair what can be if asked for.

    Parameters
    ----------
    path
        Folder of a recording set, or recordings in another format.
    format
        ``set`` or the name of another format; found out if left out.
    repair
        Repair what can be without inventing data.
    outline
        File with the ``[part]`` of a ``set.toml``, for recordings in a format that does not say it.
    progress
        Shows what is being done.

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
    with progress.doing("reading and checking"):
        part = None if outline is None else read_outline(Path(outline))
        found = checked(Path(path), format, repair, part)
    return Recordings(checked=found, rewritten=repair or found.format != OWN)


def set_of(recordings: RecordingSet | Recordings | StrPath) -> tuple[RecordingSet, Path | None]:
    """A set, read strictly if it is named, and where it is from.

    Raises
    ------
    InputError
        It cannot be read, or a value breaks a rule.
    """
    if isinstance(recordings, Recordings):
        return recordings.set, Path(recordings.checked.source)
    if isinstance(recordings, str | PathLike):
        return read_set(Path(recordings)), Path(recordings)
    return recordings, None


def name_of(source: Path | None) -> str:
    """What a report calls a set."""
    return "recordings" if source is None else str(source)
