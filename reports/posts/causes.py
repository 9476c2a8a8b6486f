"""Where the width of the real paper's rotation comes from: ``python -m reports.posts.causes``.

Its rotation again with one uncertainty after the other exactly known, and the slide between both tips
with all constants known, with only some of them, and with what may change at every instant.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from meso_robust.bounds import Interval
from meso_robust.certificates.chain import certify
from meso_robust.files import write_all
from meso_robust.motion.two_sided import Grip, cut, enclose_slide
from meso_robust.planning.reading import read_plan
from meso_robust.planning.rules import rules_of
from meso_robust.primitives import rotation
from meso_robust.primitives.approach import Touch, approach
from meso_robust.primitives.certify import certify_move
from meso_robust.primitives.obligation import Step
from meso_robust.primitives.setup import ZERO, PoseBox, Setup, setup_of
from meso_robust.task import load_task
from reports.posts.__main__ import OUT, REAL_PAPER, SHOWN, filled

TASK = REAL_PAPER.parent / "at_38_um" / "task.toml"
PAGE = "causes.md"
KNOWN = (
    *("friction", "film_ratio", "drag_anisotropy", "drag_centre", "size", "squareness"),
    *("tip_radius", "travel_direction", "misalignment", "probe_position", "sensed_position"),
    "sensed_orientation",
)
INSTANT = ("rho", "stretch", "shear", "mu")
CONSTANT = ("room", "depth", "depth_far", "radius", "radius_far", "kappa", "drag_a", "drag_n")
INSTANTLY = 1e-7
"""m; a range of h that is as good as none."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Case:
    """The rotation with something known exactly."""

    name: str
    setup: Setup
    pre: PoseBox


def cases(step: Step, setup: Setup) -> Iterator[Case]:
    """As it is, and with one thing after the other known."""
    yield Case(name="as it is", setup=setup, pre=step.pre)
    common = replace(setup, friction_common=True)
    yield Case(name="both tips always have one friction", setup=common, pre=step.pre)
    u = setup.uncertainty
    for name in KNOWN:
        exact = {name: _exact(getattr(u, name))}
        if name == "tip_radius":
            exact["passive_tip_radius"] = exact[name]
        known = replace(setup, uncertainty=replace(u, **exact))
        yield Case(name=name, setup=known, pre=step.pre)
    for name in ("x", "y", "theta"):
        pre = replace(step.pre, **{name: _exact(getattr(step.pre, name))})
        yield Case(name=f"{name} before it", setup=setup, pre=pre)


def _exact(side: Interval) -> Interval:
    return ZERO if side.mid == 0.0 else Interval.point(side.mid)


def by_cause(step: Step, setup: Setup, size: int, rounds: int) -> list[str]:
    """Rows of the first table."""
    rows = []
    for case in cases(step, setup):
        found = certify_move(step.rule, case.pre, case.setup)
        if found.post is None:
            raise RuntimeError(f"{case.name}: the rotation could not be enclosed")
        stated = np.ptp(found.post.ends, axis=0)
        began = replace(step, pre=case.pre)
        runs = filled([began], case.setup, stated=False, film=True, size=size, rounds=rounds)
        cells = [*(stated / SHOWN)[:2], *(runs / SHOWN)[:2], *(stated / runs)[:2]]
        row = f"| {case.name} | " + " | ".join(f"{cell:.3g}" for cell in cells) + " |"
        print(row, flush=True)
        rows.append(row)
    return rows


def the_rotation() -> tuple[Step, Setup]:
    """It as certified, and its task."""
    task = load_task(TASK)
    setup = setup_of(task)
    steps = certify(rules_of(read_plan(TASK.with_name("plan.json"), task)), setup).steps
    return next(one for one in steps if one.rule.action == "rotate"), setup


def touched(step: Step, setup: Setup) -> tuple[rotation.Move, Touch]:
    """The rotation, and where both tips touch first."""
    frame = step.rule.frame
    move, _ = rotation.as_begun(step.rule, frame.from_world(step.pre), frame.setup(setup))
    touch = approach(move.box, move.grip, move.labels, move.first_gap, move.edge, move.of)
    if touch is None:
        raise RuntimeError("the approach could not be enclosed")
    return move, touch


def by_slide(move: rotation.Move, touch: Touch) -> Iterator[str]:
    """Rows of the second table: the slide at the end when all that is not named is known."""
    start, others = touch.start, tuple(name for name in CONSTANT if name != "room")
    told = start.labels
    for name, open_, early, rooms in (
        ("where the slide begins", (), False, 1),
        ("and film", INSTANT[:-1], False, 1),
        ("and friction", INSTANT, False, 1),
        ("and the room", (*INSTANT, "room"), False, 1),
        ("the same, the room in 24 parts", (*INSTANT, "room"), False, 24),
        ("in place of the room the other constants", (*INSTANT, *others), False, 1),
        ("and what came before the touch", (*INSTANT, *others, *told), False, 1),
        ("and when both tips touch first", (*INSTANT, *others, *told), True, 1),
        ("and the room, in 24 parts", (*INSTANT, *CONSTANT, *told), True, 24),
    ):
        grip = _some(move.grip, open_)
        labels = {name: side if name in open_ else _exact(side) for name, side in told.items()}
        instant = Interval(start.h.mid - INSTANTLY, start.h.mid + INSTANTLY)
        own = replace(start, labels=labels, h=start.h if early else instant)
        parts = [(replace(grip, room=room), labels) for room in cut(grip, rooms)]
        tube = enclose_slide(grip, own, move.h_end.lo, parts=parts)
        ends = [1e6 * float(cell.upper[-1] - cell.lower[-1]) for cell in tube.cells]
        yield f"| {name} | {np.median(ends):.0f} | {max(ends):.0f} |"


def _some(grip: Grip, open_: tuple[str, ...]) -> Grip:
    known: dict[str, Any] = {
        name: _exact(getattr(grip, name)) for name in (*INSTANT, *CONSTANT) if name not in open_
    }
    return replace(grip, **known)


def main() -> int:
    """Measure and write."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--size", type=int, default=800, help="draws of a round")
    parser.add_argument("--rounds", type=int, default=12)
    parser.add_argument("--out", type=Path, default=OUT)
    asked = parser.parse_args()
    step, setup = the_rotation()
    move, touch = touched(step, setup)
    slide = list(by_slide(move, touch))
    print("\n".join(slide), flush=True)
    lines = [
        "# Where the width of a rotation comes from",
        "",
        "Written by `python -m reports.posts.causes`; see the [README](README.md).",
        "",
        "| exactly known | stated x, y (um) | | runs fill x, y | | stated over filled x, y | |",
        "|---|---|---|---|---|---|---|",
        *by_cause(step, setup, asked.size, asked.rounds),
        "",
        "| uncertain | width of the slide at the end: median of the parts (um) | largest |",
        "|---|---|---|",
        *slide,
    ]
    write_all(asked.out, {PAGE: "\n".join(lines) + "\n"})
    return 0


if __name__ == "__main__":
    sys.exit(main())
