"""Example tasks that ship with the package; ``paper.toml`` is the default."""

from __future__ import annotations

from pathlib import Path

_HERE = Path(__file__).parent
PAPER = _HERE / "paper.toml"
SLOT = _HERE / "slot.toml"
TWO_PROBES = _HERE / "two_probes.toml"
HEXAGON = _HERE / "hexagon.toml"
L_SHAPE = _HERE / "l_shape.toml"
SMALL = _HERE / "small.toml"
MICROSCOPE = _HERE / "microscope.toml"
"""For `meso-robust run`: schema 2, as a laboratory can be."""
SMALL_MODEL = _HERE / "small_model.toml"
"""What a diagnosis of recordings of the small part would have written: its tips adhere."""
TASKS = (PAPER, SLOT, TWO_PROBES, HEXAGON, L_SHAPE, SMALL)
"""Every task; each can be planned as it is."""
