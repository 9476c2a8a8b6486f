"""Windows: where they are, what they say of nothing, and what of a hidden effect."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from meso_robust.diagnosis.hidden_inputs import CHANNELS
from meso_robust.diagnosis.windows import Windows, windowed
from meso_robust.identification.models import viscous
from meso_robust.recordings import RecordingSet
from tests.diagnosis.designs import SIGMA, VALUES, Given, Plan, random_plans, recorded_plans
from tests.identification.sets import PART, UM

MODEL = viscous(PART.outline)


def looked(recordings: RecordingSet, correlation: float = 0.0) -> Windows:
    return windowed(recordings, MODEL, VALUES, SIGMA, correlation)


def hidden(effects: Given | None, count: int = 6, seed: int = 3) -> Windows:
    rng = np.random.default_rng(seed)
    return looked(recorded_plans(random_plans(rng, count), rng, effects))


@pytest.fixture(scope="module")
def null() -> Windows:
    return hidden(None)


def test_windows_follow_the_phases_of_the_command() -> None:
    plan = Plan(pose=(0.0, 0.0, 0.3), place=(0.0, -0.5 * PART.width), normal=(0.0, -1.0))
    found = looked(recorded_plans([plan], np.random.default_rng(0)))
    clock = plan.corners[0]
    names = [cut.phase for cut in found.cuts]
    assert names[0] == "rest"
    assert names[-2:] == ["retract", "rest"]
    assert set(names[1:-2]) <= {"approach", "one_point"}
    assert names.count("one_point") >= 3
    contacts = [cut for cut in found.cuts if cut.phase == "one_point"]
    touch = clock[1] + plan.gap / plan.speed
    assert contacts[0].start_s == pytest.approx(touch, abs=0.2)  # the margin of 6 µm is early
    assert contacts[-1].end_s == pytest.approx(clock[2], abs=0.2)
    assert all(one.end_s < other.start_s for one, other in pairwise(found.cuts))


def test_without_a_mismatch_gains_are_those_of_noise(null: Windows) -> None:
    found = null.found
    assert found.chi2.sum() / found.freedom.sum() == pytest.approx(1.0, abs=0.08)
    ratio = found.gains.sum(axis=0) / found.ranks.sum(axis=0)
    assert np.all(np.abs(ratio - 1.0) < 5.0 * np.sqrt(2.0 / found.ranks.sum(axis=0)))
    scaled = found.slack / found.slack_sigma
    assert np.nanstd(scaled) == pytest.approx(1.0, abs=0.2)
    assert max(total.sigma for total in null.totals()) < 4.0


def test_no_tip_is_made_smaller_than_a_point() -> None:
    """Point tips, as `simulate --recordings` writes them, can only be larger than stated."""
    rng = np.random.default_rng(3)
    sharp = replace(recorded_plans(random_plans(rng, 2), rng), tip_radius=0.0)

    found = looked(sharp)

    assert np.isfinite(found.found.gains).all()


def test_colour_of_the_noise_is_no_evidence() -> None:
    rng = np.random.default_rng(5)
    recordings = recorded_plans(random_plans(rng, 6), rng, colour=0.6)
    known, ignored = looked(recordings, 0.6), looked(recordings, 0.0)
    spread = [np.nanstd(w.found.slack / w.found.slack_sigma) for w in (known, ignored)]
    assert spread[0] == pytest.approx(1.0, abs=0.2)
    assert spread[1] > 1.5  # (1 + φ)/(1 − φ) = 4 is twice the standard deviation


@pytest.mark.parametrize(
    ("channel", "effects"),
    [
        ("environment", {"body_force": {"x_um_s": 2.0, "y_um_s": -1.0}}),
        ("observation", {"camera_latency": {"time_ms": 60.0}}),
        ("support", {"drag_centre_offset": {"x_um": 40.0}}),
        ("contact", {"edge_dependent_friction": {"change": -0.7, "edge": 1.0}}),
        ("geometry", {"tip_radius": {"excess_um": 4.0}}),
    ],
)
def test_a_hidden_effect_shows_at_its_stage(channel: str, effects: Given) -> None:
    totals = hidden(effects).totals()
    best = max(totals, key=lambda one: one.evidence)
    of = {one.channel: one for one in totals}
    assert of[best.channel].sigma > 5.0
    # some stages are alike in windows: the true one is the best or hardly less
    assert of[channel].evidence > 0.97 * best.evidence  # type: ignore[index]


def test_slack_of_an_untouched_part_is_the_force_on_it() -> None:
    found = hidden({"body_force": {"x_um_s": 3.0}}).found
    free = np.array([np.nansum(row) == 0.0 for row in found.gains[:, [CHANNELS.index("geometry")]]])
    weight = 1.0 / found.slack_sigma[free] ** 2
    mean = np.sum(weight * found.slack[free], axis=0) / weight.sum(axis=0)
    error = 1.0 / np.sqrt(weight.sum(axis=0))
    assert np.all(np.abs(mean - [3.0 * UM, 0.0, 0.0]) < 4.0 * error)
    assert mean[0] > 10.0 * error[0]


def test_the_recording_with_the_effect_stands_out() -> None:
    rng = np.random.default_rng(8)
    plans = random_plans(rng, 6)
    plain = recorded_plans(plans, rng).recordings
    pulled = recorded_plans(plans, rng, {"body_force": {"y_um_s": 8.0}})
    mixed = (*plain[:4], pulled.recordings[4], plain[5])
    found = looked(
        RecordingSet(
            part=pulled.part,
            tip_radius=pulled.tip_radius,
            position_source=pulled.position_source,
            sensor=pulled.sensor,
            recordings=mixed,
        )
    )
    gained = found.found.gains[:, -1] - found.found.ranks[:, -1]
    assert found.windows[int(np.argmax(gained))].recording == 4


def test_the_same_windows_twice_are_the_same(null: Windows) -> None:
    again = hidden(None)
    assert np.array_equal(null.found.gains, again.found.gains)
