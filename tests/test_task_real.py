"""Tasks of schema 2, about real probes and real parts: what is refused, and what the verdict line says."""

from __future__ import annotations

import math
import tomllib
from fractions import Fraction
from typing import Any

import numpy as np
import pytest

from meso_robust.corners import straight_edges
from meso_robust.errors import InputError
from meso_robust.primitives.setup import setup_of
from meso_robust.task import SCHEMA_2_KEYS, Film, Part, Probe, Task, Uncertainty, parse_task
from meso_robust.tasks import PAPER

ROUND = {"schema": "meso-robust/task/2", "probe.tip_radius_um": [2.5, 12.5]}
HEXAGON = [(450, -260), (450, 260), (0, 520), (-450, 260), (-450, -260), (0, -520)]
ELL = [(-440, -440), (760, -440), (760, -40), (-40, -40), (-40, 760), (-440, 760)]


def values(changes: dict[str, Any]) -> dict[str, Any]:
    found = tomllib.loads(PAPER.read_text(encoding="utf-8"))
    found["schema"] = "meso-robust/task/1"
    found["probe"].pop("tip_radius_um", None)
    for key, value in changes.items():
        section, _, name = key.rpartition(".")
        (found.setdefault(section, {}) if section else found)[name] = value
    return found


BAD: dict[str, tuple[dict[str, Any], tuple[str, ...]]] = {
    "no radius": (
        {"schema": "meso-robust/task/2"},
        ("probe.tip_radius_um is missing", "meso-robust/task/2", "give the range [low, high]"),
    ),
    "a number as radius": ({**ROUND, "probe.tip_radius_um": 12.5}, ("probe.tip_radius_um = 12.5",)),
    "radius inverted": (
        {**ROUND, "probe.tip_radius_um": [12.5, 2.5]},
        ("probe", "tip_radius_um = [12.5, 2.5]", "lower end must not exceed"),
    ),
    "negative radius": (
        {**ROUND, "probe.tip_radius_um": [-1.0, 2.5]},
        ("probe.tip_radius_um.0 = -1.0", "greater than or equal to 0"),
    ),
    "radius of half the spacing": (
        {**ROUND, "probe.tip_radius_um": [2.5, 290.0]},
        (
            "tip_radius_um = [2.5, 290.0]",
            "less than half of tip_spacing_um = 580.0",
            "overlap",
            "give",
        ),
    ),
    "tips that overlap within the tolerance": (
        {**ROUND, "probe.tip_radius_um": [2.5, 289.0], "probe.tip_spacing_tolerance_um": 2.0},
        ("[2.5, 289.0]", "less tip_spacing_tolerance_um = 2.0", "overlap"),
    ),
    "passive tip inverted": (
        {**ROUND, "probe.passive_tip_radius_um": [3.0, 2.5]},
        ("passive_tip_radius_um = [3.0, 2.5]", "lower end must not exceed"),
    ),
    "passive tip too large": (
        {**ROUND, "probe.passive_tip_radius_um": [2.5, 300.0]},
        ("passive_tip_radius_um = [2.5, 300.0]", "less than half of tip_spacing_um = 580.0"),
    ),
    "tolerance of the part's own size": (
        {**ROUND, "part.size_tolerance_um": 837.0},
        ("part", "size_tolerance_um = 837.0", "smaller than the part", "give a smaller value"),
    ),
    "inside out": (
        {**ROUND, "part.squareness_deg": 9.9, "part.size_tolerance_um": 600.0},
        ("part", "squareness_deg = 9.9", "inside out", "give a smaller value"),
    ),
    "squareness beyond use": (
        {**ROUND, "part.squareness_deg": 10.0},
        ("part.squareness_deg = 10.0", "less than 10"),
    ),
    "no straight edge": (
        {**ROUND, "part.corner_radius_um": 418.5},
        ("part", "corner_radius_um = 418.5", "straight piece of every edge", "after corner 1"),
    ),
    "direction inverted": (
        {**ROUND, "uncertainty.travel_direction_deg": [0.1, -0.1]},
        ("uncertainty", "travel_direction_deg = [0.1, -0.1]", "lower end must not exceed"),
    ),
    "force without a film": (
        {**ROUND, "probe.max_force_un": 20.0},
        (
            "probe.max_force_un = 20.0",
            "must come with film.drag_un_s_per_um",
            "give the film's drag",
        ),
    ),
    "a centre that moves nowhere": (
        {**ROUND, "uncertainty.drag_centre_moves": True},
        ("uncertainty.drag_centre_moves = true", "must come with uncertainty.drag_centre_um"),
    ),
    "whole film anisotropic": (
        {**ROUND, "uncertainty.drag_anisotropy_percent": 100.0},
        ("uncertainty.drag_anisotropy_percent = 100.0", "less than 100"),
    ),
}


@pytest.mark.parametrize("name", BAD)
def test_bad_values_are_refused_with_key_value_and_rule(name: str) -> None:
    changes, words = BAD[name]
    with pytest.raises(InputError) as caught:
        parse_task(values(changes), "real.toml")
    message = str(caught.value)
    assert message.startswith("real.toml: ")
    for word in words:
        assert word in message


GIVEN: dict[str, Any] = {
    "part.size_tolerance_um": 4.0,
    "part.squareness_deg": 0.1,
    "part.corner_radius_um": 5.0,
    "probe.tip_spacing_tolerance_um": 1.0,
    "probe.tip_radius_um": [2.5, 12.5],
    "probe.passive_tip_radius_um": [2.5, 5.0],
    "probe.max_force_un": 20.0,
    "uncertainty.friction_common": True,
    "uncertainty.travel_direction_deg": [-0.1, 0.1],
    "uncertainty.travel_scale_percent": 0.1,
    "uncertainty.drag_centre_um": 20.0,
    "uncertainty.drag_centre_moves": True,
    "uncertainty.drag_anisotropy_percent": 5.0,
    "uncertainty.probe_wander_um": 0.5,
    "film.drag_un_s_per_um": 0.2,
}
"""Every key of schema 2, with a value that is allowed."""


@pytest.mark.parametrize("key", GIVEN)
def test_a_file_of_schema_1_may_not_have_a_key_of_schema_2(key: str) -> None:
    told = "film" if key.startswith("film") else key
    with pytest.raises(InputError) as caught:
        parse_task(values({key: GIVEN[key]}), "old.toml")
    for word in (f"{told}", "belongs to schema = 'meso-robust/task/2'", "tip_radius_um, or leave"):
        assert word in str(caught.value)


def test_all_keys_of_schema_2_are_read_together_and_named_once() -> None:
    task = parse_task(values({**ROUND, **GIVEN}), "real.toml")

    assert {key.partition(".")[2] for key in GIVEN} - {"drag_un_s_per_um"} == SCHEMA_2_KEYS
    assert task.film == Film(drag_un_s_per_um=0.2)
    named = {*Part.model_fields, *Probe.model_fields, *Uncertainty.model_fields}
    assert named >= SCHEMA_2_KEYS


def test_the_published_schema_says_which_keys_belong_to_which_schema() -> None:
    rules = Task.model_json_schema(by_alias=True)
    force = rules["dependentSchemas"]["probe"]
    old = rules["then"]["properties"]

    assert rules["if"] == {"properties": {"schema": {"const": "meso-robust/task/1"}}}
    assert old.pop("film") is False
    told = {f"{name}.{key}" for name, one in old.items() for key in one["properties"]}
    assert told == set(GIVEN) - {"film.drag_un_s_per_um"}
    assert rules["else"] == {"properties": {"probe": {"required": ["tip_radius_um"]}}}
    assert force["then"] == {"required": ["film"]}


def test_every_bound_reaches_the_proof_in_si() -> None:
    """By hand: the tolerance is of a length, so an edge moves by half of it; 5 % are 1 +- e/200."""
    setup = setup_of(parse_task(values({**ROUND, **GIVEN}), "real.toml"))
    u = setup.uncertainty

    def near(ends: Any, low: float, high: float) -> None:
        assert (ends.lo, ends.hi) == pytest.approx((low, high), rel=1e-12)
        assert ends.lo <= low
        assert ends.hi >= high

    near(u.tip_radius, 2.5e-6, 12.5e-6)
    near(u.passive_tip_radius, 2.5e-6, 5e-6)
    near(setup.spacing, 579e-6, 581e-6)
    near(u.size, -2e-6, 2e-6)
    near(u.squareness, -math.radians(0.1), math.radians(0.1))
    near(u.travel_direction, -math.radians(0.1), math.radians(0.1))
    near(u.travel_scale, -1e-3, 1e-3)
    near(u.drag_centre, -20e-6, 20e-6)
    near(u.drag_anisotropy, -0.025, 0.025)
    near(u.probe_wander, -0.5e-6, 0.5e-6)
    assert setup.friction_common
    assert setup.drag_centre_moves
    near(setup.fixed_centre, 0.0, 0.0)
    assert setup.moving_centre == u.drag_centre
    assert setup.largest_force is not None
    assert setup.drag is not None
    near(setup.largest_force, 20e-6, 20e-6)
    near(setup.drag, 0.2, 0.2)  # 1 uN s/um is 1 N s/m


def test_the_passive_tip_is_as_the_others_if_nothing_is_said() -> None:
    u = setup_of(parse_task(values(ROUND), "real.toml")).uncertainty
    assert u.passive_tip_radius == u.tip_radius


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({}, "point tips"),
        (ROUND, "round tips, radius 2.5 to 12.5 um"),
        ({**ROUND, "probe.tip_radius_um": [5.0, 5.0]}, "round tips, radius 5 um"),
        (
            {**ROUND, "probe.passive_tip_radius_um": [2.5, 12.5]},
            "round tips, radius 2.5 to 12.5 um",
        ),
        (
            {**ROUND, "probe.passive_tip_radius_um": [2.0, 3.0]},
            "round tips, radius 2.5 to 12.5 um, the passive one's 2 to 3 um",
        ),
    ],
)
def test_what_a_verdict_line_says_of_the_tips(changes: dict[str, Any], words: str) -> None:
    assert parse_task(values(changes), "real.toml").tips == words


@pytest.mark.parametrize(
    "outline",
    [[(-808, -418), (808, -418), (808, 418), (-808, 418)], HEXAGON, ELL],
    ids=["rectangle", "hexagon", "L-shape"],
)
def test_no_part_as_made_has_shorter_edges_than_told(outline: list[tuple[int, int]]) -> None:
    """Parts made at random, their corners where lines meet; the worst comes close to what is told."""
    moved, turned, rounded = 5.0, math.radians(3.0), 12.0
    corners = [(Fraction(x), Fraction(y)) for x, y in outline]
    told = np.array(straight_edges(corners, moved, turned, rounded))
    points = np.array(outline, dtype=float)
    sides = np.roll(points, -1, axis=0) - points
    nominal = np.arctan2(sides[:, 1], sides[:, 0])
    depth = points[:, 0] * np.sin(nominal) - points[:, 1] * np.cos(nominal)
    rng, least = np.random.default_rng(0), np.full(len(points), np.inf)
    for _ in range(4000):
        angle = nominal + turned * np.rint(rng.uniform(-1, 1, len(points)))
        away = depth + moved * rng.choice([-1.0, 1.0], len(points))
        normal = np.stack([np.sin(angle), -np.cos(angle)], axis=1)
        meets = np.array(
            [
                np.linalg.solve(np.stack([normal[k - 1], normal[k]]), [away[k - 1], away[k]])
                for k in range(len(points))
            ]
        )
        along = np.einsum(
            "ki,ki->k", np.roll(meets, -1, axis=0) - meets,
            np.stack([np.cos(angle), np.sin(angle)], axis=1),
        )  # fmt: skip
        bend = np.abs(np.angle(np.exp(1j * (angle - np.roll(angle, 1)))))
        cut = rounded * np.tan(bend / 2)
        least = np.minimum(least, along - cut - np.roll(cut, -1))
    assert (least >= told - 1e-9).all()
    assert least == pytest.approx(told, abs=1.5)
