"""The tutorial's commands run, on shipped data, and print what the page shows."""

from __future__ import annotations

import re
import shlex
import shutil
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner

from meso_robust.cli import app
from meso_robust.guide import TUTORIAL
from reports.tutorial.walk import Command, commands, edited, missing

SET = Path(__file__).parent.parent / "example" / "set"
PAGE = commands(TUTORIAL.read_text(encoding="utf-8"))
QUICKER = {
    "plan": ("--samples", "50"),
    "track": ("--no-overlay",),
    "identify": ("--starts", "4"),
}
"""What makes a verb quick; the answer stays."""
NEGATIVE = ("identify",)
NOT_WALKED = ("--out edited", "--out middle")
"""Plans that are refuted after a long search; `make tutorial` walks them."""


def words_of(command: Command, folder: Path) -> list[str]:
    """Words of a command, as a shell would split and fill them in."""
    words: list[str] = []
    for word in shlex.split(command.text):
        found = sorted(folder.glob(word)) if "*" in word else []
        words += [str(path.relative_to(folder)) for path in found] or [word]
    return words


@pytest.fixture(scope="module")
def walk(tmp_path_factory: pytest.TempPathFactory) -> dict[str, tuple[Command, Any]]:
    """What each command printed, by its text; the videos but one are tracked already."""
    folder = tmp_path_factory.mktemp("walk with spaces µ")
    results: dict[str, tuple[Command, Any]] = {}
    with pytest.MonkeyPatch.context() as patched:
        patched.chdir(folder)
        for command in PAGE:
            if command.friction:
                edited(Path("task.toml"), command.friction)
            done = run(command)
            if done is not None:
                results[command.text] = command, done
            if "example" in command.text:
                patched.chdir(folder / "latch")
    return results


def run(command: Command) -> Any:
    """The result of a command; None for those of the shell and those that are left out."""
    text = command.text
    if text.startswith("sed "):
        edited(Path("again/task.toml"), "friction = [0.281, 0.288]")
        return None
    if text.startswith("cd ") or text.endswith(NOT_WALKED):
        return None
    given, text = text.split(" | ") if " | " in text else ("", text)
    words = words_of(Command(text, (), None), Path.cwd())[1:]
    more = QUICKER.get(words[0], ())
    if words[0] == "track":
        words = [word for word in words if not word.endswith(".mp4")]
        words.insert(1, "videos/push_5.mp4")
    done = CliRunner().invoke(
        app, [*words, *more], input=shlex.split(given)[-1] + "\n" if given else None
    )
    if words[0] == "track":
        shutil.copytree(SET, "set", dirs_exist_ok=True)
    return done


def result(walk: dict[str, tuple[Command, Any]], part: str) -> tuple[Command, Any]:
    (found,) = [walk[text] for text in walk if part in text]
    return found


def test_every_command_is_one_of_ours_and_most_are_walked(
    walk: dict[str, tuple[Command, Any]],
) -> None:
    verbs = [shlex.split(text.split(" | ")[-1])[1] for text in walk]

    assert verbs == [
        *("example", "plan", "track", "recordings", "identify", "diagnose"),
        *("plan", "plan", "check", "drive"),
    ]
    assert len(PAGE) == len(walk) + 4


def test_all_that_is_walked_ends_as_it_should(walk: dict[str, tuple[Command, Any]]) -> None:
    """A fit that is rejected is a negative answer, all else is none."""
    for text, (_, done) in walk.items():
        assert done.exit_code == any(part in text for part in NEGATIVE), f"{text}\n{done.output}"


@pytest.mark.parametrize(
    "part",
    ["recordings set", "plan task.toml --out first", "check last", "drive", "plan again/task.toml"],
)
def test_what_is_printed_is_what_the_page_shows(
    walk: dict[str, tuple[Command, Any]], part: str
) -> None:
    command, done = result(walk, part)
    shown = tuple(line for line in command.shown if "1000" not in line)  # fewer runs here

    assert shown
    assert missing(shown, done.stdout) == []


@pytest.mark.parametrize(
    ("part", "start"),
    [
        ("identify", "FIT REJECTED: viscous fitted to 8 recordings"),
        ("diagnose", "NAMED: part_geometry explains 100 % of the explainable error"),
        (
            "--model diagnosis",
            "PROVED (round tips, radius 12.5 µm): latch plate, with the model viscous+part_geometry",
        ),
    ],
)
def test_answers_of_searches_are_those_of_the_page(
    walk: dict[str, tuple[Command, Any]], part: str, start: str
) -> None:
    """Digits may differ between machines, the answer may not."""
    command, done = result(walk, part)

    assert command.shown[0].startswith(start)
    assert done.stdout.startswith(start)


def test_a_diagnosis_is_told_in_the_words_of_the_page(walk: dict[str, tuple[Command, Any]]) -> None:
    """All but the numbers, which may differ, also in sign where they are near zero."""
    command, done = result(walk, "diagnose")
    number = re.compile(r"−?\d[\d.]*(e[+−-]?\d+)?")
    shown = tuple(number.sub("0", line) for line in command.shown)

    assert missing(shown, number.sub("0", done.stdout)) == []


def test_the_radius_of_the_recordings_is_part_of_the_promise(
    walk: dict[str, tuple[Command, Any]],
) -> None:
    command, done = result(walk, "--model diagnosis")
    told = tuple(line for line in command.shown if "round tips" in line)

    assert len(told) == 2
    assert missing(told, done.stdout) == []
    assert "12.5 µm" in told[0]
    assert ": 50 of 50 runs end in the goal" in done.stdout


def test_a_page_that_shows_other_output_is_found_out() -> None:
    assert missing(("PROVED: x", "a …"), "PROVED: x\na b") == []
    assert missing(("PROVED: x",), "PROVED: x y") == ["PROVED: x"]
    assert missing(("b …",), "a b") == ["b …"]
