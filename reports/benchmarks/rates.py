"""How fast compiled parts are, beside what they were at commit a28a793: rows of the page of waits."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable
from dataclasses import dataclass

from meso_robust.certificates.chain import certify
from meso_robust.copies import allow
from meso_robust.feasible_regions.maps import Primitive, map_of, moves_of
from meso_robust.identification.identify import identify
from meso_robust.lifetime import short
from meso_robust.planning.compose import compose
from meso_robust.primitives.setup import setup_of
from meso_robust.task import load_task
from meso_robust.tasks import PAPER
from reports.benchmarks import executions, identification, mujoco_push, steps
from reports.benchmarks.events import two_tips_us
from reports.benchmarks.one_push import grounds
from reports.benchmarks.own_push import step_times
from reports.benchmarks.timing import best_of, number, once, reached, table

_CELLS = 128


@dataclass(frozen=True, slots=True, kw_only=True)
class Rate:
    """A figure and what is wanted of it."""

    name: str
    measured: Callable[[], float]
    before: str
    """At commit a28a793, two idle cores."""
    wanted: float
    most: bool = True
    """Whether less is better."""
    peer: Callable[[], str] = lambda: ""
    """What another program needs for the same, where one does it."""


def _steps_a_second() -> float:
    return float(steps.rate(steps.jobs()[0]))


def _one_call_ms() -> float:
    return 1e3 * step_times(grounds()[2], 25)[0].cpu


def _mujoco() -> str:
    ground, setting = grounds()[0], mujoco_push.SETTINGS[0]
    try:
        _, clock = mujoco_push.mujoco_push(ground, setting)
    except ImportError:
        return "MuJoCo not installed"
    return f"MuJoCo, four corners, 4 % off: {number(1e3 * clock.cpu)}"


def _map_s(primitive: Primitive) -> float:
    task = load_task(PAPER)
    setup = setup_of(task)
    chain = certify(compose(task).rules, setup)
    moves, first = moves_of(chain.steps, setup, primitive)
    # as the command line does
    short()
    allow()
    return once(lambda: map_of(primitive, moves, first, _CELLS)).wall


def _three_points_s() -> float:
    recordings = identification.made("three_point")
    identify(recordings, model="three_point", starts=2)
    return once(lambda: identify(recordings, model="three_point", starts=20)).wall


def _import_ms() -> float:
    words = [sys.executable, "-c", "import meso_robust"]
    bare = [sys.executable, "-c", "pass"]
    each = [
        best_of(lambda w=one: subprocess.run(w, check=True), 9).wall  # type: ignore[misc]
        for one in (words, bare)
    ]
    return 1e3 * (each[0] - each[1])


RATES = (
    Rate(name=f"map of the rotation, {_CELLS} × {_CELLS}, s",
         measured=lambda: _map_s("rotation"), before="37.5", wanted=5.0),
    Rate(name=f"map of the Y-translation, {_CELLS} × {_CELLS}, s",
         measured=lambda: _map_s("y_translation"), before="14.4", wanted=5.0),
    Rate(name="event-driven, two sides, 1 mm, µs", measured=two_tips_us, before="71.8", wanted=20.0),
    Rate(name="film stepper, one call within 0.1 %, ms", measured=_one_call_ms, before="0.41",
         wanted=0.1, peer=_mujoco),
    Rate(name="steps with two contacts a second", measured=_steps_a_second, before="1,500,000",
         wanted=3e6, most=False),
    Rate(name="executions a second held against every claim, two processes",
         measured=lambda: executions.rates(2, "events", True)[0], before="29,500", wanted=60_000.0,
         most=False),
    Rate(name="identify three points, 20 recordings, s", measured=_three_points_s, before="34",
         wanted=10.0),
    Rate(name="import meso_robust, ms more than Python alone", measured=_import_ms, before="50",
         wanted=50.0),
)  # fmt: skip


def section(only: str) -> list[str]:
    """Lines of the table.

    Parameters
    ----------
    only
        Rows whose name has this word; all if empty.
    """
    heads = ("what", "now", "at a28a793", "wanted", "reached", "peer")
    rows = []
    for rate in RATES:
        if only in rate.name:
            print(rate.name, file=sys.stderr)
            now = rate.measured()
            goal = reached(now, rate.wanted, most=rate.most)
            rows.append((rate.name, number(now), rate.before, *goal, rate.peer()))
    return table("Rates", heads, rows)
