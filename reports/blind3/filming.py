"""A case of the third blind trial as films that `track` has read."""

from __future__ import annotations

import math
import tempfile
from collections.abc import Mapping
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

import numpy as np

import meso_robust
from meso_robust.recordings import Recording, write_set
from reports.blind3.cases import Case, sealed
from reports.blind3.film import PIXEL_UM, drawn_look, film
from reports.blind3.generate import (
    LENGTH,
    RADIUS,
    SUBSTEPS,
    WIDTH,
    Change,
    Floats,
    Push,
    World,
    pushes,
    small_wrongs,
)
from reports.blind3.laws import FAMILIES, OUTSIDE

SEED = 20261127
"""Of the looks of films and of their list; no other case has a seed that follows from it."""
TRACKERS = ("pixel_locking",)
"""What a tracker does, and no camera: it is put into what was tracked."""

Values = Mapping[str, Any]


def world_of(case: Case, label: Values) -> tuple[World, list[Push]]:
    """What is true of a case, and its pushes, with the sizes that were measured.

    Raises
    ------
    ValueError
        The label is not of this case.
    """
    rng = np.random.default_rng(case.seed)
    plan, wrongs = pushes(rng), small_wrongs(rng)
    mu, rho = float(rng.uniform(0.2, 0.4)), float(rng.uniform(430.0, 520.0))
    if (mu, rho, asdict(wrongs)) != (label["mu"], label["rho"], label["wrongs"]):
        raise ValueError(f"case {case.id}: the label is of another case")
    made = []
    for name, size in zip(case.families, label["sizes"], strict=True):
        shape = np.random.default_rng(int(rng.integers(2**31)))
        made.append({**FAMILIES, **OUTSIDE}[name].make(size, shape))
    return World(changes=tuple(made), wrongs=wrongs, mu=mu, rho=rho), plan


def tracked(case: Case, folder: Path) -> Values:
    """Film the pushes of a case, track them, and write the set; return what is true of it."""
    with tempfile.TemporaryDirectory() as place:
        label = sealed(case, Path(place) / "unused")
        whole, plan = world_of(case, label)
        named = list(zip(case.families, whole.changes, strict=True))
        world = replace(whole, changes=tuple(one for name, one in named if name not in TRACKERS))
        later = tuple(one for name, one in named if name in TRACKERS)
        rng = np.random.default_rng([SEED, case.id])
        look, found = drawn_look(world, rng), []
        for k, push in enumerate(plan):
            path = Path(place) / f"push_{k:02d}.avi"
            _filmed(path, (world, look), push, rng)
            seen = meso_robust.track(
                path,
                length_um=LENGTH,
                width_um=WIDTH,
                tip_radius_um=RADIUS,
                pixel_um=PIXEL_UM,
                start=(None, None, math.degrees(push.start[2])),
                commands=path.with_suffix(".csv"),
            )
            if seen.recordings is not None:
                found.append(seen.recordings)
        rows = tuple(_changed(one, later) for each in found for one in each.recordings)
        write_set(folder, replace(found[0], recordings=rows))
        lost = np.isnan(np.concatenate([one.poses[:, 0] for one in rows])).mean()
        how = {"noise": look.noise, "disc": look.disc, "tracked": len(rows), "lost": float(lost)}
        return {**label, **how}


def _filmed(path: Path, scene: tuple[World, Any], push: Push, rng: np.random.Generator) -> None:
    """Write a film and beside it what the controller logged; exposures jitter, stamps do not say so."""
    wrongs, frames = scene[0].wrongs, push.times[::SUBSTEPS]
    late = 1e-3 * wrongs.jitter_ms * rng.uniform(-1.0, 1.0, len(frames))
    late[0] = 0.0
    film(path, scene, push, frames + late, rng)
    tips = push.tips[::SUBSTEPS] + wrongs.tip_log_um * rng.normal(size=(len(frames), 2))
    _log(path.with_suffix(".csv"), np.column_stack([frames, tips]))


def _changed(seen: Recording, changes: tuple[Change, ...]) -> Recording:
    """A recording after what its tracker did to it."""
    poses = seen.poses * [1e6, 1e6, 1.0]
    for change in changes:
        poses = change.see(seen.times, poses) if change.see else poses
    return replace(seen, poses=poses * [1e-6, 1e-6, 1.0]) if changes else seen


def _log(path: Path, rows: Floats) -> None:
    text = "time_s,probe1_x_um,probe1_y_um\n"
    path.write_text(text + "".join(f"{t!r},{x!r},{y!r}\n" for t, x, y in rows.tolist()), "utf-8")
