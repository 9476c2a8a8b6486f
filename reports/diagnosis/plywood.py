"""What each law adds on one real set of single pushes: ``python -m reports.diagnosis.plywood --help``.

``--recordings`` names the folder of `reports.diagnosis.real_report`; of it ``mit_plywood`` is used. Laws are added one
after the other, in the order in which they stand here; nothing is searched, so that no set is chosen by the
recordings that judge it.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from meso_robust.diagnosis.baseline import fitted_baseline
from meso_robust.diagnosis.folds import Bench, RollOut, bench_of, rolled_out, weights_of
from meso_robust.diagnosis.noise import noise_of, with_noise
from meso_robust.files import write_all
from meso_robust.identification.likelihood import fit
from meso_robust.identification.models import Model, with_effects
from meso_robust.recordings.importers import FORMATS
from meso_robust.recordings.usable import usable_set
from meso_robust.types import Floats
from reports.one_rig.__main__ import error_words

Numbers = Mapping[str, Mapping[str, float]]


@dataclass(frozen=True, slots=True, kw_only=True)
class Law:
    """A law that is added.

    Attributes
    ----------
    words
        For the page.
    scales
        ``{effect: {key: typical change}}`` of its fitted numbers.
    begins
        (K, k) values that a search begins at, in the units of the keys.
    held
        ``{effect: {key: value}}``.
    """

    words: str
    scales: Numbers
    begins: tuple[tuple[float, ...], ...]
    held: Numbers


LAWS = (
    Law(
        words="drag that differs along a direction of the stage",
        scales={"anisotropic_drag": {"fraction": 0.05, "direction_deg": 20.0}},
        begins=tuple((0.2, lay) for lay in (0.0, 45.0, 90.0, 135.0)),
        held={},
    ),
    Law(
        words="registration of camera and robot",
        scales={"registration_shift": {"x_um": 170.0, "y_um": 170.0}},
        begins=((0.0, 0.0),),
        held={},
    ),
    Law(
        words="yaw of the part's frame",
        scales={"part_yaw": {"angle_deg": 0.2}},
        begins=((0.0,),),
        held={},
    ),
    Law(
        words="reference point off the centre",
        scales={"reference_offset": {"x_um": 170.0, "y_um": 170.0}},
        begins=((0.0, 0.0),),
        held={},
    ),
    Law(
        words="dry friction, pressure at the rim",
        scales={"dry_friction": {"ratio": 130.0}},
        begins=((100.0,), (1000.0,)),
        held={"dry_friction": {"form": 1.0}},
    ),
)


def laddered(folder: Path, seed: int) -> tuple[Bench, list[tuple[str, RollOut]]]:
    """Roll-outs of the plain model, and with one law more each."""
    found = usable_set(FORMATS["mcube_json"].read(folder).recordings).recordings
    noise = noise_of(found)
    recordings = with_noise(found, noise)
    baseline = fitted_baseline(
        recordings, noise, "viscous", quick=True, seed=seed, told=lambda *_: None
    )
    bench = bench_of(recordings, baseline, seed)
    rungs = [("plain", rolled_out(bench, baseline.model, baseline.fits.values[0]))]
    scales: dict[str, Mapping[str, float]] = {}
    held: dict[str, Mapping[str, float]] = {}
    for law in LAWS:
        scales |= law.scales
        held |= law.held
        model = with_effects(baseline.model, scales, held)
        begun = _begun(bench, model, rungs[-1][1].values, law)
        rungs.append((law.words, rolled_out(bench, model, begun)))
        print(law.words, error_words(bench, rungs[-1][1], seed), flush=True)
    return bench, rungs


def _begun(bench: Bench, model: Model, before: Floats, law: Law) -> Floats:
    """(n,) the best fit from every place to begin at."""
    added = model.parameters[len(before) :]
    units = np.array([one.to_si for one in added])
    begins = np.array([[*before, *(units * begin)] for begin in law.begins])
    settings = bench.baseline.settings.by_chord(8, 0.05)
    prepared = replace(bench.prepared, weights=weights_of(bench, model, begins[0]))
    found = fit(prepared, model, begins, settings).fits
    return np.asarray(found.values[np.nanargmin(found.chi2)])


HEAD = """# One real set of single pushes, law by law

Command: `python -m reports.diagnosis.plywood --recordings FOLDER` (`mit_plywood`: 20 pushes of a steel block of 90 mm
on plywood, robot arm and motion capture; no data is shipped here).

Every recording is predicted from the pose at rest to its end by a fit that has not seen its fold. Each row has the laws of
those above it, too. Root mean squares with 90 % intervals by bootstrap over recordings.

| with | out of fold | the law's numbers, and of the fits without a fold |
|---|---|---|
"""


def report(bench: Bench, rungs: Sequence[tuple[str, RollOut]], seed: int) -> str:
    """The page."""
    rows, known = "", len(rungs[0][1].values)
    for words, found in rungs:
        shown = np.array([found.model.shown(one) for one in (found.values, *found.by_fold)])
        first = 0 if len(found.values) == known else known
        told = ", ".join(
            f"{key} {shown[0, k]:.3g} ({shown[1:, k].min():.3g} … {shown[1:, k].max():.3g})"
            for k, key in enumerate(found.model.keys)
            if k >= first
        )
        known = len(found.values)
        rows += f"| {words} | {error_words(bench, found, seed)} | {told} |\n"
    return HEAD + rows


def main(arguments: Sequence[str] | None = None) -> None:
    """Add the laws and write the page."""
    parser = argparse.ArgumentParser(
        prog="python -m reports.diagnosis.plywood", description=__doc__
    )
    parser.add_argument("--recordings", type=Path, required=True)
    parser.add_argument("--out", type=Path, default=Path(__file__).with_suffix(".md"))
    parser.add_argument("--seed", type=int, default=0)
    given = parser.parse_args(arguments)
    folder = given.recordings / "mit_plywood"
    if not folder.is_dir():
        sys.stderr.write(f"{folder} is not here; nothing to do\n")
        return
    bench, rungs = laddered(folder, given.seed)
    write_all(given.out.parent, {given.out.name: report(bench, rungs, given.seed)})


if __name__ == "__main__":
    main(sys.argv[1:])
