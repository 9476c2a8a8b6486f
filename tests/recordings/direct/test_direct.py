"""Wrongs concealed by an independent generator are found with their sizes, and none where none is."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from meso_robust.recordings import Recording, RecordingSet, Rectangle, SensorInfo
from meso_robust.recordings.direct.causes import likely_cause
from meso_robust.recordings.direct.clocks import Stream, clock_test, regular_clock
from meso_robust.recordings.direct.finding import Finding
from meso_robust.recordings.direct.run import DirectTests, direct_tests
from meso_robust.recordings.direct.stated import misstated
from meso_robust.recordings.direct.straight import straight_test
from tests.recordings.direct.generator import (
    HALF_LONG,
    HALF_SHORT,
    RATIO,
    Camera,
    Seen,
    Stage,
    Support,
)

UM, DEG = 1e-6, np.pi / 180.0
SPEEDS = (40.0, 75.0, 150.0)


def as_set(seen: Sequence[Seen], rate: float = 30.0) -> RecordingSet:
    recordings = tuple(
        Recording(
            file=f"push_{k:02d}.csv",
            probe_names=tuple(f"probe{p + 1}" for p in range(one.tips.shape[1])),
            times=one.times,
            poses=one.poses * [UM, UM, DEG],
            probes=one.tips * UM,
        )
        for k, one in enumerate(seen)
    )
    return RecordingSet(
        part=Rectangle(length=2 * HALF_LONG * UM, width=2 * HALF_SHORT * UM),
        tip_radius=0.0,
        position_source="controller",
        sensor=SensorInfo(frame_rate=rate),
        recordings=recordings,
    )


def pushed(
    seed: int, count: int = 12, support: Support | None = None, **camera: Any
) -> RecordingSet:
    stage = Stage(seed, Camera(**camera), support or Support())
    return as_set([stage.push(k % 4, SPEEDS[k % 3]) for k in range(count)])


def finding(tests: DirectTests, effect: str) -> Finding:
    by_name = {one.effect: one for one in tests.findings}
    assert effect in by_name, sorted(by_name)
    return by_name[effect]


def near(one: Finding, *truth: float, within: float) -> None:
    values = [each.value for each in one.estimates]
    assert values == pytest.approx(truth, abs=within)


@pytest.mark.parametrize("seed", range(4))
def test_nothing_is_found_where_nothing_is_wrong(seed: int) -> None:
    tests = direct_tests(pushed(seed))
    assert tests.findings == ()
    assert tests.gap is not None
    assert tests.gap.rms[0] < 1.5e-6
    assert tests.balance is not None
    assert tests.balance.rho / UM**2 == pytest.approx(RATIO, rel=0.1)  # noise of ω makes it small


def test_offset_shift_and_yaw_are_told_apart() -> None:
    tests = direct_tests(pushed(1, 16, offset_um=(9.0, -6.0), shift_um=(-8.0, 12.0), yaw_deg=0.8))
    near(finding(tests, "reference_offset"), 9.0, -6.0, within=1.0)
    near(finding(tests, "registration_shift"), -8.0, 12.0, within=1.0)
    near(finding(tests, "part_yaw"), 0.8, within=0.1)
    assert tests.gap is not None
    before, after = tests.gap.rms
    assert before > 5e-6
    assert after < 1.2e-6


@pytest.mark.parametrize(
    ("camera", "effect", "truth", "within"),
    [
        ({"late_s": 0.06}, "camera_latency", (60.0,), 6.0),
        ({"turn_deg": 0.5}, "camera_rotation", (0.5,), 0.1),
        ({"stretch_percent": (0.0, 2.3)}, "camera_anisotropy", (0.0, 2.3), 0.25),
        ({"stretch_percent": (1.5, 1.5)}, "camera_scale", (1.5,), 0.2),
    ],
)
def test_a_wrong_camera_is_found_by_tip_and_face(
    camera: dict[str, Any], effect: str, truth: tuple[float, ...], within: float
) -> None:
    # with a shift free beside it: the set is about no particular origin
    tests = direct_tests(pushed(2, 16, **camera))
    near(finding(tests, effect), *truth, within=within)


@pytest.mark.parametrize(
    ("stated", "said"),
    [
        (25.0, "was the diameter given?"),
        (12.5, ""),
        (6.25, "was half of it given?"),
        (20.0, "measure"),
    ],
)
def test_a_radius_that_is_not_the_one_at_which_tips_touch_is_a_warning(
    stated: float, said: str
) -> None:
    """Tips of 12.5 um: their centres are that far outside of the point that touches."""
    stage, outward = Stage(5, Camera(), Support()), (-90.0, 0.0, 90.0, 180.0)
    seen = []
    for k in range(12):
        push = stage.push(k % 4, SPEEDS[k % 3])
        angle = np.radians(push.poses[:, 2] + outward[k % 4])
        away = 12.5 * np.column_stack([np.cos(angle), np.sin(angle)])
        seen.append(replace(push, tips=push.tips + away[:, None]))
    recordings = replace(as_set(seen), tip_radius=stated * UM)
    tests = direct_tests(recordings)
    told = [str(one) for one in misstated(recordings, tests)]
    # an offset or a size that looks nearly as well may be what is wrong
    alike = tuple(replace(one, alike=("part_geometry",)) for one in tests.findings)
    assert misstated(recordings, replace(tests, findings=alike)) == ()
    assert [f"{said} measure" in one or said == "measure" for one in told] == [True] * bool(said)
    if told:
        radius = float(told[0].split("tip_radius_um = ")[1].split()[0])
        assert radius == pytest.approx(12.5, abs=0.4)


def test_a_late_camera_is_found_in_the_hand() -> None:
    stage = Stage(3, Camera(late_s=0.12, stretch_percent=(0.0, 2.0)))
    tests = direct_tests(as_set([stage.carried() for _ in range(12)]))
    assert tests.hand is not None
    near(finding(tests, "camera_latency"), 120.0, within=6.0)
    near(finding(tests, "camera_anisotropy"), 0.0, 2.0, within=0.4)
    assert tests.hand.rms[1] < 0.2 * tests.hand.rms[0]
    assert tests.gap is not None
    assert tests.gap.rms[1] < 2e-6


@pytest.mark.parametrize(
    ("support", "effect", "truth", "within"),
    [
        (Support(lay=0.4, lay_deg=30.0), "anisotropic_drag", (0.4, 30.0), 6.0),
        (Support(centre_um=(80.0, -50.0)), "drag_centre_offset", (80.0, -50.0), 25.0),
    ],
)
def test_an_uneven_support_breaks_the_balance(
    support: Support, effect: str, truth: tuple[float, ...], within: float
) -> None:
    tests = direct_tests(pushed(5, 24, support))
    near(finding(tests, effect), *truth, within=within)
    assert tests.gap is not None
    assert tests.gap.findings == ()


def test_a_delay_is_never_negative() -> None:
    tests = direct_tests(pushed(2, 16, late_s=-0.05))
    assert "camera_latency" not in {one.effect for one in tests.findings}


def test_noise_of_the_log_and_of_its_stamps_are_told_apart() -> None:
    rng = np.random.default_rng(0)
    clean = pushed(6, 8)

    def noisy(one: Recording, tip_um: float, stamp_s: float) -> Recording:
        times = np.sort(one.times + stamp_s * rng.uniform(-1.0, 1.0, one.times.size) * 1.7)
        return replace(
            one, times=times, probes=one.probes + tip_um * UM * rng.normal(size=one.probes.shape)
        )

    log = straight_test(
        replace(clean, recordings=tuple(noisy(one, 0.1, 0.0) for one in clean.recordings))
    )
    assert log is not None
    assert log.tip_sigma / UM == pytest.approx(0.1, rel=0.15)
    assert log.stamp_sigma == 0.0
    stamps = straight_test(
        replace(clean, recordings=tuple(noisy(one, 0.01, 0.005) for one in clean.recordings))
    )
    assert stamps is not None
    assert stamps.tip_sigma / UM == pytest.approx(0.01, rel=0.15)
    assert stamps.stamp_sigma == pytest.approx(0.005, rel=0.2)


def test_a_jittering_clock_is_told_from_jerky_motion() -> None:
    rng = np.random.default_rng(1)
    even = np.array(np.delete(0.004 * np.arange(300), [50, 51, 120]), dtype=np.float64)
    place = np.column_stack((0.1 * even, 0.02 * even))
    late = np.array(np.sort(even + rng.exponential(0.0005, even.size)), dtype=np.float64)
    test = clock_test(Stream(file="a.csv", name="tip", times=late, values=place))
    assert test is not None
    assert test.lost == 3
    assert test.period == pytest.approx(0.004, rel=2e-3)
    assert test.stamps_at_fault
    jerky = np.column_stack((0.1 * (even + rng.exponential(0.001, even.size)), 0.02 * even))
    other = clock_test(Stream(file="a.csv", name="tip", times=even, values=jerky))
    assert other is not None
    assert not other.stamps_at_fault
    assert other.jitter < 1e-9


def test_one_late_stamp_is_seen_and_does_not_move_the_clock() -> None:
    even = np.arange(100) / 30.0
    late = even.copy()
    late[40] += 0.025
    test = clock_test(Stream(file="a.csv", name="tip", times=late, values=np.zeros((100, 2))))
    assert test is not None
    assert test.late == (40,)
    np.testing.assert_allclose(regular_clock(late)[1], even, atol=1e-9)


@pytest.mark.parametrize(
    ("camera", "slip", "words"),
    [
        ({}, lambda p, t: (p * [1, 1, DEG], t), "θ in rad"),
        ({}, lambda p, t: (p, t * [1, -1]), "y of the tips has the other sign"),
        ({}, lambda p, t: (p, t[..., ::-1]), "x and y of the tips are exchanged"),
        ({}, lambda p, t: (p, t + 250.0), "shifted"),
    ],
)
def test_a_slip_is_named(camera: dict[str, Any], slip: object, words: str) -> None:
    stage = Stage(8, Camera(**camera))
    seen = [stage.push(k % 4, heading_deg=[10.0, 60.0, 130.0, -70.0][k % 4]) for k in range(8)]
    wrong = []
    for one in seen:
        poses, tips = slip(one.poses, one.tips)  # type: ignore[operator]
        wrong.append(replace(one, poses=poses, tips=tips))
    assert likely_cause(as_set(seen)) is None
    cause = likely_cause(as_set(wrong))
    assert cause is not None
    assert words in cause.words


def test_a_long_delay_is_named() -> None:
    stage = Stage(9, Camera(late_s=0.3))
    cause = likely_cause(as_set([stage.push(k % 4, 300.0) for k in range(8)]))
    assert cause is not None
    assert "lags behind the tips by 3" in cause.words
