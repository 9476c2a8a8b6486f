"""The paper's tables and figures made again, as one HTML page that needs nothing else."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Mapping
from dataclasses import replace

from markupsafe import Markup

from meso_robust.provenance import made_with
from meso_robust.reporting import pages
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


def reproduction_report(made_items: Mapping[str, Made], setting: Setting) -> str:
    """One self-contained HTML page on some items: the answers first, then item by item.

    Parameters
    ----------
    made_items, setting
        The items by name, and what they were made with.

    Returns
    -------
    str
        The page; it asks for nothing from outside.
    """
    rows = [row for one in made_items.values() for row in one.found.rows]
    counts = Counter(row.agreement for row in rows if not row.loose)
    banner = pages.Banner(
        verb="reproduce",
        subject="Automated Assembly for Mesoscale Parts",
        word=_headline(made_items),
        colour="NEUTRAL",
        meaning="Every number that the paper prints beside ours, with the reason where they differ. "
        "Where the paper leaves out an input, it is named and the result is shown over its range.",
        figures=(
            *((word, str(counts[agreement])) for agreement, word in _COUNTED.items()),
            ("beside a tolerance only", str(sum(row.loose for row in rows))),
            (
                "inputs the paper leaves out",
                str(sum(len(one.found.missing) for one in made_items.values())),
            ),
            ("seconds", f"{sum(one.seconds for one in made_items.values()):.0f}"),
        ),
    )
    which = f" {next(iter(made_items))}" if len(made_items) == 1 else ""
    quick = " --quick" * setting.quick
    return pages.page(
        pages.Report(
            banner=banner,
            sections=(
                *[_answers(made_items)] * (len(made_items) > 1),
                *(_section(item) for item in made_items.values()),
            ),
            made=pages.made(
                f"meso-robust reproduce{which}{quick} --seed {setting.seed}",
                ("the same numbers", pages.code("reproduction.json")),
                using={**made_with(), "seed": str(setting.seed)},
            ),
        )
    )


def _answers(made_items: Mapping[str, Made]) -> pages.Section:
    rows = [
        (
            Markup('<a href="#{}">{}</a>').format(name, each.item.title),
            each.item.where,
            worded(each.found.answer),
        )
        for name, each in made_items.items()
    ]
    body = pages.table("Answers", "item | in the paper | what came of it", rows)
    return pages.Section("answers", "Answers", (body,))


def _section(item: Made) -> pages.Section:
    heads = "quantity | #printed | #ours | #difference | unit | why"
    rows = [
        (
            worded(row.quantity),
            shown(row.printed),
            shown(row.ours),
            apart(row),
            worded(row.unit),
            worded(row.why),
        )
        for row in item.found.rows
    ]
    head = (
        '<p class="muted">{} · <code>meso-robust reproduce {}</code> · {:.1f} s</p>\n'
        "<p><strong>{}</strong></p>"
    )
    body = [
        pages.html(head, item.item.where, item.name, item.seconds, worded(item.found.answer)),
        pages.table(f"Numbers of {item.item.title}", heads, rows, look="roomy"),
    ]
    if item.found.missing:
        texts = pages.bullets([worded(text) for text in item.found.missing])
        summary = "What the paper leaves out, and what was taken"
        body.append(pages.html("<details open><summary>{}</summary>\n{}</details>", summary, texts))
    pictures = (
        replace(each, caption=worded(each.caption), look="bounded") for each in item.found.figures
    )
    body.append(pages.figure(*pictures))
    return pages.Section(item.name, item.item.title, body)


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
