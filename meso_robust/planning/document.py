"""``plan.json`` written: the policy's rules, and its moves for the nominal run."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from meso_robust import units
from meso_robust.planning.plan_file import (
    AimDocument as AimDocument,
    BoxDocument as BoxDocument,
    MoveDocument as MoveDocument,
    Pair as Pair,
    PlanDocument as PlanDocument,
    ProbeDocument as ProbeDocument,
    RuleDocument as RuleDocument,
)
from meso_robust.primitives.move import Aim, MoveRule
from meso_robust.primitives.setup import PoseBox
from meso_robust.task import Task
from meso_robust.types import Floats

NAMES = ("dtp_top", "dtp_bottom", "stp")
"""Tips: the one on the right of the dual-tip probe, seen along the push, the one on the left, and the
single one. A name stays with its tip whether the axes of a move are mirrored or not."""


def plan_document(
    task: Task,
    rules: Sequence[MoveRule],
    sensed: Sequence[Floats],
    posts: Sequence[PoseBox | None],
) -> PlanDocument:
    """Write out a plan.

    Parameters
    ----------
    task, rules
        The task and its moves.
    sensed
        (3,) pose sensed before each move of the nominal run, m and rad.
    posts
        Certified box after each move, None where there is none.

    Returns
    -------
    PlanDocument
        The policy, and its moves for the nominal run in um.
    """
    return PlanDocument(
        task=task.name,
        task_hash=task.hash,
        policy=tuple(_rule(rule) for rule in rules),
        moves=tuple(
            _move(task, rule, pose, post)
            for rule, pose, post in zip(rules, sensed, posts, strict=True)
        ),
    )


def _aim(aim: Aim) -> AimDocument:
    return AimDocument(relative_to=aim.anchor.value, offset_um=aim.offset_um)


def _rule(rule: MoveRule) -> RuleDocument:
    single = rule.single
    return RuleDocument(
        step=rule.step,
        primitive=rule.primitive,
        action=rule.action,
        side=rule.side,
        dual_x=_aim(rule.dual.x),
        dual_y=_aim(rule.dual.y),
        dual_end_x=_aim(rule.dual_end),
        single_x=None if single is None else _aim(single.x),
        single_y=None if single is None else _aim(single.y),
        heading=rule.frame.heading,
        mirrored=rule.frame.mirrored,
    )


def _move(task: Task, rule: MoveRule, pose: Floats, post: PoseBox | None) -> MoveDocument:
    spacing = task.probe.tip_spacing_um * units.UM
    commands = rule.commands(pose[None], spacing, np.zeros(1))
    places = dict(zip(names_of(rule), commands.tips[0], strict=True))
    return MoveDocument(
        step=rule.step,
        primitive=rule.primitive,
        probes=tuple(
            ProbeDocument(name=name, start_um=_um(places[name]), passive=name == "stp")
            for name in NAMES
            if name in places
        ),
        travel_um=_um(commands.travel[0, 0]),
        speed_um_s=task.probe.speed_um_s,
        expect=None if post is None else box_document(post),
    )


def names_of(rule: MoveRule) -> tuple[str, ...]:
    """Names of a move's tips.

    Parameters
    ----------
    rule
        The move.

    Returns
    -------
    tuple
        In the order of ``MoveRule.commands``: upper, lower, passive.
    """
    right, left, single = NAMES
    pair = (left, right) if rule.frame.mirrored else (right, left)
    return pair if rule.single is None else (*pair, single)


def _um(point: Floats) -> Pair:
    x, y = (round(float(value) / units.UM, 4) + 0.0 for value in point)
    return x, y


def box_document(box: PoseBox) -> BoxDocument:
    """A box as it is read.

    Parameters
    ----------
    box
        World frame.

    Returns
    -------
    BoxDocument
        um and deg, rounded outward to a thousandth, for reading: no proof looks at it.
    """
    return _box(box, _outward)


def goal_document(box: PoseBox) -> BoxDocument:
    """A goal as it is read.

    Parameters
    ----------
    box
        World frame.

    Returns
    -------
    BoxDocument
        um and deg, rounded inward to a thousandth, for reading: no proof looks at it.
    """
    return _box(box, _inward)


def _box(box: PoseBox, rounded: Callable[[float, float], Pair]) -> BoxDocument:
    return BoxDocument(
        x_um=rounded(units.to_um(box.x.lo), units.to_um(box.x.hi)),
        y_um=rounded(units.to_um(box.y.lo), units.to_um(box.y.hi)),
        theta_deg=rounded(units.to_deg(box.theta.lo), units.to_deg(box.theta.hi)),
    )


# 1e-6 of a thousandth: an end that the change of units has moved by a digit keeps its thousandth
def _inward(low: float, high: float) -> Pair:
    return float(np.ceil(low * 1e3 - 1e-6) / 1e3), float(np.floor(high * 1e3 + 1e-6) / 1e3)


def _outward(low: float, high: float) -> Pair:
    return float(np.floor(low * 1e3 - 1e-6) / 1e3), float(np.ceil(high * 1e3 + 1e-6) / 1e3)
