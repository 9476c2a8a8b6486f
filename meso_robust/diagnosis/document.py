"""``diagnosis.json``: a diagnosis as stored in a file."""

from __future__ import annotations

from typing import Annotated, Literal, TypeAlias

from pydantic import BaseModel, ConfigDict, Field, FiniteFloat

from meso_robust.diagnosis.rejection import Ground

SCHEMA = "meso-robust/diagnosis/2"
FILE = "diagnosis.json"

Channel: TypeAlias = Literal[
    "support", "contact", "actuation", "observation", "environment", "geometry"
]
"""Stage of the chain from command to recording."""
PhaseName: TypeAlias = Literal["approach", "one_point", "two_point", "retract", "rest"]
Component: TypeAlias = Literal["x", "y", "theta"]
Verdict: TypeAlias = Literal["consistent", "named", "partial", "ambiguous", "unknown"]
SWAY_SHARE = 0.5
"""Of the square of what is left, from which on a sway is what is wrong."""

Probability = Annotated[FiniteFloat, Field(ge=0, le=1)]
Count = Annotated[int, Field(ge=0)]
NotNegative = Annotated[FiniteFloat, Field(ge=0)]
Key = Annotated[str, Field(min_length=1)]


class _Section(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True, strict=True, title=None)


class ValueSection(_Section):
    """A number with its interval."""

    value: FiniteFloat
    """Best value."""
    low: FiniteFloat
    """Lower end of the interval."""
    high: FiniteFloat
    """Upper end of the interval."""
    unit: str = ""
    """Unit of the three; empty if there is none."""


class BaselineSection(_Section):
    """The plain model, fitted to the training recordings."""

    model: Key
    """The plain model, as `--model` names it: viscous, three_point …"""
    parameters: dict[Key, ValueSection]
    """Its parameters by name."""


class WhereSection(_Section):
    """A span of a recording in which the plain model fails."""

    recording: Key
    """CSV file of the recording."""
    start_s: FiniteFloat
    """Start of the span, s, on the clock of the recording."""
    end_s: FiniteFloat
    """End of the span, s."""
    phase: PhaseName
    """What probes and part do in the span."""
    channel: Channel
    """Stage whose hidden input explains the span best."""
    component: Component
    """Component of the motion that fails most."""
    sigma: NotNegative
    """Size of the misfit, in standard deviations of its distribution without a mismatch."""
    grows_with: str
    """Covariate that the misfit of this component follows; empty if none is significant."""


class LocalTestSection(_Section):
    """One of the local tests behind the p-value."""

    name: Key
    """What was tested: a recording, a phase of it, or the signature of an effect."""
    kind: Literal["recording", "phase", "signature"]
    """Which of the three."""
    sigma: FiniteFloat
    """Standardised by the simulated recordings without a mismatch."""


class MismatchSection(_Section):
    """Whether and where the plain model fails."""

    detected: bool
    """Whether the p-value is at most the threshold, or with few `nulls` the least that they allow."""
    p_value: Probability
    """p-value of the largest local test, from recordings simulated without a mismatch."""
    threshold: Probability
    """p-value from which on a mismatch counts as detected."""
    nulls: Count
    """Recording sets that were simulated and refitted for the p-value."""
    tests: tuple[LocalTestSection, ...] = ()
    """The largest ones."""
    where: tuple[WhereSection, ...] = ()
    """Spans in which the plain model fails."""


class EffectSection(_Section):
    """An effect of the extended model."""

    name: Key
    """Name in the catalogue."""
    probability: Probability
    """That the effect is part of the answer."""
    parameters: dict[Key, ValueSection]
    """Its size, by parameter."""
    stage: Channel
    """Stage of the experiment's chain that the effect belongs to."""
    equation: Key
    """The effect's equation in the field's symbols."""
    share: FiniteFloat | None = None
    """Share of the explainable error that it explains, out of fold; null in the first version."""
    form: str = ""
    """Form of its law: what was held, such as the edge of a friction; empty if it has one form only."""
    each_push: bool = False
    """Whether every push has its own, which no recording tells of another one: its size is the standard deviation."""


class ExplainedSection(_Section):
    """Explainable error that the effects explain in recordings which a fit has not seen."""

    share: FiniteFloat
    """Share of the explainable error: the plain model's out of fold, less what free hidden inputs leave;
    means of squares, in roll-outs from the pose seen at rest."""
    low: FiniteFloat
    """Lower end of its interval, 90 % bootstrap over recordings."""
    high: FiniteFloat
    """Upper end, likewise."""
    folds: Count
    """Parts that the recordings were cut into, each predicted by a fit of the others."""


class RemainderSection(_Section):
    """What is left unexplained in roll-outs, beyond what free hidden inputs leave."""

    um: NotNegative
    """Root mean square of the place, um."""
    deg: NotNegative
    """Root mean square of the turn, deg."""
    sigma: NotNegative
    """Root mean square of all over the noise."""
    stage: Channel | None
    """Stage whose hidden input explains most of what no effect does; null if nothing is looked for."""
    component: Component | None
    """Component of the motion that most of it is in; null likewise."""
    phase: PhaseName | None
    """What probes and part do where most of it is; null likewise."""
    grows_with: str
    """Covariate that it follows; empty if none is significant."""
    spread_between_pushes: NotNegative
    """Standard deviation over mean of what is left of one recording: small if all are wrong alike."""


class BudgetSection(_Section):
    """Part of the explainable error; the shares of all parts add up to one."""

    effect: str
    """Effect that explains it; empty for what none does."""
    stage: Channel | None
    """Stage of the effect, or else the one whose hidden input helps most."""
    phase: PhaseName
    """What probes and part do."""
    component: Component
    """Component of the motion."""
    share: FiniteFloat
    """Of the explainable error; below zero where an effect makes it worse."""


class ResidualBaseSection(ValueSection):
    """A base of the residual law, with its coefficient."""

    meaning: Key
    """What it stands for, in words."""
    chosen: Probability
    """Share of the random halves of the recordings that chose it."""


class ResidualSection(_Section):
    """A regression of what no effect explains on a few bases; it predicts, and names nothing."""

    added_to: tuple[Key, ...]
    """Effects of the model that it was added to; empty: the plain model."""
    bases: dict[Key, ResidualBaseSection]
    """Its coefficients, by the names of the bases; the parameters of `residual` in model.toml."""
    before_um: NotNegative
    """Error of place without it: root mean square out of fold, um."""
    after_um: NotNegative
    """The same with it, where the bases were chosen without the recording too."""
    before_deg: NotNegative
    """Error of the turn without it, deg."""
    after_deg: NotNegative
    """The same with it."""
    fall: FiniteFloat
    """Share of the mean square error beyond the noise that it takes out of fold."""
    fall_low: FiniteFloat
    """Lower end of its interval, 90 % bootstrap over recordings."""
    fall_high: FiniteFloat
    """Upper end, likewise."""
    folds: Count
    """Parts that the recordings were cut into, each predicted by a choice and a fit without it."""
    offered: bool
    """Whether it helps for sure, and is in model.toml."""


class CandidateSection(_Section):
    """A set of effects that was refitted."""

    effects: tuple[Key, ...]
    """Names in the catalogue; empty: the plain model."""
    gain: FiniteFloat
    """Log density of left-out training recordings, over that of the plain model."""
    chi2: NotNegative
    """Squared residuals over the training recordings, each relative to the noise, summed."""
    probability: Probability
    """Probability of this set among all that were refitted."""
    adequate: bool | None
    """Whether nothing is left that the detector sees; None where that was not asked."""
    rejected: str
    """Why it was rejected; empty if it was not."""
    ground: Ground | None = None
    """The same as an id; null for one that is."""
    instead: tuple[str, ...] = ()
    """Of `same-motion` the set that makes the same motion."""


class PairSection(_Section):
    """Two pushes that should coincide in the frame of the part."""

    invariance: Key
    """What should make no difference: speed, place, heading, time, mirror …"""
    first: Key
    """One recording."""
    second: Key
    """The other."""
    difference_um: NotNegative
    """Distance of the two displacements, um."""
    difference_deg: NotNegative
    """Difference of the two turns, deg."""
    sigma: NotNegative
    """Difference over what noise and unequal starts explain."""
    predicted_sigma: FiniteFloat | None
    """What the extended model makes of the same pair; None without one."""


class CovariateSection(_Section):
    """A quantity that the misfit follows."""

    component: Component
    """Component of the misfit."""
    frame: Literal["stage", "part"]
    """Frame of the component."""
    covariate: Key
    """The quantity; `constant` if the misfit has a mean of its own."""
    correlation: FiniteFloat
    """-1 to 1, weighted with the accuracy; of a constant: mean over root mean square."""
    p_value: Probability
    """Corrected for all pairs of components and covariates (permuted recordings)."""


class ChannelSection(_Section):
    """How much of the misfit a hidden input at one stage explains."""

    channel: Channel
    """The stage."""
    share: FiniteFloat
    """Share of what hidden inputs at all stages together explain."""
    sigma: FiniteFloat
    """Size of what it explains, in standard deviations."""


class NotIdentifiableSection(_Section):
    """An effect that these recordings could not show, and the push that would."""

    effect: Key
    """Name in the catalogue."""
    detectability: NotNegative
    """Standard deviations by which an effect of relevant size would show."""
    alike: tuple[Key, ...]
    """Effects that would look the same in these recordings."""
    push: str
    """The push that would show it, in words; empty if none would."""


class HeldOutRecording(_Section):
    """Errors of one recording that no fit has seen."""

    recording: Key
    """CSV file of the recording."""
    split: Literal["held_out", "extrapolation"]
    """Which split held it out."""
    baseline_sigma: NotNegative
    """Error of the plain model: root mean square over the noise."""
    extended_sigma: NotNegative
    """The same of the extended model."""
    baseline_um: NotNegative
    """Error of the plain model: root mean square, um."""
    extended_um: NotNegative
    """The same of the extended model, um."""


class HeldOutSection(_Section):
    """Errors of recordings, each predicted from the pose seen at rest by a fit to others, before and after."""

    recordings: tuple[Key, ...]
    """CSV files, each left out of a fit in its turn."""
    baseline_sigma: NotNegative
    """Root mean square over the noise."""
    extended_sigma: NotNegative
    """The same of the extended model."""
    noise_floor_sigma: NotNegative
    """What is left where there is only noise: repeatability and systematic error together."""
    repeatability_sigma: NotNegative | None = None
    """What the repeatability leaves, the scatter from frame to frame. A model leaves less than the noise
    where it takes up systematic error, which stays from frame to frame, but not less than this. Null if
    too few frames are still."""
    baseline_um: NotNegative
    """Error of the plain model: root mean square, um."""
    extended_um: NotNegative
    """The same of the extended model, um."""
    improvement_low: FiniteFloat
    """Lower end of the relative fall in error, 90 % bootstrap over recordings."""
    improvement_high: FiniteFloat
    """Upper end, likewise."""
    extrapolation: str = ""
    """What the extrapolation split holds out; empty if the recordings do not offer one."""
    extrapolation_recordings: tuple[Key, ...] = ()
    """CSV files of the extrapolation split."""
    extrapolation_baseline_sigma: NotNegative | None = None
    """Error of the plain model on them, over the noise."""
    extrapolation_extended_sigma: NotNegative | None = None
    """The same of the extended model."""
    black_box_sigma: NotNegative | None = None
    """What a regression with as many numbers reaches on recordings that no set of effects was chosen by."""
    each: tuple[HeldOutRecording, ...] = ()
    """The errors recording by recording."""


class ControlSection(_Section):
    """Spans in which both models predict the same, so that the effects should not help, nor do."""

    spans: Annotated[int, Field(ge=1)]
    """Number of the spans."""
    within_sigma: NotNegative
    """Predictions that differ by less than this in every frame count as the same."""
    sigma_before: NotNegative
    """Root mean square over the noise; 1 where the plain model is right."""
    sigma_after: NotNegative
    """The same of the extended model."""


class PushSection(_Section):
    """A push to make next, in the frame of the part."""

    edge: int | None = None
    """The edge after this corner of the outline; null if it does not matter."""
    place: FiniteFloat | None = None
    """Along the edge, −1 … 1."""
    slant_deg: FiniteFloat | None = None
    """Turn of the push from the edge's inward normal, counter-clockwise, deg."""
    speed_um_s: FiniteFloat | None = None
    """Speed of the probe, um/s."""
    travel_um: FiniteFloat | None = None
    """Travel of the probe, um."""
    what: str = ""
    """The push in words."""


class NextExperiment(_Section):
    """What to record next, and why."""

    why: str
    """What the push would tell."""
    push: PushSection
    """The push."""


class NoiseSection(_Section):
    """Noise of the sensor that the tests assume."""

    position_sigma_um: NotNegative
    """Standard deviation of x and y, um."""
    orientation_sigma_deg: NotNegative
    """Standard deviation of theta, deg."""
    correlation: FiniteFloat
    """Correlation of the noise in neighbouring frames."""
    source: Key
    """Where they are from, in words."""
    sway_um: NotNegative | None = None
    """Root mean square of x and y, um, by which the part is seen to move to and fro at rest, which is not in
    the deviations above; null where frames at rest scatter as noise does."""
    sway_hz: NotNegative | None = None
    """How often it does so, Hz; null likewise."""


class ProvenanceSection(_Section):
    """What the diagnosis was made from."""

    recordings_sha256: Annotated[str, Field(pattern="^[0-9a-f]{64}$")]
    """SHA-256 of the recording set's values, independent of layout."""
    seed: Count
    """Seed of all random numbers."""
    quick: bool
    """Whether less was tried, because of `--quick`."""
    meso_robust: Key
    """Version of the package."""
    notes: tuple[str, ...] = ()
    """What was left out of the recordings, interpolated or shifted."""


class DiagnosisDocument(_Section):
    """What recordings say of a model, file diagnosis.json."""

    schema_: Annotated[
        Literal["meso-robust/diagnosis/2", "meso-robust/diagnosis/1"], Field(alias="schema")
    ]
    """Name and version of the format; the first version has no `explained`, `remainder`, `budget`,
    `relevant_um` and shares of effects."""
    verdict: Verdict
    """Whether the plain model holds, and if not, whether an explanation was found."""
    why: str
    """The verdict's reason in one sentence."""
    baseline: BaselineSection
    """The plain model."""
    noise: NoiseSection
    """The sensor's noise."""
    training: tuple[Key, ...]
    """CSV files that models were fitted to."""
    mismatch: MismatchSection
    """Whether and where the plain model fails."""
    explained: ExplainedSection | None = None
    """What the effects explain together; null where nothing is to be explained, or nothing helps."""
    remainder: RemainderSection | None = None
    """What they leave, or the plain model where there are none; null in the first version."""
    residual: ResidualSection | None = None
    """A law of what has no name, where the verdict is partial or unknown; null where none was found."""
    budget: tuple[BudgetSection, ...] = ()
    """The explainable error, part by part."""
    relevant_um: NotNegative | None = None
    """Error of prediction from which on a mismatch matters, um; null in the first version."""
    explainable_um: NotNegative | None = None
    """Explainable error of the plain model: root mean square, um, of place or of the turn of the farthest
    corner, whichever is larger; null in the first version."""
    effects: tuple[EffectSection, ...]
    """The best answer; empty if the recordings are consistent with the plain model."""
    ambiguous_with: tuple[tuple[Key, ...], ...]
    """Sets of effects that explain the recordings as well."""
    not_identifiable: tuple[Key, ...]
    """Effects that these recordings could not have shown."""
    not_identifiable_why: tuple[NotIdentifiableSection, ...] = ()
    """For each of them, how far from showing it is."""
    candidates: tuple[CandidateSection, ...] = ()
    """Sets of effects that were refitted, the best first."""
    channels: tuple[ChannelSection, ...] = ()
    """What hidden inputs explain, stage by stage."""
    invariances: tuple[PairSection, ...] = ()
    """Pushes that should coincide."""
    covariates: tuple[CovariateSection, ...] = ()
    """What the misfit grows with."""
    catch_all_sigma: NotNegative | None = None
    """Error that a free hidden input leaves of recordings that no set of effects was chosen by."""
    decoys: Count = 0
    """Signatures of the best set put on other recordings and in wrong frames."""
    decoy_share: Probability | None = None
    """Share of the decoys that explain as much as the signature where it belongs; None without decoys."""
    control: ControlSection | None = None
    """Spans that must not improve; null if there are none."""
    held_out: HeldOutSection
    """Errors before and after of every recording, each predicted by a fit to others."""
    next_experiment: NextExperiment
    """What to record next."""
    provenance: ProvenanceSection
    """What the diagnosis was made from."""

    @property
    def of_each_push(self) -> bool:
        """Whether the answer is an effect that every push has its own of."""
        return any(effect.each_push for effect in self.effects)

    @property
    def extends(self) -> bool:
        """Whether there is an extended model, which predicts other recordings."""
        return bool(self.effects) and not self.of_each_push
