"""The live loop in the virtual laboratory: ``python -m reports.live.campaign [--runs 1000] [--faulty 160] [--killed 40]``.

Continues where it was stopped, as long as the task is the same.
"""

from __future__ import annotations

import argparse
import json
import math
import sys
from collections import Counter
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from meso_robust.files import write_all
from meso_robust.live.conductor import Conductor, Phase
from meso_robust.live.journal import Header, Journal, replayed
from meso_robust.live.lab_file import VirtualSection, WatchSection
from meso_robust.live.loop import Glimpse, Words, run_loop
from meso_robust.live.preflight import check_lab, trust_of
from meso_robust.live.session import eye_of
from meso_robust.live.virtual_bench import LIFTED, UNPACED, lab_of, laboratory_of
from meso_robust.task import load_task
from meso_robust.tasks import MICROSCOPE
from meso_robust.types import Floats
from reports.live.judging import RATE, Result, bench, goal, moved, outside, worst
from reports.live.killing import KILLED, killed_run

OUT = Path(__file__).parent
RESULTS, PAGE = "results.json", "results.md"
FAULTY = 10**6
"""Seeds from here on are of runs in which something goes wrong."""
QUICK_MS = 50.0


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
        in_goal=outside(laboratory.pose, goal(task)) == 0.0,
        moved_unpushed_um=moved(seen),
        outside_um=worst(seen, moves),
        landed=laboratory.landed,
        stuck=laboratory.stuck,
        moves=conductor.made,
        replays=again is None,
        lifted=lifted or "lift by hand" in ending.text,
        fault=", ".join(f"{name} = {value:.1f}" for name, value in faults.items()),
        first_ms=round(took[0], 1) if took else 0.0,
        later_ms={str(k): n for k, n in sorted(Counter(map(math.ceil, took[1:])).items())},
    )


def any_run(seed: int) -> Result:
    """A run as its seed says: without a fault, with one, or killed and begun again."""
    return killed_run(seed) if seed >= KILLED else one_run(seed)


def carried_on(runs: int, faulty: int, killed: int, workers: int, out: Path) -> list[Result]:
    """Runs, each written as it is done."""
    path, task = out / RESULTS, load_task(MICROSCOPE)
    kept = json.loads(path.read_text(encoding="utf-8")) if path.exists() else {}
    entries = kept.get("runs", []) if kept.get("task") == task.hash else []
    done = [Result(**entry) for entry in entries]
    seeds = [*range(KILLED, KILLED + killed), *range(FAULTY, FAULTY + faulty), *range(runs)]
    left = [seed for seed in seeds if seed not in {one.seed for one in done}]
    with ProcessPoolExecutor(workers) as pool:
        for result in pool.map(any_run, left):
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
        "A run is done if its fault came after its end, or made no difference to it. One whose program was "
        "killed is what the program came to that was started after it, which finds the part and the probes "
        "as they were left.",
    ]


def main() -> int:
    """Run; exit status 1 if a promise was broken or a run did not reach the goal."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--runs", type=int, default=1000)
    parser.add_argument("--faulty", type=int, default=160)
    parser.add_argument("--killed", type=int, default=40)
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--out", type=Path, default=OUT)
    asked = parser.parse_args()
    done = carried_on(asked.runs, asked.faulty, asked.killed, asked.workers, asked.out)
    failed = [one for one in done if one.unsound or not (one.fault or one.succeeded)]
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
