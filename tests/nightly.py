"""Tests that take long: run by ``make nightly``, skipped with a reason elsewhere."""

from __future__ import annotations

import os

import pytest

NIGHT = bool(os.environ.get("MESO_NIGHTLY"))
REASON = "takes long; make nightly runs it"
at_night = pytest.mark.skipif(not NIGHT, reason=REASON)
