"""The report on a recording set as one HTML page that needs nothing else."""

from __future__ import annotations

from dataclasses import dataclass
from shlex import quote

import numpy as np
from markupsafe import Markup

from meso_robust.identification.answer import set_hash
from meso_robust.provenance import made_with
from meso_robust.recordings import Recording
from meso_robust.recordings.noise import Spread, estimated_sensor, systematic
from meso_robust.recordings.problem import KINDS, Problem, lines_text
from meso_robust.recordings.problems import line_numbers
from meso_robust.recordings.rules import DEG, UM
from meso_robust.recordings.summary import Checked, RecordingSummary, summary
from meso_robust.reporting.recording_figures import recording_figure
from meso_robust.reporting.skeleton import Banner, Colour, code, page, versions
from meso_robust.reporting.svg import style, to_svg

MOST_PICTURES = 16
"""Recordings that are drawn; those with problems come first."""
MOST_ROWS = 500
"""Rows of one table."""
_COLOURS: dict[str, Colour] = {
    "CLEAN": "PROVED",
    "USABLE WITH CARE": "UNKNOWN",
    "NOT USABLE AS IT IS": "REFUTED",
}
_MEANING = {
    "CLEAN": "Nothing in these recordings speaks against using them.",
    "USABLE WITH CARE": "They can be used, but read the warnings first.",
    "NOT USABLE AS IT IS": "Some recordings cannot be used as they are; the errors say why.",
}
_TAGS = {"error": "bad", "warning": "open", "information": ""}


@dataclass(frozen=True, slots=True)
class _Row:
    """A problem or a repair in words."""

    tag: str
    severity: str
    where: str
    kind: str
    text: str


@dataclass(frozen=True, slots=True)
class _Picture:
    """One recording: its name, its numbers and its drawing."""

    title: str
    caption: str
    svg: Markup


def recordings_report(checked: Checked) -> str:
    """One self-contained HTML page on a checked set: the verdict first, then problems and pictures.

    Parameters
    ----------
    checked
        The set and all that was found. The pictures show it as it is after the repair.
    """
    summaries = {one.file: one for one in summary(checked.recordings)}
    with style():
        pictures = [
            _picture(checked, recording, summaries[recording.file], k)
            for k, recording in enumerate(_drawn(checked))
        ]
    banner = Banner(
        verb="recordings",
        subject=checked.source,
        about=f"format {checked.format}",
        word=checked.verdict,
        colour=_COLOURS[checked.verdict],
        meaning=_MEANING[checked.verdict],
        figures=tuple(_figures(checked, tuple(summaries.values()))),
    )
    return page(
        "recordings.html.j2",
        banner,
        _made(checked),
        checked=checked,
        remaining=[_problem(one) for one in _sorted(checked.remaining)][:MOST_ROWS],
        repairs=[
            _Row("", "", _where(one.file, one.rows), KINDS[one.kind], one.done)
            for one in checked.repairs
        ][:MOST_ROWS],
        noise=_noise(checked),
        table=[_numbers(one) for one in summaries.values()][:MOST_ROWS],
        pictures=pictures,
        most=MOST_ROWS,
        count=len(summaries),
    )


def _made(checked: Checked) -> tuple[tuple[str, str], ...]:
    """What was checked, and how to check it again."""
    repair = " --repair" if checked.repairs else ""
    return (
        ("to reproduce", code(f"meso-robust recordings {quote(checked.source)}{repair}")),
        ("values as shown (SHA-256)", code(set_hash(checked.recordings))),
        versions(made_with()),
    )


def _sorted(problems: tuple[Problem, ...]) -> list[Problem]:
    """Errors first, then warnings."""
    order = list(_TAGS)
    return sorted(problems, key=lambda one: order.index(one.severity))


def _where(file: str, rows: tuple[int, ...]) -> str:
    return f"{file}, {lines_text(rows)}" if rows else file


def _problem(one: Problem) -> _Row:
    text = f"{one.value}; {one.rule}; {one.advice}."
    return _Row(
        _TAGS[one.severity], one.severity, _where(one.file, one.rows), KINDS[one.kind], text
    )


def _figures(checked: Checked, summaries: tuple[RecordingSummary, ...]) -> list[tuple[str, str]]:
    """Name and value of what stands under the verdict."""
    errors = sum(one.severity == "error" for one in checked.remaining)
    seen, lost = sum(one.seen for one in summaries), sum(one.lost for one in summaries)
    return [
        ("recordings", str(len(summaries))),
        ("frames that show the part", str(seen)),
        ("frames lost", f"{lost} ({100.0 * lost / max(seen + lost, 1):.0f} %)"),
        ("errors · warnings", f"{errors} · {len(checked.matters) - errors}"),
        ("repairs", str(len(checked.repairs))),
    ]


def _noise(checked: Checked) -> list[tuple[str, str, str, str, str]]:
    """Coordinate, σ as stated, repeatability, systematic error, lag-1 correlation."""
    stated, found = checked.recordings.sensor, estimated_sensor(checked.recordings).noise
    rows = (
        ("x", stated.position_sigma, found.x, UM, "µm"),
        ("y", stated.position_sigma, found.y, UM, "µm"),
        ("θ", stated.orientation_sigma, found.theta, DEG, "°"),
    )
    return [
        (
            name,
            "not stated" if value is None else f"{value / unit:.4g} {letter}",
            _estimate(spread, unit, letter),
            "—"
            if (rest := systematic(value, spread.sigma)) is None
            else f"{rest / unit:.4g} {letter}",
            "—" if spread.correlation is None else f"{spread.correlation:.2f}",
        )
        for name, value, spread, unit, letter in rows
    ]


def _estimate(spread: Spread, unit: float, letter: str) -> str:
    if spread.sigma is None:
        return f"cannot be estimated: {spread.reason}"
    error = spread.sigma / np.sqrt(2.0 * spread.freedom)
    return f"{spread.sigma / unit:.4g} ± {error / unit:.2g} {letter}"


def _numbers(one: RecordingSummary) -> dict[str, str]:
    """One recording as cells."""
    tips = [
        f"{tip.name}: "
        + (
            "not seen"
            if tip.path is None or tip.mean_speed is None or tip.largest_speed is None
            else f"{_short(tip.path / UM)} µm, {_short(tip.mean_speed / UM)} µm/s, "
            f"largest {_short(tip.largest_speed / UM)}"
        )
        for tip in one.tips
    ]
    return {
        "file": one.file,
        "duration": f"{one.duration:.3g}",
        "frames": f"{one.seen} + {one.lost} lost",
        "travel": "—" if one.travel is None else _short(one.travel / UM),
        "turn": "—" if one.turn is None else _short(one.turn / DEG),
        "tips": "; ".join(tips),
        "phases": ", ".join(
            f"{phase.name} {phase.end - phase.start:.2g} s" for phase in one.phases
        ),
    }


def _short(value: float) -> str:
    """Four digits, or all of a long number before its point."""
    return f"{value:.4g}" if abs(value) < 1e4 else f"{value:.0f}"


def _drawn(checked: Checked) -> list[Recording]:
    """Recordings to draw, those with problems first, in the order of the set."""
    troubled = {one.file for one in checked.matters}
    every = checked.recordings.recordings
    first = [one for one in every if one.file in troubled]
    chosen = [*first, *(one for one in every if one.file not in troubled)][:MOST_PICTURES]
    names = {one.file for one in chosen}
    return [one for one in every if one.file in names]


def _picture(
    checked: Checked, recording: Recording, numbers: RecordingSummary, index: int
) -> _Picture:
    rows = {
        row
        for one in checked.remaining
        if one.file == recording.file and one.kind not in {"gap", "wrap"}
        for row in one.rows
    }
    lines = line_numbers(recording, checked.lines)
    marked = frozenset(k for k, line in enumerate(lines) if line in rows)
    figure = recording_figure(checked.recordings, recording, marked, numbers.phases)
    cells = _numbers(numbers)
    caption = (
        f"{cells['duration']} s, {cells['frames']}; the part moves by {cells['travel']} µm and "
        f"turns by {cells['turn']}°."
    )
    name = f"Recording {recording.file}"
    return _Picture(recording.file, caption, to_svg(figure, f"rec{index}", name))
