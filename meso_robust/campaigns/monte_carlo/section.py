"""The keys of a part of the kind *monte-carlo*."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, FiniteFloat

from meso_robust.campaigns.kind import PlanSection


class MonteCarloSection(PlanSection):
    """The keys of a part of this kind."""

    kind: Literal["monte-carlo"]
    """The kind: the success rate of a plan with its interval."""
    executions: Annotated[int, Field(ge=1, le=10**12)]
    """Runs in all."""
    engine: Literal["events", "stepper"] = "events"
    """Event-driven, or LCP stepper; bare moves are run by the stepper."""
    draws: Literal["uniform", "corners"] = "uniform"
    """Of everything uncertain: within its range, or at its ends."""
    chunk: Annotated[int, Field(ge=1, le=10**7)] | None = None
    """Executions of a chunk."""
    at_least: Annotated[FiniteFloat, Field(ge=0, le=1)] | None = None
    """Success that is demanded: ``held`` if the lower end of the interval reaches it."""
