"""What the recordings of a run state of its tips, by hand."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
import pytest

from meso_robust.live.exchange import Place, Reading, Seen
from meso_robust.live.journal import Header, Turn
from meso_robust.live.lab_file import Lab
from meso_robust.live.recorder import recordings_of
from meso_robust.recordings import RecordingSet, Rectangle
from tests.live.rig import TRUST, lab, sight

UM = 1e-6
SPEED, STOP = 80.0, 203.0  # um/s, um
PART = Rectangle(length=1616e-6, width=837e-6)


def _turn(phase: str, time: float, x: float, height: float) -> Turn:
    """A frame that is exposed 12 ms before the manipulators are asked."""
    seen = Seen(number=1, time=time - 0.012, digest=1, sight=sight(sigma=0.8))
    down = Place(x_um=x, y_um=0.0, height_um=height, busy=False)
    away = Place(x_um=0.0, y_um=0.0, height_um=300.0, busy=False)
    reading = Reading(time=time, seen=seen, places={"dual": away, "single": down})
    return Turn(reading=reading, phase=phase, commands=(), sensed=None, move=None)


def _turns() -> Sequence[Turn]:
    """A tip that waits for 0.5 s, goes 203 um at 80 um/s, and rests: it stops between two answers."""
    turns = []
    for k in range(40):
        time = 0.1 * (k + 1)
        x = min(max(SPEED * (time - 0.55), 0.0), STOP)
        phase = "checking" if x == 0.0 else "pushing" if x < STOP else "resting"
        turns.append(_turn(phase, time, x, 0.0))
    return [*turns, _turn("seeing", 4.1, STOP, 300.0)]


def _made(given: Lab) -> RecordingSet:
    header = Header(
        task_hash="", plan_hash="", lab=given, trust=TRUST, confirm=False, dry=False, version="", started=""
    )  # fmt: skip
    made = recordings_of(header, _turns(), PART)
    assert made is not None
    return made


def test_a_tip_is_where_it_was_when_a_frame_was_exposed() -> None:
    """Also where it began or ended to move since the manipulators were asked before."""
    (one,) = _made(lab()).recordings
    assert one.times[0] == 0.0
    clock = one.times + 0.188  # the first frame after the first answer
    expected = np.clip(SPEED * (clock - 0.55), 0.0, STOP)
    assert np.abs(one.probes[:, 0, 0] / UM - expected).max() < 1e-6
    assert np.all(one.probes[:, 0, 1] == 0.0)


def test_the_sensor_states_what_tracker_and_laboratory_do() -> None:
    stated = lab()
    off = {"tip_error_um": 2.7, "direction_error_deg": 0.1, "scale_error_percent": 0.2}
    (dual, single) = stated.manipulators
    unsure = stated.model_copy(update={"manipulators": (dual, single.model_copy(update=off))})
    sensor = _made(unsure).sensor
    assert sensor.position_sigma == pytest.approx(0.8 * UM)
    assert sensor.orientation_sigma == pytest.approx(math.radians(0.02))
    # 203 um turned by 0.1 deg end 0.354 um aside, and 0.2 % of them are 0.406 um
    largest = math.sqrt(2.7**2 + 0.354**2 + 0.406**2)
    assert sensor.tip_offset == pytest.approx(largest / math.sqrt(3.0) * UM, rel=1e-3)
    assert _made(stated).sensor.tip_offset == 0.0
