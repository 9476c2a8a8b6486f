"""Every kind of report in a real browser: quiet, alone, readable in both themes, on a phone, on paper."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest

from meso_robust.pipeline import Planned
from tests.browser import Browser, Page, tab
from tests.reporting.pages import EVIL, MAKERS, plan_page

KINDS = ("proved", "refuted", *MAKERS)
PHONE = 380
A4 = 680  # CSS pixels between margins of 15 mm

WIDEST = "document.documentElement.scrollWidth"
REPEATED = """(() => { const ids = [...document.querySelectorAll('[id]')].map(e => e.id);
  return ids.filter((id, k) => ids.indexOf(id) !== k); })()"""
DANGLING = """[...document.querySelectorAll('a[href]')].map(a => a.getAttribute('href'))
  .filter(h => h.startsWith('#') && !document.getElementById(h.slice(1)))"""
LEVELS = "[...document.querySelectorAll('h1, h2, h3, h4, h5, h6')].map(h => Number(h.tagName[1]))"
UNREACHED = """[...document.querySelectorAll('*')].filter(e => e.scrollWidth > e.clientWidth + 1
  && getComputedStyle(e).overflowX === 'auto' && e.tabIndex < 0
  && !e.matches('.formula') && !e.closest('.entry')).map(e => e.outerHTML.slice(0, 80))"""
UNNAMED = """[...document.querySelectorAll('.scroll, svg[role=img], nav, input, select, canvas')]
  .filter(e => !e.closest('[aria-hidden=true]') && !(e.ariaLabel || e.querySelector(':scope > title') || e.labels?.length))
  .map(e => e.outerHTML.slice(0, 80))"""
CUT = f"""[...document.querySelectorAll('main *')].filter(e => e.getClientRects().length
  && !e.closest('svg') && e.getBoundingClientRect().right > {A4} + 1)
  .map(e => e.outerHTML.slice(0, 80))"""
CONTRASTS = """(() => {
  const part = x => { x /= 255; return x <= 0.04045 ? x / 12.92 : ((x + 0.055) / 1.055) ** 2.4; };
  const light = c => 0.2126 * part(c[0]) + 0.7152 * part(c[1]) + 0.0722 * part(c[2]);
  const read = s => { const v = s.match(/[\\d.]+/g).map(Number); return v.length < 4 ? [...v, 1] : v; };
  const over = (top, low) => [0, 1, 2].map(k => top[3] * top[k] + (1 - top[3]) * low[k]).concat(1);
  const behind = e => { if (!e) return [255, 255, 255, 1];
    const own = read(getComputedStyle(e).backgroundColor);
    return own[3] === 1 ? own : over(own, behind(e.parentElement)); };
  const poor = {};
  const texts = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  for (let node; (node = texts.nextNode());) {
    const e = node.parentElement, look = getComputedStyle(e);
    if (!node.data.trim() || !e.checkVisibility() || e.closest('script, style, math, select, button')) continue;
    if (e instanceof SVGElement && e.tagName !== 'text' && e.tagName !== 'tspan') continue;
    const ground = behind(e.closest('svg')?.parentElement ?? e);
    const ink = over(read(e instanceof SVGElement ? look.fill : look.color), ground);
    const [a, b] = [light(ink), light(ground)].sort((p, q) => q - p);
    const ratio = (a + 0.05) / (b + 0.05);
    if (ratio === 1 && e.closest('svg')) continue; // a number in a dot of ink
    if (ratio < 4.5) poor[`${e.tagName}.${e.className.baseVal ?? e.className}: ${node.data.trim().slice(0, 30)}`] = ratio;
  }
  return poor; })()"""


CUT_PICTURES = """[...document.querySelectorAll('figure svg')].filter(e => e.checkVisibility()).filter(e => {
  const right = e.getBoundingClientRect().right, frame = e.closest('.scroll') ?? e.parentElement;
  return right > innerWidth || frame.scrollWidth > frame.clientWidth + 1; }).map(e => e.id || e.textContent.slice(0, 40))"""
CUT_CONTROLS = """[...document.querySelectorAll('select, button, output, input')].filter(e => e.checkVisibility()
  && e.getBoundingClientRect().right > innerWidth).map(e => e.id || e.outerHTML.slice(0, 60))"""


@pytest.fixture(scope="module", params=KINDS)
def kind(request: pytest.FixtureRequest) -> str:
    return str(request.param)


@pytest.fixture(scope="module")
def file(
    kind: str, request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory
) -> Path:
    """One page of every kind, each made once."""
    path = tmp_path_factory.mktemp("pages") / f"{kind} ä.html"
    make: Callable[[], str] = MAKERS.get(kind) or (lambda: plan_page(request.getfixturevalue(kind)))
    path.write_text(make(), encoding="utf-8")
    return path


@pytest.fixture(scope="module")
def shown(browser: Browser, file: Path) -> Iterator[Page]:
    """The page, opened once."""
    with tab(browser) as opened:
        opened.open(file)
        yield opened


def test_a_page_is_quiet_alone_and_whole(shown: Page, kind: str) -> None:
    shown.emulate()
    assert shown.errors == []
    assert shown.outside == []
    assert shown.evaluate(REPEATED) == []
    assert shown.evaluate(DANGLING) == []
    assert shown.evaluate("document.documentElement.lang") == "en"
    levels = shown.evaluate(LEVELS)
    assert levels.count(1) == 1
    assert all(low <= high + 1 for high, low in pairwise(levels))
    assert shown.evaluate(UNNAMED) == []
    footer = shown.evaluate("document.querySelector('footer').textContent")
    assert "to reproduce" in footer
    assert "meso-robust " in footer


def test_names_of_the_user_are_shown_and_not_run(shown: Page, kind: str) -> None:
    if kind == "register":
        pytest.skip("the register holds nothing of a user")
    shown.emulate()
    assert shown.evaluate("document.title") != "run"
    assert shown.evaluate("document.querySelectorAll('img').length") == 0
    if kind not in ("experiment", "reproduction"):
        assert shown.evaluate("document.querySelector('header bdi').textContent") == EVIL
    assert EVIL in re.sub(r"\s+", " ", shown.evaluate("document.body.textContent"))


def test_a_page_follows_the_theme(shown: Page, kind: str) -> None:
    ground = "getComputedStyle(document.body).backgroundColor"
    shown.emulate()
    light, poor = shown.evaluate(ground), shown.evaluate(CONTRASTS)
    shown.emulate(dark=True)
    dark, poor_dark = shown.evaluate(ground), shown.evaluate(CONTRASTS)
    assert (light, dark) == ("rgb(255, 255, 255)", "rgb(17, 22, 27)")
    assert poor == {}
    assert poor_dark == {}


def test_a_page_fits_a_phone(shown: Page, kind: str) -> None:
    shown.emulate(width=PHONE)
    assert shown.evaluate(WIDEST) <= PHONE
    assert shown.evaluate(UNREACHED) == []


def test_no_picture_is_cut_in_a_narrow_window(shown: Page, kind: str) -> None:
    for width in (PHONE, 500):
        shown.emulate(width=width)
        assert shown.evaluate(CUT_PICTURES) == []
        assert shown.evaluate(CUT_CONTROLS) == []


def test_a_page_is_reached_by_keys(shown: Page, kind: str) -> None:
    shown.emulate()
    shown.press("Tab")
    assert shown.evaluate("document.activeElement.className") == "skip"
    seen = "(b => b.left >= 0 && b.top >= 0 && b.width > 0)(document.activeElement.getBoundingClientRect())"
    assert shown.evaluate(seen)
    shown.press("Enter")
    assert shown.evaluate("document.activeElement.id") == "main"
    shown.press("Tab")
    outline = "getComputedStyle(document.activeElement).outlineStyle"
    assert shown.evaluate(f"document.activeElement !== document.body && {outline}") == "solid"


def test_a_page_is_printed_whole(shown: Page, kind: str) -> None:
    shown.emulate(width=A4, printed=True)
    assert shown.evaluate(CUT) == []
    hidden = "[...document.querySelectorAll('details:not(.finding details):not(.sheet) > :not(summary)')]"
    assert shown.evaluate(f"{hidden}.filter(e => !e.checkVisibility()).length") == 0
    if kind == "register":
        return  # more than a hundred sheets
    assert len(re.findall(rb"/Type\s*/Page\b", shown.pdf())) >= 1


def test_nothing_outside_can_be_asked_for(shown: Page, kind: str) -> None:
    shown.emulate()
    shown.evaluate(
        "void (document.body.append(Object.assign(new Image(), {src: 'http://x.test/a'})))"
    )
    shown.evaluate("fetch('http://x.test/b').catch(() => 0)")
    refused = [error for error in shown.errors if "Content Security Policy" in error]
    assert len(refused) >= 2
    assert [url for url in shown.outside if url.endswith("/b")] == []


def test_a_derivation_opens_where_it_is_asked_for(
    page: Page, proved: Planned, tmp_path: Path
) -> None:
    path = tmp_path / "plan.html"
    path.write_text(plan_page(proved), encoding="utf-8")
    page.open(path)
    page.click(".conditions a[href$='friction_margin']")
    target: Any = page.evaluate("document.querySelector(':target').textContent")
    assert "one_point_sticking.friction_margin" in target
    page.click(":target summary")
    assert page.evaluate("document.querySelector(':target').open")
    assert page.evaluate("document.querySelectorAll(':target math').length") == 2
