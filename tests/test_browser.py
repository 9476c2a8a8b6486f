"""The harness itself: that it sees what it is there to see."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.browser import BrowserError, Page

TRIAL = """<!DOCTYPE html><html lang="en"><head><title>trial</title>
<style>body { background: rgb(255, 255, 255) }
@media (prefers-color-scheme: dark) { body { background: rgb(0, 0, 0) } }
@media print { body { background: rgb(9, 9, 9) } }
button { width: 80px; height: 40px } input { width: 200px }</style></head>
<body><button id="a">a</button><input id="s" type="range" min="0" max="10" step="0.5" value="1">
<output id="o"></output><script>
document.querySelector("#a").addEventListener("click", e => {
  document.querySelector("#o").textContent = "clicked " + e.isTrusted; });
document.querySelector("#s").addEventListener("input", e => {
  document.querySelector("#o").textContent = "slid " + e.target.value; });
document.addEventListener("keydown", e => { document.title = e.key + (e.shiftKey ? " shift" : ""); });
</script>SCRIPT</body></html>"""
BODY = "getComputedStyle(document.body).backgroundColor"
OUTPUT = "document.querySelector('#o').textContent"


def opened(page: Page, folder: Path, script: str = "") -> Page:
    path = folder / "trial ä.html"
    path.write_text(TRIAL.replace("SCRIPT", script), encoding="utf-8")
    page.open(path)
    return page


def test_hands_and_keys(page: Page, tmp_path: Path) -> None:
    opened(page, tmp_path)
    page.click("#a")
    assert page.evaluate(OUTPUT) == "clicked true"
    page.slide("#s", 4.5)
    assert page.evaluate(OUTPUT) == "slid 4.5"
    page.drag("#s", 90)
    assert page.evaluate("Number(document.querySelector('#s').value)") > 8
    page.press("ArrowLeft", shift=True)
    assert page.evaluate("document.title") == "ArrowLeft shift"
    page.press("Tab")
    assert page.evaluate("document.activeElement.tagName") != "INPUT"
    assert (page.errors, page.outside) == ([], [])


def test_reader(page: Page, tmp_path: Path) -> None:
    opened(page, tmp_path)
    assert page.evaluate(BODY) == "rgb(255, 255, 255)"
    page.emulate(dark=True, width=380, still=True)
    assert page.evaluate(BODY) == "rgb(0, 0, 0)"
    assert page.evaluate("innerWidth") == 380
    assert page.evaluate("matchMedia('(prefers-reduced-motion: reduce)').matches")
    page.emulate(printed=True)
    assert page.evaluate(BODY) == "rgb(9, 9, 9)"
    assert page.pdf().startswith(b"%PDF")
    page.screenshot(tmp_path / "page.png")
    assert (tmp_path / "page.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize(
    ("script", "said"),
    [
        ("<script>console.error('first', 7)</script>", "first 7"),
        ("<script>missing.name</script>", "missing is not defined"),
        ("<script>Promise.reject(new Error('lost'))</script>", "lost"),
    ],
)
def test_errors_are_seen(page: Page, tmp_path: Path, script: str, said: str) -> None:
    opened(page, tmp_path, script)
    assert len(page.errors) == 1
    assert said in page.errors[0]
    opened(page, tmp_path)
    assert page.errors == []


def test_outside_requests_are_seen(page: Page, tmp_path: Path) -> None:
    inside = '<img alt="" src="data:image/gif;base64,R0lGODlhAQABAAAAACw=">'
    opened(page, tmp_path, inside + '<img alt="" src="other.png"><img alt="" src="http://x.test/">')
    names = sorted(url.rsplit("/", 2)[-2:] for url in page.outside)
    assert names == sorted([["x.test", ""], [tmp_path.name, "other.png"]])


def test_a_fault_is_told(page: Page, tmp_path: Path) -> None:
    opened(page, tmp_path)
    with pytest.raises(BrowserError, match="nothing on the page is #none"):
        page.click("#none")
    with pytest.raises(BrowserError, match="not true within"):
        page.wait("false", seconds=0.05)
    with pytest.raises(BrowserError, match="is not defined"):
        page.evaluate("missing")
    with pytest.raises(BrowserError, match="ERR_FILE_NOT_FOUND"):
        page.open(tmp_path / "absent.html")
