"""Direct tests on a page: what they find, and the pictures that show it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from markupsafe import Markup

from meso_robust.recordings.direct.balance import BalanceTest
from meso_robust.recordings.direct.clocks import ClockTest
from meso_robust.recordings.direct.document import finding_words
from meso_robust.recordings.direct.gap import GapTest
from meso_robust.recordings.direct.hand import HandTest
from meso_robust.recordings.direct.run import DirectTests
from meso_robust.recordings.direct.trends import Trend
from meso_robust.recordings.rules import UM
from meso_robust.reporting import pages
from meso_robust.reporting.plot import Area, limits, picture
from meso_robust.reporting.theme import BLUE, ORANGE
from meso_robust.types import Floats, Ints

_MS = 1e-3
_MOST = 1500  # dots of one picture
_TRENDS = 5
_CLOCKS = 12
_SHARE = 0.005  # of the values at either end that a picture does not make room for


def direct_section(tests: DirectTests) -> pages.Section:
    """What the tests without a simulation show.

    Parameters
    ----------
    tests
        Of a set.

    Returns
    -------
    pages.Section
        Findings, pictures of the residuals before and after, trends and clocks.
    """
    words = (
        "<p>These tests ask no simulation and hold whatever is wrong with the geometry. A part that moves "
        "is touched, so the gap between tip and face should be zero; in the frame of a hand of two tips "
        "the part should stand still; and while one tip pushes, moment over turn is one ratio for every "
        "friction; a part at rest should not sway. Intervals are of 90 %, p-values by the signs of whole recordings "
        "(of a sway: by the order of frames).</p>"
    )
    found = [finding_words(one) for one in tests.findings]
    pictures = [
        _residuals(name, caption, test)
        for name, caption, test in (
            ("Gap between tip and face", "tip to face, while the part moves", tests.gap),
            ("Part in the frame of the hand", "less its mean in every push", tests.hand),
            ("Error of the lever arm", "moment over force less the ratio of drags", tests.balance),
        )
        if test is not None
    ]
    clocks = [one for one in tests.clocks if one.stamps_at_fault or one.late] or list(tests.clocks)
    return pages.Section(
        "direct",
        "Direct tests",
        (
            pages.html(words),
            pages.bullets(found, most=50, file="summary.json")
            if found
            else pages.html("<p>They find nothing.</p>"),
            *([pages.figure(*pictures)] if pictures else []),
            *_trends("What is left of the gap", tests.gap_trends),
            *_trends("What is left of the lever arm", tests.balance_trends),
            *([_clock_table(clocks[:_CLOCKS])] if clocks else []),
        ),
    )


def _residuals(name: str, caption: str, test: GapTest | HandTest | BalanceTest) -> pages.Figure:
    before, after = (value / UM for value in test.rms)
    return pages.Figure(
        svg=_dots(name, test.recording, test.before / UM, test.after / UM),
        title=name,
        caption=f"{caption}, by recording: as recorded (orange, {before:.3g} µm) and with what was found "
        f"taken out (blue, {after:.3g} µm).",
    )


def _dots(name: str, recording: Ints, before: Floats, after: Floats) -> Markup:
    kept = np.linspace(0, before.size - 1, min(before.size, _MOST)).round().astype(int)
    both = np.concatenate((before, after))
    low, high = np.quantile(both, [_SHARE, 1.0 - _SHARE])
    y = limits(np.array([low, high, 0.0]))
    # frames of a recording side by side, in their order
    rank = np.concatenate(
        [np.linspace(-0.4, 0.4, int(np.sum(recording == k))) for k in np.unique(recording)]
    )
    order = np.argsort(recording, kind="stable")
    x = np.empty(recording.size)
    x[order] = recording[order] + rank
    area = Area(60.0, 8.0, 760.0, 160.0, (-0.6, float(recording.max(initial=0)) + 0.6), y)
    clip = [np.clip(values[kept], *y) for values in (before, after)]
    return picture(
        835.0,
        205.0,
        name,
        [
            area.frame("recording", "µm"),
            area.dots(x[kept], clip[0], ORANGE, 1.3),
            area.dots(x[kept], clip[1], BLUE, 1.3),
        ],
    )


def _trends(label: str, trends: Sequence[Trend]) -> list[Markup]:
    rows = [
        (one.covariate, f"{one.correlation:.2f}", f"{one.p_value:.3g}") for one in trends[:_TRENDS]
    ]
    return (
        [pages.table(label, f"{label.lower()}, against | #correlation | #p", rows)] if rows else []
    )


def _clock_table(clocks: Sequence[ClockTest]) -> Markup:
    rows = [
        (
            f"{one.file}, {one.name}",
            f"{one.period / _MS:.4g}",
            f"{one.jitter / _MS:.2g}",
            str(one.lost),
            str(len(one.late)),
            _rough(one),
        )
        for one in clocks
    ]
    heads = (
        "stream | #period, ms | #jitter, ms | #lost | #late | off even travel by its stamps → by a regular "
        "clock, µm"
    )
    return pages.table("Clocks", heads, rows)


def _rough(one: ClockTest) -> str:
    if not np.isfinite(one.rough):
        return "—"
    return f"{one.rough / UM:.3g} → {one.rough_regular / UM:.3g}"
