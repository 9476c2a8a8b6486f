"""Cases of the third blind trial that come as films: the renderer, and what is promised."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import meso_robust
from reports.blind3 import film as renderer, filming
from reports.blind3.cases import HERE, listed
from reports.blind3.film import PIXEL_UM, drawn_look, film
from reports.blind3.filmed import FILMS, LATE, SHORT, Trial
from reports.blind3.generate import (
    LENGTH,
    RADIUS,
    SUBSTEPS,
    WIDTH,
    Change,
    Floats,
    Push,
    World,
    moved,
    pushes,
)
from tests.blind3.test_trial import imports


@pytest.fixture(scope="module")
def push() -> Push:
    """A quick push, and only 40 frames of it."""
    rng = np.random.default_rng(5)
    quick = pushes(rng)[1]
    frames = 40 * SUBSTEPS
    return replace(quick, times=quick.times[:frames], tips=quick.tips[:frames])


def tracked(world: World, push: Push, folder: Path) -> Floats:
    """(F, 3) what `track` finds in a film, um and rad."""
    rng, path = np.random.default_rng(0), folder / "push.avi"
    film(path, (world, drawn_look(world, rng)), push, push.times[::SUBSTEPS], rng)
    start = (None, None, float(np.degrees(push.start[2])))
    seen = meso_robust.track(
        path, length_um=LENGTH, width_um=WIDTH, tip_radius_um=RADIUS, pixel_um=PIXEL_UM, start=start
    )
    assert seen.recordings is not None
    return seen.recordings.recordings[0].poses * [1e6, 1e6, 1.0]


def error(seen: Floats, true: Floats) -> Floats:
    """(F, 3) in the part's own frame."""
    c, s = np.cos(true[:, 2]), np.sin(true[:, 2])
    x, y, turn = (seen - true).T
    return np.column_stack([c * x + s * y, c * y - s * x, np.angle(np.exp(1j * turn))])


def test_the_renderer_shares_nothing_with_the_package() -> None:
    assert imports(Path(renderer.__file__)) == {"reports.blind3.generate"}


def test_a_film_shows_the_part_where_the_plant_has_it(push: Push, tmp_path: Path) -> None:
    world = World()
    found = error(tracked(world, push, tmp_path), moved(world, push)[::SUBSTEPS])
    assert np.abs(found.mean(axis=0)[:2]).max() < 0.05 * PIXEL_UM
    assert found[:, :2].std() < 0.1 * PIXEL_UM
    assert np.abs(found[:, 2]).max() < np.radians(0.2)


def stands_out(stated: Floats) -> Floats:
    """Another outline, whose upper edge lies 15 um farther out."""
    return stated + 15.0 * (stated[:, 1:] > 0.0) * [0.0, 1.0]


@pytest.mark.parametrize(
    ("change", "seen"),
    [
        (Change(corners=stands_out), lambda true: true + 7.5 * own_y(true)),
        (
            Change(see=lambda _, poses: poses * [1.01, 1.01, 1.0]),
            lambda true: true * [1.01, 1.01, 1.0],
        ),
    ],
)
def test_what_is_concealed_is_seen_where_it_is(
    change: Change, seen: Callable[[Floats], Floats], push: Push, tmp_path: Path
) -> None:
    world = World(changes=(change,))
    true = moved(world, push)[::SUBSTEPS]
    found = error(tracked(world, push, tmp_path), seen(true))
    assert np.abs(found.mean(axis=0)[:2]).max() < 0.05 * PIXEL_UM


def own_y(poses: Floats) -> Floats:
    """(F, 3) the part's own y axis on the stage."""
    heading = poses[:, 2]
    return np.column_stack([-np.sin(heading), np.cos(heading), np.zeros(len(poses))])


def test_a_world_is_made_again_from_its_label_and_no_other() -> None:

    labels = json.loads((HERE / "commitment.json").read_text(encoding="utf-8"))["sets"]
    case, label = listed()[300], labels["300"]
    world, _ = filming.world_of(case, label)
    assert [one.truth for one in world.changes] == [label["truth"]]
    with pytest.raises(ValueError, match="another case"):
        filming.world_of(listed()[301], label)


def test_the_films_are_of_other_cases() -> None:
    seeds = [{case.seed for case in of} for of in (listed(), FILMS.cases, SHORT.cases, LATE.cases)]
    assert len(set.union(*seeds)) == sum(len(of) for of in seeds)
    kinds = [case.kind for case in FILMS.cases]
    assert [kinds.count(kind) for kind in ("single", "null", "pair", "outside")] == [60, 24, 18, 18]
    kinds = [case.kind for case in SHORT.cases]
    assert [kinds.count(kind) for kind in ("single", "null", "pair", "outside")] == [0, 0, 18, 18]
    kinds = [case.kind for case in LATE.cases]
    assert [kinds.count(kind) for kind in ("single", "null", "pair", "outside")] == [20, 8, 18, 18]


def test_answers_are_of_promised_sets_only(tmp_path: Path) -> None:
    trial = replace(FILMS, out=tmp_path)
    (tmp_path / "sets" / "000").mkdir(parents=True)
    (tmp_path / "sets" / "000" / "set.toml").write_text("another", encoding="utf-8")
    promise = {"sets": {"000": {"sha256": "0" * 64}}}
    (tmp_path / "commitment.json").write_text(json.dumps(promise), encoding="utf-8")
    with pytest.raises(ValueError, match="case 0: a file differs"):
        trial.run(trial.cases[:1], "quick", 1)
    assert trial.answers("quick") == []


@pytest.mark.parametrize("trial", [FILMS, SHORT, LATE])
def test_the_commitment_is_of_this_generator(trial: Trial) -> None:
    promised = json.loads(trial.commitment.read_text(encoding="utf-8"))
    assert promised["generator_sha256"] == trial.generator_hash()
    assert set(promised["sets"]) == {f"{case.id:03d}" for case in trial.cases}
