"""The frames of a run as images of a folder, which `track` reads as a video.

Plain PGM: written in a fraction of a millisecond, and without loss. The line of an instant stands in the
table before its image gets its name, so that a killed run leaves a folder that can be read.
"""

from __future__ import annotations

import os
from contextlib import suppress
from pathlib import Path
from typing import IO

import numpy as np

from meso_robust.errors import InputError
from meso_robust.live.devices import Frame
from meso_robust.tracking.frames import TIMES_FILE

VIDEO, DRAFT, KILLED = "video", "video.part", "video.killed"
"""The folder of a run's frames; while it grows; and what a killed run left of it."""
_HALF = ".half"  # ending of an image that is being written: no ending of an image


def frame_name(turn: int) -> str:
    """File of the frame on which a turn was decided.

    Parameters
    ----------
    turn
        From 1, as they stand in the journal below its first line.

    Returns
    -------
    str
        Names have the order of the turns.
    """
    return f"turn_{turn:06d}.pgm"


class Film:
    """Writes the frames of a run, turn by turn.

    Parameters
    ----------
    folder
        Where `VIDEO` is to be once the run has ended.

    Raises
    ------
    InputError
        `VIDEO` or `KILLED` holds other files, which would have to be removed.
    """

    def __init__(self, folder: Path) -> None:
        self._folder, self._draft = folder, folder / DRAFT
        for name in (VIDEO, KILLED):
            _check_own(folder / name)
        if self._draft.exists():
            _remove(folder / KILLED)
            self._draft.replace(folder / KILLED)
        self._last: float | None = None
        self._times: IO[str] | None = None

    def add(self, turn: int, frame: Frame) -> None:
        """Write the frame of a turn; one that is no newer than the one before is left out.

        Parameters
        ----------
        turn
            From 1.
        frame
            As the camera gave it.
        """
        if self._last is not None and not frame.time > self._last:
            return  # a fault of the camera, which the journal tells; a video's instants must rise
        self._last = frame.time
        name = frame_name(turn)
        times = self._table()
        times.write(f"{name},{frame.time!r}\n")
        times.flush()
        high, wide = frame.image.shape
        half = self._draft / (name + _HALF)
        with half.open("wb") as file:
            file.write(b"P5\n%d %d\n255\n" % (wide, high))
            file.write(np.ascontiguousarray(frame.image).data)
        os.rename(half, self._draft / name)

    def _table(self) -> IO[str]:
        """Made with the first frame: a laboratory that cannot be reached leaves no folder."""
        if self._times is None:
            self._draft.mkdir(parents=True)
            self._times = (self._draft / TIMES_FILE).open("w", encoding="utf-8")
            self._times.write("file,time_s\n")
        return self._times

    def close(self) -> None:
        """End the table."""
        if self._times is not None:
            self._times.close()

    def finish(self) -> bool:
        """Give the folder its name, in the place of an earlier run's.

        Returns
        -------
        bool
            Whether there is a video: without a frame there is no folder.
        """
        self.close()
        _remove(self._folder / VIDEO)
        if self._times is None:
            return False
        self._draft.replace(self._folder / VIDEO)
        return True


def _own(path: Path) -> bool:
    return path.name == TIMES_FILE or path.name.removesuffix(_HALF).endswith(".pgm")


def _check_own(folder: Path) -> None:
    if not folder.exists():
        return
    strangers = (
        [path.name for path in folder.iterdir() if not _own(path)] if folder.is_dir() else [""]
    )
    if strangers:
        raise InputError(
            f"{folder / strangers[0]}: is no frame of a run and would be lost; give another --out"
        )


def _remove(folder: Path) -> None:
    """Remove an earlier run's frames, and nothing else."""
    with suppress(FileNotFoundError):
        for path in folder.iterdir():
            if _own(path):
                path.unlink()
        folder.rmdir()
