"""Rows, the document, the page and the verb, on items of their own and on the smallest of the real."""

from __future__ import annotations

import json
import math
import re
from dataclasses import replace
from pathlib import Path

import pytest
from markupsafe import Markup
from typer.testing import CliRunner

from meso_robust.cli import app
from meso_robust.errors import InputError
from meso_robust.reporting.pages import Figure
from meso_robust.reproduction.document import Made, document, text
from meso_robust.reproduction.item import Found, Item, Row, Setting, Value
from meso_robust.reproduction.items import ITEMS, asked, item
from meso_robust.reproduction.page import apart, reproduction_report, shown
from meso_robust.wording import worded

RUNNER = CliRunner()


@pytest.mark.parametrize(
    ("printed", "ours", "difference", "said"),
    [
        (11.0, 13.5, 2.5, "differs by +2.50"),
        (11.0, 11.0, 0.0, "equal"),
        ((30.0, 40.0), 35.0, 0.0, "print contains ours"),
        ((30.0, 40.0), (32.0, 40.0), 0.0, "print contains ours"),
        ((30.0, 40.0), (10.0, 22.0), -8.0, "differs by −8.00"),
        ((30.0, 40.0), (38.0, 90.0), 0.0, "overlaps"),
        ((30.0, 40.0), (0.0, 90.0), 0.0, "ours contains print"),
        (20.0, (12.0, 30.0), 0.0, "ours contains print"),
        (None, 3.0, None, ""),
        ("similar", 3.0, None, ""),
    ],
)
def test_differences_are_those_of_numbers_and_ranges(
    printed: Value, ours: Value, difference: float | None, said: str
) -> None:
    row = Row(quantity="q", printed=printed, ours=ours, why="w")
    assert row.difference == difference
    assert apart(row) == said


def test_a_difference_needs_a_reason() -> None:
    with pytest.raises(ValueError, match="net y: differs from the print; say why"):
        Row(quantity="net y", printed=(18.0, 20.0), ours=11.0)


def test_the_page_counts_what_contains_what_and_tolerances_apart() -> None:
    pairs: list[tuple[Value, Value]] = [
        ((0.0, 9.0), 1.0), ((0.0, 9.0), 2.0), (1.0, (0.0, 2.0)), ((0.0, 2.0), (1.0, 3.0)), (1.0, 2.0)
    ]  # fmt: skip
    rows = [Row(quantity="q", printed=one, ours=other, why="w") for one, other in pairs]
    rows += [Row(quantity="q", printed=(-76.0, 76.0), ours=(-5.0, 5.0), loose=True)]
    (one,) = made().values()
    page = reproduction_report(
        {"one": replace(one, found=replace(one.found, rows=tuple(rows)))}, Setting()
    )
    facts = dict(re.findall(r"<dt>([^<]*)</dt><dd[^>]*>([^<]*)</dd>", page))
    assert facts["printed numbers and ranges that contain ours"] == "2"
    assert facts["contained in our range"] == "1"
    assert facts["overlap only"] == "1"
    assert facts["differ"] == "1"
    assert facts["beside a tolerance only"] == "1"


def test_values_are_shown_with_three_digits_and_a_real_minus() -> None:
    assert shown(-1234.5) == "−1234"
    assert shown((0.05, 12.345)) == "0.05 … 12.3"
    assert shown(0.0001234) == "0.00012"
    assert shown(None) == "–"
    assert shown("jams") == "jams"


def made() -> dict[str, Made]:
    found = Found(
        answer="It <b>stands</b>.",
        rows=(Row(quantity="net y", unit="um", printed=(18.0, 20.0), ours=11.0, why="a & b"),),
        missing=("the tip spacing",),
        figures=(Figure(svg=Markup("<svg><title>f</title></svg>"), caption="a picture"),),
        data={"y_um": [1.0, 2.0], "after_a_jam": ({"x_um": math.nan},)},
    )
    one = Item(title="Table III", where="Section X-C", run=lambda _: found)
    return {"one": Made(name="one", item=one, found=found, seconds=1.25)}


def test_the_document_holds_every_row_with_its_difference() -> None:
    found = json.loads(text(document(made(), Setting(seed=3, quick=True))))
    assert found["schema"] == "meso-robust/reproduction/1"
    assert (found["seed"], found["quick"]) == (3, True)
    row = found["items"]["one"]["rows"][0]
    assert (row["printed"], row["ours"], row["difference"]) == ([18.0, 20.0], 11.0, -7.0)
    assert row["agreement"] == "differs"
    data = found["items"]["one"]["data"]
    assert data == {"y_um": [1.0, 2.0], "after_a_jam": [{"x_um": None}]}


def test_only_the_unit_is_reworded() -> None:
    assert worded("5 um, sum of 3 um/s") == "5 µm, sum of 3 µm/s"


def test_a_number_that_is_none_is_not_written() -> None:
    with pytest.raises(ValueError, match="JSON compliant"):
        text({"x": float("nan")})


def test_the_page_leads_with_the_answers_and_escapes_words() -> None:
    page = reproduction_report(made(), Setting())
    assert "It &lt;b&gt;stands&lt;/b&gt;." in page
    assert "a &amp; b" in page
    assert "<svg><title>f</title></svg>" in page
    assert "µm" in page  # the unit of the row, stated as um
    assert 'id="answers"' not in page  # of one item only
    two = made() | {"two": made()["one"]}
    both = reproduction_report(two, Setting())
    assert both.index('id="answers"') < both.index('id="one"')
    assert "the tip spacing" in page
    assert "<script" not in page
    assert "http" not in page.replace("http://www.w3.org", "").replace("http-equiv", "")


@pytest.mark.parametrize("name", ITEMS)
def test_every_item_has_a_file_with_a_title_and_a_place(name: str) -> None:
    one = item(name)
    assert one.title
    assert one.where


def test_an_item_that_is_none_is_refused_with_a_list() -> None:
    with pytest.raises(InputError, match=r"ITEM: 'table-9'; must be one of tests, sensitivity"):
        asked("table-9")
    answer = RUNNER.invoke(app, ["reproduce", "table-9"])
    assert answer.exit_code == 2


def test_one_item_is_written_beside_its_data(tmp_path: Path) -> None:
    out = tmp_path / "out"
    answer = RUNNER.invoke(app, ["reproduce", "table-1", "--quick", "--out", str(out), "--quiet"])
    assert answer.exit_code == 0, answer.output
    found = json.loads((out / "reproduction.json").read_text(encoding="utf-8"))
    assert list(found["items"]) == ["table-1"]
    assert found["items"]["table-1"]["rows"]
    page = (out / "index.html").read_text(encoding="utf-8")
    assert found["items"]["table-1"]["answer"].split(".")[0][:40] in page
    assert sorted(path.name for path in out.iterdir()) == ["index.html", "reproduction.json"]


def test_the_same_seed_gives_the_same_rows() -> None:
    def rows(seed: int) -> tuple[Row, ...]:
        return item("tables-3-5").run(Setting(quick=True, seed=seed)).rows

    assert rows(1) == rows(1)
    assert rows(1) != rows(2)
