"""The paper's tables and figures made again, as one HTML page that needs nothing else."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Mapping

from meso_robust.provenance import made_with
from meso_robust.reporting.skeleton import Banner, code, page, versions
from meso_robust.reporting.words import MINUS
from meso_robust.reproduction.document import Made
from meso_robust.reproduction.item import Agreement, Row, Setting, Value
from meso_robust.wording import worded

_MICRO = re.compile(r"\bum\b")
_COUNTED = {
    Agreement.PRINT_CONTAINS: "printed numbers and ranges that contain ours",
    Agreement.OURS_CONTAINS: "contained in our range",
    Agreement.OVERLAPS: "overlap only",
    Agreement.DIFFERS: "differ",
}
_SAID = {
    Agreement.PRINT_CONTAINS: "print contains ours",
    Agreement.OURS_CONTAINS: "ours contains print",
    Agreement.OVERLAPS: "overlaps",
}
_NONE = "–"  # where the paper prints nothing


def reproduction_report(made: Mapping[str, Made], setting: Setting) -> str:
    """One self-contained HTML page on some items: the answers first, then item by item."""
    rows = [row for one in made.values() for row in one.found.rows]
    counts = Counter(row.agreement for row in rows if not row.loose)
    banner = Banner(
        verb="reproduce",
        subject="Automated Assembly for Mesoscale Parts",
        word=_headline(made),
        colour="NEUTRAL",
        meaning="Every number that the paper prints beside ours, with the reason where they differ. "
        "Where the paper leaves out an input, it is named and the result is shown over its range.",
        figures=(
            *((word, str(counts[agreement])) for agreement, word in _COUNTED.items()),
            ("beside a tolerance only", str(sum(row.loose for row in rows))),
            (
                "inputs the paper leaves out",
                str(sum(len(one.found.missing) for one in made.values())),
            ),
            ("seconds", f"{sum(one.seconds for one in made.values()):.0f}"),
        ),
    )
    return page(
        "reproduction.html.j2",
        banner,
        _made(made, setting),
        made_items=tuple(made.values()),
        shown=shown,
        apart=apart,
        worded=worded,
    )


def _made(made: Mapping[str, Made], setting: Setting) -> tuple[tuple[str, str], ...]:
    """How to make the items again."""
    which = f" {next(iter(made))}" if len(made) == 1 else ""
    quick = " --quick" * setting.quick
    return (
        ("to reproduce", code(f"meso-robust reproduce{which}{quick} --seed {setting.seed}")),
        ("the same numbers", code("reproduction.json")),
        versions({**made_with(), "seed": str(setting.seed)}),
    )


def shown(value: Value) -> str:
    """A value as shown in a table."""
    if value is None:
        return _NONE
    if isinstance(value, str):
        return value
    if isinstance(value, tuple):
        return f"{_number(value[0])} … {_number(value[1])}"
    return _number(value)


def apart(row: Row) -> str:
    """The difference as shown in a table; nothing where there is none to tell."""
    if row.difference is None or row.agreement is None:
        return ""
    if row.agreement is not Agreement.DIFFERS:
        same = row.printed == row.ours
        return "equal" if same else _SAID[row.agreement]
    return f"differs by {'+' if row.difference > 0.0 else ''}{_number(row.difference)}"


def _number(value: float) -> str:
    if value == 0.0:
        return "0"
    digits = max(0, 3 - len(str(int(abs(value)))))
    text = f"{value:.{digits}f}" if abs(value) >= 1e-2 else f"{value:.2g}"
    return text.replace("-", MINUS)


def _headline(made: Mapping[str, Made]) -> str:
    if len(made) == 1:
        return next(iter(made.values())).item.title
    return f"{len(made)} items of the paper, made again"
