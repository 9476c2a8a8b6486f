"""The animation: one page that needs nothing else and shows the runs as they were."""

from __future__ import annotations

import json
import re
import shutil
import subprocess
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from markupsafe import escape

from meso_robust.laboratory.running import PlanRun
from meso_robust.laboratory.simulation import Case, Simulated, player_of, simulated
from meso_robust.laboratory.simulation_answer import document
from meso_robust.planning.document import PlanDocument
from meso_robust.primitives.setup import setup_of
from meso_robust.reporting.animation import animation, data, embedded
from tests.conftest import paper_task

REPORT = Path(__file__).parents[2] / "reports" / "paper_task"
EVIL = "</script><script>alert('1')</script> & <b>"
CHROMIUM = shutil.which("chromium") or shutil.which("google-chrome")


@pytest.fixture(scope="module")
def found() -> Simulated:
    """The paper's plan, 30 samples, with the adversary."""
    task = paper_task()
    text = (REPORT / "plan.json").read_text(encoding="utf-8")
    plan = PlanDocument.model_validate_json(text)
    player = player_of(plan, setup_of(task))
    return simulated(task, plan, player, samples=30, seed=4, adversarial=True)


def with_modes(found: Simulated) -> Simulated:
    """The same with contact modes in the nominal run: dtp_bottom sticks, later slips."""
    moves = []
    for move in found.nominal.runs.moves:
        modes = np.zeros_like(move.modes)
        modes[0, 10:50, 1], modes[0, 50:, 1] = 1, 3
        moves.append(replace(move, modes=modes))
    runs = PlanRun(
        moves=tuple(moves),
        outcomes=found.nominal.runs.outcomes,
        failed_in=found.nominal.runs.failed_in,
    )
    return replace(found, nominal=Case(row=found.nominal.row, runs=runs))


class Elements(HTMLParser):
    """Start tags, and the text of the script that holds the data."""

    def __init__(self, page: str) -> None:
        super().__init__()
        self.tags: list[tuple[str, dict[str, str | None]]] = []
        self.text: dict[str, str] = {}
        self.feed(page)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append((tag, dict(attrs)))

    def handle_data(self, data: str) -> None:
        tag, attributes = self.tags[-1] if self.tags else ("", {})
        name = attributes.get("id") or tag
        self.text[name] = self.text.get(name, "") + data


def page_of(found: Simulated) -> str:
    return animation(found, document(found))


def played(page: str) -> Any:
    return json.loads(Elements(page).text["data"])


def test_page_shows_at_most_twenty_runs_the_nominal_and_the_worst_first(found: Simulated) -> None:
    names = [run["name"] for run in played(page_of(found))["runs"]]

    assert names[:2] == ["nominal", "worst found"]
    assert len(names) == len(set(names)) == 20
    sampled = np.abs(found.sampled.final * [1e6, 1e6, 180 / np.pi] - [0, 0, 180]) / [76, 76, 5]
    assert names[2] == f"sample {sampled.max(axis=1).argmax()}"


def test_page_plays_the_runs_to_a_hundredth_of_a_micrometre(found: Simulated) -> None:
    first = played(page_of(found))["runs"][0]

    for shown, move in zip(first["moves"], found.nominal.runs.moves, strict=True):
        assert np.abs(np.array(shown["x"]) - move.path[0, :, 0] * 1e6).max() <= 0.00501
        assert np.abs(np.array(shown["y"]) - move.path[0, :, 1] * 1e6).max() <= 0.00501
        assert np.abs(np.array(shown["t"]) - np.degrees(move.path[0, :, 2])).max() <= 0.000501
        assert np.abs(np.array(shown["tips"]) - move.tips[0] * 1e6).max() <= 0.00501
        assert np.abs(np.array(shown["travel"]) - move.travel[0] * 1e6).max() <= 0.00501
    assert first["good"] is True
    assert first["moves"][-1]["stop"] == 1.0


@pytest.mark.parametrize(("goal_x_um", "goal_y_um"), [(0.0, 0.0), (5000.0, 4000.0)])
def test_everything_that_is_shown_lies_in_view(
    found: Simulated, goal_x_um: float, goal_y_um: float
) -> None:
    task = paper_task(goal__x_um=goal_x_um, goal__y_um=goal_y_um)
    values = data(replace(found, task=task))
    left, low, right, high = values["extent"]
    assert left < goal_x_um - 808 < goal_x_um + 808 < right
    assert low < goal_y_um - 418.5 < goal_y_um + 418.5 < high
    corners = np.array([[-808, -418.5], [808, -418.5], [808, 418.5], [-808, 418.5]])

    for run in values["runs"]:
        for move in run["moves"]:
            for x, y, theta in zip(move["x"], move["y"], move["t"], strict=True):
                c, s = np.cos(np.radians(theta)), np.sin(np.radians(theta))
                seen = corners @ np.array([[c, s], [-s, c]]) + [x, y]
                assert (seen >= [left, low]).all()
                assert (seen <= [right, high]).all()


def test_moves_last_as_long_as_the_travel_at_the_plan_s_speed(found: Simulated) -> None:
    moves = data(found)["moves"]
    shown = data(found)["runs"][0]["moves"]

    # the shipped plan travels 199.3, 398.2 and 1340.9 um at 75 um/s; the last travel is our own
    assert [move["seconds"] for move in moves[:3]] == pytest.approx(
        [199.3 / 75, 398.2 / 75, 1340.9 / 75], abs=1e-3
    )
    assert moves[3]["seconds"] == pytest.approx(-shown[3]["travel"][-1][0] / 75, abs=1e-3)
    assert [move["passive"] for move in moves][2] == [False, False, True]


def test_contact_modes_are_embedded_as_one_digit_an_instant(found: Simulated) -> None:
    runs = data(with_modes(found))["runs"]

    assert runs[0]["moves"][0]["modes"] == ["0" * 97, "0" * 10 + "1" * 40 + "3" * 47]


def test_page_needs_nothing_else(found: Simulated) -> None:
    page = page_of(found)
    elements = Elements(page)

    assert len(page.encode()) < 1_500_000
    assert "http" not in page.replace("http-equiv", "")
    addresses = [
        value
        for _, attributes in elements.tags
        for key, value in attributes.items()
        if key in ("src", "href", "action", "data")
    ]
    assert {address[0] for address in addresses if address} == {"#"}
    policy = next(a["content"] for tag, a in elements.tags if a.get("http-equiv"))
    assert "default-src 'none'" in (policy or "")
    assert not re.search(r"\bfetch\(|XMLHttpRequest|WebSocket|import\(|@import|url\(", page)


def test_names_of_the_user_are_shown_and_never_run(found: Simulated) -> None:
    task = found.task.model_copy(update={"name": EVIL})
    moves = tuple(m.model_copy(update={"primitive": EVIL}) for m in found.plan.moves)
    evil = replace(found, task=task, plan=found.plan.model_copy(update={"moves": moves}))

    page = page_of(evil)

    assert [tag for tag, _ in Elements(page).tags].count("script") == 2  # the data, and ours
    assert "b" not in [tag for tag, _ in Elements(page).tags]
    assert f"<bdi>{escape(EVIL)}</bdi>" in page
    assert played(page)["moves"][0]["name"] == EVIL


def test_embedded_json_is_the_same_json() -> None:
    values = {"a<b>&c": ["</script>", "<!--", "\u2028 µ"], "n": [1.25, None, True]}

    text = str(embedded(values))

    assert json.loads(text) == values
    assert not set("<>&") & set(text)


@pytest.mark.skipif(CHROMIUM is None, reason="no Chromium on this machine")
def test_browser_plays_without_an_error(found: Simulated, tmp_path: Path) -> None:
    """At the end of the plan the page shows the pose at which the simulator ended."""
    page = tmp_path / "animation.html"
    page.write_text(page_of(with_modes(found)), encoding="utf-8")
    flags = "--headless --no-sandbox --disable-gpu --disable-quic --no-first-run --disable-sync"
    command = [
        str(CHROMIUM),
        *flags.split(),
        "--disable-background-networking",
        "--disable-component-update",
        f"--user-data-dir={tmp_path / 'profile'}",
        "--virtual-time-budget=1000",
        "--enable-logging=stderr",
        "--dump-dom",
        f"{page.as_uri()}#run=0&at=1",
    ]

    done = subprocess.run(command, capture_output=True, text=True, check=True, timeout=60)
    text = Elements(done.stdout).text

    assert "CONSOLE" not in done.stderr
    x, y, theta = found.nominal.runs.final[0] * [1e6, 1e6, 180 / np.pi]
    shown = [float(text[f"now-{k}"].replace("−", "-")) for k in ("x", "y", "theta")]
    assert shown == pytest.approx([x, y, theta], abs=0.06)
    assert text["now-move"].strip() == "4 of 4, x translation"
    assert "dtp_bottom: slip −" in done.stdout
