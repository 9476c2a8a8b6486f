"""The sampling of Section IX-D and Lemma 1: dispersion halved down to the control uncertainty."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import TypeVar

from meso_robust.planning.effort import spend

T = TypeVar("T")


def levels(low: float, high: float, smallest: float) -> Iterator[list[float]]:
    """New samples of [low, high], level by level.

    The first level is the middle; each further one halves the dispersion and adds the points in
    between, until the dispersion is no larger than ``smallest``.

    Examples
    --------
    >>> list(levels(0.0, 8.0, 2.0))
    [[4.0], [2.0, 6.0]]
    """
    dispersion = 0.5 * (high - low)
    samples = [low + dispersion]
    while samples and dispersion >= smallest:
        yield samples
        dispersion *= 0.5
        samples = [low + k * dispersion for k in range(1, round((high - low) / dispersion), 2)]


REFINED = 2  # levels that are searched beyond the first robust one
MANY = 8  # samples of a level from which it is worth to sift all of them at once


def best_robust(
    low: float,
    high: float,
    smallest: float,
    attempt: Callable[[float], tuple[float, T] | None],
    refined: int = REFINED,
    sift: Callable[[list[float]], list[float]] | None = None,
) -> T | None:
    """The best robust sample of the first level that has one and of its neighbours after that.

    The paper stops at the first robust sample; its neighbours are worth a look when, as for the
    length of a push, samples differ in how good they are.

    Parameters
    ----------
    low, high, smallest
        Range of the input, and the dispersion at which the search ends (control uncertainty).
    attempt
        Certifies one sample; None if it is not robust, else its worth (higher is better) and what
        was found.
    refined
        How many further levels are looked at, and only on either side of the best sample so far.
    sift
        Leaves of many samples those that may be robust, in less time than to attempt them.
    """
    best: tuple[float, float, T] | None = None
    for samples in levels(low, high, smallest):
        if best is not None:
            refined -= 1
            if refined < 0:
                break
            samples = _nearest(samples, best[1])
        if sift is not None and len(samples) >= MANY:
            spend()
            samples = sift(samples)
        for sample in samples:
            spend()
            result = attempt(sample)
            if result is not None and (best is None or result[0] > best[0]):
                best = result[0], sample, result[1]
    return None if best is None else best[2]


def _nearest(samples: list[float], to: float) -> list[float]:
    return sorted(samples, key=lambda sample: abs(sample - to))[:2]
