"""How long a diagnosis takes: ``python -m reports.benchmarks.diagnosis``.

Twenty recordings of the blind generator, without a mismatch and with three effects, quick and in full, after
one diagnosis that warms up; wall and processor time, of the process and of its copy. As the command line does, it
takes one thread of the linear algebra and lets the process be copied.
"""

from __future__ import annotations

import os
import tempfile
import time
from pathlib import Path

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # before NumPy is imported

from meso_robust.copies import allow
from meso_robust.diagnosis.answer import diagnosed
from reports.blind.generator import Case, make, write

RECORDINGS = 20
CASES = (
    Case(kind="null", seed=900),
    Case(kind="effect", names=("camera_latency",), multiples=(8.0,), seed=901),
    Case(kind="effect", names=("dry_friction",), multiples=(8.0,), seed=902),
    Case(kind="outside", names=("constant_moment",), multiples=(8.0,), seed=903),
)
LIMITS = {True: 15.0, False: 120.0}


def main() -> None:
    """Print a table."""
    allow()
    print(f"{os.cpu_count()} cores, load {os.getloadavg()[0]:.1f} before the start")
    with tempfile.TemporaryDirectory() as name:
        folders = []
        for k, case in enumerate(CASES):
            folders.append(Path(name) / str(k))
            write(make(case, recordings=RECORDINGS), folders[-1])
        diagnosed(folders[0], quick=True)
        for quick, limit in LIMITS.items():
            for case, folder in zip(CASES, folders, strict=True):
                before, worked = time.perf_counter(), _processor()
                found = diagnosed(folder, quick=quick)
                wall, processor = time.perf_counter() - before, _processor() - worked
                print(
                    f"{'quick' if quick else 'full':6}{' + '.join(case.names) or 'nothing':18}"
                    f"{found['verdict']:12}{wall:7.1f} s wall {processor:7.1f} s processor "
                    f"(to reach: {limit:.0f} s)",
                    flush=True,
                )


def _processor() -> float:
    """Processor time in s of this process and of copies that have ended."""
    return sum(os.times()[:4])


if __name__ == "__main__":
    main()
