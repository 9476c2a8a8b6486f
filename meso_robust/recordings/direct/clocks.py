"""Whether the stamps of a stream come at regular instants, and whether that is where they belong.

Stamps that a busy computer gives late still count frames that a regular clock has made. A line through
stamp against number of the frame is that clock; how far the stamps lie off it is their jitter. If what
moves is smoother on the regular clock than on the stamps, the stamps are at fault and not the motion.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from meso_robust.types import Floats, Indices

_FEWEST = 8
_NORMAL = 1.4826
_LATE = 6.0  # robust deviations beyond which a single stamp is no jitter
_SHARE = 0.25  # of a period, below which a late stamp does not matter
_WINDOW = 10  # samples on either side of a straight piece
_FAST = 0.3  # of the fastest piece: the motion is clear there


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Stream:
    """Samples with stamps of their own.

    Attributes
    ----------
    file, name
        Recording, and what was sampled.
    times
        (T,) stamps in s, in the order of the file.
    values
        (T, D) m.
    """

    file: str
    name: str
    times: Floats
    values: Floats


@dataclass(frozen=True, slots=True, kw_only=True)
class ClockTest:
    """Regularity of the stamps of one stream.

    Attributes
    ----------
    file, name
        Recording, and what was sampled.
    period
        s from sample to sample.
    jitter
        Robust standard deviation in s of the stamps about a regular clock.
    lost
        Samples that the clock counts and the file lacks.
    late
        Samples whose stamp is off by more than a quarter of a period and six deviations.
    rough, rough_regular
        m by which a moving point leaves a straight line in time over short pieces, by the stamps and
        by the regular clock; NaN where nothing moves.
    """

    file: str
    name: str
    period: float
    jitter: float
    lost: int
    late: tuple[int, ...]
    rough: float
    rough_regular: float

    @property
    def stamps_at_fault(self) -> bool:
        """Whether motion is clearly smoother on the regular clock."""
        return self.rough_regular < 0.7 * self.rough


def clock_test(stream: Stream) -> ClockTest | None:
    """Hold the stamps of a stream against a regular clock.

    Parameters
    ----------
    stream
        Samples and stamps.

    Returns
    -------
    ClockTest or None
        None of fewer than eight samples.
    """
    times = stream.times[np.isfinite(stream.times)]
    if times.size < _FEWEST or times.size < stream.times.size:
        return None
    counts, regular = regular_clock(times)
    off = times - regular
    period = float((regular[-1] - regular[0]) / max(counts[-1] - counts[0], 1))
    jitter = _NORMAL * float(np.median(np.abs(off)))
    late = np.flatnonzero(np.abs(off) > max(_LATE * jitter, _SHARE * period))
    return ClockTest(
        file=stream.file,
        name=stream.name,
        period=period,
        jitter=jitter,
        lost=int(counts[-1] - counts[0] + 1 - times.size),
        late=tuple(late.tolist()) if late.size <= 0.05 * times.size else (),
        rough=_roughness(times, stream.values),
        rough_regular=_roughness(regular, stream.values),
    )


def regular_clock(times: Floats) -> tuple[Indices, Floats]:
    """The regular clock nearest to some stamps.

    Parameters
    ----------
    times
        (T,) stamps in s.

    Returns
    -------
    (T,), (T,)
        Number of each sample on that clock, gaps counted, and its instant in s.
    """
    steps = np.diff(times)
    period = _period(steps)
    # a late stamp makes one step long and the next one short: two steps are counted together
    counts = np.zeros(times.size, dtype=np.intp)
    for _ in range(3):
        ideal = (times - times[0]) / period
        offset = np.median(ideal - np.round(ideal))
        counts = _increasing(np.round(ideal - offset).astype(np.intp))
        slope, start = _line(counts.astype(float), times)
        if not slope > 0.0:
            break
        period = slope
    return counts, np.asarray(start + period * counts, dtype=np.float64)


def _period(steps: Floats) -> float:
    """Median of the steps that are no gaps, from sums of two: late stamps cancel in them."""
    positive = steps[steps > 0.0]
    if positive.size < 2:
        return float(positive[0]) if positive.size else 1.0
    middle = float(np.median(positive))
    pairs = steps[1:] + steps[:-1]
    near = pairs[(pairs > 1.5 * middle) & (pairs < 2.5 * middle)]
    return float(0.5 * np.mean(near)) if near.size else middle


def _increasing(counts: Indices) -> Indices:
    """Counts that grow by at least one, where a stamp that comes late gives way to the next."""
    index = np.arange(counts.size)
    early = np.minimum.accumulate((counts - index)[::-1])[::-1] + index
    return np.asarray(np.maximum.accumulate(early - index) + index)


def _line(x: Floats, y: Floats) -> tuple[float, float]:
    """Slope and start of a line through most of some points."""
    kept = np.ones(x.size, dtype=bool)
    slope = start = 0.0
    for _ in range(4):
        slope, start = np.polyfit(x[kept], y[kept], 1)
        off = np.abs(y - start - slope * x)
        kept = off <= max(3.0 * _NORMAL * float(np.median(off)), 1e-12)
        if kept.sum() < 3:
            break
    return float(slope), float(start)


def _roughness(times: Floats, values: Floats) -> float:
    """Median over fast pieces of the deviation in m from a straight line in time."""
    length = 2 * _WINDOW + 1
    good = np.all(np.isfinite(values), axis=1)
    if values.size == 0 or times.size < 2 * length or not np.all(good):
        times, values = times[good], values[good]
        if times.size < 2 * length:
            return float("nan")
    starts = np.arange(0, times.size - length + 1, _WINDOW)
    speeds, errors = [], []
    for first in starts.tolist():
        clock = times[first : first + length] - times[first]
        piece = values[first : first + length]
        basis = np.column_stack((np.ones(length), clock))
        line, *_ = np.linalg.lstsq(basis, piece, rcond=None)
        speeds.append(float(np.linalg.norm(line[1])))
        errors.append(float(np.sqrt(np.mean(np.sum((piece - basis @ line) ** 2, axis=1)))))
    fast = np.array(speeds) > _FAST * max(speeds)
    return float(np.median(np.array(errors)[fast])) if max(speeds) > 0.0 else float("nan")
