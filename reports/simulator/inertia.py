"""How much inertia changes the path of the paper's part: ``python -m reports.simulator.inertia``.

The part is 1616 × 837 × 40 µm of beryllium copper. Its mass over the drag of the film is the time in
which it stops; the path of a 600 µm push is compared with the quasi-static one for such times from
10 µs to 1 s.
"""

import sys
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from meso_robust.simulator import Dynamic, Push, simulate
from tests.simulator.problems import HALF_LONG, HALF_SHORT, MU, RHO, UM, rectangle

F = npt.NDArray[np.float64]

THICKNESS = 40 * UM
DENSITY = 8250.0  # kg/m³, beryllium copper
DRAG = 12.8e-3  # N s/m, an oil of 0.1 Pa s in a film of 10 µm
SPEED = 75 * UM
TIMES = np.geomspace(1e-5, 1.0, 16)
PLACES = np.array([-700.0, -400.0, -150.0, 60.0, 250.0, 550.0]) * UM


def time_constant() -> float:
    """Mass over drag of the paper's part, s."""
    return 4 * HALF_LONG * HALF_SHORT * THICKNESS * DENSITY / DRAG


def _push(step: float) -> Push:
    """Tips at several places of the lower long edge that go up by 600 µm."""
    runs = len(PLACES)
    return Push.straight(
        vertices=rectangle(),
        poses=np.zeros((runs, 3)),
        tips=np.column_stack([PLACES, np.full(runs, -HALF_SHORT)])[:, None],
        travel=np.tile([[[0.0, 600 * UM]]], (runs, 1, 1)),
        friction=np.full(runs, MU),
        film_ratio=RHO,
        step=step,
        speed=SPEED,
        time_step=1e3,
    )


def differences(times: F, step: float = 1e-6) -> F:
    """Largest distance between the paths with and without inertia.

    Parameters
    ----------
    times
        (K,) mass over drag, s.
    step
        Of the tips, m; the same for both paths.

    Returns
    -------
    ndarray
        (K,) in m, over all places, all instants and all corners of the part.
    """
    push = _push(step)
    still = _corners(simulate(push, record=60).path)
    gyration = (HALF_LONG**2 + HALF_SHORT**2) / 3
    largest = []
    for time in times:
        motion = Dynamic(mass=float(time), inertia=float(time) * gyration)
        moved = _corners(simulate(replace(push, motion=motion), record=60).path)
        largest.append(np.abs(moved - still).max())
    return np.array(largest)


def _corners(path: F) -> F:
    """(N, R, 4) corners of the part as complex numbers."""
    corners = rectangle() @ np.array([1.0, 1.0j])
    at = path[..., 0] + 1j * path[..., 1]
    return np.asarray(at[..., None] + np.exp(1j * path[..., 2, None]) * corners)


def main() -> None:
    """Print the data of the figure."""
    own = time_constant()
    times = np.sort(np.append(TIMES, own))
    lines = [
        f"the paper's part: m / e_x = {1e6 * own:.1f} µs",
        "m / e_x in s, largest distance of a corner from the quasi-static path in µm",
    ]
    for time, away in zip(times, differences(times), strict=True):
        lines.append(f"{time:10.3e} {1e6 * away:12.5f}")
    sys.stdout.write("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
