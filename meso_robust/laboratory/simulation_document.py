"""``simulation.json``: what became of every run; evidence beside a proof, never part of one."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from meso_robust.planning.plan_file import BoxDocument, Document


class FinalPose(Document):
    """The part at the end of a run."""

    x_um: float
    """x of the reference point, um, world frame."""
    y_um: float
    """y of the reference point, um, world frame."""
    theta_deg: float
    """Orientation, deg."""


class RunDocument(Document):
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
    """Pose of the part."""
    miss: float | None
    """Largest of the three distances from the goal's middle in tolerances; null unless completed."""
    in_goal: bool
    """Whether the run was completed and ended in the goal."""


class UncertainDocument(Document):
    """Something uncertain in a run, SI; the name ends in the unit."""

    name: str
    """What is uncertain."""
    value: str
    """The double in hexadecimal."""
    low: str
    """Lower end of its range, hexadecimal."""
    high: str
    """Upper end of its range, hexadecimal."""


class CaseDocument(Document):
    """A run with everything that was uncertain in it, exactly."""

    run: RunDocument
    """Its outcome."""
    draws: tuple[UncertainDocument, ...]
    """Every uncertain quantity."""


class AdversaryDocument(Document):
    """The worst run that was found."""

    note: str = "found by a search: a run that misses breaks the plan, none found proves nothing"
    """How to read it."""
    evaluations: int
    """Runs that the search made."""
    worst: CaseDocument
    """The worst of them."""


class EndingDocument(Document):
    """A way in which sampled runs did not end in the goal."""

    move: int | None
    """Move that ended early, from 1; null if all were completed."""
    what: str
    """How the runs ended."""
    count: int
    """Number of such runs."""


class SampledDocument(Document):
    """The random runs in short."""

    runs: int
    """Random runs."""
    completed: int
    """Runs that carried out all moves."""
    in_goal: int
    """Runs that ended in the goal."""
    largest_miss: float | None
    """In tolerances, of the completed runs."""
    failures: tuple[EndingDocument, ...]
    """Most frequent first."""


class SimulationDocument(Document):
    """A simulation."""

    schema_: Annotated[Literal["meso-robust/simulation/1"], Field(alias="schema")] = (
        "meso-robust/simulation/1"
    )
    """Name and version of the format."""
    task: str
    """Name of the task."""
    task_hash: str
    """SHA-256 of the task's values."""
    plan_hash: str
    """SHA-256 of the plan's values, independent of layout."""
    kind: Literal["feedback", "open_loop"]
    """Whether moves follow the sensed pose or are fixed."""
    moves: tuple[str, ...]
    """Primitive of each move."""
    goal: BoxDocument
    """The goal."""
    seed: int
    """Seed of all draws."""
    step_um: float
    """Longest probe displacement of a simulation step."""
    all_in_goal: bool
    """Whether every run ended in the goal."""
    nominal: RunDocument
    """The run without errors."""
    sampled: SampledDocument
    """The random runs in short."""
    adversary: AdversaryDocument | None
    """The worst run that a search found; null without `--adversarial`."""
    witness: CaseDocument | None
    """The replayed witness; null without `--witness`."""
    samples: tuple[RunDocument, ...]
    """The random runs one by one."""
    made_with: dict[str, str]
    """Versions of what the simulation was made with."""
