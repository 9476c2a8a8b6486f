"""The simulator's kernel is compiled beside others, and of one type for all pushes."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from numba import typeof

from meso_robust.simulator import Push, ahead
from meso_robust.simulator.arrange import inputs_of

PART = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]) * 1e-3


@pytest.fixture(autouse=True)
def _afresh() -> Iterator[None]:
    ahead._compiling.cache_clear()
    yield
    ahead._compiling.cache_clear()


@pytest.fixture
def begun(monkeypatch: pytest.MonkeyPatch) -> list[subprocess.Popen[bytes]]:
    """Processes that were begun; they fail at once instead of compiling."""
    processes: list[subprocess.Popen[bytes]] = []
    begin = subprocess.Popen

    def failing(
        words: list[str], *, stdin: int, stdout: int, stderr: int
    ) -> subprocess.Popen[bytes]:
        assert words[-2:] == ["-m", "meso_robust.simulator.ahead"]
        processes.append(
            begin(
                [sys.executable, "-c", "raise SystemExit(3)"],
                stdin=stdin,
                stdout=stdout,
                stderr=stderr,
            )
        )
        return processes[-1]

    monkeypatch.setattr(subprocess, "Popen", failing)
    return processes


def _push(friction: np.ndarray) -> Push:
    ways = np.array([[[[5e-3, 0.0]], [[4e-3, 0.0]], [[3e-3, 0.0]]]])
    return Push.along(
        vertices=PART, poses=np.zeros((1, 3)), ways=ways, friction=friction,
        support=Push.straight(
            vertices=PART, poses=np.zeros((1, 3)), tips=np.array([[[5e-3, 0.0]]]),
            travel=np.zeros((1, 1, 2)), friction=np.zeros((1, 1)), film_ratio=1e-6, step=1e-6,
        ).support,
        step=1e-6,
    )  # fmt: skip


def test_pushes_of_one_friction_and_of_many_take_the_same_kernel() -> None:
    """Or the longest compilation of all is made twice."""
    plain, by_leg = (
        inputs_of(_push(np.full(shape, 0.3)), np.array([1]), False) for shape in ((1, 1), (1, 2, 1))
    )
    assert by_leg.waypoints.shape[-1] == plain.waypoints.shape[-1] + 1
    assert typeof(plain) == typeof(by_leg)


def test_a_kernel_that_is_not_kept_is_compiled_once(
    begun: list[subprocess.Popen[bytes]], monkeypatch: pytest.MonkeyPatch
) -> None:
    """And one that failed to compile holds up nothing."""
    monkeypatch.setattr(ahead, "_indices", list)
    ahead.wait()
    assert not begun
    ahead.begin()
    ahead.begin()
    ahead.wait()
    assert [process.returncode for process in begun] == [3]


def test_a_process_that_hangs_is_ended_and_holds_up_nothing(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    begin, hanging = subprocess.Popen, [sys.executable, "-c", "import time; time.sleep(600)"]
    processes: list[subprocess.Popen[bytes]] = []

    def hung(_: list[str], *, stdin: int, stdout: int, stderr: int) -> subprocess.Popen[bytes]:
        processes.append(begin(hanging, stdin=stdin, stdout=stdout, stderr=stderr))
        return processes[-1]

    monkeypatch.setattr(ahead, "_indices", list)
    monkeypatch.setattr(ahead, "PATIENCE", 0.2)
    monkeypatch.setattr(subprocess, "Popen", hung)
    ahead.begin()
    began = time.monotonic()
    ahead.wait()
    assert time.monotonic() - began < 60.0
    (process,) = processes
    assert process.returncode is not None
    assert process.returncode != 0


@pytest.mark.parametrize("age", [-1.0, 1.0])
def test_a_kernel_younger_than_its_sources_is_kept(
    age: float,
    begun: list[subprocess.Popen[bytes]],
    monkeypatch: pytest.MonkeyPatch,
    tmp_path: Path,
) -> None:
    """An older one is compiled again."""
    index = tmp_path / "batch.kernel.nbi"
    index.touch()
    newest = max(path.stat().st_mtime for path in Path(ahead.__file__).parent.glob("*.py"))
    os.utime(index, (newest + age, newest + age))
    monkeypatch.setattr(ahead, "_indices", lambda: [index])
    ahead.begin()
    ahead.wait()
    assert len(begun) == (0 if age > 0.0 else 1)


def test_what_is_compiled_is_the_kernel_that_pushes_take() -> None:
    """The process ends well, and leaves what is looked for."""
    ahead._compile()
    assert ahead._is_kept()
