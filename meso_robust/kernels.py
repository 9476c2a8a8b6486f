"""Keys for compiled code that is kept on disk."""

from __future__ import annotations

import hashlib
from pathlib import Path


def fingerprint(*packages: str) -> int:
    """A number that changes with any source of the named packages (folders beside this file).

    Numba keeps compiled code on disk and renews it when the file of the function changes, but not
    when a function that it calls from another file does. What a function encloses is part of its key
    on disk, so a kernel that calls into other files must enclose this number (a stale kernel would
    prove with yesterday's arithmetic), and the functions it calls must not be kept by themselves.
    """
    digest = hashlib.sha256()
    for package in packages:
        for source in sorted((Path(__file__).parent / package).glob("*.py")):
            digest.update(source.read_bytes())
    return int.from_bytes(digest.digest()[:7], "big")
