"""A straightening (t^2): one tip sticks until the other touches, then the part moves with both.

Once both touch, the line through them keeps its direction ``pi/2 + beta`` and so does the edge.
Nothing but the translation can follow: a motion that both tips keep in contact does not turn and
differs from it by a slide along the edge only, against which the friction of both tips together
stands; one that leaves a tip is a motion of the other tip alone, which sticks and turns the part
back onto the tip that it left; with no tip in contact the part rests in the way of both.
"""

from __future__ import annotations

import dataclasses
import functools

from flint import arb

from meso_robust.checker import statement as st
from meso_robust.checker.contact import Contact, Turning
from meso_robust.checker.dual import Dual, Point
from meso_robust.checker.ids import Must, Property, named
from meso_robust.checker.inputs import PoseBox
from meso_robust.checker.passage import Memory, Passage, Pose, Sweep
from meso_robust.checker.pushing import (
    NAMES,
    UNIT,
    comes_free,
    constant,
    free_at_start,
    on_edge,
    sticks,
    touch,
)
from meso_robust.checker.ranges import Box, Side, common, hull, shift, span
from meso_robust.checker.requirement import Part, Requirement, Variables, prove
from meso_robust.checker.scene import Scene, direction


def check_straighten(scene: Scene, memory: Memory | None = None) -> Passage:
    """Prove a straightening from every pose of its scene.

    Parameters
    ----------
    scene
        The move.
    memory
        The tilt just before, if any, in the same axes.

    Raises
    ------
    Refused
        A requirement does not follow.
    """
    requirements = [
        *free_at_start(scene, (1, -1)),
        comes_free("pair", _aligned, scene.box),
    ]
    cases = [_Case(scene, side, box) for side, box in _first_contacts(scene)]
    for case in cases:
        requirements += case.requirements()
    for requirement in requirements:
        prove(requirement)
    theta = scene.box["beta"]
    right = arb.pi() / 2
    return Passage(
        does=named(Property.STRAIGHTENS),
        post=PoseBox(
            x=functools.reduce(hull, (span(case.x_end, case.box) for case in cases)),
            y=functools.reduce(hull, (case.height(memory) for case in cases)),
            theta=shift(shift(theta, right), scene.turn),
        ),
        requirements=tuple(requirements),
        swept=tuple(sweep for case in cases for sweep in case.swept(exact=len(cases) == 1)),
    )


def _aligned(at: Point) -> Dual:
    """Direction of the edge while both tips touch."""
    return at["beta"] + arb.pi() / 2


def _first_contacts(scene: Scene) -> list[tuple[int, Box]]:
    """Which tip can touch first (the upper one turns the part counter-clockwise), and from where.

    The second tip stands off the line of the edge as long as the first has not turned it all the
    way: its distance is ``spacing cos(theta - beta)/cos(beta)``, positive below ``pi/2 + beta``.
    """
    box, right = scene.box, arb.pi() / 2
    (low, high), beta = box["theta"], box["beta"]
    first, last = beta[0] + right, beta[1] + right
    cases: list[tuple[int, Box]] = []
    if not low > last:
        cases.append((1, {**box, "theta": (low, high.min(last))}))
    if not high < first:
        cases.append((-1, {**box, "theta": (low.max(first), high)}))
    return cases


@dataclasses.dataclass(frozen=True, slots=True)
class _Case:
    """The tip on ``side`` touches first."""

    scene: Scene
    side: int
    box: Box

    def first(self, at: Point) -> Contact:
        return touch(self.scene, at, self.side)

    def end(self, at: Point) -> Contact:
        """The first contact when the other tip touches."""
        c, s = direction(at["beta"])
        return Contact(-s, c, self.scene.d1, self.first(at).d2)

    def other(self, at: Point) -> Dual:
        """``d2`` of the tip that touches second."""
        c, _ = direction(at["beta"])
        return self.first(at).d2 - self.scene.spacing * self.side / c

    def travel(self, at: Point) -> Dual:
        """Travel in contact."""
        return self.first(at).arm_x - self.scene.ahead_end(at, self.side)

    def x_end(self, at: Point) -> Dual:
        return at["x"] + self.scene.ahead_end(at, self.side) - self.end(at).arm_x

    def turning(self, at: Point) -> Pose:
        """The part when a share of the first tip's turn is done."""
        first, scene = self.first(at), self.scene
        angle = at["theta"] + at["share"] * (_aligned(at) - at["theta"])
        now = Contact(*direction(angle), scene.d1, first.d2)
        ahead = first.arm_x - Turning(first, self.side).needed(now, at["rho"])
        y = at["y"] + scene.rise(at, self.side) - now.arm_y
        return at["x"] + ahead - now.arm_x, y, angle

    def together(self, at: Point) -> Pose:
        """The part when a share of the travel of both tips is still to come."""
        alone = Turning(self.first(at), self.side).needed(self.end(at), at["rho"])
        left = (self.travel(at) - alone) * at["share"]
        return self.x_end(at) + left, self.y_end(at), _aligned(at)

    def swept(self, *, exact: bool) -> tuple[Sweep, Sweep]:
        """All poses while the first tip is alone, and while both push."""
        box = {**self.box, "share": UNIT}
        return (
            Sweep(self.turning, box, "share", exact=exact),
            Sweep(self.together, box, "share", exact=exact),
        )

    def height(self, memory: Memory | None) -> Side:
        """Where y of the part is at the end."""
        plain = span(self.y_end, self.box)
        if memory is None or not memory.about(self.scene):
            return plain
        return common(plain, span(functools.partial(self.y_after, memory), self.joint(memory)))

    def y_end(self, at: Point) -> Dual:
        return at["y"] + self.scene.rise(at, self.side) - self.end(at).arm_y

    def y_after(self, memory: Memory, at: Point) -> Dual:
        """The same, from the tilt's own start: its height before follows from the angle."""
        c, s = direction(at["theta"])
        earlier = {key.removeprefix("tilt "): at[key] for key in at if key.startswith("tilt ")}
        before = {"beta": at["beta"], "rho": at["rho"], "mu": at["mu"], **earlier}
        return self.y_end({**at, "y": memory.height(before, c, s)})

    def joint(self, memory: Memory) -> Box:
        """The variables of both moves; what is constant during a run is shared."""
        own = {f"tilt {n}": s for n, s in memory.scene.box.items() if n not in _LASTING}
        return {**self.box, **own}

    def requirements(self) -> list[Requirement]:
        scene, side, box = self.scene, self.side, self.box
        first, second = NAMES[side], NAMES[-side]

        def path(at: Point) -> Dual:
            return at["theta"] + at["share"] * (_aligned(at) - at["theta"])

        def start(at: Point) -> Dual:
            return at["theta"]

        def offset(at: Point) -> Dual:
            return self.first(at).d2

        pair: Variables = {
            "beta": lambda at: at["beta"],
            "d1": constant(scene.d1),
            "d2": offset if side > 0 else self.other,
            "d4": constant(scene.spacing),
        }
        turn: Variables = {
            "travel": self.travel,
            "theta_start": lambda at: at["theta"],
            "theta_end": _aligned,
            "d1": constant(scene.d1),
            "d2": offset,
            "rho": lambda at: at["rho"],
            "side": constant(arb(side)),
        }
        ends = tuple(
            Part({"travel": self.travel, "theta": angle, "d2": offset}, box)
            for angle in (start, _aligned)
        )
        return [
            on_edge(first, scene, offset, box),
            *sticks(first, scene, path, offset, side, {**box, "share": UNIT}, (start, _aligned)),
            on_edge(second, scene, self.other, box),
            Requirement(
                name=named(Must.PAIR_STICKS),
                statement=st.PAIR_STICKS,
                parts=(Part({"beta": lambda at: at["beta"], "mu": lambda at: at["mu"]}, box),),
            ),
            Requirement(
                name=named(Must.PAIR_PUSHES),
                statement=st.PAIR_PRESSES,
                parts=(Part(pair, box),),
            ),
            *sticks(second, scene, _aligned, self.other, -side, box),
            Requirement(
                name=named(Must.SECOND_TIP_TOUCHES),
                statement=st.ARRIVES,
                parts=(Part(turn, box),),
                cover=ends,
                stated_box=self.longest,
            ),
        ]

    def longest(self, stated: Box) -> Box:
        """The stated box of the arrival: the turn goes through all of its angles."""
        low, high = stated["theta"]
        start, end = (low, high) if self.side > 0 else (high, low)
        d1, side = self.scene.d1, arb(self.side)
        return {
            "travel": stated["travel"],
            "theta_start": (start, start),
            "theta_end": (end, end),
            "d1": (d1, d1),
            "d2": stated["d2"],
            "rho": self.box["rho"],
            "side": (side, side),
        }


_LASTING = ("beta", "rho", "mu")
