"""The page on a recording set: verdict first, escaped, self-contained, the same every time."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest

from meso_robust.recordings import RecordingSet
from meso_robust.recordings.phases import phases
from meso_robust.recordings.problems import problems
from meso_robust.recordings.repair import Repair
from meso_robust.recordings.summary import Checked
from meso_robust.reporting.recording_figures import recording_figure
from meso_robust.reporting.recordings import recordings_report
from meso_robust.reporting.svg import style
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
    with style():
        figure = recording_figure(recordings, quiet, frozenset({60}), phases(recordings, quiet))
        plane, *rows = figure.axes
        assert plane.get_aspect() == 1.0
        (mark,) = [line for line in plane.lines if line.get_marker() == "o"]
        assert np.allclose(np.asarray(mark.get_xydata()), [[2700.0, 70.0]], atol=1e-9)
        first = plane.patches[-2].get_xy()[:4]  # type: ignore[attr-defined]
        np.testing.assert_allclose(np.ptp(first, axis=0), [800.0, 1600.0], atol=1e-6)
        assert len(rows) == 3
        x = np.asarray(rows[0].lines[0].get_ydata(), dtype=np.float64)
        assert np.flatnonzero(np.isnan(x)).tolist() == list(range(100, 110))
        assert len(x) == FRAMES
        spans = [patch.get_extents().width for patch in rows[0].patches]
        assert len(spans) == 2  # contact and one hole


def test_nothing_seen_can_be_drawn() -> None:
    blind = replace(one(MIDDLE), poses=np.full((FRAMES, 3), np.nan))
    recordings = clean(recordings=(blind,))
    assert "<svg" in recordings_report(checked(recordings))
