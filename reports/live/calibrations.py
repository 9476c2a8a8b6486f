"""Whether a calibration's stated error covers: ``python -m reports.live.calibrations [--seeds 50]``.

Continues where it was stopped.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np

from meso_robust.files import write_all
from meso_robust.live.calibrating import calibrate, grid
from meso_robust.live.loading import calibrated
from meso_robust.live.placing import tip_places
from meso_robust.live.virtual_bench import REPEATS, laboratory_of, uncalibrated_lab
from meso_robust.task import load_task
from meso_robust.tasks import MICROSCOPE

OUT = Path(__file__).parent
RESULTS, PAGE = "calibrations.json", "calibrations.md"
RATE = 2.0  # frames a second


@dataclass(frozen=True, slots=True, kw_only=True)
class Measured:
    """One manipulator of one laboratory."""

    seed: int
    name: str
    stated_um: float
    """What the calibration says that a tip may be off."""
    true_um: float
    """What one is off at most among the places of the grid, with what the manipulator does not repeat."""
    stated_deg: float
    true_deg: float
    """Of the axes' direction, any of them."""
    stated_percent: float
    true_percent: float
    probe_position_um: float
    """What a task must state."""

    @property
    def covered(self) -> bool:
        """Whether all three stated errors hold the true ones."""
        return (
            self.true_um <= self.stated_um
            and self.true_deg <= self.stated_deg
            and self.true_percent <= self.stated_percent
        )


def one_laboratory(seed: int) -> list[Measured]:
    """Calibrate a laboratory whose file is a little wrong, and compare with what is true of it."""
    task = load_task(MICROSCOPE)
    lab = uncalibrated_lab(task, seed)
    virtual = lab.virtual.model_copy(update={"frame_rate_hz": RATE})
    lab = lab.model_copy(update={"virtual": virtual})
    laboratory = laboratory_of(task, lab)
    document = calibrate(laboratory.devices(), lab)
    rows = []
    for stated, one in zip(lab.manipulators, calibrated(lab, document).manipulators, strict=True):
        true = laboratory.truth.manipulators[one.name]
        off = [
            float(np.abs(tip - tip_places(true, place)[name]).max())
            for place in grid(lab, stated)
            for name, tip in tip_places(one, place).items()
        ]
        turn = np.linspace(0.0, 2.0 * np.pi, 73)
        ways = np.array([np.cos(turn), np.sin(turn)])  # in the world, where both should go
        gone = np.array(true.axes) @ np.linalg.inv(np.array(one.axes)) @ ways
        across = ways[0] * gone[1] - ways[1] * gone[0]
        along = (ways * gone).sum(axis=0)
        rows.append(
            Measured(
                seed=seed,
                name=one.name,
                stated_um=round(one.tip_error_um, 4),
                true_um=round(max(off) + REPEATS, 4),
                stated_deg=round(one.direction_error_deg, 5),
                true_deg=round(float(np.degrees(np.arctan2(across, along)).max()), 5),
                stated_percent=round(one.scale_error_percent, 5),
                true_percent=round(100.0 * float(np.abs(np.hypot(*gone) - 1.0).max()), 5),
                probe_position_um=document.probe_position_um,
            )
        )
    return rows


def page(rows: Sequence[Measured]) -> str:
    """The results in Markdown."""
    lines = [
        "# Does a calibration's stated error cover?",
        "",
        "Written by `python -m reports.live.calibrations`; see the [README](README.md).",
        "",
        f"{len({row.seed for row in rows})} virtual laboratories whose files are wrong by up to 10 um, 0.3 deg "
        f"and 0.3 %; {len(rows)} manipulators that repeat to {REPEATS:g} um; pixels of 5.26 um.",
        "",
        "| error | stated (median, largest) | true (median, largest) | covered |",
        "|---|---|---|---|",
    ]
    for what, unit in (
        ("um", "of a tip, um"),
        ("deg", "of a travel's direction, deg"),
        ("percent", "of its length, %"),
    ):
        stated, true = (
            np.array([getattr(row, f"{kind}_{what}") for row in rows])
            for kind in ("stated", "true")
        )
        lines.append(
            f"| {unit} | {np.median(stated):.3f}, {stated.max():.3f} | {np.median(true):.3f}, "
            f"{true.max():.3f} | {(true <= stated).sum()} of {len(rows)} |"
        )
    probe = [row.probe_position_um for row in rows]
    lines += [
        "",
        f"A task must state `probe_position_um` of {np.median(probe):.2f} (median), {max(probe):.2f} (largest).",
    ]
    return "\n".join(lines) + "\n"


def main() -> int:
    """Calibrate; exit status 1 if an error was not covered."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", type=int, default=50)
    parser.add_argument("--out", type=Path, default=OUT)
    asked = parser.parse_args()
    path = asked.out / RESULTS
    rows = [Measured(**row) for row in json.loads(path.read_text("utf-8"))] if path.exists() else []
    for seed in sorted(set(range(asked.seeds)) - {row.seed for row in rows}):
        rows += one_laboratory(seed)
        text = ",\n".join(json.dumps(asdict(row)) for row in rows)
        write_all(asked.out, {RESULTS: f"[\n{text}\n]\n", PAGE: page(rows)})
    return 0 if all(row.covered for row in rows) else 1


if __name__ == "__main__":
    sys.exit(main())
