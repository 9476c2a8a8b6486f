"""The page of a campaign: verdict first, true to the totals, nothing left out, escaped, self-contained."""

from __future__ import annotations

import math
import re
from dataclasses import replace
from typing import Literal
from xml.etree import ElementTree

import numpy as np
import pytest
from matplotlib.patches import Polygon, Rectangle

from meso_robust.campaigns.answer import Answer, PartAnswer, Shown
from meso_robust.campaigns.document import Campaign
from meso_robust.campaigns.kind import Bars, Coverage, Failure, Part, Paths, Table, Told, View
from meso_robust.campaigns.store import Session, Trouble
from meso_robust.reporting import campaign_words as words
from meso_robust.reporting.campaign import campaign_report
from meso_robust.reporting.campaign_figures import ends_figure, path_figure, scale, strips
from meso_robust.reporting.svg import style
from tests.reporting.test_page import NAMESPACES, Reader

TABLE = Table(
    title="Endings",
    head=("ending", "runs", "share", "code"),
    rows=(("in the goal", "999812", "99.98 %", "a"), ("jammed", "188", "0.02 %", "7")),
    note="exact",
)
BARS = Bars(
    title="Targets",
    unit="of the limit",
    labels=("over", "just under", "half"),
    values=(1.25, 0.99999996, 0.5),
    limit=1.0,
)
COVERAGE = Coverage(
    title="Coverage",
    labels=("friction", "move 2 sensing theta_rad"),
    counts=((0, 10, 50, 100, 200, 400, 20, 20), (3, 3, 3, 3)),
)
PATHS = Paths(
    title="Hardest",
    part_um=((-400.0, -800.0), (400.0, -800.0), (400.0, 800.0), (-400.0, 800.0)),
    goal=(2000.0, 600.0, 90.0),
    tolerance=(75.0, 5.0),
    runs=tuple(
        (f"run {k}", ((0.0, 0.0, 0.0), (1000.0, 300.0, 45.0), (2000.0 + 10.0 * k, 600.0, 90.0)))
        for k in range(8)
    ),
)
WITNESS = {"task.toml": "t", "plan.json": "p", "witness.json": "w"}
SCRIPT = "<script>alert({})</script>"


def told(
    verdict: Literal["held", "broken", "measured"], *views: View, answer: str = "An answer."
) -> Told:
    return Told(verdict=verdict, answer=answer, figures=(("broken claims", "0 of 9"),), views=views)


def part(name: str, what: Told, **changes: object) -> PartAnswer:
    asked = {"name": name, "kind": "falsify", "plan": None, "factor": 1.5, "rare": True}
    given = {
        "part": Part(name=name, kind="falsify", seed=77, confidence=0.99, asked=asked, given={}),
        "unit": "executions",
        "planned": 240,
        "done": 240,
        "runs": 1_200_000,
        "failed": 0,
        "seconds": 96.0,
        "totals": {},
        "told": what,
        "shown": (),
    }
    return PartAnswer(**{**given, **changes})  # type: ignore[arg-type]


def session(**changes: object) -> Session:
    given = {
        "began": "2026-03-01T08:00:00+00:00",
        "ended": "2026-03-01T08:01:00+00:00",
        "crew": "2 processes",
        "machine": "Linux x86_64, 2 cores",
        "runs": 1_200_000,
        "seconds": 60.0,
    }
    return Session(**{**given, **changes})  # type: ignore[arg-type]


def trouble(chunk: int, attempt: int, what: str, given_up: bool = False) -> Trouble:
    at = "2026-03-01T08:00:30+00:00"
    return Trouble(at=at, part="tube", chunk=chunk, attempt=attempt, what=what, given_up=given_up)


def answer(*parts: PartAnswer, **changes: object) -> Answer:
    campaign = Campaign(
        name="nightly",
        seed=5,
        confidence=0.99,
        chunk_limit_s=60.0,
        parts=tuple(one.part for one in parts),
        text='name = "nightly"  # as written',
    )
    given = {"campaign": campaign, "parts": parts, "troubles": (), "sessions": (session(),)}
    return Answer(**{**given, **changes})  # type: ignore[arg-type]


def shown(chunk: int, files: dict[str, str], folder: str = "failures/tube-44-1") -> Shown:
    failure = Failure(what="leaves the box", detail=f"0.6 um too far in {chunk}", files=files)
    return Shown(chunk=chunk, failure=failure, folder=folder if files else "")


@pytest.fixture(scope="module")
def everything() -> Answer:
    """All views, all verdicts, missing chunks, failures, troubles, two sessions."""
    tube = part(
        "tube",
        told("broken", BARS, COVERAGE, PATHS, answer="Move 3 leaves its box by 0.6 um."),
        done=235,
        runs=2_412_345,
        failed=3,
        seconds=155.7,
        shown=(shown(44, WITNESS), shown(45, {})),
    )
    return answer(
        part("rate", told("measured", TABLE)),
        tube,
        part("laws", told("held"), unit="examples", runs=718_243),
        troubles=(
            trouble(4, 1, "its worker died"),
            trouble(4, 2, "its worker died"),
            trouble(4, 3, "MemoryError", given_up=True),
        ),
        sessions=(session(ended=None), session(crew="Dask at tcp://h:1", runs=900, seconds=90.0)),
    )


MISSING = {"tube": (4, 17, 18, 19, 201)}


@pytest.fixture(scope="module")
def page(everything: Answer) -> str:
    return campaign_report(everything, MISSING)


def section(page: str, start: str, end: str) -> str:
    return page[page.index(start) : page.index(end, page.index(start))]


def test_the_page_is_well_formed_and_needs_nothing_else(page: str) -> None:
    reader = Reader(page)
    assert page.startswith("<!DOCTYPE html>")
    assert reader.open == []
    assert len(reader.ids) == len(set(reader.ids))
    assert {target[0] for target in reader.targets} == {"#"}
    assert {target[1:] for target in reader.targets} <= set(reader.ids)
    assert not {"script", "link", "img", "iframe", "image"} & set(reader.tags)
    assert set(re.findall(r'https?://[^\s"<>]*', page)) <= NAMESPACES
    assert "@import" not in page


def test_the_same_answer_gives_the_same_page(everything: Answer, page: str) -> None:
    assert campaign_report(everything, MISSING) == page


def test_the_verdict_comes_first_then_every_part_then_how_it_was_done(page: str) -> None:
    text = page[page.index("<body>") :]
    order = [
        text.index(words)
        for words in (
            "<h1>BROKEN</h1>",
            "Move 3 leaves its box by 0.6 µm.",
            "parts that are broken",
            'id="missing"',
            'id="parts"',
            'id="part-1"',
            'id="part-2"',
            'id="part-3"',
            'id="throughput"',
            'id="troubles"',
            'id="stated"',
            'id="made"',
        )
    ]
    assert order == sorted(order)


@pytest.mark.parametrize(
    ("verdict", "done", "colour", "words"),
    [
        ("held", 240, "PROVED", "HELD"),
        ("broken", 239, "REFUTED", "BROKEN"),
        ("measured", 240, "NEUTRAL", "MEASURED"),
        ("held", 239, "UNKNOWN", "INCOMPLETE"),
    ],
)
def test_the_banner_has_the_verdict_and_its_colour(
    verdict: Literal["held", "broken", "measured"], done: int, colour: str, words: str
) -> None:
    page = campaign_report(answer(part("tube", told(verdict), done=done)))
    assert f'<header class="{colour}">' in page
    assert f"<h1>{words}</h1>" in page
    assert f"<title>{words}: nightly</title>" in page


def test_held_is_not_called_proved() -> None:
    parts = (part("tube", told("held")), part("rate", told("measured"), runs=9))
    text = Reader(campaign_report(answer(*parts))).text
    assert "1 of 2 parts made a claim and looked for what breaks it in 1,200,000 runs" in text
    assert "evidence, not a proof" in text
    alone = Reader(campaign_report(answer(parts[0]))).text
    assert "1 of 1 part made a claim" in alone


def test_the_counts_are_those_given(page: str) -> None:
    rows = section(page, 'id="parts"', "</table>")
    (row,) = [one for one in rows.split("<tr>") if ">tube<" in one]
    assert re.findall(r'<td class="n">([^<]*)</td>', row) == ["2,412,345", "3", "235 of 240"]
    banner = Reader(section(page, "<header", "</header>") + "</header>").text
    # 1,200,000 + 2,412,345 + 718,243 runs; 240 + 235 + 240 of 720 chunks
    assert "runs 4,330,588" in banner
    assert "parts that are broken 1 of 3" in banner
    assert "chunks done 715 of 720" in banner
    # 96 + 155.7 + 96 s of work
    assert "of work, summed over the workers 5.8 min" in banner


def test_throughput_is_runs_over_seconds(page: str) -> None:
    text = Reader(section(page, '<h2 id="throughput">', '<h2 id="troubles">')).text
    # 1,200,900 runs in 150 s
    assert "1,200,900 runs in 2.5 min of 2 sessions: 8,006 runs/s overall." in text
    assert "2026-03-01 08:00:00 UTC killed 2 processes" in text
    assert "1,200,000 60.0 20,000 " in text
    assert "Dask at tcp://h:1" in text
    assert "session 1: 20,000 runs/s" in text
    assert "session 2: 10 runs/s" in text
    # 2,412,345 in 155.7 s of work
    assert "tube 2,412,345 executions 155.7 15,494" in text


def test_one_session_has_nothing_to_be_compared_with() -> None:
    page = campaign_report(answer(part("tube", told("held"))))
    assert "of one session: 20,000 runs/s overall" in Reader(page).text
    assert "by session" not in page


def test_missing_chunks_are_named(page: str, everything: Answer) -> None:
    sentence = "5 of 240 chunks are missing, counted from 0: 4, 17–19, 201."
    assert sentence in Reader(section(page, '<h2 id="missing">', "</ul>")).text
    assert sentence in section(page, 'id="part-2"', "</section>")
    assert "missing" not in section(page, 'id="part-1"', "</section>")
    unnamed = campaign_report(everything)
    assert "5 of 240 chunks are missing." in unnamed
    complete = campaign_report(answer(part("tube", told("held"))))
    assert "are missing" not in complete


def test_failures_are_told_in_full_with_the_command_that_replays_them(page: str) -> None:
    text = Reader(section(page, "<h3>Failures</h3>\n<p>3 of", "<h3>Targets")).text
    assert "3 of 2,412,345 executions failed; 2 are written out." in text
    assert "leaves the box chunk 44 0.6 µm too far in 44" in text
    assert "failures/tube-44-1 : plan.json, task.toml, witness.json" in text
    at = "failures/tube-44-1"
    command = f"meso-robust simulate {at}/task.toml {at}/plan.json --witness {at}/witness.json"
    assert text.count(command) == 1
    assert "0.6 µm too far in 45" in text
    assert "None in 718,243 examples." in section(page, 'id="part-3"', "</section>")


def test_a_certificate_is_replayed_by_the_checker_and_other_files_by_nothing() -> None:
    certificate = shown(1, {"task.toml": "", "certificate.json": ""}, "failures/a b")
    command = "meso-robust check 'failures/a b'/certificate.json 'failures/a b'/task.toml"
    assert words.replay(certificate) == command
    assert words.replay(shown(1, {"example.txt": ""})) == ""


def test_troubles_are_all_listed_or_said_to_be_none(page: str) -> None:
    text = Reader(section(page, '<h2 id="troubles">', '<h2 id="stated">')).text
    assert "3 attempts at a chunk failed; 1 was the last" in text
    assert "tube 4 1 its worker died 2026-03-01 08:00:30 UTC repeated" in text
    assert "tube 4 3 MemoryError 2026-03-01 08:00:30 UTC given up" in text
    quiet = campaign_report(answer(part("tube", told("held"))))
    assert "None: no attempt at a chunk failed." in quiet


def test_of_many_troubles_the_last_are_listed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("meso_robust.reporting.campaign.MOST_TROUBLES", 2)
    found = answer(
        part("tube", told("held")), troubles=tuple(trouble(k, 1, f"died {k}") for k in range(3))
    )
    text = Reader(campaign_report(found)).text
    assert "3 attempts at a chunk failed" in text
    assert "The last 2 of 3." in text
    assert "died 0" not in text
    assert "died 1" in text


def test_what_was_asked_and_what_made_it_is_on_the_page(page: str, everything: Answer) -> None:
    text = Reader(page).text
    assert 'name = "nightly" # as written' in text
    assert "plan not given factor 1.5 rare true seed of the part 77" in text
    assert everything.campaign.hash in text
    assert everything.totals_digest in text
    assert f"numpy {np.__version__}" in text


def test_nothing_that_a_user_or_a_kind_writes_is_run() -> None:
    evil = [SCRIPT.format(k) for k in range(20)]
    views = (
        Table(title=evil[0], head=(evil[1],), rows=((evil[2],),), note=evil[3]),
        Bars(title=evil[4], unit=evil[5], labels=(evil[6],), values=(1.0,), note=evil[7]),
        Coverage(title=evil[8], labels=(evil[9],), counts=((1, 2),), note=evil[10]),
        replace(PATHS, runs=((evil[11], PATHS.runs[0][1]),)),
    )
    failure = Failure(what=evil[12], detail=evil[13], files={evil[14]: ""})
    bad = part(
        evil[15],
        told("broken", *views, answer=evil[16]),
        shown=(Shown(chunk=0, failure=failure, folder="failures/x"),),
    )
    found = answer(bad, troubles=(trouble(0, 1, evil[17]),), sessions=(session(machine=evil[18]),))
    found = replace(found, campaign=replace(found.campaign, name=evil[19], text=evil[19]))
    page = campaign_report(found, {evil[15]: (0,)})
    assert "<script" not in page
    for k in range(20):
        assert f"&lt;script&gt;alert({k})&lt;/script&gt;" in page, k
    assert Reader(page).open == []


def test_columns_of_numbers_stand_to_the_right_with_thousands_grouped(page: str) -> None:
    table = section(page, "<h3>Endings</h3>", "</table>")
    assert '<th>ending</th><th class="n">runs</th><th class="n">share</th><th>code</th>' in table
    assert '<td class="n">999,812</td><td class="n">99.98 %</td><td>a</td>' in table
    assert "exact" in section(page, "</table>", "</section>")


@pytest.mark.parametrize(
    ("column", "right"),
    [
        (("1", "−2.5", "3e-07"), True),
        (("0.1 … 0.2", "—"), True),
        (("12 of 30", "<0.1 %"), True),
        (("3.1 um", "0.2 deg"), True),
        (("[0.1, 0.2] %", "[3, 4] %"), True),
        (("3.1 umbrellas",), False),
        (("2.71e-05 (± 12 %)", "not met", "1e-3"), True),
        (("98.1 % (52/53; 90 … 99 %)", "-"), True),
        (("1", "2", "a sentence about the third"), False),
        (("1", "two"), False),
        (("—", ""), False),
        (("a3f1", "2"), False),
    ],
)
def test_what_a_column_of_numbers_is(column: tuple[str, ...], right: bool) -> None:
    table = Table(title="", head=("x",), rows=tuple((cell,) for cell in column))
    assert words.numeric(table) == (right,)


def test_thousands_are_grouped_in_counts_and_nowhere_else() -> None:
    assert words.grouped("1234 of 56789012") == "1,234 of 56,789,012"
    assert words.grouped("0.12345 to 123 on 2026-03-01, 1,234") == (
        "0.12345 to 123 on 2026-03-01, 1,234"
    )


def test_a_table_without_rows_says_so() -> None:
    empty = Table(title="Objections", head=("a", "b"), rows=())
    assert "no rows" in campaign_report(answer(part("tube", told("held", empty))))


def bars_of(page: str) -> list[ElementTree.Element]:
    drawn = section(page, "<h3>Targets</h3>", "</table>")
    return [ElementTree.fromstring(svg) for svg in re.findall(r"<svg.*?</svg>", drawn)]


def test_bars_are_as_long_as_their_values_and_the_limit_is_where_it_is(page: str) -> None:
    drawn = bars_of(page)
    lengths = [float(bar.find("rect").get("width", "")) for bar in drawn]  # type: ignore[union-attr]
    # the longest, 1.25, has the full width
    np.testing.assert_allclose(lengths, [100.0, 80.0, 40.0], atol=1e-3)
    for bar in drawn:
        (limit,) = [line for line in bar.iter("line") if line.get("class") == "limit"]
        assert limit.get("x1") == limit.get("x2") == "80.000"
    looks = [bar.find("rect").get("class") for bar in drawn]  # type: ignore[union-attr]
    assert looks == ["passes", "bar", "bar"]
    titles = [bar.findtext("title") for bar in drawn]
    assert titles == [
        "over: 1.25 of the limit, beyond the limit",
        "just under: 0.99999996 of the limit",
        "half: 0.5 of the limit",
    ]
    assert section(page, "<h3>Targets", "</table>").count(">beyond<") == 1


def test_negative_bars_go_to_the_left_of_zero() -> None:
    view = Bars(title="", unit="", labels=("a", "b"), values=(-1.0, 3.0))
    found = scale(view)
    assert found.zero == 25.0
    assert found.bars == ((0.0, 25.0), (25.0, 75.0))
    assert found.limit is None
    assert found.passes == (False, False)


def test_bars_that_are_all_zero_have_no_length() -> None:
    assert scale(replace(BARS, values=(0.0,) * 3, limit=None)).bars == ((0.0, 0.0),) * 3


@pytest.mark.parametrize(
    ("value", "limit", "text"),
    [
        (2_412_345.0, None, "2,412,345"),
        (0.123456, None, "0.1235"),
        (0.99999996, 1.0, "0.99999996"),
        (1.00001, 1.0, "1.00001"),
        (1.0, 1.0, "1"),
        (-0.25, 1.0, "−0.25"),
        (12345.678, None, "12,346"),
        (1e20, None, "1e+20"),
    ],
)
def test_a_number_is_seen_on_its_side_of_the_limit(
    value: float, limit: float | None, text: str
) -> None:
    assert words.beside(value, limit) == text


def test_strips_are_shaded_by_the_share_of_each_bin_and_empty_bins_are_marked(page: str) -> None:
    first, second = strips(COVERAGE)
    # an even share of the first is 100 runs
    assert first.shades == ("none", "s1", "s2", "s3", "s4", "s6", "s1", "s1")
    assert second.shades == ("s3",) * 4
    drawn = re.findall(r"<svg.*?</svg>", section(page, "<h3>Coverage</h3>", "</table>"), re.DOTALL)
    svg = ElementTree.fromstring(drawn[-2])
    assert [bar.get("class") for bar in svg.iter("rect")] == list(first.shades)
    told = [bar.findtext("title") for bar in svg.iter("rect")]
    assert told == [f"bin {k} of 8: {n}" for k, n in enumerate(COVERAGE.counts[0], start=1)]
    assert len(list(svg.iter("line"))) == 1
    assert '<td class="n">0</td><td class="n">400</td>' in page


def test_a_quantity_that_was_never_drawn_is_all_empty() -> None:
    (strip,) = strips(Coverage(title="", labels=("x",), counts=((0, 0, 0),)))
    assert strip.shades == ("none",) * 3


def test_a_run_is_drawn_from_its_start_to_its_end_with_the_goal() -> None:
    poses = np.array(PATHS.runs[1][1])
    with style():
        axes = path_figure(PATHS, poses, np.array([[-500.0, -900.0], [3000.0, 1500.0]])).axes[0]
    assert axes.get_aspect() == 1.0
    shapes = [patch.get_xy()[:4] for patch in axes.patches if isinstance(patch, Polygon)]
    # the pose on the way, the goal, the start, the end
    assert len(shapes) == 4
    np.testing.assert_allclose(shapes[2], PATHS.part_um, atol=1e-9)
    # turned by 90 deg: (x, y) goes to (-y, x)
    turned = np.array([(2010.0 - y, 600.0 + x) for x, y in PATHS.part_um])
    np.testing.assert_allclose(shapes[3], turned, atol=1e-9)
    np.testing.assert_allclose(shapes[1], turned - [10.0, 0.0], atol=1e-9)
    np.testing.assert_allclose(np.asarray(axes.lines[0].get_xydata()), poses[:, :2])
    (box,) = [patch for patch in axes.patches if isinstance(patch, Rectangle)]
    assert box.get_bbox().bounds == pytest.approx((1925.0, 525.0, 150.0, 150.0))


def test_ends_are_drawn_beside_the_tolerance_and_those_outside_are_crossed() -> None:
    away = [(0.0, 0.0, 360.0), (1.0, 0.0, 0.0), (0.0, 80.0, -4.0), (60.0, -60.0, -6.0)]
    with style():
        plane, strip = ends_figure(PATHS, np.array(PATHS.goal) + np.array(away)).axes
    assert [line.get_marker() for line in plane.lines] == ["o", "o", "X", "X"]
    marks = np.array([np.asarray(line.get_xydata())[0] for line in plane.lines])
    np.testing.assert_allclose(marks, np.array(away)[:, :2], atol=1e-9)
    turned = [float(np.asarray(line.get_xdata())[0]) for line in strip.lines]
    np.testing.assert_allclose(turned, [0.0, 0.0, -4.0, -6.0], atol=1e-9)
    (box,) = plane.patches
    assert box.get_bbox().bounds == (-75.0, -75.0, 150.0, 150.0)  # type: ignore[attr-defined]
    assert [text.get_text() for text in plane.texts] == ["1, 2", "3", "4"]


def test_of_many_runs_the_first_are_drawn_and_the_rest_is_said(page: str) -> None:
    drawn = section(page, "<h3>Hardest</h3>", "</section>")
    assert re.findall(r"<figure>\n<h3>(.*?)</h3>", drawn) == [
        *[f"{k + 1}. run {k}" for k in range(6)],
        "Where they end",
    ]
    assert "The first 6 of 8 runs." in drawn
    assert drawn.count('<svg role="img"') == 7
    assert not re.search(r"#[0-9a-f]{6}\b", drawn)  # all colours follow the theme


def test_a_way_that_ends_before_the_run_does_is_drawn_as_far_as_it_goes() -> None:
    jammed = ("jams", ((0.0, 0.0, 0.0), (5.0, 5.0, 1.0), (math.nan,) * 3))
    page = campaign_report(answer(part("tube", told("measured", replace(PATHS, runs=(jammed,))))))
    assert "1. jams" in page
    assert "nan" not in section(page, "<h3>Hardest</h3>", "</section>").lower()


def test_no_run_to_draw_is_said() -> None:
    page = campaign_report(answer(part("tube", told("held", replace(PATHS, runs=())))))
    assert "No run to draw." in page


@pytest.mark.parametrize(
    ("indices", "text"),
    [
        ((), ""),
        ((7,), "7"),
        ((0, 1, 2, 5), "0–2, 5"),
        ((999, 1000, 1001), "999–1,001"),
        (tuple(range(0, 84, 2)), ", ".join(map(str, range(0, 80, 2))) + " and 2 more places"),
    ],
)
def test_neighbours_are_drawn_together(indices: tuple[int, ...], text: str) -> None:
    assert words.spans(indices) == text


def test_rates_and_times_in_words() -> None:
    assert words.rate(30_000, 0.5) == "60,000"
    assert words.rate(25, 3.0) == "8.33"
    assert words.rate(25, 0.0) == "—"
    assert words.duration(34.21) == "34.2 s"
    assert words.duration(150.0) == "2.5 min"
    assert words.duration(9000.0) == "2.5 h"


def test_units_are_written_as_people_write_them() -> None:
    assert words.worded("3 um and 4 um^2, 5 um2; sum, um_of") == "3 µm and 4 µm², 5 µm²; sum, um_of"
