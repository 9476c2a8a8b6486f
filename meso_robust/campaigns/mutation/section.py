"""The keys of a campaign of tampered certificates."""

from __future__ import annotations

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from meso_robust.campaigns.kind import PlanSection

FORGED = 0.25
"""Share of the certificates that are forged, unless another is asked for."""


class MutationSection(PlanSection):
    """Certificates that are tampered with: what the checker accepts must still be true."""

    kind: Literal["mutation"]
    """The kind: changed certificates are given to the checker."""
    factor: Annotated[float, Field(ge=1, le=1)] = 1.0
    """A certificate is about the task's own uncertainties: 1."""
    certificate: str | None = None
    """Certificate for the task, relative to the campaign file; generated for the plan if absent."""
    certificates: Annotated[int, Field(ge=1, le=10**8)] = 3000
    """How many tampered ones are checked."""
    chunk: Annotated[int, Field(ge=1, le=10**5)] = 100
    """Certificates in a chunk: some seconds of work."""
    changes: Annotated[int, Field(ge=1, le=5)] = 1
    """Things changed at once in each."""
    forged: Annotated[float, Field(ge=0, le=1)] = FORGED
    """Share of the certificates that are forged with care, in all that must fit together; the others have
    single values changed."""

    @model_validator(mode="after")
    def _one_source(self) -> Self:
        if self.certificate is not None and self.plan is not None:
            raise ValueError(
                "plan and certificate are both given; a certificate holds its plan: give one of them"
            )
        return self
