"""What was found, as a document and in words."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from meso_robust.identification.document import (
    SCHEMA,
    MinimumSection,
    ModelDocument,
    NotIdentifiableSection,
    ParameterSection,
    PartSection,
    ProbeSection,
    ProvenanceSection,
    QualitySection,
    RecordingSection,
    SensorSection,
)
from meso_robust.identification.identify import Identification
from meso_robust.identification.models import Model
from meso_robust.identification.profiles import Profile
from meso_robust.identification.verdict import meaning, verdict
from meso_robust.recordings import RecordingSet, Rectangle
from meso_robust.recordings.fingerprint import set_hash
from meso_robust.recordings.noise import (
    Noise,
    estimated_noise,
    in_words,
    position_repeatability,
)
from meso_robust.simulator import Outcome
from meso_robust.wording import counted, down_to, up_to


def document(
    recordings: RecordingSet, found: Identification, version: str, remarks: Sequence[str] = ()
) -> ModelDocument:
    """The document of what was found.

    Parameters
    ----------
    recordings, found
        What was fitted, and how.
    version
        Of this package.
    remarks
        What else to keep in mind about the recordings; joins the notes.

    Returns
    -------
    ModelDocument
        The content of ``model.toml``.
    """
    made = ModelDocument.model_validate(sections(recordings, found, version, remarks))
    return made.model_copy(update={"verdict": verdict(made)})


def sections(
    recordings: RecordingSet, found: Identification, version: str, remarks: Sequence[str] = ()
) -> dict[str, Any]:
    """The same without a verdict, by the keys of ``model.toml``.

    A mapping, because `schema` is the name of a method of pydantic's models; and because a diagnosis
    puts the sections of its extended model in the place of the plain one's.

    Parameters
    ----------
    recordings, found, version, remarks
        As in `document`.

    Returns
    -------
    dict
        Values and sections of a `ModelDocument`, to be validated.
    """
    model, likelihood = found.model, found.fitted is not None
    shown = model.shown(found.best)
    return {
        "schema": SCHEMA,
        "model": model.name,
        "objective": found.objective,
        "interval": "profile likelihood" if likelihood else "last simplex",
        "confidence": found.confidence if likelihood else None,
        "part": _part(recordings),
        "probe": ProbeSection(tip_radius_um=_rounded(1e6 * recordings.tip_radius)),
        "parameters": {one.key: _parameter(model, one) for one in found.profiles},
        "held": {model.keys[k]: shown[k] for k in np.flatnonzero(~model.fitted)},
        "not_identifiable": tuple(
            NotIdentifiableSection(name=one.name, why=one.why) for one in found.not_identifiable
        ),
        "quality": _quality(found),
        "sensor": _sensor(found, estimated_noise(recordings)),
        "minima": tuple(_minimum(found, k) for k in range(len(found.minima))),
        "recording": _recordings(found),
        "provenance": ProvenanceSection(
            recordings_sha256=set_hash(recordings),
            seed=found.seed,
            starts=found.starts,
            meso_robust=version,
            notes=(*(f"{note.file}: {note.what}" for note in found.prepared.notes), *remarks),
        ),
    }


def summary(document: ModelDocument) -> str:
    """The answer in a few lines: parameters with their intervals, misfit, what is not known.

    Parameters
    ----------
    document
        What was found.

    Returns
    -------
    str
        Lines; interval ends are rounded outward to six digits.
    """
    how: str = document.interval
    if document.confidence is not None:
        how = f"{document.confidence:.0%} intervals by {how}"
    fitted = f"{document.model} fitted to {counted(len(document.recording), 'recording')} ({how})"
    lines = [f"{verdict(document)}: {fitted}"]
    if said := meaning(document):
        lines.append(f"  {said}")
    for key, one in document.parameters.items():
        low = "no lower bound" if one.open_low else down_to(one.low, 6)
        high = "no upper bound" if one.open_high else up_to(one.high, 6)
        lines.append(f"  {key} = {one.value:.6g}   [{low}, {high}]")
    if document.quality is not None and document.quality.inflation > 1.0:
        lines.append(
            "  residuals are larger than the noise, or not white: intervals are "
            f"{document.quality.inflation**0.5:.3g} times as wide as the noise alone would make them"
        )
    if document.sensor is not None:
        lines.append(f"  noise of x and y: {noise_words(document.sensor)}")
    if len(document.minima) > 1:
        lines.append(f"  {len(document.minima)} local minima were found; model.toml lists them")
    lines += [f"  not identifiable: {one.name}: {one.why}" for one in document.not_identifiable]
    return "\n".join(lines)


def noise_words(sensor: SensorSection) -> str:
    """The noise of x and y that was assumed, told apart, and where it is from.

    Parameters
    ----------
    sensor
        Section of the document; µm.

    Returns
    -------
    str
        A clause without a full stop.
    """
    words = in_words(sensor.position_sigma_um, sensor.position_repeatability_um, 1.0, "µm")
    return f"{words} ({sensor.position_source})"


def _rounded(value: float) -> float:
    """Twelve digits: 1616.0 um, not 1616.0000000000002."""
    return float(f"{value:.12g}")


def _part(recordings: RecordingSet) -> PartSection:
    part = recordings.part
    if isinstance(part, Rectangle):
        return PartSection(
            length_um=_rounded(1e6 * part.length), width_um=_rounded(1e6 * part.width)
        )
    corners = tuple((_rounded(1e6 * x), _rounded(1e6 * y)) for x, y in part.outline.tolist())
    return PartSection(polygon_um=corners)


def _parameter(model: Model, one: Profile) -> ParameterSection:
    parameter = model.parameters[model.keys.index(one.key)]
    return ParameterSection(
        value=parameter.shown(one.value),
        low=parameter.shown(one.low),
        high=parameter.shown(one.high),
        open_low=one.open_low,
        open_high=one.open_high,
    )


def _quality(found: Identification) -> QualitySection | None:
    if found.quality is None:
        return None
    names = ("chi2", "freedom", "p_value", "correlation", "inflation", "numerical")
    return QualitySection(**{name: getattr(found.quality, name) for name in names})


def _sensor(found: Identification, noise: Noise) -> SensorSection | None:
    if found.settings is None:
        return None
    known = found.prepared.sigmas
    position, orientation = known.position_source, known.orientation_source
    return SensorSection(
        position_sigma_um=_rounded(1e6 * found.settings.position),
        orientation_sigma_deg=_rounded(float(np.degrees(found.settings.orientation))),
        position_source="fitted" if position == "unknown" else position,
        orientation_source="fitted" if orientation == "unknown" else orientation,
        position_repeatability_um=_scaled(position_repeatability(noise), 1e6),
        orientation_repeatability_deg=_scaled(noise.theta.sigma, 180.0 / np.pi),
    )


def _scaled(value: float | None, factor: float) -> float | None:
    return None if value is None else _rounded(factor * value)


def _minimum(found: Identification, k: int) -> MinimumSection:
    one = found.minima[k]
    shown = found.model.shown(one.values)
    return MinimumSection(
        objective_um=float(1e6 * one.objective) if np.isfinite(one.objective) else None,
        cost=one.cost if found.fitted is not None else 1e6 * one.cost,
        x_um=float(1e6 * one.axes[0]),
        y_um=float(1e6 * one.axes[1]),
        theta_deg=float(np.degrees(one.axes[2])),
        found=one.found,
        parameters=dict(zip(found.model.keys, shown, strict=True)),
    )


def _recordings(found: Identification) -> tuple[RecordingSection, ...]:
    counts, poses = found.prepared.counts, found.prediction.poses[0]
    squares = np.nan_to_num((found.prepared.seen - poses) ** 2).sum(axis=1)
    rms = np.sqrt(squares / np.maximum(counts, 1))
    return tuple(
        RecordingSection(
            file=file,
            frames=int(counts[r].max()),
            x_um=float(1e6 * rms[r, 0]),
            y_um=float(1e6 * rms[r, 1]),
            theta_deg=float(np.degrees(rms[r, 2])),
            outcome=Outcome(int(found.prediction.outcomes[0, r])).word,
        )
        for r, file in enumerate(found.prepared.files)
    )
