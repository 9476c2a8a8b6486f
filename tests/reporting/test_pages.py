"""The builder of all pages: what is left out is said, what a user wrote is escaped, boxes have names."""

from __future__ import annotations

from markupsafe import Markup

from meso_robust.reporting import pages
from tests.reporting.test_page import Reader

EVIL = "<b>&"
BANNER = pages.Banner(verb="plan", subject=EVIL, word="PROVED", colour="PROVED", meaning=EVIL)


def test_cells_are_escaped_and_set_by_their_column() -> None:
    table = pages.table(EVIL, "name | #µm | ~place", [(EVIL, 3, Markup("<i>x</i>"))])
    assert '<thead><tr><th>name</th><th class="n">µm</th><th>place</th></tr></thead>' in table
    row = '<th>&lt;b&gt;&amp;</th><td class="n">3</td><td class="nowrap"><i>x</i></td>'
    assert f"<tr>{row}</tr>" in table
    assert 'aria-label="&lt;b&gt;&amp;"' in table
    assert Reader(table).open == []


def test_a_table_without_heads_or_names_has_none() -> None:
    table = pages.table("t", " | ", [("a", "b")], named=False)
    assert "<th" not in table
    assert "<tr><td>a</td><td>b</td></tr>" in table


def test_what_is_left_out_of_a_table_or_list_is_said() -> None:
    said = "The first 2 of 3; all are in <code>all.json</code>."
    for part in (
        pages.table("t", "a", [("1",), ("2",), ("3",)], most=2, file="all.json"),
        pages.bullets(["1", "2", "3"], most=2, file="all.json"),
    ):
        assert said in part
        assert ">2<" in part
        assert ">3<" not in part
    assert "all stand" not in pages.table("t", "a", [("1",)], most=1, file="all.json")


def test_sections_are_listed_by_title_by_link_or_not_at_all_and_boxes_are_named() -> None:
    made = pages.made("meso-robust plan", using={"meso-robust": "1"})
    sections = (
        pages.Section("a", EVIL, ()),
        pages.Section("b", "Long title", (pages.html("<p>{}</p>", EVIL),), link="Short"),
        pages.Section("c", "Hidden", (), link="", look="notice"),
    )
    page = pages.page(pages.Report(banner=BANNER, sections=sections, made=made))
    links = '<a href="#a">&lt;b&gt;&amp;</a><a href="#b">Short</a><a href="#made">'
    assert links in page
    assert '<h2 id="b">Long title</h2>\n<p>&lt;b&gt;&amp;</p>' in page
    assert '<section class="notice" aria-labelledby="c">\n<h2 id="c">Hidden</h2>' in page
    assert page.count("<section") == 1
    assert "<b>&" not in page
    assert Reader(page).open == []


def test_only_a_page_that_says_so_may_run_scripts() -> None:
    for scripted in (False, True):
        made = pages.made("meso-robust plan", using={})
        page = pages.page(pages.Report(banner=BANNER, sections=(), made=made, scripted=scripted))
        assert ("script-src" in page) == scripted
