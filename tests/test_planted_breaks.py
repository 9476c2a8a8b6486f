"""The list of planted breaks fits the code; ``reports/planted_breaks`` runs it."""

from __future__ import annotations

import json
from collections import Counter
from dataclasses import replace

from reports.planted_breaks.__main__ import FOLDER, Result, listed, stale, table


def test_the_list_fits_the_code() -> None:
    assert list(stale(listed())) == []


def test_a_line_that_has_changed_and_a_slow_test_are_told() -> None:
    first = listed()[0]
    gone, slow = replace(first, old="no such line"), replace(first, tests=("tests/blind",))

    assert "stands 0 times" in next(stale([gone]))
    assert "not among the fast tests" in next(stale([slow]))


def test_every_promise_has_breaks_and_each_was_noticed() -> None:
    breaks = listed()
    results = json.loads((FOLDER / "noticed.json").read_text(encoding="utf-8"))

    assert len(breaks) >= 40
    assert len(Counter(item.promise for item in breaks)) >= 20
    assert [b.name for b in breaks if not results.get(b.name, {}).get("noticed_by")] == []
    shown = (FOLDER / "noticed.md").read_text(encoding="utf-8")
    assert shown == table(breaks, {name: Result(**one) for name, one in results.items()})
