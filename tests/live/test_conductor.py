"""The loop without devices: what it does in every kind of trouble is to lift and to end."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Any

import pytest

from meso_robust.live.exchange import Seen
from meso_robust.live.lab_file import WatchSection
from tests.live.rig import DONE, HOLDING, LOST, MOVE, Rig, lab, sight


class Plan:
    """Answers one after another, and what it was asked."""

    def __init__(self, *answers: Mapping[str, Any]) -> None:
        self._answers: Iterator[Mapping[str, Any]] = iter(answers)
        self.asked: list[tuple[float, float, float]] = []

    def __call__(self, x: float, y: float, theta: float) -> Mapping[str, Any]:
        self.asked.append((x, y, theta))
        return next(self._answers)


def test_two_moves_and_the_end() -> None:
    plan = Plan(MOVE, HOLDING, DONE)
    rig = Rig(plan)

    ending = rig.end()

    assert (ending.outcome, rig.conductor.made, len(plan.asked)) == ("done", 2, 3)
    assert [(c.name, c.x_um, c.y_um, c.speed_um_s) for c in rig.went] == [
        ("dual", 1000.0, 0.0, 1000.0),
        ("dual", 850.0, 0.0, 75.0),
        ("dual", 1000.0, 0.0, 1000.0),
        ("single", -500.0, 0.0, 1000.0),
        ("dual", 850.0, 0.0, 75.0),
    ]
    assert rig.lifted


def test_a_move_may_rest_before_and_after_and_draw_its_tips_back() -> None:
    rig = Rig(Plan({**MOVE, "rest_s": 1.0, "back_um": 60.0}, DONE))
    spent: dict[str, list[float]] = {}
    while rig.conductor.outcome is None:
        rig.turn()
        spent.setdefault(rig.conductor.phase, []).append(rig.time)

    assert (rig.conductor.outcome.outcome, rig.conductor.made) == ("done", 1)
    assert [(c.name, c.x_um, c.y_um, c.speed_um_s) for c in rig.went] == [
        ("dual", 1000.0, 0.0, 1000.0),
        ("dual", 850.0, 0.0, 75.0),
        ("dual", 910.0, 0.0, 75.0),
    ]
    phases = list(spent)  # in the order in which they began
    assert phases[-6:] == ["checking", "pushing", "resting", "withdrawing", "raising", "ended"]
    # a turn is 0.1 s, and a phase may begin anywhere in one
    assert spent["checking"][-1] - spent["checking"][0] == pytest.approx(1.0, abs=0.11)
    before = [time for time in spent["resting"] if time < spent["withdrawing"][0]]
    after = [time for time in spent["resting"] if time > spent["withdrawing"][0]]
    for times in (before, after):
        assert times[-1] - times[0] == pytest.approx(1.0, abs=0.11)
    assert rig.lifted


@pytest.mark.parametrize("phase", ["resting", "withdrawing"])
@pytest.mark.parametrize(
    ("change", "word"), [({"y_um": 5.0}, "straight way"), ({"height_um": 50.0}, "left the plane")]
)
def test_tips_that_stay_down_are_watched(phase: str, change: dict[str, Any], word: str) -> None:
    rig = Rig(Plan({**MOVE, "rest_s": 1.0, "back_um": 60.0}, DONE))
    rig.until(phase)
    rig.places["dual"] = replace(rig.places["dual"], **change)
    rig.turn()
    ending = rig.end()
    assert ending.outcome == "fault"
    assert word in ending.text


def test_a_tip_that_cannot_be_drawn_back_is_a_fault() -> None:
    rig = Rig(Plan({**MOVE, "back_um": 60.0}, DONE))
    rig.until("resting")
    rig.obey = False
    ending = rig.end()
    assert ending.outcome == "fault"
    assert "stopped 60.0 um short" in ending.text


def test_everything_is_halted_and_lifted_before_anything_is_looked_at() -> None:
    """What was going on when the program was killed ends there."""
    plan = Plan(MOVE, DONE)
    rig = Rig(plan)
    rig.places["dual"] = replace(rig.places["dual"], busy=True, x_um=7.0)

    first = rig.turn()

    assert [(c.do, c.name, c.height_um) for c in first] == [
        ("halt", "", 0.0), ("lift", "dual", 300.0), ("lift", "single", 300.0),
    ]  # fmt: skip
    for _ in range(20):
        rig.turn()  # it still moves
    assert plan.asked == []
    assert rig.went == []


def test_a_place_on_turned_axes_is_where_the_matrix_says() -> None:
    stated = lab()
    dual = stated.manipulators[0].model_copy(update={"axes": ((0.0, -1.0), (1.0, 0.0))})
    rig = Rig(
        Plan(MOVE, DONE),
        lab=stated.model_copy(update={"manipulators": (dual, *stated.manipulators[1:])}),
    )
    rig.end()
    assert [(c.x_um, c.y_um) for c in rig.went] == [(0.0, -1000.0), (0.0, -850.0)]


@pytest.mark.parametrize("answer", [{"refused": "outside"}, {"error": "no pose"}])
def test_what_is_refused_is_not_made(answer: Mapping[str, Any]) -> None:
    rig = Rig(Plan(answer))
    ending = rig.end()
    assert (ending.outcome, ending.text) == ("refused", next(iter(answer.values())))
    assert rig.went == []


def test_a_part_that_is_not_there_is_waited_for_and_then_given_up() -> None:
    plan = Plan()
    rig = Rig(plan)
    rig.sight = LOST
    ending = rig.end()
    assert ending.outcome == "refused"
    assert "no place fits the outline" in ending.text
    assert (plan.asked, rig.went) == ([], [])


def test_a_part_that_moves_is_not_acted_on() -> None:
    plan = Plan()
    rig = Rig(plan)
    rig.until("seeing")
    for k in range(200):
        rig.sight = sight(x=1500.0 + 2.0 * k)
        rig.turn()
    assert rig.conductor.outcome is not None
    assert "moves by" in rig.conductor.outcome.text
    assert plan.asked == []


def test_frames_taken_before_the_probes_were_lifted_do_not_count() -> None:
    plan = Plan(DONE)
    rig = Rig(plan)
    rig.until("seeing")
    since = rig.time
    for k in range(5):
        rig.number += 1
        old = rig.conductor
        reading_time = since - 0.05 + 0.001 * k
        from meso_robust.live.exchange import Reading, Seen

        seen = Seen(number=rig.number, time=reading_time, digest=rig.number, sight=sight())
        old.step(Reading(time=since + 0.001 * k, seen=seen, places=rig.places))
    assert plan.asked == []


def test_the_same_image_again_and_again_is_not_three_frames() -> None:
    plan = Plan()
    rig = Rig(plan)
    rig.until("seeing")
    from meso_robust.live.exchange import Reading, Seen

    for k in range(20):
        time = rig.time + 0.1 * (k + 1)
        seen = Seen(number=100 + k, time=time - 0.01, digest=7, sight=sight())
        rig.conductor.step(Reading(time=time, seen=seen, places=rig.places))
    assert plan.asked == []


@pytest.mark.parametrize("phase", ["placing", "hovering", "lowering", "checking", "pushing"])
def test_a_camera_that_stops_ends_it_wherever_it_is(phase: str) -> None:
    rig = Rig(Plan(MOVE, DONE))
    rig.until(phase)
    rig.obey, before = False, len(rig.went)
    rig.sight = None
    for _ in range(6):
        rig.turn()
    assert rig.conductor.phase in ("ending", "ended")
    rig.obey = True
    ending = rig.end()
    assert ending.outcome == "fault"
    assert "ms old" in ending.text or "lift" in ending.text
    assert len(rig.went) == before


@pytest.mark.parametrize("phase", ["seeing", "asking", "placing", "hovering", "lowering", "checking", "pushing", "raising"])  # fmt: skip
def test_a_stop_halts_and_lifts_at_once(phase: str) -> None:
    rig = Rig(Plan(MOVE, DONE), confirm=True)
    if phase not in ("seeing", "asking"):
        rig.until("asking")
        rig.turn(word="yes")
    rig.until(phase)
    before = len(rig.went)

    commands = rig.turn(word="stop")

    assert [c.do for c in commands] == ["halt", "lift", "lift"]
    assert rig.end().outcome == "stopped"
    assert rig.lifted
    assert len(rig.went) == before


def test_a_manipulator_that_stops_short_ends_it_and_the_plan_is_not_asked_again() -> None:
    plan = Plan(MOVE, DONE)
    rig = Rig(plan)
    rig.until("checking")
    rig.obey = False
    rig.until("pushing")
    rig.places["dual"] = replace(rig.places["dual"], x_um=900.0)
    for _ in range(12):
        rig.turn()
    rig.obey = True
    for command in rig.said[-2:]:
        rig._do((command,))
    ending = rig.end()
    assert ending.outcome == "fault"
    assert "dual stopped 50.0 um short" in ending.text
    assert len(plan.asked) == 1


def test_a_manipulator_that_leaves_its_way_ends_it() -> None:
    rig = Rig(Plan(MOVE, DONE))
    rig.until("checking")
    rig.obey = False
    rig.until("pushing")
    rig.places["dual"] = replace(rig.places["dual"], x_um=950.0, y_um=3.0, busy=True)
    rig.turn()
    assert rig.conductor.phase == "ending"


def test_a_part_that_was_moved_by_the_placing_is_not_pushed() -> None:
    rig = Rig(Plan(MOVE, DONE))
    rig.until("checking")
    rig.sight = sight(x=1504.0)
    ending = rig.end()
    assert ending.outcome == "refused"
    assert "has moved by 4.00 um" in ending.text
    assert len(rig.went) == 1
    assert rig.lifted


def test_no_probe_is_lowered_towards_a_part_that_was_kicked() -> None:
    rig = Rig(Plan(MOVE, DONE))
    rig.until("hovering")
    rig.sight = sight(x=1540.0)
    assert rig.end().outcome == "refused"
    assert {c.height_um for c in rig.said if c.do == "lift"} == {300.0}


def test_what_it_may_have_moved_by_counts_the_error_of_seeing() -> None:
    """5 um are stated; of 3 x 1 um of error 2 um are left."""
    for moved, outcome in ((1.9, "done"), (2.1, "refused")):
        rig = Rig(Plan(MOVE, DONE))
        rig.until("checking")
        rig.sight = sight(x=1500.0 + moved, sigma=1.0)
        rig.turn()
        assert (rig.conductor.phase == "pushing") == (outcome == "done"), moved


@pytest.mark.parametrize(
    ("change", "why"),
    [
        ({"travel_um": [-5000.0, 0.0]}, "outside its limits"),
        ({"speed_um_s": 2000.0}, "more than max_speed_um_s"),
        ({"probes": [{"name": "nobody", "start_um": [0.0, 0.0]}]}, "no manipulator carries nobody"),
        (
            {"probes": [{"name": "dtp_top", "start_um": [0.0, 300.0]}, {"name": "dtp_bottom", "start_um": [0.0, -290.0]}]},
            "cannot hold its tips so",
        ),
    ],
)  # fmt: skip
def test_a_move_that_cannot_be_made_is_not_begun(change: Mapping[str, Any], why: str) -> None:
    rig = Rig(Plan({**MOVE, **change}))
    ending = rig.end()
    assert ending.outcome == "refused"
    assert why in ending.text
    assert rig.went == []


def test_each_move_waits_for_its_yes() -> None:
    rig = Rig(Plan(MOVE, DONE), confirm=True)
    rig.until("asking")
    for _ in range(50):
        rig.turn()
    assert rig.went == []
    (asked,) = (c for c in rig.said if c.do == "ask")
    assert "dtp_top at (1000.0, 290.0)" in asked.text
    rig.turn(word="no")
    assert rig.end().outcome == "stopped"
    assert rig.went == []


def test_a_dry_run_commands_nothing() -> None:
    rig = Rig(Plan(MOVE), dry=True)
    for name, place in rig.places.items():
        rig.places[name] = replace(place, height_um=300.0)
    ending = rig.end()
    assert ending.outcome == "dry_run"
    assert "y_translation" in ending.text
    assert {c.do for c in rig.said} == {"end"}


def test_a_probe_that_cannot_be_lifted_is_told() -> None:
    rig = Rig(Plan())
    rig.obey = False
    ending = rig.end()
    assert ending.outcome == "fault"
    assert "dual, single could not be lifted: lift by hand" in ending.text


@pytest.mark.parametrize(
    ("reading", "why"),
    [
        ({"fault": "the camera is unplugged"}, "the camera is unplugged"),
        ({"places": {}}, "dual does not say where it is"),
        ({"stage_um": None}, "the stage does not say where it is"),
        ({"stage_um": (9.0, 0.0)}, "the stage has moved by 9.0 um"),
        ({"latency_s": 3.0}, "3000 ms from a frame"),
    ],
)
def test_what_devices_do_amiss_ends_it(reading: Mapping[str, Any], why: str) -> None:
    rig = Rig(Plan(MOVE, DONE))
    rest: dict[str, Any] = {"stage_um": (0.0, 0.0)}
    while rig.conductor.phase != "pushing":
        rig.turn(**rest)
    rig.turn(**{**rest, **reading})
    ending = rig.end()
    assert ending.outcome == "fault"
    assert why in ending.text
    assert rig.lifted


def test_frames_out_of_order_and_from_the_future_end_it() -> None:
    for time in (-5.0, 5.0):
        rig = Rig(Plan(MOVE))
        rig.until("seeing")
        rig.turn()
        from meso_robust.live.exchange import Reading, Seen

        seen = Seen(number=1, time=rig.time + time, digest=1, sight=sight())
        rig.conductor.step(Reading(time=rig.time, seen=seen, places=rig.places))
        assert rig.conductor.phase == "ending"


def test_a_move_takes_no_longer_than_it_should() -> None:
    rig = Rig(Plan(MOVE, DONE), lab=lab(watch=WatchSection(patience_s=1.0)))
    rig.until("checking")
    rig.obey = False
    rig.until("pushing")
    rig.places["dual"] = replace(rig.places["dual"], x_um=990.0, busy=True)
    for _ in range(60):
        rig.turn()
    assert any("did not arrive in time" in c.text for c in [rig.conductor.outcome] if c) or (
        rig.conductor.phase == "ending"
    )


def test_a_stop_that_was_said_before_the_first_turn_is_obeyed() -> None:
    rig = Rig(Plan(MOVE, DONE))
    first = rig.turn(word="stop")
    assert [c.do for c in first] == ["halt", "lift", "lift"]
    assert rig.end().outcome == "stopped"
    assert rig.went == []


@pytest.mark.parametrize("time", [math.nan, math.inf])
def test_a_time_or_place_that_is_no_number_ends_it(time: float) -> None:
    rig = Rig(Plan(MOVE, DONE))
    rig.until("pushing")
    seen = Seen(number=10**6, time=time, digest=1, sight=sight())
    rig.turn(seen=seen)
    assert rig.end().outcome == "fault"
    rig = Rig(Plan(MOVE, DONE))
    rig.turn(stage_um=(0.0, 0.0))
    rig.turn(stage_um=(time, 0.0))
    while rig.conductor.outcome is None:
        rig.turn(stage_um=(0.0, 0.0))
    assert rig.conductor.outcome.outcome == "fault"


def test_a_probe_that_was_not_lifted_because_a_device_failed_is_lifted_once_it_answers() -> None:
    rig = Rig(Plan(MOVE, DONE))
    rig.until("pushing")
    rig.obey = False
    rig.turn(word="stop")
    rig.turn(fault="dual: does not answer")
    rig.obey = True
    rig.turn()
    assert not rig.lifted
    assert rig.end().outcome == "stopped"
    assert rig.lifted
