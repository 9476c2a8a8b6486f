"""The simulator's kernel, compiled by a process of its own while this one compiles what proves.

Numba compiles one kernel at a time in a process. The kernels that prove and the one that simulates take
about equally long, so that a first plan on two cores takes little more than half of the time.
"""

from __future__ import annotations

import atexit
import subprocess
import sys
from functools import cache
from pathlib import Path

import numpy as np
from numba import config

from meso_robust.lifetime import short
from meso_robust.simulator.batch import run_range, simulate
from meso_robust.simulator.push import Push

PATIENCE = 300.0
"""s; it takes 20 s of a core, and machines may be busy or slow."""


def begin() -> None:
    """Begin to compile what is not kept on disk yet; does nothing the second time."""
    _compiling()


def wait() -> None:
    """Wait until it is compiled; does nothing if nothing was begun.

    A process that failed, or that takes longer than `PATIENCE` and is ended, is no error: the kernel is then
    compiled at its first call, as ever.
    """
    if _compiling.cache_info().currsize and (process := _compiling()) is not None:
        try:
            process.wait(PATIENCE)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()


@cache
def _compiling() -> subprocess.Popen[bytes] | None:
    if config.DISABLE_JIT or _is_kept():
        return None
    # -P: not what lies in the present folder
    words = [sys.executable, "-P", "-m", __name__]
    quiet = subprocess.DEVNULL
    try:
        process = subprocess.Popen(words, stdin=quiet, stdout=quiet, stderr=quiet)
    except OSError:
        return None
    atexit.register(process.terminate)
    return process


def _is_kept() -> bool:
    """Whether what is kept is younger than every source; Numba itself looks closer when it loads it."""
    newest = max(source.stat().st_mtime for source in Path(__file__).parent.glob("*.py"))
    return any(index.stat().st_mtime >= newest for index in _indices())


def _indices() -> list[Path]:
    """Numba's tables of what it keeps of the kernel."""
    module = run_range.__module__.rpartition(".")[2]
    return list(Path(run_range.stats.cache_path).glob(f"{module}.*.nbi"))  # type: ignore[attr-defined]


def _compile() -> None:
    """Run the kernel once, on a push that touches nothing."""
    short()
    corners = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]) * 1e-3
    simulate(
        Push.straight(
            vertices=corners,
            poses=np.zeros((1, 3)),
            tips=np.array([[[5e-3, 0.0]]]),
            travel=np.array([[[1e-6, 0.0]]]),
            friction=np.zeros((1, 1)),
            film_ratio=1e-6,
            step=1e-6,
        ),
        workers=1,
    )
    for index in _indices():
        index.touch()  # loaded, not compiled, if a source changed its date alone


if __name__ == "__main__":
    _compile()
