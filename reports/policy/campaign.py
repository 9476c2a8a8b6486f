"""The large form of the policy's tests: ``python -m reports.policy.campaign [--runs 20000] [--out F]``.

Builds the policy of the paper's task, writes ``policy.json``, ``region.svg`` and ``policy.md`` to
``reports/policy``, and runs it in both engines of the simulator and in the foreign plant from starts all over
its region. With ``--task F.toml --name N`` that of another task; ``N.md`` is written only.
"""

from __future__ import annotations

import argparse
import sys
import time
from pathlib import Path
from typing import Literal

import numpy as np

from meso_robust.cli.console import Reporter
from meso_robust.files import write_all
from meso_robust.laboratory.engines import Engine
from meso_robust.laboratory.running import Bench
from meso_robust.policy.build import make_policy
from meso_robust.policy.cells import Policy
from meso_robust.policy.document import policy_document
from meso_robust.policy.region import sensed_start, tube
from meso_robust.primitives.setup import setup_of
from meso_robust.reporting.policy import draw, summary
from meso_robust.task import load_task
from meso_robust.tasks import PAPER
from reports.foreign_plant.running import ForeignBench
from reports.policy.runs import draw_starts, run_policy

World = Engine | Literal["foreign plant"]
"""What carries the moves out: an engine of the simulator, or a plant that shares no physics with it."""
REPORT = Path(__file__).parents[2] / "reports" / "policy"


def campaign(policy: Policy, runs: int, world: World, seed: int) -> tuple[bool, str]:
    """Whether all runs kept the claim, and a line about them."""
    rng = np.random.default_rng(seed)
    setup, draws = setup_of(policy.task), draw_starts(policy, runs, rng)
    if world == "foreign plant":
        done = run_policy(policy, ForeignBench.of(setup, draws))
    else:
        done = run_policy(policy, Bench.of(setup, draws, engine=world))
    away = done.excess / np.array([1e-6, 1e-6, np.pi / 180.0])
    # a step of the stepper is 2 um, and tips of the plant are soft: some hundredths of one out of a box
    kept = done.kept if world == "events" else bool(done.in_goal.all())
    line = (
        f"{world}: {int(done.in_goal.sum())} of {runs} runs end in the goal, "
        f"{int((done.moves <= done.promised).sum())} within the moves that were promised; largest "
        f"distance outside of an answered box {away[0]:.3f} um, {away[1]:.3f} um, {away[2]:.5f} deg"
    )
    return kept, line


def main() -> int:
    """Build, write, run; exit status 1 if a run broke the claim."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--runs", type=int, default=20000)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--out", type=Path, default=REPORT)
    parser.add_argument("--task", type=Path, default=PAPER)
    parser.add_argument("--name", default="policy")
    asked = parser.parse_args()
    task = load_task(asked.task)
    before = time.perf_counter()
    policy = make_policy(task, Reporter(quiet=False).doing)
    seconds = time.perf_counter() - before
    text, kept = judged(policy, seconds, asked.runs, asked.seed)
    files = {f"{asked.name}.md": text}
    if asked.task == PAPER:
        slices = tube(policy, sensed_start(task))
        files["policy.json"] = policy_document(policy).model_dump_json(by_alias=True) + "\n"
        files["region.svg"] = draw(policy, slices)
    write_all(asked.out, files)
    sys.stdout.write(text)
    return 0 if kept else 1


def judged(policy: Policy, seconds: float, runs: int, seed: int) -> tuple[str, bool]:
    """A page about a policy that was built in some seconds, and whether all runs kept its claim."""
    slices = tube(policy, sensed_start(policy.task))
    tenth = runs // 10
    parts: tuple[tuple[World, int], ...] = (
        ("events", runs), ("stepper", tenth), ("foreign plant", tenth)
    )  # fmt: skip
    found = [campaign(policy, count, world, seed) for world, count in parts]
    lines = "".join(f"- {line}\n" for _, line in found)
    text = summary(policy, slices, seconds) + f"\n## Carried out\n\n{lines}"
    return text, all(kept for kept, _ in found)


if __name__ == "__main__":
    sys.exit(main())
