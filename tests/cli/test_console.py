"""What is shown on a terminal: any name as it is, and every part of a campaign from the beginning."""

from __future__ import annotations

import io
import sys

import pytest
import rich.console

from meso_robust.cli.console import Reporter

NAMES = ("[/x]", "[red]", "[bold]a[/bold]", "a\\")


@pytest.fixture
def terminal(monkeypatch: pytest.MonkeyPatch) -> io.StringIO:
    shown = io.StringIO()
    one = rich.console.Console(file=shown, force_terminal=True, width=100, color_system=None)
    monkeypatch.setattr(rich.console, "Console", lambda **_: one)
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True)
    return shown


@pytest.mark.parametrize("name", NAMES)
def test_names_are_shown_as_they_are(name: str, terminal: io.StringIO) -> None:
    say = Reporter()
    for begin in (
        lambda: say.doing(f"{name} of doing"),
        lambda: say.counting(f"{name} of counting", 3),
    ):
        with begin():
            pass
    with say.following() as told:
        told(f"{name} of following", 1, 3)
    with say.rating() as rated:
        rated(f"{name} of rating", (0, 3), None)
        rated(f"{name} of rating", (1, 3), (10, 0, "runs"))

    for what in ("doing", "counting", "following", "rating: 1 of 3 chunks, 0 failed"):
        assert f"{name} of {what}" in terminal.getvalue()


def test_a_part_is_shown_as_it_begins(terminal: io.StringIO) -> None:
    with Reporter().rating() as rated:
        rated("laws", (0, 1200), None)
        rated("rates", (2, 5), None)
    assert "laws: 0 of 1,200 chunks, begins" in terminal.getvalue()
    assert "rates: 2 of 5 chunks, begins" in terminal.getvalue()


def test_elsewhere_a_part_that_begins_is_a_line(capsys: pytest.CaptureFixture[str]) -> None:
    with Reporter().rating() as rated:
        rated("[red]", (0, 1200), None)
        rated("[red]", (1, 1200), (10, 0, "runs"))  # the next line comes ten seconds later
    assert capsys.readouterr().err == "[red]: 0 of 1,200 chunks, begins\n"
