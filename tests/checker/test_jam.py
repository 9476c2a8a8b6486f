"""Two tips that jam the part: no motion is left, by every mode and by both engines."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from flint import arb, ctx

from meso_robust.checker import jam, replay as replaying
from meso_robust.checker.document import AimDocument
from meso_robust.checker.grip import D, S
from meso_robust.checker.ids import Must, Objection, named
from meso_robust.checker.inputs import PoseBox, given
from meso_robust.checker.jam import check_jam
from meso_robust.checker.passage import Passage
from meso_robust.checker.ranges import ZERO, side_of
from meso_robust.checker.refusal import Refused
from meso_robust.checker.replay import JAM
from meso_robust.checker.rotate import Held, Turn
from meso_robust.checker.scene import Scene, scene_of
from meso_robust.checker.slide import grip_of
from meso_robust.checker.verdict import BITS
from meso_robust.checker.words import sentence
from meso_robust.laboratory.draws import draw
from meso_robust.laboratory.replay import Feedback
from meso_robust.laboratory.witness import more_of
from meso_robust.primitives.setup import setup_of
from meso_robust.simulator.outcome import Outcome
from meso_robust.task import Task, parse_task
from tests.checker import balance
from tests.checker.test_check import checked, objection
from tests.checker.test_replay import Document, fate, refuting
from tests.checker.test_rotate import END, RISE, SPACING, rule, scene, task
from tests.conftest import paper_task
from tests.laboratory.paper import paper_player
from tests.nightly import often

WIDTH, MU, RADII = 837.0, 0.33, 14.0
"""um: of the part of test_rotate, its friction, and the radii of both tips together."""
LEAST = WIDTH * np.hypot(1.0, MU) + RADII / np.hypot(1.0, MU)
"""um: the tips' distance across the travel without a jam (``reports/derivations``, no-jam of round tips)."""
ROTATION = 2
"""Which move of the paper's plan."""


@pytest.fixture(autouse=True)
def precision() -> Iterator[None]:
    with ctx.workprec(BITS):
        yield


# ------------------------------------------------------------------------ certificates


def closer(document: Document, by_um: float) -> Document:
    """The certificate as one that a run with no error refutes; its tips are closer in the rotation."""
    found = refuting(document, paper_task(), outcome=JAM)
    found["policy"][ROTATION]["dual_y"]["offset_um"] -= by_um
    return found


def test_a_run_that_jams_is_confirmed(document: Document) -> None:
    answer = checked(closer(document, 32.0), paper_task())
    assert (answer.verdict, answer.positive) == ("WITNESS CONFIRMED", False)
    assert f"move {ROTATION + 1}: {sentence(named(Objection.JAMS))}" in answer.claims
    assert not any("outcome" in one for one in answer.not_checked)


def test_a_run_that_jams_does_not_fail_otherwise(document: Document) -> None:
    found = closer(document, 32.0)
    found["witness"]["outcome"] = "misses_goal"
    assert objection(found) == "value: witness.outcome"


def test_a_run_that_ends_in_the_goal_does_not_jam(document: Document) -> None:
    assert objection(closer(document, 0.0)) == "witness_fails"


@pytest.mark.parametrize("shown", ["between", "closings"])
def test_a_jam_that_is_not_shown_is_undecided(
    document: Document, monkeypatch: pytest.MonkeyPatch, shown: str
) -> None:
    rows = getattr(jam, f"_{shown}")

    def and_what_is_not(held: Held, bound: arb) -> list[Any]:
        return [*rows(held, bound), lambda: held.grip.apart * -1]

    monkeypatch.setattr(jam, f"_{shown}", and_what_is_not)
    found = closer(document, 32.0)
    assert checked(found, paper_task()).verdict == "WITNESS UNDECIDED"


@pytest.mark.parametrize("meets", [False, True])
def test_a_wall_on_the_way_counts_first(monkeypatch: pytest.MonkeyPatch, *, meets: bool) -> None:
    def not_shown(*_: object) -> None:
        raise Refused(named(Must.PART_CLEAR_OF_WALLS), "apart from each wall", "not shown")

    monkeypatch.setattr(replaying, "clear_of_walls", not_shown)
    monkeypatch.setattr(replaying, "meets_a_wall", lambda *_: meets)
    monkeypatch.setattr(replaying, "check_jam", lambda *_: None)
    why = named(Must.NO_JAM)
    found = replaying._stopped(pushing(880.0), given(task(0.0)), 0, why)
    assert found.fails is meets
    assert found.outcome is None
    assert found.why.id is (Objection.MEETS_WALL if meets else Must.PART_CLEAR_OF_WALLS)


# ------------------------------------------------------------------------ where it begins


def pushing(apart: float, share: float = 0.0, end_um: float = END) -> Scene:
    """A rotation between tips so far apart across the travel, um; where the active one ends."""
    rises = 925.0 * np.sin(np.radians(0.1))  # the travel of that task is turned against x
    found = scene(given(task(share)), share, (apart + rises) / np.cos(np.radians(0.1)))
    end = AimDocument(relative_to="sensed part", offset_um=end_um)
    return replace(found, rule=found.rule.model_copy(update={"dual_end_x": end}))


def test_it_jams_up_to_the_distance_that_is_derived() -> None:
    assert check_jam(pushing(LEAST - 0.5)).does == named(Objection.JAMS)
    with pytest.raises(Refused, match="jams"):
        check_jam(pushing(LEAST + 0.5))


def test_what_the_ranges_leave_open_stays_open() -> None:
    """At one distance some of the runs jam and others do not."""
    with pytest.raises(Refused, match=r"jam|close"):
        check_jam(pushing(LEAST - 2.0, 0.1))
    assert check_jam(pushing(LEAST - 15.0, 0.1)).does == named(Objection.JAMS)


def test_a_push_that_ends_before_the_grip_closes_does_not_jam() -> None:
    with pytest.raises(Refused, match="jams"):
        check_jam(pushing(LEAST - 20.0, end_um=-250.0))
    assert check_jam(pushing(LEAST - 20.0, end_um=-400.0)).does == named(Objection.JAMS)


def test_a_stretch_that_motions_may_leave_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(jam, "MORE", -0.1)
    with pytest.raises(Refused, match="tube"):
        check_jam(pushing(LEAST - 20.0))


@pytest.mark.parametrize("ahead_deg", [-3.0, 3.0])
def test_an_idle_tip_that_may_touch_first_is_refused(ahead_deg: float) -> None:
    """What the part does then is another matter. Of tips so close both reach the edge."""
    apart, spacing = 880.0, 150.0
    values = task(0.0, probe={"tip_spacing_um": spacing}).to_dict()
    values["uncertainty"]["tip_misalignment_deg"] = [ahead_deg, ahead_deg]
    found = scene(given(Task.from_dict(values)), 0.0, apart)
    nearer = AimDocument(relative_to="sensed part", offset_um=RISE + (apart + spacing) / 2)
    moved = replace(found, rule=found.rule.model_copy(update={"dual_y": nearer}))
    if ahead_deg < 0:
        assert check_jam(moved).does == named(Objection.JAMS)
    else:
        with pytest.raises(Refused, match="idle"):
            check_jam(moved)


def test_tips_that_close_on_the_part_as_they_touch_it_jam_at_once() -> None:
    """With much friction the line through both contacts is within both cones at the touch."""
    found = check_jam(leaning(2.3, 340.0))
    ends = [float(end) for end in found.post.theta]
    assert 2.3 < ends[0] < ends[1] < 2.31


@pytest.mark.parametrize("what", ["_pressed", "_on_edges", "_forces"])
def test_tips_that_may_leave_the_part_are_refused(
    monkeypatch: pytest.MonkeyPatch, what: str
) -> None:
    monkeypatch.setattr(Turn, what, lambda *_: [lambda: ZERO])
    monkeypatch.setattr(Turn, "_forces_back", lambda *_: [lambda: ZERO])
    monkeypatch.setattr(Turn, "_exceeds", in_balls)
    with pytest.raises(Refused, match=r"both tips|active tip"):
        check_jam(leaning(2.3, 340.0))


def in_balls(turn: Turn, bound: arb, *spares: Any) -> bool:
    """What is asked of all grips, at one of them."""
    held = turn._held(turn.pieces[0], turn.around.middle)
    values = [[of() for of in spare(held, bound)] for spare in spares]
    return any(all(getattr(one, "value", one) > 0 for one in own) for own in values)


def test_a_stretch_beyond_the_end_of_the_travel_is_refused(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(jam, "_shut", lambda land, below, h_end: float(h_end) - 1e-6)
    with pytest.raises(Refused, match="jams"):
        check_jam(pushing(LEAST - 20.0, end_um=-400.0))


def leaning(theta: float, reach: float) -> Scene:
    """A part that leans, between two tips as far above and below it along its edges, um."""
    c, s = np.cos(theta), np.sin(theta)
    gap = 1.0
    active = reach * np.array([c, s]) + (WIDTH / 2 + 5.0) * np.array([s, -c])
    passive = -reach * np.array([c, s]) - (WIDTH / 2 + 9.0 + gap) * np.array([s, -c])
    aims = {
        "dual_x": active[0] + 30.0, "dual_y": active[1] + SPACING / 2, "dual_end_x": active[0] - 400.0,
        "single_x": passive[0], "single_y": passive[1],
    }  # fmt: skip
    aimed = {
        name: AimDocument(relative_to="sensed part", offset_um=float(um))
        for name, um in aims.items()
    }
    zero = side_of(ZERO)
    pre = PoseBox(x=zero, y=zero, theta=side_of(arb(theta)))
    values = task(0.0).to_dict()
    values["uncertainty"]["friction"] = [0.9, 0.9]
    return scene_of(rule().model_copy(update=aimed), pre, given(Task.from_dict(values)))


# ------------------------------------------------------------------------ by every mode


def states(seed: int, count: int) -> Iterator[dict[str, float]]:
    """Grips about to close, real parts and films; lengths in half widths."""
    rng = np.random.default_rng(seed)
    while count:
        n = {
            "depth": rng.uniform(0.8, 1.2), "depth_far": rng.uniform(0.8, 1.2), "radius": rng.uniform(0.01, 0.1),
            "radius_far": rng.uniform(0.01, 0.1), "tilt": rng.uniform(-0.1, 0.1), "drag_a": rng.uniform(-0.1, 0.1),
            "drag_n": rng.uniform(-0.1, 0.1), "rho": rng.uniform(0.3, 3.0), "stretch": rng.uniform(-0.2, 0.2),
            "shear": rng.uniform(-0.2, 0.2), "bend": rng.uniform(-0.1, 0.1), "mu_lower": rng.uniform(0.1, 0.6),
            "mu_passive": rng.uniform(0.1, 0.6), "h": rng.uniform(0.0, 1.0), "ahead": rng.uniform(-0.5, 1.5),
            "V": rng.uniform(1.9, 2.6),
        }  # fmt: skip
        with np.errstate(invalid="ignore"):
            T = grip_of(n, n["h"], S, n["ahead"]).T
        if T > 0.1:
            count -= 1
            yield n


def held(n: dict[str, float]) -> Held:
    return Held(grip_of(n, n["h"], S, n["ahead"]), n)


def kept(of: Held) -> bool:
    """Both tips press whatever the ratios."""
    forces = [force for one in of.corners for force in (one.moving, one.resting)]
    alone = [of.grip.alone(of.drag, of.ratios[D] * sign) for sign in (-1, 1)]
    return min(*forces, *alone) > 0


def test_slips_are_those_of_every_mode() -> None:
    for n in states(0, 50):
        own, other = held(n), balance.Held.at(n, n["h"], n["ahead"])
        lean = np.sqrt(1 + n["tilt"] ** 2)
        for ways in ((-1, -1), (-1, 1), (1, -1), (1, 1)):
            motion = other.motion(ways, own.ratios)
            assert motion is not None
            forces = own.forces(*ways)
            found = np.array(forces.slips) / forces.divisor
            told = [other.slip(motion, D), other.slip(motion, S) / lean]
            assert found == pytest.approx(told, rel=1e-6, abs=1e-9)


def test_no_mode_is_left_where_all_are_excluded() -> None:
    """While only the first and the last row hold slips keep to their sides; without these, motions remain."""
    seen = dict.fromkeys(("jam", "between", "closed"), 0)
    for n in states(1, often(4000, 20000)):
        own = held(n)
        if not kept(own):
            continue
        other = balance.Held.at(n, n["h"], n["ahead"])
        motions = other.motions(own.ratios)
        between, closed = (
            all(float(of()) > 0 for of in rows(own, ZERO)) for rows in (jam._between, jam._closings)
        )
        if between and closed:
            assert not motions
            seen["jam"] += 1
        elif between:
            seen["between"] += len(motions)
        elif closed:
            seen["closed"] += len(motions)
        for motion in motions:
            slips = [other.slip(motion, tip) for tip in (D, S)]
            assert not between or (slips[D] > -1e-9 and slips[S] < 1e-9)
    assert min(seen.values()) > 20


# ------------------------------------------------------------------------ against the simulator


def real_paper_task() -> Task:
    """The paper's, of parts and tips within tolerances; the film and the ways as stated."""
    values = paper_task().to_dict()
    values["schema"] = "meso-robust/task/2"
    values["part"] |= {"size_tolerance_um": 2.0, "squareness_deg": 0.1}
    values["probe"]["tip_radius_um"] = [1.0, 2.0]
    values["uncertainty"] |= {"friction": [0.33, 0.34], "friction_common": True}
    return parse_task(values, "real")


@pytest.mark.parametrize(("of", "certain"), [(paper_task, True), (real_paper_task, False)])
def test_runs_jam_where_the_event_driven_engine_jams_them(
    monkeypatch: pytest.MonkeyPatch, of: Callable[[], Task], *, certain: bool
) -> None:
    """Between tips so far apart that errors and friction decide; ``certain``: the run tells all of them."""
    whole, rules = of(), list(paper_player().rules)
    setup, dual = setup_of(whole), rules[ROTATION].dual
    nearer = replace(dual, y=replace(dual.y, offset_um=dual.y.offset_um - 24.0))
    rules[ROTATION] = replace(rules[ROTATION], dual=nearer)
    draws = draw(setup, len(rules), often(4, 20), np.random.default_rng(9))
    player = Feedback(rules=tuple(rules), setup=setup, engine="events")
    rows = player.rows_of(draws)
    found = player.run(rows)
    jammed = (found.outcomes == Outcome.JAM) & (found.failed_in == ROTATION)
    assert 0 < jammed.sum() < len(jammed)
    stuck: list[PoseBox] = []

    def proved(moved: Scene) -> Passage:
        passage = check_jam(moved)
        stuck.append(moved.frame.world(passage.post))
        return passage

    monkeypatch.setattr(replaying, "check_jam", proved)
    for row, jams in enumerate(jammed):
        known = len(stuck)
        told = fate(whole, tuple(rules), draws, row, more_of(player, rows[row]))
        shown = told is not None and told.outcome == JAM
        assert shown <= jams
        assert shown == jams or not certain
        assert len(stuck) == known + shown
        if shown:
            where = stuck[-1]
            for value, (low, high) in zip(
                found.final[row], (where.x, where.y, where.theta), strict=True
            ):
                assert float(low) - 1e-8 < value < float(high) + 1e-8
    assert stuck
