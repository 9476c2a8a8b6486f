"""Runs whose program is killed at any moment (SIGKILL), and begun again in the same laboratory.

The laboratory is this process and outlives the program that is killed, which is a process of its own behind a pair of
pipes: tips go on to where they were sent, and stay down. Both programs write their journals, of which nothing else
is known afterwards.
"""

from __future__ import annotations

import os
import signal
import time
from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import IO

import numpy as np

from meso_robust.live.conductor import Conductor, Phase
from meso_robust.live.devices import Devices
from meso_robust.live.journal import Header, Journal, Turn, read_journal, replayed
from meso_robust.live.lab_file import Lab, VirtualSection, WatchSection
from meso_robust.live.loop import Words, run_loop
from meso_robust.live.pipe import Line, devices_at, serve
from meso_robust.live.preflight import trust_of
from meso_robust.live.session import eye_of
from meso_robust.live.virtual import VirtualLaboratory
from meso_robust.live.virtual_bench import LIFTED, UNPACED, lab_of, laboratory_of
from meso_robust.task import Task
from meso_robust.types import Floats
from reports.live.judging import RATE, Result, bench, goal, moved, outside, worst

KILLED = 2 * 10**6
"""Seeds from here on are of runs whose program is killed."""
QUESTIONS = 600
"""A run asks the laboratory about as many: the program is killed after any of them."""
PAUSE = 0.03
"""s, longest, from the answer until the program is killed: it has then seen, decided, or written something."""
LEFT = 10.0
"""s, longest, of the laboratory's clock until it is started again."""
PATIENCE = 120.0
"""s that the program waits for the laboratory, which shares a loaded machine with it."""
Seen = list[tuple[Phase, Floats]]
Program = Callable[[Devices], None]


def killed_run(seed: int) -> Result:
    """Carry the plan out until its program is killed, start another one, and judge both by their journals."""
    task, driver = bench()
    driver.controller.settle()  # a thread would be missing in the copies of this process
    _loaded()
    rng = np.random.default_rng([seed, 3])
    last, pause, left = (
        int(rng.integers(1, QUESTIONS)),
        rng.uniform(0.0, PAUSE),
        rng.uniform(0.0, LEFT),
    )
    virtual = VirtualSection(seed=seed, frame_rate_hz=RATE)
    lab = lab_of(task, "-x", virtual)
    watch = WatchSection(max_age_ms=2500.0 / RATE, max_latency_ms=UNPACED)
    lab = lab.model_copy(update={"watch": watch})
    header = _header(task, lab)
    laboratory = laboratory_of(task, lab, corner=bool(seed % 2))

    def writing(path: Path) -> Program:
        def program(devices: Devices) -> None:
            driver.answer(9e5, 9e5, 0.0)  # whatever went before is another part's
            conductor = Conductor(lab, driver.answer, header.trust)
            run_loop(devices, lab, eye_of(task, header), conductor, Journal(path, header), Words())

        return program

    def journal(path: Path) -> tuple[list[Turn], bool]:
        """Its turns, and whether they are decided again to the last bit."""
        kept, turns = read_journal(path)
        driver.answer(9e5, 9e5, 0.0)
        return turns, replayed(kept, turns, driver.answer) is None

    with TemporaryDirectory() as folder:
        first, second = Path(folder) / "first.jsonl", Path(folder) / "second.jsonl"
        _started(writing(first), lab, laboratory, (last, pause))
        at_death = laboratory.now()
        laboratory.wait(left)
        _started(writing(second), lab, laboratory)
        before, same = journal(first) if first.exists() and first.stat().st_size else ([], True)
        after, again = journal(second)
    end = after[-1].commands[-1]
    died = [(Phase(before[-1].phase), laboratory.pose_at(at_death))] if before else []
    found = [(Phase.LIFTING, laboratory.pose_at(after[0].reading.time))]
    seen = [*_seen(before, laboratory), *died, *found, *_seen(after, laboratory)]
    moves = [[turn.move for turn in turns if turn.move is not None] for turns in (before, after)]
    far = [
        worst(_seen(turns, laboratory), made)
        for turns, made in zip((before, after), moves, strict=True)
    ]
    heights = [one.status().height * 1e6 for one in laboratory.manipulators.values()]
    lifted = all(abs(height - LIFTED) < lab.manipulators[0].height_error_um for height in heights)
    return Result(
        seed=seed,
        outcome=str(end["outcome"]),
        why=str(end["text"]),
        in_goal=outside(laboratory.pose, goal(task)) == 0.0,
        moved_unpushed_um=moved(seen),
        outside_um=max(far),
        landed=laboratory.landed,
        stuck=laboratory.stuck,
        moves=sum(map(len, moves)),
        replays=same and again,
        lifted=lifted or "lift by hand" in str(end["text"]),
        fault=f"killed_after_question = {last}",
        first_ms=0.0,
        later_ms={},
    )


@cache
def _loaded() -> None:
    """Draw and see a frame, so that the copies of this process need load nothing for theirs."""
    task, _ = bench()
    lab = lab_of(task, "-x", VirtualSection(frame_rate_hz=RATE))
    frame = laboratory_of(task, lab).frame(2.0)
    if frame is not None:
        eye_of(task, _header(task, lab)).look(frame.image, {})


def _header(task: Task, lab: Lab) -> Header:
    return Header(
        task_hash=task.hash, plan_hash="", lab=lab, trust=trust_of(task), confirm=False, dry=False,
        version="", started="",
    )  # fmt: skip


def _seen(turns: list[Turn], laboratory: VirtualLaboratory) -> Seen:
    return [(Phase(turn.phase), laboratory.pose_at(turn.reading.time)) for turn in turns]


def _started(
    program: Program, lab: Lab, laboratory: VirtualLaboratory, fate: tuple[int, float] | None = None
) -> None:
    """Run a program in a process of its own until it ends, or is killed some s after an answer."""
    ask, told = os.pipe(), os.pipe()
    child = os.fork()
    if child == 0:
        status = 1
        try:
            os.close(ask[0])
            os.close(told[1])
            with os.fdopen(ask[1], "w") as to, os.fdopen(told[0]) as answers:
                program(devices_at(Line(to, answers, PATIENCE), lab))
            status = 0
        finally:
            os._exit(status)  # nothing of the parent's is tidied up twice
    os.close(ask[1])
    os.close(told[0])
    with os.fdopen(ask[0]) as questions, os.fdopen(told[1], "w") as answers:
        if fate is None:
            serve(laboratory.devices(), questions, answers)
        else:
            serve(laboratory.devices(), _until(questions, fate[0]), answers)
            time.sleep(fate[1])
            os.kill(child, signal.SIGKILL)
    os.waitpid(child, 0)


def _until(questions: IO[str], last: int) -> Iterator[str]:
    """The first questions."""
    for k, line in enumerate(questions, start=1):
        yield line
        if k == last:
            return
