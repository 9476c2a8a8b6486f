"""Which recordings are fitted, and which no fit may see until the end."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from meso_robust.recordings import RecordingSet

_SHARE = 0.2  # of the recordings is held out
_FEWEST = 6  # recordings of which any can be spared


@dataclass(frozen=True, slots=True, kw_only=True)
class Split:
    """Recordings by what they are for.

    Attributes
    ----------
    training
        All fits and all choices see these only.
    held_out
        No fit sees these, and no search; they may refute an answer that it gave, and of what is
        not explained they choose the part that carries over. None if there are too few recordings.
    """

    training: RecordingSet
    held_out: RecordingSet | None


def split(recordings: RecordingSet, seed: int) -> Split:
    """Hold out a fifth of the recordings, whole ones, at random.

    Parameters
    ----------
    recordings
        All.
    seed
        Of the choice.
    """
    count = len(recordings.recordings)
    spared = max(2, round(_SHARE * count)) if count >= _FEWEST else 0
    chosen = set(np.random.default_rng([seed, count]).permutation(count)[:spared].tolist())
    return Split(
        training=_of(recordings, [k for k in range(count) if k not in chosen]),
        held_out=_of(recordings, sorted(chosen)) if spared else None,
    )


def without(recordings: RecordingSet, left_out: set[str]) -> RecordingSet:
    """The recordings but those of some files."""
    kept = [k for k, one in enumerate(recordings.recordings) if one.file not in left_out]
    return _of(recordings, kept)


def _of(recordings: RecordingSet, rows: list[int]) -> RecordingSet:
    return replace(recordings, recordings=tuple(recordings.recordings[k] for k in rows))
