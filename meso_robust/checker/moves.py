"""Which file verifies which move."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from meso_robust.checker.document import RuleDocument
from meso_robust.checker.force import force_below_cap
from meso_robust.checker.guide import check_guide
from meso_robust.checker.ids import Objection, named
from meso_robust.checker.inputs import Given, PoseBox
from meso_robust.checker.passage import Memory, Passage
from meso_robust.checker.refusal import Refused
from meso_robust.checker.regrasp import check_regrasp
from meso_robust.checker.rotate import check_rotate
from meso_robust.checker.scene import Scene, scene_of
from meso_robust.checker.straighten import check_straighten
from meso_robust.checker.tilt import check_tilt
from meso_robust.checker.walls import clear_of_walls

Check = Callable[[Scene, Given, Memory | None], Passage]
MOVES: dict[str, Check] = {
    "tilt": lambda scene, given, memory: check_tilt(scene),
    "straighten": lambda scene, given, memory: check_straighten(scene, memory),
    "rotate": lambda scene, given, memory: check_rotate(scene),
    "guide": lambda scene, given, memory: check_guide(scene, given),
    "regrasp": lambda scene, given, memory: check_regrasp(scene),
}


def verify_move(
    rule: RuleDocument, pre: PoseBox, given: Given, memory: Memory | None
) -> tuple[Scene, Passage]:
    """Prove what a move does from every pose in ``pre`` (world axes).

    Parameters
    ----------
    rule, pre, given
        The move, the poses before it, the task.
    memory
        What the move before left behind.

    Raises
    ------
    Refused
        A requirement does not follow, or the kind of move is not known.
    """
    check_rule(rule)
    scene = scene_of(rule, pre, given)
    passage = verify_scene(scene, given, memory)
    more = (*force_below_cap(scene, given, passage), *clear_of_walls(scene, passage, given))
    return scene, replace(passage, requirements=(*passage.requirements, *more))


def verify_scene(scene: Scene, given: Given, memory: Memory | None) -> Passage:
    """The same of a move whose variables are given, walls left aside."""
    return MOVES[scene.rule.action](scene, given, memory)


def check_rule(rule: RuleDocument) -> None:
    """What a rule must and must not hold, so that nothing of it goes unused.

    Raises
    ------
    Refused
        It does not, or the kind of move is not known.
    """
    if rule.action not in MOVES:
        raise Refused(named(Objection.MOVE_KNOWN), rule.action, sorted(MOVES))
    turns = rule.action in {"tilt", "rotate"}
    if turns != (rule.side != 0):
        raise Refused(
            named(Objection.SIDE_OF_MOVE, action=rule.action), rule.side, "1 or -1" if turns else 0
        )
    passive = [part is not None for part in (rule.single_x, rule.single_y)]
    if passive != [rule.action == "rotate"] * 2:
        needed = "given" if rule.action == "rotate" else "null"
        raise Refused(named(Objection.PASSIVE_TIP, action=rule.action), passive, needed)
