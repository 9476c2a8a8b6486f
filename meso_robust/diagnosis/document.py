"""``diagnosis.json``: a diagnosis as it stands in a file."""

from __future__ import annotations

from typing import Annotated, Literal, TypeAlias

from pydantic import BaseModel, ConfigDict, Field, FiniteFloat

SCHEMA = "meso-robust/diagnosis/1"
FILE = "diagnosis.json"

Channel: TypeAlias = Literal[
    "support", "contact", "actuation", "observation", "environment", "geometry"
]
"""Stage of the chain from command to recording."""
PhaseName: TypeAlias = Literal["approach", "one_point", "two_point", "retract", "rest"]
Component: TypeAlias = Literal["x", "y", "theta"]
Verdict: TypeAlias = Literal["consistent", "named", "ambiguous", "unknown"]

Probability = Annotated[FiniteFloat, Field(ge=0, le=1)]
Count = Annotated[int, Field(ge=0)]
NotNegative = Annotated[FiniteFloat, Field(ge=0)]
Key = Annotated[str, Field(min_length=1)]


class _Section(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True, strict=True, title=None)


class ValueSection(_Section):
    """A number with its interval."""

    value: FiniteFloat
    low: FiniteFloat
    high: FiniteFloat
    unit: str = ""


class BaselineSection(_Section):
    """The plain model, fitted to the training recordings."""

    model: Key
    parameters: dict[Key, ValueSection]


class WhereSection(_Section):
    """A span of a recording in which the plain model fails."""

    recording: Key
    start_s: FiniteFloat
    end_s: FiniteFloat
    phase: PhaseName
    channel: Channel
    """Stage whose hidden input explains the span best."""
    component: Component
    sigma: NotNegative
    """Size of the misfit, in standard deviations of its distribution without a mismatch."""
    grows_with: str
    """Covariate that the misfit of this component follows; empty if none is significant."""


class LocalTestSection(_Section):
    """One of the local tests behind the p-value."""

    name: Key
    kind: Literal["recording", "phase", "signature"]
    sigma: FiniteFloat
    """Standardised by the simulated recordings without a mismatch."""


class MismatchSection(_Section):
    """Whether and where the plain model fails."""

    detected: bool
    p_value: Probability
    """Of the largest of all local tests, under recordings simulated without a mismatch."""
    threshold: Probability
    nulls: Count
    """Recording sets that were simulated and refitted for the p-value."""
    tests: tuple[LocalTestSection, ...] = ()
    """The largest ones."""
    where: tuple[WhereSection, ...] = ()


class EffectSection(_Section):
    """An effect of the extended model."""

    name: Key
    probability: Probability
    parameters: dict[Key, ValueSection]
    stage: Channel
    equation: Key


class CandidateSection(_Section):
    """A set of effects that was refitted."""

    effects: tuple[Key, ...]
    gain: FiniteFloat
    """Log density of left-out training recordings, over that of the plain model."""
    chi2: NotNegative
    probability: Probability
    adequate: bool | None
    """Whether nothing is left that the detector sees; None where that was not asked."""
    rejected: str
    """Why it is not the answer; empty for those that may be."""


class PairSection(_Section):
    """Two pushes that should coincide in the frame of the part."""

    invariance: Key
    """What should make no difference: speed, place, heading, time, mirror …"""
    first: Key
    second: Key
    difference_um: NotNegative
    difference_deg: NotNegative
    sigma: NotNegative
    """Difference over what noise and unequal starts explain."""
    predicted_sigma: FiniteFloat | None
    """What the extended model makes of the same pair; None without one."""


class CovariateSection(_Section):
    """A quantity that the misfit follows."""

    component: Component
    frame: Literal["stage", "part"]
    covariate: Key
    correlation: FiniteFloat
    p_value: Probability
    """Corrected for all pairs of components and covariates (permuted recordings)."""


class ChannelSection(_Section):
    """How much of the misfit a hidden input at one stage explains."""

    channel: Channel
    share: FiniteFloat
    """Of what a hidden input at every stage explains."""
    sigma: FiniteFloat


class NotIdentifiableSection(_Section):
    """An effect that these recordings could not show, and the push that would."""

    effect: Key
    detectability: NotNegative
    """Standard deviations by which an effect of relevant size would show."""
    alike: tuple[Key, ...]
    """Effects that would look the same in these recordings."""
    push: str


class HeldOutRecording(_Section):
    """Errors of one recording that no fit has seen."""

    recording: Key
    split: Literal["held_out", "extrapolation"]
    baseline_sigma: NotNegative
    extended_sigma: NotNegative
    baseline_um: NotNegative
    extended_um: NotNegative


class HeldOutSection(_Section):
    """Errors on recordings that no fit has seen, before and after."""

    recordings: tuple[Key, ...]
    baseline_sigma: NotNegative
    """Root mean square over the noise."""
    extended_sigma: NotNegative
    noise_floor_sigma: NotNegative
    baseline_um: NotNegative
    extended_um: NotNegative
    improvement_low: FiniteFloat
    """Of the relative fall of the error, 90 % bootstrap over recordings."""
    improvement_high: FiniteFloat
    extrapolation: str = ""
    """What the extrapolation split holds out; empty if the recordings do not offer one."""
    extrapolation_recordings: tuple[Key, ...] = ()
    extrapolation_baseline_sigma: NotNegative | None = None
    extrapolation_extended_sigma: NotNegative | None = None
    black_box_sigma: NotNegative | None = None
    """What a regression with as many numbers reaches on the same recordings."""
    each: tuple[HeldOutRecording, ...] = ()


class ControlSection(_Section):
    """Spans in which both models predict the same, so that the effects should not help, nor do."""

    spans: Annotated[int, Field(ge=1)]
    within_sigma: NotNegative
    """Predictions that differ by less in every frame count as the same."""
    sigma_before: NotNegative
    """Root mean square over the noise; 1 where the plain model is right."""
    sigma_after: NotNegative


class PushSection(_Section):
    """A push to make next, in the frame of the part."""

    edge: int | None = None
    place: FiniteFloat | None = None
    """Along the edge, −1 … 1."""
    slant_deg: FiniteFloat | None = None
    speed_um_s: FiniteFloat | None = None
    travel_um: FiniteFloat | None = None
    what: str = ""


class NextExperiment(_Section):
    """What to record next, and why."""

    why: str
    push: PushSection


class NoiseSection(_Section):
    """Noise of the sensor that the tests assume."""

    position_sigma_um: NotNegative
    orientation_sigma_deg: NotNegative
    correlation: FiniteFloat
    """Of neighbouring frames."""
    source: Key


class ProvenanceSection(_Section):
    """What the diagnosis was made from."""

    recordings_sha256: Annotated[str, Field(pattern="^[0-9a-f]{64}$")]
    seed: Count
    quick: bool
    meso_robust: Key
    notes: tuple[str, ...] = ()


class DiagnosisDocument(_Section):
    """What recordings say of a model, file diagnosis.json."""

    schema_: Annotated[Literal["meso-robust/diagnosis/1"], Field(alias="schema")]
    verdict: Verdict
    why: str
    """The verdict's reason in one sentence."""
    baseline: BaselineSection
    noise: NoiseSection
    training: tuple[Key, ...]
    mismatch: MismatchSection
    effects: tuple[EffectSection, ...]
    ambiguous_with: tuple[tuple[Key, ...], ...]
    not_identifiable: tuple[Key, ...]
    not_identifiable_why: tuple[NotIdentifiableSection, ...] = ()
    candidates: tuple[CandidateSection, ...] = ()
    channels: tuple[ChannelSection, ...] = ()
    invariances: tuple[PairSection, ...] = ()
    covariates: tuple[CovariateSection, ...] = ()
    catch_all_sigma: NotNegative | None = None
    """Error on held-out recordings that a free hidden input leaves."""
    decoys: Count = 0
    """Signatures of the best set put on other recordings and in wrong frames."""
    decoy_share: Probability | None = None
    """Of them, that explain as much as the signature where it belongs; None without decoys."""
    control: ControlSection | None = None
    held_out: HeldOutSection
    next_experiment: NextExperiment
    provenance: ProvenanceSection
