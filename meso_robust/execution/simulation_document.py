"""``simulation.json``: what became of every run; evidence beside a proof, never part of one."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field

from meso_robust.planning.document import BoxDocument


class _Model(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True, populate_by_name=True)


class FinalPose(_Model):
    """The part at the end of a run."""

    x_um: float
    y_um: float
    theta_deg: float


class RunDocument(_Model):
    """One run."""

    run: str
    """nominal, worst, witness, or ``sample K`` from 0."""
    outcome: str
    """completed, jam, starts inside, or the simulator's name of its own failure."""
    move: int | None
    """Move that ended early, from 1; null if all were completed."""
    touching: tuple[str, ...]
    """Probes that held the part when it jammed."""
    final: FinalPose
    miss: float | None
    """Largest of the three distances from the goal's middle in tolerances; null unless completed."""
    in_goal: bool


class UncertainDocument(_Model):
    """Something uncertain in a run, SI; the name ends in the unit."""

    name: str
    value: str
    """The double in hexadecimal."""
    low: str
    high: str


class CaseDocument(_Model):
    """A run with everything that was uncertain in it, exactly."""

    run: RunDocument
    draws: tuple[UncertainDocument, ...]


class AdversaryDocument(_Model):
    """The worst run that was found."""

    note: str = "found by a search: a run that misses breaks the plan, none found proves nothing"
    evaluations: int
    worst: CaseDocument


class EndingDocument(_Model):
    """A way in which sampled runs did not end in the goal."""

    move: int | None
    what: str
    count: int


class SampledDocument(_Model):
    """The random runs in short."""

    runs: int
    completed: int
    in_goal: int
    largest_miss: float | None
    """In tolerances, of the completed runs."""
    failures: tuple[EndingDocument, ...]
    """Most frequent first."""


class SimulationDocument(_Model):
    """A simulation."""

    schema_: Annotated[Literal["meso-robust/simulation/1"], Field(alias="schema")] = (
        "meso-robust/simulation/1"
    )
    task: str
    task_hash: str
    plan_hash: str
    """SHA-256 of the plan's values, independent of layout."""
    kind: Literal["feedback", "open_loop"]
    moves: tuple[str, ...]
    """Primitive of each move."""
    goal: BoxDocument
    seed: int
    step_um: float
    """Longest probe displacement of a simulation step."""
    all_in_goal: bool
    nominal: RunDocument
    sampled: SampledDocument
    adversary: AdversaryDocument | None
    witness: CaseDocument | None
    samples: tuple[RunDocument, ...]
    made_with: dict[str, str]
