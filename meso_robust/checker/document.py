"""A certificate as it is read: what may stand where. Nothing of it is believed here."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, FiniteFloat

from meso_robust.reading import Count, Deg, Distance, Factor, MoveNumber, PaperStep, Seed, Um

HexPair = tuple[str, str]
Word = Literal["PROVED", "REFUTED", "UNKNOWN"]
Over = dict[str, HexPair]


class Model(BaseModel):
    """Values of a file: known keys only, nothing converted."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True)


class AimDocument(Model):
    """A commanded coordinate."""

    relative_to: Literal["sensed part", "world"]
    offset_um: Annotated[FiniteFloat, Field(ge=-1e6, le=1e6)]


class RuleDocument(Model):
    """A move of the policy."""

    step: PaperStep
    primitive: str
    action: str
    side: Literal[-1, 0, 1]
    dual_x: AimDocument
    dual_y: AimDocument
    dual_end_x: AimDocument
    single_x: AimDocument | None
    single_y: AimDocument | None
    heading: Literal["-x", "-y", "+x", "+y"]
    mirrored: bool


class BoxDocument(Model):
    """A box of poses for reading."""

    x_um: tuple[Um, Um]
    y_um: tuple[Um, Um]
    theta_deg: tuple[Deg, Deg]


class ExactBox(Model):
    """A box of poses, exactly."""

    x_m: HexPair
    y_m: HexPair
    theta_rad: HexPair


class NamedDocument(Model):
    """A stable id and its data."""

    id: str
    about: dict[str, str]


class ObligationDocument(NamedDocument):
    """One inequality over one box."""

    inequality: str
    verdict: Word
    lower_bound: str | None
    boxes: Count
    over: Over


class StepDocument(Model):
    """One certified move."""

    step: PaperStep
    primitive: str
    action: str
    property: NamedDocument
    verdict: Word
    pre: BoxDocument
    pre_exact: ExactBox
    post: BoxDocument | None
    post_exact: ExactBox | None
    obligations: tuple[ObligationDocument, ...]


class ClaimDocument(Model):
    """What the certificate is about."""

    id: str
    moves: MoveNumber
    premises: tuple[str, ...]
    uncertainties: dict[str, HexPair]
    inequalities: dict[str, str | None]


class UndecidedDocument(Model):
    """Why the verdict is UNKNOWN."""

    move: MoveNumber
    step: PaperStep
    action: str
    reason: NamedDocument
    inequality: str | None
    fails: bool
    over: Over
    settled_by: NamedDocument


class WitnessDocument(Model):
    """A run that breaks the claim."""

    outcome: str
    move: MoveNumber | None
    start: tuple[str, str, str]
    friction: str
    film_ratio_m2: str
    misalignment_rad: str
    sensing: tuple[tuple[str, str, str], ...]
    dual_probe: tuple[HexPair, ...]
    single_probe: tuple[HexPair, ...]
    more: dict[str, str] = {}


class LimitDocument(NamedDocument):
    """What is not proved at a larger factor."""

    step: PaperStep
    action: str


class MarginDocument(Model):
    """How much more uncertainty the plan could bear."""

    factor: Factor
    refused_at: Factor | None
    binds_first: str | None
    each_alone: dict[str, Factor]
    limit: LimitDocument | None


class SimulationDocument(Model):
    """Runs of the simulator: evidence beside the proof."""

    samples: Count
    seed: Seed
    step_um: Annotated[FiniteFloat, Field(gt=0, le=1e6)]
    completed: Count
    in_goal: Count
    in_certified_box: Count | None
    largest_excess_um_um_deg: tuple[tuple[Distance, Distance, Distance], ...]
    simulator_error_um_um_deg: tuple[Distance, Distance, Distance]


class Certificate(Model):
    """A certificate."""

    schema_: Annotated[Literal["meso-robust/certificate/2"], Field(alias="schema")]
    digest: str
    verdict: Word
    task: str
    task_hash: str
    claim: ClaimDocument
    goal: BoxDocument
    goal_exact: ExactBox
    policy: tuple[RuleDocument, ...]
    steps: tuple[StepDocument, ...]
    undecided: UndecidedDocument | None
    witness: WitnessDocument | None
    margin: MarginDocument
    simulation: SimulationDocument
    made_with: dict[str, str]
    reading: dict[str, Any]
    """Sentences for people: not looked at."""
