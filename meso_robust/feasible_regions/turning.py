"""Proofs that a two-sided rotation fails; see ``impossible`` for what counts as a proof."""

from __future__ import annotations

from dataclasses import replace

from meso_robust.bounds import Interval, Verdict, enclose
from meso_robust.bounds.interval import cos, sin
from meso_robust.conditions import condition
from meso_robust.feasible_regions.cells import extreme
from meso_robust.feasible_regions.impossible import misses
from meso_robust.motion import sticking
from meso_robust.primitives.move import MoveRule
from meso_robust.primitives.names import ObligationId
from meso_robust.primitives.obligation import Step
from meso_robust.primitives.rotation import certify_rotation
from meso_robust.primitives.setup import PoseBox, Setup
from meso_robust.primitives.tips import HALF

LONGER = Interval.point(2.0)  # how much longer the part is made to see a tip run off its edge


def rotation_fails(rule: MoveRule, pre: PoseBox, setup: Setup) -> bool:
    """Whether the rotation is broken for all commands of ``rule``.

    One pose of ``pre`` and one value of the uncertainties for which it is are enough.

    Raises
    ------
    ValueError
        The rule has no passive tip.
    """
    if rule.single is None:
        raise ValueError(f"a rotation needs a passive tip, got {rule}")
    points = [_point(pre, setup, upper) for upper in (True, False)]
    past = (rule.dual_end.offset - rule.single.x.offset).hi < 0.0  # else no tip is near an end
    return any(_too_short(rule, pose, at) for pose, at in points) or (
        past and any(_runs_off(rule, pose, at) for pose, at in points)
    )


def _point(pre: PoseBox, setup: Setup, upper: bool) -> tuple[PoseBox, Setup]:
    """A pose and values of the uncertainties: the pair of tips high (or low) on the part."""
    u = setup.uncertainty
    known = replace(
        u,
        sensed_position=extreme(u.sensed_position, upper),
        probe_position=extreme(u.probe_position, upper),
        misalignment=extreme(u.misalignment, not upper),
        friction=extreme(u.friction, upper),
        film_ratio=extreme(u.film_ratio, upper),
    )
    pose = PoseBox(
        x=Interval.point(pre.x.mid),
        y=extreme(pre.y, not upper),
        theta=extreme(pre.theta, upper),
    )
    return pose, replace(setup, uncertainty=known)


def _heights(rule: MoveRule, pose: PoseBox, setup: Setup) -> tuple[Interval, Interval]:
    """Where the active and the passive tip are in y, in the world."""
    if rule.single is None:
        raise ValueError(f"a rotation needs a passive tip, got {rule}")
    sensed, off = setup.uncertainty.sensed_position, setup.uncertainty.probe_position
    active = rule.dual.y.place(pose.y, sensed, off) - HALF * setup.spacing
    return active, rule.single.y.place(pose.y, sensed, off)


def _too_short(rule: MoveRule, pose: PoseBox, setup: Setup) -> bool:
    """Both tips could hold the part at the end only at a lower angle than it started with."""
    edge, beta = setup.edge(pose.theta.mid), setup.uncertainty.misalignment
    active, passive = _heights(rule, pose, setup)
    behind = HALF * setup.spacing * sin(beta) / cos(beta)
    end = rule.dual_end.offset + behind  # the errors of both x are the same here
    if rule.single is not None:
        end = end - rule.single.x.offset
    box = {"theta": edge.angle(pose.theta), "V": active - passive, "d1": edge.depth}
    (h_start,) = enclose(condition("two_sided_rotation", "pair_position"), box)
    return end.lo > h_start.hi


def _runs_off(rule: MoveRule, pose: PoseBox, setup: Setup) -> bool:
    """A tip is beyond the end of its edge after the push.

    The push is followed on a longer part, which moves the same as long as both tips are on the real
    one. That the idle tip would touch the longer part does not matter.
    """
    longer = replace(setup.rectangle, half_length=setup.half_length * LONGER)
    edge = setup.edge(pose.theta.mid)
    for rough in (True, False):  # the latter takes twice as long and is needed near an end only
        step = certify_rotation(rule, pose, replace(setup, outline=longer), rough=rough)
        if step.post is None or not _enclosed(step):
            continue
        angle = edge.angle(step.post.theta)
        active, passive = (height - step.post.y for height in _heights(rule, pose, setup))
        # the far edge is the near one after half a turn of the part
        offsets = [sticking.contact_offset(angle, edge.depth, rise) for rise in (active, -passive)]
        if any(misses(offset, edge) for offset in offsets):
            return True
        if all(-edge.half.lo < offset.lo and offset.hi < edge.half.lo for offset in offsets):
            return False
    return False


def _enclosed(step: Step) -> bool:
    """Whether the motion of the two tips alone is proved to end in the box of the step."""
    return all(
        obligation.proof.verdict is Verdict.PROVED
        for obligation in step.obligations
        if obligation.name.id is not ObligationId.IDLE_TIP_PASSES
    )
