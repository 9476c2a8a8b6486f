"""Recording sets of the blind benchmark: what is in them, and what must not be."""

from __future__ import annotations

import csv
import json
import re
import tomllib
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from reports.blind.corpus import EFFECTS as PUBLISHED, STAGE
from reports.blind.detectable import just_detectable, nuisance
from reports.blind.effects import EFFECTS
from reports.blind.generator import UNIDENTIFIABLE, Case, Made, make, write
from reports.blind.laws import Laws
from reports.blind.outside import OUTSIDE
from reports.blind.posts import CLEAR, STAGGER, TOUCHING, distance, laid, paths
from reports.blind.pushes import DESIGNS, SPEEDS, commanded
from reports.blind.world import World, filmed, run

NULL = Case(seed=3)
FEW = 4


@pytest.fixture(scope="module")
def drifting() -> Made:
    """Few recordings by a camera that drifts."""
    return make(Case("effect", ("camera_drift",), (4.0,), seed=3), FEW)


@pytest.fixture(scope="module")
def null() -> Made:
    """The same recordings without."""
    return make(NULL, FEW)


def test_every_published_effect_is_there_and_at_its_stage() -> None:
    assert {name: effect.stage for name, effect in EFFECTS.items()} == STAGE
    assert len(EFFECTS) == len(PUBLISHED) == 28
    assert len(OUTSIDE) >= 8
    assert not set(OUTSIDE) & set(PUBLISHED)
    assert set().union(*UNIDENTIFIABLE) <= set(PUBLISHED)


@pytest.mark.parametrize("effect", [*EFFECTS.values(), *OUTSIDE.values()], ids=lambda e: e.name)
def test_an_effect_changes_the_world_and_nothing_when_it_has_no_size(effect) -> None:  # type: ignore[no-untyped-def]
    plain = World()
    changed = effect.change(effect.guess, 5).of(plain)
    assert (changed.laws, changed.camera, changed.excess) != (
        plain.laws,
        plain.camera,
        plain.excess,
    )
    assert effect.change(effect.guess, 5) == effect.change(effect.guess, 5)
    if effect.name not in ("unmodelled_wall",):
        push = commanded(
            replace(DESIGNS["lazy"](np.random.default_rng(0), 1)[0], length=40.0), np.zeros(3)
        )
        none = filmed(effect.change(0.0, 5).of(plain), push)
        assert none == pytest.approx(filmed(plain, push), abs=0.01)


def test_a_diagnostic_set_has_all_edges_speeds_idle_and_twins() -> None:
    plans = DESIGNS["diagnostic"](np.random.default_rng(1), 16)
    assert len(plans) == 16
    assert {p.edge for p in plans} == {0, 1, 2, 3}
    assert {p.speed for p in plans} == set(SPEEDS)
    assert any(p.reversal for p in plans)
    shared = [(p.edge % 2, abs(p.place), abs(p.slant)) for p in plans]
    assert len(shared) - len(set(shared)) == 4
    for plan in plans:
        push = commanded(plan, np.zeros(3))
        assert push.frames[-1] < 12.0
        assert np.all(np.diff(push.times) > 0.0)
        assert push.commands()[0] == pytest.approx(push.commands()[11])


def test_a_lazy_set_has_one_edge_and_one_speed_and_no_idle() -> None:
    plans = DESIGNS["lazy"](np.random.default_rng(1), 16)
    assert len({(p.edge, p.place, p.speed) for p in plans}) == 1
    assert all(p.rest == p.retract == 0.0 for p in plans)


@pytest.mark.parametrize(
    ("norm", "size"),
    [
        (lambda s: 10.0 * s, 0.5),
        (lambda s: 2.0 * s**2, np.sqrt(2.5)),
        (lambda s: 0.05 * s if s < 20.0 else 100.0 * s, 20.0),
    ],
)
def test_the_just_detectable_size_is_where_the_norm_is_five(
    norm: Callable[[float], float], size: float
) -> None:
    found = just_detectable(norm, 0.1, 1e3)
    assert found == pytest.approx(size, rel=0.3)


def test_what_is_never_detectable_has_the_largest_size() -> None:
    assert just_detectable(lambda s: 1e-6 * s, 0.1, 30.0) == 30.0


def test_nuisance_is_projected_out_and_a_drift_is_not(null: Made, drifting: Made) -> None:
    known = nuisance(null.world, null.pushes, null.sensor)

    def raw(world: World) -> float:
        pairs = zip(null.pushes, known.base, strict=True)
        return float(
            np.sqrt(sum(np.sum(((filmed(world, p) - b) / known.sigmas) ** 2) for p, b in pairs))
        )

    laws = null.world.laws
    for near in (laws._replace(mu=laws.mu + 0.006), laws._replace(footprint=laws.footprint + 0.01)):
        other = World(near)
        left = known.size_of([filmed(other, push) for push in null.pushes])
        assert left < 0.1 * raw(other)
    moved = [replace(push, start=push.start + np.array([0.3, -0.2, 1e-4])) for push in null.pushes]
    assert known.size_of([filmed(null.world, push) for push in moved]) < 0.5
    size = known.size_of(drifting.clean)
    assert size == pytest.approx(20.0, rel=0.3)
    assert drifting.label["signature_sigma"] == pytest.approx(size)


def test_the_label_tells_the_truth(drifting: Made, null: Made) -> None:
    label = json.loads(json.dumps(drifting.label))
    assert label["names"] == ["camera_drift"]
    assert label["stages"] == ["observation"]
    assert label["multiples"] == [pytest.approx(4.0)]
    speed = np.hypot(*label["parameters"][0].values())
    assert speed == pytest.approx(label["sizes"][0]) == 4.0 * label["just_detectable"][0]
    for push, seen, plain in zip(drifting.pushes, drifting.clean, null.clean, strict=True):
        drift = np.hypot(*(seen - plain)[:, :2].T)
        assert drift == pytest.approx(speed * push.frames, abs=1e-6)


def test_the_streams_of_a_seed_are_independent(drifting: Made, null: Made) -> None:
    """Concealing something changes neither the experiment nor the noise."""
    for one, other, seen, plain in zip(
        drifting.recordings, null.recordings, drifting.clean, null.clean, strict=True
    ):
        assert np.array_equal(one.commands, other.commands)
        kept = np.searchsorted(np.arange(len(seen)) / 30.0, one.times - 1e-9)
        noise = one.poses - seen[kept]
        assert noise == pytest.approx(other.poses - plain[kept], abs=1e-9, nan_ok=True)


def test_a_seed_settles_everything(null: Made) -> None:
    again, another = make(NULL, FEW), make(replace(NULL, seed=4), FEW)
    assert again.label == null.label
    for one, other in zip(again.recordings, null.recordings, strict=True):
        assert np.array_equal(one.poses, other.poses, equal_nan=True)
    assert another.label["mu"] != null.label["mu"]


def test_pushes_are_laid_to_end_at_a_post_or_clear_of_it_and_do_not_jam() -> None:
    rng, place, radius = np.random.default_rng(2), np.array([300.0, -200.0]), 60.0
    free = World(Laws(mu=0.45))
    posted = World(Laws(mu=0.45, post_radius=radius + 20.0, post_x=place[0], post_y=place[1]))
    plans = [replace(p, speed=225.0) for p in DESIGNS["diagnostic"](rng, 8)]
    expected = min(TOUCHING, sum(p.edge % 2 == 0 for p in plans))
    ending = 0
    for plan in laid(plans, free, place, radius, rng):
        gap = distance(free, paths(plan, free)[-8:], place) - radius
        assert -1.0 < gap < STAGGER + 1.0 or gap > CLEAR
        ending += gap < CLEAR
        push = commanded(plan, np.zeros(3))
        assert np.min(run(posted, push, push.frames)[1][:, 5]) > -0.2
    assert ending == expected >= 3


def test_a_written_set_has_the_recordings_and_no_label(drifting: Made, tmp_path: Path) -> None:
    write(drifting, tmp_path / "set")
    files = sorted(p.name for p in (tmp_path / "set").iterdir())
    assert files == [*(f"push_{k:02d}.csv" for k in range(FEW)), "set.toml"]
    text = (tmp_path / "set" / "set.toml").read_text()
    stated = tomllib.loads(text)
    assert [entry["file"] for entry in stated["recording"]] == files[:-1]
    assert ("position_sigma_um" in stated["sensor"]) == drifting.sensor.stated
    assert not {*EFFECTS, *OUTSIDE} & set(re.findall(r"\w+", text))
    with (tmp_path / "set" / "push_01.csv").open() as lines:
        rows = list(csv.DictReader(lines))
    recorded = drifting.recordings[1]
    assert [float(row["time_s"]) for row in rows] == pytest.approx(recorded.times, abs=1e-6)
    tips = [[float(row["probe1_x_um"]), float(row["probe1_y_um"])] for row in rows]
    assert np.array(tips) == pytest.approx(recorded.commands, abs=1e-4)
    turns = np.array([float(row["part_theta_deg"] or "nan") for row in rows])
    assert np.nanmax(np.abs(turns)) <= 180.0
    assert np.array_equal(np.isnan(turns), np.isnan(recorded.poses[:, 2]))
    wrapped = np.exp(1j * (np.radians(turns) - recorded.poses[:, 2]))
    assert np.nanmax(np.abs(wrapped - 1.0)) < 1e-6
