"""How long a fit takes: ``python -m reports.benchmarks.identification``.

Twenty recordings of 600 µm (240 frames each) and twenty random starts, both models, after one fit that
warms up; wall and processor time.
"""

from __future__ import annotations

import os
import time
from dataclasses import replace
from pathlib import Path

import numpy as np

from meso_robust.identification.identify import Objective, identify
from meso_robust.recordings import RecordingSet
from meso_robust.recordings.writing import write_set
from meso_robust.simulator import Film, ThreePoints
from tests.identification.sets import FIRST_TABLE_POINTS, random_pushes, recorded

RECORDINGS = STARTS = 20
MODELS: tuple[tuple[str, Objective, float], ...] = (
    ("viscous", "likelihood", 10.0),
    ("viscous", "printed", 10.0),
    ("three_point", "likelihood", 60.0),
    ("three_point", "printed", 60.0),
)


def made(model: str) -> RecordingSet:
    """A set whose truth is the paper's film, or its first set of support points."""
    rng = np.random.default_rng(1)
    pushes = random_pushes(rng, RECORDINGS)
    if model == "viscous":
        return recorded(pushes, Film.ratio(np.full(RECORDINGS, 0.3769e-6)), 0.33, rng)
    return recorded(pushes, ThreePoints(points=FIRST_TABLE_POINTS), 0.5, rng)


def write(folder: str) -> None:
    """Write a set of one recording of 240 frames."""
    one = made("viscous")
    write_set(Path(folder), replace(one, recordings=one.recordings[:1]))


def main() -> None:
    """Print a table."""
    print(f"{os.cpu_count()} cores, load {os.getloadavg()[0]:.1f} before the start")
    for model, objective, limit in MODELS:
        recordings = made(model)
        identify(recordings, model=model, starts=2, objective=objective)
        before, worked = time.perf_counter(), time.process_time()
        identify(recordings, model=model, starts=STARTS, objective=objective)
        wall, processor = time.perf_counter() - before, time.process_time() - worked
        print(
            f"{model:12} {objective:11} {wall:7.2f} s wall {processor:7.2f} s processor "
            f"(to reach: {limit:.0f} s)"
        )


if __name__ == "__main__":
    main()
