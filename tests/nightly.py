"""Tests that take long: run by ``make nightly``, skipped with a reason elsewhere."""

from __future__ import annotations

import os
from collections.abc import Iterable
from typing import Any

import pytest

NIGHT = bool(os.environ.get("MESO_NIGHTLY"))
at_night = pytest.mark.skipif(not NIGHT, reason="takes long; make nightly runs it")


def by_day(first: int, cases: Iterable[Any]) -> list[Any]:
    """All cases at night, by day the first few: the others take long to say the same of other values."""
    every = list(cases)
    return every if NIGHT else every[:first]


def often(day: int, night: int) -> int:
    """How often something is drawn."""
    return night if NIGHT else day
