"""At which spacing of two round tips a part jams: ``python -m reports.simulator.jam_thresholds --out F``.

The part, 837 um wide, is turned between a moving tip and one at rest on its opposite edge. Both
engines bisect the spacing of the tips' centres across the push at which the part just gets through;
beside it what balance and Coulomb's law give: ``w sqrt(1 + m^2) + (r + r') / sqrt(1 + m^2)`` with the
smaller m of both coefficients of friction.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import numpy.typing as npt

from meso_robust.files import write_all
from meso_robust.simulator import Outcome, Push, simulate
from meso_robust.simulator.exact import exact

UM = 1e-6
LENGTH, WIDTH, FILM_RATIO = 1616.0, 837.0, 0.3769e-6
AHEAD = 40.0
"""um from before to behind where the tips are nearest; the part can jam only there."""
ASIDE = (-60.0, 0.0, 60.0)
"""um of the reference point along the edges, from the middle between the tips."""
STEP = 0.05
"""um, of the time stepper."""
REACH, HALVINGS = 4.0, 9
"""um on both sides of the formula that are searched, and how often they are halved: to 0.016 um."""
RADII = ((0.0, 0.0), (2.5, 2.5), (12.5, 12.5), (2.5, 12.5))
FRICTIONS = ((0.33, 0.33), (0.36, 0.36), (0.30, 0.36), (0.36, 0.30))
Pair = tuple[float, float]


def formula(friction: Pair, radii: Pair) -> float:
    """um; see the module."""
    root = float(np.hypot(1.0, min(friction)))
    return WIDTH * root + sum(radii) / root


def push_of(spacings: npt.NDArray[np.float64], friction: Pair, radii: Pair, aside: float) -> Push:
    """A turn past the place where the tips are nearest, for each of some spacings, um."""
    wide = WIDTH + sum(radii)
    theta = np.arctan2(spacings, AHEAD) + np.arcsin(wide / np.hypot(AHEAD, spacings))
    along = np.stack([np.cos(theta), np.sin(theta)], axis=1)
    outward = np.stack([along[:, 1], -along[:, 0]], axis=1)
    moving = np.column_stack([np.full(len(spacings), AHEAD), spacings])
    apart = np.sqrt(AHEAD**2 + spacings**2 - wide**2)  # of the contacts, along the edges
    centre = moving - (0.5 * WIDTH + radii[0]) * outward - (0.5 * apart + aside)[:, None] * along
    tips = np.stack([moving, np.zeros_like(moving)], axis=1)
    travel = np.zeros_like(tips)
    travel[:, 0, 0] = -2.0 * AHEAD
    half = 0.5 * np.array([LENGTH, WIDTH])
    return Push.straight(
        vertices=np.array([[-1, -1], [1, -1], [1, 1], [-1, 1.0]]) * half * UM,
        poses=np.column_stack([centre * UM, theta]),
        tips=tips * UM,
        travel=travel * UM,
        friction=np.tile(friction, (len(spacings), 1)),
        radii=np.array([radii]) * UM,
        film_ratio=FILM_RATIO,
        step=STEP * UM,
    )


def threshold(engine: str, friction: Pair, radii: Pair, aside: Sequence[float] = ASIDE) -> Pair:
    """Least and largest spacing (um) at which the part just gets through, wherever it lies.

    Parameters
    ----------
    engine
        events or stepper.
    friction, radii
        Of the moving tip and of the one at rest; um.
    aside
        Places of the part, um; see `ASIDE`.
    """
    found = []
    for place in aside:
        low, high = formula(friction, radii) - REACH, formula(friction, radii) + REACH
        for _ in range(HALVINGS):
            middle = 0.5 * (low + high)
            push = push_of(np.array([middle]), friction, radii, place)
            outcome = (exact(push) if engine == "events" else simulate(push)).outcomes[0]
            low, high = (low, middle) if outcome == Outcome.COMPLETED else (middle, high)
        found.append(0.5 * (low + high))
    return min(found), max(found)


def page() -> str:
    """The table in Markdown."""
    lines = [
        "# Spacing of two round tips at which the part jams",
        "",
        "`python -m reports.simulator.jam_thresholds --out reports/simulator/jam_thresholds.md` writes this",
        "page. Part 837 um wide; µ and radius of the moving tip and of the one at rest; spacings in um, bisected",
        "to 0.016 um at three places of the part.",
        "",
        "| µ | radii (um) | formula | event-driven | stepper |",
        "|---|---|---|---|---|",
    ]
    for friction in FRICTIONS:
        for radii in RADII:
            ends = [threshold(engine, friction, radii) for engine in ("events", "stepper")]
            cells = [f"{low:.2f} … {high:.2f}" for low, high in ends]
            lines.append(
                f"| {friction[0]:g}, {friction[1]:g} | {radii[0]:g}, {radii[1]:g} | "
                f"{formula(friction, radii):.2f} | {cells[0]} | {cells[1]} |"
            )
    return "\n".join(lines) + "\n"


def main() -> int:
    """Write or print the page."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=Path)
    out, text = parser.parse_args().out, page()
    if out is None:
        sys.stdout.write(text)
    else:
        write_all(out.parent, {out.name: text})
    return 0


if __name__ == "__main__":
    sys.exit(main())
