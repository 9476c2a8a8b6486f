"""The report on a fitted model as one HTML page that needs nothing else."""

from __future__ import annotations

from dataclasses import dataclass
from shlex import quote

import numpy as np
from markupsafe import Markup

from meso_robust.identification.answer import noise_words
from meso_robust.identification.document import ModelDocument, ParameterSection, QualitySection
from meso_robust.identification.identify import Identification
from meso_robust.identification.models.model import Model
from meso_robust.identification.verdict import COLOURS, meaning, p_words, verdict
from meso_robust.provenance import made_with
from meso_robust.reporting.identification_figures import (
    DRAWN_MINIMA,
    profile_figure,
    recording_figure,
    support_figure,
)
from meso_robust.reporting.skeleton import Banner, code, page, versions
from meso_robust.reporting.svg import style, to_svg
from meso_robust.reporting.words import about, high_end, low_end, sentence, signed, significant
from meso_robust.wording import down_to, up_to

MOST_PICTURES = 12
"""Recordings that are drawn, those with the largest residuals first."""


@dataclass(frozen=True, slots=True)
class _Picture:
    """A drawing with its title."""

    title: str
    svg: Markup


def identification_report(document: ModelDocument, found: Identification, source: str) -> str:
    """One self-contained HTML page: the answer first, then its grounds.

    Parameters
    ----------
    document, found
        The fitted model, as written and as found.
    source
        Name of the recording set.
    """
    with style():
        pictures = {
            "profiles": _profiles(found),
            "supports": _supports(found),
            "recordings": [_recording(found, row) for row in _worst(found)],
        }
    word = verdict(document)
    banner = Banner(
        verb="identify",
        subject=source,
        about=f"model {document.model}",
        word=word,
        colour=COLOURS[word],
        meaning=Markup("<strong>{}</strong><br>{}").format(
            sentence(meaning(document)) or _headline(document, found.model), _how(document)
        ),
        figures=tuple(_figures(document)),
    )
    return page(
        "identification.html.j2",
        banner,
        _made(document, source),
        document=document,
        rows=[_row(key, one) for key, one in document.parameters.items()],
        minima=document.minima,
        pictures=pictures,
        drawn=DRAWN_MINIMA,
        significant=significant,
        p_words=p_words,
    )


def _how(document: ModelDocument) -> str:
    """What stands behind the intervals."""
    if document.confidence is None:
        return (
            "The paper's objective by Nelder and Mead's method; an interval is the last simplex, "
            "without a probability."
        )
    return (
        f"Maximum likelihood with unknown starts; {100 * document.confidence:.0f} % intervals by "
        "profile likelihood."
    )


def _made(document: ModelDocument, source: str) -> tuple[tuple[str, str], ...]:
    """What the model was made from, and how to make it again."""
    made = document.provenance
    again = (
        f"meso-robust identify {quote(source)} --model {document.model} "
        f"--objective {document.objective} --starts {made.starts} --seed {made.seed}"
    )
    return (
        ("to reproduce", code(again)),
        ("recordings (SHA-256)", code(made.recordings_sha256)),
        *((("noise of x and y", noise_words(document.sensor)),) if document.sensor else ()),
        versions({**made_with(), "meso-robust": made.meso_robust, "seed": str(made.seed)}),
        *(("note", note) for note in made.notes),
    )


def _headline(document: ModelDocument, model: Model) -> str:
    """The first two parameters with their units and intervals."""
    units = {parameter.key: parameter.unit for parameter in model.parameters}
    return ", ".join(
        f"{_symbol(key)} = {about(one.value)} [{_low(one)}, {_high(one)}] {units[key]}".strip()
        for key, one in list(document.parameters.items())[:2]
    )


def _symbol(key: str) -> str:
    return key.removesuffix("_um2").removesuffix("_um").replace("rho", "ρ").replace("mu", "µ")


def _low(one: ParameterSection) -> str:
    return "?" if one.open_low else low_end(one.low)


def _high(one: ParameterSection) -> str:
    return "?" if one.open_high else high_end(one.high)


def _figures(document: ModelDocument) -> list[tuple[str, str]]:
    """Name and value of what stands under the headline."""
    best = document.minima[0]
    shown = [
        ("recordings", str(len(document.recording))),
        ("RMS of x · y", f"{best.x_um:.3g} · {best.y_um:.3g} µm"),
        ("RMS of θ", f"{best.theta_deg:.2g}°"),
        ("local minima", str(len(document.minima))),
    ]
    if document.quality is not None:
        shown.append(("χ² on degrees of freedom", _test(document.quality)))
    return shown


def _test(quality: QualitySection) -> str:
    return f"{quality.chi2:,.0f} on {quality.freedom:,}, {p_words(quality.p_value)}"


def _row(key: str, one: ParameterSection) -> dict[str, str]:
    low = "no lower bound" if one.open_low else signed(down_to(one.low, 6))
    high = "no upper bound" if one.open_high else signed(up_to(one.high, 6))
    return {"key": key, "value": significant(one.value), "low": low, "high": high}


def _profiles(found: Identification) -> Markup | None:
    if found.fitted is None:
        return None
    return to_svg(profile_figure(found), "profiles", "Rise of χ² along every parameter")


def _supports(found: Identification) -> Markup | None:
    if not found.model.name.startswith("three_point"):
        return None
    return to_svg(support_figure(found), "supports", "Support points of the local minima")


def _worst(found: Identification) -> list[int]:
    """Recordings to draw."""
    scale = np.array([1.0, 1.0, found.prepared.length])
    left = np.nan_to_num((found.prepared.seen - found.prediction.poses[0]) * scale)
    mean = np.sum(left**2, axis=(1, 2)) / np.maximum(found.prepared.counts.sum(axis=1), 1)
    return [int(row) for row in np.argsort(-mean)[:MOST_PICTURES]]


def _recording(found: Identification, row: int) -> _Picture:
    name = found.prepared.files[row]
    svg = to_svg(recording_figure(found, row), f"rec{row}", f"Recording {name} beside the model")
    return _Picture(name, svg)
