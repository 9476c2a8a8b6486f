"""The live page: a server of this machine alone that shows the run and can stop it."""

from __future__ import annotations

import json
import threading
import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Any

import cv2
import numpy as np

from meso_robust.live.conductor import Phase, told
from meso_robust.live.lab_file import Lab
from meso_robust.live.loop import Glimpse, Words
from meso_robust.live.sight import DEG, SIGMAS, UM, Sight, Trust, calibration_of
from meso_robust.types import Floats, Image

HOST = "127.0.0.1"
PAGE = Path(__file__).parent / "page.html"
QUALITY = 80  # of the JPEG that is shown
NOTHING = "–"
LINGER = 0.5  # s, in which a page that asks every 0.15 s is told how the run ended


@dataclass(slots=True, eq=False)
class Shown:
    """What the page shows now; the loop writes it, requests read it."""

    state: dict[str, Any] = field(default_factory=dict)
    image: Image | None = None
    lock: threading.Lock = field(default_factory=threading.Lock)


class View:
    """Turns of the loop, as the page shows them.

    Parameters
    ----------
    lab, trust
        The laboratory, and how accurate a pose must be.
    outline
        (V, 2) corners of the part, m.
    """

    def __init__(self, lab: Lab, trust: Trust, outline: Floats) -> None:
        self._lab, self._trust, self._outline = lab, trust, outline
        self._calibration = calibration_of(lab.camera)
        self.shown = Shown(state=self._state(None))

    def show(self, glimpse: Glimpse) -> None:
        """Take a turn of the loop."""
        state = self._state(glimpse)
        with self.shown.lock:
            if glimpse.frame is None:
                kept = ("outline", "pose", "sigma", "margin", "trusted", "number", "latency")
                state |= {key: self.shown.state[key] for key in kept}
            else:
                self.shown.image = glimpse.frame.image
            self.shown.state = state

    def _state(self, glimpse: Glimpse | None) -> dict[str, Any]:
        camera = self._lab.camera
        sight = None if glimpse is None else glimpse.sight
        conductor = None if glimpse is None else glimpse.conductor
        move = None if conductor is None or conductor.phase is Phase.SEEING else conductor.move
        ending = None if conductor is None else conductor.outcome
        phase = (
            "begins"
            if conductor is None
            else f"{conductor.made} moves made: {conductor.phase.value}"
        )
        late = 0.0 if glimpse is None else 1e3 * glimpse.latency
        return {
            "size": [camera.width_px, camera.height_px],
            "number": 0 if glimpse is None or glimpse.frame is None else glimpse.frame.number,
            "phase": phase if ending is None else f"{ending.outcome}: {ending.text}",
            "ended": ending is not None,
            "trusted": sight is not None and sight.pose is not None,
            "latency": f"{late:.1f} ms",
            **self._seen(sight),
            **self._coming(move),
        }

    def _seen(self, sight: Sight | None) -> dict[str, Any]:
        if sight is None or sight.pose is None or sight.sigma is None:
            why = NOTHING if sight is None else sight.reason
            return {"pose": why, "sigma": NOTHING, "margin": NOTHING, "outline": []}
        x, y, theta = sight.pose
        wide, turn = SIGMAS * max(sight.sigma[:2]), SIGMAS * sight.sigma[2]
        trust = self._trust
        room = min(1.0 - wide / trust.position_um, 1.0 - turn / trust.orientation_deg)
        c, s = np.cos(theta * DEG), np.sin(theta * DEG)
        corners = self._outline @ np.array([[c, s], [-s, c]]) + np.array([x, y]) * UM
        return {
            "pose": f"{x:.1f}, {y:.1f} um, {theta:.2f} deg",
            "sigma": f"{wide:.2f} um, {turn:.3f} deg",
            "margin": f"{100.0 * room:.0f} %",
            "outline": self._px(corners),
        }

    def _coming(self, move: Mapping[str, Any] | None) -> dict[str, Any]:
        if move is None:
            return {"move": NOTHING, "expect": NOTHING, "box": [], "tips": []}
        expect, travel = move.get("expect"), np.array(move["travel_um"])
        box, words = [], "nothing is certified"
        if expect:
            (a, b), (c, d) = expect["x_um"], expect["y_um"]
            box = self._px(np.array([[a, c], [b, c], [b, d], [a, d]]) * UM)
            low, high = expect["theta_deg"]
            words = f"x {a:.1f} … {b:.1f}, y {c:.1f} … {d:.1f} um, {low:.2f} … {high:.2f} deg"
        radii = {tip.name: tip.radius_um for one in self._lab.manipulators for tip in one.tips}
        tips = []
        for tip in move["probes"]:
            start = np.array(tip["start_um"])
            end = start if tip.get("passive") else start + travel
            ends = self._px(np.array([start, end]) * UM)
            size = max(radii.get(tip["name"], 0.0) / self._lab.camera.pixel_size_um, 4.0)
            tips.append([*ends, size])
        return {"move": told(move), "expect": words, "box": box, "tips": tips}

    def _px(self, points: Floats) -> list[list[float]]:
        rows: list[list[float]] = np.round(self._calibration.to_pixels(points), 1).tolist()
        return rows


class _Handler(BaseHTTPRequestHandler):
    """Answers the page's own requests."""

    shown: Shown
    words: Words

    def do_GET(self) -> None:
        """The page, its state, its picture."""
        path = self.path.split("?")[0]
        if not self._own():
            return
        if path == "/":
            self._answer("text/html; charset=utf-8", PAGE.read_bytes())
        elif path == "/state":
            with self.shown.lock:
                body = json.dumps(self.shown.state, allow_nan=False).encode()
            self._answer("application/json", body)
        elif path == "/frame.jpg" and self.shown.image is not None:
            _, code = cv2.imencode(".jpg", self.shown.image, [cv2.IMWRITE_JPEG_QUALITY, QUALITY])
            self._answer("image/jpeg", code.tobytes())
        else:
            self.send_error(404)

    def do_POST(self) -> None:
        """Stop: the one thing that can be asked."""
        if not self._own():
            return
        if self.path == "/stop":
            self.words.say("stop")
            self._answer("application/json", b"{}")
        else:
            self.send_error(404)

    def _own(self) -> bool:
        """Whether this machine is meant: a name of elsewhere that leads here is another page's."""
        host = self.headers.get("Host") or ""
        origin = self.headers.get(
            "Origin"
        )  # of the page that asks; a browser always says it of a POST
        here = host.rsplit(":", 1)[0] in (HOST, "localhost")
        if here and origin in (None, f"http://{host}"):
            return True
        self.send_error(403)
        return False

    def _answer(self, kind: str, body: bytes) -> None:
        self.send_response(200)
        self.send_header("Content-Type", kind)
        self.send_header("Content-Length", str(len(body)))
        self.send_header("Cache-Control", "no-store")
        self.send_header("Content-Security-Policy", "default-src 'self' 'unsafe-inline' data:")
        self.end_headers()
        self.wfile.write(body)

    def log_message(self, format: str, *args: object) -> None:  # noqa: A002 - its name there
        """Nothing."""


class _Server(ThreadingHTTPServer):
    daemon_threads = True

    def handle_error(self, request: Any, client_address: Any) -> None:
        """Nothing: a browser may close a connection whenever it likes."""


@contextmanager
def served(shown: Shown, words: Words, port: int = 0) -> Iterator[str]:
    """A page while a block runs.

    Parameters
    ----------
    shown
        What it shows.
    words
        Where its stop goes.
    port
        0: any that is free.

    Yields
    ------
    str
        Its address.
    """
    handler = type("Handler", (_Handler,), {"shown": shown, "words": words})
    server = _Server((HOST, port), handler)
    thread = threading.Thread(target=server.serve_forever, args=(0.05,), daemon=True)
    thread.start()
    try:
        yield f"http://{HOST}:{server.server_address[1]}/"
    finally:
        if shown.state.get("ended"):
            time.sleep(LINGER)
        server.shutdown()
        server.server_close()
        thread.join()
