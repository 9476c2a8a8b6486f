"""``meso-robust --version``: everything that a report of a fault needs."""

from __future__ import annotations

import os
import platform
import re
import sys
from importlib.metadata import PackageNotFoundError, requires, version
from pathlib import Path

from meso_robust import __version__
from meso_robust.caches import PACKAGE, kernels, user_folder
from meso_robust.provenance import commit, cores

_NEEDED = re.compile(
    r"(?P<name>[\w.-]+)(?:\[[^]]*\])?(?P<rest>[^;]*)(?:;.*extra *== *['\"](?P<extra>\w+))?"
)


def lines() -> list[str]:
    """The answer, a line a fact."""
    facts = {
        "meso-robust": f"{__version__}, {commit()}",
        "installed in": str(PACKAGE.parent),
        "python": f"{platform.python_version()} {platform.python_implementation()}, {sys.executable}",
        "platform": platform.platform(),
        "processor": f"{_processor()}, {cores()} of {os.cpu_count()} cores usable",
        "locale": f"{sys.getfilesystemencoding()} files, {sys.stdout.encoding} output",
        "linear algebra": _blas(),
        "compiled kernels": kernels(),
        "user's cache folder": str(user_folder() or "none"),
    }
    packages = {
        f"{name}{f' (extra {extra})' if extra else ''}": _version(name)
        for name, extra in dependencies()
    }
    width = max(map(len, [*facts, *packages]))
    return [f"{key:{width}}  {value}" for key, value in (facts | packages).items()]


def dependencies() -> list[tuple[str, str]]:
    """Names of what the package needs, each with the extra that asks for it, none for the plain ones."""
    try:
        stated = requires("meso-robust") or []
    except PackageNotFoundError:
        return []
    found = [match for line in stated if (match := _NEEDED.match(line))]
    named = {(match["name"].lower(), match["extra"] or "") for match in found}
    return sorted(
        ((name, extra) for name, extra in named if extra != "dev"), key=lambda one: one[::-1]
    )


def _version(name: str) -> str:
    try:
        return version(name)
    except PackageNotFoundError:
        return "not installed"


def _processor() -> str:
    try:
        found = re.search(
            r"model name\s*:\s*(.+)", Path("/proc/cpuinfo").read_text(encoding="utf-8")
        )
    except OSError:
        found = None
    return f"{found[1] if found else platform.processor() or 'unknown'} ({platform.machine()})"


def _blas() -> str:
    """What NumPy computes with: the last bits of a result can depend on it."""
    import numpy as np

    shown: object = np.show_config(mode="dicts")
    found = shown.get("Build Dependencies", {}).get("blas", {}) if isinstance(shown, dict) else {}
    kernel = os.environ.get("OPENBLAS_CORETYPE")
    told = f"{found.get('name', 'unknown')} {found.get('version', '')}".strip()
    return f"{told}, OPENBLAS_CORETYPE={kernel}" if kernel else told
