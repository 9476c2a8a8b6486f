"""What designs are worth: ``python -m reports.identification.design_report --sets 100 --out DIR``."""

from __future__ import annotations

import argparse
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import numpy.typing as npt

from meso_robust.identification.design import DETERMINANT, QUANTILE, design, intervals
from meso_robust.identification.experiment import PlannedPush
from meso_robust.identification.information import information, prior
from meso_robust.identification.rollout import Setting
from meso_robust.recordings import SensorInfo
from reports.identification.refit import RATE, SIGMAS, recorded, refit
from tests.identification.table_one import FILM, P1, POINTS, TESTS, VISCOUS

F = npt.NDArray[np.float64]

SENSOR = SensorInfo(
    frame_rate=RATE, position_sigma=float(SIGMAS[0]), orientation_sigma=float(SIGMAS[2])
)
FINER = 0.25
"""Of the film's step in fits: designed pushes tell more than the model's own step is good for."""

TEXT = """# What a designed experiment is worth

Command: `python -m reports.identification.design_report --sets {sets} --out reports/identification`

Eight pushes each: tests A–H of the paper once, against a set designed at nominal parameters. Every row of the
tables is from refits of noisy simulated motion (1.2 µm, 0.08°, {rate:.0f} frames a second, parts laid down within
5 µm and 0.3°), by a dense Gauss–Newton fit of parameters and starts that shares only the simulator with the design. The truth
of every set differs from the nominal values for which the pushes were chosen. On the film the data come from the
event-driven engine, the fits use the stepper. The model is the right one throughout: with a wrong one no interval
here holds.

{cases}
"""

CASE = """## {title}

Truth: {truth}. {count} sets, {seconds:.0f} s; {failed} more left out, as the simulator did not
come to the end of their data.

| parameter | {heads} |
|---|{rules}|
{rows}

{names}
"""


@dataclass(frozen=True)
class Outcomes:
    """Errors in coordinates of S sets, and deviations claimed by the fits."""

    errors: F
    deviations: F

    @property
    def rms(self) -> F:
        return np.asarray(np.sqrt(np.mean(self.errors**2, axis=0)))

    @property
    def coverage(self) -> F:
        return np.asarray(np.mean(np.abs(self.errors) <= QUANTILE * self.deviations, axis=0))


def compare(
    setting: Setting,
    nominal: F,
    spread: F,
    plans: Mapping[str, Sequence[PlannedPush]],
    sets: int,
    seed: int,
) -> tuple[dict[str, Outcomes], int]:
    """Refit every plan on the same truths, drawn evenly within a spread of coordinates.

    Also says how many sets were left out because the data could not be simulated to their end.
    """
    model = setting.model
    rng = np.random.default_rng(seed)
    here = model.coordinates(nominal[None])
    found: dict[str, list[tuple[F, F]]] = {name: [] for name in plans}
    done = failed = 0
    while done < sets:
        truth = model.values(here + spread * rng.uniform(-1.0, 1.0, here.shape))
        if not model.valid(truth)[0]:
            continue
        row: dict[str, tuple[F, F]] = {}
        data = {name: recorded(setting, pushes, truth[0], rng) for name, pushes in plans.items()}
        if any(seen is None for seen in data.values()):
            failed += 1
            continue
        for name, pushes in plans.items():
            seen = data[name]
            assert seen is not None
            fit = refit(setting, pushes, seen, nominal)
            away = model.coordinates(fit.values[None]) - model.coordinates(truth)
            row[name] = (away[0], fit.deviations)
        for name, result in row.items():
            found[name].append(result)
        done += 1
    return {
        name: Outcomes(np.array([a for a, _ in rows]), np.array([d for _, d in rows]))
        for name, rows in found.items()
    }, failed


def plans_of(
    setting: Setting, nominal: F, criteria: Sequence[str]
) -> dict[str, Sequence[PlannedPush]]:
    """Tests A–H, and a design of as many pushes by each criterion."""
    plans: dict[str, Sequence[PlannedPush]] = {"A–H": TESTS.pushes}
    for criterion in criteria:
        found = design(setting, nominal, SENSOR, len(TESTS.pushes), criterion=criterion)
        plans[f"designed ({criterion})"] = found.experiment.pushes
    return plans


def case(
    title: str, truth: str, setting: Setting, nominal: F, spread: F, *, sets: int, named: str
) -> str:
    began = time.perf_counter()
    plans = plans_of(setting, nominal, (DETERMINANT, named))
    found, failed = compare(setting, nominal, spread, plans, sets, seed=1)
    base = prior(setting.model)
    half = {}
    for name, pushes in plans.items():
        told = information(setting, pushes, nominal, SENSOR).matrices.sum(axis=0)
        half[name] = np.array(
            [0.5 * (one.high - one.low) for one in intervals(setting.model, nominal, base + told)]
        )
    rows = []
    slope = setting.model.values(setting.model.coordinates(nominal[None]) + 1e-6) - nominal
    for k, parameter in enumerate(setting.model.parameters):
        if parameter.unseen:
            rows.append(f"| {parameter.key} | {' | '.join(['not identifiable'] * len(plans))} |")
            continue
        unit = abs(float(slope[0, k])) / 1e-6 / parameter.to_si
        first = found["A–H"].rms[k]
        cells = []
        for name, result in found.items():
            times = "" if name == "A–H" else f", {first / result.rms[k]:.1f} × less"
            cells.append(
                f"{result.rms[k] * unit:.3g}{times} (±{half[name][k] / parameter.to_si:.3g}; "
                f"{100.0 * result.coverage[k]:.0f} %)"
            )
        rows.append(f"| {parameter.key} | {' | '.join(cells)} |")
    names = "\n".join(
        f"- {name}: {', '.join(f'`{push.name}`' for push in pushes)}"
        for name, pushes in plans.items()
    )
    return CASE.format(
        title=title,
        truth=truth,
        count=sets,
        failed=failed,
        seconds=time.perf_counter() - began,
        heads=" | ".join(f"{name}: RMS error (predicted 90 %; covered)" for name in plans),
        rules="|".join(["---"] * len(plans)),
        rows="\n".join(rows),
        names=names,
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--sets", type=int, default=100)
    parser.add_argument("--out", type=Path, required=True)
    given = parser.parse_args()
    given.out.mkdir(parents=True, exist_ok=True)
    cases = [
        case(
            "Film",
            "ρ within 5 % of 0.3769 mm², µ within 0.03 of 0.33",
            replace(FILM, model=replace(FILM.model, step=FINER * FILM.model.step)),
            VISCOUS,
            np.array([0.05, 0.03]),
            sets=given.sets,
            named="rho_um2",
        ),
        case(
            "Three points",
            "p1\\* of Table I, µ_t within 0.03, every coordinate of a point within 18 µm",
            POINTS,
            P1,
            np.array([0.03, 0.0] + [0.02] * 6),
            sets=max(given.sets // 4, 2),
            named="mu_t",
        ),
    ]
    page = TEXT.format(sets=given.sets, rate=RATE, cases="\n".join(cases))
    (given.out / "design.md").write_text(page.rstrip() + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
