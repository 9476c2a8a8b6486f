"""Whether what is left of a residual goes with heading, speed, place, time or side."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from meso_robust.recordings.direct.pushing import Contacts
from meso_robust.recordings.direct.selection import Columns, scores
from meso_robust.types import Floats, Ints


@dataclass(frozen=True, slots=True, kw_only=True)
class Trend:
    """A residual against one covariate.

    Attributes
    ----------
    covariate
        What it is compared with.
    correlation
        Of the residual with the best combination of the covariate's columns, 0 … 1.
    p_value
        For the largest of all covariates, by the signs of whole recordings.
    """

    covariate: str
    correlation: float
    p_value: float


def trends(residual: Floats, pairs: Contacts, rows: Ints) -> tuple[Trend, ...]:
    """Compare a residual with everything that it might go with.

    Parameters
    ----------
    residual
        (n,) m.
    pairs
        Of the pushing frames.
    rows
        (n,) which of them the residual is of.

    Returns
    -------
    tuple of Trend
        The likeliest first.
    """
    recordings = np.unique(pairs.recording[rows], return_inverse=True)[1]
    columns = {
        name: Columns(tuple(str(k) for k in range(block.shape[1])), block)
        for name, block in _covariates(pairs, rows).items()
        if block.shape[1]
    }
    found = [
        Trend(covariate=name, correlation=correlation, p_value=p_value)
        for name, (correlation, p_value) in scores(residual, recordings, columns).items()
    ]
    return tuple(sorted(found, key=lambda one: (one.p_value, -one.correlation)))


def _covariates(pairs: Contacts, rows: Ints) -> Mapping[str, Floats]:
    """(n, m) centred columns by name; none where the covariate does not vary."""
    velocity, pose = pairs.velocities[rows], pairs.poses[rows]
    heading = np.arctan2(velocity[:, 1], velocity[:, 0])
    own = heading - pose[:, 2]
    side = np.round(np.arctan2(pairs.normal[rows, 1], pairs.normal[rows, 0]) / (np.pi / 8))
    speed = np.hypot(*pairs.tip_velocities[rows].T)

    def waves(angle: Floats, k: int) -> Floats:
        return np.column_stack((np.cos(k * angle), np.sin(k * angle)))

    blocks = {
        "mean": np.ones((rows.size, 1)),
        "heading of the motion on the stage": waves(heading, 1),
        "twice the heading on the stage": waves(heading, 2),
        "heading of the motion in the part": waves(own, 1),
        "twice the heading in the part": waves(own, 2),
        "orientation of the part": waves(pose[:, 2], 1),
        "speed of the tip": speed[:, None],
        "place": pose[:, :2],
        "time in the recording": _since(pairs, rows)[:, None],
        "number of the recording": pairs.recording[rows, None].astype(float),
        "side of the part": np.column_stack([side == one for one in np.unique(side)]).astype(float),
    }
    return {
        name: block if name == "mean" else _varying(block - block.mean(axis=0))
        for name, block in blocks.items()
    }


def _varying(block: Floats) -> Floats:
    return block[:, np.ptp(block, axis=0) > 1e-9 * (1.0 + np.abs(block).max(initial=0.0))]


def _since(pairs: Contacts, rows: Ints) -> Floats:
    """(n,) s since the first pushing frame of the recording."""
    times, number = pairs.times[rows], pairs.recording[rows]
    first = {k: times[number == k].min() for k in np.unique(number).tolist()}
    return np.asarray(times - np.array([first[k] for k in number.tolist()]))
