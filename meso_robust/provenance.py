"""What code made a result, and on what: versions, the commit of a checkout, cores."""

from __future__ import annotations

import os
import platform
import subprocess
from collections.abc import Iterable
from functools import cache
from importlib.metadata import version
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
NONE = "not a checkout"


def made_with(packages: Iterable[str] = ("numba", "numpy", "scipy")) -> dict[str, str]:
    """Versions of the package, of what it computes with and of Python, the machine and the commit.

    Parameters
    ----------
    packages
        What else bears on the result, by distribution name.

    Returns
    -------
    dict
        Name and version.
    """
    return {
        **{name: version(name) for name in ("meso-robust", *packages)},
        "python": platform.python_version(),
        "machine": platform.machine(),
        "commit": commit(),
    }


@cache
def commit() -> str:
    """Commit of the checkout that the package runs from, or why there is none.

    An installed package can lie in a folder of somebody else's repository, whose commit says nothing.

    Returns
    -------
    str
        The short hash, or why there is none.
    """
    if not ((ROOT / ".git").exists() and (ROOT / "pyproject.toml").is_file()):
        return NONE
    try:
        answer = subprocess.run(
            ["git", "-C", str(ROOT), "rev-parse", "--short", "HEAD"],
            capture_output=True,
            text=True,
            timeout=5,  # s: a repository on a network that does not answer must not hold up a plan
            check=False,
        )
    except (OSError, subprocess.TimeoutExpired):
        return "unknown"
    return answer.stdout.strip() or NONE


def cores() -> int:
    """Cores that this process may use, which a container or a batch system can restrict.

    Returns
    -------
    int
        At least one.
    """
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1
