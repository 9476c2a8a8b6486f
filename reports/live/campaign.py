"""The live loop in the virtual laboratory: ``python -m reports.live.campaign [--runs 1000] [--workers 2]``.

Continues where it was stopped, as long as the task is the same.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import asdict, dataclass
from functools import cache
from itertools import pairwise
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from meso_robust.api.drive import Driver, drive
from meso_robust.files import write_all
from meso_robust.live.conductor import Conductor, Phase
from meso_robust.live.journal import Header, Journal
from meso_robust.live.lab_file import VirtualSection, WatchSection
from meso_robust.live.loop import Glimpse, Words, run_loop
from meso_robust.live.preflight import check_lab, trust_of
from meso_robust.live.session import eye_of
from meso_robust.live.virtual_bench import UNPACED, lab_of, laboratory_of
from meso_robust.planning.compose import compose
from meso_robust.planning.document import plan_document
from meso_robust.primitives.setup import setup_of
from meso_robust.task import Task, load_task
from meso_robust.tasks import MICROSCOPE
from meso_robust.types import Floats

OUT = Path(__file__).parent
RESULTS, PAGE = "results.json", "results.md"
RATE = 4.0  # frames a second
SOFT = np.array([2.0, 2.0, 0.03])
"""um, um, deg by which the plant is soft and has mass; reports/foreign_plant measures it."""
QUICK_MS = 50.0
STILL = 0.2  # um by which a part that nothing is to push may come to rest


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
    frames: int
    quick: int
    """Frames from which the commands followed within QUICK_MS."""
    median_ms: float
    longest_ms: float

    @property
    def succeeded(self) -> bool:
        """The loop says done, and it is."""
        return self.outcome == "done" and self.in_goal

    @property
    def unsound(self) -> bool:
        """Something that was promised not to happen did."""
        claimed = self.outcome == "done" and not self.in_goal
        moved = self.moved_unpushed_um > STILL or self.outside_um > 0.0
        return claimed or moved or self.landed


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


def one_run(seed: int, **virtual: Any) -> Result:
    """Carry the plan out once; odd seeds draw at corners of the box of everything uncertain."""
    task, driver = bench()
    driver.answer(9e5, 9e5, 0.0)  # whatever went before is another part's
    lab = lab_of(task, "-x", VirtualSection(seed=seed, frame_rate_hz=RATE, **virtual))
    watch = WatchSection(max_age_ms=2500.0 / RATE, max_latency_ms=UNPACED)
    lab = lab.model_copy(update={"watch": watch})
    check_lab(task, lab, "lab")
    header = Header(
        task_hash=task.hash, plan_hash="", lab=lab, trust=trust_of(task), confirm=False, dry=False,
        version="", started="",
    )  # fmt: skip
    laboratory = laboratory_of(task, lab, corner=bool(seed % 2))
    conductor = Conductor(lab, driver.answer, header.trust)
    seen: list[tuple[Phase, Floats, float]] = []

    def shown(glimpse: Glimpse) -> None:
        took = glimpse.latency if glimpse.frame is not None else np.nan
        seen.append((conductor.phase, laboratory.pose, took))

    journal = Journal(None, header)
    devices = laboratory.devices()
    ending = run_loop(devices, lab, eye_of(task, header), conductor, journal, Words(), shown)
    moves = [turn.move for turn in journal.turns if turn.move is not None]
    took = np.array([1e3 * latency for _, _, latency in seen if np.isfinite(latency)])
    return Result(
        seed=seed,
        outcome=ending.outcome,
        why=ending.text,
        in_goal=_outside(laboratory.pose, _goal(task)) == 0.0,
        moved_unpushed_um=_moved(seen),
        outside_um=_worst(seen, moves),
        landed=laboratory.landed,
        stuck=laboratory.stuck,
        moves=conductor.made,
        frames=len(took),
        quick=int((took <= QUICK_MS).sum()),
        median_ms=round(float(np.median(took)), 2),
        longest_ms=round(float(took.max()), 1),
    )


def _goal(task: Task) -> dict[str, list[float]]:
    low, high = setup_of(task).goal.ends
    scale = np.array([1e6, 1e6, 180.0 / np.pi])
    names = ("x_um", "y_um", "theta_deg")
    return {n: [a, b] for n, a, b in zip(names, low * scale, high * scale, strict=True)}


def _outside(pose: Floats, box: Mapping[str, Sequence[float]], soft: Floats | None = None) -> float:
    """Farthest beyond a side of a box, um or hundredths of a degree."""
    shown = np.array([pose[0], pose[1], np.degrees(pose[2])])
    sides = np.array([box["x_um"], box["y_um"], box["theta_deg"]])
    off = np.maximum(np.maximum(sides[:, 0] - shown, shown - sides[:, 1]), 0.0)
    off = np.maximum(off - (np.zeros(3) if soft is None else soft), 0.0)
    return float((off * [1.0, 1.0, 100.0]).max())


def _moved(seen: Sequence[tuple[Phase, Floats, float]]) -> float:
    """um between turns of which neither is in a push."""
    far = 0.0
    for (before, a, _), (after, b, _) in pairwise(seen):
        if Phase.PUSHING not in (before, after):
            far = max(far, float(np.abs(b - a)[:2].max()))
    return far


def _worst(
    seen: Sequence[tuple[Phase, Floats, float]], moves: Sequence[Mapping[str, Any]]
) -> float:
    """How far outside of the certified boxes the part lay after its moves."""
    ends = [
        b
        for (before, _, _), (after, b, _) in pairwise(seen)
        if before is Phase.RAISING and after is Phase.SEEING
    ]
    pairs = zip(ends, moves, strict=False)
    return max((_outside(pose, move["expect"], SOFT) for pose, move in pairs), default=0.0)


def carried_on(runs: int, workers: int, out: Path) -> list[Result]:
    """Runs, each written as it is done."""
    path, task = out / RESULTS, load_task(MICROSCOPE)
    kept = json.loads(path.read_text(encoding="utf-8")) if path.exists() else {}
    entries = kept.get("runs", []) if kept.get("task") == task.hash else []
    done = [Result(**entry) for entry in entries]
    left = [seed for seed in range(runs) if seed not in {one.seed for one in done}]
    with ProcessPoolExecutor(workers) as pool:
        for result in pool.map(one_run, left):
            done.append(result)
            text = json.dumps({"task": task.hash, "runs": [asdict(one) for one in done]})
            write_all(out, {RESULTS: text + "\n", PAGE: page(done)})
            sys.stdout.write(f"{result.seed}: {result.outcome}: {result.why}\n")
            sys.stdout.flush()
    return done


def page(done: Sequence[Result]) -> str:
    """The results in Markdown."""
    frames, quick = sum(one.frames for one in done), sum(one.quick for one in done)
    median = float(np.median([one.median_ms for one in done]))
    good, bad = sum(one.succeeded for one in done), [one for one in done if one.unsound]
    lines = [
        "# The live loop in the virtual laboratory",
        "",
        "Written by `python -m reports.live.campaign`; see the [README](README.md).",
        "",
        "| | |",
        "|---|---|",
        f"| runs | {len(done):,} |",
        f"| done, and the part in the goal | {good:,} |",
        f"| unsound: a promise broken | {len(bad)} |",
        f"| moves made | {sum(one.moves for one in done):,} |",
        f"| farthest move of a part that nothing was to push | {max(o.moved_unpushed_um for o in done):.3f} um |",
        f"| frames | {frames:,} |",
        f"| from a frame to its commands | {median:.1f} ms (median); at most {QUICK_MS:g} ms of "
        f"{100.0 * quick / frames:.2f} % of the frames |",
        "",
    ]
    lines += [f"- seed {one.seed}: {one.outcome}: {one.why}" for one in done if not one.succeeded]
    return "\n".join(lines).rstrip() + "\n"


def main() -> int:
    """Run; exit status 1 if a promise was broken or a run did not reach the goal."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--runs", type=int, default=1000)
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--out", type=Path, default=OUT)
    asked = parser.parse_args()
    done = carried_on(asked.runs, asked.workers, asked.out)
    return 0 if all(one.succeeded and not one.unsound for one in done) else 1


if __name__ == "__main__":
    sys.exit(main())
