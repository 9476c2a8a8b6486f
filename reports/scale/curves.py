"""What grows, and the work at each size."""

from __future__ import annotations

import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from meso_robust.certificates.chain import certify
from meso_robust.diagnosis.answer import diagnosed
from meso_robust.identification.identify import identify
from meso_robust.kernels import one_thread
from meso_robust.laboratory.judging import judge
from meso_robust.planning.reading import read_plan
from meso_robust.planning.rules import rules_of
from meso_robust.primitives.setup import Setup, setup_of
from meso_robust.recordings import read_set, write_set
from meso_robust.simulator import Film
from meso_robust.task import load_task
from meso_robust.tasks import PAPER
from meso_robust.tracking.frames import open_frames
from meso_robust.tracking.track import track
from reports.benchmarks.complementarity import solve_all
from reports.benchmarks.tracking import scene_of
from tests.identification.sets import random_pushes, recorded
from tests.laboratory.paper import paper_claims, paper_player
from tests.simulator.problems import contact_problems, random_rows
from tests.tracking.pushes import push

Work = Callable[[], object]
REAL = Path(__file__).parents[1] / "real_paper"


@dataclass(frozen=True, slots=True, kw_only=True)
class Curve:
    """Work whose cost grows."""

    name: str
    grows_with: str
    usual: int
    """Largest size of everyday use."""
    sizes: tuple[int, ...]
    made: Callable[[int], Work]
    """Prepares the work of a size, which is not counted."""
    expected: float
    """Exponent that the algorithm promises."""

    def costs(self) -> list[float]:
        """Processor time of each size, s; the least one first, unseen, as it may compile."""
        self.made(self.sizes[0])()
        return [_cost(self.made(size)) for size in self.sizes]


def exponent(sizes: tuple[int, ...], costs: list[float]) -> float:
    """Slope of the logarithm of the cost over that of the size, from the larger half of the sizes."""
    half = len(sizes) // 2
    slope, _ = np.polyfit(np.log(sizes[half:]), np.log(costs[half:]), 1)
    return float(slope)


def _cost(work: Work) -> float:
    """Mean of a fifth of a second, and of one time at least after one that warms up."""
    with one_thread():
        work()
        spent, times, start = 0.0, 0, time.process_time()
        while spent < 0.2:
            work()
            times, spent = times + 1, time.process_time() - start
        return spent / times


def _runs(count: int) -> Work:
    player, claims = replace(paper_player(), engine="events"), paper_claims()
    rows = player.draw(count, np.random.default_rng(0))
    return lambda: judge(player, claims, rows)


def _inputs(count: int) -> Work:
    """The first pushes of the plan for real probes, of whose inputs so many are uncertain."""
    task = load_task(REAL / "task.toml")
    setup, exact = setup_of(task), setup_of(load_task(PAPER))
    rules = rules_of(read_plan(REAL / "plan.json", task))[:2]
    always = len(exact.uncertainty.stated)
    names = [n for n in setup.uncertainty.stated if n not in exact.uncertainty.stated]
    known = {name: getattr(exact.uncertainty, name) for name in names[count - always :]}
    given: Setup = replace(setup, uncertainty=replace(setup.uncertainty, **known))
    return lambda: certify(rules, given, whole=False)


def _contacts(count: int) -> Work:
    rng = np.random.default_rng(0)
    M, q = contact_problems(random_rows(500, count, rng), rng.uniform(0.0, 1.0, 500))
    z = np.zeros_like(q)
    return lambda: solve_all(M, q, z, 1)


def _frames(count: int) -> Work:
    folder = Path(tempfile.mkdtemp())
    filmed = push(folder / "push.avi", count, speed=6e-4 / count)
    return lambda: track(open_frames(filmed.path), scene_of(filmed, probes=True))


def _set(count: int) -> Path:
    rng = np.random.default_rng(1)
    made = recorded(random_pushes(rng, count), Film.ratio(np.full(count, 0.3769e-6)), 0.33, rng)
    folder = Path(tempfile.mkdtemp())
    write_set(folder, made)
    return folder


def _read(count: int) -> Work:
    folder = _set(count)
    return lambda: read_set(folder)


def _identified(count: int) -> Work:
    recordings = read_set(_set(count))
    return lambda: identify(recordings, model="viscous", starts=4, objective="likelihood")


def _diagnosed(count: int) -> Work:
    folder = _set(count)
    return lambda: diagnosed(folder, quick=True)


CURVES = (
    Curve(
        name="runs of a plan held against every claim", grows_with="runs", usual=10_000,
        sizes=(100, 1_000, 10_000, 100_000), made=_runs, expected=1.0,
    ),
    Curve(
        name="certificate of the first two pushes for real probes", grows_with="uncertain inputs",
        usual=13, sizes=(6, 8, 10, 13), made=_inputs, expected=2.0,
    ),
    Curve(
        name="500 contact problems by Lemke's method", grows_with="contacts", usual=3,
        sizes=(1, 2, 3, 6, 12, 30), made=_contacts, expected=3.0,
    ),
    Curve(
        name="tracking part and probe", grows_with="frames", usual=150,
        sizes=(15, 50, 150, 500, 1_500), made=_frames, expected=1.0,
    ),
    Curve(
        name="reading and checking a set", grows_with="recordings", usual=20,
        sizes=(2, 6, 20, 60, 200), made=_read, expected=1.0,
    ),
    Curve(
        name="fit of a film, four starts", grows_with="recordings", usual=20,
        sizes=(2, 6, 20, 60, 200), made=_identified, expected=1.0,
    ),
    Curve(
        name="quick diagnosis, nothing concealed", grows_with="recordings", usual=20,
        sizes=(6, 20, 60, 200), made=_diagnosed, expected=1.0,
    ),
)  # fmt: skip
"""All of them, each up to ten times what is usual (inputs: all that a task can state)."""
