"""The report on a recording set as one HTML page that needs nothing else."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from shlex import quote

import numpy as np
from markupsafe import Markup

from meso_robust.provenance import made_with
from meso_robust.recordings import Recording
from meso_robust.recordings.fingerprint import set_hash
from meso_robust.recordings.noise import Spread, estimated_sensor, systematic
from meso_robust.recordings.problem import KINDS, lines_text
from meso_robust.recordings.problems import line_numbers
from meso_robust.recordings.rules import DEG, UM
from meso_robust.recordings.summary import Checked, RecordingSummary, TipSummary, summary
from meso_robust.reporting import pages
from meso_robust.reporting.direct import direct_section
from meso_robust.reporting.recording_figures import recording_svg

MOST_PICTURES = 16
"""Recordings that are drawn; those with problems come first."""
MOST_ROWS = 500
"""Rows of one table."""
_COLOURS: dict[str, pages.Colour] = {
    "CLEAN": "PROVED",
    "USABLE WITH CARE": "UNKNOWN",
    "NOT USABLE AS IT IS": "REFUTED",
}
_MEANING = {
    "CLEAN": "No reason was found not to use these recordings.",
    "USABLE WITH CARE": "They can be used, but read the warnings first.",
    "NOT USABLE AS IT IS": "Some recordings cannot be used as they are; the errors say why.",
}
_TAGS = {"error": "bad", "warning": "open", "information": ""}


def recordings_report(checked: Checked) -> str:
    """One self-contained HTML page on a checked set: the verdict first, then problems and pictures.

    Parameters
    ----------
    checked
        The set and all that was found. The pictures show it as it is after the repair.

    Returns
    -------
    str
        The page; it asks for nothing from outside.
    """
    summaries = {each.file: each for each in summary(checked.recordings)}
    repair = " --repair" if checked.repairs else ""
    notes = pages.Section(
        "notes",
        "What the import says",
        link="",
        body=(pages.bullets(checked.notes, most=MOST_ROWS, file="summary.json"),),
    )
    return pages.page(
        pages.Report(
            banner=_banner(checked, tuple(summaries.values())),
            sections=(
                _problems(checked),
                _repairs(checked),
                *[notes] * bool(checked.notes),
                *([direct_section(checked.direct)] if checked.direct else []),
                _noise(checked),
                _numbers(tuple(summaries.values())),
                _pictures(checked, summaries),
            ),
            made=pages.made(
                f"meso-robust recordings {quote(checked.source)}{repair}",
                ("values as shown (SHA-256)", pages.code(set_hash(checked.recordings))),
                using=made_with(),
            ),
        )
    )


def _banner(checked: Checked, summaries: tuple[RecordingSummary, ...]) -> pages.Banner:
    errors = sum(problem.severity == "error" for problem in checked.remaining)
    seen, lost = sum(each.seen for each in summaries), sum(each.lost for each in summaries)
    return pages.Banner(
        verb="recordings",
        subject=checked.source,
        about=f"format {checked.format}",
        word=checked.verdict,
        colour=_COLOURS[checked.verdict],
        meaning=_MEANING[checked.verdict],
        figures=(
            ("recordings", str(len(summaries))),
            ("frames that show the part", str(seen)),
            ("frames lost", f"{lost} ({100.0 * lost / max(seen + lost, 1):.0f} %)"),
            ("errors · warnings", f"{errors} · {len(checked.matters) - errors}"),
            ("repairs", str(len(checked.repairs))),
        ),
    )


def _problems(checked: Checked) -> pages.Section:
    order = list(_TAGS)  # errors first, then warnings
    problems = sorted(checked.remaining, key=lambda problem: order.index(problem.severity))
    rows = [
        (
            Markup('<span class="tag {}">{}</span>').format(
                _TAGS[problem.severity], problem.severity
            ),
            _where(problem.file, problem.rows),
            KINDS[problem.kind],
            f"{problem.value}; {problem.rule}; {problem.advice}.",
        )
        for problem in problems
    ]
    heads = "weight | where | what | found; rule; what to do"
    return pages.Section(
        "problems",
        "Remaining problems" if checked.repairs else "Problems",
        link="Problems",
        body=(_table("Problems", heads, rows) if rows else pages.html("<p>None.</p>"),),
    )


def _repairs(checked: Checked) -> pages.Section:
    none = "made; --repair makes those that invent no data" if checked.found else "needed"
    words = (
        "<p>Values that are not measurements were marked as not seen or left out. Nothing was filled in, "
        "and no other value was changed.</p>"
    )
    rows = [
        (_where(repair.file, repair.rows), KINDS[repair.kind], repair.done)
        for repair in checked.repairs
    ]
    return pages.Section(
        "repairs",
        "Repairs",
        (pages.html(words), _table("Repairs", "where | what | done", rows))
        if rows
        else (pages.html("<p>None was {}.</p>", none),),
    )


def _table(label: str, heads: str, rows: Sequence[tuple[str, ...]]) -> Markup:
    return pages.table(label, heads, rows, named=False, most=MOST_ROWS, file="summary.json")


def _where(file: str, rows: tuple[int, ...]) -> str:
    return f"{file}, {lines_text(rows)}" if rows else file


def _noise(checked: Checked) -> pages.Section:
    stated, found = checked.recordings.sensor, estimated_sensor(checked.recordings).noise
    coordinates = (
        ("x", stated.position_sigma, found.x, UM, "µm"),
        ("y", stated.position_sigma, found.y, UM, "µm"),
        ("θ", stated.orientation_sigma, found.theta, DEG, "°"),
    )
    heads = "coordinate | σ stated | repeatability, from still frames | systematic error | correlation from frame to frame"
    rows = [
        (
            name,
            "not stated" if value is None else f"{value / unit:.4g} {letter}",
            _estimate(spread, unit, letter),
            "—"
            if (rest := systematic(value, spread.sigma)) is None
            else f"{rest / unit:.4g} {letter}",
            "—" if spread.correlation is None else f"{spread.correlation:.2f}",
        )
        for name, value, spread, unit, letter in coordinates
    ]
    words = (
        "<p>σ is the noise that a set states: repeatability and systematic error together. The frames before "
        "the first contact, in which the part is still, show the repeatability, the scatter from "
        "frame to frame. A systematic error (of the outline, the lens, the place in the image) stays "
        "the same from frame to frame: it is what σ has beyond the repeatability.</p>"
    )
    return pages.Section("noise", "Noise", (pages.html(words), pages.table("Noise", heads, rows)))


def _estimate(spread: Spread, unit: float, letter: str) -> str:
    if spread.sigma is None:
        return f"cannot be estimated: {spread.reason}"
    error = spread.sigma / np.sqrt(2.0 * spread.freedom)
    return f"{spread.sigma / unit:.4g} ± {error / unit:.2g} {letter}"


def _numbers(summaries: tuple[RecordingSummary, ...]) -> pages.Section:
    heads = (
        "recording | #s | frames | #part moves, µm | #turns, ° | tips: path, mean speed | phases"
    )
    rows = [
        (
            each.file,
            f"{each.duration:.3g}",
            _frames(each),
            _travel(each),
            _turn(each),
            "; ".join(f"{tip.name}: {_speeds(tip)}" for tip in each.tips),
            ", ".join(f"{phase.name} {phase.end - phase.start:.2g} s" for phase in each.phases),
        )
        for each in summaries
    ]
    body = pages.table("Numbers", heads, rows, most=MOST_ROWS, file="summary.json")
    return pages.Section("numbers", "Numbers", (body,))


def _speeds(tip: TipSummary) -> str:
    if tip.path is None or tip.mean_speed is None or tip.largest_speed is None:
        return "not seen"
    return (
        f"{_short(tip.path / UM)} µm, {_short(tip.mean_speed / UM)} µm/s, "
        f"largest {_short(tip.largest_speed / UM)}"
    )


def _frames(each: RecordingSummary) -> str:
    return f"{each.seen} + {each.lost} lost"


def _travel(each: RecordingSummary) -> str:
    return "—" if each.travel is None else _short(each.travel / UM)


def _turn(each: RecordingSummary) -> str:
    return "—" if each.turn is None else _short(each.turn / DEG)


def _short(value: float) -> str:
    """Four digits, or all of a long number before its point."""
    return f"{value:.4g}" if abs(value) < 1e4 else f"{value:.0f}"


def _pictures(checked: Checked, summaries: Mapping[str, RecordingSummary]) -> pages.Section:
    pictures = [
        _picture(checked, recording, summaries[recording.file]) for recording in _drawn(checked)
    ]
    words = (
        "<p>Left, to scale: the part at the start (dashed), at the end (dark) and in between, the paths "
        "of its reference point (blue) and of the tips (orange).\nRight: contact is shaded blue, gaps "
        "of more than one frame amber; rows with a problem are purple.\n"
    )
    if len(pictures) < len(summaries):
        words += (
            f"{len(pictures)} of {len(summaries)} recordings are drawn, those with problems first."
        )
    return pages.Section(
        "pictures", "Pictures", (pages.html(f"{words}</p>"), pages.figure(*pictures))
    )


def _drawn(checked: Checked) -> list[Recording]:
    """Recordings to draw, those with problems first, in the order of the set."""
    troubled = {problem.file for problem in checked.matters}
    every = checked.recordings.recordings
    first = sorted(every, key=lambda recording: recording.file not in troubled)[:MOST_PICTURES]
    names = {recording.file for recording in first}
    return [recording for recording in every if recording.file in names]


def _picture(checked: Checked, recording: Recording, numbers: RecordingSummary) -> pages.Figure:
    rows = {
        row
        for problem in checked.remaining
        if problem.file == recording.file and problem.kind not in {"gap", "wrap"}
        for row in problem.rows
    }
    lines = line_numbers(recording, checked.lines)
    marked = frozenset(k for k, line in enumerate(lines) if line in rows)
    label = f"Recording {recording.file}"
    return pages.Figure(
        svg=recording_svg(checked.recordings, recording, marked, numbers.phases, label),
        title=recording.file,
        caption=f"{numbers.duration:.3g} s, {_frames(numbers)}; the part moves by "
        f"{_travel(numbers)} µm and turns by {_turn(numbers)}°.",
    )
