"""Time to render a frame: ``python -m reports.benchmarks.microscope``."""

from __future__ import annotations

import time
from collections.abc import Callable

import cv2
import numpy as np

from meso_robust.microscope import Exposure, Probe, Scene, irradiance, reflected, render

_FRAMES = 100
_TIPS = np.array([[-3e-4, 6e-4], [9e-4, -6e-5]])


def _milliseconds(draw: Callable[[int], object]) -> float:
    """CPU time a call, after the first, which draws ahead what does not move."""
    draw(0)
    start = time.process_time()
    for k in range(_FRAMES):
        draw(k)
    return 1e3 * (time.process_time() - start) / _FRAMES


def _frame_of(scene: Scene, noise: bool) -> Callable[[int], object]:
    rng = np.random.default_rng(0)
    tips = _TIPS[: len(scene.probes)]

    def draw(k: int) -> object:
        pose = np.array([1e-4 + 1e-6 * k, 5e-5, 0.3])
        return render(scene, pose, tips, rng) if noise else irradiance(scene, pose, tips)

    return draw


def main() -> None:
    """Print a table."""
    cv2.setNumThreads(1)
    print("| 640 x 480 frame of the paper's part | CPU ms |\n|---|---|")
    probes = Probe(direction=2.6), Probe(direction=-0.6)
    for count in (1, 2):
        for quality, noise in ((90, True), (None, True), (None, False)):
            scene = reflected(probes=probes[:count], exposure=Exposure(jpeg_quality=quality))
            parts = f"{count} probe{'s' * (count > 1)}{', noise' * noise}{', JPEG' * bool(quality)}"
            print(f"| {parts} | {_milliseconds(_frame_of(scene, noise)):.1f} |")


if __name__ == "__main__":
    main()
