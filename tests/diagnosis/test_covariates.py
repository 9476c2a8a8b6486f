"""Covariates: what is there is found, and nothing else."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from meso_robust.diagnosis.localisation import Covariate, conditions, followed, scanned
from meso_robust.diagnosis.windows import windowed
from meso_robust.identification.models import viscous
from meso_robust.identification.prepared import prepare
from tests.diagnosis.designs import SIGMA, VALUES, Given, Plan, random_plans, recorded_plans
from tests.identification.sets import PART, UM

F = npt.NDArray[np.float64]
MODEL = viscous(PART.outline)
RECORDINGS = np.repeat(np.arange(14), 6)
NAMES = tuple(f"z{k}" for k in range(12))


def scan(slack: F, table: F) -> tuple[Covariate, ...]:
    return followed(slack, np.ones(slack.shape), NAMES, table, RECORDINGS, seed=0)


def drawn(rng: np.random.Generator) -> tuple[F, F]:
    """Slacks (W, 5) of unit noise, and covariates of recordings and of windows (W, 12)."""
    table = rng.standard_normal((len(RECORDINGS), 12))
    table[:, :6] = rng.standard_normal((14, 6))[RECORDINGS]
    return rng.standard_normal((len(RECORDINGS), 5)), table


def in_simulator(effects: Given | None, seed: int, count: int = 12) -> tuple[Covariate, ...]:
    rng = np.random.default_rng(seed)
    recordings = recorded_plans(random_plans(rng, count), rng, effects)
    prepared = prepare(recordings, step=MODEL.step)
    return scanned(windowed(recordings, MODEL, VALUES, SIGMA, prepared=prepared), prepared)


def test_what_a_slack_follows_comes_first() -> None:
    rng = np.random.default_rng(1)
    slack, table = drawn(rng)
    slack[:, 3] -= 1.5 * table[:, 2]
    first = scan(slack, table)[0]
    assert (first.component, first.frame, first.covariate) == ("x", "part", "z2")
    assert first.p_value < 0.01
    expected = np.corrcoef(slack[:, 3], table[:, 2])[0, 1]
    assert abs(first.correlation - expected) < 1e-9


def test_a_mean_is_a_constant() -> None:
    slack, table = drawn(np.random.default_rng(2))
    slack[:, 2] += 1.0
    first = scan(slack, table)[0]
    assert (first.component, first.covariate) == ("theta", "constant")
    assert first.correlation > 0.5


def test_nothing_is_followed_by_chance() -> None:
    rng = np.random.default_rng(3)
    alarms = sum(bool(scan(*drawn(rng))) for _ in range(60))
    assert alarms <= 8  # 3 expected


def test_windows_of_one_recording_are_no_independent_evidence() -> None:
    rng = np.random.default_rng(4)
    alarms = 0
    for _ in range(60):
        slack, table = drawn(rng)
        slack += 4.0 * rng.standard_normal((14, 5))[RECORDINGS]
        alarms += bool(scan(slack, table))
    assert alarms <= 8  # taken window by window nearly all would be


def test_one_wild_recording_carries_no_correlation() -> None:
    slack, table = drawn(np.random.default_rng(5))
    slack[RECORDINGS == 3] += 1e3
    assert scan(slack, table) == ()


def test_conditions_of_a_push() -> None:
    pose, edge = (100 * UM, -50 * UM, 0.5 * np.pi), -0.5 * PART.width
    plan = Plan(pose, place=(200 * UM, edge), normal=(0.0, -1.0), slant=0.0, speed=50 * UM)
    other = Plan(pose, place=(200 * UM, edge), normal=(0.0, -1.0), slant=0.0, speed=150 * UM)
    recordings = recorded_plans([plan, other], np.random.default_rng(0))
    prepared = prepare(recordings, step=MODEL.step)
    windows = windowed(recordings, MODEL, VALUES, SIGMA, prepared=prepared)
    names, table = conditions(prepared, windows.cuts)
    rows = [
        dict(zip(names, row, strict=True))
        for row, cut in zip(table, windows.cuts, strict=True)
        if cut.phase == "one_point"
    ]
    first = rows[1]
    assert abs(first["speed"] - 50 * UM) < 1e-9
    assert abs(first["lever arm"] - 200 * UM) < 20 * UM  # +y push, right of the centre: turns left
    # at 90° the part's +y is the stage's −x
    assert abs(first["tip velocity x (stage)"] + 50 * UM) < 1 * UM
    assert first["rest before"] < 0.45
    assert max(row["speed"] for row in rows) > 140 * UM
    assert {"one_point", "retract", "rest"} <= set(names)


def test_sets_without_a_mismatch_follow_nothing() -> None:
    assert sum(bool(in_simulator(None, seed, count=6)) for seed in range(2)) == 0


def test_a_drifting_camera_is_a_constant_of_the_stage() -> None:
    found = in_simulator({"camera_drift": {"y_um_s": -2.0}}, 6)
    of = {(one.component, one.frame, one.covariate): one for one in found}
    assert of[("y", "stage", "constant")].correlation < -0.5


def test_a_larger_tip_shows_along_the_way_of_the_tip() -> None:
    found = in_simulator({"tip_radius": {"excess_um": 6.0}}, 7)
    assert any("tip velocity" in one.covariate or one.covariate == "lever arm" for one in found)
