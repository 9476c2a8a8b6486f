"""The report on a fitted model as one HTML page that needs nothing else."""

from __future__ import annotations

from shlex import quote

import numpy as np
from markupsafe import Markup

from meso_robust.identification.answer import noise_words
from meso_robust.identification.document import ModelDocument, ParameterSection, QualitySection
from meso_robust.identification.identify import Identification
from meso_robust.identification.models.model import Model
from meso_robust.identification.verdict import COLOURS, meaning, p_words, verdict
from meso_robust.provenance import made_with
from meso_robust.reporting import pages
from meso_robust.reporting.identification_figures import (
    DRAWN_MINIMA,
    profile_figure,
    recording_figure,
    support_figure,
)
from meso_robust.reporting.svg import style, to_svg
from meso_robust.reporting.words import about, high_end, low_end, sentence, signed, significant
from meso_robust.wording import down_to, up_to

MOST_PICTURES = 12
"""Recordings that are drawn, those with the largest residuals first."""


def identification_report(document: ModelDocument, found: Identification, source: str) -> str:
    """One self-contained HTML page: the answer first, then its grounds.

    Parameters
    ----------
    document, found
        The fitted model, as written and as found.
    source
        Name of the recording set.

    Returns
    -------
    str
        The page; it asks for nothing from outside.
    """
    origin = document.provenance
    with style():  # for all that the sections draw
        sections = (
            _parameters(document, found),
            _not_identifiable(document),
            _minima(document, found),
            _recordings(document, found),
        )
    return pages.page(
        pages.Report(
            banner=_banner(document, found.model, source),
            sections=sections,
            made=pages.made(
                f"meso-robust identify {quote(source)} --model {document.model} "
                f"--objective {document.objective} --starts {origin.starts} --seed {origin.seed}",
                ("recordings (SHA-256)", pages.code(origin.recordings_sha256)),
                *((("noise of x and y", noise_words(document.sensor)),) if document.sensor else ()),
                using={**made_with(), "meso-robust": origin.meso_robust, "seed": str(origin.seed)},
                notes=origin.notes,
            ),
        )
    )


def _banner(document: ModelDocument, model: Model, source: str) -> pages.Banner:
    word, best = verdict(document), document.minima[0]
    figures = [
        ("recordings", str(len(document.recording))),
        ("RMS of x · y", f"{best.x_um:.3g} · {best.y_um:.3g} µm"),
        ("RMS of θ", f"{best.theta_deg:.2g}°"),
        ("local minima", str(len(document.minima))),
    ]
    if (quality := document.quality) is not None:
        test = f"{quality.chi2:,.0f} on {quality.freedom:,}, {p_words(quality.p_value)}"
        figures.append(("χ² on degrees of freedom", test))
    return pages.Banner(
        verb="identify",
        subject=source,
        about=f"model {document.model}",
        word=word,
        colour=COLOURS[word],
        meaning=Markup("<strong>{}</strong><br>{}").format(
            sentence(meaning(document)) or _headline(document, model), _how(document)
        ),
        figures=figures,
    )


def _how(document: ModelDocument) -> str:
    """What the intervals are based on."""
    if document.confidence is None:
        return (
            "The paper's objective by Nelder and Mead's method; an interval is the last simplex, "
            "without a probability."
        )
    return (
        f"Maximum likelihood with unknown starts; {100 * document.confidence:.0f} % intervals by "
        "profile likelihood."
    )


def _headline(document: ModelDocument, model: Model) -> str:
    """The first two parameters with their units and intervals."""
    units = {parameter.key: parameter.unit for parameter in model.parameters}
    return ", ".join(
        f"{_symbol(key)} = {about(fitted.value)} [{_low(fitted)}, {_high(fitted)}] {units[key]}".strip()
        for key, fitted in list(document.parameters.items())[:2]
    )


def _symbol(key: str) -> str:
    return key.removesuffix("_um2").removesuffix("_um").replace("rho", "ρ").replace("mu", "µ")


def _low(fitted: ParameterSection) -> str:
    return "?" if fitted.open_low else low_end(fitted.low)


def _high(fitted: ParameterSection) -> str:
    return "?" if fitted.open_high else high_end(fitted.high)


def _parameters(document: ModelDocument, found: Identification) -> pages.Section:
    heads = "parameter | #value | #low | #high"
    rows = [
        (
            pages.code(key),
            significant(fitted.value),
            "no lower bound" if fitted.open_low else signed(down_to(fitted.low, 6)),
            "no upper bound" if fitted.open_high else signed(up_to(fitted.high, 6)),
        )
        for key, fitted in document.parameters.items()
    ]
    body = [pages.table("Parameters", heads, rows)]
    if document.quality is not None and document.quality.inflation > 1:
        body.append(_misfit(document.quality))
    if (sensor := document.sensor) is not None:
        words = "<p>Noise: {} µm ({}) and {}° ({}).</p>"
        position = significant(sensor.position_sigma_um, 3), sensor.position_source
        angle = significant(sensor.orientation_sigma_deg, 3), sensor.orientation_source
        body.append(pages.html(words, *position, *angle))
    if found.fitted is not None:
        body.append(
            pages.figure(
                pages.Figure(
                    svg=to_svg(
                        profile_figure(found), "profiles", "Rise of χ² along every parameter"
                    ),
                    title="How χ² rises when a parameter is held and all others follow",
                    caption="Dashed: the quantile that bounds the interval (shaded). The rise is "
                    "divided by the factor on the variances, which allows for residuals beyond the noise "
                    "and for the error of the steps.",
                )
            )
        )
    return pages.Section("parameters", "Parameters", body)


def _misfit(quality: QualitySection) -> Markup:
    rejected = quality.rejected
    advice = " <code>meso-robust diagnose</code> looks for what it leaves out." if rejected else ""
    return pages.html(
        '<div class="notice"><h2>{}</h2>\n<p>χ² = {} for {} degrees of freedom ({}), and neighbouring '
        "residuals correlate by {:.2f}. The intervals are {:.3g} times as wide as the sensor's noise "
        f"alone would make them, and hold only for what this model can describe.{advice}</p></div>",
        "The recordings reject this model" if rejected else "The model does not explain everything",
        significant(quality.chi2),
        quality.freedom,
        p_words(quality.p_value),
        quality.correlation,
        quality.inflation**0.5,
    )


def _not_identifiable(document: ModelDocument) -> pages.Section:
    rows = [(pages.code(each.name), f"{each.why}.") for each in document.not_identifiable]
    return pages.Section(
        "unknown",
        "What the recordings do not determine",
        link="Not identifiable",
        body=(pages.table("What is not determined", "what | why", rows),),
    )


def _minima(document: ModelDocument, found: Identification) -> pages.Section:
    heads = ("minimum", "starts", "F, µm", "x, µm", "y, µm", "θ, °", *document.minima[0].parameters)
    rows = [
        (
            str(number),
            str(minimum.found),
            "—" if minimum.objective_um is None else significant(minimum.objective_um, 4),
            significant(minimum.x_um, 3),
            significant(minimum.y_um, 3),
            significant(minimum.theta_deg, 3),
            *(significant(value, 5) for value in minimum.parameters.values()),
        )
        for number, minimum in enumerate(document.minima, start=1)
    ]
    body = [
        pages.html(
            "<p>{} random starts (seed {}). F is the paper's eq. (4), each recording taken from its "
            "first pose as seen.</p>",
            document.provenance.starts,
            document.provenance.seed,
        ),
        pages.table("Local minima", " | #".join(heads), rows),
    ]
    if found.model.name.startswith("three_point"):
        drawn = "all" if len(rows) <= DRAWN_MINIMA else f"the first {DRAWN_MINIMA}"
        caption = f"Support points of {drawn} minima; + is the reference point."
        label = "Support points of the local minima"
        svg = to_svg(support_figure(found), "supports", label)
        body.append(pages.figure(pages.Figure(svg=svg, caption=caption, wide=False)))
    return pages.Section("minima", "Local minima", link="Minima", body=body)


def _recordings(document: ModelDocument, found: Identification) -> pages.Section:
    heads = "recording | #frames | #x, µm | #y, µm | #θ, ° | simulated push"
    rows = [
        (
            each.file,
            each.frames,
            significant(each.x_um, 3),
            significant(each.y_um, 3),
            significant(each.theta_deg, 3),
            each.outcome,
        )
        for each in document.recording
    ]
    body = [pages.table("Recordings", heads, rows)]
    if document.provenance.notes:
        body += [
            pages.html("<h3>Used differently from what the files say</h3>"),
            pages.bullets(document.provenance.notes),
        ]
    drawn = [_recording(found, row) for row in _worst(found)]
    words = (
        "<p>Left, to scale: the part at the start (light) and at the end (grey), and where the model "
        "puts its end (blue, dashed); path of the reference point, seen (dots) and fitted (line); paths "
        "of the tips (orange).\nRight: seen minus fitted."
    )
    if len(drawn) < len(rows):
        words += f" The {len(drawn)} recordings with the largest residuals of {len(rows)}."
    body += [pages.html(f"{words}</p>"), pages.figure(*drawn)]
    return pages.Section("recordings", "Recordings", body)


def _worst(found: Identification) -> list[int]:
    """Recordings to draw."""
    scale = np.array([1.0, 1.0, found.prepared.length])
    left = np.nan_to_num((found.prepared.seen - found.prediction.poses[0]) * scale)
    mean = np.sum(left**2, axis=(1, 2)) / np.maximum(found.prepared.counts.sum(axis=1), 1)
    return [int(row) for row in np.argsort(-mean)[:MOST_PICTURES]]


def _recording(found: Identification, row: int) -> pages.Figure:
    name = found.prepared.files[row]
    svg = to_svg(recording_figure(found, row), f"rec{row}", f"Recording {name} with the model")
    return pages.Figure(svg=svg, title=name)
