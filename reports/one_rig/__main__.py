"""One delay and one scale by axis for all sets of a rig: ``python -m reports.one_rig --help``."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from meso_robust.diagnosis.baseline import fitted_baseline
from meso_robust.diagnosis.folds import Bench, RollOut, bench_of, rolled_out, weights_of
from meso_robust.diagnosis.noise import noise_of, with_noise
from meso_robust.errors import InputError
from meso_robust.files import write_all
from meso_robust.identification.likelihood import fit
from meso_robust.identification.models import with_effects
from meso_robust.identification.prepared import prepare
from meso_robust.recordings import RecordingSet
from meso_robust.recordings.importers import FORMATS
from meso_robust.recordings.usable import usable_set
from meso_robust.types import Floats
from reports.diagnosis.real_report import NO_OUTLINE

SCALES = {
    "camera_latency": {"time_ms": 20.0},
    "camera_anisotropy": {"x_percent": 0.3, "y_percent": 0.3},
}
KEYS = ("camera_latency.time_ms", "camera_anisotropy.x_percent", "camera_anisotropy.y_percent")
_RESAMPLED, _TAIL = 4000, 0.05
HEAD = """# One delay and one scale by axis for one rig

Command: `python -m reports.one_rig --recordings FOLDER`, where FOLDER holds the sets of the rig
(`cmu_two_finger`, the robot logs of PlanarManipulationToolBox; no data is shipped here).

Each set is predicted from the pose at rest to the end, every recording by a fit that has not seen it. *Plain*: film
ratio and friction only. *Rig*: the same two numbers, with a delay of the camera and a scale along x and y that were
fitted to the **other** sets only. *Own*: all numbers fitted to the set itself, but for the fold predicted.
Errors are root mean squares with 90 % intervals by bootstrap over recordings, and the median recording's. Behind a rig
value stands two standard errors of the set's own fit; behind the median of the sets, those of how much sets differ.

"""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Measured:
    """A set: its recordings, roll-outs, and what its own fit says of the rig, with its weight."""

    name: str
    bench: Bench
    plain: RollOut
    own: RollOut
    values: Floats
    """(3,) of `KEYS`, in their units."""
    information: Floats
    """(3, 3) about them, the set's other numbers unknown."""


def usable(folder: Path) -> RecordingSet:
    """The recordings of a set in which the part is not found deep inside a tip at first."""
    found = usable_set(FORMATS["two_finger_log"].read(folder).recordings).recordings
    able = []
    for one in found.recordings:
        try:
            prepare(replace(found, recordings=(one,)))
        except InputError:
            continue
        able.append(one)
    return replace(found, recordings=tuple(able))


def measured(folder: Path, seed: int) -> Measured:
    """Fit one set by itself."""
    found = usable(folder)
    noise = noise_of(found)
    recordings = with_noise(found, noise)
    baseline = fitted_baseline(
        recordings, noise, "viscous", quick=True, seed=seed, told=lambda *_: None
    )
    bench = bench_of(recordings, baseline, seed)
    plain = rolled_out(bench, baseline.model, baseline.fits.values[0])
    model = with_effects(baseline.model, SCALES)
    own = rolled_out(bench, model, np.append(plain.values, [0.1, 0.0, 0.0]))
    settings = baseline.settings.by_chord(6, 0.05)
    weighed = replace(bench.prepared, weights=weights_of(bench, model, own.values))
    ended = fit(weighed, model, own.values[None], settings)
    spread = np.linalg.inv(ended.information[0])[-3:, -3:]
    units = np.array([20.0, 0.3, 0.3])
    shown = dict(zip(model.keys, model.shown(ended.fits.values[0]), strict=True))
    return Measured(
        name=folder.name,
        bench=bench,
        plain=plain,
        own=own,
        values=np.array([shown[key] for key in KEYS]),
        information=np.linalg.inv(spread * np.outer(units, units)),
    )


def pooled(sets: Sequence[Measured]) -> tuple[Floats, Floats]:
    """(3,) rig values of some sets together, and (3,) errors by how much the sets differ.

    Every set counts the same: what differs between them is no noise of the camera.
    """
    values = np.array([one.values for one in sets])
    middle = np.median(values, axis=0)
    error = 1.2533 * values.std(axis=0, ddof=1) / np.sqrt(len(values))
    return middle, error


def predicted_by_rig(one: Measured, rig: Floats) -> RollOut:
    """Roll-outs of a set with the rig's values held."""
    late, x, y = rig.tolist()
    model = with_effects(
        one.bench.baseline.model,
        {},
        fixed={
            "camera_latency": {"time_ms": late},
            "camera_anisotropy": {"x_percent": x, "y_percent": y},
        },
    )
    return rolled_out(one.bench, model, one.own.values[:2])


def error_words(bench: Bench, found: RollOut, seed: int) -> str:
    """Root mean square of place and turn with its interval, and the median over recordings."""
    away = bench.prepared.seen - found.poses
    place = np.nansum(np.sum(away[..., :2] ** 2, axis=2), axis=1)
    turn = np.nansum(away[..., 2] ** 2, axis=1)
    count = np.sum(np.all(np.isfinite(away), axis=2), axis=1)
    drawn = np.random.default_rng([seed, 3]).integers(0, len(count), (_RESAMPLED, len(count)))
    low, high = np.quantile(
        1e3 * np.sqrt(place[drawn].sum(axis=1) / count[drawn].sum(axis=1)), [_TAIL, 1.0 - _TAIL]
    )
    whole = 1e3 * np.sqrt(place.sum() / count.sum())
    degrees = np.degrees(np.sqrt(turn.sum() / count.sum()))
    usual = 1e3 * np.median(np.sqrt(place / count))
    return f"{whole:.2f} [{low:.2f}, {high:.2f}] mm, {degrees:.2f}°; median {usual:.2f}"


def report(sets: Sequence[Measured], seed: int) -> str:
    """The page."""
    text = HEAD
    text += (
        "| set | recordings | delay, ms | scale x, % | scale y, % |\n|---|---:|---:|---:|---:|\n"
    )
    for one in sets:
        errors = 2.0 * np.sqrt(np.diag(np.linalg.inv(one.information)))
        told = " | ".join(f"{v:.1f} ± {e:.1f}" for v, e in zip(one.values, errors, strict=True))
        text += f"| {one.name} | {len(one.bench.fold)} | {told} |\n"
    middle, spread = pooled(sets)
    told = " | ".join(f"{v:.1f} ± {2 * e:.1f}" for v, e in zip(middle, spread, strict=True))
    text += f"| all (median; spread of sets) | | {told} |\n\n"
    text += (
        "| set | rig values, from the other sets | plain | rig, out of set | own, out of fold |\n"
    )
    text += "|---|---|---:|---:|---:|\n"
    for one in sets:
        rig, _ = pooled([other for other in sets if other is not one])
        found = predicted_by_rig(one, rig)
        values = f"{rig[0]:.0f} ms, {rig[1]:.1f} %, {rig[2]:.1f} %"
        cells = [error_words(one.bench, each, seed) for each in (one.plain, found, one.own)]
        text += f"| {one.name} | {values} | {' | '.join(cells)} |\n"
    return text


def main(arguments: Sequence[str] | None = None) -> None:
    """Fit every set, predict each from the others, and write the page."""
    parser = argparse.ArgumentParser(prog="python -m reports.one_rig", description=__doc__)
    parser.add_argument("--recordings", type=Path, required=True)
    parser.add_argument("--out", type=Path, default=Path(__file__).with_name("results.md"))
    parser.add_argument("--seed", type=int, default=0)
    given = parser.parse_args(arguments)
    folders = sorted(
        one
        for one in given.recordings.iterdir()
        if one.is_dir() and one.name.split("_")[0] not in NO_OUTLINE
    )
    sets = []
    for folder in folders:
        sets.append(measured(folder, given.seed))
        print(folder.name, sets[-1].values, flush=True)
    write_all(given.out.parent, {given.out.name: report(sets, given.seed)})


if __name__ == "__main__":
    main(sys.argv[1:])
