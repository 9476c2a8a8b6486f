"""A hidden transform is found within what is stated of it; and what that means for a task."""

from __future__ import annotations

import math

import numpy as np
import pytest

from meso_robust.errors import InputError
from meso_robust.live.calibrating import Seen, calibrate, fitted, grid
from meso_robust.live.calibration_file import CalibrationDocument
from meso_robust.live.devices import DeviceError
from meso_robust.live.lab_file import Lab, VirtualSection
from meso_robust.live.loading import calibrated
from meso_robust.live.placing import tip_places
from meso_robust.live.preflight import check_lab
from meso_robust.live.virtual import VirtualLaboratory
from meso_robust.live.virtual_bench import REPEATS, lab_of, laboratory_of, uncalibrated_lab
from meso_robust.task import load_task
from meso_robust.tasks import MICROSCOPE


@pytest.fixture(scope="module")
def measured() -> tuple[Lab, VirtualLaboratory, CalibrationDocument]:
    """One manipulator, which is what a change can break; `reports/live/calibrations.py` measures many."""
    task = load_task(MICROSCOPE)
    lab = uncalibrated_lab(task, 1)
    slow = lab.virtual.model_copy(update={"frame_rate_hz": 2.0})
    lab = lab.model_copy(update={"virtual": slow, "manipulators": lab.manipulators[1:]})
    laboratory = laboratory_of(task, lab)
    return lab, laboratory, calibrate(laboratory.devices(), lab)


def test_tips_are_where_the_calibration_says_within_its_error(
    measured: tuple[Lab, VirtualLaboratory, CalibrationDocument],
) -> None:
    lab, laboratory, document = measured
    found = calibrated(lab, document)
    for stated, one in zip(lab.manipulators, found.manipulators, strict=True):
        true = laboratory.truth.manipulators[one.name]
        before = 0.0
        for place in grid(lab, stated):
            where = tip_places(true, place)
            for name, tip in tip_places(one, place).items():
                assert np.abs(tip - where[name]).max() + REPEATS <= one.tip_error_um
                before = max(
                    before, float(np.abs(tip_places(stated, place)[name] - where[name]).max())
                )
        assert before > 3.0 * one.tip_error_um  # the file was far worse
        assert one.tip_error_um < 2.7  # with arrival_um what the task states


def test_the_axes_lie_within_their_intervals_and_the_probes_are_lifted(
    measured: tuple[Lab, VirtualLaboratory, CalibrationDocument],
) -> None:
    lab, laboratory, document = measured
    outside = 0
    for name, found in document.manipulators.items():
        off = np.abs(np.array(found.axes) - np.array(laboratory.truth.manipulators[name].axes))
        outside += int((off > np.array(found.axes_error)).sum())
    assert outside <= 1  # of 4 intervals of 95 %
    for one in laboratory.manipulators.values():
        assert one.status().height == pytest.approx(lab.manipulators[0].lifted_um * 1e-6)


def test_a_fit_by_hand() -> None:
    """A turn by a quarter, and an offset, with one place that lies 0.3 um off."""
    lab = lab_of(load_task(MICROSCOPE))
    owns = [np.array([x, y]) for x in (0.0, 100.0, 200.0) for y in (0.0, 100.0, 200.0)]
    seen = [Seen(own=own, tips={"a": np.array([-own[1] + 5.0, own[0] + 7.0])}) for own in owns]
    exact = fitted(seen, ["a"], lab)
    assert np.array(exact.axes) == pytest.approx(np.array([[0.0, -1.0], [1.0, 0.0]]), abs=1e-12)
    assert exact.tips["a"].offset_um == pytest.approx((5.0, 7.0))
    assert exact.tip_error_um == pytest.approx(0.1 * lab.camera.pixel_size_um, abs=1e-9)

    seen[4] = Seen(own=owns[4], tips={"a": seen[4].tips["a"] + [0.3, 0.0]})
    off = fitted(seen, ["a"], lab)
    residual = 0.3 * (1.0 - 1.0 / 9.0)  # the middle place shifts the mean alone
    assert off.tip_error_um > residual + 0.1 * lab.camera.pixel_size_um
    squares = residual**2 + 8.0 * (0.3 / 9.0) ** 2
    assert off.scatter_um == pytest.approx(math.sqrt(squares / 18.0))


def test_a_tip_that_is_not_seen_ends_it_lifted() -> None:
    task = load_task(MICROSCOPE)
    lab = lab_of(task, "-x", VirtualSection(part=(1e5, 1e5, 0.0), frame_rate_hz=5.0))
    laboratory = laboratory_of(task, lab)
    tips = lab.manipulators[0].tips
    wrong = tips[0].model_copy(
        update={"offset_um": (tips[0].offset_um[0] + 200.0, tips[0].offset_um[1])}
    )
    dual = lab.manipulators[0].model_copy(update={"tips": (wrong, tips[1])})
    stated = lab.model_copy(update={"manipulators": (dual, lab.manipulators[1])})
    with pytest.raises(DeviceError, match="dtp_top is not seen"):
        calibrate(laboratory.devices(), stated)
    assert laboratory.manipulators["dual"].status().height == pytest.approx(300e-6)


def test_a_task_that_states_less_than_was_measured_is_refused() -> None:
    task = load_task(MICROSCOPE)
    lab = lab_of(task)
    check_lab(task, lab, "lab")
    for change, why in (
        ({"tip_error_um": 3.5}, r"3\.8 um; the task states probe_position_um = 3"),
        ({"direction_error_deg": 0.03}, r"states travel_direction_deg = \[-0.02, 0.02\]"),
        ({"scale_error_percent": 0.06}, r"states travel_scale_percent = 0.05"),
    ):
        dual = lab.manipulators[0].model_copy(update=change)
        with pytest.raises(InputError, match=why):
            check_lab(task, lab.model_copy(update={"manipulators": (dual,)}), "lab")


@pytest.mark.parametrize(
    ("change", "why"),
    [
        ({"radius_um": 20.0}, r"radius_um = 20: must be within \[12, 13\]"),
        ({"offset_um": (0.0, 295.0)}, "tips are 585.00 um apart"),
        ({"offset_um": (2.0, 290.0)}, "is turned by -0.198 deg"),
    ],
)
def test_a_laboratory_that_is_not_the_task_s_is_refused(
    change: dict[str, object], why: str
) -> None:
    task = load_task(MICROSCOPE)
    lab = lab_of(task)
    dual = lab.manipulators[0]
    tips = (dual.tips[0].model_copy(update=change), dual.tips[1])
    wrong = lab.model_copy(update={"manipulators": (dual.model_copy(update={"tips": tips}),)})
    with pytest.raises(InputError, match=why):
        check_lab(task, wrong, "lab")
