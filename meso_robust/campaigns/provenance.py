"""What code makes a result: results of different code are never added up."""

from __future__ import annotations

import hashlib
import os
import platform
from functools import cache
from importlib.metadata import version
from pathlib import Path

from meso_robust import __version__

PACKAGES = ("casadi", "cma", "hypothesis", "numba", "numpy", "python-flint", "scipy", "sympy")
"""Those whose version may bear on the last bit of a result."""


TOLD_BY = ("cli", "reporting", "reproduction")
"""Folders of the package that no result can depend on."""


@cache
def code() -> str:
    """What decides whether results may be added up.

    Returns
    -------
    str
        SHA-256 over the package's sources and the versions of what it computes with.
    """
    digest = hashlib.sha256(__version__.encode())
    folder = Path(__file__).resolve().parents[1]
    for source in sorted(folder.rglob("*.py")):
        name = source.relative_to(folder)
        if name.parts[0] in TOLD_BY:
            continue
        digest.update(name.as_posix().encode() + b"\0")
        digest.update(source.read_bytes())
    for package, found in versions().items():
        digest.update(f"{package} {found}\0".encode())
    return digest.hexdigest()


@cache
def versions() -> dict[str, str]:
    """Versions of what results are computed with.

    Returns
    -------
    dict
        By the name of the package; ``python`` too.
    """
    return {"python": platform.python_version(), **{name: version(name) for name in PACKAGES}}


def machine() -> str:
    """The machine that runs this: system, processor, number of cores."""
    return f"{platform.system()} {platform.machine()}, {os.cpu_count()} cores"
