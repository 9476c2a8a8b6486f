"""Tables of the report on single pushes and on pushes by two fingers."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
import numpy.typing as npt

from meso_robust.recordings import RecordingSet
from meso_robust.recordings.importers import FORMATS
from reports.identification.real.fitting import (
    BOOTSTRAP,
    Rows,
    difference,
    folds_of,
    interval,
    root_mean_square,
)
from reports.identification.real.ladders import (
    CENTRE,
    DELAY,
    GRAIN,
    OFFSET,
    Effects,
    Rung,
    problem_of,
    rung,
)

F = npt.NDArray[np.float64]
Ladder = Sequence[tuple[str, Effects]]

PROTOTYPE = (2.6, 2.4)
"""mm and degrees: what a prototype reached with ρ and μ, on 24 other pushes of the same data."""
OUT = 4  # pushes that are left out at a time
REPEATS = 2  # of every push's being left out, in other company

PLYWOOD: Ladder = (
    ("ρ, µ", {}),
    ("+ reference point", OFFSET),
    ("+ centre of drag", {**OFFSET, **CENTRE}),
    ("+ grain, no centre", {**OFFSET, **GRAIN}),
    ("+ grain and centre", {**OFFSET, **CENTRE, **GRAIN}),
)
FINGERS: Ladder = (
    ("ρ, µ", {}),
    ("+ delay of the camera", DELAY),
    ("+ reference point", {**DELAY, **OFFSET}),
)
GUESS = {"camera_latency.time_ms": 0.1, "anisotropic_drag.fraction": 1e-3}  # SI

HEAD = "| model | own mm | own ° | unseen mm | unseen ° | median push, unseen | parameters |\n"
RULE = "|---|---|---|---|---|---|---|\n"


def plywood(folder: Path, draws: int) -> str:
    """Single pushes of a square on plywood."""
    recordings = FORMATS["mcube_json"].read(folder).recordings
    folds = folds_of(len(recordings.recordings), OUT, REPEATS, seed=0)
    rungs = climbed(recordings, PLYWOOD, folds, draws)
    first, best = rungs[0], min(rungs, key=lambda one: root_mean_square(one.unseen)[0])
    gain = difference(first.unseen[:, 0] ** 2, best.unseen[:, 0] ** 2) * 1e6
    return (
        "## Single pushes of a 90-mm square on plywood (MIT)\n\n"
        f"{len(recordings.recordings)} pushes of about 50 mm at 100 mm/s; leave {OUT} out, {REPEATS} "
        "times in other company. On an ellipsoidal limit surface a single kinematic pusher moves the "
        "part as on a film, m_max/f_max = √ρ.\n\n"
        + HEAD
        + RULE
        + "".join(map(row, rungs))
        + f"\nA prototype's figure with ρ and µ, on 24 *other* pushes: {PROTOTYPE[0]} mm and "
        f"{PROTOTYPE[1]}°. With the same two parameters the unseen pushes here are at "
        f"{_both(first.unseen)}; those 24 are not at hand, so this is no like-for-like comparison. "
        f"Smallest unseen error: *{best.name}*, {_both(best.unseen)}; its mean square is below that of "
        f"ρ and µ alone by [{gain[0]:.1f}, {gain[1]:.1f}] mm² (the best of five by this very figure). "
        f"{_worst(first, recordings)}\n"
    )


def _worst(one: Rung, recordings: RecordingSet) -> str:
    """Where the plain model fails most."""
    worst = np.argsort(-one.unseen[:, 0])[:4]
    names = [
        "i=" + recordings.recordings[k].file.split("_i=")[1].removesuffix(".csv") for k in worst
    ]
    sizes = ", ".join(
        f"{name} ({1e3 * one.unseen[k, 0]:.1f} mm)" for name, k in zip(names, worst, strict=True)
    )
    return f"The plain model fails most at {sizes}."


def two_fingers(folder: Path, draws: int) -> str:
    """Pushes by two fingers, a table for each part."""
    parts = [child for child in sorted(folder.iterdir()) if child.is_dir()]
    told = [_one_part(part, draws) for part in parts]
    delays = [1e3 * rungs[1].fit.values[2] for _, rungs in told if rungs]
    return (
        "## Pushes by two round fingers, seen by a camera (CMU)\n\n"
        "Two or three different pushes, each repeated in five logs. Unseen: one kind of push is "
        "predicted from the other kinds.\n\n"
        f"The camera's delay comes out at {min(delays):.0f} … {max(delays):.0f} ms for the parts, each "
        "by itself; no file states it. Two fingers hold the part: its motion says little of √ρ, and of µ "
        "often no more than that it is large (2 is the limit of the search). A reference point that "
        "one kind of push fits can spoil the prediction of another.\n\n"
        + "\n".join(text for text, _ in told)
    )


def _one_part(folder: Path, draws: int) -> tuple[str, list[Rung]]:
    importer = FORMATS["two_finger_log"]
    name = folder.name.split("_")[0]
    if name == "butter":  # the logs do not hold its outline
        why = "Not fitted: its outline stands neither in the logs nor beside them."
        return f"### butterfly\n\n{why}\n", []
    recordings = importer.read(folder).recordings
    kinds = np.array([r.file.rsplit("_push", 1)[1] for r in recordings.recordings])
    folds = [np.flatnonzero(kinds == kind) for kind in np.unique(kinds)]
    rungs = climbed(recordings, FINGERS, folds, draws)
    table = HEAD + RULE + "".join(map(row, rungs))
    return f"### {folder.name}\n\n{len(kinds)} pushes.\n\n{table}", rungs


def climbed(
    recordings: RecordingSet, ladder: Ladder, folds: Sequence[Rows], draws: int
) -> list[Rung]:
    """Fit each model of a ladder."""
    return [
        rung(name, problem_of(recordings, effects), folds, guess=GUESS, draws=draws)
        for name, effects in ladder
    ]


def row(one: Rung) -> str:
    """A line of the table."""
    own, unseen, bounds = (
        root_mean_square(one.own),
        root_mean_square(one.unseen),
        interval(one.unseen),
    )
    middle = np.median(one.unseen, axis=0)
    return (
        f"| {one.name} | {1e3 * own[0]:.2f} | {np.degrees(own[1]):.2f} | {1e3 * unseen[0]:.2f} "
        f"[{1e3 * bounds[0, 0]:.2f}, {1e3 * bounds[1, 0]:.2f}] | {np.degrees(unseen[1]):.2f} "
        f"[{np.degrees(bounds[0, 1]):.2f}, {np.degrees(bounds[1, 1]):.2f}] | {1e3 * middle[0]:.2f} mm, "
        f"{np.degrees(middle[1]):.2f}° | {_parameters(one)} |\n"
    )


def _both(each: F) -> str:
    size = root_mean_square(each)
    return f"{1e3 * size[0]:.2f} mm and {np.degrees(size[1]):.2f}°"


SHOWN: Mapping[str, tuple[str, float, str]] = {
    "rho_um2": ("√ρ", 1e3, "mm"),
    "mu": ("µ", 1.0, ""),
    "reference_offset.x_um": ("c_x", 1e3, "mm"),
    "reference_offset.y_um": ("c_y", 1e3, "mm"),
    "drag_centre_offset.x_um": ("drag x", 1e3, "mm"),
    "drag_centre_offset.y_um": ("drag y", 1e3, "mm"),
    "anisotropic_drag.fraction": ("grain", 1.0, ""),
    "anisotropic_drag.direction_deg": ("along", 180.0 / np.pi, "°"),
    "camera_latency.time_ms": ("delay", 1e3, "ms"),
}
"""Name, factor from SI and unit of what the table shows of a parameter."""


def _parameters(one: Rung) -> str:
    texts = []
    for k, key in enumerate(one.model.keys):
        name, factor, unit = SHOWN[key]
        values = np.append(one.spread[:, k], one.fit.values[k])
        values = factor * (np.sqrt(values) if key == "rho_um2" else values)
        low, high = np.quantile(values[:-1], BOOTSTRAP)
        texts.append(f"{name} {values[-1]:.3g} [{low:.3g}, {high:.3g}] {unit}".rstrip())
    return "; ".join(texts)
