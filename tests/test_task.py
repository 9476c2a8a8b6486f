"""Task files: what is refused, with which words, and what the hash depends on."""

from __future__ import annotations

import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from meso_robust.errors import InputError
from meso_robust.task import Part, load_task, parse_task
from meso_robust.tasks import PAPER

TEXT = PAPER.read_text(encoding="utf-8")


def changed(old: str, new: str) -> str:
    assert TEXT.count(old) == 1
    return TEXT.replace(old, new)


def refused(tmp_path: Path, text: str) -> str:
    path = tmp_path / "task.toml"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(InputError) as caught:
        load_task(path)
    message = str(caught.value)
    assert message.startswith(f"{path}: ")
    return message.removeprefix(f"{path}: ")


BAD = {
    "missing key": ("speed_um_s = 75.0", "", ("probe.speed_um_s", "is missing")),
    "misspelt section": ("[plan]", "[plans]", ("key plans", "is unknown", "mean 'plan'?")),
    "missing section": (
        """[plan]
least_y_translations = 1          # Section X-C: "one robust Y motion followed by one robust rotation"
""",
        "",
        ("key plan", "is missing"),
    ),
    "unknown key": ("[plan]\n", "[plan]\nspeed = 3\n", ("plan.speed", "is unknown")),
    "unknown section": ("[plan]", "[extra]\n[plan]", ("extra", "is unknown")),
    "text as number": (
        "length_um = 1616.0",
        'length_um = "long"',
        ("part.length_um", "'long'", "number"),
    ),
    "number as text": ('name = "paper, Section IX-E"', "name = 3", ("name", "3", "string")),
    "truth as number": ("length_um = 1616.0", "length_um = true", ("part.length_um", "True")),
    "truth as count": (
        "least_y_translations = 1 ",
        "least_y_translations = true ",
        ("plan.least_y_translations", "True", "integer"),
    ),
    "fraction as count": (
        "least_y_translations = 1 ",
        "least_y_translations = 1.5 ",
        ("plan.least_y_translations", "1.5", "integer"),
    ),
    "number as section": ("[plan]\nleast_y_translations = 1 ", "[[plan]]\nx = 1 ", ("plan",)),
    "negative length": (
        "width_um = 837.0",
        "width_um = -837.0",
        ("part.width_um", "-837.0", "greater than or equal to 1"),
    ),
    "zero spacing": (
        "tip_spacing_um = 580.0",
        "tip_spacing_um = 0.0",
        ("probe.tip_spacing_um", "0.0", "greater than or equal to 1"),
    ),
    "negative error": (
        "sensed_position_um = 5.0",
        "sensed_position_um = -5.0",
        ("uncertainty.sensed_position_um", "-5.0", "greater than or equal to 0"),
    ),
    "negative friction": (
        "friction = [0.30, 0.36]",
        "friction = [-0.1, 0.36]",
        ("uncertainty.friction.0", "-0.1", "greater than or equal to 0"),
    ),
    "inverted friction": (
        "friction = [0.30, 0.36]",
        "friction = [0.36, 0.30]",
        ("uncertainty", "friction = [0.36, 0.3]", "lower end must not exceed"),
    ),
    "inverted misalignment": (
        "[-0.25, 0.25]",
        "[0.25, -0.25]",
        ("uncertainty", "tip_misalignment_deg = [0.25, -0.25]", "lower end must not exceed"),
    ),
    "range of three": (
        "friction = [0.30, 0.36]",
        "friction = [0.30, 0.33, 0.36]",
        ("uncertainty.friction", "[0.3, 0.33, 0.36]", "at most 2"),
    ),
    "range of one": (
        "friction = [0.30, 0.36]",
        "friction = [0.30]",
        ("uncertainty.friction.1", "is missing"),
    ),
    "not a number": ("x_um = 2060.4", "x_um = nan", ("start.x_um", "nan", "finite")),
    "not a number in a range": (
        "friction = [0.30, 0.36]",
        "friction = [0.30, nan]",
        ("uncertainty.friction.1", "nan", "finite"),
    ),
    "infinite": ("y_um = -9.2", "y_um = -inf", ("start.y_um", "-inf", "finite")),
    "misaligned beyond use": (
        "[-0.25, 0.25]",
        "[-45.0, 0.25]",
        ("uncertainty.tip_misalignment_deg.0", "-45.0", "greater than -30"),
    ),
    "whole film error": (
        "film_ratio_percent = 5.0",
        "film_ratio_percent = 100.0",
        ("uncertainty.film_ratio_percent", "100.0", "less than 100"),
    ),
    "turned too often": (
        "theta_deg = 90.0",
        "theta_deg = 450.0",
        ("start.theta_deg", "450.0", "less than or equal to 360"),
    ),
    "tolerance beyond a right angle": (
        "orientation_tolerance_deg = 5.0",
        "orientation_tolerance_deg = 90.0",
        ("goal.orientation_tolerance_deg", "90.0", "less than 90"),
    ),
    "too many translations": (
        "least_y_translations = 1 ",
        "least_y_translations = 7 ",
        ("plan.least_y_translations", "7", "less than or equal to 6"),
    ),
    "wider than long": (
        "width_um = 837.0",
        "width_um = 1700.0",
        ("part", "width_um = 1700.0 exceeds length_um = 1616.0", "give the long side"),
    ),
    "another schema": (
        'schema = "meso-robust/task/1"',
        'schema = "meso-robust/task/3"',
        ("schema", "meso-robust/task/3", "meso-robust/task/1", "meso-robust/task/2"),
    ),
}


@pytest.mark.parametrize("name", BAD)
def test_bad_values_are_refused_with_key_value_and_rule(name: str, tmp_path: Path) -> None:
    old, new, words = BAD[name]
    message = refused(tmp_path, changed(old, new))
    for word in words:
        assert word in message, message


def test_a_missing_file_is_named(tmp_path: Path) -> None:
    path = tmp_path / "nowhere.toml"
    with pytest.raises(InputError, match=r"nowhere\.toml: cannot be read \(No such file"):
        load_task(path)


def test_a_folder_is_not_a_task(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="cannot be read"):
        load_task(tmp_path)


@pytest.mark.parametrize("text", ["part = [", "schema: meso-robust/task/1", "x = 1\nx = 2"])
def test_what_is_not_toml_is_refused(text: str, tmp_path: Path) -> None:
    assert refused(tmp_path, text).startswith("is not a TOML file")


def test_what_is_not_utf_8_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "task.toml"
    path.write_bytes(b'name = "\xff\xfe"')
    with pytest.raises(InputError, match="is not a TOML file in UTF-8"):
        load_task(path)


def test_an_empty_file_misses_a_key(tmp_path: Path) -> None:
    assert "is missing" in refused(tmp_path, "")


def test_values_that_are_no_file_name_their_source() -> None:
    with pytest.raises(InputError, match=r"^request 7: key schema is missing"):
        parse_task({}, "request 7")


def test_the_shipped_task_is_read_as_written() -> None:
    task = load_task(PAPER)
    assert task.part == Part(length_um=1616.0, width_um=837.0)
    assert (task.start.x_um, task.start.y_um, task.start.theta_deg) == (2060.4, -9.2, 90.0)
    assert task.uncertainty.friction == (0.30, 0.36)
    assert task.goal.position_tolerance_um == 76.0


def test_whole_numbers_are_lengths_too(tmp_path: Path) -> None:
    path = tmp_path / "task.toml"
    path.write_text(changed("width_um = 837.0", "width_um = 837"), encoding="utf-8")
    assert load_task(path) == load_task(PAPER)
    assert load_task(path).hash == load_task(PAPER).hash


def test_a_task_cannot_be_changed() -> None:
    task = load_task(PAPER)
    with pytest.raises(ValueError, match="frozen"):
        task.goal.x_um = 1.0


@pytest.mark.parametrize(
    "layout",
    [
        lambda text: "# a comment\n\n" + text,
        lambda text: text.replace(" = ", "="),
        lambda text: "\n".join(line.split("#")[0].rstrip() for line in text.splitlines()),
        lambda text: text.replace("0.30", "0.3").replace("837.0", "8.37e2"),
        lambda text: text.replace(
            "length_um = 1616.0\nwidth_um = 837.0", "width_um = 837.0\nlength_um = 1616.0"
        ),
    ],
    ids=["comment", "spaces", "bare", "notation", "order"],
)
def test_the_hash_ignores_layout(layout: Callable[[str], str], tmp_path: Path) -> None:
    path = tmp_path / "task.toml"
    path.write_text(layout(TEXT), encoding="utf-8")
    assert path.read_text(encoding="utf-8") != TEXT
    assert load_task(path).hash == load_task(PAPER).hash


def leaves(values: dict[str, Any], above: tuple[str, ...] = ()) -> list[tuple[str, ...]]:
    found = []
    for key, value in values.items():
        found += leaves(value, (*above, key)) if isinstance(value, dict) else [(*above, key)]
    return found


@pytest.mark.parametrize(
    "where", [leaf for leaf in leaves(tomllib.loads(TEXT)) if leaf != ("schema",)], ids=".".join
)
def test_the_hash_depends_on_every_value(where: tuple[str, ...]) -> None:
    values = tomllib.loads(TEXT)
    section = values
    for key in where[:-1]:
        section = section[key]
    old = section[where[-1]]
    if isinstance(old, list):
        section[where[-1]] = [old[0], old[1] + 0.01]
    elif isinstance(old, str):
        section[where[-1]] = old + "!"
    else:
        section[where[-1]] = old + 1
    assert parse_task(values, "changed").hash != load_task(PAPER).hash
