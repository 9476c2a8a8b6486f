"""The report on what the plain model leaves out, as one HTML page that needs nothing else."""

from __future__ import annotations

from itertools import pairwise
from shlex import quote

import numpy as np
from markupsafe import Markup

from meso_robust.diagnosis.document import DiagnosisDocument, HeldOutRecording
from meso_robust.diagnosis.evidence import Evidence
from meso_robust.provenance import made_with
from meso_robust.recordings.direct.document import words
from meso_robust.recordings.direct.run import DirectTests
from meso_robust.reporting import pages
from meso_robust.reporting.diagnosis_figures import (
    LEVELS,
    budget_figure,
    held_out_figure,
    map_figure,
    null_figure,
    overlay_figure,
    residuals,
    size,
    strip_figure,
    vectors_figure,
)
from meso_robust.reporting.diagnosis_words import (
    COMPONENTS,
    LOOKS,
    PHASES,
    answer,
    left_words,
    noise_words,
    plain,
    probability,
    set_words,
    sets,
    stage_words,
    standing_words,
    unit_words,
)
from meso_robust.reporting.direct import direct_section
from meso_robust.reporting.equations import typeset
from meso_robust.reporting.svg import style, to_svg
from meso_robust.reporting.theme import STAGES
from meso_robust.reporting.words import number, significant
from meso_robust.simulator.catalogue import CATALOGUE
from meso_robust.wording import counted

MOST_PICTURES = 6
"""Recordings that are drawn, those that the plain model fits worst first."""
MOST_ROWS = 40
"""Rows of one table, and recordings of one picture."""


def diagnosis_report(
    document: DiagnosisDocument,
    evidence: Evidence,
    source: str,
    direct: DirectTests | None = None,
) -> str:
    """One self-contained HTML page: the answer first, then its grounds.

    Parameters
    ----------
    document, evidence
        The diagnosis, as written, and the motion that it is about.
    source
        Name of the recording set.
    direct
        What the tests say that need no simulation, where they were made.

    Returns
    -------
    str
        The page; it asks for nothing from outside.
    """
    with style():
        pictures = _pictures(document, evidence)
    origin, extended = document.provenance, document.extends
    body = pages.prose(
        "diagnosis.html.j2",
        document=document,
        pictures=pictures,
        sets=sets(document),
        spans=document.mismatch.where[:MOST_ROWS],
        held_out=_held_out(document),
        left=left_words(document),
        unexplained=sum(part.share for part in document.budget if not part.effect),
        shades=_shades(),
        channels=list(STAGES),
        most=MOST_ROWS,
        phases=PHASES,
        components=COMPONENTS,
        typeset=typeset,
        set_words=set_words,
        unit=unit_words,
        plain=plain,
        standing=standing_words,
        meaning=_meaning,
        number=lambda value: "—" if value is None else significant(value, 3),
        percent=lambda share: number(100.0 * share, 0),
        probability=probability,
        counted=counted,
    )
    better = "Does the fit improve?" if extended else "Error on held-out recordings"
    return pages.page(
        pages.Report(
            banner=_banner(document, source, direct),
            sections=(
                pages.section(
                    body,
                    "answer",
                    "What the plain model leaves out" if extended else "The answer",
                    "Answer",
                ),
                *(
                    ()
                    if pictures["budget"] is None
                    else (pages.section(body, "budget", "Where the error is", "Budget"),)
                ),
                *(
                    ()
                    if pictures["held_out"] is None
                    else (pages.section(body, "better", better, "Held out"),)
                ),
                *(
                    ()
                    if document.residual is None
                    else (pages.section(body, "residual", "A law without a name", "Residual law"),)
                ),
                *(() if direct is None else (direct_section(direct),)),
                pages.section(body, "overlays", "Recorded and simulated motion", "Recordings"),
                pages.section(
                    body, "maps", f"Residuals{' before and after' if extended else ''}", "Residuals"
                ),
                pages.section(body, "where", "Where the plain model fails", "Where"),
                pages.section(body, "chance", "Could it be chance?", "Chance"),
                pages.section(body, "candidates", "Candidates"),
                pages.section(body, "invariances", "Invariances"),
                pages.section(
                    body, "blind", "What these recordings could not show", "Not identifiable"
                ),
                pages.section(
                    body, "next", "The next experiment", "Next experiment", look="notice next"
                ),
                pages.section(body, "noise", "Noise", ""),
                pages.section(body, "limits", "What this does not say"),
            ),
            made=pages.made(
                f"meso-robust diagnose {quote(source)} --model {document.baseline.model} "
                f"--seed {origin.seed}{' --quick' * origin.quick}",
                ("recordings (SHA-256)", pages.code(origin.recordings_sha256)),
                using={**made_with(), "meso-robust": origin.meso_robust, "seed": str(origin.seed)},
                notes=origin.notes,
            ),
            styles=("diagnosis.css",),
        )
    )


def _banner(document: DiagnosisDocument, source: str, direct: DirectTests | None) -> pages.Banner:
    look = LOOKS[document.verdict]
    seen = words(direct) if direct is not None and document.verdict == "unknown" else ()
    without = f"; tip and part by themselves, without any model, look {seen[0]}" if seen else ""
    return pages.Banner(
        verb="diagnose",
        subject=source,
        about=f"plain model {document.baseline.model}",
        word=document.verdict.upper(),
        colour=look.colour,
        meaning=Markup("<strong>{}</strong><br>{}<br>Why: {}.").format(
            answer(document) + without, look.meaning, document.why.rstrip(".")
        ),
        figures=_figures(document),
    )


def _meaning(effect: str, key: str) -> str:
    """What the catalogue says of a parameter; nothing for those it does not know."""
    stated = CATALOGUE[effect].parameters if effect in CATALOGUE else ()
    return next((parameter.meaning for parameter in stated if parameter.key == key), "")


def _figures(document: DiagnosisDocument) -> list[tuple[str, str]]:
    """Name and value of what stands under the headline."""
    mismatch, held = document.mismatch, document.held_out
    likely = f"of a misfit as large without a mismatch; {mismatch.nulls} sets"
    rows = [(likely, f"p = {probability(mismatch.p_value)}")]

    def errors(name: str, before: float, after: float, unit: str) -> None:
        change = f" → {significant(after, 3)}" if document.extends else ""
        rows.append((name, f"{significant(before, 3)}{change} {unit}"))

    if held.recordings:
        what = f"error on {counted(len(held.recordings), 'recording')}, each predicted without itself; {noise_words(held)}"
        errors(what, held.baseline_sigma, held.extended_sigma, "σ")
        errors("the same error in position", held.baseline_um, held.extended_um, "µm")
    before, after = held.extrapolation_baseline_sigma, held.extrapolation_extended_sigma
    if before is not None and after is not None:
        errors("error on extrapolation", before, after, "σ")
    return rows


def _held_out(document: DiagnosisDocument) -> list[HeldOutRecording]:
    """Recordings of the held-out picture and table, worst first."""
    worst = sorted(document.held_out.each, key=lambda recording: -recording.baseline_sigma)
    return sorted(worst, key=lambda recording: recording.split == "extrapolation")[:MOST_ROWS]


def _shades() -> list[tuple[str, str]]:
    """Name in the style sheet and range of every shade of the map."""
    ends = [f"{level:g}" for level in LEVELS]
    between = [f"{low}–{high} σ" for low, high in pairwise(ends)]
    return [
        (f"s{level}", words)
        for level, words in enumerate([f"< {ends[0]} σ", *between, f"> {ends[-1]} σ"])
    ]


def _pictures(
    document: DiagnosisDocument, evidence: Evidence
) -> dict[str, pages.Figure | list[pages.Figure] | None]:
    """Everything that is drawn; None where there is nothing to draw."""
    worst = np.argsort(-size(residuals(evidence, evidence.baseline)), kind="stable").tolist()
    vectors, scale = vectors_figure(evidence)
    rows = sorted(worst[:MOST_ROWS])
    held, spans = _held_out(document), document.mismatch.where
    noise = document.held_out.noise_floor_sigma, document.held_out.repeatability_sigma
    pictures: dict[str, pages.Figure | list[pages.Figure] | None] = {
        "budget": None,
        "held_out": None,
        "strip": None,
        "map": pages.Figure(
            svg=to_svg(map_figure(evidence, rows), "map", "Residuals by recording and time"),
            caption="Root mean square of x, y and θ over the noise in each sixtieth of the longest "
            "recording; empty where nothing was seen.",
        ),
        "vectors": pages.Figure(
            svg=to_svg(vectors, "vectors", "Residuals by place on the stage"),
            title="By place on the stage",
            caption=f"Recorded minus simulated position, {scale:g} times enlarged, at the place of "
            "the part.",
        ),
        "null": None,
        "recordings": [_recording(evidence, row) for row in worst[:MOST_PICTURES]],
    }
    if document.budget:
        drawing = budget_figure(document.budget)
        pictures["budget"] = pages.Figure(
            svg=to_svg(drawing, "budget", "Explainable error by effect, phase and component"),
            caption="Mean squares of roll-outs from the pose at rest, of recordings that the fit has not "
            "seen, beyond what free hidden inputs leave; the colour is the stage, hatched is unexplained. "
            + stage_words(document),
        )
    if held:
        drawing = held_out_figure(held, noise, document.extends)
        pictures["held_out"] = pages.Figure(svg=to_svg(drawing, "held", "Held-out errors"))
    if spans:
        drawing = strip_figure(spans, evidence, _marked(document, evidence))
        pictures["strip"] = pages.Figure(
            svg=to_svg(drawing, "strip", "Spans of misfit"),
            caption="Grey: the recording. In every row x, y and θ from top to bottom; the colour is "
            "the stage of the chain whose hidden input explains the span best.",
        )
    if len(evidence.null_statistics):
        svg = to_svg(null_figure(evidence, document), "null", "Local tests without a mismatch")
        pictures["null"] = pages.Figure(svg=svg, wide=False)
    return pictures


def _marked(document: DiagnosisDocument, evidence: Evidence) -> list[int]:
    """Recordings of the strip of spans: the marked ones first, as many as there is room for."""
    named = {span.recording for span in document.mismatch.where}
    rows = sorted(range(len(evidence.files)), key=lambda row: evidence.files[row] not in named)
    return sorted(rows[:MOST_ROWS])


def _recording(evidence: Evidence, row: int) -> pages.Figure:
    file = evidence.files[row]
    kind = "held out of the choice" if file in evidence.held_out else "training"
    if file in evidence.extrapolation:
        kind += ", extrapolation"
    svg = to_svg(overlay_figure(evidence, row), f"rec{row}", f"Recording {file} beside the models")
    return pages.Figure(svg=svg, title=f"{file} ({kind})")
