"""Frames decoded by a thread of their own while earlier ones are tracked."""

from __future__ import annotations

from collections import deque
from collections.abc import Generator, Iterable
from concurrent.futures import ThreadPoolExecutor

from meso_robust.tracking.frames import Frame

_DEPTH = 4  # frames that wait at most: what the reader may be ahead, and the memory that this takes


def read_ahead(frames: Iterable[Frame]) -> Generator[Frame, None, None]:
    """The same frames in the same order, read before they are asked for.

    Parameters
    ----------
    frames
        Read by one other thread, which ends with the iteration.

    Raises
    ------
    InputError
        As reading does, after the frames before it.
    """
    source = iter(frames)
    with ThreadPoolExecutor(1, "frames") as reader:
        waiting = deque(reader.submit(next, source, None) for _ in range(_DEPTH))
        try:
            while (frame := waiting.popleft().result()) is not None:
                waiting.append(reader.submit(next, source, None))
                yield frame
        finally:
            for one in waiting:
                one.cancel()
