"""What is kept of a run in the virtual laboratory, and what of it breaks a promise."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from itertools import pairwise
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from meso_robust.api.drive import Driver, drive
from meso_robust.live.conductor import Phase
from meso_robust.planning.compose import compose
from meso_robust.planning.document import plan_document
from meso_robust.primitives.setup import setup_of
from meso_robust.task import Task, load_task
from meso_robust.tasks import MICROSCOPE
from meso_robust.types import Floats

RATE = 1.0
"""Frames a second: most of a run's time goes into images."""
SOFT = np.array([2.0, 2.0, 0.03])
"""um, um, deg by which the plant is soft and has mass; reports/foreign_plant measures it."""
STILL = 0.5
"""um by which a part may still move between two turns once its push was broken off: tips and part are soft."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Result:
    """One run."""

    seed: int
    outcome: str
    why: str
    in_goal: bool
    moved_unpushed_um: float
    """Farthest that the part went while nothing was to push it."""
    outside_um: float
    """Farthest that it lay outside of the certified box after a move, beyond what the plant is soft by."""
    landed: bool
    stuck: bool
    moves: int
    replays: bool
    """Whether its journal, decided again, is the same to the last bit."""
    lifted: bool
    """Whether it ended with the probes lifted, or says that they are to be lifted by hand."""
    fault: str
    """What went wrong; empty: nothing."""
    first_ms: float
    """From the first frame, all of which is searched, to its commands."""
    later_ms: dict[str, int]
    """How many of the other frames took how many ms, rounded up."""

    @property
    def succeeded(self) -> bool:
        """The loop says done, and it is."""
        return self.outcome == "done" and self.in_goal

    @property
    def unsound(self) -> bool:
        """Something that was promised not to happen did."""
        claimed = self.outcome == "done" and not self.in_goal
        moved = self.moved_unpushed_um > STILL or self.outside_um > 0.0
        kicked = self.fault.startswith("kicked")  # by which the part moves, whatever the loop does
        broken = not (self.replays and self.lifted)
        return claimed or broken or ((moved or self.landed) and not kicked)


@cache
def bench() -> tuple[Task, Driver]:
    """The task, and its proved plan."""
    task = load_task(MICROSCOPE)
    rules, setup = compose(task).rules, setup_of(task)
    poses = [np.array(setup.start.mid)] * len(rules)
    document = plan_document(task, rules, poses, [None] * len(rules))
    with TemporaryDirectory() as folder:
        path = Path(folder) / "plan.json"
        path.write_text(document.model_dump_json(by_alias=True), encoding="utf-8")
        return task, drive(task, path)


def goal(task: Task) -> dict[str, list[float]]:
    """The task's goal as a box."""
    low, high = setup_of(task).goal.ends
    scale = np.array([1e6, 1e6, 180.0 / np.pi])
    names = ("x_um", "y_um", "theta_deg")
    return {n: [a, b] for n, a, b in zip(names, low * scale, high * scale, strict=True)}


def outside(pose: Floats, box: Mapping[str, Sequence[float]], soft: Floats | None = None) -> float:
    """Farthest beyond a side of a box, um or hundredths of a degree."""
    shown = np.array([pose[0], pose[1], np.degrees(pose[2])])
    sides = np.array([box["x_um"], box["y_um"], box["theta_deg"]])
    off = np.maximum(np.maximum(sides[:, 0] - shown, shown - sides[:, 1]), 0.0)
    off = np.maximum(off - (np.zeros(3) if soft is None else soft), 0.0)
    return float((off * [1.0, 1.0, 100.0]).max())


def moved(seen: Sequence[tuple[Phase, Floats]]) -> float:
    """um between turns of which neither is in a push."""
    far = 0.0
    for (before, a), (after, b) in pairwise(seen):
        if Phase.PUSHING not in (before, after):
            far = max(far, float(np.abs(b - a)[:2].max()))
    return far


def worst(seen: Sequence[tuple[Phase, Floats]], moves: Sequence[Mapping[str, Any]]) -> float:
    """How far outside of the certified boxes the part lay after its moves."""
    ends = [
        b
        for (before, _), (after, b) in pairwise(seen)
        if before is Phase.RAISING and after is Phase.SEEING
    ]
    pairs = zip(ends, moves, strict=False)
    return max((outside(pose, move["expect"], SOFT) for pose, move in pairs), default=0.0)
