"""A certificate as it is read: what may stand where. Nothing of it is believed here."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field, FiniteFloat

HexPair = tuple[str, str]
Pair = tuple[FiniteFloat, FiniteFloat]
Word = Literal["PROVED", "REFUTED", "UNKNOWN"]
Over = dict[str, HexPair]


class _Model(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True, strict=True)


class AimDocument(_Model):
    """A commanded coordinate."""

    relative_to: Literal["sensed part", "world"]
    offset_um: Annotated[FiniteFloat, Field(ge=-1e6, le=1e6)]


class RuleDocument(_Model):
    """A move of the policy."""

    step: int
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


class BoxDocument(_Model):
    """A box of poses for reading."""

    x_um: Pair
    y_um: Pair
    theta_deg: Pair


class ExactBox(_Model):
    """A box of poses, exactly."""

    x_m: HexPair
    y_m: HexPair
    theta_rad: HexPair


class ObligationDocument(_Model):
    """One inequality over one box."""

    claim: str
    inequality: str
    derivation: str
    verdict: Word
    lower_bound: str | None
    boxes: int
    over: Over


class StepDocument(_Model):
    """One certified move."""

    step: int
    primitive: str
    action: str
    property: str
    verdict: Word
    pre: BoxDocument
    pre_exact: ExactBox
    post: BoxDocument | None
    post_exact: ExactBox | None
    obligations: tuple[ObligationDocument, ...]


class ClaimDocument(_Model):
    """What the certificate is about."""

    words: str
    assumptions: tuple[str, ...]
    inequalities: tuple[str, ...]


class UndecidedDocument(_Model):
    """Why the verdict is UNKNOWN."""

    move: int
    step: int
    action: str
    claim: str
    inequality: str
    fails: bool
    over: Over
    settled_by: str


class WitnessDocument(_Model):
    """A run that breaks the claim."""

    outcome: str
    start: tuple[str, str, str]
    friction: str
    film_ratio_m2: str
    misalignment_rad: str
    sensing: tuple[tuple[str, str, str], ...]
    dual_probe: tuple[HexPair, ...]
    single_probe: tuple[HexPair, ...]


class MarginDocument(_Model):
    """How much more uncertainty the plan could bear."""

    factor: FiniteFloat
    refused_at: FiniteFloat | None
    binds_first: str | None
    each_alone: dict[str, FiniteFloat]
    limit: str | None


class SimulationDocument(_Model):
    """Runs of the simulator: evidence beside the proof."""

    samples: int
    seed: int
    step_um: FiniteFloat
    completed: int
    in_goal: int
    in_certified_box: int | None
    largest_excess_um_um_deg: tuple[tuple[FiniteFloat, FiniteFloat, FiniteFloat], ...]
    simulator_error_um_um_deg: tuple[FiniteFloat, FiniteFloat, FiniteFloat]


class Certificate(_Model):
    """A certificate."""

    schema_: Annotated[Literal["meso-robust/certificate/1"], Field(alias="schema")]
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
