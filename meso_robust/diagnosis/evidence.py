"""What the pictures of a diagnosis are drawn from: motion as recorded and as either model has it."""

from __future__ import annotations

from dataclasses import dataclass

from meso_robust.types import Floats


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
