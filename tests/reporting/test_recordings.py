"""The page on a recording set: verdict first, escaped, self-contained, the same every time."""

from __future__ import annotations

import re
from dataclasses import replace
from xml.etree import ElementTree

import numpy as np
import pytest

from meso_robust.recordings import RecordingSet
from meso_robust.recordings.direct.document import words
from meso_robust.recordings.direct.run import direct_tests
from meso_robust.recordings.phases import phases
from meso_robust.recordings.problems import problems
from meso_robust.recordings.repair import Repair
from meso_robust.recordings.summary import Checked
from meso_robust.reporting.recording_figures import recording_svg
from meso_robust.reporting.recordings import recordings_report
from meso_robust.reporting.theme import BLUE, BLUE_FILL, ORANGE, PURPLE
from tests.recordings.planted import FRAMES, MIDDLE, UM, clean, one, planted, poses
from tests.reporting.test_page import Reader


def checked(recordings: RecordingSet, **changes: object) -> Checked:
    found = problems(recordings)
    given = {
        "source": "a <b> & 'c'",
        "format": "set",
        "recordings": recordings,
        "found": found,
        "repairs": (),
        "remaining": found,
    }
    return Checked(**{**given, **changes})  # type: ignore[arg-type]


@pytest.fixture(scope="module")
def troubled() -> Checked:
    """Zeros, and a repair and a note with signs that HTML must not see."""
    changed = poses()
    changed[[50, 51]] = 0.0
    recordings = planted(poses=changed)
    repair = Repair(file="x<script>.csv", kind="clock", rows=(7,), done="left <out>")
    return checked(recordings, repairs=(repair,), notes=("assumed <i>this</i>",))


@pytest.fixture(scope="module")
def page(troubled: Checked) -> str:
    return recordings_report(troubled)


def test_the_verdict_comes_first_and_problems_before_pictures(page: str) -> None:
    reader = Reader(page)
    assert reader.open == []
    text = page[page.index("<body>") :]
    order = [
        text.index(part)
        for part in (
            "NOT USABLE AS IT IS",
            "pose of zeros",
            "left &lt;out&gt;",
            'id="noise"',
            "<svg",
        )
    ]
    assert order == sorted(order)
    assert "lines 52-53" in text


def test_words_from_files_are_escaped(page: str) -> None:
    assert "<script" not in page
    assert "x&lt;script&gt;.csv, line 7" in page
    assert "assumed &lt;i&gt;this&lt;/i&gt;" in page
    assert "a &lt;b&gt; &amp; &#39;c&#39;" in page


def test_the_page_needs_nothing_else_and_is_the_same_every_time(
    troubled: Checked, page: str
) -> None:
    assert not re.search(r'(src|href)="(?!#)', page)
    assert "@import" not in page
    assert not re.search(r"url\((?!#)", page)
    ids = re.findall(r'\bid="([^"]*)"', page)
    assert len(ids) == len(set(ids))
    assert recordings_report(troubled) == page


def test_a_clean_set_says_so() -> None:
    text = recordings_report(checked(clean(recordings=(one(MIDDLE, seed=1),))))
    assert '<header class="PROVED">' in text
    assert "<h1>CLEAN</h1>" in text
    assert "None was needed." in text


def test_of_many_recordings_those_with_problems_are_drawn(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr("meso_robust.reporting.recordings.MOST_PICTURES", 2)
    many = [one(f"push_{k:02d}.csv", seed=k) for k in range(4)]
    changed = many[-1].poses.copy()
    changed[50] = 0.0
    many[-1] = replace(many[-1], poses=changed)
    text = recordings_report(checked(clean(recordings=tuple(many))))
    assert re.findall(r'<h3>(.*)</h3>\n<div class="scroll[^>]*><svg', text) == [
        many[0].file,
        many[-1].file,
    ]
    assert "2 of 4 recordings are drawn" in text


def test_the_drawing_shows_the_path_to_scale_the_marks_and_the_holes() -> None:
    quiet = one(MIDDLE, noise=0.0)
    hidden = quiet.poses.copy()
    hidden[100:110] = np.nan
    hidden[60, 1] += 100 * UM
    quiet = replace(quiet, poses=hidden)
    recordings = clean(recordings=(quiet,))

    shown = phases(recordings, quiet)
    svg = ElementTree.fromstring(recording_svg(recordings, quiet, frozenset({60}), shown, "a <b>"))

    tag = "{http://www.w3.org/2000/svg}"
    assert svg.findtext(f"{tag}title") == "a <b>"
    paths = [path.attrib for path in svg.iter(f"{tag}path")]
    # the part as it begins: 800 um wide and 1600 um high, at one scale
    (first,) = [path for path in paths if "stroke-dasharray" in path]
    corners = np.array([pair.split() for pair in first["d"][1:].split("L")], dtype=float)[:4]
    width, height = np.ptp(corners, axis=0)
    assert height / width == pytest.approx(2.0, rel=1e-3)
    # 100 um off in y, seen at the same scale in the plane; and in the three rows
    marks = [circle.attrib for circle in svg.iter(f"{tag}circle") if circle.get("fill") == PURPLE]
    assert len(marks) == 4
    left = corners[:, 0].mean()
    plane = [mark for mark in marks if float(mark["cx"]) < 400.0]
    assert len(plane) == 1
    assert float(plane[0]["cx"]) == pytest.approx(left, abs=0.05)
    above = corners[:, 1].mean() - float(plane[0]["cy"])
    assert above == pytest.approx(width * 100.0 / 800.0, abs=0.05)
    # the line of x over time is broken where nothing was seen
    (x_row, *_) = [p for p in paths if p["stroke"] == BLUE and float(p["d"][1:].split()[0]) > 400]
    pieces = x_row["d"][1:].split("M")
    assert [len(piece.split("L")) for piece in pieces] == [100, FRAMES - 110]
    spans = [r.attrib for r in svg.iter(f"{tag}rect") if r.get("fill") in {BLUE_FILL, ORANGE}]
    assert len(spans) == 6  # contact and one hole in each row


def test_nothing_seen_can_be_drawn() -> None:
    blind = replace(one(MIDDLE), poses=np.full((FRAMES, 3), np.nan))
    recordings = clean(recordings=(blind,))
    assert "<svg" in recordings_report(checked(recordings))


def test_direct_tests_stand_on_the_page_with_their_pictures() -> None:
    rng = np.random.default_rng(0)
    recordings = tuple(
        replace(
            each,
            poses=each.poses + [30 * UM, -20 * UM, 0.0] + 1e-8 * rng.normal(size=each.poses.shape),
        )
        for each in (
            one(f"push_{k:02d}.csv", k, start=(2700 * UM, -30 * UM, angle))
            for k, angle in enumerate(np.tile([0.0, np.pi / 2], 6).tolist())
        )
    )
    tests = direct_tests(clean(recordings=recordings))
    assert tests.gap is not None
    made = checked(clean(recordings=recordings), direct=tests)
    reader = Reader(recordings_report(made))
    assert reader.open == []
    assert "Direct tests" in reader.text
    assert "Gap between tip and face" in reader.text
    for line in words(tests):
        assert line.removeprefix("as if ") in reader.text
    # all are pushed along +x: a shift and a radius look the same, and the page says which it takes
    assert abs(tests.gap.rms[0] - 30e-6) < 2e-6
    assert tests.gap.rms[1] < 3e-6
