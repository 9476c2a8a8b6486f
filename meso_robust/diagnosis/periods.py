"""Periods of a wave in the place, from what is seen while the part is pushed.

A fit finds the size of a wave whose period is nearly known, and no other one: from a period away its misfit
is flat. So periods are looked for where no model is needed: a push along a line moves the part smoothly,
and what its motion has beside a cubic of the time is searched for waves in the place on each axis
(N. R. Lomb 1976, doi:10.1007/BF00648343, with the cubic projected out of the waves as well).
"""

from __future__ import annotations

import numpy as np

from meso_robust.identification.prepared import Prepared
from meso_robust.types import Flags, Floats

MOST = 3
"""Periods that are told, the likeliest first."""
_FINE = 4.0  # waves to a period more over the whole field
_LONGEST = 0.7  # of the field
_SHORTEST = 0.012  # of the part's characteristic length
_FRAMES = 2.5  # ways from frame to frame, of which a wave is no shorter
_ENDS = 0.03  # of the way of the part, which are left out at both ends of a push
_FEWEST = 12  # frames of a push
_SMOOTH = 4  # numbers of a cubic


def driven(prepared: Prepared) -> Floats:
    """(R, T, 2) place of the first tip in m, as logged, at the instants of the frames."""
    rows = []
    for times, waypoints, instants in zip(
        prepared.times, prepared.waypoints[:, :, 0], prepared.instants, strict=True
    ):
        rows.append(np.stack([np.interp(instants, times, axis) for axis in waypoints.T], axis=-1))
    return np.array(rows)


def periods(prepared: Prepared, places: Floats) -> list[float]:
    """Periods of the waves that stand out in the motion of the part.

    Parameters
    ----------
    prepared
        The recordings.
    places
        (R, T, 2) places in m, world frame, in which the waves are looked for.

    Returns
    -------
    list of float
        At most `MOST` periods in m, the likeliest first; none without pushes of a dozen frames.
    """
    parts = [
        part
        for seen, place, instants in zip(prepared.seen, places, prepared.instants, strict=True)
        for part in [_pushed(seen[:, :2], place, instants)]
        if part is not None
    ]
    if not parts:
        return []
    every = np.concatenate([place for _, place, _ in parts])
    field = float(np.max(np.ptp(every, axis=0)))
    if not field > 0.0:
        return []
    steps = np.concatenate([np.hypot(*np.diff(place, axis=0).T) for _, place, _ in parts])
    shortest = max(_SHORTEST * prepared.length, _FRAMES * float(np.median(steps)))
    waves = np.arange(1.0 / _LONGEST, field / shortest, 1.0 / _FINE) / field
    if not waves.size:
        return []
    power = np.zeros(len(waves))
    for axis in range(2):
        power += _gains(parts, axis, waves)
    peaks = np.flatnonzero(_peaks(power))
    return [float(1.0 / waves[k]) for k in peaks[np.argsort(-power[peaks])][:MOST]]


Part = tuple[Floats, Floats, Floats]
"""What the motion of a push has beside a cubic (F, 2), its places (F, 2), and the cubic's basis (F, 4)."""


def _pushed(seen: Floats, place: Floats, instants: Floats) -> Part | None:
    known = np.all(np.isfinite(seen), axis=1) & np.isfinite(instants)
    if np.count_nonzero(known) < _FEWEST:
        return None
    seen, place, instants = seen[known], place[known], instants[known]
    way = np.hypot(*(seen - seen[0]).T)
    moves = (way > _ENDS * way.max()) & (way < (1.0 - _ENDS) * way.max())
    if np.count_nonzero(moves) < _FEWEST:
        return None
    seen, place, time = seen[moves], place[moves], instants[moves]
    basis, _ = np.linalg.qr(np.vander(2.0 * (time - time[0]) / np.ptp(time) - 1.0, _SMOOTH))
    return seen - basis @ (basis.T @ seen), place, basis


def _gains(parts: list[Part], axis: int, waves: Floats) -> Floats:
    """(W,) squares that the best wave of each number of waves a metre takes from the motion along an axis."""
    inner, outer = np.zeros((len(waves), 2, 2)), np.zeros((len(waves), 2))
    for rest, place, basis in parts:
        turned = 2.0 * np.pi * waves[:, None] * place[:, axis]
        both = np.stack([np.sin(turned), np.cos(turned)], axis=1)
        both -= (both @ basis) @ basis.T
        inner += both @ both.transpose(0, 2, 1)
        outer += both @ rest[:, axis]
    inner += 1e-9 * np.trace(inner, axis1=1, axis2=2)[:, None, None] * np.eye(2) + np.finfo(
        float
    ).tiny * np.eye(2)
    return np.asarray(
        np.einsum("wi,wi->w", outer, np.linalg.solve(inner, outer[..., None])[..., 0])
    )


def _peaks(power: Floats) -> Flags:
    """(W,) which are not below their neighbours."""
    padded = np.concatenate([[-np.inf], power, [-np.inf]])
    return np.asarray((power >= padded[:-2]) & (power >= padded[2:]))
