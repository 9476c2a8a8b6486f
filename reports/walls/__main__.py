"""Write ``results.md``: which way of using the slot's walls works at all, over friction and film of the task.

Nothing of the proof is used: parts, tips and walls are stated here, and the engine does the rest.
"""

from __future__ import annotations

import itertools
import math
from functools import cache
from pathlib import Path

import numpy as np

from meso_robust.simulator import Fixture, Outcome, Push, exact
from meso_robust.simulator.support_models import Film
from meso_robust.task import load_task
from meso_robust.tasks import PAPER
from meso_robust.types import Floats
from meso_robust.units import UM

HALF_LONG, HALF_SHORT, MOUTH = 808.0, 418.5, 300.0
NARROW = 976.0
"""Width of the slot."""
CORNERS = UM * np.array([[808, 418.5], [-808, 418.5], [-808, -418.5], [808, -418.5]])
WORST = tuple(itertools.product((0.30, 0.36), (0.358, 0.3958)))
"""Friction of the tips and film ratio, mm^2: corners of the task."""
SPACING = 580.0
DEPTHS = (100, 200, 300, 400, 500, 600, 700, 800, 900)
LEANS = (1.0, 3.0)
ABOVE, REACHES = (860.0, 870.0, 880.0, 890.0, 900.0, 920.0, 940.0), (900.0, 920.0, 940.0, 960.0)
"""Of tip and part beyond the slot's edge, um."""
RUNS, OFF, MIDDLES = 48, 8.0, (-260.0, -230.0, -200.0, -170.0, -140.0, -110.0)


@cache
def slot() -> Fixture:
    """The paper's."""
    stated = load_task(PAPER.with_name("slot.toml")).slot
    assert stated is not None
    return Fixture((np.array(stated.outline_um, dtype=float) * UM,), stated.friction)


def push(
    pose: Floats, tips: Floats, travel: float, corner: tuple[float, float]
) -> tuple[Floats, bool]:
    """Pose (um, um, rad) after tips (P, 2) have gone by ``travel`` um along -x, and whether they could."""
    friction, ratio = corner
    moved = exact(
        Push.along(
            vertices=CORNERS,
            poses=np.array([[pose[0] * UM, pose[1] * UM, pose[2]]]),
            ways=UM * np.stack([tips, tips - [travel, 0.0]])[None],
            friction=np.full((1, len(tips)), friction),
            support=Film(drag=np.diag([1.0, 1.0, ratio * 1e-6])),
            fixture=slot(),
            step=1e-6,
        )
    )
    return moved.poses[0] / [UM, UM, 1.0], bool(moved.outcomes[0] == Outcome.COMPLETED)


def on_edge(depth: float, lean: float) -> Floats:
    """A part whose front is up, its lower side on the slot's lower edge, this deep along the side."""
    c, s, ahead = math.cos(lean), math.sin(lean), HALF_LONG - depth
    x = MOUTH + ahead * c + HALF_SHORT * s + 1e-3
    y = -NARROW / 2 - ahead * s + HALF_SHORT * c + 1e-3
    return np.array([x, y, math.pi - lean])


def behind(pose: Floats, heights: tuple[float, ...]) -> Floats | None:
    """Point tips on the slot's axis plus ``heights``, the foremost on the rear edge; None: they miss it."""
    c, s = math.cos(math.pi - pose[2]), math.sin(math.pi - pose[2])
    offsets = [(y - pose[1] + HALF_LONG * s) / c for y in heights]
    if max(map(abs, offsets)) >= HALF_SHORT:
        return None
    x = max(pose[0] + HALF_LONG * c + off * s for off in offsets)
    return np.array([[x + 1e-3, y] for y in heights])


def in_the_slot(heights: tuple[float, ...]) -> list[str]:
    """A row a depth: what becomes of a part that leans on the slot's edge, at the worst corner."""
    rows = []
    for depth in DEPTHS:
        cells = []
        for lean in LEANS:
            pose = on_edge(depth, math.radians(lean))
            tips = behind(pose, heights)
            if tips is None:
                cells.append("tip beside the edge")
                continue
            ends = [push(pose, tips, min(200.0, 1100.0 - depth), corner) for corner in WORST]
            jams = sum(not done for _, done in ends)
            leans = [abs(180.0 - math.degrees(end[2])) for end, done in ends if done]
            cells.append(
                f"jam in {jams} of {len(ends)}" if jams else f"{lean:.0f} → {max(leans):.2f}°"
            )
        rows.append(f"| {depth} | " + " | ".join(cells) + " |")
    return rows


def pivoted(placed: Floats, above: float, corner: tuple[float, float]) -> tuple[Floats, bool]:
    """Pose after an upright part before the slot's lower edge was pushed by one tip this far above it."""
    tips = np.array([[placed[0] + HALF_SHORT + 12.5, above - NARROW / 2]])
    return push(placed, tips, 1400.0, corner)


def grid() -> list[str]:
    """A row a distance of tip and edge across the push: what becomes of each place of the part."""
    rows = []
    for above in ABOVE:
        cells = []
        for reach in REACHES:
            if above > reach:
                cells.append("–")
                continue
            placed = np.array(
                [MOUTH + HALF_SHORT + 1e-2, reach - NARROW / 2 - HALF_LONG, math.pi / 2]
            )
            ends = [pivoted(placed, above, corner) for corner in WORST]
            jams = sum(not done for _, done in ends)
            least = min(math.degrees(end[2]) for end, _ in ends)
            cells.append(f"jam in {jams} of {len(ends)}" if jams else f"{least - 90.0:.0f}°")
        rows.append(f"| {above:.0f} | " + " | ".join(cells) + " |")
    return rows


def brought_in() -> list[str]:
    """A row a height of the pair: runs that pivot about the slot's edge and are then pushed in."""
    rng = np.random.default_rng(0)
    turned = []
    for k in range(RUNS):
        off, x, lean = rng.uniform(-OFF, OFF, 2), rng.uniform(1.0, 20.0), rng.uniform(0.0, 0.005)
        placed = np.array([MOUTH + HALF_SHORT + x, -352.0 + off[0], math.pi / 2 + lean])
        pose, done = pivoted(placed, 898.0 + off[1], WORST[k % len(WORST)])
        pose[1] += 0.05  # off the wall, by more than rounding
        turned.append((pose, done, WORST[k % len(WORST)]))
    rows = []
    for middle in MIDDLES:
        missed = jammed = arrived = 0
        for pose, done, corner in turned:
            tips = behind(pose, (middle - SPACING / 2, middle + SPACING / 2))
            if tips is None or not done:
                missed += tips is None
                jammed += not done
                continue
            end, through = push(pose, tips, float(tips[0, 0] - HALF_LONG), corner)
            jammed += not through
            near = abs(end[:2]).max() <= 76.0 and abs(math.degrees(end[2]) - 180.0) <= 5.0
            arrived += through and bool(near)
        rows.append(f"| {middle:.0f} | {missed} | {jammed} | {arrived} of {RUNS} |")
    return rows


def main() -> None:
    """Measure and write."""
    single, pair = in_the_slot((0.0,)), in_the_slot((-SPACING / 2, SPACING / 2))
    head = [
        "| front is so deep, µm | " + " | ".join(f"leans by {lean:.0f}°" for lean in LEANS) + " |",
        "|---|---|---|",
    ]
    text = [
        "# The walls of the paper's slot as help",
        "",
        "The paper's part and its slot of 976 µm; event-driven engine, point tips, walls with friction 0.3; the worst of",
        "the four corners of tip friction (0.30, 0.36) and film ratio (± 5 %). Written by `python -m reports.walls`.",
        "",
        "## Pushed along the slot",
        "",
        "The part's front is up, and its lower side bears on the slot's lower edge. It is pushed by 200 µm; given is the",
        "lean afterwards. Two tips, 290 µm on either side of the slot's axis:",
        "",
        *head,
        *pair,
        "",
        "One tip on the axis:",
        "",
        *head,
        *single,
        "",
        "## Pivot on the slot's edge",
        "",
        "The upright part lies against the slot's lower edge, beside the other wall, and one tip pushes it above that edge by",
        "1,400 µm, so that its upper end turns into the slot. Turn at the end, at least, of 90° (–: the tip misses the part).",
        "By the register it does not jam if tip and edge are more than 874 to 890 µm apart (friction 0.30 to 0.36).",
        "",
        "| tip beyond the edge, µm | "
        + " | ".join(f"part beyond it by {reach:.0f}" for reach in REACHES)
        + " |",
        "|---|" + "---|" * len(REACHES),
        *grid(),
        "",
        f"## Pivot, and then in: {RUNS} runs",
        "",
        f"Part 944 ± {OFF:.0f} µm and tip 898 ± {OFF:.0f} µm beyond the edge, 1 to 20 µm before it, turned by up to 0.3°; the corners",
        "of friction and film in turn. Then two tips push it to the goal (76 µm, 5°), their middle at this height:",
        "",
        "| middle of the tips, µm | tip misses the rear edge | jams | reaches the goal |",
        "|---|---|---|---|",
        *brought_in(),
        "",
    ]
    Path(__file__).with_name("results.md").write_text("\n".join(text), encoding="utf-8")


if __name__ == "__main__":
    main()
