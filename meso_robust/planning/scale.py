"""Lengths of the planner that suit a part of a millimetre, and smaller ones for a smaller part."""

from __future__ import annotations

from meso_robust import units
from meso_robust.primitives.setup import Setup

FULL_UM = 800.0  # the paper's part is 837 um wide, and such lengths were chosen for it


def fine(setup: Setup) -> float:
    """Factor on such a length: 1 for a part that is at least ``FULL_UM`` wide, less in proportion."""
    return min(1.0, units.to_um(setup.outline.width) / FULL_UM)
