"""The live page in a real browser: what it shows, what it asks for, and its stop."""

from __future__ import annotations

import urllib.error
import urllib.request
from dataclasses import replace

import numpy as np
import pytest

from meso_robust.live.devices import Frame
from meso_robust.live.loop import Glimpse, Words
from meso_robust.live.page import View, served
from tests.browser import Page
from tests.live.rig import DONE, LOST, MOVE, TRUST, Rig, lab, sight

OUTLINE = np.array([[-300e-6, -150e-6], [300e-6, -150e-6], [300e-6, 150e-6], [-300e-6, 150e-6]])
WITH_BOX = {
    **MOVE,
    "expect": {"x_um": [900.0, 950.0], "y_um": [-10.0, 10.0], "theta_deg": [89.0, 91.0]},
}


def view_of(rig: Rig, view: View) -> None:
    image = np.full((480, 640), 80, np.uint8)
    frame = Frame(number=rig.number, time=rig.time, image=image)
    view.show(
        Glimpse(
            frame=frame,
            sight=rig.sight,
            conductor=rig.conductor,
            commands=(),
            latency=0.0123,
            places={},
        )
    )


def test_the_page_shows_the_run_and_stops_it(page: Page) -> None:
    answers = iter([WITH_BOX, DONE])
    rig = Rig(lambda *_: next(answers))
    rig.sight = sight(500.0, 100.0, 90.0)
    rig.until("placing")
    view, words = View(lab(), TRUST, OUTLINE), Words()
    view_of(rig, view)
    with served(view.shown, words) as address:
        page.url = address
        page.send("Page.navigate", url=address)
        page.wait("document.querySelector('#pose')?.textContent.startsWith('500.0')")
        page.wait("document.querySelector('#frame').naturalWidth === 640")
        text = "document.querySelector('{}').textContent".format
        assert page.evaluate(text("#phase")) == "0 moves made: placing"
        assert "by (-150.0, 0.0) um at 75 um/s" in page.evaluate(text("#move"))
        assert page.evaluate(text("#expect")).startswith("x 900.0 … 950.0")
        assert page.evaluate(text("#margin")) == "70 %"
        assert page.evaluate(text("#latency")) == "12.3 ms"
        points = page.evaluate("document.querySelector('.part').getAttribute('points')")
        # the middle of the image is the origin, a pixel is 5 um, the part stands upright
        first = [float(v) for v in points.split(" ")[0].split(",")]
        assert first == pytest.approx(
            [319.5 + (500.0 + 150.0) / 5.0, 239.5 - (100.0 - 300.0) / 5.0], abs=0.1
        )
        assert page.evaluate("document.querySelectorAll('.tip').length") == 2
        assert page.evaluate("document.querySelectorAll('.box').length") == 1

        page.click("#stop")
        page.wait("true")
        for _ in range(100):
            if (word := words.take()) == "stop":
                break
            page.draw()
        assert word == "stop"
        rig.turn(word=word)
        rig.sight = LOST
        rig.end()
        view_of(rig, view)
        page.wait("document.querySelector('#phase').textContent.startsWith('stopped')")
        assert page.evaluate("document.querySelector('#stop').disabled")
        assert page.evaluate("document.querySelectorAll('.part').length") == 0
        assert all(url.startswith((address, "data:")) for url in page.requests)
        assert page.errors == []


def asked(address: str, host: str | None = None, data: bytes | None = None) -> int:
    request = urllib.request.Request(
        address, data=data, headers={} if host is None else {"Host": host}
    )
    try:
        with urllib.request.urlopen(request, timeout=10.0) as answer:
            return int(answer.status)
    except urllib.error.HTTPError as error:
        return error.code


def test_a_page_of_elsewhere_is_not_answered() -> None:
    view, words = View(lab(), TRUST, OUTLINE), Words()
    with served(view.shown, words) as address:
        assert address.startswith("http://127.0.0.1:")
        assert asked(address + "state") == 200
        assert asked(address + "state", host="evil.example") == 403
        assert asked(address + "stop", host="evil.example:80", data=b"") == 403
        assert words.take() == ""
        assert asked(address + "stop", data=b"") == 200
        assert words.take() == "stop"
        assert asked(address + "lab.toml") == 404
        assert asked(address + "frame.jpg") == 404
        assert asked(address + "go", data=b"") == 404


def test_what_was_seen_last_stays_between_frames() -> None:
    answers = iter([MOVE])
    rig = Rig(lambda *_: next(answers))
    rig.until("placing")
    view = View(lab(), TRUST, OUTLINE)
    view_of(rig, view)
    before = dict(view.shown.state)
    blank = Glimpse(
        frame=None, sight=None, conductor=rig.conductor, commands=(), latency=0.0, places={}
    )
    view.show(replace(blank))
    assert view.shown.state["outline"] == before["outline"] != []
    assert view.shown.state["pose"] == before["pose"]
