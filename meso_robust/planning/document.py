"""``plan.json``: the policy's rules, and its moves for the nominal run."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Sequence
from typing import Annotated, Literal

import numpy as np
import numpy.typing as npt
from pydantic import BaseModel, ConfigDict, Field, FiniteFloat

from meso_robust import units
from meso_robust.primitives.frame import Heading
from meso_robust.primitives.move import Action, Aim, MoveRule
from meso_robust.primitives.setup import PoseBox
from meso_robust.reading import Deg, PaperStep, Um
from meso_robust.task import Task

Floats = npt.NDArray[np.float64]
Commanded = Annotated[float, Field(json_schema_extra={"minimum": -1e6, "maximum": 1e6})]
"""um; ``reading`` keeps the limits, with an advice about the unit."""
Pair = tuple[Commanded, Commanded]
NAMES = ("dtp_top", "dtp_bottom", "stp")
"""Tips: the one on the right of the dual-tip probe, seen along the push, the one on the left, and the
single one. A name stays with its tip whether the axes of a move are mirrored or not."""


class _Model(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True, populate_by_name=True)


class AimDocument(_Model):
    """A commanded coordinate: ``offset_um`` from the sensed part or from the world's origin."""

    relative_to: Literal["sensed part", "world"]
    """What the offset is added to: the coordinate sensed before the move, or the world's zero."""
    offset_um: Commanded
    """The offset, um, along the axis that the key names."""


class RuleDocument(_Model):
    """A move as a function of the pose sensed before it."""

    step: PaperStep
    """Step of the paper's algorithm, 1 to 4, that the move belongs to."""
    primitive: str
    """The primitive: y_translation, rotation or x_translation."""
    action: Action
    """Which certified motion the move is."""
    side: Annotated[int, Field(json_schema_extra={"minimum": -1, "maximum": 1})]
    """Of a tilt or a rotation: 1 turns the part counter-clockwise in these axes, -1 clockwise; else 0."""
    dual_x: AimDocument
    """x of the middle of the two active tips at the start; the push goes along -x of the axes of `heading`."""
    dual_y: AimDocument
    """y of that middle."""
    dual_end_x: AimDocument
    """x of that middle at the end of the travel."""
    single_x: AimDocument | None = None
    """x of the passive tip; null if the move has none."""
    single_y: AimDocument | None = None
    """y of the passive tip; null if the move has none."""
    heading: Heading = "-x"
    """Where the push goes; the offsets are along and across it, in axes turned by as much."""
    mirrored: bool = False
    """Whether the y axis of these axes is mirrored."""


class ProbeDocument(_Model):
    """A probe of a move; an active one travels and is lifted out of the plane afterwards."""

    name: str
    """The tip: of the dual-tip probe dtp_top is the one on the right and dtp_bottom the one on the left,
    seen along the push, stp is the single one. So dtp_top has the larger y of the two in a push along
    -x, the smaller y along +x, the smaller x along -y and the larger x along +y."""
    start_um: Pair
    """[x, y] of the tip before the move, free of contact, um, world frame."""
    passive: bool = False
    """Whether the tip rests while the others travel."""


class BoxDocument(_Model):
    """A box of poses."""

    x_um: tuple[Um, Um]
    """[low, high] of the reference point's x, um."""
    y_um: tuple[Um, Um]
    """[low, high] of the reference point's y, um."""
    theta_deg: tuple[Deg, Deg]
    """[low, high] of the orientation, deg."""


class MoveDocument(_Model):
    """What the hardware does."""

    step: PaperStep
    """Step of the paper's algorithm, 1 to 4, that the move belongs to."""
    primitive: str
    """The primitive: y_translation, rotation or x_translation."""
    probes: tuple[ProbeDocument, ...]
    """Every tip in the plane."""
    travel_um: Pair
    """[x, y] by which every active tip travels, um, world frame."""
    speed_um_s: Annotated[FiniteFloat, Field(ge=0, le=1e6)]
    """Speed of the travel, um/s."""
    expect: BoxDocument | None
    """Certified box of the part's pose after the move, rounded outward; null if not certified."""


class PlanDocument(_Model):
    """A quasi-open-loop plan."""

    schema_: Annotated[Literal["meso-robust/plan/1"], Field(alias="schema")] = "meso-robust/plan/1"
    """Name and version of the format."""
    task: str
    """Name of the task."""
    task_hash: str
    """SHA-256 of the task's values, independent of the layout of its file."""
    policy: tuple[RuleDocument, ...]
    """The plan itself: before each move sense the pose, then command the probes as stated."""
    moves: tuple[MoveDocument, ...]
    """The same moves for the nominal run, in which every error is zero."""

    @property
    def hash(self) -> str:
        """SHA-256 of the plan's values, independent of the layout of its file."""
        text = json.dumps(self.model_dump(mode="json", by_alias=True), sort_keys=True)
        return hashlib.sha256(text.encode()).hexdigest()


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
    """Names of a move's tips in the order of ``MoveRule.commands``: upper, lower, passive."""
    right, left, single = NAMES
    pair = (left, right) if rule.frame.mirrored else (right, left)
    return pair if rule.single is None else (*pair, single)


def _um(point: Floats) -> Pair:
    x, y = (round(float(value) / units.UM, 4) + 0.0 for value in point)
    return x, y


def box_document(box: PoseBox) -> BoxDocument:
    """A box in um and deg, rounded outward to a thousandth."""
    return BoxDocument(
        x_um=_outward(units.to_um(box.x.lo), units.to_um(box.x.hi)),
        y_um=_outward(units.to_um(box.y.lo), units.to_um(box.y.hi)),
        theta_deg=_outward(units.to_deg(box.theta.lo), units.to_deg(box.theta.hi)),
    )


def goal_document(box: PoseBox) -> BoxDocument:
    """A goal in um and deg, rounded to a thousandth for reading."""
    return BoxDocument(
        x_um=_inward(units.to_um(box.x.lo), units.to_um(box.x.hi)),
        y_um=_inward(units.to_um(box.y.lo), units.to_um(box.y.hi)),
        theta_deg=_inward(units.to_deg(box.theta.lo), units.to_deg(box.theta.hi)),
    )


def _inward(low: float, high: float) -> Pair:
    return float(np.ceil(low * 1e3 - 1e-6) / 1e3), float(np.floor(high * 1e3 + 1e-6) / 1e3)


def _outward(low: float, high: float) -> Pair:
    return float(np.floor(low * 1e3 - 1e-6) / 1e3), float(np.ceil(high * 1e3 + 1e-6) / 1e3)
