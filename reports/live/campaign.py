"""The live loop in the virtual laboratory: ``python -m reports.live.campaign [--runs 1000] [--faulty 160]``.

Continues where it was stopped, as long as the task is the same.
"""

from __future__ import annotations

import argparse
import json
import math
import sys
from collections import Counter
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
from meso_robust.live.journal import Header, Journal, replayed
from meso_robust.live.lab_file import VirtualSection, WatchSection
from meso_robust.live.loop import Glimpse, Words, run_loop
from meso_robust.live.preflight import check_lab, trust_of
from meso_robust.live.session import eye_of
from meso_robust.live.virtual_bench import LIFTED, UNPACED, lab_of, laboratory_of
from meso_robust.planning.compose import compose
from meso_robust.planning.document import plan_document
from meso_robust.primitives.setup import setup_of
from meso_robust.task import Task, load_task
from meso_robust.tasks import MICROSCOPE
from meso_robust.types import Floats

OUT = Path(__file__).parent
RESULTS, PAGE = "results.json", "results.md"
RATE = 1.0
"""Frames a second: most of a run's time goes into images."""
FAULTY = 10**6
"""Seeds from here on are of runs in which something goes wrong."""
SOFT = np.array([2.0, 2.0, 0.03])
"""um, um, deg by which the plant is soft and has mass; reports/foreign_plant measures it."""
QUICK_MS = 50.0
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


def faults_of(seed: int) -> dict[str, float]:
    """What goes wrong in a run, at any time of it."""
    if seed < FAULTY:
        return {}
    rng = np.random.default_rng([seed, 2])
    when, short = float(rng.uniform(0.0, 70.0)), float(rng.uniform(0.5, 100.0))
    kinds: list[dict[str, float]] = [
        {"lost_from_s": when},
        {"lost_from_s": when, "lost_until_s": when + 4.0},
        {"frozen_from_s": when},
        {"short_um": short},
        {"stalls_from_s": when},
        {"stage_moves_at_s": when},
        {"lift_fails_from_s": when},
        {"kicked_at_s": when},
    ]
    return kinds[seed % len(kinds)]


def one_run(seed: int, **virtual: Any) -> Result:
    """Carry the plan out once; odd seeds draw at corners of the box of everything uncertain."""
    task, driver = bench()
    driver.answer(9e5, 9e5, 0.0)  # whatever went before is another part's
    faults = faults_of(seed)
    given = {"seed": seed, "frame_rate_hz": RATE, "faults": faults, **virtual}
    lab = lab_of(task, "-x", VirtualSection.model_validate(given))
    watch = WatchSection(max_age_ms=2500.0 / RATE, max_latency_ms=UNPACED)
    lab = lab.model_copy(update={"watch": watch})
    check_lab(task, lab, "lab")
    header = Header(
        task_hash=task.hash, plan_hash="", lab=lab, trust=trust_of(task), confirm=False, dry=False,
        version="", started="",
    )  # fmt: skip
    laboratory = laboratory_of(task, lab, corner=bool(seed % 2))
    conductor = Conductor(lab, driver.answer, header.trust)
    seen: list[tuple[Phase, Floats]] = []
    took: list[float] = []

    def shown(glimpse: Glimpse) -> None:
        seen.append((conductor.phase, laboratory.pose))
        if glimpse.frame is not None:
            took.append(1e3 * glimpse.latency)

    journal = Journal(None, header)
    devices = laboratory.devices()
    ending = run_loop(devices, lab, eye_of(task, header), conductor, journal, Words(), shown)
    moves = [turn.move for turn in journal.turns if turn.move is not None]
    driver.answer(9e5, 9e5, 0.0)
    again = replayed(header, journal.turns, driver.answer)
    heights = [one.status().height * 1e6 for one in laboratory.manipulators.values()]
    lifted = all(abs(height - LIFTED) < lab.manipulators[0].height_error_um for height in heights)
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
        replays=again is None,
        lifted=lifted or "lift by hand" in ending.text,
        fault=", ".join(f"{name} = {value:.1f}" for name, value in faults.items()),
        first_ms=round(took[0], 1) if took else 0.0,
        later_ms={str(k): n for k, n in sorted(Counter(map(math.ceil, took[1:])).items())},
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


def _moved(seen: Sequence[tuple[Phase, Floats]]) -> float:
    """um between turns of which neither is in a push."""
    far = 0.0
    for (before, a), (after, b) in pairwise(seen):
        if Phase.PUSHING not in (before, after):
            far = max(far, float(np.abs(b - a)[:2].max()))
    return far


def _worst(seen: Sequence[tuple[Phase, Floats]], moves: Sequence[Mapping[str, Any]]) -> float:
    """How far outside of the certified boxes the part lay after its moves."""
    ends = [
        b
        for (before, _), (after, b) in pairwise(seen)
        if before is Phase.RAISING and after is Phase.SEEING
    ]
    pairs = zip(ends, moves, strict=False)
    return max((_outside(pose, move["expect"], SOFT) for pose, move in pairs), default=0.0)


def carried_on(runs: int, faulty: int, workers: int, out: Path) -> list[Result]:
    """Runs, each written as it is done."""
    path, task = out / RESULTS, load_task(MICROSCOPE)
    kept = json.loads(path.read_text(encoding="utf-8")) if path.exists() else {}
    entries = kept.get("runs", []) if kept.get("task") == task.hash else []
    done = [Result(**entry) for entry in entries]
    seeds = [*range(FAULTY, FAULTY + faulty), *range(runs)]
    left = [seed for seed in seeds if seed not in {one.seed for one in done}]
    with ProcessPoolExecutor(workers) as pool:
        for result in pool.map(one_run, left):
            done.append(result)
            rows = ",\n".join(json.dumps(asdict(one)) for one in done)
            text = f'{{"task": "{task.hash}", "runs": [\n{rows}\n]}}\n'
            write_all(out, {RESULTS: text, PAGE: page(done)})
            sys.stdout.write(f"{result.seed}: {result.outcome}: {result.why}\n")
            sys.stdout.flush()
    return done


def page(done: Sequence[Result]) -> str:
    """The results in Markdown."""
    plain, faulty = ([one for one in done if bool(one.fault) is told] for told in (False, True))
    lines = [
        "# The live loop in the virtual laboratory",
        "",
        "Written by `python -m reports.live.campaign`; see the [README](README.md).",
        "",
        "## Within the assumptions of the certificate",
        "",
        "| | |",
        "|---|---|",
        f"| runs | {len(plain):,} |",
        f"| done, and the part in the goal | {sum(one.succeeded for one in plain):,} |",
        f"| unsound: a promise broken | {sum(one.unsound for one in plain)} |",
        f"| journals that are decided again to the last bit | {sum(one.replays for one in plain):,} |",
        f"| moves made | {sum(one.moves for one in plain):,} |",
        *_timed(plain),
        "",
        *[f"- seed {one.seed}: {one.outcome}: {one.why}" for one in plain if not one.succeeded],
    ]
    if faulty:
        lines += ["", "## With faults", "", *_faults(faulty)]
    return "\n".join(lines).rstrip() + "\n"


def _timed(done: Sequence[Result]) -> list[str]:
    """Rows about what moved unasked, and about times."""
    if not done:
        return []
    counts = sum((Counter({int(k): n for k, n in one.later_ms.items()}) for one in done), Counter())
    times = np.repeat(*map(np.array, zip(*sorted(counts.items()), strict=True)))
    firsts = np.array([one.first_ms for one in done])
    return [
        f"| farthest move of a part that nothing was to push | {max(o.moved_unpushed_um for o in done):.3f} um |",
        f"| frames | {len(times) + len(firsts):,} |",
        f"| from a frame to its commands | {np.median(times):.0f} ms (median), "
        f"{np.quantile(times, 0.99, method='higher'):.0f} ms (99 %), {times.max():.0f} ms (longest); "
        f"{100.0 * np.mean(times <= QUICK_MS):.2f} % within {QUICK_MS:g} ms |",
        f"| from the first frame, all of which is searched, before anything moves | "
        f"{np.median(firsts):.0f} ms (median), {firsts.max():.0f} ms (longest) |",
    ]


def _faults(done: Sequence[Result]) -> list[str]:
    """A table of what went wrong, and how it ended."""
    rows = ["| what | runs | done | refused | fault | unsound |", "|---|---|---|---|---|---|"]
    kinds: dict[str, list[Result]] = {}
    for one in done:
        kinds.setdefault(" and ".join(p.split(" = ")[0] for p in one.fault.split(", ")), []).append(
            one
        )
    for kind, runs in kinds.items():
        ends = Counter(one.outcome for one in runs)
        rows.append(
            f"| `{kind}` | {len(runs)} | {ends['done']} | {ends['refused']} | {ends['fault']} | "
            f"{sum(one.unsound for one in runs)} |"
        )
    return [
        *rows,
        "",
        "A run is done if its fault came after its end, or made no difference to it.",
    ]


def main() -> int:
    """Run; exit status 1 if a promise was broken or a run did not reach the goal."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--runs", type=int, default=1000)
    parser.add_argument("--faulty", type=int, default=160)
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--out", type=Path, default=OUT)
    asked = parser.parse_args()
    done = carried_on(asked.runs, asked.faulty, asked.workers, asked.out)
    failed = [one for one in done if one.unsound or not (one.fault or one.succeeded)]
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
