"""Speed of the whole tracker: ``python -m reports.benchmarks.tracking``.

A rendered push of 640 x 480 pixels (MJPG) is tracked by one thread and decoded by another, without the
overlay and the report. Processor time counts both; the clock is worth reading on a quiet machine only.
It asserts nothing about time.
"""

import tempfile
import time
from pathlib import Path

import cv2
import numpy as np

from meso_robust.tracking.calibration import Calibration
from meso_robust.tracking.frames import open_frames
from meso_robust.tracking.track import Scene, Start, track
from reports.benchmarks.timing import number, reached, table
from tests.tracking.pushes import PART, PIXEL, RADIUS, Filmed, push

FRAMES = 300
TARGET = 200.0  # frames a second


def scene_of(filmed: Filmed, probes: bool) -> Scene:
    """What is stated of the push."""
    x, y = filmed.tips[0, 0].tolist()
    return Scene(
        outline=PART,
        tip_radius=RADIUS,
        calibration=Calibration(pixel_size=PIXEL, size=(640, 480)),
        pose=np.array([np.nan, np.nan, 0.0]),
        probes=(Start(name="probe1", tip=(x, y)),) if probes else (),
    )


def row(filmed: Filmed, name: str, probes: bool) -> list[str]:
    """Cells of one way of tracking: processor time, so that a shared machine matters less; the clock."""
    scene = scene_of(filmed, probes)
    track(open_frames(filmed.path), scene)  # compiles
    marks: list[float] = []
    start, clock = time.process_time(), time.perf_counter()
    track(open_frames(filmed.path), scene, lambda: marks.append(time.process_time()))
    whole, waited = time.process_time() - start, time.perf_counter() - clock
    after_first = (len(marks) - 1) / (marks[-1] - marks[0])
    total = len(marks) / whole
    by_clock = len(marks) / waited
    target = reached(by_clock, TARGET) if probes else ("", "")
    return [name, number(total), number(after_first), number(by_clock), *target]


def main() -> None:
    """Print the table."""
    cv2.setNumThreads(1)
    with tempfile.TemporaryDirectory() as folder:
        filmed = push(Path(folder) / "push.avi", FRAMES, speed=2e-6)
        start = time.process_time()
        count = sum(1 for _ in open_frames(filmed.path))
        decoding = count / (time.process_time() - start)
        heads = [
            "640 x 480, MJPG",
            "frames/s of CPU",
            "after the first",
            "by the clock",
            "target",
            "met",
        ]
        rows = [
            ["decoding alone", number(decoding), "", "", "", ""],
            row(filmed, "part", probes=False),
            row(filmed, "part and probe", probes=True),
        ]
    print("\n".join(table(f"Tracking {FRAMES} frames", heads, rows)))


if __name__ == "__main__":
    main()
