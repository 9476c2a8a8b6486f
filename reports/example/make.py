"""Makes the videos and the calibration grid of the shipped example: ``python -m reports.example.make``.

The files are committed; the truth about them stays in `reports.example.experiment`.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import cv2
import numpy as np

import meso_robust
from meso_robust.microscope import (
    Exposure,
    Metal,
    Oil,
    Optics,
    Part,
    Probe,
    Scene,
    film,
    grid_image,
    rectangle,
)
from reports.example.experiment import LENGTH, PLANS, TIP_RADIUS, WIDTH, Motion, Plan, moved

UM = 1e-6
FOLDER = Path(meso_robust.__file__).parent / "example"
OPTICS = Optics(pixel_size=5.2e-6, width=560, height=420)
PITCH = 200e-6


def main() -> None:
    """Write everything that is drawn."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=Path, default=FOLDER)
    out = parser.parse_args().out
    videos = out / "videos"
    videos.mkdir(parents=True, exist_ok=True)
    grid = grid_image(OPTICS, PITCH, "dots", exposure=Exposure(), rng=np.random.default_rng(0))
    cv2.imwrite(str(out / "grid.png"), grid, [cv2.IMWRITE_PNG_COMPRESSION, 9])
    for number, plan in enumerate(PLANS):
        motion = moved(plan)
        film(
            videos / f"push_{number}.mp4",
            scene(plan),
            motion.times,
            motion.poses * [UM, UM, 1.0],
            motion.tips[:, None] * UM,
            np.random.default_rng(number),
        ).unlink()  # the truth is not shipped
        (videos / f"push_{number}.csv").write_text(log(motion), encoding="utf-8")


def log(motion: Motion) -> str:
    """What the controller, which also triggers the camera, writes down."""
    rows = np.column_stack([motion.times, motion.tips])
    lines = [f"{time:.2f},{x:.2f},{y:.2f}" for time, x, y in rows]
    return "\n".join(["time_s,probe1_x_um,probe1_y_um", *lines, ""])


def scene(plan: Plan) -> Scene:
    """What the camera sees of a push: probes reach in from the side that they push from."""
    needle = Probe(tip_radius=TIP_RADIUS * UM, direction=plan.behind + 0.2)
    return Scene(
        part=Part(outline=rectangle(LENGTH * UM, WIDTH * UM), metal=Metal(seed=7)),
        probes=(needle,),
        oil=Oil(seed=9),
        optics=OPTICS,
        exposure=Exposure(vignetting=0.1),
    )


if __name__ == "__main__":
    main()
