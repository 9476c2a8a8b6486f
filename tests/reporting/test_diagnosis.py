"""The page of a diagnosis: answer first, true to the document, escaped, self-contained."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import matplotlib
import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import to_hex
from matplotlib.figure import Figure
from matplotlib.patches import PathPatch, Rectangle

from meso_robust.diagnosis.document import Channel, Verdict
from meso_robust.diagnosis.evidence import Evidence
from meso_robust.reporting import diagnosis_figures as figures
from meso_robust.reporting.diagnosis import diagnosis_report
from meso_robust.reporting.diagnosis_words import answer, stage_words, summary
from meso_robust.reporting.svg import style
from meso_robust.reporting.theme import BAND, SHADES, STAGES
from meso_robust.types import Floats
from tests.reporting.diagnoses import EXTRAPOLATION, NAMES, SPANS, document, evidence
from tests.reporting.test_page import Reader

VERDICTS: tuple[Verdict, ...] = ("consistent", "named", "partial", "ambiguous", "unknown")
SOURCE = "sets/<a>&'b'"


@pytest.fixture(scope="module")
def pages() -> dict[Verdict, str]:
    return {verdict: made(verdict) for verdict in VERDICTS}


def made(verdict: Verdict) -> str:
    """The page of a verdict, with one recording drawn on the one that has most to show."""
    with pytest.MonkeyPatch.context() as patch:
        drawn = int(verdict == "named")
        patch.setattr("meso_robust.reporting.diagnosis.MOST_PICTURES", drawn)
        return diagnosis_report(document(verdict), evidence(verdict), SOURCE)


@pytest.fixture
def _no_overlays(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("meso_robust.reporting.diagnosis.MOST_PICTURES", 0)


@pytest.fixture(autouse=True)
def _style() -> Iterator[None]:
    with style():
        yield


@pytest.mark.parametrize("verdict", VERDICTS)
def test_every_page_is_well_formed_and_needs_nothing_else(
    pages: dict[Verdict, str], verdict: Verdict
) -> None:
    page = pages[verdict]
    reader = Reader(page)
    assert page.startswith("<!DOCTYPE html>")
    assert reader.open == []
    assert len(reader.ids) == len(set(reader.ids))
    assert all(target.startswith("#") for target in reader.targets)
    assert {target[1:] for target in reader.targets} <= set(reader.ids)
    assert "@import" not in page
    assert "<script" not in page
    assert len(page.encode()) < 1_500_000


@pytest.mark.parametrize("verdict", VERDICTS)
def test_the_answer_comes_first(pages: dict[Verdict, str], verdict: Verdict) -> None:
    body = pages[verdict][pages[verdict].index("<body>") :]
    parts = (f"<h1>{verdict.upper()}</h1>", f"The reason of {verdict} &lt;in", 'id="answer"')
    order = [body.index(part) for part in (*parts, "<svg", 'id="limits"', 'id="made"')]
    assert order == sorted(order)
    assert body.index("0.52 µm and 0.031°") < body.index("The reason of")


def test_no_page_speaks_of_a_floor_that_a_model_can_go_below(pages: dict[Verdict, str]) -> None:
    """A model leaves less than the noise where it absorbs the systematic part of it."""
    assert any("noise: repeatability and systematic error" in page for page in pages.values())
    for page in pages.values():
        assert "noise floor" not in page
        assert "any law could reach" not in page


LEFT = "0.52 µm and 0.031° are left unexplained, most of it y with one tip"


def test_the_answer_is_one_sentence_that_a_laboratory_can_act_on() -> None:
    dry = "dry_friction (support): ratio 0.21 [0.18, 0.24]"
    next_one = "next: push faster <225>"
    assert answer(document("named")) == (
        f"{dry} explains 93 % [87, 98] of an error of 5.21 µm; {LEFT}; {next_one}"
    )
    assert answer(document("partial")) == (
        f"{dry} explains 55 % [49, 60] of an error of 5.21 µm; {LEFT}; {next_one}"
    )
    assert answer(document("consistent")) == (
        "rho_um2 376900 [371000, 383000] µm², mu 0.331 [0.32, 0.343]; predictions are off by "
        "0.52 µm and 0.031°; 0.74 µm matter"
    )
    assert answer(document("ambiguous")) == (
        "body_force or film_flow or camera_drift + backlash explains 90 % [84, 95] of an error of "
        f"5.21 µm; {LEFT}; {next_one}"
    )
    assert answer(document("unknown")) == (
        "no effect of the catalogue explains it; it is most likely a matter of what tip and part do where they touch; "
        "largest in a<b>&$x$_0.csv at 1.70–4.20 s (one tip): "
        f"θ, 12.3 σ, grows with <speed>; {LEFT}; {next_one}"
    )


@pytest.mark.parametrize(
    ("stage", "sway", "shakes"),
    [("observation", 0.5, True), ("observation", 0.35, False), ("actuation", 0.5, False)],
)
def test_an_image_that_shakes_is_what_is_wrong(
    stage: Channel, sway: float, *, shakes: bool
) -> None:
    found = document("unknown")
    assert found.remainder is not None
    said = answer(
        found.model_copy(
            update={
                "remainder": found.remainder.model_copy(update={"stage": stage}),
                "noise": found.noise.model_copy(update={"sway_um": sway, "sway_hz": 2.6}),
            }
        )
    )
    shaken = (
        "no effect of the catalogue explains it; the image sways by 0.5 µm at 2.6 Hz, with a part at rest; "
        f"{LEFT}; next: keep the camera, the stage and the table still, and record again"
    )
    assert (said == shaken) is shakes
    assert ("sways" in said) is shakes


def test_the_first_version_says_what_it_knew() -> None:
    later = ("explained", "remainder", "relevant_um", "explainable_um")
    old = document("named", schema="meso-robust/diagnosis/1", budget=(), **dict.fromkeys(later))
    assert answer(old) == (
        "dry_friction (support): ratio 0.21 [0.18, 0.24]; held-out error 4.1 → 1.05 σ; "
        "next: push faster <225>"
    )
    assert "Where the error is" not in diagnosis_report(old, evidence("named"), SOURCE)


def test_windows_that_point_elsewhere_than_the_effects_are_explained() -> None:
    assert stage_words(document("named")) == ""
    words = stage_words(document("ambiguous"))
    assert words.startswith("Windows by themselves point to support")
    assert words.endswith("Over all recordings, environment explains more.")


def test_the_bar_of_the_budget_adds_up() -> None:
    drawing = figures.budget_figure(document("partial").budget)
    bars = [one for one in drawing.axes[0].patches if isinstance(one, Rectangle)]
    assert sum(one.get_width() for one in bars) == pytest.approx(1.0)
    colours = {to_hex(one.get_facecolor()): one.get_width() for one in bars}
    assert colours[STAGES["support"]] == pytest.approx(0.55)


def test_the_summary_names_alternatives_and_extrapolation() -> None:
    lines = summary(document("ambiguous")).splitlines()
    assert lines[1] == (
        "  body_force (environment): x_um_s −1.5 [−1.9, −1.1] µm/s, y_um_s 0.4 [0.1, 0.7] µm/s, "
        "probability 0.52"
    )
    assert lines[2:4] == ["  or: film_flow", "  or: camera_drift + backlash"]
    assert "  extrapolation (the speed 225 µm/s): 5.33 → 1.16 σ" in lines
    assert lines[-1] == "  next: push faster <225>"


def test_spans_tell_a_stage_only_where_no_effect_has_one() -> None:
    def first(verdict: Verdict, **given: Any) -> str:
        lines = summary(document(verdict, **given)).splitlines()
        return next(line for line in lines if "where:" in line)

    span = document("named").mismatch.where[0]
    assert f"{span.channel}, " not in first("named")
    assert first("unknown", effects=()) == first("named").replace("): ", f"): {span.channel}, ")


def test_words_of_users_are_escaped_and_no_formulas(pages: dict[Verdict, str]) -> None:
    page = pages["named"]
    for raw in ("a<b>", "<a>", "<speed>", "<225>", "<note>", "mathdefault"):
        assert raw not in page
    for shown in ("a&lt;b&gt;&amp;$x$_0.csv", "sets/&lt;a&gt;&amp;&#39;b&#39;", "&lt;speed&gt;"):
        assert shown in page
    text = page[page.index('id="map-figure_1"') : page.index('id="vectors-figure_1"')]
    assert "a&lt;b&gt;&amp;$x$_0.csv" in text  # in a picture, too


@pytest.mark.parametrize(
    ("verdict", "present", "absent"),
    [
        ("consistent", ["Nothing is added", "No span stands out", "None was refitted"], "law"),
        (
            "named",
            ["66 to 78 %", "motion alone: film_viscosity .", "recording 3 stays"],
            "rule out none",
        ),
        ("partial", ["explains part of the mismatch", "no effect contact 45"], "No set of"),
        ("ambiguous", ["rule out none of the following", "film_flow"], "No set of"),
        (
            "unknown",
            ["No set of the catalogue's effects", "Nothing is added to the model"],
            "66 to 78",
        ),
    ],
)
def test_every_verdict_says_what_it_is(
    pages: dict[Verdict, str], verdict: Verdict, present: list[str], absent: str
) -> None:
    reader = Reader(pages[verdict])
    for words in present:
        assert words in reader.text
    assert absent not in reader.text
    extended = verdict in ("named", "partial", "ambiguous")
    assert ("extended model" in reader.text) == extended


def test_what_was_not_fitted_has_no_interval_and_what_is_not_enough_no_probability() -> None:
    stribeck = {
        "name": "stribeck_friction",
        "probability": 0.0,
        "stage": "support",
        "equation": "f = −τ exp(−(|u|/v_s)²) u/|u|",
        "parameters": {
            "ratio": {"value": 1234567.0, "low": -2e9, "high": 3e9},
            "speed_um_s": {"value": 30.0, "low": 30.0, "high": 30.0, "unit": "µm/s"},
        },
    }
    given = document("unknown", effects=(stribeck,))
    assert summary(given).splitlines()[1] == (
        "  stribeck_friction (support): ratio 1234567 [−2e+09, 3e+09], speed_um_s 30 µm/s (fixed), "
        "not enough alone"
    )


def test_what_no_recording_tells_apart_is_told() -> None:
    given = document("named")
    (first, *_) = given.candidates
    names = tuple(sorted(effect.name for effect in given.effects))
    twin = first.model_copy(update={"effects": ("drag_drift",), "instead": names})
    other = twin.model_copy(update={"effects": ("film_flow",), "instead": ("backlash",)})
    longer = twin.model_copy(update={"effects": ("backlash", "drag_drift")})
    found = given.model_copy(update={"candidates": (first, twin, other, longer)})

    assert "  or, by the same motion: drag_drift" in summary(found).splitlines()
    assert "(or, by the same motion, drag_drift)" in answer(found)
    assert "film_flow" not in answer(found)
    assert "backlash" not in answer(found)
    assert "by the same motion" not in answer(given)


@pytest.mark.parametrize(
    ("low", "each_push", "said"),
    [
        (0.2, False, "probability 1"),
        (-0.41, False, "probability 1 where it was fitted, left open by what was held out"),
        (0.0, True, "probability 1"),  # nothing that a held-out push could be predicted with
    ],
)  # fmt: skip
def test_no_effect_is_sure_where_held_out_recordings_are_predicted_no_better(
    low: float, each_push: bool, said: str
) -> None:
    pull = {"value": 5.0, "low": 4.0, "high": 6.0}
    adhesion = {
        "name": "tip_adhesion",
        "probability": 1.0,
        "stage": "contact",
        "equation": "F = s",
        "parameters": {"pull_um_s": pull},
        "each_push": each_push,
    }
    given = document("partial", effects=(adhesion,))
    held = given.held_out.model_copy(update={"recordings": ("push_0.csv",), "improvement_low": low})
    first = summary(given.model_copy(update={"held_out": held})).splitlines()[1]
    assert first.startswith("  tip_adhesion (contact): pull_um_s 5 [4, 6] µm/s")
    assert first.endswith(f", {said}")


@pytest.mark.parametrize(
    ("number", "form", "said"),
    [
        (0.0, "constant until it breaks", ""),
        (1.0, "falls linearly to nothing at r", ", falls linearly to nothing at r"),
        (1.0, "form not told by these recordings", ""),
    ],
)
def test_the_form_of_a_law_is_said_in_words_unless_it_is_the_usual_one(
    number: float, form: str, said: str
) -> None:
    held = {"value": number, "low": number, "high": number}
    adhesion = {
        "name": "tip_adhesion",
        "probability": 1.0,
        "stage": "contact",
        "equation": "F = s",
        "parameters": {"pull_um_s": {"value": 5.0, "low": 4.0, "high": 6.0}, "form": held},
        "form": form,
    }
    first = summary(document("named", effects=(adhesion,))).splitlines()[1]
    assert first == f"  tip_adhesion (contact): pull_um_s 5 [4, 6] µm/s{said}, probability 1"


@pytest.mark.parametrize(
    ("share", "said"), [(0.0, ""), (1.0, ", 100 % of its shear taken for a turn")]
)
def test_what_a_tracker_takes_for_a_turn_is_said_in_words(share: float, said: str) -> None:
    values = {"x_percent": {"value": 0.5, "low": 0.4, "high": 0.6}}
    values |= {"turned": {"value": share, "low": share, "high": share}}
    stretch = {
        "name": "camera_anisotropy",
        "probability": 1.0,
        "stage": "observation",
        "equation": "y = A x",
        "parameters": values,
    }
    first = summary(document("named", effects=(stretch,))).splitlines()[1]
    expected = f"  camera_anisotropy (observation): x_percent 0.5 [0.4, 0.6]{said}, probability 1"
    assert first == expected


def test_the_equation_is_set_and_its_parameter_explained(pages: dict[Verdict, str]) -> None:
    assert "<i>f</i> = −<i>τ</i> <i>u</i>/|<i>u</i>| on every part" in pages["named"]
    assert "force over film drag at 75 µm/s" in Reader(pages["named"]).text


@pytest.mark.usefixtures("_no_overlays")
def test_an_improvement_that_may_be_none_is_said_so() -> None:
    plain = document("named")
    held = plain.held_out.model_copy(update={"improvement_low": -0.04})
    text = Reader(diagnosis_report(plain.model_copy(update={"held_out": held}), tiny(), "s")).text
    assert "−4 to 78 %" in text
    assert "The interval includes no improvement." in text


def test_a_page_is_made_of_almost_nothing() -> None:
    bare = document("consistent")
    nothing = bare.held_out.model_copy(update={"recordings": (), "each": ()})
    mismatch = bare.mismatch.model_copy(update={"nulls": 0, "tests": ()})
    empty = {"held_out": nothing, "mismatch": mismatch, "not_identifiable_why": ()}
    empty |= {"invariances": (), "not_identifiable": ()}
    blind = replace(
        tiny(), null_statistics=np.zeros(0), seen=np.full((2, 5, 3), np.nan), extended=None
    )
    text = Reader(diagnosis_report(bare.model_copy(update=empty), blind, "s")).text
    assert "No recording was held out, so nothing here shows" in text
    assert "No two pushes were found" in text
    assert "Every effect of the catalogue would have shown" in text


def test_pages_are_the_same_every_time_whatever_the_user_has_set(
    pages: dict[Verdict, str],
) -> None:
    with matplotlib.rc_context({"font.size": 30.0, "axes.facecolor": "red"}):
        assert made("consistent") == pages["consistent"]
        assert matplotlib.rcParams["font.size"] == 30.0


@pytest.mark.parametrize("verdict", ["named", "unknown"])
def test_pictures_follow_the_theme(pages: dict[Verdict, str], verdict: Verdict) -> None:
    page = pages[verdict]
    sheet = page[: page.index("</style>")]
    dark = sheet[sheet.index("prefers-color-scheme: dark") :]
    for drawing in re.findall(r"<svg.*?</svg>", page, re.DOTALL):
        assert not re.search(r"#[0-9a-f]{6}\b", drawing)
        used = set(re.findall(r"var\(--([a-z0-9]+)\)", drawing))
        assert used
        assert all(f"--{name}: " in sheet for name in used)
    for name in ("ink", "paper", "grid", "band", "vermilion", "blue", "way", "s0", "s6", "contact"):
        assert f"--{name}: " in dark


# ---------------------------------------------------------------------------- drawings by their data


def tiny(**changes: object) -> Evidence:
    """Two recordings of five frames without noise, 10 and 20 σ off in x at the last one."""
    truth = np.zeros((2, 5, 3))
    truth[:, :, 0] = np.linspace(0.0, 400e-6, 5)
    baseline = truth.copy()
    baseline[:, 4, 0] -= [10e-6, 20e-6]
    tips = truth[:, :, None, :2] - [110e-6, 0.0]
    given: dict[str, object] = {
        "files": ("one.csv", "two.csv"),
        "outline": np.array([[-1.0, -0.5], [1.0, -0.5], [1.0, 0.5], [-1.0, 0.5]]) * 1e-4,
        "tip_radius": 1e-5,
        "instants": np.tile(np.arange(5.0), (2, 1)),
        "seen": truth,
        "tips": tips,
        "baseline": baseline,
        "extended": truth.copy(),
        "sigma": np.array([1e-6, 1e-6, 1e-3]),
        "held_out": ("two.csv",),
        "extrapolation": (),
        "null_statistics": np.linspace(2.0, 4.0, 50),
        "statistic": 3.0,
    }
    return Evidence(**{**given, **changes})  # type: ignore[arg-type]


def vertices(patch: Any) -> Floats:
    """(N, 2) points of a shape."""
    return np.asarray(patch.get_path().vertices, dtype=np.float64)


def line_x(line: Any) -> float:
    """Place of an upright line."""
    return float(line.get_xdata()[0])


def filled(figure: Figure, colour: str) -> list[Rectangle]:
    found = [p for axes in figure.axes for p in axes.patches if isinstance(p, Rectangle)]
    return [p for p in found if to_hex(p.get_facecolor()) == colour]


def test_residuals_are_over_the_noise_and_an_angle_has_no_turns() -> None:
    given = tiny()
    whole_turn = given.baseline.copy()
    whole_turn[0, 2, 2] += 2.0 * np.pi - 0.002
    left = figures.residuals(given, whole_turn)
    assert left[1, 4, 0] == pytest.approx(20.0)
    assert left[0, 2, 2] == pytest.approx(2.0)
    np.testing.assert_allclose(
        figures.size(figures.residuals(given, given.baseline)), np.array([10, 20]) / np.sqrt(15)
    )


def test_the_worst_recordings_are_drawn_first_and_say_if_they_were_held_out() -> None:
    page = diagnosis_report(document("named"), tiny(), "s")
    titles = re.findall(r'<h3>(.*)</h3>\n<div class="scroll[^>]*><svg', page)
    assert titles[:2] == ["two.csv (held out of the choice)", "one.csv (training)"]


def test_bars_are_as_long_as_the_errors() -> None:
    held = document("named").held_out
    figure = figures.held_out_figure(held.each, (0.97, 0.07), extended=True)
    before = [bar.get_width() for bar in filled(figure, figures.BASELINE)]
    after = [bar.get_width() for bar in filled(figure, figures.EXTENDED)]
    assert before == pytest.approx([3.28, 3.69, 4.1, 4.51])
    assert after == pytest.approx([1.155, 1.1025, 1.05, 0.9975])
    (floor,) = [line for line in figure.axes[0].lines if line.get_linestyle() == "--"]
    assert line_x(floor) == 0.97
    starred = [t.get_text() for t in figure.axes[0].get_yticklabels() if "*" in t.get_text()]
    assert starred == [f"{name} *" for name in EXTRAPOLATION]
    legend = figure.axes[0].get_legend()
    assert legend is not None
    drawn = legend.get_window_extent(FigureCanvasAgg(figure).get_renderer())
    assert 0 <= drawn.x0 < drawn.x1 <= figure.bbox.x1
    assert drawn.y1 <= figure.bbox.y1  # not cut off by the top of the picture
    plain = figures.held_out_figure(held.each, (1.0, None), extended=False)
    assert filled(plain, figures.EXTENDED) == []


def test_an_overlay_shows_the_part_where_it_was_seen_and_where_it_was_simulated() -> None:
    figure = figures.overlay_figure(tiny(), 1)
    plane, x, _, theta = figure.axes
    assert plane.get_aspect() == 1.0
    ends = {
        to_hex(p.get_edgecolor()): float(np.mean(vertices(p)[:4, 0]))
        for p in plane.patches
        if not isinstance(p, PathPatch)
    }
    assert ends["#1f2933"] == pytest.approx(400.0)
    assert ends[figures.BASELINE] == pytest.approx(380.0)
    assert ends[figures.EXTENDED] == pytest.approx(400.0)
    (dots,) = [p for p in x.patches if isinstance(p, PathPatch)]
    np.testing.assert_allclose(vertices(dots)[::2, 1], [0, 0, 0, 0, 20], atol=1e-9)
    (line,) = x.lines
    np.testing.assert_allclose(np.asarray(line.get_ydata()), 0.0, atol=1e-9)
    (band,) = filled(figure, BAND)[2:]
    assert band.get_height() == pytest.approx(4 * np.degrees(1e-3))
    assert band.axes is theta


def test_a_map_is_darkest_where_the_residual_is() -> None:
    figure = figures.map_figure(tiny(), [0, 1])
    shades, after = (
        {to_hex(p.get_facecolor()): vertices(p) for p in axes.patches} for axes in figure.axes
    )
    # root mean square of 20 σ in one of three components
    assert 7.0 < 20 / np.sqrt(3) < 12.0
    worst = shades[SHADES[5]]
    np.testing.assert_allclose([worst[:, 0].max(), worst[:, 1].max()], [4.0, 1.96])
    assert len(worst) == 5
    assert [len(after[shade]) > 0 for shade in SHADES] == [True] + 6 * [False]


def test_residuals_of_places_are_drawn_where_the_part_was() -> None:
    figure, scale = figures.vectors_figure(tiny())
    hairs, _ = figure.axes[0].patches
    ends = vertices(hairs).reshape(-1, 2, 2)
    assert scale == 2.0  # 48 of 400 µm for the longest of 20 µm, rounded down to 1, 2 or 5
    np.testing.assert_allclose(ends[-1], [[400.0, 0.0], [400.0 + 2 * 20.0, 0.0]], atol=1e-9)
    np.testing.assert_allclose(np.ptp(ends[:4, :, 0], axis=1), 0.0, atol=1e-9)


def test_spans_lie_on_the_time_line_of_their_recording() -> None:
    where = document("named").mismatch.where
    figure = figures.strip_figure(where, evidence("named"), range(len(NAMES)))
    (contact,) = filled(figure, STAGES["contact"])
    assert (contact.get_x(), contact.get_width()) == pytest.approx((1.9, 5.1))
    assert 3.0 < contact.get_y() < contact.get_y() + contact.get_height() < 4.0
    theta, x = filled(figure, STAGES["support"])
    assert x.get_y() < theta.get_y()
    lengths = [span["end_s"] - span["start_s"] for span in SPANS[:2]]
    assert [theta.get_width(), x.get_width()] == pytest.approx(lengths)


@pytest.mark.parametrize(("statistic", "scale"), [(3.0, "linear"), (15.9, "linear"), (41, "log")])
def test_the_nulls_stand_beside_the_recordings(statistic: float, scale: str) -> None:
    figure = figures.null_figure(tiny(statistic=statistic), document("named"))
    (axes,) = figure.axes
    bars = [p for p in axes.patches if isinstance(p, Rectangle)]
    assert sum(bar.get_height() for bar in bars) == 50
    limit, found = (line_x(line) for line in axes.lines)
    assert limit == pytest.approx(3.96, abs=0.001)  # 98 % of the way from 2 to 4
    assert found == statistic
    assert axes.get_xscale() == scale


@pytest.mark.parametrize("field", ["seen", "tips", "baseline", "extended", "sigma", "files"])
def test_evidence_of_the_wrong_shape_is_refused(field: str) -> None:
    with pytest.raises(ValueError, match=f"{field}: has the shape .* must be"):
        tiny(**{field: ("one.csv",) if field == "files" else np.zeros((2, 4))})


def test_many_recordings_are_cut_to_a_page(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("meso_robust.reporting.diagnosis.MOST_ROWS", 3)
    monkeypatch.setattr("meso_robust.reporting.diagnosis.MOST_PICTURES", 1)
    page = diagnosis_report(document("named"), evidence("named"), "s")
    (title,) = re.findall(r'<h3>(.*\.csv.*)</h3>\n<div class="scroll[^>]*><svg', page)
    assert title == "push_09.csv (held out of the choice)"
    assert page.count("The first 3 of ") == 2  # spans, held-out recordings
    assert "The first 3 of 5; all are in" in page
    map_ = page[page.index('id="map-figure_1"') : page.index('id="vectors-figure_1"')]
    assert len(re.findall(r"\.csv</text>", map_)) == 3


@pytest.mark.usefixtures("_no_overlays")
def test_a_residual_law_is_shown_with_its_gain_and_never_as_a_name() -> None:
    law = {
        "added_to": (),
        "bases": {
            "across_sin2": {
                **{"value": -0.138, "low": -0.243, "high": -0.0335, "chosen": 0.97},
                "meaning": "the same, φ the heading on the stage × sin 2φ",
            }
        },
        **{"before_um": 3918.0, "after_um": 3193.0, "before_deg": 2.87, "after_deg": 2.72},
        **{"fall": 0.243, "fall_low": 0.062, "fall_high": 0.404, "folds": 6, "offered": True},
    }
    found = document("unknown", residual=law)
    page = diagnosis_report(found, evidence("unknown"), SOURCE)
    section = page[page.index('id="residual"') :]
    section = section[: section.index("</section>")]
    text = re.sub(r"\s+", " ", re.sub(r"<[^>]*>", "", section))
    for words in (
        "3920",
        "3190 µm",
        "24 % [6, 40]",
        "not a name",
        "across_sin2",
        "model.toml",
        "97",
    ):
        assert words in text.replace(",", ",").replace("\u202f", ""), words
    assert "across_sin2" not in answer(found)
    assert "nothing is proved with it" in text
    weak = diagnosis_report(
        document("unknown", residual=law | {"offered": False}), evidence("unknown"), SOURCE
    )
    assert "has no residual term" in weak
    assert 'id="residual"' not in diagnosis_report(document("named"), evidence("named"), SOURCE)
