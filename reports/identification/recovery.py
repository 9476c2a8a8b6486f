"""Whether stated intervals cover the truth: ``python -m reports.identification.recovery --sets 200``.

Every set has a random truth, random pushes, noise, lost frames, and tips whose positions are the
controller's or seen by the camera. It is fitted from random starts that know nothing of the truth.
"""

from __future__ import annotations

import argparse
import json
import time
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import asdict, dataclass, replace
from itertools import repeat
from multiprocessing import get_context
from pathlib import Path

import numpy as np
import numpy.typing as npt
from scipy.stats import beta

from meso_robust.errors import InputError
from meso_robust.identification.identify import Identification, identify
from meso_robust.identification.models import MODELS
from meso_robust.kernels import one_thread
from meso_robust.recordings import PositionSource, RecordingSet
from meso_robust.simulator import Film, ThreePoints
from tests.identification.sets import PART, random_pushes, recorded

Floats = npt.NDArray[np.float64]

NOMINAL = 0.9
FAR_OFF = 5.0


@dataclass(frozen=True, slots=True, eq=False)
class Case:
    """A set and its truth, (n,) in SI."""

    recordings: RecordingSet
    truth: Floats


@dataclass(frozen=True, slots=True)
class Result:
    """What the fit of one set gave, by parameter."""

    model: str
    seed: int
    starts: int
    keys: Sequence[str] = ()
    covered: Sequence[bool] = ()
    errors: Sequence[float] = ()
    """Value less truth over half the interval."""
    widths: Sequence[float] = ()
    """Half the interval over the parameter's scale; infinite if it is open."""
    seconds: float = 0.0
    refused: str = ""
    """Why the set could not be fitted, or empty."""


def case(model: str, seed: int) -> Case:
    """A random truth and its recordings, the tips seen by the camera in every second set."""
    rng = np.random.default_rng([seed, len(model)])
    chosen = MODELS[model](PART.outline)
    truth = chosen.draw(rng, 1)
    pushes = random_pushes(rng, int(rng.integers(8, 15)))
    if model == "viscous":
        truth[0, 1] = rng.uniform(0.1, 0.7)
        support: Film | ThreePoints = Film.ratio(np.full(len(pushes.poses), truth[0, 0]))
        friction = float(truth[0, 1])
    else:
        truth[0, 0] = rng.uniform(0.1, 0.7)
        truth = chosen.alike(truth)
        support = ThreePoints(points=truth[0, 2:].reshape(3, 2))
        friction = float(truth[0, 0])
    source: PositionSource = "camera" if seed % 2 else "controller"
    return Case(recorded(pushes, support, friction, rng, source=source), truth[0])


def compared(made: Case, found: Identification, one: Result) -> Result:
    """Intervals against the truth, support points in the order that fits best."""
    chosen = MODELS[one.model](PART.outline)
    truth = matched(one.model, made.truth, found.best)
    columns = [chosen.keys.index(profile.key) for profile in found.profiles]
    low = np.array([p.low if not p.open_low else -np.inf for p in found.profiles])
    high = np.array([p.high if not p.open_high else np.inf for p in found.profiles])
    half = 0.5 * (high - low)
    scale = np.array([p.scale for p in chosen.parameters])[columns]
    return replace(
        one,
        keys=[profile.key for profile in found.profiles],
        covered=((truth[columns] >= low) & (truth[columns] <= high)).tolist(),
        errors=((found.best - truth)[columns] / half).tolist(),
        widths=(half / scale).tolist(),
    )


def matched(model: str, truth: Floats, fitted: Floats) -> Floats:
    """The truth with its support points in the order nearest to those fitted."""
    if model != "three_point":
        return truth
    orders = [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]]
    points = truth[2:].reshape(3, 2)
    away = [np.sum((points[o].ravel() - fitted[2:]) ** 2) for o in orders]
    return np.concatenate([truth[:2], points[orders[int(np.argmin(away))]].ravel()])


def fitted(model: str, seed: int, starts: int) -> Result:
    """One set made and fitted; `Result.refused` says why it could not be."""
    made = case(model, seed)
    before = time.perf_counter()
    try:
        with one_thread():  # each core has a process of its own
            found = identify(made.recordings, model=model, starts=starts, seed=seed)
    except InputError as error:
        return Result(model, seed, starts, refused=str(error))
    seconds = time.perf_counter() - before
    return compared(made, found, Result(model, seed, starts, seconds=seconds))


def campaign(
    model: str, sets: int, starts: int, workers: int = 1, ledger: Path | None = None
) -> list[Result]:
    """Fit the sets that the ledger (JSON lines) does not have yet, and keep each as it ends."""
    known = {(one.model, one.seed, one.starts): one for one in _kept(ledger)}
    open_ones = [seed for seed in range(sets) if (model, seed, starts) not in known]
    if workers == 1:
        fresh = map(fitted, repeat(model), open_ones, repeat(starts))
        done = [_keep(one, ledger) for one in fresh]
    else:
        with ProcessPoolExecutor(workers, mp_context=get_context("spawn")) as pool:
            jobs = [pool.submit(fitted, model, seed, starts) for seed in open_ones]
            done = [_keep(job.result(), ledger) for job in as_completed(jobs)]
    known |= {(one.model, one.seed, one.starts): one for one in done}
    return [known[model, seed, starts] for seed in range(sets)]


def _kept(ledger: Path | None) -> list[Result]:
    if ledger is None or not ledger.exists():
        return []
    return [Result(**json.loads(line)) for line in ledger.read_text(encoding="utf-8").splitlines()]


def _keep(one: Result, ledger: Path | None) -> Result:
    if ledger is not None:
        with ledger.open("a", encoding="utf-8") as file:
            file.write(json.dumps(asdict(one)) + "\n")
    return one


def table(model: str, every: Sequence[Result]) -> list[str]:
    """Coverage by parameter, in Markdown."""
    results = [one for one in every if not one.refused]
    refused = [one for one in every if one.refused]
    lines = [
        f"## {model}: {len(every)} sets, from {every[0].starts} random starts each",
        "",
        "| parameter | covered | share | 95 % of the share | median half width / scale | closed |",
        "|---|---|---|---|---|---|",
    ]
    for k, key in enumerate(results[0].keys):
        hits = sum(int(one.covered[k]) for one in results)
        low, high = clopper(hits, len(results))
        widths = np.array([one.widths[k] for one in results])
        closed = int(np.isfinite(widths).sum())
        lines.append(
            f"| {key} | {hits}/{len(results)} | {hits / len(results):.3f} | {low:.3f} … {high:.3f} | "
            f"{np.median(widths):.2g} | {closed} |"
        )
    seconds = np.array([one.seconds for one in results])
    lines += ["", f"Median {np.median(seconds):.2f} s a fit, longest {seconds.max():.2f} s.", ""]
    named = [f"- set {one.seed}: {one.refused}" for one in refused]
    lines += [f"More than {FAR_OFF:g} half widths off: {_far_off(results)}.", ""]
    return [*lines, f"Refused: {len(refused)}.", *named, ""]


def _far_off(results: Sequence[Result]) -> str:
    """Sets whose worst parameter is that far from the truth, the worst first."""
    worst = {one.seed: max(abs(error) for error in one.errors) for one in results}
    far = sorted((off, seed) for seed, off in worst.items() if off > FAR_OFF)
    return ", ".join(f"set {seed} ({off:,.1f})" for off, seed in reversed(far)) or "none"


def clopper(hits: int, count: int) -> tuple[float, float]:
    """Exact 95 % interval of a share."""
    low = float(beta.ppf(0.025, hits, count - hits + 1)) if hits else 0.0
    high = float(beta.ppf(0.975, hits + 1, count - hits)) if hits < count else 1.0
    return low, high


def main() -> None:
    """Run the campaign, going on where it stands, and write the report."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--sets", type=int, default=200)
    parser.add_argument("--three-point-sets", type=int, default=200)
    parser.add_argument("--starts", type=int, default=6)
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--out", type=Path, default=Path("reports/identification"))
    asked = parser.parse_args()
    asked.out.mkdir(parents=True, exist_ok=True)
    lines = [
        "# Parameters recovered from simulated recordings",
        "",
        f"Nominal coverage {NOMINAL:.0%}. Every set has a truth of its own (drawn as the model draws "
        "its starts, friction 0.1 … 0.7), 8 to 14 random slanted pushes of 600 µm at 75 µm/s with one "
        "round tip (12.5 µm), 30 frames/s, σ = 1.2 µm and 0.08°, 3 % of the frames lost; in every "
        "second set the tips are seen by the camera with the same noise. Motion on the film is from "
        "the event-driven engine, on three points from the stepper at 1 and 0.5 µm, extrapolated to "
        "steps of no length. `python -m reports.identification.recovery`, which goes on from "
        "`recovery.jsonl`.",
        "",
    ]
    for model, sets in (("viscous", asked.sets), ("three_point", asked.three_point_sets)):
        if sets:
            ledger = asked.out / "recovery.jsonl"
            done = campaign(model, sets, asked.starts, asked.workers, ledger)
            lines += table(model, done)
            (asked.out / "recovery.md").write_text("\n".join(lines), encoding="utf-8")


if __name__ == "__main__":
    main()
