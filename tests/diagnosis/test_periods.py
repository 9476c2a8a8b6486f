"""Periods of waves that are found without a model, in motion that no code of the package made."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from meso_robust.diagnosis.diagnose import Diagnosis
from meso_robust.diagnosis.periods import MOST, driven, periods
from meso_robust.identification.prepared import Prepared
from meso_robust.types import Floats

UM = 1e-6


@pytest.fixture(scope="module")
def prepared(null: Diagnosis) -> Prepared:
    return null.baseline.prepared


def pushed(prepared: Prepared, wave: Any, seed: int = 3) -> tuple[Prepared, Floats]:
    """Pushes of 2 mm along x and along y at an even speed, seen to 0.5 µm, and where the tip was."""
    rng = np.random.default_rng(seed)
    runs, count = 6, 160
    way = np.linspace(0.0, 2000.0, count)
    tips = np.zeros((runs, count, 2))
    for run in range(runs):
        tips[run] = rng.uniform(-400.0, 400.0, 2)
        tips[run, :, run % 2] += way
    poses = np.concatenate([tips + wave(tips), np.zeros((runs, count, 1))], axis=2)
    poses[..., :2] = UM * (poses[..., :2] + rng.normal(0.0, 0.5, tips.shape))
    instants = np.tile(np.linspace(0.0, 20.0, count), (runs, 1))
    return replace(prepared, seen=poses, instants=instants), UM * tips


@pytest.mark.parametrize("period", [37.0, 90.0, 415.0, 1150.0])
@pytest.mark.parametrize("axis", [0, 1])
def test_the_period_of_a_wave_comes_first(prepared: Prepared, period: float, axis: int) -> None:
    def wave(tips: Floats) -> Floats:
        off = np.zeros_like(tips)
        off[..., axis] = 1.5 * np.sin(2 * np.pi * tips[..., axis] / period + 0.8)
        return off

    found = periods(*pushed(prepared, wave))
    assert found[0] == pytest.approx(period * UM, rel=0.25 * period / 2000.0)
    assert len(found) <= MOST


def test_neither_speed_nor_arch_of_a_push_is_a_wave(prepared: Prepared) -> None:
    """What the camera makes longer, and a push that slows down, leave only what noise makes of periods."""

    def stretched(tips: Floats) -> Floats:
        return 0.02 * tips + 20.0 * np.linspace(0.0, 1.0, tips.shape[1])[:, None] ** 2

    still = [periods(*pushed(prepared, lambda tips: 0.0 * tips, seed))[0] for seed in range(5)]
    bent = [periods(*pushed(prepared, stretched, seed))[0] for seed in range(5)]
    np.testing.assert_allclose(bent, still, rtol=1e-2)


def test_where_nothing_moves_there_are_no_periods(prepared: Prepared) -> None:
    few = replace(prepared, seen=prepared.seen[:, :5], instants=prepared.instants[:, :5])
    assert periods(few, few.seen[..., :2]) == []
    lost = replace(prepared, seen=np.full_like(prepared.seen, np.nan))
    assert periods(lost, lost.seen[..., :2]) == []


def test_a_tip_is_where_its_log_says_between_two_entries(prepared: Prepared) -> None:
    """At the time of a waypoint it is that, and half way between two the mean of both."""
    times, tips = prepared.times[:1], prepared.waypoints[:1, :, 0]
    middle = 0.5 * (times[:, 1:] + times[:, :-1])
    one = replace(prepared, times=times, waypoints=prepared.waypoints[:1], instants=middle)
    found = driven(one)
    np.testing.assert_allclose(found[0], 0.5 * (tips[0, 1:] + tips[0, :-1]), atol=1e-15)
