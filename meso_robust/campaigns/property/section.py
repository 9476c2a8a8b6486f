"""The keys of a part of the kind *property*."""

from __future__ import annotations

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from meso_robust.campaigns.kind import Section
from meso_robust.campaigns.property.registry import PROPERTIES


class PropertySection(Section):
    """The keys of a part of this kind."""

    kind: Literal["property"]
    """The kind: laws of the package are tried on random examples."""
    properties: Annotated[tuple[str, ...], Field(min_length=1)] = tuple(PROPERTIES)
    """Names of the laws; all if absent."""
    examples: Annotated[int, Field(ge=1, le=10**9)]
    """Budget of each law."""
    chunk: Annotated[int, Field(ge=1, le=10**6)] | None = None
    """Examples of a chunk; as many as take some seconds if absent."""

    @model_validator(mode="after")
    def _known_and_once(self) -> Self:
        for name in self.properties:
            if name not in PROPERTIES:
                raise ValueError(
                    f"{name!r} is not a property; must be one of {', '.join(PROPERTIES)}"
                )
            if self.properties.count(name) > 1:
                raise ValueError(f"property {name!r} is given twice; name each once")
        return self
