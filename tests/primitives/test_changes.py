"""Every step of the shipped plan is proved, and no longer is after a named change."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import pytest

from meso_robust import units
from meso_robust.bounds import Interval, Verdict
from meso_robust.certificates.chain import certify
from meso_robust.primitives import rotation
from meso_robust.primitives.move import Aim, MoveRule, Point, from_part
from meso_robust.primitives.names import ObligationId
from meso_robust.primitives.obligation import Step
from meso_robust.primitives.rotation import certify_rotation, rotation_begins
from meso_robust.primitives.setup import Setup, setup_of
from meso_robust.primitives.straighten import certify_straighten
from meso_robust.primitives.tilt import certify_tilt
from tests.conftest import paper_task as changed_task
from tests.strategies import paper_chain, paper_task

TILT, STRAIGHTEN, ROTATE, TO_GOAL = range(4)
NAMES = ("tilt", "straighten", "rotate", "to goal")


def again(
    index: int,
    rule: Callable[[MoveRule], MoveRule] = lambda rule: rule,
    setup: Callable[[Setup], Setup] = lambda setup: setup,
) -> Step:
    """A step of the shipped plan, from the same poses, with a changed rule or setup."""
    chain = paper_chain()
    old, given = chain.steps[index], setup(chain.setup)
    move = rule(old.rule)
    if index == TILT:
        return certify_tilt(move, old.pre, given)
    if index == ROTATE:
        return certify_rotation(move, old.pre, given)
    turn = None
    if index == STRAIGHTEN:
        first = chain.steps[TILT]
        turn = certify_tilt(first.rule, first.pre, chain.setup).leaves
    return certify_straighten(move, old.pre, given, turn)


def open_claims(step: Step) -> set[str]:
    """Ids of what is not proved, and the same with their data."""
    names = [o.name for o in step.obligations if o.proof.verdict is not Verdict.PROVED]
    return {text for name in names for text in (str(name.id), name.key)}


def by(aim: Aim, more_um: float) -> Aim:
    return replace(aim, offset_um=round(aim.offset_um + more_um, 1))


def shifted(*, x: float = 0.0, y: float = 0.0, end: float = 0.0) -> Callable[[MoveRule], MoveRule]:
    """The active probe starts elsewhere or ends elsewhere, um."""
    return lambda rule: replace(
        rule,
        dual=Point(x=by(rule.dual.x, x), y=by(rule.dual.y, y)),
        dual_end=by(rule.dual_end, end),
    )


def passive(*, x: float = 0.0, y: float = 0.0) -> Callable[[MoveRule], MoveRule]:
    """The passive tip rests elsewhere, um."""

    def change(rule: MoveRule) -> MoveRule:
        assert rule.single is not None
        return replace(rule, single=Point(x=by(rule.single.x, x), y=by(rule.single.y, y)))

    return change


def uncertain(**sides: Interval) -> Callable[[Setup], Setup]:
    return lambda setup: replace(setup, uncertainty=replace(setup.uncertainty, **sides))


def resized(**sides: Interval) -> Callable[[Setup], Setup]:
    changes: dict[str, Any] = dict(sides)
    return lambda setup: replace(setup, **changes)


@pytest.mark.parametrize("index", range(4), ids=NAMES)
def test_every_step_of_the_shipped_plan_is_proved(index: int) -> None:
    for step in (paper_chain().steps[index], again(index)):
        assert step.verdict is Verdict.PROVED
        assert step.post is not None
        assert step.obligations
        told = paper_chain().steps[index].post  # the same, widened by 1 % a side and to the grid
        assert told is not None
        assert step.post.within(told)
        assert told.x.width < 1.0201 * step.post.x.width + 4e-9
        assert told.theta.width < 1.0201 * step.post.theta.width + 1e-5


def test_the_shipped_plan_is_proved() -> None:
    chain = paper_chain()
    assert [step.rule.action for step in chain.steps] == [
        "tilt",
        "straighten",
        "rotate",
        "straighten",
    ]
    assert chain.verdict is Verdict.PROVED
    assert chain.open_obligation is None


WIDE_FRICTION = uncertain(friction=Interval(0.05, 0.9))
CROOKED = units.radians(20.0)
SLIPS = "tip_sticks"

BREAKS: dict[str, tuple[int, dict[str, Any], str]] = {
    # claim that must stay open, by step and change
    "tilt, wide friction": (TILT, {"setup": WIDE_FRICTION}, SLIPS),
    "straighten, wide friction": (STRAIGHTEN, {"setup": WIDE_FRICTION}, SLIPS),
    "rotate, wide friction": (ROTATE, {"setup": WIDE_FRICTION}, "no_jam"),
    "to goal, wide friction": (TO_GOAL, {"setup": WIDE_FRICTION}, SLIPS),
    "tilt from contact": (TILT, {"rule": shifted(x=-20)}, "tip_free_at_start"),
    "straighten from contact": (STRAIGHTEN, {"rule": shifted(x=-20)}, "tip_free_at_start/lower"),
    "rotate from contact": (ROTATE, {"rule": shifted(x=-20)}, "tip_free_at_start"),
    "to goal from contact": (TO_GOAL, {"rule": shifted(x=-20)}, "tip_free_at_start/upper"),
    "rotate ends as it touches": (ROTATE, {"rule": shifted(end=1220)}, "rests_before_end"),
    "rotate ends before it touches": (ROTATE, {"rule": shifted(end=1245)}, "rests_before_end"),
    "rotate hardly at all": (ROTATE, {"rule": shifted(end=1300)}, "rests_before_end"),
    "passive tip in contact": (ROTATE, {"rule": passive(x=15)}, "tip_free_at_start/passive"),
    "tilt without travel": (TILT, {"rule": shifted(end=225)}, "tip_reaches_part"),
    "straighten too short": (STRAIGHTEN, {"rule": shifted(end=40)}, "second_tip_touches"),
    # of 400 simulated runs from corners of the box all end against both tips at 420 um, 398 at 440 um
    "to goal too short": (TO_GOAL, {"rule": shifted(end=440)}, "second_tip_touches"),
    "rotate too far": (ROTATE, {"rule": shifted(end=-60)}, "both_tips_on_edges"),
    "tilt far off the middle": (TILT, {"rule": shifted(y=60)}, SLIPS),
    "tilt off the edge": (TILT, {"rule": shifted(y=520)}, "tip_on_edge"),
    "tilt near the middle": (TILT, {"rule": shifted(y=-120)}, "idle_tip_passes"),
    "straighten above the middle": (STRAIGHTEN, {"rule": shifted(y=120)}, "second_tip_touches"),
    "straighten below the middle": (STRAIGHTEN, {"rule": shifted(y=-220)}, SLIPS),
    "to goal above the middle": (TO_GOAL, {"rule": shifted(y=150)}, "tip_sticks/upper"),
    "to goal off the edge": (TO_GOAL, {"rule": shifted(y=-120)}, "tip_on_edge"),
    "tilt, crooked tips": (TILT, {"setup": uncertain(misalignment=CROOKED.hull(-CROOKED))}, ""),
    "straighten, crooked tips": (
        STRAIGHTEN,
        {"setup": uncertain(misalignment=CROOKED.hull(-CROOKED))},
        "pair_sticks",
    ),
    "rotate, crooked tips": (
        ROTATE,
        {"setup": uncertain(misalignment=CROOKED.hull(-CROOKED))},
        "",
    ),
    "to goal, crooked tips": (
        TO_GOAL,
        {"setup": uncertain(misalignment=CROOKED.hull(-CROOKED))},
        "pair_sticks",
    ),
    "upper tip ahead by 20 deg": (
        STRAIGHTEN,
        {"setup": uncertain(misalignment=CROOKED)},
        "pair_sticks",
    ),
    "lower tip ahead by 20 deg": (
        STRAIGHTEN,
        {"setup": uncertain(misalignment=-CROOKED)},
        "pair_sticks",
    ),
    "separation below the limit": (ROTATE, {"rule": shifted(y=-30)}, "no_jam"),
    "passive tip too high": (ROTATE, {"rule": passive(y=30)}, "no_jam"),
    "passive tip far below": (ROTATE, {"rule": passive(y=-500)}, ""),
    "tips too close": (
        TILT,
        {"rule": shifted(y=-55), "setup": resized(stated_spacing=units.metres(470.0))},
        "idle_tip_passes",
    ),
    "tips wider than the short edge": (
        TO_GOAL,
        {"setup": resized(stated_spacing=units.metres(840.0))},
        "tip_on_edge",
    ),
    "unknown sensing": (
        TILT,
        {"setup": uncertain(sensed_position=Interval(-6e-5, 6e-5))},
        "tip_free_at_start",
    ),
    "unknown film": (TO_GOAL, {"setup": uncertain(film_ratio=Interval(1e-8, 4e-6))}, ""),
}


@pytest.mark.parametrize("name", BREAKS)
def test_a_named_change_leaves_its_claim_open(name: str) -> None:
    index, change, claim = BREAKS[name]
    step = again(index, **change)
    assert step.verdict is not Verdict.PROVED
    found = open_claims(step)
    assert found or step.post is None
    if claim:
        assert claim in found


@pytest.mark.parametrize("index", [ROTATE])
def test_the_jam_limit_decides(index: int) -> None:
    """The separation may shrink down to w sqrt(1 + mu^2) plus the probes' errors, not below."""
    rule = paper_chain().steps[index].rule
    assert rule.single is not None
    separation = rule.dual.y.offset_um - 290.0 - rule.single.y.offset_um
    limit = 837.0 * (1 + 0.36**2) ** 0.5 + 10.0
    spare = separation - limit
    assert spare > 0.0
    no_jam = ObligationId.NO_JAM
    assert no_jam not in open_claims(again(index, shifted(y=-spare + 0.2)))
    assert no_jam in open_claims(again(index, shifted(y=-spare - 0.2)))


def test_a_jammed_pair_is_not_certified() -> None:
    """V = 857 um, w = 837 um, mu = 0.33, everything else known."""
    rule = paper_chain().steps[ROTATE].rule
    assert rule.single is not None
    separation = rule.dual.y.offset_um - 290.0 - rule.single.y.offset_um
    zero = Interval.point(0.0)
    known = uncertain(
        friction=Interval(0.33, 0.33),
        probe_position=zero,
        sensed_position=zero,
        misalignment=zero,
    )
    step = again(ROTATE, shifted(y=857.0 - separation), known)
    assert step.verdict is not Verdict.PROVED
    assert ObligationId.NO_JAM in open_claims(step)


def test_smaller_uncertainties_stay_proved() -> None:
    for index in range(4):
        step = again(
            index, setup=lambda setup: replace(setup, uncertainty=setup.uncertainty.scaled(0.5))
        )
        wide = paper_chain().steps[index].post
        assert step.verdict is Verdict.PROVED, NAMES[index]
        assert step.post is not None
        assert wide is not None
        assert step.post.within(wide)


def test_the_turn_of_a_tilt_makes_the_height_sharper() -> None:
    chain = paper_chain()
    old = chain.steps[STRAIGHTEN]
    alone = certify_straighten(old.rule, old.pre, chain.setup)
    assert alone.post is not None
    assert old.post is not None
    assert old.post.y.width < alone.post.y.width


def test_mirrored_tilt_is_the_mirror_image() -> None:
    """Pushing with the upper tip below the middle turns the part clockwise by as much."""
    chain = paper_chain()
    old = chain.steps[TILT]
    assert old.post is not None
    mirrored = replace(
        old.rule,
        side=-1,
        dual=replace(
            old.rule.dual, y=replace(old.rule.dual.y, offset_um=-old.rule.dual.y.offset_um)
        ),
    )
    step = certify_tilt(mirrored, old.pre, chain.setup)
    assert step.verdict is Verdict.PROVED
    assert step.post is not None
    assert step.leaves is not None
    assert step.post.theta.mid + old.post.theta.mid == pytest.approx(
        2 * old.pre.theta.mid, abs=1e-6
    )
    assert step.post.y.mid + old.post.y.mid == pytest.approx(2 * old.pre.y.mid, abs=1e-9)
    assert step.post.x.mid == pytest.approx(old.post.x.mid, abs=1e-9)


@pytest.mark.parametrize("change", [{"side": -1}, {"side": 0}, {"single": None}])
def test_a_rule_that_is_no_rotation_is_refused(change: dict[str, Any]) -> None:
    with pytest.raises(ValueError, match="rotation rule needs side = 1 and a passive tip"):
        again(ROTATE, lambda rule: replace(rule, **change))


def test_a_goal_of_30_um_is_not_reached() -> None:
    task = paper_task()
    goal = task.goal.model_copy(update={"position_tolerance_um": 30.0})
    narrow = setup_of(task.model_copy(update={"goal": goal}))
    chain = certify([step.rule for step in paper_chain().steps], narrow)
    assert chain.complete
    assert all(step.verdict is Verdict.PROVED for step in chain.steps)
    assert not chain.reaches_goal
    assert chain.verdict is not Verdict.PROVED


def test_an_unfinished_plan_proves_nothing() -> None:
    rules = [step.rule for step in paper_chain().steps]
    setup = paper_chain().setup
    assert certify(rules[:3], setup).verdict is not Verdict.PROVED
    assert certify(rules[1:], setup).verdict is not Verdict.PROVED
    assert certify([rules[0], rules[2], rules[3]], setup).verdict is not Verdict.PROVED


@pytest.mark.parametrize("beyond_um", [0.2, 0.8])
def test_an_idle_tip_that_would_strike_the_corner_on_its_way_is_seen(beyond_um: float) -> None:
    """Misaligned by 5 deg before a part at 92.5 deg, the upper tip comes down over the corner.

    It is beyond the end once the lower tip touches, and off the edge's line at the start, but not
    clear of the part in between: the simulated part turns 1.4 deg further than by the tilt alone.
    """
    task = changed_task(
        start__x_um=0.0,
        start__y_um=0.0,
        start__theta_deg=92.5,
        uncertainty__sensed_position_um=0.0,
        uncertainty__sensed_orientation_deg=0.0,
        uncertainty__probe_position_um=0.0,
        uncertainty__friction=[0.33, 0.33],
        uncertainty__film_ratio_percent=0.0,
        uncertainty__tip_misalignment_deg=[5.0, 5.0],
    )
    theta, beta, spacing, depth = math.radians(92.5), math.radians(5.0), 580.0, 418.5
    across = -spacing * math.tan(beta) * math.cos(theta) + spacing * math.sin(theta)
    offset = 808.0 + beyond_um - across
    rise = offset * math.sin(theta) - depth * math.cos(theta)
    reach = (depth + rise * math.cos(theta)) / math.sin(theta) - spacing / 2 * math.tan(beta)

    def tilt(far_um: float) -> Step:
        rule = MoveRule(
            step=1,
            primitive="y_translation",
            action="tilt",
            side=1,
            dual=Point(x=from_part(reach + far_um), y=from_part(rise + spacing / 2)),
            dual_end=from_part(reach - 20.0),
        )
        setup = setup_of(task)
        return certify_tilt(rule, setup.start, setup)

    assert "idle_tip_passes/before_touch" in open_claims(tilt(400.0))


def test_a_rotation_refused_at_its_start_is_not_followed_in_haste() -> None:
    """Tips so close that they may jam: the verdict is the same, and nothing of the turn is worked out."""
    old, given = paper_chain().steps[ROTATE], paper_chain().setup
    assert old.rule.single is not None
    closer = replace(old.rule.single, y=by(old.rule.single.y, 60.0))
    rule = replace(old.rule, single=closer)
    thorough, hasty = (
        certify_rotation(rule, old.pre, given, rough=rough) for rough in (False, True)
    )
    assert str(ObligationId.NO_JAM) in open_claims(thorough) & open_claims(hasty)
    assert {o.name.id for o in thorough.obligations} - {o.name.id for o in hasty.obligations} >= {
        ObligationId.PUSHES_UNTIL_REST,
        ObligationId.BOTH_TIPS_TOUCH,
    }
    assert not rotation_begins(rule, old.pre, given)
    assert rotation_begins(old.rule, old.pre, given)


def test_what_is_exactly_zero_takes_no_part_in_a_rotation() -> None:
    """Point tips that do not wander: no bend of the path, and no radius on which a creep hangs."""
    old, given = paper_chain().steps[ROTATE], paper_chain().setup
    move = rotation._move(old.rule, old.pre, given.edge(old.pre.theta.mid), given)
    assert move.grip.bend == Interval(0.0, 0.0)
    assert not {"bend", "by_r_D", "at_r_D", "by_drag_a", "radius_lower"} & set(move.of.creep.inputs)
    assert {"by_d_D", "at_d_D"} <= set(move.of.creep.inputs)
