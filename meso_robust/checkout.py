"""The checkout that the package runs from, if it does."""

from __future__ import annotations

import subprocess
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
NONE = "not a checkout"


def commit() -> str:
    """Commit of the checkout that the package runs from, or why there is none.

    An installed package can lie in a folder of somebody else's repository, whose commit says nothing.
    """
    if not ((ROOT / ".git").exists() and (ROOT / "pyproject.toml").is_file()):
        return NONE
    try:
        answer = subprocess.run(
            ["git", "-C", str(ROOT), "rev-parse", "--short", "HEAD"],
            capture_output=True,
            text=True,
            timeout=5,
            check=False,
        )
    except (OSError, subprocess.TimeoutExpired):
        return "unknown"
    return answer.stdout.strip() or NONE
