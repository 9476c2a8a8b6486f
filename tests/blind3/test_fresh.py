"""The trial of pairs and of laws that are new again: its laws, its list, its sets and their scores."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Iterator
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from meso_robust.plant.kernel import nearest
from meso_robust.recordings import read_set
from meso_robust.simulator.catalogue import CATALOGUE
from reports.blind3 import beyond, fresh, generate
from reports.blind3.cases import Case, digest, listed
from reports.blind3.filmed import FRESH, TRIALS
from reports.blind3.generate import World, Wrongs, clear_norm, filmed, pushes
from reports.blind3.laws import FAMILIES, OUTSIDE
from reports.blind3.score import results_text
from tests.blind3.test_trial import imports, made_up

KNOWN = {**FAMILIES, **beyond.LEARNT}


@pytest.fixture(autouse=True)
def here() -> Iterator[None]:
    with fresh.laws_of_here():
        yield


@pytest.fixture(scope="module")
def plan() -> list[generate.Push]:
    return pushes(np.random.default_rng(5), count=4)


@pytest.fixture(scope="module")
def norm(plan: list[generate.Push]) -> Any:
    return clear_norm(World(), plan)


def test_the_laws_use_the_generator_only() -> None:
    assert imports(Path(fresh.__file__)) == {
        f"reports.blind3.{name}" for name in ("beyond", "cases", "generate", "laws")
    }


def test_what_is_outside_is_new_and_of_every_stage() -> None:
    soon = {"clock_rate", "part_skew", "runout"}
    there = set(CATALOGUE) | soon | set(OUTSIDE) | set(beyond.OUTSIDE)  # a miss prints no law
    assert not [name for name in fresh.OUTSIDE if name in there]
    assert {family.stage for family in fresh.OUTSIDE.values()} == {
        family.stage for family in FAMILIES.values()
    }


@pytest.mark.parametrize("name", fresh.OUTSIDE)
def test_every_law_changes_what_is_seen_and_does_nothing_of_no_size(
    name: str, plan: list[generate.Push], norm: Any
) -> None:
    family = fresh.OUTSIDE[name]

    def seen(size: float, shape: int) -> list[generate.Floats]:
        world = World(changes=(family.make(size, np.random.default_rng(shape)),))
        first = [filmed(world, push) for push in plan]
        for before, push in zip(first, plan, strict=True):  # what it remembers ends with a push
            np.testing.assert_array_equal(filmed(world, push), before)
        return first

    assert norm(seen(0.0, 0)) < 1e-6
    assert any(norm(seen(family.most, shape)) > 4.0 * 5.0 for shape in range(3))


def test_a_drive_is_late_and_arrives() -> None:
    times = np.arange(0.0, 12.0, 0.0125)
    way = np.column_stack([np.interp(times, [1.0, 4.0], [0.0, 300.0]), np.zeros(len(times))])
    for make, size, largest in (
        (fresh.stalling_drive, 0.2, 20.0),
        (fresh.late_part, 20.0, 50.0),
        (fresh.ringing_arm, 8.0, 8.0),
    ):
        for shape in range(6):
            drive = make(size, np.random.default_rng(shape)).drive
            assert drive is not None
            late = (way - drive(times, way))[:, 0]
            assert not late[times < 1.0].any()
            assert 0.2 * largest < late.max() <= largest + 1e-9
            assert abs(late[-1]) < 0.05 * largest
            assert (late.min() < -1.0) == (make is fresh.ringing_arm)


def test_opposite_edges_of_a_trapezium_lean_against_each_other() -> None:
    for shape in range(4):
        corners = generate.corners_of(
            World(changes=(fresh.tapered_part(10.0, np.random.default_rng(shape)),))
        )
        assert corners.mean(axis=0) == pytest.approx([0.0, 0.0], abs=1e-9)
        moved = np.abs(corners) - fresh.HALF
        (axis,) = np.flatnonzero(np.abs(moved).max(axis=0) > 1.0)
        assert sorted(moved[:, axis]) == pytest.approx([-10.0, -10.0, 10.0, 10.0])
        longer = corners[moved[:, axis] > 0.0]
        assert longer[0, 1 - axis] == longer[1, 1 - axis]


@pytest.mark.parametrize("rounding", [0.0, 3.0])
def test_long_edges_of_a_bow_lie_off_by_as_much_and_ends_stay(rounding: float) -> None:
    change = fresh.bent_part(12.0, np.random.default_rng(1))
    world = World(changes=(change,), wrongs=Wrongs(rounding_um=rounding))
    bent, plain = fresh.outline_of(world), fresh.outline_of(replace(world, changes=()))

    def upper(outline: generate.Floats, x: float) -> float:
        return 600.0 - float(nearest(outline, x, 600.0)[0])

    def lower(outline: generate.Floats, x: float) -> float:
        return -600.0 + float(nearest(outline, x, -600.0)[0])

    assert len(bent) > len(plain)
    for side in (upper, lower):
        middle, far = (side(bent, x) - side(plain, x) for x in (0.0, 700.0))
        assert abs(middle) == pytest.approx(4.0, abs=0.3)
        assert abs(middle - far) == pytest.approx(12.0 * (700.0 / fresh.HALF[0]) ** 2, abs=0.5)
    assert upper(bent, 0.0) - lower(bent, 0.0) == pytest.approx(2.0 * fresh.HALF[1], abs=0.1)
    assert np.ptp(bent[:, 0]) == pytest.approx(np.ptp(plain[:, 0]))


def test_a_camera_that_looks_askew_bends_no_line() -> None:
    see = fresh.keystone(4.0, np.random.default_rng(2)).see
    assert see is not None
    ramp = np.linspace(-800.0, 800.0, 9)
    poses = np.column_stack([ramp, 300.0 + 0.5 * ramp, np.full(9, np.arctan(0.5))])
    seen = see(ramp, poses)
    along = np.diff(seen[:, :2], axis=0)
    headings = np.arctan2(along[:, 1], along[:, 0])
    assert np.ptp(headings) < 1e-9
    assert seen[:, 2] == pytest.approx(headings[0])
    assert np.ptp(np.hypot(*along.T)) > 1.0


def test_the_list_is_the_same_drawn_again_and_has_its_shares() -> None:
    of = FRESH.cases
    assert list(of) == fresh.listed(20261204)
    assert [case.id for case in of] == list(range(64))
    assert Counter(case.kind for case in of) == fresh.KINDS
    outside = Counter(name for case in of if case.kind == "outside" for name in case.families)
    assert set(outside) == set(fresh.OUTSIDE)
    assert set(outside.values()) == {2}
    for case in of:
        assert fresh.fits(case.multiples)
        assert set(case.families) <= set(fresh.OUTSIDE if case.kind == "outside" else KNOWN)
        if case.kind == "pair":
            one, other = case.families
            assert KNOWN[one].stage != KNOWN[other].stage
    before = {case.seed for of in (listed(), *_others()) for case in of}
    assert not before & {case.seed for case in of}


def _others() -> list[Any]:
    return [trial.cases for trial in TRIALS.values() if trial is not FRESH]


def test_what_is_promised_is_of_this_list_and_generator_and_well_visible() -> None:
    promised = json.loads(FRESH.commitment.read_text(encoding="utf-8"))
    assert promised["generator_sha256"] == FRESH.generator_hash()
    assert set(promised["sets"]) == {f"{case.id:03d}" for case in FRESH.cases}
    cases = json.loads((FRESH.out / "cases.json").read_text(encoding="utf-8"))
    assert cases == json.loads(json.dumps([asdict(case) for case in FRESH.cases]))
    for case in FRESH.cases:
        label = promised["sets"][f"{case.id:03d}"]
        assert len(label["measured"]) == len(case.families)
        assert fresh.fits(label["measured"])


def test_sizes_fit_if_well_visible_and_not_far_apart() -> None:
    assert fresh.fits([])
    assert fresh.fits([4.0, 20.0])
    assert not fresh.fits([3.9])
    assert not fresh.fits([101.0])
    assert not fresh.fits([4.0, 20.1])


def test_a_set_is_made_until_it_fits_and_the_same_again(tmp_path: Path) -> None:
    case = Case(id=0, kind="outside", families=("bow_wave",), multiples=(12.0,), seed=4)
    label = fresh.sealed(case, tmp_path / "a")
    assert label == fresh.sealed(case, tmp_path / "b")
    assert digest(tmp_path / "a") == digest(tmp_path / "b")
    assert fresh.fits(label["measured"])
    assert len(read_set(tmp_path / "a").recordings) == generate.PUSHES


def test_a_set_that_never_fits_is_refused(tmp_path: Path, monkeypatch: Any) -> None:
    tried = []

    def made(case: Case, _: Path) -> Any:
        tried.append((case.seed, case.multiples))
        return {"measured": [1.0]}

    monkeypatch.setattr(fresh, "sealed_before", made)
    case = Case(id=7, kind="single", families=("backlash",), multiples=(9.0,), seed=4)
    with pytest.raises(RuntimeError, match="case 7"):
        fresh.sealed(case, tmp_path)
    assert tried[:4] == [(4, (9.0,)), (4, (81.0,)), (5, (9.0,)), (5, (81.0,))]
    assert len(tried) == fresh.TRIES


def test_what_is_outside_is_right_by_its_stage() -> None:
    for name, family in fresh.OUTSIDE.items():
        unknown = made_up("outside", (name,), "unknown", stage=family.stage)
        assert unknown.wanted
        assert not made_up("outside", (name,), "unknown", stage="nowhere").wanted
        assert made_up("outside", (name,), "named", "camera_scale").wrong
        assert "1 of 1, 100 %" in results_text([unknown], frozenset())


def test_files_that_are_sealed_are_as_they_were() -> None:
    promised = json.loads(TRIALS["beyond"].commitment.read_text(encoding="utf-8"))
    assert promised["generator_sha256"] == TRIALS["beyond"].generator_hash()
