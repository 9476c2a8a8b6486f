"""What the pictures of a diagnosis are drawn from: motion as recorded and as either model has it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from meso_robust.types import Floats

if TYPE_CHECKING:  # a page is drawn without the machinery that makes a diagnosis
    from meso_robust.diagnosis.diagnose import Diagnosis
    from meso_robust.diagnosis.validation import Errors
    from meso_robust.identification.prepared import Prepared


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Evidence:
    """R recordings padded to T instants and P probes, in SI.

    Raises
    ------
    ValueError
        If an array has not the shape that its field states.
    """

    files: tuple[str, ...]
    """R recordings."""
    outline: Floats
    """(V, 2) corners of the part in its own frame, m."""
    tip_radius: float
    """m."""
    instants: Floats
    """(R, T) s; padding repeats the end."""
    seen: Floats
    """(R, T, 3) poses of the part, m and rad; NaN where not seen, and after the end."""
    tips: Floats
    """(R, T, P, 2) centres of the tips, m; NaN where a recording has no such probe."""
    baseline: Floats
    """(R, T, 3) poses predicted by the plain model."""
    extended: Floats | None
    """(R, T, 3) poses predicted by the extended model; None where nothing was added."""
    sigma: Floats
    """(3,) standard deviations of the noise, m and rad."""
    held_out: tuple[str, ...]
    """Recordings that no fit has seen."""
    extrapolation: tuple[str, ...]
    """Recordings of a kind of push that a fit of its own left out."""
    null_statistics: Floats
    """(B,) largest local test of every set that was simulated without a mismatch."""
    statistic: float
    """Largest local test of the recordings."""

    def __post_init__(self) -> None:
        """Check the shapes."""
        rows, frames = self.instants.shape
        poses = (rows, frames, 3)
        shapes = {"seen": poses, "baseline": poses, "extended": poses, "sigma": (3,)}
        for name, shape in shapes.items():
            found = getattr(self, name)
            if found is not None and found.shape != shape:
                _refuse(name, found.shape, shape)
        if self.tips.shape[:2] != (rows, frames) or self.tips.shape[3:] != (2,):
            _refuse("tips", self.tips.shape, (rows, frames, "P", 2))
        if len(self.files) != rows:
            _refuse("files", (len(self.files),), (rows,))


def _refuse(name: str, found: tuple[int, ...], shape: tuple[int | str, ...]) -> None:
    raise ValueError(f"{name}: has the shape {found}; must be {shape}, as instants have it")


def evidence(found: Diagnosis) -> Evidence:
    """Recorded and predicted motion of all recordings, those of the fit first.

    Parameters
    ----------
    found
        The diagnosis.

    Returns
    -------
    Evidence
        Padded to the longest recording.
    """
    plain, extended, beyond = found.plain, found.extended, found.checked.extrapolation
    before = [one for one in (plain.training, plain.held_out) if one is not None]
    after = [one for one in (extended.training, extended.held_out) if one] if extended else []
    frames = max(one.poses.shape[1] for one in before)
    prepared = [one.prepared for one in before]
    return Evidence(
        files=tuple(file for one in prepared for file in one.files),
        outline=prepared[0].outline,
        tip_radius=found.recordings.tip_radius,
        instants=np.concatenate([_clock(one.instants, frames) for one in prepared]),
        seen=np.concatenate([_padded(one.seen, frames) for one in prepared]),
        tips=_tips_of(prepared, frames),
        baseline=_poses(before, frames),
        extended=_poses(after, frames) if len(after) == len(before) else None,
        sigma=found.baseline.noise.sigma,
        held_out=plain.held_out.prepared.files if plain.held_out else (),
        extrapolation=beyond.files if beyond else (),
        null_statistics=found.detected.detection.null_statistics,
        statistic=found.detected.detection.statistic,
    )


def _poses(errors: list[Errors], frames: int) -> Floats:
    return np.concatenate([_padded(one.poses, frames) for one in errors])


def _tips_of(prepared: list[Prepared], frames: int) -> Floats:
    """(R, frames, P, 2) of all parts, of which one can have fewer tips; NaN for those it has not."""
    each = [_padded(_tips(part), frames) for part in prepared]
    found = np.full((sum(map(len, each)), frames, max(tips.shape[2] for tips in each), 2), np.nan)
    first = 0
    for tips in each:
        found[first : first + len(tips), :, : tips.shape[2]] = tips
        first += len(tips)
    return found


def _padded(values: Floats, frames: int) -> Floats:
    """(R, frames, …) with NaN after the end of (R, T, …)."""
    wide = np.full((len(values), frames, *values.shape[2:]), np.nan)
    wide[:, : values.shape[1]] = values
    return wide


def _clock(instants: Floats, frames: int) -> Floats:
    """(R, frames) with the end repeated."""
    return np.pad(instants, ((0, 0), (0, frames - instants.shape[1])), mode="edge")


def _tips(prepared: Prepared) -> Floats:
    """(R, T, P, 2) m; NaN for a probe that is parked because a recording has none."""
    count, _, probes, _ = prepared.waypoints.shape
    tips = np.empty((count, prepared.instants.shape[1], probes, 2))
    for r in range(count):
        for p in range(probes):
            for axis in range(2):
                tips[r, :, p, axis] = np.interp(
                    prepared.instants[r], prepared.times[r], prepared.waypoints[r, :, p, axis]
                )
    away = np.all(np.abs(tips + prepared.parked) < 1e-9, axis=-1)
    tips[away] = np.nan
    return tips
