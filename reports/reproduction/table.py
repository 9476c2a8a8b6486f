"""Printed numbers beside ours, as text: ``python -m reports.reproduction.table``.

Reads the ``reproduction.json`` that ``meso-robust reproduce --out reports/reproduction`` wrote, and
writes ``printed_and_ours.md`` beside it.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from meso_robust.files import write_all
from meso_robust.reproduction.item import Row
from meso_robust.reproduction.page import apart, shown
from meso_robust.wording import worded

HERE = Path(__file__).parent


def page(document: dict[str, Any]) -> str:
    """Every item: its answer, and its rows."""
    lines = [
        "# The paper's tables and figures, made again",
        "",
        "Commands: `meso-robust reproduce --out reports/reproduction`, which also makes the page with the "
        "pictures, then `python -m reports.reproduction.table`. Where the paper prints a range, the "
        "difference is that from its nearer end.",
    ]
    for item in document["items"].values():
        lines += ["", f"## {item['title']}", "", f"{item['where']}. {worded(item['answer'])}", ""]
        lines += [*_table(item["rows"])]
    return "\n".join(lines) + "\n"


def _table(rows: list[dict[str, Any]]) -> Iterator[str]:
    yield "| quantity | printed | ours | difference | unit | why |"
    yield "|---|--:|--:|--:|---|---|"
    for values in rows:
        row = Row(
            quantity=values["quantity"],
            unit=values["unit"],
            printed=_value(values["printed"]),
            ours=_value(values["ours"]),
            why=values["why"],
        )
        words = (worded(text).replace("|", "\\|") for text in (row.quantity, row.unit, row.why))
        quantity, unit, why = words
        yield f"| {quantity} | {shown(row.printed)} | {shown(row.ours)} | {apart(row)} | {unit} | {why} |"


def _value(value: Any) -> Any:
    return tuple(value) if isinstance(value, list) else value


def main() -> None:
    """Write the page."""
    document = json.loads((HERE / "reproduction.json").read_text(encoding="utf-8"))
    write_all(HERE, {"printed_and_ours.md": page(document)})


if __name__ == "__main__":
    main()
