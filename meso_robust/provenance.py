"""What code made a result: versions, and the commit of a checkout."""

from __future__ import annotations

import platform
import subprocess
from collections.abc import Iterable
from functools import cache
from importlib.metadata import version
from pathlib import Path


def made_with(packages: Iterable[str] = ("numba", "numpy", "scipy")) -> dict[str, str]:
    """Versions of the package, of what it computes with and of Python, the machine and the commit.

    Parameters
    ----------
    packages
        What else bears on the result, by distribution name.
    """
    return {
        **{name: version(name) for name in ("meso-robust", *packages)},
        "python": platform.python_version(),
        "machine": platform.machine(),
        "commit": commit(),
    }


@cache
def commit() -> str:
    """Commit of the checkout the package runs from, or why there is none."""
    here = Path(__file__).resolve().parent
    try:
        answer = subprocess.run(
            ["git", "-C", str(here), "rev-parse", "--short", "HEAD"],
            capture_output=True,
            text=True,
            timeout=5,
            check=False,
        )
    except OSError:
        return "unknown"
    return answer.stdout.strip() or "not a checkout"
