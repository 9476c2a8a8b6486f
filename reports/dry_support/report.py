"""A tilt and a straightening of the paper's part on three dry points, over boxes of everything uncertain."""

from __future__ import annotations

import argparse
import math
from collections.abc import Iterator
from pathlib import Path

from meso_robust import units
from meso_robust.bounds import HALF_PI, Interval, Verdict, prove_positive
from meso_robust.conditions import condition
from meso_robust.errors import NotApplicableError
from meso_robust.files import write_all
from meso_robust.motion.dry_turn import DryPush, turn_on_points

SUPPORTS_UM = {
    "Table I, first row": ((-563.3, 411.3), (605.9, -409.1), (-102.1, -273.2)),
    "Table I, second row": ((794.0, -412.4), (774.5, -217.8), (-538.8, 278.8)),
    "near the corners": ((-780.0, 400.0), (-780.0, -400.0), (780.0, 0.0)),
    "near the middle": ((-300.0, 200.0), (-300.0, -200.0), (300.0, 0.0)),
}
"""Places from the centre along the long edge that is pushed and along its outward normal."""
DEPTH_UM, SIZE_UM, PLACE_UM, OFFSET_UM = 418.5, 1.0, 5.0, 8.0
FRICTION, RADIUS_UM = Interval(0.30, 0.36), (2.5, 12.5)
ERROR_DEG, MISALIGNMENT_DEG, LEAN_DEG = 0.3, 0.25, 3.0
OFFSETS_UM = tuple(range(60, 420, 20))
TRAVEL_UM = (90.0, 110.0)


def _around(middle_um: float, reach_um: float) -> Interval:
    return units.metres(middle_um - reach_um).hull(units.metres(middle_um + reach_um))


def _degrees(low: float, high: float) -> Interval:
    return units.radians(low).hull(units.radians(high))


def _push(name: str, offset_um: float) -> DryPush:
    return DryPush(
        depth=_around(DEPTH_UM, SIZE_UM),
        offset=_around(offset_um, OFFSET_UM),
        radius=units.metres(RADIUS_UM[0]).hull(units.metres(RADIUS_UM[1])),
        places=tuple(
            (_around(along, PLACE_UM), _around(across, PLACE_UM))
            for along, across in SUPPORTS_UM[name]
        ),
        friction=FRICTION,
    )


def tilted(name: str, offset_um: float) -> str | None:
    """Where a tilt from upright ends, deg, if it is proved."""
    start = _degrees(90.0 - ERROR_DEG, 90.0 + ERROR_DEG)
    travel = units.metres(TRAVEL_UM[0]).hull(units.metres(TRAVEL_UM[1]))
    turn = turn_on_points(_push(name, offset_um), start, travel, 1)
    if not turn.sticks:
        return None
    return f"{math.degrees(turn.end.lo):.2f} … {math.degrees(turn.end.hi):.2f}"


def straightened(name: str, offset_um: float) -> str | None:
    """The travel after which a leaning part is straight, um, if that is proved.

    The upper tip turns the part until the lower one, as far below the middle, touches as well.
    """
    beta = _degrees(-MISALIGNMENT_DEG, MISALIGNMENT_DEG)
    start = _degrees(90.0 - LEAN_DEG - ERROR_DEG, 90.0 - LEAN_DEG + ERROR_DEG)
    aligned = HALF_PI + beta
    upper, lower = _push(name, offset_um), _push(name, -offset_um)
    pair = {"beta": beta, "mu": FRICTION, "d1": upper.depth, "d2": upper.offset}
    pair["d4"] = upper.offset - lower.offset
    conditions = ("normal_forces", "friction_margin")
    holds = (prove_positive(condition("two_point_sticking", name), pair) for name in conditions)
    if any(proof.verdict is not Verdict.PROVED for proof in holds):
        return None
    # the second tip alone would stick and turn the part back, so it cannot be lifted off
    if not turn_on_points(lower, aligned, Interval.point(0.0), -1).sticks:
        return None
    for travel_um in range(20, 320, 20):
        turn = turn_on_points(upper, start, units.metres(float(travel_um)), 1)
        if turn.end.lo >= aligned.hi:
            return f"{travel_um}" if turn.sticks else None
    return None


def _rows() -> Iterator[str]:
    for name in SUPPORTS_UM:
        try:
            tilts = {offset: tilted(name, offset) for offset in OFFSETS_UM}
            straight = {offset: straightened(name, offset) for offset in OFFSETS_UM}
        except NotApplicableError as error:
            yield f"| {name} | – | – | – | – | {error} |"
            continue
        yield "| " + " | ".join((name, *_told(tilts, "deg"), *_told(straight, "µm"), "")) + "|"


def _told(found: dict[int, str | None], unit: str) -> tuple[str, str]:
    proved = [offset for offset, end in found.items() if end is not None]
    if not proved:
        return "none", "–"
    return f"{proved[0]} … {proved[-1]}", f"{found[proved[-1]]} {unit}"


def main() -> None:
    """Write the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=Path, required=True)
    out = parser.parse_args().out
    head = (
        "# One tip on three dry points\n\n"
        f"Supports known to ± {PLACE_UM:g} µm, each edge to ± {SIZE_UM:g} µm, the contact to ± {OFFSET_UM:g} "
        f"µm, the start to ± {ERROR_DEG:g}°; µ of the tip in [0.30, 0.36]; tip radius 2.5 to 12.5 µm. A tilt of "
        f"{TRAVEL_UM[0]:g} to {TRAVEL_UM[1]:g} µm of travel from upright, and a straightening from a lean of "
        f"{LEAN_DEG:g}° by tips as far above as below the middle.\n\n"
        "| supports | tilt PROVED at d2, µm | ends at, at the largest | straightening PROVED at ± d2, µm | straight "
        "after, at the largest | not applicable |\n|---|---|---|---|---|---|\n"
    )
    write_all(out, {"results.md": head + "\n".join(_rows()) + "\n"})


if __name__ == "__main__":
    main()
