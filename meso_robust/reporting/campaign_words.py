"""Counts, rates and spans of chunks in words, for the report on a campaign."""

from __future__ import annotations

import json
import re
import shlex
from collections.abc import Iterable, Sequence

from meso_robust.campaigns.answer import Shown
from meso_robust.campaigns.kind import Table, Values
from meso_robust.reporting.words import signed, significant
from meso_robust.wording import worded as worded

NONE = "—"
_CELL = re.compile(r"(?=.*\d)([\d\s.,;%…–±()\[\]/<>≤≥×+−-]|e[+-]?\d|of|to|um2?|µm|deg|s\b)*")
_BLANK = {"", "-", "–", NONE}
_SHORT = 14  # letters of a word that may stand for a number, such as "not met"
_LONG = re.compile(r"(?<![\w.,])\d{4,}(?![\w,-])")
_MOST_SPANS = 40  # stretches of chunks that are named one by one


def count(value: int) -> str:
    """A count, thousands grouped."""
    return f"{value:,}"


def parts(value: int) -> str:
    """So many parts."""
    return "1 part" if value == 1 else f"{value:,} parts"


def rate(runs: int, seconds: float) -> str:
    """Runs a second to three digits; a dash if no time was taken."""
    if seconds <= 0.0:
        return NONE
    speed = runs / seconds
    return f"{speed:,.0f}" if speed >= 100.0 else significant(speed, 3)


def duration(seconds: float) -> str:
    """A time in the units of everyday life."""
    if seconds < 120.0:
        return f"{seconds:.1f} s"
    if seconds < 7200.0:
        return f"{seconds / 60.0:.1f} min"
    return f"{seconds / 3600.0:,.1f} h"


def instant(text: str) -> str:
    """Date and time as people write them."""
    return text.replace("T", " ").replace("+00:00", " UTC")


def spans(indices: Sequence[int]) -> str:
    """Rising indices, neighbours drawn together: ``0–2, 5``."""
    stretches: list[tuple[int, int]] = []
    for index in indices:
        if stretches and index == stretches[-1][1] + 1:
            stretches[-1] = (stretches[-1][0], index)
        else:
            stretches.append((index, index))
    shown = [f"{a:,}" if a == b else f"{a:,}–{b:,}" for a, b in stretches[:_MOST_SPANS]]
    more = len(stretches) - len(shown)
    return ", ".join(shown) + (f" and {more:,} more places" if more else "")


def beside(value: float, limit: float | None) -> str:
    """All digits before the point, and so many that a number is seen on its side of the limit."""
    least = min(max(4, len(f"{abs(value):.0f}")), 17)
    for digits in range(least, 18):
        text = f"{value:.{digits}g}"
        if limit is None or _side(float(text), limit) == _side(value, limit):
            break
    return plain(float(text))


def _side(value: float, limit: float) -> int:
    return (value > limit) - (value < limit)


def plain(value: float) -> str:
    """A number as it is, thousands grouped."""
    return signed(f"{value:,}".removesuffix(".0"))


def numeric(table: Table) -> tuple[bool, ...]:
    """For each column whether it is one of numbers, to be set to the right."""
    columns = zip(*table.rows, strict=True) if table.rows else [() for _ in table.head]
    return tuple(_numeric(column) for column in columns)


def _numeric(column: Iterable[str]) -> bool:
    """Whether most cells are numbers, and the rest are as short."""
    told = [cell.strip() for cell in column if cell.strip() not in _BLANK]
    others = [cell for cell in told if not _CELL.fullmatch(cell)]
    return 2 * len(others) < len(told) and all(len(cell) <= _SHORT for cell in others)


def grouped(cell: str) -> str:
    """A cell of numbers, thousands grouped."""
    return _LONG.sub(lambda digits: f"{int(digits.group()):,}", cell)


def replay(shown: Shown) -> str:
    """Command that shows a failure again, in the folder of the report; empty if there is none."""
    at, files = shlex.quote(shown.folder), set(shown.failure.files)
    if {"task.toml", "plan.json", "witness.json"} <= files:
        return f"meso-robust simulate {at}/task.toml {at}/plan.json --witness {at}/witness.json"
    if {"task.toml", "certificate.json"} <= files:
        return f"meso-robust check {at}/certificate.json {at}/task.toml"
    return ""


def asked(values: Values) -> list[tuple[str, str]]:
    """The keys of a part as stated, name and kind apart."""
    return [(key, _value(value)) for key, value in values.items() if key not in {"name", "kind"}]


def _value(value: object) -> str:
    if value is None:
        return "not given"
    return value if isinstance(value, str) else json.dumps(value, ensure_ascii=False)
