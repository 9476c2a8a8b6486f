"""The view in the plan's page, in a real browser."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from meso_robust.bounds import Interval
from meso_robust.pipeline import Planned
from meso_robust.reporting.plan import report
from meso_robust.reporting.slim import slim
from meso_robust.reporting.view import data, held, view
from tests.browser import Page
from tests.nightly import at_night
from tests.reporting.javascript import Script

HERE = Path(__file__).parents[2] / "meso_robust" / "reporting"
MOST_BYTES = 96 * 1024


@pytest.fixture(scope="module")
def path(proved_page: str, tmp_path_factory: pytest.TempPathFactory) -> Path:
    found = tmp_path_factory.mktemp("view") / "report.html"
    found.write_text(proved_page, encoding="utf-8")
    return found


def said(page: Page, name: str) -> str:
    text = page.evaluate(f"document.getElementById({name!r}).textContent")
    assert isinstance(text, str)
    return text.strip()


def number(page: Page, name: str) -> float:
    return float(said(page, name).replace("−", "-"))


def knob(page: Page, label: str) -> str:
    """Selector of the slider whose label begins so."""
    found = page.evaluate(
        f"[...document.querySelectorAll('.knob')].find(k => k.textContent.startsWith({label!r}))"
        ".querySelector('input').id"
    )
    return f"#{found}"


def value(page: Page, claim: str, move: int) -> str:
    """What stands at the right of the bar of a condition."""
    text = page.evaluate(
        f"[...document.querySelectorAll('.sheet')][{move}].querySelectorAll('.conds .cond')"
        f".values().find(c => c.textContent.startsWith({claim!r})).querySelector('.value').textContent"
    )
    assert isinstance(text, str)
    return text


def test_nominal_run_is_the_simulated_one(page: Page, path: Path, proved: Planned) -> None:
    page.open(path)
    page.slide("#position", 1000)

    x, y, theta = proved.check.nominal.final[0] * [1e6, 1e6, 180 / np.pi]
    shown = [number(page, f"now-{name}") for name in ("x", "y", "theta")]
    assert shown == pytest.approx([x, y, theta], abs=0.06)  # the stepper's own error is 0.05 um
    assert said(page, "box-tag") == "inside: proved"
    assert said(page, "end-tag") == "✓ ends in the goal"
    assert page.evaluate("document.querySelectorAll('.sheet .tag.good').length") == 5
    assert (page.errors, page.outside) == ([], [])


def test_play_moves_the_part(page: Page, path: Path) -> None:
    page.open(path)
    before = number(page, "now-x")
    page.click("#play")
    page.wait(f"document.getElementById('now-x').textContent !== '{before:.1f}'")
    assert said(page, "play") == "Pause"
    page.click("#play")
    assert number(page, "now-x") < before
    assert page.errors == []


def test_sliders_change_motion_and_margins(page: Page, path: Path) -> None:
    page.open(path)
    page.slide("#position", 1000)
    ends, margin = number(page, "now-y"), value(page, "the pushing tip sticks", 0)
    page.slide(knob(page, "passive tip y"), 4.0)
    assert number(page, "now-y") != ends
    assert said(page, "box-tag") == "inside: proved"

    page.slide(knob(page, "friction"), 0.39)
    assert value(page, "the pushing tip sticks", 0) != margin == "100 %"
    assert said(page, "box-tag") == "outside: not promised"
    assert "friction is × 2.00 of its half width" in said(page, "box-words")
    assert page.errors == []


def test_margin_of_the_certificate_counts(page: Page, path: Path, proved: Planned) -> None:
    """One uncertainty alone, between its stated range and what is certified of it."""
    alone = proved.certificate.margin.each_alone["friction"]
    assert alone > 1.1
    page.open(path)
    page.slide(knob(page, "friction"), 0.33 + 0.03 * (1 + alone) / 2)
    assert said(page, "box-tag") == "in the margin: proved"


def test_far_outside_the_run_jams_and_the_margin_says_so(page: Page, path: Path) -> None:
    page.open(path)
    for label, there in (("friction", 0.39), ("active probe y", -9.0), ("passive tip y", 9.0)):
        page.slide(knob(page, label), there)

    assert said(page, "end-tag") == "✕ ends early"
    assert said(page, "end-words").startswith("Move 3: jams")
    assert value(page, "the grasp cannot close", 2).startswith("✕ −")
    page.click("#nominal")
    assert said(page, "end-tag") == "✓ ends in the goal"


def test_errors_of_one_move(page: Page, path: Path) -> None:
    page.open(path)
    page.slide("#which", 2)
    page.slide(knob(page, "active probe x"), 3.0)
    page.slide("#which", 0)
    shown = f"document.querySelector('{knob(page, 'active probe x')}').parentNode.lastChild"
    assert page.evaluate(f"{shown}.textContent") == "0.0 µm"
    off = page.evaluate("[...document.querySelectorAll('.knob.off')].map(k => k.textContent)")
    assert [text.split(" ±")[0] for text in off] == [
        "seen x",
        "seen y",
        "seen θ",
        "passive tip x",
        "passive tip y",
    ]
    page.slide("#which", "all")  # type: ignore[arg-type]
    assert page.evaluate(f"{shown}.textContent") == "varies"


@at_night
def test_random_runs_stay_inside_and_the_worst_ends_in_the_goal(page: Page, path: Path) -> None:
    """The certificate promises it of every run; the page shows what it finds."""
    page.open(path)
    for name in ("inside", "corner"):
        page.click(f"#{name}")
        assert (said(page, "box-tag"), said(page, "end-tag")) == (
            "inside: proved",
            "✓ ends in the goal",
        )
    share = page.evaluate(
        "parseFloat(document.getElementById('end-words').textContent.split('at ')[1])"
    )
    page.click("#worst")
    page.wait("!document.getElementById('worst').disabled")
    worst = page.evaluate(
        "parseFloat(document.getElementById('end-words').textContent.split('at ')[1])"
    )
    assert share <= worst < 100
    assert said(page, "box-tag") == "inside: proved"
    assert page.errors == []


def test_keyboard(page: Page, path: Path) -> None:
    page.open(path)
    page.evaluate("document.getElementById('stage').focus()")
    page.press("ArrowRight", shift=True)
    assert said(page, "now-move").startswith("2 of 4")
    page.press("End")
    assert said(page, "now-move").startswith("4 of 4")
    page.press("Home")
    page.press("Space")
    assert said(page, "play") == "Pause"
    page.press("Space")
    page.press("Home")

    first = knob(page, "friction")
    page.evaluate(f"document.querySelector('{first}').focus()")
    page.press("ArrowRight")
    assert page.evaluate(f"Number(document.querySelector('{first}').value)") > 0.33
    assert number(page, "now-x") == pytest.approx(2060.4)  # the arrow is the slider's own
    unnamed = "[...document.querySelectorAll('#view input, #view select, #view button')].filter("
    unnamed += "e => !e.labels?.length && !e.ariaLabel && !e.textContent.trim()).length"
    assert page.evaluate(unnamed) == 0


def test_reduced_motion_plays_move_by_move(page: Page, path: Path) -> None:
    page.emulate(still=True)
    page.open(path)
    page.click("#play")
    page.wait("document.getElementById('now-move').textContent.startsWith('2 of 4')")
    page.click("#play")
    ends = page.evaluate("JSON.parse(document.getElementById('data').textContent).moves[0].seconds")
    assert said(page, "now-time").startswith(f"{ends:.1f} of")


def test_phone_and_paper(page: Page, path: Path) -> None:
    page.emulate(width=380, height=800)
    page.open(path)
    wide = "[...document.querySelectorAll('#view *')].filter(e => !e.closest('.hidden') &&"
    wide += " e.getBoundingClientRect().right > innerWidth + 1).map(e => e.outerHTML.slice(0, 80))"
    assert page.evaluate(wide) == []
    page.emulate(printed=True)
    assert page.evaluate("getComputedStyle(document.getElementById('view')).display") == "none"


def test_a_plan_that_is_not_proved(page: Page, refuted_page: str, tmp_path: Path) -> None:
    path = tmp_path / "refuted.html"
    path.write_text(refuted_page, encoding="utf-8")
    page.open(path)

    assert said(page, "box-tag") == "inside: not proved"
    page.click("#corner")
    assert page.errors == []


def test_names_of_the_user_are_shown_and_never_run(
    page: Page, proved: Planned, tmp_path: Path
) -> None:
    evil = "</script><img src=x onerror=\"document.title='run'\">"
    moves = tuple(m.model_copy(update={"primitive": evil}) for m in proved.plan.moves)
    plan = proved.plan.model_copy(update={"moves": moves})
    values = {name: getattr(proved, name) for name in proved.__dataclass_fields__}
    path = tmp_path / "evil.html"
    path.write_text(report(Planned(**{**values, "plan": plan})), encoding="utf-8")
    page.open(path)

    assert evil in page.evaluate("document.querySelector('.sheet summary b').textContent")
    assert page.evaluate("document.title") != "run"
    assert (page.errors, page.outside) == ([], [])


def test_view_stays_small_and_strict(proved: Planned, proved_page: str) -> None:
    section = proved_page[proved_page.index('<section class="player view"') :]
    styles = [(HERE / name).read_text(encoding="utf-8") for name in ("view.css", "player.css")]
    whole = [section[: section.index("</section>")], *styles]

    assert str(view(proved)) in whole[0]
    assert sum(len(text.encode()) for text in whole) < MOST_BYTES
    assert not re.search(r"innerHTML|outerHTML|insertAdjacent|eval\(|\son[a-z]+=\"", "".join(whole))


def test_slim_keeps_what_a_script_means() -> None:
    script = """
    // a "comment" with `quotes`
    const a = 3, b = -2; // and another
    const words = `${ a }  //  b` + "  //  " + '{ }';
    const f = (x) => ({ value: x - -b + +a, less: a < b ? 1 : 2 });
    answer = JSON.stringify([words, f(7), a--b === 0, typeof a in { number: 1 }]);
    """
    script = script.replace("a--b === 0", "a - - b").replace("'{ }'", '"{ }"')
    both = [Script(f"let answer; {code}").call("eval", "answer") for code in (script, slim(script))]

    assert both[0] == both[1]
    assert len(slim(script)) < 0.75 * len(script)


def test_data_states_ranges_in_the_task_s_units(proved: Planned) -> None:
    told = data(proved)

    assert told["ranges"]["friction"] == pytest.approx([0.3, 0.36])
    assert told["ranges"]["film_ratio"] == pytest.approx([376900 * 0.95, 376900 * 1.05])
    assert told["ranges"]["misalignment"] == pytest.approx([-0.25, 0.25])
    assert told["ranges"]["sensed_position"] == pytest.approx([-5, 5])
    assert np.abs(told["task"]["corners"]) == pytest.approx(np.array([[808, 418.5]] * 4))
    assert [move["proved"] for move in told["moves"]] == [True] * 4


def test_what_is_promised_and_has_no_slider_is_said(proved: Planned, proved_page: str) -> None:
    assert 'id="held"' not in proved_page  # of the paper's task every error has one
    stray = Interval(-1e-6, 1e-6)
    uncertainty = replace(proved.setup.uncertainty, probe_wander=stray, drag_anisotropy=stray)
    setup = replace(proved.setup, uncertainty=uncertainty, friction_common=False)
    said = report(replace(proved, setup=setup))
    said = said[said.index('id="held"') :].partition("</p>")[0]
    for words in ("a probe that strays", "friction that changes", "a direction of the stage"):
        assert words in said
    assert "centre of drag" not in said
    assert held(setup)
    assert not held(proved.setup)
