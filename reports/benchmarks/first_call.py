"""Seconds to the first result of a process: ``python -m reports.benchmarks.first_call``.

Prints the time to import, to the first result of the time stepper and of the event-driven engine.
"""

import time

START = time.perf_counter()

import numpy as np  # noqa: E402 (the clock runs while importing)

from meso_robust.simulator import simulate  # noqa: E402
from meso_robust.simulator.events import integrate  # noqa: E402
from reports.benchmarks.one_push import BOX, MM, RADIUS, TIP, grounds, push  # noqa: E402


def main() -> None:
    """Print the three times in s."""
    imported = time.perf_counter()
    simulate(push(grounds()[0], 100))
    stepped = time.perf_counter()
    integrate(
        vertices=BOX * MM,
        poses=np.zeros((1, 3)),
        tips=TIP[None, None] * MM,
        travel=np.array([[[0.0, MM]]]),
        friction=np.zeros((1, 1)),
        drag=np.diag([1.0, 1.0, MM**2]),
        radii=np.array([RADIUS * MM]),
    )
    followed = time.perf_counter()
    print(imported - START, stepped - imported, followed - stepped)


if __name__ == "__main__":
    main()
