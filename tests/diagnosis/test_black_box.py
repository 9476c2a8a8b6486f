"""The regression that competes with named physics: which columns it has, picks and profits from."""

from __future__ import annotations

from dataclasses import replace
from itertools import combinations

import numpy as np
import numpy.typing as npt
import pytest

from meso_robust.diagnosis.controls import black_box, chosen, columns_of
from meso_robust.diagnosis.diagnose import Diagnosis
from meso_robust.diagnosis.validation import Errors
from meso_robust.identification.prepared import Prepared, prepare
from meso_robust.simulator import Point
from tests.diagnosis.designs import Plan, recorded_plans
from tests.identification.sets import PART, UM

Floats = npt.NDArray[np.float64]

PLACE = 0.4


def test_selection_is_the_best_subset_where_columns_are_orthogonal() -> None:
    rng = np.random.default_rng(0)
    columns = np.linalg.qr(rng.standard_normal((40, 7)))[0].T * rng.uniform(0.1, 9.0, (7, 1))
    data = rng.standard_normal(40)
    for numbers in range(4):
        weights = chosen(columns, data, numbers)
        left = [
            np.sum((data - data @ np.linalg.pinv(columns[list(of)]) @ columns[list(of)]) ** 2)
            for of in combinations(range(7), numbers)
        ]
        assert np.count_nonzero(weights) == numbers
        assert np.sum((data - weights @ columns) ** 2) == pytest.approx(min(left))


def test_a_column_that_repeats_another_is_not_chosen_again() -> None:
    rng = np.random.default_rng(1)
    columns = rng.standard_normal((3, 20))
    columns[1] = 2.0 * columns[0]
    weights = chosen(columns, 3.0 * columns[0] + 0.01 * columns[2], 3)
    assert np.count_nonzero(weights) == 2
    assert weights @ columns == pytest.approx(3.0 * columns[0] + 0.01 * columns[2])


@pytest.fixture(scope="module")
def pushed() -> tuple[Plan, Prepared, Floats]:
    """A push on one edge without noise, with its true poses."""
    plan = Plan(
        pose=(100 * UM, -50 * UM, 0.3),
        place=(PLACE * 0.5 * PART.length, -0.5 * PART.width),
        normal=(0.0, -1.0),
        slant=0.0,
    )
    recordings = recorded_plans([plan], np.random.default_rng(0), noise=0.0)
    prepared = prepare(recordings, step=1.5 * UM)
    return plan, prepared, prepared.seen


def test_columns_grow_with_the_way_of_the_tip_in_contact_only(
    pushed: tuple[Plan, Prepared, Floats],
) -> None:
    plan, prepared, poses = pushed
    columns = columns_of(prepared, poses)[:, 0]
    clock, touch = prepared.instants[0], plan.wait + plan.gap / plan.speed
    end = plan.wait + (plan.gap + plan.length) / plan.speed
    grown = np.clip(clock - touch, 0.0, end - touch) * plan.speed / prepared.length
    near = 3.0 * prepared.step / prepared.length + plan.speed / 30.0 / prepared.length
    assert columns[0, :, 0] == pytest.approx(grown, abs=2.0 * near)  # in x at an even rate
    assert np.all(columns[0, :, 1:] == 0.0)
    assert np.all(columns[:, clock < touch - 0.2] == 0.0)
    assert np.ptp(columns[:, clock > end + 0.3], axis=1) == pytest.approx(0.0, abs=1e-12)


def test_rates_are_speed_heading_place_time_edge_and_place_along_it(
    pushed: tuple[Plan, Prepared, Floats],
) -> None:
    plan, prepared, poses = pushed
    # rate by rate, the turn that has grown at the end, over the way
    ends = columns_of(prepared, poses)[4::5, 0, -1, 2]
    one, speed, sine, cosine, x, y, time, *edges, place = ends / ends[0]
    middle = poses[0].mean(axis=0)
    assert one == 1.0
    assert speed == pytest.approx(plan.speed / prepared.length, rel=0.1)
    assert np.arctan2(sine, cosine) == pytest.approx(0.3, abs=0.2)
    assert [x, y] == pytest.approx(middle[:2] / prepared.length, abs=0.15)
    touch = plan.wait + plan.gap / plan.speed
    assert time == pytest.approx(touch + 0.5 * plan.length / plan.speed, rel=0.05)
    sides = np.roll(PART.outline, -1, axis=0) - PART.outline
    below = int(np.argmax(sides[:, 0]))  # counter-clockwise: the lower side goes along +x
    assert edges == pytest.approx(np.eye(4)[below])
    assert place == pytest.approx(PLACE, abs=0.1)


def test_the_frame_of_the_part_is_turned_by_its_heading(
    pushed: tuple[Plan, Prepared, Floats],
) -> None:
    _, prepared, poses = pushed
    turned = poses + np.array([0.0, 0.0, 0.5 * np.pi])
    still = replace(prepared, outline=prepared.outline @ np.array([[0.0, -1.0], [1.0, 0.0]]))
    ahead = columns_of(prepared, poses)[2, 0]
    aside = columns_of(still, turned)[2, 0]
    assert aside[:, 0] == pytest.approx(-ahead[:, 1], abs=1e-9)
    assert aside[:, 1] == pytest.approx(ahead[:, 0], abs=1e-9)
    left = columns_of(prepared, poses)[3, 0]  # along the part's y
    assert left[:, 0] == pytest.approx(-ahead[:, 1], abs=1e-12)
    assert left[:, 1] == pytest.approx(ahead[:, 0], abs=1e-12)
    along = ahead[-1, 1] / ahead[-1, 0]
    assert np.tan(poses[0, :, 2]).min() < along < np.tan(poses[0, :, 2]).max()
    assert np.ptp(ahead[:, :2]) > 0.1


def grown(of: Errors, weights: dict[int, float], noise: Floats | float = 0.0) -> Errors:
    """Errors that are some columns and noise."""
    columns = np.where(of.at.seen, columns_of(of.prepared, of.poses), 0.0)
    white = sum(weight * of.at.rows(columns[k]) for k, weight in weights.items()) + noise
    return replace(of, rows=of.at.cleaned(np.broadcast_to(white, of.rows.shape)))


def test_what_grows_as_a_column_does_is_predicted_on_other_recordings(late: Diagnosis) -> None:
    assert late.plain.held_out is not None
    law = {3: 40.0, 24: 25.0}
    training, other = grown(late.plain.training, law), grown(late.plain.held_out, law)
    size = np.sqrt(np.sum(other.rows**2) / other.freedom.sum())
    assert black_box(training, other, 0) == pytest.approx(size)
    assert black_box(training, other, 2) < 1e-6 * size
    assert 1e-3 * size < black_box(training, other, 1) < size


def test_noise_of_other_recordings_is_not_predicted(late: Diagnosis) -> None:
    assert late.plain.held_out is not None
    rng = np.random.default_rng(4)
    training = grown(late.plain.training, {}, rng.standard_normal(late.plain.training.rows.shape))
    other = grown(late.plain.held_out, {}, rng.standard_normal(late.plain.held_out.rows.shape))
    size = np.sqrt(np.sum(other.rows**2) / other.freedom.sum())
    assert black_box(training, other, 3) > 0.995 * size


def test_it_does_worse_than_the_physics_that_was_left_out(late: Diagnosis) -> None:
    assert late.plain.held_out is not None
    assert late.extended is not None
    assert late.extended.held_out is not None
    assert late.checked.black_box is not None
    assert late.extended.held_out.whole < 1.1
    assert late.checked.black_box > late.extended.held_out.whole + 0.3
    assert late.checked.black_box < 1.3 * late.plain.held_out.whole


def test_the_tip_touches_where_its_radius_says(pushed: tuple[Plan, Prepared, Floats]) -> None:
    _, prepared, poses = pushed
    pointed = replace(prepared, shapes=(Point(),))
    assert np.any(columns_of(prepared, poses))
    assert not np.any(columns_of(pointed, poses))
