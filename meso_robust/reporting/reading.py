"""What the report reads out of a result: which runs got how far, which steps are certified."""

from __future__ import annotations

from collections import Counter
from enum import Enum

import numpy as np
import numpy.typing as npt

from meso_robust.bounds import Verdict
from meso_robust.certificates.chain import Chain
from meso_robust.laboratory.crosscheck import CrossCheck
from meso_robust.laboratory.running import why

MOST_POINTS = 1000  # of one scatter; more would only make the page slow


class Standing(Enum):
    """What is known of one move of the plan; the value is how the page says it."""

    CERTIFIED = "certified"
    CONDITIONAL = "proved only if the moves before it are"
    OPEN = "not proved"
    NOT_REACHED = "not reached by the proof"


def standings(chain: Chain, moves: int) -> tuple[Standing, ...]:
    """The standing of every move: a proof counts only if all those before it hold."""
    found: list[Standing] = []
    sound = True
    for step in chain.steps:
        proved = step.verdict is Verdict.PROVED
        if not proved:
            found.append(Standing.OPEN)
        else:
            found.append(Standing.CERTIFIED if sound else Standing.CONDITIONAL)
        sound &= proved
    return (*found, *[Standing.NOT_REACHED] * (moves - len(found)))


def through(check: CrossCheck, move: int) -> npt.NDArray[np.bool_]:
    """(N,) whether a run completed the move with this index."""
    return check.sampled.failed_in > move


def thinned(poses: npt.NDArray[np.float64], most: int = MOST_POINTS) -> npt.NDArray[np.float64]:
    """At most about ``most`` rows, evenly chosen, and always the extreme ones.

    Parameters
    ----------
    poses
        (N, 3) poses.
    most
        How many to keep.
    """
    if len(poses) <= most:
        return poses
    even = np.linspace(0, len(poses) - 1, most).astype(np.int64)
    return poses[np.union1d(even, [*poses.argmin(axis=0), *poses.argmax(axis=0)])]


def ending(code: int) -> str:
    """Why a run ended, as a short phrase."""
    return why(code).split(":")[0].split(";")[0]


def endings(check: CrossCheck) -> tuple[tuple[str, str, int], ...]:
    """(where, how, how many) of the runs that do not end in the goal, most frequent first."""
    sampled = check.sampled
    early = ~sampled.completed
    counts = Counter(
        (f"move {move + 1}", ending(int(code)))
        for move, code in zip(sampled.failed_in[early], sampled.outcomes[early], strict=True)
    )
    missed = int((sampled.completed & ~check.in_goal).sum())
    if missed:
        counts[("end", "completed, but the last pose misses the goal")] = missed
    return tuple((where, how, count) for (where, how), count in counts.most_common())
