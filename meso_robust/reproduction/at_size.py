"""What is found of the shrunk task at one size of the part."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from meso_robust.reproduction.shrunk import Certified, Errors


@dataclass(frozen=True, slots=True, kw_only=True)
class AtSize:
    """Everything at one size."""

    length_um: float
    certified: Mapping[Errors, Certified]
    free: Mapping[Errors, float]
    """Share of runs that end in the goal without adhesion."""
    held: Mapping[str, float]
    """The same with adhesion, all errors shrunk with the part, by the name of the pull."""
