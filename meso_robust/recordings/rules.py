"""Rules that values in memory and values in files share, and the units of the files."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence

import numpy as np

from meso_robust.types import Floats

# Not from `units`: that module encloses its products and loads the interval arithmetic for it.
UM = 1e-6
"""Metres in a micrometre, and newtons in a micronewton."""
DEG = math.pi / 180.0
"""Radians in a degree."""

CLOCK_RULE = "must be after the instant of the row before"

_PROBE = re.compile(r"[A-Za-z][A-Za-z0-9_]{0,63}")


def file_fault(name: str) -> str | None:
    """What forbids a name as that of a recording's file, or None; "value; rule; advice".

    Parameters
    ----------
    name
        As stated.

    Returns
    -------
    str or None
        The fault.
    """
    plain = name.isprintable() and not set(name) & set('/\\:*?"<>|')
    if plain and name.endswith(".csv") and name != ".csv":
        return None
    rule = "must be the plain name of a file in the folder of the set, ending in .csv"
    return f"{name!r}; {rule}; use a name such as push_00.csv"


def probe_fault(name: str) -> str | None:
    """What forbids a name as that of a probe, or None; "value; rule; advice".

    Parameters
    ----------
    name
        As stated.

    Returns
    -------
    str or None
        The fault.
    """
    if _PROBE.fullmatch(name) and name != "part":
        return None
    rule = "must be a letter, then letters, digits and _, and not part"
    return f"{name!r}; {rule}; use a name such as probe1"


def twice_fault(names: Sequence[str]) -> str | None:
    """Say which name appears twice, or None; upper and lower case count as the same."""
    lower = [name.lower() for name in names]
    for k, name in enumerate(lower):
        if name in lower[:k]:
            return f"{names[k]!r} appears twice; names must differ, not only in case; rename one"
    return None


def clock_fault(times: Floats) -> tuple[int, str] | None:
    """First wrong instant of a clock with its value and the rule, or None."""
    rule = "must be a finite number of seconds"
    for wrong in np.flatnonzero(~np.isfinite(times))[:1]:
        return int(wrong), f"{times[wrong]}; {rule}; leave the row out"
    for wrong in np.flatnonzero(np.diff(times) <= 0.0)[:1] + 1:
        rule = f"{CLOCK_RULE}, {times[wrong - 1]} s"
        return int(wrong), f"{times[wrong]} s; {rule}; sort the rows, keep one of each instant"
    return None
