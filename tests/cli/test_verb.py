"""Commands follow from calls: options and their limits from the signature, the ending from the result."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest
import typer

import meso_robust as mr
from meso_robust.api.result import Result
from meso_robust.cli import app
from meso_robust.cli.verb import end

LIMITS = {
    ("plan", "samples"): (1, 1_000_000),
    ("certify", "samples"): (1, 1_000_000),
    ("simulate", "dropout"): (0, 0.99),
    ("simulate", "latency_ms"): (0, 1000),
    ("simulate", "noise_um"): (0, None),
    ("track", "most_lost"): (0, 1),
    ("identify", "starts"): (1, 10_000),
    ("identify", "design"): (0, 100),
    ("identify", "confidence"): (0.5, 0.999),
    ("campaign", "workers"): (1, 1024),
    ("campaign", "seed"): (0, None),
}
CALLS: dict[str, Callable[..., object]] = {
    "plan": mr.plan, "certify": mr.certify, "check": mr.check, "simulate": mr.simulate, "track": mr.track,
    "recordings": mr.read_recordings, "identify": mr.identify, "diagnose": mr.diagnose,
    "campaign": mr.campaign, "reproduce": mr.reproduce,
}  # fmt: skip


def options(verb: str) -> dict[str, Any]:
    group: Any = typer.main.get_command(app)
    return {one.name: one for one in group.get_command(None, verb).params}


@pytest.mark.parametrize(("verb", "name"), LIMITS)
def test_limits_of_options_are_those_of_arguments(verb: str, name: str) -> None:
    option = options(verb)[name]
    limits = getattr(option, "type", option)  # Typer before 0.29 keeps them with Click's type
    assert (limits.min, limits.max) == LIMITS[verb, name]


@pytest.mark.parametrize("verb", CALLS)
def test_every_argument_is_an_option_that_is_explained(verb: str) -> None:
    found = options(verb)
    by_itself = {"folder", "store", "progress"}
    for name, stated in inspect.signature(CALLS[verb]).parameters.items():
        if name not in by_itself:
            assert (found[name].help or "").endswith((".", "…")), name
            assert "``" not in found[name].help, name
            given = stated.default not in (stated.empty, None, False)
            assert not given or found[name].default == stated.default, name
    assert found["as_json"].help.startswith("Print ")
    assert found["as_json"].opts == ["--json"]


def test_options_that_have_other_names_than_arguments() -> None:
    assert options("track")["set_file"].opts == ["--set"]
    assert options("track")["probes"].opts == ["--probe"]
    with pytest.raises(mr.InputError, match=r"set_file= SET\.toml") as caught:
        mr.track("x", pixel_um=1.0)
    assert "--" not in str(caught.value)


@dataclass(frozen=True, kw_only=True)
class Answer(Result):
    """An answer for a trial."""

    positive: bool = True
    notes: tuple[str, ...] = ()
    brief: str = ""
    why_not: str = ""

    def __str__(self) -> str:
        return "the answer"

    def text(self) -> str:
        return "{}\n"

    def files(self) -> dict[str, str]:
        return {"answer.json": self.text()}


@pytest.mark.parametrize(
    ("result", "asked", "printed", "noted", "status"),
    [
        (Answer(), (False, False), "the answer\nreport: out/report.html\n", "", 0),
        (Answer(), (True, False), "{}\n", "", 0),
        (Answer(), (False, True), "", "", 0),
        (Answer(brief="yes"), (False, True), "yes\n", "", 0),
        (Answer(brief="yes"), (True, True), "{}\n", "", 0),
        (Answer(notes=("a",)), (True, False), "{}\n", "meso-robust: note: a\n", 0),
        (Answer(notes=("a",)), (True, True), "{}\n", "", 0),
        (Answer(positive=False), (True, False), "{}\n", "", 1),
        (Answer(positive=False, why_not="lost"), (False, True), "", "meso-robust: lost\n", 1),
    ],
)
def test_how_a_verb_ends(
    result: Answer,
    asked: tuple[bool, bool],
    printed: str,
    noted: str,
    status: int,
    capsys: pytest.CaptureFixture[str],
) -> None:
    ended = 0
    try:
        end(result, Path("out"), *asked)
    except typer.Exit as leaving:
        ended = leaving.exit_code
    assert (*capsys.readouterr(), ended) == (printed, noted, status)
