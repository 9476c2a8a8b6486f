"""Example tasks that ship with the package; ``paper.toml`` is the default."""

from __future__ import annotations

from pathlib import Path

PAPER = Path(__file__).parent / "paper.toml"
SLOT = Path(__file__).parent / "slot.toml"
HEXAGON = Path(__file__).parent / "hexagon.toml"
L_SHAPE = Path(__file__).parent / "l_shape.toml"
