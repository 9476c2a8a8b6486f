"""Which primitives an open-loop plan is made of, so that someone else's moves can be certified."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from fractions import Fraction

from meso_robust.bounds import Verdict
from meso_robust.errors import NotApplicableError
from meso_robust.planning.document import MoveDocument, PlanDocument, ProbeDocument
from meso_robust.primitives.certify import certify_move
from meso_robust.primitives.frame import Frame, Heading
from meso_robust.primitives.move import Action, Aim, Anchor, MoveRule, Point
from meso_robust.primitives.obligation import Step
from meso_robust.primitives.setup import PoseBox, Setup
from meso_robust.task import Task

Spot = tuple[Fraction, Fraction]

KINDS: tuple[tuple[Action, int], ...] = (
    ("straighten", 0),
    ("tilt", 1),
    ("tilt", -1),
    ("regrasp", 0),
)


def inferred(plan: PlanDocument, task: Task, setup: Setup) -> tuple[MoveRule, ...]:
    """Rules that command exactly the moves of an open-loop plan.

    Parameters
    ----------
    plan, task, setup
        A plan without a policy, and its task.

    Returns
    -------
    tuple
        A rule a move: of the motions that it can be, the first one that is proved from all poses before
        it, and the first one at all if none is.

    Raises
    ------
    NotApplicableError
        A move is not made by a dual-tip probe of the task along an axis, with at most one passive tip.
    """
    state: PoseBox | None = setup.start
    step: Step | None = None
    rules: list[MoveRule] = []
    for k, move in enumerate(plan.moves):
        candidates = list(_candidates(move, k, task))
        if state is None:
            rules.append(candidates[0])
            continue
        tried = [certify_move(rule, state, setup, step) for rule in candidates]
        step = next((one for one in tried if one.verdict is Verdict.PROVED), tried[0])
        rules.append(step.rule)
        state = step.post
    return tuple(rules)


def _candidates(move: MoveDocument, k: int, task: Task) -> Iterator[MoveRule]:
    """All rules that command this very move."""
    heading = _heading(move, k)
    stated = task.probe.headings
    if stated is not None and heading not in stated:
        raise NotApplicableError(
            f"move {k + 1} pushes along {heading}, but the task's probes push along "
            f"{', '.join(stated)} only (probe.headings)"
        )
    for mirrored in (False, True):
        frame = Frame(heading=heading, mirrored=mirrored)
        rule = _placed(move, k, task, frame)
        if rule.single is not None:
            yield replace(rule, action="rotate", side=1)
        elif not mirrored:
            yield from (replace(rule, action=action, side=side) for action, side in KINDS)


def _heading(move: MoveDocument, k: int) -> Heading:
    x, y = move.travel_um
    found: dict[tuple[bool, bool], Heading] = {
        (x < 0, y == 0): "-x",
        (x > 0, y == 0): "+x",
        (y < 0, x == 0): "-y",
        (y > 0, x == 0): "+y",
    }
    heading = found.get((True, True))
    if heading is None:
        raise NotApplicableError(
            f"move {k + 1} travels by {[x, y]} um: no primitive pushes other than along an axis"
        )
    return heading


def _placed(move: MoveDocument, k: int, task: Task, frame: Frame) -> MoveRule:
    """The move in ``frame``, of no particular kind yet."""
    pair = [_own(probe, frame) for probe in move.probes if not probe.passive]
    passive = [_own(probe, frame) for probe in move.probes if probe.passive]
    spacing = Fraction(repr(task.probe.tip_spacing_um))
    across = sorted(spot[1] for spot in pair)
    if len(pair) != 2 or pair[0][0] != pair[1][0] or across[1] - across[0] != spacing:
        raise NotApplicableError(
            f"move {k + 1}: its active probes are not the two tips of the task's dual-tip probe, "
            f"side by side across the push, {task.probe.tip_spacing_um} um apart"
        )
    if len(passive) > 1:
        raise NotApplicableError(f"move {k + 1} has {len(passive)} passive probes; at most one")
    x, y = (Fraction(repr(part)) for part in move.travel_um)
    start, travel = pair[0][0], abs(x) + abs(y)
    return MoveRule(
        step=move.step,
        primitive=move.primitive,
        action="straighten",
        side=0,
        dual=Point(x=_aim(start, k), y=_aim((across[0] + across[1]) / 2, k)),
        dual_end=_aim(start - travel, k),
        single=Point(x=_aim(passive[0][0], k), y=_aim(passive[0][1], k)) if passive else None,
        frame=frame,
    )


def _own(probe: ProbeDocument, frame: Frame) -> Spot:
    """Where a probe starts in the axes of a frame, um, exactly as written."""
    x, y = (Fraction(repr(value)) for value in probe.start_um)
    (a, b), (c, d) = frame.matrix.T.astype(int).tolist()
    return a * x + b * y, c * x + d * y


def _aim(value: Fraction, k: int) -> Aim:
    """A coordinate in the world that is written to the plan exactly."""
    offset = round(float(value), 9)
    if Fraction(repr(offset)) != value:
        raise NotApplicableError(
            f"move {k + 1}: the middle of its pair at {float(value)} um has too many digits to be "
            "certified as written; round positions to 0.001 um"
        )
    return Aim(anchor=Anchor.WORLD, offset_um=offset)
