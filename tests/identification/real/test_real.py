"""Quick form of the report on recordings of others, where a folder of them lies beside the repository."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from meso_robust.recordings.importers import FORMATS
from meso_robust.recordings.importers.support_point_log import support_points
from reports.identification.real.fitting import errors, fitted, root_mean_square
from reports.identification.real.ladders import DELAY, problem_of, start_of
from reports.identification.real.push_tables import GUESS
from reports.identification.real.support_tables import LENGTH, held_by
from reports.identification.real.supports import usable
from reports.identification.real.wrenches import friction_at, pairs_of

REAL = Path(__file__).resolve().parents[4] / "shared" / "recordings"
real = pytest.mark.skipif(not REAL.is_dir(), reason="no recordings of others beside it")


@real
def test_a_film_fits_single_pushes_on_plywood_to_millimetres() -> None:
    problem = problem_of(FORMATS["mcube_json"].read(REAL / "mit_plywood").recordings, {})
    fit = fitted(problem, start_of(problem, GUESS))
    own = root_mean_square(errors(problem, fit.values))
    assert own[0] < 5e-3
    assert own[1] < np.radians(4.0)
    # √ρ of an even pressure on the square would be 0.38 of the side, of its rim 0.53
    assert 0.38 < np.sqrt(fit.values[0]) / 0.090 < 0.53


@real
def test_the_delay_of_the_two_finger_camera_shows() -> None:
    """Without it the tips stand millimetres inside the part."""
    recordings = FORMATS["two_finger_log"].read(
        REAL / "cmu_two_finger" / "bigrect_3pts_20_neg30_90"
    )
    some = replace(recordings.recordings, recordings=recordings.recordings.recordings[:6])
    sizes = []
    for effects in ({}, DELAY):
        problem = problem_of(some, effects)
        fit = fitted(problem, start_of(problem, GUESS))
        sizes.append(root_mean_square(errors(problem, fit.values))[0])
    assert 0.10 < fit.values[2] < 0.18
    assert sizes[1] < 0.5 * sizes[0]


@real
def test_forces_give_the_friction_and_its_centre_at_known_points() -> None:
    folder = "wood_30_90_30_30_30_90"
    recordings = FORMATS["support_point_log"].read(REAL / "cmu_support_points" / folder).recordings
    kept, wrong = usable(recordings, "")
    assert not wrong
    assert len(kept.recordings) == 50
    points = support_points(folder)
    assert points is not None
    friction, explained = friction_at(points, pairs_of(recordings, LENGTH))
    assert friction.sum() == pytest.approx(5.0, rel=0.05)  # measured apart from these pushes
    assert np.hypot(*(friction @ points / friction.sum())) < 4e-3
    assert explained > 0.9


@real
def test_a_pose_that_cannot_be_right_is_named() -> None:
    recordings = FORMATS["support_point_log"].read(
        REAL / "cmu_support_points" / "30_90_30_30_30_90"
    )
    _, wrong = usable(recordings.recordings, "exp9_15")
    assert len(wrong) == 1


def test_intervals_that_hold_the_known_points_are_counted() -> None:
    known = np.array([[-0.02, -0.02], [0.04, -0.02], [-0.02, 0.04]])
    shifts = np.linspace(-1e-3, 1e-3, 21)[:, None, None]
    assert held_by(known + shifts, known) == 6
    for aside in (5e-3, -5e-3):
        moved = known + shifts
        moved[:, 0, 0] += aside
        assert held_by(moved[:, [1, 2, 0]], known) == 5
