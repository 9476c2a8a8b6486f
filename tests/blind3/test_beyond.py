"""The trial with six effects more: its laws, its list, its sets and their scores."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from meso_robust.recordings import read_set
from meso_robust.simulator.catalogue import CATALOGUE, stage_of
from reports.blind3 import beyond, generate
from reports.blind3.cases import Case, digest, listed, sealed
from reports.blind3.filmed import BEYOND, TRIALS
from reports.blind3.generate import World, clear_norm, filmed, pushes
from reports.blind3.laws import FAMILIES
from reports.blind3.score import results_text
from tests.blind3.test_trial import imports, made_up

LAWS = {**beyond.LEARNT, **beyond.OUTSIDE}
KNOWN = {**FAMILIES, **beyond.LEARNT}


def test_the_laws_use_the_generator_only() -> None:
    assert imports(Path(beyond.__file__)) == {
        f"reports.blind3.{name}" for name in ("cases", "generate", "laws")
    }


def test_what_is_learnt_is_the_catalogues_and_what_is_outside_is_not() -> None:
    for name, family in beyond.LEARNT.items():
        assert stage_of(name).name == family.stage
        told = family.form in CATALOGUE[name].forms
        assert not told
    there = set(CATALOGUE)  # asked by name alone, so that a miss does not print the laws
    assert not [name for name in beyond.OUTSIDE if name in there]
    assert {family.stage for family in beyond.OUTSIDE.values()} == {
        family.stage for family in FAMILIES.values()
    }


@pytest.fixture(scope="module")
def plan() -> list[generate.Push]:
    return pushes(np.random.default_rng(5), count=2)


@pytest.fixture(scope="module")
def norm(plan: list[generate.Push]) -> Any:
    return clear_norm(World(), plan)


@pytest.mark.parametrize("name", LAWS)
def test_every_law_changes_what_is_seen_and_does_nothing_of_no_size(
    name: str, plan: list[generate.Push], norm: Any
) -> None:
    family = LAWS[name]

    def seen(size: float, shape: int) -> float:
        change = family.make(size, np.random.default_rng(shape))
        return float(norm([filmed(World(changes=(change,)), push) for push in plan]))

    assert seen(0.0, 0) < 1e-6
    # a place may be drawn where no push goes
    assert any(seen(family.most, shape) > 1.0 for shape in range(6))


def test_a_screw_errs_along_one_axis_periodically_and_never_drives_back() -> None:
    for shape in range(20):
        family = beyond.LEARNT["leadscrew_error"]
        drive = family.make(family.most, np.random.default_rng(shape)).drive
        assert drive is not None
        way = np.tile(np.arange(-1000.0, 1000.0, 0.5)[:, None], 2)
        error = drive(np.zeros(len(way)), way) - way
        (axis,) = np.flatnonzero(np.ptp(error, axis=0))
        wave = error[:, axis]
        assert np.abs(wave).max() == pytest.approx(family.most, rel=0.05)
        assert np.diff(wave).min() > -0.5
        tops = np.flatnonzero((wave[1:-1] > wave[:-2]) & (wave[1:-1] >= wave[2:]))
        turns = [way[b, axis] - way[a, axis] for a, b in pairwise(tops)]
        assert np.ptp(turns) <= 1.0
        assert 119.0 < turns[0] < 601.0


def test_an_angle_is_off_as_often_as_a_pixel_looks_alike() -> None:
    for shape in range(6):
        see = beyond.folded_angle(1.5, np.random.default_rng(shape)).see
        assert see is not None
        poses = np.column_stack([np.zeros((721, 2)), np.linspace(-np.pi, np.pi, 721)])
        error = np.degrees(see(poses[:, 0], poses) - poses)
        assert not error[:, :2].any()
        assert np.abs(error[:, 2]).max() == pytest.approx(1.5, rel=0.05)
        np.testing.assert_allclose(error[:361, 2], error[360:, 2], atol=1e-9)


def test_a_parallelogram_keeps_its_lengths() -> None:
    change = beyond.skewed_part(20.0, np.random.default_rng(1))
    assert change.corners is not None
    half = 0.5 * np.array([generate.LENGTH, generate.WIDTH])
    stated = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]) * half
    moved = change.corners(stated)
    (axis,) = np.flatnonzero(np.abs(moved - stated).max(axis=0))
    assert sorted((moved - stated)[:, axis]) == pytest.approx([-20.0, -20.0, 20.0, 20.0])
    np.testing.assert_allclose(moved[0] + moved[2], 0.0, atol=1e-9)
    sides = np.abs(moved - np.roll(moved, 1, axis=0))[:, axis]
    assert sorted(sides) == pytest.approx([40.0, 40.0, 2.0 * half[axis], 2.0 * half[axis]])


def test_a_mount_slips_once_and_against_its_way(plan: list[generate.Push]) -> None:
    for push in plan:
        drive = beyond.jumping_mount(8.0, np.random.default_rng(3)).drive
        assert drive is not None
        slip = drive(push.times, push.tips) - push.tips
        far = np.hypot(*slip.T)
        assert far[0] == 0.0
        assert far[-1] == pytest.approx(8.0)
        assert (np.diff(far) >= -1e-9).all()
        assert slip[-1] @ (push.tips[-1] - push.tips[0]) < 0.0


def test_a_clock_is_off_by_a_part_of_the_time() -> None:
    see = beyond.fast_clock(2.0, np.random.default_rng(0)).see
    assert see is not None
    times = np.linspace(0.0, 4.0, 321)
    late = see(times, np.outer(times, [1.0, 1.0, 1.0]))[:300, 0] - times[:300]
    np.testing.assert_allclose(np.abs(late), 0.02 * times[:300], atol=1e-9)


def test_suction_holds_again_in_the_next_push(plan: list[generate.Push]) -> None:
    world = World(changes=(beyond.suction(1.0, np.random.default_rng(0)),))
    first = filmed(world, plan[0])
    np.testing.assert_array_equal(filmed(world, plan[0]), first)


def test_the_list_is_the_same_drawn_again_and_has_its_shares() -> None:
    of = BEYOND.cases
    assert list(of) == beyond.listed(100, 20261202)
    assert [case.id for case in of] == list(range(100))
    assert of != beyond.listed(100, 20261203)
    for k in range(0, 100, 20):
        kinds = [case.kind for case in of[k : k + 20]]
        counts = [kinds.count(kind) for kind in ("single", "null", "pair", "outside")]
        assert counts == [10, 4, 3, 3]
    for kind in ("single", "pair"):
        first = [case.families[0] in beyond.LEARNT for case in of if case.kind == kind]
        assert np.mean(first) == pytest.approx(1.0 / 3.0, abs=0.05)
    for case in of:
        assert len(case.families) == len(case.multiples)
        assert set(case.families) <= set(beyond.OUTSIDE if case.kind == "outside" else KNOWN)
        if case.kind == "pair":
            one, other = case.families
            assert KNOWN[one].stage != KNOWN[other].stage
    drawn = {name for case in of for name in case.families}
    assert drawn >= {*LAWS, *FAMILIES}


def test_no_other_trial_has_its_seeds() -> None:
    others = [trial.cases for trial in TRIALS.values() if trial is not BEYOND]
    before = {case.seed for of in (listed(), *others) for case in of}
    assert not before & {case.seed for case in BEYOND.cases}


def test_a_set_is_made_with_a_law_of_here_and_the_same_again(tmp_path: Path) -> None:
    case = Case(id=0, kind="outside", families=("fast_clock",), multiples=(9.0,), seed=4)
    label = beyond.sealed(case, tmp_path / "a")
    assert label == beyond.sealed(case, tmp_path / "b")
    assert digest(tmp_path / "a") == digest(tmp_path / "b")
    assert label["measured"] == [pytest.approx(9.0, rel=0.1)]
    assert len(read_set(tmp_path / "a").recordings) == generate.PUSHES
    with pytest.raises(KeyError):  # as before
        sealed(case, tmp_path / "c")


def test_what_is_learnt_is_right_by_its_name_and_what_is_outside_by_its_stage() -> None:
    for name in beyond.LEARNT:
        told = made_up("single", (name,), "named", name)
        assert told.wanted
        assert told.right_physics
        assert made_up("single", (name,), "named", "backlash").wrong
        both = made_up("pair", (name, "dry_friction"), "named", name, "dry_friction")
        assert both.wanted
    for name, family in beyond.OUTSIDE.items():
        unknown = made_up("outside", (name,), "unknown", stage=family.stage)
        assert unknown.wanted
        assert not made_up("outside", (name,), "unknown", stage="nowhere").wanted
        assert made_up("outside", (name,), "named", "camera_scale").wrong
        assert "1 of 1, 100 %" in results_text([unknown], frozenset())
