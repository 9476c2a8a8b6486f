"""Pictures of the blind benchmark, as SVG text that needs nothing else."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from meso_robust.campaigns.blind.judging import canonical
from meso_robust.campaigns.blind.labels import SILENT
from reports.blind.corpus import EFFECTS

Values = Mapping[str, Any]

WIDE, HIGH = 420, 260  # of the plotting area
LEFT, TOP = 60, 30
CELL = 17
BLUE, ORANGE, GREY = "#0072b2", "#d55e00", "#888888"  # apart for every kind of colour vision
LAST = ("ambiguous", "unknown", "not identifiable", "consistent", "no answer")
OTHER = "other or several"


def _page(width: float, height: float, title: str, parts: Iterable[str]) -> str:
    head = (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width:g} {height:g}" '
        f'width="{width:g}" height="{height:g}" font-family="sans-serif" font-size="12" role="img">'
        f'<title>{title}</title><rect width="100%" height="100%" fill="white"/>'
    )
    return "\n".join([head, *parts, "</svg>\n"])


def _text(x: float, y: float, text: str, more: str = "") -> str:
    return f'<text x="{x:.1f}" y="{y:.1f}" {more}>{text}</text>'


def _line(points: Sequence[tuple[float, float]], colour: str, more: str = "") -> str:
    path = " ".join(f"{x:.1f},{y:.1f}" for x, y in points)
    return f'<polyline points="{path}" fill="none" stroke="{colour}" {more}/>'


def _dot(x: float, y: float, radius: float, colour: str) -> str:
    return f'<circle cx="{x:.1f}" cy="{y:.1f}" r="{radius:.1f}" fill="{colour}"/>'


def _frame(across: str, up: str) -> list[str]:
    """Axes with 0, 50 and 100 % upwards."""
    box = f'<rect x="{LEFT}" y="{TOP}" width="{WIDE}" height="{HIGH}" fill="none" stroke="{GREY}"/>'
    ticks = [
        _text(LEFT - 6, TOP + HIGH * (1 - k / 2) + 4, f"{50 * k} %", 'text-anchor="end"')
        for k in range(3)
    ]
    middle = 'text-anchor="middle"'
    return [
        box,
        *ticks,
        _text(LEFT + WIDE / 2, TOP + HIGH + 38, across, middle),
        _text(LEFT, TOP - 10, up),
    ]


def power_figure(by_multiple: Sequence[Values]) -> str:
    """Detected and rightly named against the size, with their intervals."""
    parts = _frame("size / just-detectable size", "share of single effects")
    step = WIDE / max(len(by_multiple), 1)
    at = [LEFT + step * (k + 0.5) for k in range(len(by_multiple))]
    for x, row in zip(at, by_multiple, strict=True):
        size = f"{row['multiple']:g}×" if row["multiple"] else "&lt; 1×"
        parts.append(_text(x, TOP + HIGH + 18, size, 'text-anchor="middle"'))
    curves = (("detected", "detected", GREY), ("right", "named rightly", BLUE))
    for k, (key, words, colour) in enumerate(curves):
        shifted = [x + 6 * k for x in at]
        parts += _curve(shifted, [row[key] for row in by_multiple], colour)
        parts.append(_text(LEFT + 10, TOP + 18 + 16 * k, words, f'fill="{colour}"'))
    return _page(LEFT + WIDE + 20, TOP + HIGH + 50, "Power", parts)


def _height(rate: float) -> float:
    return TOP + HIGH * (1 - rate)


def _curve(at: Sequence[float], shares: Sequence[Values], colour: str) -> list[str]:
    points = [(x, _height(s["rate"])) for x, s in zip(at, shares, strict=True)]
    bars = [
        _line([(x, _height(s["low"])), (x, _height(s["high"]))], colour)
        for x, s in zip(at, shares, strict=True)
    ]
    return [
        _line(points, colour, 'stroke-width="2"'),
        *bars,
        *(_dot(*p, 4, colour) for p in points),
    ]


def reliability_figure(bins: Sequence[Values]) -> str:
    """How often a stated probability was right; a dot's area is its number of claims."""
    parts = _frame("stated probability", "share that is right")
    ends = [(LEFT, TOP + HIGH), (LEFT + WIDE, TOP)]
    parts.append(_line([(float(x), float(y)) for x, y in ends], GREY, 'stroke-dasharray="4 4"'))
    most = max((b["count"] for b in bins), default=1)
    for b in bins:
        x, y = LEFT + WIDE * b["stated"], _height(b["right"])
        parts.append(_dot(x, y, 3 + 9 * (b["count"] / most) ** 0.5, BLUE))
    for k in range(3):
        parts.append(
            _text(LEFT + WIDE * k / 2, TOP + HIGH + 18, f"{50 * k} %", 'text-anchor="middle"')
        )
    return _page(LEFT + WIDE + 30, TOP + HIGH + 50, "Reliability", parts)


def confusion_figure(confusion: Mapping[str, Mapping[str, int]]) -> str:
    """Answers (columns) by what was concealed (rows); right answers are framed."""
    kinds = [row for row in confusion if row not in EFFECTS]
    rows = [*(name for name in EFFECTS if name in confusion), *kinds]
    names = [name for name in EFFECTS if canonical([name]) == {name}]
    columns = [*names, OTHER, *LAST]
    x0, y0 = 190, 170
    parts = [
        _text(x0 - 6, y0 + CELL * (k + 0.8), row, 'text-anchor="end"') for k, row in enumerate(rows)
    ]
    for k, column in enumerate(columns):
        x, y = x0 + CELL * (k + 0.8), y0 - 6.0
        parts.append(_text(x, y, column, f'transform="rotate(-60 {x:.1f} {y:.1f})"'))
    for k, row in enumerate(rows):
        counts = _placed(confusion[row], columns)
        total = sum(counts.values())
        for j, column in enumerate(columns):
            share = counts[column] / total
            parts.append(_cell(x0 + CELL * j, y0 + CELL * k, counts[column], share))
        parts += [
            _frame_of(x0 + CELL * columns.index(c), y0 + CELL * k) for c in _right(row, columns)
        ]
    width, height = x0 + CELL * len(columns) + 110, y0 + CELL * len(rows) + 20
    return _page(width, height, "Confusion matrix", parts)


RIGHT = {
    ("null", "consistent"),
    ("outside", "unknown"),
    ("unidentifiable", "ambiguous"),
    *((name, "not identifiable") for name in SILENT),
}


def _placed(answers: Mapping[str, int], columns: Sequence[str]) -> dict[str, int]:
    counts = dict.fromkeys(columns, 0)
    for answer, count in answers.items():
        counts[answer if answer in counts else OTHER] += count
    return counts


def _right(row: str, columns: Sequence[str]) -> list[str]:
    silent = row in SILENT
    return [c for c in columns if (row, c) in RIGHT or (not silent and canonical([row]) == {c})]


def _frame_of(x: float, y: float) -> str:
    size = f'width="{CELL}" height="{CELL}" fill="none"'
    return f'<rect x="{x}" y="{y}" {size} stroke="{ORANGE}" stroke-width="1.5"/>'


def _cell(x: float, y: float, count: int, share: float) -> str:
    ink = "white" if share > 0.5 else "black"
    box = (
        f'<rect x="{x}" y="{y}" width="{CELL}" height="{CELL}" fill="{BLUE}" '
        f'fill-opacity="{share:.2f}" stroke="#dddddd"/>'
    )
    if not count:
        return box
    place = f'text-anchor="middle" font-size="10" fill="{ink}"'
    return box + _text(x + CELL / 2, y + CELL * 0.7, str(count), place)
