"""Where what is computed once is kept: compiled kernels, the list of fonts.

Besides the folder of the results these are the only places that a command writes to. Numba keeps a
kernel beside its source, where Python keeps its own compiled files, or in the user's cache folder
where the package may not be written to.
"""

from __future__ import annotations

import atexit
import os
import shutil
import sys
import tempfile
from collections.abc import Mapping, MutableMapping
from pathlib import Path

PACKAGE = Path(__file__).resolve().parent
NAME = "meso-robust"


def user_folder(environ: Mapping[str, str] = os.environ) -> Path | None:
    """The user's cache folder by the custom of the system; None for a user without a home.

    Parameters
    ----------
    environ
        Of the process.

    Returns
    -------
    Path | None
        It need not be there.
    """
    if sys.platform == "win32":
        named = environ.get("LOCALAPPDATA")
    else:
        named = environ.get("XDG_CACHE_HOME")
    if named and Path(named).is_absolute():
        return Path(named)
    try:
        home = Path.home()
    except RuntimeError:
        return None
    return home / ("Library/Caches" if sys.platform == "darwin" else ".cache")


def kernels(environ: Mapping[str, str] = os.environ) -> str:
    """Where Numba keeps compiled kernels, in words.

    Parameters
    ----------
    environ
        Of the process.

    Returns
    -------
    str
        A folder, or a pattern of folders.
    """
    if environ.get("NUMBA_CACHE_DIR"):
        return environ["NUMBA_CACHE_DIR"]
    if _writable(PACKAGE):
        return f"{PACKAGE}/**/__pycache__"
    folder = user_folder(environ)
    return f"{folder / 'numba'}" if folder and _writable(folder) else "a temporary folder"


def prepare(environ: MutableMapping[str, str] = os.environ) -> None:
    """Name folders that can be written to, for this process and for those that it starts.

    What the user has set stays. Numba cannot compile where it finds no place for its kernels, so
    without any it is given a temporary one.

    Parameters
    ----------
    environ
        Of the process; the names are set in it.
    """
    folder = user_folder(environ)
    if folder is not None and _writable(folder):
        # their own choice would be a folder of settings in the home, and the current folder
        environ.setdefault("MPLCONFIGDIR", str(folder / NAME / "matplotlib"))
        environ.setdefault("HYPOTHESIS_STORAGE_DIRECTORY", str(folder / NAME / "hypothesis"))
        return
    temporary = tempfile.mkdtemp(prefix=f"{NAME}-")
    atexit.register(shutil.rmtree, temporary, ignore_errors=True)
    environ.setdefault("MPLCONFIGDIR", temporary)
    environ.setdefault("HYPOTHESIS_STORAGE_DIRECTORY", temporary)
    if not _writable(PACKAGE):
        environ.setdefault("NUMBA_CACHE_DIR", temporary)


def _writable(folder: Path) -> bool:
    """Whether files can be made in a folder, or the folder itself where there is none yet."""
    try:
        nearest = next(path for path in (folder, *folder.parents) if path.exists())
    except OSError:
        return False
    return nearest.is_dir() and os.access(nearest, os.W_OK | os.X_OK)
