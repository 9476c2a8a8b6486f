"""What may be concealed in a recording set, and the form in which it is stated."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Literal, Self

from pydantic import BaseModel, ConfigDict, FiniteFloat, model_validator

from meso_robust.simulator.catalogue import CATALOGUE, stage_of

Kind = Literal["null", "effect", "pair", "outside", "unidentifiable"]

KINDS: tuple[Kind, ...] = ("null", "effect", "pair", "outside", "unidentifiable")
TITLES: Mapping[Kind, str] = {
    "null": "nothing concealed",
    "effect": "one effect of the catalogue",
    "pair": "two effects of the catalogue",
    "outside": "an effect that the catalogue does not have",
    "unidentifiable": "recordings that cannot show what is concealed",
}
STAGE: Mapping[str, str] = {name: stage_of(name).name for name in CATALOGUE}
"""Stage of every effect of the catalogue."""
SILENT = frozenset({"drag_drift"})
"""Effects that no motion shows alone: the path does not depend on how large the drag is."""
SIZES = (1.0, 2.0, 4.0, 8.0, 16.0)
"""Multiples of the just-detectable size that are distinguished."""
PLAIN = 4.0
"""Multiple of the just-detectable size from which an effect is plain to see."""


class _Told(BaseModel):
    model_config = ConfigDict(extra="allow", frozen=True)


class Truth(_Told):
    """What is concealed, an entry for each effect."""

    stages: tuple[str, ...]
    """Where each acts; of the catalogue's effects that of the catalogue counts."""
    multiples: tuple[FiniteFloat, ...]
    """Size of each over its just-detectable size."""
    parameters: tuple[dict[str, Any], ...]
    """Values of each, as ``diagnosis.json`` names them; may be empty."""


class Label(_Told):
    """What is concealed in a recording set; any further keys are kept."""

    kind: Kind
    names: tuple[str, ...]
    """Effects that are concealed."""
    truth: Truth

    @model_validator(mode="after")
    def _one_entry_each(self) -> Self:
        for key in ("stages", "multiples", "parameters"):
            count = len(getattr(self.truth, key))
            if count != len(self.names):
                raise ValueError(
                    f"truth.{key} has {count} entries; must have {len(self.names)}, "
                    "one for each of names"
                )
        if (self.kind == "null") != (not self.names):
            raise ValueError(
                f"names has {len(self.names)} entries; kind {self.kind!r} has "
                f"{'none' if self.kind == 'null' else 'at least one'}"
            )
        return self
