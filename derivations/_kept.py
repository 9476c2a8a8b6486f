"""Derivations kept on disk, each by a hash of everything that it follows from.

A kept derivation is taken only if nothing has changed that could change a statement or its proof:
the file that states it, the files that this one imports, the code that proves, and the versions of
what that calls. It lies where Python keeps its own compiled files, and is trusted as they are.
"""

from __future__ import annotations

import ast
import contextlib
import hashlib
import os
import pickle
import sys
import tempfile
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

from derivations._derivation import Derivation

FOLDER = Path(__file__).resolve().parent
KEPT = FOLDER / "__pycache__"
PROVERS = ("sympy", "mpmath", "z3-solver", "python-flint", "gmpy2")
"""What proves, and the arithmetic that SymPy uses where it is installed."""


def key(name: str, folder: Path = FOLDER) -> str:
    """Hash of everything that a derivation follows from.

    Parameters
    ----------
    name
        A file of the folder, without ``.py``.
    folder
        The derivations.

    Returns
    -------
    str
        64 hexadecimal digits.
    """
    digest = hashlib.sha256(sys.version.encode())
    for package in PROVERS:
        digest.update(f"\n{package} {_version(package)}".encode())
    for source in sorted(_sources(name, folder)):
        text = source.read_bytes()
        digest.update(f"\n{source.name} {len(text)}\n".encode() + text)
    return digest.hexdigest()


def load(name: str, kept: Path = KEPT) -> Derivation | None:
    """The derivation as it was kept; None if it is not, or anything that it follows from changed.

    Parameters
    ----------
    name
        As of `key`.
    kept
        Where they are kept.

    Returns
    -------
    Derivation or None
    """
    try:
        digest, found = pickle.loads((kept / f"{name}.proof").read_bytes())
    except Exception:  # none, cut short, or of classes that are no more: it is derived anew
        return None
    return found if digest == key(name) and isinstance(found, Derivation) else None


def keep(derivation: Derivation, digest: str, kept: Path = KEPT) -> None:
    """Keep a derivation, whole or not at all; where nothing can be written, none is kept.

    Parameters
    ----------
    derivation
        Which holds: one with a step that does not is never made.
    digest
        Its `key`, taken before it was derived: a file that changes meanwhile is then noticed.
    kept
        Where they are kept.
    """
    with contextlib.suppress(OSError):
        kept.mkdir(exist_ok=True)
        handle, draft = tempfile.mkstemp(dir=kept)
        with os.fdopen(handle, "wb") as file:
            pickle.dump((digest, derivation), file)
        Path(draft).replace(kept / f"{derivation.name}.proof")


def _version(package: str) -> str:
    try:
        return version(package)
    except PackageNotFoundError:
        return "none"


def _sources(name: str, folder: Path) -> set[Path]:
    """The file, what it imports from the folder, and the code that proves."""
    found = {*folder.glob("_*.py"), folder / "generate.py"}
    open_ = [folder / f"{name}.py"]
    while open_:
        source = open_.pop()
        if source not in found and source.is_file():
            found.add(source)
            open_ += [folder / f"{module}.py" for module in _imported(source)]
    return found


def _imported(source: Path) -> set[str]:
    """Files of the folder that a file imports, anywhere in it."""
    names: set[str] = set()
    for node in ast.walk(ast.parse(source.read_bytes())):
        if isinstance(node, ast.Import):
            names |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module is not None:
            names |= {node.module, *(f"{node.module}.{alias.name}" for alias in node.names)}
    parts = (name.split(".") for name in names)
    return {part[1] for part in parts if part[0] == "derivations" and len(part) > 1}
