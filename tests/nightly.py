"""Tests that take long: run by ``make nightly``, skipped with a reason elsewhere."""

from __future__ import annotations

import os

import pytest

at_night = pytest.mark.skipif(
    not os.environ.get("MESO_NIGHTLY"), reason="takes long; make nightly runs it"
)
