"""Invariances: pairs are found, nothing is broken by nothing, and each effect breaks its own."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from meso_robust.diagnosis.invariances import Pair, compared, pairs, symmetries
from meso_robust.diagnosis.runs import runs_of
from meso_robust.identification.prepared import Prepared, prepare
from meso_robust.recordings.outline import gyration
from tests.diagnosis.designs import SIGMA, Given, Plan, random_plans, recorded_plans
from tests.identification.sets import PART, UM, turned

ALPHA = 1e-3


def twins(rng: np.random.Generator) -> list[Plan]:
    """Six pushes, each followed by the same one about the part but for one thing."""
    plans = []
    for k, first in enumerate(random_plans(rng, 6, speeds=[75 * UM])):
        # off the middle of the edge, so that the part turns
        away = float(rng.choice([-1.0, 1.0]) * rng.uniform(0.35, 0.6))
        nx, ny = first.normal
        px, py = 0.5 * PART.length * (nx or away), 0.5 * PART.width * (ny or away)
        first = replace(first, place=(px, py))
        x, y, heading = first.pose
        aimed = (x + rng.normal(0.0, 1 * UM), y + rng.normal(0.0, 1 * UM), heading)
        other = [
            replace(first, pose=(x + 400 * UM, y - 300 * UM, heading)),
            replace(first, pose=aimed, speed=20 * UM, length=200 * UM),
            replace(first, pose=(x, y, heading + 1.0)),
            replace(first, pose=aimed, wait=first.wait + 2.0),
            replace(first, pose=(x, y, heading + np.pi), place=(-px, -py), normal=(-nx, -ny)),
            # about the normal of the edge, so that the push keeps its direction on the stage
            replace(
                first,
                pose=aimed,
                place=(px, -py) if nx else (-px, py),
                slant=-first.slant,
            ),
        ][k]
        plans += [first, other]
    return plans


KINDS = ("place", "speed", "heading", "later", "turn", "mirror")


def shown(effects: Given | None, seed: int = 4, colour: float = 0.0) -> tuple[Pair, ...]:
    return pairs(twins_seen(effects, seed, colour), SIGMA, colour)


def twins_seen(
    effects: Given | None, seed: int, colour: float = 0.0, noise: float = 1.0
) -> Prepared:
    rng = np.random.default_rng(seed)
    plans = twins(rng)
    return prepare(recorded_plans(plans, rng, effects, colour=colour, noise=noise), step=5 * UM)


def broken(found: tuple[Pair, ...]) -> set[str]:
    """Invariances whose least probable test is so by chance less often than α, of that many tests."""
    each: dict[str, list[float]] = {}
    for pair in found:
        each.setdefault(pair.invariance, []).append(pair.p_value)
    return {name for name, of in each.items() if 1.0 - (1.0 - min(of)) ** len(of) < ALPHA}


def test_symmetries_of_outlines() -> None:
    kinds = sorted(one.kind for one in symmetries(PART.outline))
    assert kinds == ["mirror", "mirror", "same", "turn"]
    square = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])  # not about its centre
    assert len(symmetries(square)) == 8
    ell = np.array([[0.0, 0.0], [3.0, 0.0], [3.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0]])
    assert [one.kind for one in symmetries(ell)] == ["same"]


def test_the_image_of_a_motion_is_the_motion_of_the_image() -> None:
    square = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    motion, point = np.array([0.3, -0.2, 0.7]), np.array([0.9, 0.1])
    for symmetry in symmetries(square):
        image = symmetry.of_motion(motion)
        moved = symmetry.of_points(turned(motion[2]) @ point + motion[:2])
        same = turned(image[2]) @ symmetry.of_points(point) + image[:2]
        assert np.allclose(moved, same, atol=1e-12)


def test_gyration_of_a_rectangle() -> None:
    expected = np.sqrt((PART.length**2 + PART.width**2) / 12.0)
    assert gyration(PART.outline) == pytest.approx(expected, rel=1e-9)
    away = gyration(PART.outline + np.array([3e-4, 4e-4]))  # Huygens and Steiner
    assert away == pytest.approx(np.hypot(expected, 5e-4), rel=1e-9)


def test_planned_twins_are_found_by_what_they_differ_in() -> None:
    found = shown(None)
    for k, kind in enumerate(KINDS):
        files = (f"push_{2 * k:02d}.csv", f"push_{2 * k + 1:02d}.csv")
        names = [pair.invariance for pair in found if (pair.first, pair.second) == files]
        assert kind in names
    singles = [pair for pair in found if pair.first == pair.second]
    assert len(singles) == 5 * 12


def test_nothing_is_broken_without_a_mismatch() -> None:
    p_values = []
    for seed in range(5):
        colour = 0.4 * (seed % 2)
        found = shown(None, seed=20 + seed, colour=colour)
        assert broken(found) == set()
        p_values += [pair.p_value for pair in found]
    assert np.mean(np.array(p_values) < 0.05) < 0.07
    assert np.mean(np.array(p_values) < 0.5) > 0.3  # and tolerances are not absurdly wide


@pytest.mark.parametrize(
    ("effects", "breaks", "keeps"),
    [
        ({"dry_friction": {"ratio": 0.4}}, {"speed"}, {"place", "heading", "later", "turn"}),
        ({"body_force": {"x_um_s": 6.0}}, {"untouched", "rest", "speed"}, {"onset", "place"}),
        ({"tip_radius": {"excess_um": 4.0}}, {"onset"}, {"untouched", "metric", "speed"}),
        ({"camera_scale": {"percent": 1.0}}, {"metric"}, {"untouched", "rest"}),
        ({"tip_adhesion": {"pull_um_s": 20.0}}, {"retract"}, {"untouched", "place", "onset"}),
        # exp(g x) at another place is the same film, but for its scale
        ({"drag_gradient": {"x_per_mm": 0.6}}, {"heading"}, {"untouched", "speed", "place"}),
        ({"drag_centre_offset": {"y_um": 60.0}}, {"turn"}, {"speed", "place", "heading"}),
        ({"camera_latency": {"time_ms": 120.0}}, {"onset", "retract", "speed"}, {"heading"}),
    ],
)
def test_an_effect_breaks_its_own_invariances(
    effects: Given, breaks: set[str], keeps: set[str]
) -> None:
    found = broken(shown(effects))
    assert breaks <= found
    assert not keeps & found


def test_the_gap_of_a_larger_tip_is_its_excess() -> None:
    found = [p for p in shown({"tip_radius": {"excess_um": 4.0}}) if p.invariance == "onset"]
    gaps = np.array([pair.difference[0] for pair in found])
    errors = np.array([pair.tolerance[0] for pair in found])
    assert np.mean(gaps) == pytest.approx(4.0 * UM, abs=3.0 * errors.max() / np.sqrt(len(gaps)))


def test_predictions_are_held_against_the_same_tests() -> None:
    effects = {"dry_friction": {"ratio": 0.4}}
    prepared = twins_seen(effects, seed=4)
    found = pairs(prepared, SIGMA)
    right = compared(prepared, found, twins_seen(effects, 4, noise=0.0).seen, SIGMA)
    wrong = compared(prepared, found, twins_seen(None, 4, noise=0.0).seen, SIGMA)
    speed = [k for k, pair in enumerate(found) if pair.invariance == "speed"]
    assert speed
    for k in speed:
        assert right[k].sigma == pytest.approx(found[k].sigma, abs=3.0)
        assert wrong[k].sigma < 1.5  # unequal starts only
        assert found[k].sigma > 5.0


def test_a_tip_that_rests_in_a_noisy_log_neither_turns_nor_pushes() -> None:
    """The log of an encoder, of 0.05 um, with a break of a second in the middle of every push."""
    plain = twins_seen(None, 3)
    rng = np.random.default_rng(8)
    middle = [0.5 * (run.contact_s + run.end_s) for run in runs_of(plain, SIGMA, 0.0)]
    assert len(middle) == len(plain.files)
    grid = np.linspace(plain.times[:, 0], plain.times[:, -1] + 1.0, 400, axis=1)
    before = np.array(
        [np.where(t < m, t, np.maximum(t - 1.0, m)) for t, m in zip(grid, middle, strict=True)]
    )
    way = np.stack(
        [
            [np.interp(b, t, of) for of in w.reshape(len(w), -1).T]
            for b, t, w in zip(before, plain.times, plain.waypoints, strict=True)
        ]
    )
    way = np.moveaxis(way, 1, 2).reshape(len(grid), 400, -1, 2)
    broken = replace(
        plain,
        times=grid,
        waypoints=way + rng.normal(0.0, 0.05 * UM, way.shape),
        instants=plain.instants + (plain.instants > np.array(middle)[:, None]),
    )
    for one, other in zip(runs_of(plain, SIGMA, 0.0), runs_of(broken, SIGMA, 0.0), strict=True):
        assert other.end_s == pytest.approx(one.end_s + 1.0, abs=0.1)
        assert other.reversals == one.reversals
        assert other.length == pytest.approx(one.length, abs=2 * UM)
        assert set(one.after) - set(other.after) <= set(one.after[:3])
