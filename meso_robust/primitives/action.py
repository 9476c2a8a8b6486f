"""Names of the certified motions."""

from __future__ import annotations

from typing import Literal

Action = Literal["tilt", "straighten", "rotate", "regrasp", "guide"]
