"""The report on what the plain model leaves out, as one HTML page that needs nothing else."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from shlex import quote

import numpy as np
from markupsafe import Markup

from meso_robust.diagnosis.document import DiagnosisDocument, HeldOutRecording
from meso_robust.diagnosis.evidence import Evidence
from meso_robust.provenance import made_with
from meso_robust.reporting.diagnosis_figures import (
    LEVELS,
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
    noise_words,
    plain,
    probability,
    set_words,
    sets,
    standing_words,
    unit_words,
)
from meso_robust.reporting.equations import typeset
from meso_robust.reporting.skeleton import Banner, code, page, versions
from meso_robust.reporting.svg import style, to_svg
from meso_robust.reporting.theme import STAGES
from meso_robust.reporting.words import number, significant
from meso_robust.simulator.catalogue import CATALOGUE
from meso_robust.wording import counted

MOST_PICTURES = 6
"""Recordings that are drawn, those that the plain model fits worst first."""
MOST_ROWS = 40
"""Rows of one table, and recordings of one picture."""


@dataclass(frozen=True, slots=True)
class _Picture:
    """A drawing with its title."""

    title: str
    svg: Markup


def diagnosis_report(document: DiagnosisDocument, evidence: Evidence, source: str) -> str:
    """One self-contained HTML page: the answer first, then its grounds.

    Parameters
    ----------
    document, evidence
        The diagnosis, as written, and the motion that it is about.
    source
        Name of the recording set.
    """
    with style():
        pictures = _pictures(document, evidence)
    look = LOOKS[document.verdict]
    banner = Banner(
        verb="diagnose",
        subject=source,
        about=f"plain model {document.baseline.model}",
        word=document.verdict.upper(),
        colour=look.colour,
        meaning=Markup("<strong>{}</strong><br>{}<br>Why: {}.").format(
            answer(document), look.meaning, document.why.rstrip(".")
        ),
        figures=tuple((name, value) for value, name in _figures(document)),
    )
    return page(
        "diagnosis.html.j2",
        banner,
        _made(document, source),
        document=document,
        pictures=pictures,
        sets=sets(document),
        spans=document.mismatch.where[:MOST_ROWS],
        held_out=_held_out(document),
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


def _made(document: DiagnosisDocument, source: str) -> list[tuple[str, str]]:
    """What the diagnosis was made from, and how to make it again."""
    made = document.provenance
    again = (
        f"meso-robust diagnose {quote(source)} --model {document.baseline.model} --seed {made.seed}"
    )
    return [
        ("to reproduce", code(again + " --quick" * made.quick)),
        ("recordings (SHA-256)", code(made.recordings_sha256)),
        versions({**made_with(), "meso-robust": made.meso_robust, "seed": str(made.seed)}),
        *(("note", note) for note in made.notes),
    ]


def _meaning(effect: str, key: str) -> str:
    """What the catalogue says of a parameter; nothing for those it does not know."""
    known = CATALOGUE[effect].parameters if effect in CATALOGUE else ()
    return next((one.meaning for one in known if one.key == key), "")


def _figures(document: DiagnosisDocument) -> list[tuple[str, str]]:
    """Value and name of what stands under the headline."""
    mismatch, held = document.mismatch, document.held_out
    p = probability(mismatch.p_value)
    shown = [(f"p = {p}", f"of a misfit as large without a mismatch; {mismatch.nulls} sets")]
    if held.recordings:
        shown.append(
            (
                _before_after(document, held.baseline_sigma, held.extended_sigma, "σ"),
                f"error on {counted(len(held.recordings), 'held-out recording')}; {noise_words(held)}",
            )
        )
        shown.append(
            (
                _before_after(document, held.baseline_um, held.extended_um, "µm"),
                "the same error in position",
            )
        )
    before, after = held.extrapolation_baseline_sigma, held.extrapolation_extended_sigma
    if before is not None and after is not None:
        shown.append((_before_after(document, before, after, "σ"), "error on extrapolation"))
    return shown


def _before_after(document: DiagnosisDocument, before: float, after: float, unit: str) -> str:
    """Both errors, or the one there is if nothing was added."""
    if not document.effects:
        return f"{significant(before, 3)} {unit}"
    return f"{significant(before, 3)} → {significant(after, 3)} {unit}"


def _held_out(document: DiagnosisDocument) -> list[HeldOutRecording]:
    """Recordings of the held-out picture and table, worst first."""
    worst = sorted(document.held_out.each, key=lambda one: -one.baseline_sigma)
    return sorted(worst, key=lambda one: one.split == "extrapolation")[:MOST_ROWS]


def _shades() -> list[tuple[str, str]]:
    """Name in the style sheet and range of every shade of the map."""
    ends = [f"{level:g}" for level in LEVELS]
    between = [f"{low}–{high} σ" for low, high in pairwise(ends)]
    return [
        (f"s{level}", words)
        for level, words in enumerate([f"< {ends[0]} σ", *between, f"> {ends[-1]} σ"])
    ]


def _pictures(document: DiagnosisDocument, evidence: Evidence) -> dict[str, object]:
    """Everything that is drawn; None where there is nothing to draw."""
    worst = np.argsort(-size(residuals(evidence, evidence.baseline)), kind="stable").tolist()
    vectors, scale = vectors_figure(evidence)
    rows = sorted(worst[:MOST_ROWS])
    held, spans = _held_out(document), document.mismatch.where
    noise = document.held_out.noise_floor_sigma, document.held_out.repeatability_sigma
    return {
        "held_out": to_svg(
            held_out_figure(held, noise, bool(document.effects)), "held", "Held-out errors"
        )
        if held
        else None,
        "strip": to_svg(
            strip_figure(spans, evidence, _marked(document, evidence)), "strip", "Spans of misfit"
        )
        if spans
        else None,
        "map": to_svg(map_figure(evidence, rows), "map", "Residuals by recording and time"),
        "vectors": to_svg(vectors, "vectors", "Residuals by place on the stage"),
        "scale": f"{scale:g}",
        "null": to_svg(null_figure(evidence, document), "null", "Local tests without a mismatch")
        if len(evidence.null_statistics)
        else None,
        "recordings": [_recording(evidence, row) for row in worst[:MOST_PICTURES]],
    }


def _marked(document: DiagnosisDocument, evidence: Evidence) -> list[int]:
    """Recordings of the strip of spans: the marked ones first, as many as there is room for."""
    named = {span.recording for span in document.mismatch.where}
    rows = sorted(range(len(evidence.files)), key=lambda row: evidence.files[row] not in named)
    return sorted(rows[:MOST_ROWS])


def _recording(evidence: Evidence, row: int) -> _Picture:
    file = evidence.files[row]
    kind = "held out" if file in evidence.held_out else "training"
    if file in evidence.extrapolation:
        kind += ", extrapolation"
    svg = to_svg(overlay_figure(evidence, row), f"rec{row}", f"Recording {file} beside the models")
    return _Picture(f"{file} ({kind})", svg)
