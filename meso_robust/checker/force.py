"""No contact force exceeds what a task allows, if it says so.

The drag of a part that moves at ``v`` at its centre of drag is ``E v``, with ``E`` symmetric and its
largest eigenvalue ``1 + hypot(stretch, shear)`` times the mean drag. The power of the one force f of a tip
that sticks and moves at ``u`` is all that the film takes, ``f u >= v E v``, and ``|f|^2 = |E v|^2`` is at
most the eigenvalue times ``v E v``: so ``|f|`` is at most the eigenvalue times ``|u|``. Two tips on one edge
that carry the part along share the normal part of ``E u``; each has friction of at most mu times its
own normal force. What two tips on opposite edges press is bounded along the motion (``rotate.py``).
"""

from __future__ import annotations

from flint import arb

from meso_robust.checker import statement as st
from meso_robust.checker.ids import Must, named
from meso_robust.checker.inputs import Given
from meso_robust.checker.passage import Passage
from meso_robust.checker.ranges import Box, Side
from meso_robust.checker.refusal import Refused
from meso_robust.checker.requirement import Requirement
from meso_robust.checker.scene import Scene

PUSHES = ("tilt", "straighten")
"""The moves that push from one side."""


def force_below_cap(scene: Scene, given: Given, passage: Passage) -> tuple[Requirement, ...]:
    """Prove that no tip exceeds the largest force; nothing if nothing is asked or touched.

    Raises
    ------
    Refused
        It does not follow.
    """
    if given.largest_force is None or given.drag is None or scene.rule.action == "regrasp":
        return ()
    if passage.slips:
        raise Refused(named(Must.FORCE_BELOW_CAP), "proved", "not of a tip that may slip")
    if passage.largest_force is not None:
        force = passage.largest_force() * (_largest(scene.box["scale"]) + 1)
    elif scene.rule.action in PUSHES:
        force = _most(scene)
    else:
        raise Refused(named(Must.FORCE_BELOW_CAP), "proved", f"not of a {scene.rule.action}")
    if scene.rule.action != "tilt":
        force *= (1 + given.friction[1] * given.friction[1]).sqrt()
    force *= 1 + _largest(scene.box["bend"])  # faster, where a tip strays along its line
    return capped(given.drag * given.speed * force, given.largest_force)


def capped(force: arb, cap: arb) -> tuple[Requirement, ...]:
    """The requirement that a bound of all contact forces, N, is below the cap.

    Raises
    ------
    Refused
        It is not.
    """
    must = named(Must.FORCE_BELOW_CAP)
    if not force < cap:
        raise Refused(must, f"less than {float(cap):.4g} N", f"up to {float(force):.4g} N")

    def verify(box: Box, bound: arb) -> bool:
        if set(box) != {"force"}:
            raise Refused(must.value("over"), sorted(box), ["force"])
        most = box["force"][1]
        return bool(most >= force and cap - most >= bound)

    return (Requirement(name=must, statement=st.FORCE, parts=(), verify=verify),)


def _most(scene: Scene) -> arb:
    """Largest force of a tip over mean drag and commanded speed."""
    stretch, shear, bend, scale = (
        _largest(scene.box[name]) for name in ("stretch_now", "shear_now", "bend_now", "scale")
    )
    uneven = (stretch * stretch + shear * shear).sqrt() + 1
    return uneven * (scale + 1) * (bend * bend + 1).sqrt()


def _largest(side: Side) -> arb:
    return abs(side[0]).max(abs(side[1])).upper()
