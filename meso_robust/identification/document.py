"""``model.toml`` and ``identification.json``: a fitted model as stored in a file."""

from __future__ import annotations

from collections.abc import Mapping, Sequence, Set
from pathlib import Path
from typing import Annotated, Any, Literal, Self

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, FiniteFloat, model_validator

from meso_robust.identification.models import MODELS, Model, with_effects
from meso_robust.recordings import Rectangle
from meso_robust.simulator.catalogue import CATALOGUE
from meso_robust.simulator.effects import Effects
from meso_robust.toml_files import checked, read_toml
from meso_robust.types import Floats

SCHEMA = "meso-robust/model/1"
FILE = "model.toml"

FitWord = Literal["IDENTIFIED", "PARTLY IDENTIFIED", "NOT IDENTIFIED", "FITTED", "FIT REJECTED"]
REJECTED_BELOW = 1e-3
"""p-value of χ² below which the recordings reject a model."""

Share = Annotated[FiniteFloat, Field(gt=0, lt=1)]
MOST = 1e15
"""Of any number: far beyond all that is fitted in earnest, and squares of it are still numbers."""
Count = Annotated[int, Field(ge=0, le=10**15)]
Number = Annotated[FiniteFloat, Field(ge=-MOST, le=MOST)]
Positive = Annotated[FiniteFloat, Field(gt=0, le=MOST)]
NotNegative = Annotated[FiniteFloat, Field(ge=0, le=MOST)]
Key = Annotated[str, Field(min_length=1)]


class _Section(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True, strict=True, title=None)


class PartSection(_Section):
    """The outline that was pushed: a rectangle (length_um and width_um) or a polygon (polygon_um)."""

    length_um: Positive | None = None
    """Side along the part's x axis at theta = 0, the long one, um."""
    width_um: Positive | None = None
    """Side across it, um."""
    polygon_um: tuple[tuple[Number, Number], ...] | None = None
    """Corners [x, y] about the reference point, counter-clockwise, um."""

    @model_validator(mode="after")
    def _one_outline(self) -> Self:
        sides = (self.length_um is not None) + (self.width_um is not None)
        if (self.polygon_um is None) != (sides == 2) or sides == 1:
            raise ValueError("give length_um and width_um, or polygon_um")
        return self


class ProbeSection(_Section):
    """What pushed the part."""

    tip_radius_um: NotNegative
    """Radius of the tips as the recordings state it, um; 0: points."""


class ParameterSection(_Section):
    """A parameter in the unit that its name ends in."""

    value: Number
    """Best value."""
    low: Number
    """Lower end of the interval; of the range where the recordings give no bound."""
    high: Number
    """Upper end, likewise."""
    open_low: bool
    """Whether the recordings give no lower bound."""
    open_high: bool
    """Whether the recordings give no upper bound."""

    @model_validator(mode="after")
    def _value_between(self) -> Self:
        if not self.low <= self.value <= self.high:
            raise ValueError(f"low ≤ value ≤ high must hold: {self.low}, {self.value}, {self.high}")
        return self


class NotIdentifiableSection(_Section):
    """Something that the recordings do not determine."""

    name: Key
    """What is not determined: a parameter or a combination of them."""
    why: Key
    """The reason, in words."""


class MinimumSection(_Section):
    """A local minimum of the search."""

    objective_um: NotNegative | None = None
    """F of eq. (4); absent where a push jams."""
    cost: NotNegative
    """What was minimised: χ² for "likelihood", F in um for "printed"."""
    x_um: NotNegative
    """Root mean square of the residuals in x over all recordings, um."""
    y_um: NotNegative
    """The same in y, um."""
    theta_deg: NotNegative
    """Root mean squares over all recordings."""
    found: Count
    """Number of random starts that led there."""
    parameters: dict[Key, Number]
    """The parameters there, each in the unit that its name ends in."""


class QualitySection(_Section):
    """How well the best fit of the likelihood explains the recordings."""

    chi2: NotNegative
    """Squared residuals, each relative to the noise, summed."""
    freedom: Annotated[int, Field(ge=-(10**15), le=10**15)]
    """Degrees of freedom: residuals minus fitted values."""
    p_value: Annotated[FiniteFloat, Field(ge=0, le=1)]
    """Probability of such a χ² if model and noise are right; noise that still frames show is known as
    well as they show it."""
    correlation: Number
    """Correlation of the residuals of neighbouring frames."""
    inflation: Annotated[FiniteFloat, Field(ge=1, le=MOST)]
    """Factor on the variance for the intervals; 1 if residuals look like the noise."""
    numerical: NotNegative
    """Standard deviations that a parameter moved when predictions were corrected for the steps."""

    @property
    def rejected(self) -> bool:
        """Whether the recordings reject the model."""
        return self.p_value < REJECTED_BELOW


class RecordingSection(_Section):
    """Root mean squares of the residuals of one recording."""

    file: Key
    """CSV file of the recording."""
    frames: Count
    """Frames that were compared."""
    x_um: NotNegative
    """Of x, um."""
    y_um: NotNegative
    """Of y, um."""
    theta_deg: NotNegative
    """Of the orientation, deg."""
    outcome: Key
    """How the simulated push ended: completed, jam …"""


class SensorSection(_Section):
    """Noise that was assumed."""

    position_sigma_um: Positive
    """Standard deviation of x and y, um: repeatability and systematic error together."""
    orientation_sigma_deg: Positive
    """Standard deviation of theta, deg."""
    position_source: Literal["stated", "estimated", "fitted"]
    """Where that of x and y is from: the set, still frames, or the fit."""
    orientation_source: Literal["stated", "estimated", "fitted"]
    """Where that of theta is from, likewise."""
    position_repeatability_um: Positive | None = None
    """Scatter of x and y from frame to frame, from still frames, um; the rest of the standard deviation is
    systematic error. Absent if too few frames are still."""
    orientation_repeatability_deg: Positive | None = None
    """The same of theta, deg."""


class ProvenanceSection(_Section):
    """What the model was made from."""

    recordings_sha256: Annotated[str, Field(pattern="^[0-9a-f]{64}$")]
    """SHA-256 of the recording set's values, independent of layout."""
    seed: Annotated[int, Field(ge=0, le=10**80)]
    """Seed of the random starts."""
    starts: Annotated[int, Field(ge=1, le=10**15)]
    """Random starts of the search."""
    meso_robust: Key
    """Version of the package."""
    notes: tuple[str, ...]
    """What was left out of the recordings, interpolated or shifted."""


class ModelDocument(_Section):
    """A fitted model, file model.toml."""

    schema_: Annotated[Literal["meso-robust/model/1"], Field(alias="schema")]
    """Name and version of the format."""
    model: Key
    """One of `MODELS`, or such a base with effects of the catalogue: ``base+effect+effect``."""
    verdict: FitWord | None = None
    """FIT REJECTED: the recordings reject the model (χ²); IDENTIFIED, PARTLY or NOT IDENTIFIED: all, some or no
    parameters have bounds; FITTED: all have, and no known noise tells how good the fit is. Absent from
    models of `diagnose`."""
    diagnosis: Literal["consistent", "named", "partial", "ambiguous", "unknown"] | None = None
    """Verdict of the diagnosis that the model is from; None of an identification."""
    objective: Literal["printed", "likelihood"]
    """What was minimised: the paper's eq. (4), or the negative log likelihood."""
    interval: Literal[
        "profile likelihood", "curvature", "curvature and jackknife", "jackknife", "last simplex"
    ]
    """What the intervals are: of a profile or the curvature of the likelihood, with a probability, or the
    latter and, as far as recordings disagree, what leaving out one of them at a time does where that is
    wider; of a model with a residual law by leaving out a fold of recordings at a time; or the width of a
    search, without one."""
    confidence: Share | None = None
    """Probability of each interval, by itself; absent where intervals have none."""
    part: PartSection
    """The outline that was pushed."""
    probe: ProbeSection | None = None
    """What pushed it."""
    parameters: dict[Key, ParameterSection]
    """The fitted parameters by name."""
    held: dict[Key, Number] = {}
    """Parameters that no motion shows, as they were simulated (any other value does as well), and
    parameters of effects that were not fitted."""
    not_identifiable: tuple[NotIdentifiableSection, ...]
    """What the recordings do not determine."""
    quality: QualitySection | None = None
    """How well the fit explains the recordings; of the likelihood only."""
    sensor: SensorSection | None = None
    """The noise that was assumed."""
    minima: Annotated[tuple[MinimumSection, ...], Field(min_length=1)]
    """All minima that were found, the best first."""
    recording: tuple[RecordingSection, ...]
    """Residuals of each recording."""
    provenance: ProvenanceSection
    """What the model was made from."""

    @model_validator(mode="after")
    def _keys_of_model(self) -> Self:
        base, *effects = self.model.split("+")
        if base not in MODELS:
            return self
        given = {*self.parameters, *self.held}
        _check_effects(effects, given)
        shown = {key: one.value for key, one in self.parameters.items()} | self.held
        Effects(_by_effect(effects, shown))  # refuses what no effect can be
        known = set(MODELS[base](_outline(self.part)).keys)
        plain = {key for key in given if "." not in key}
        if known != plain:
            raise ValueError(
                f"parameters: {', '.join(sorted(plain))}; must be those of model {base}: "
                f"{', '.join(sorted(known))}"
            )
        return self

    @property
    def values(self) -> Floats:
        """(n,) values in SI, in the order of the model's parameters.

        Raises
        ------
        KeyError
            If the base of the model is not one of `MODELS`.
        """
        model = self.made()
        shown = {key: section.value for key, section in self.parameters.items()} | self.held
        return np.array([shown[p.key] * p.to_si for p in model.parameters])

    def made(self) -> Model:
        """The model for this part; ``base+effect+effect`` is the base extended by effects.

        Raises
        ------
        KeyError
            If the base is not one of `MODELS`.
        """
        base, *effects = self.model.split("+")
        model = MODELS[base](_outline(self.part))
        if not effects:
            return model
        return with_effects(
            model,
            _by_effect(effects, dict.fromkeys(self.parameters, 1.0)),
            _by_effect(effects, self.held),
        )


def _by_effect(effects: Sequence[str], values: Mapping[str, float]) -> dict[str, dict[str, float]]:
    """``{effect: {parameter: value}}`` of the keys ``effect.parameter``, in the order of effects."""
    found: dict[str, dict[str, float]] = {}
    for effect in effects:
        of = {key: value for key, value in values.items() if key.startswith(f"{effect}.")}
        if of:
            found[effect] = {key.partition(".")[2]: value for key, value in of.items()}
    return found


def _check_effects(effects: Sequence[str], keys: Set[str]) -> None:
    """Refuse a name with effects that the keys ``effect.parameter`` do not fit."""
    for effect in effects:
        if effect not in CATALOGUE:
            raise ValueError(
                f"model: effect {effect!r} is not in the catalogue; use {', '.join(CATALOGUE)}"
            )
    owners = {key.partition(".")[0] for key in keys if "." in key}
    if len(set(effects)) < len(effects) or owners != set(effects):
        raise ValueError(
            f"model: its name has the effects {', '.join(effects) or '(none)'}, its parameters those "
            f"of {', '.join(sorted(owners)) or '(none)'}; must be the same, each once"
        )
    known = {f"{effect}.{one.key}" for effect in effects for one in CATALOGUE[effect].parameters}
    extra = sorted(key for key in keys if "." in key and key not in known)
    if extra:
        raise ValueError(
            f"parameters: {', '.join(extra)}; must be one of {', '.join(sorted(known))}"
        )


def read_model(path: Path) -> ModelDocument:
    """Read and check a ``model.toml``.

    Parameters
    ----------
    path
        Of the file.

    Returns
    -------
    ModelDocument
        Checked: its model can be made and its values are within sane bounds.

    Raises
    ------
    InputError
        The file cannot be read, is not TOML, or a value breaks a rule; the message names file, key,
        value and rule.
    """
    return parse_model(read_toml(path, "give a model.toml"), str(path))


def parse_model(values: Mapping[str, Any], source: str) -> ModelDocument:
    """Check the values of a ``model.toml``.

    Parameters
    ----------
    values
        As TOML has them.
    source
        Names them in messages.

    Returns
    -------
    ModelDocument
        In the units of the file.

    Raises
    ------
    InputError
        A value breaks a rule.
    """
    keys = "`meso-robust schema model`"
    return checked(ModelDocument, values, source, whole="model", keys=keys)


def _outline(part: PartSection) -> Floats:
    if part.polygon_um is not None:
        return 1e-6 * np.array(part.polygon_um)
    return Rectangle(length=1e-6 * (part.length_um or 0), width=1e-6 * (part.width_um or 0)).outline
