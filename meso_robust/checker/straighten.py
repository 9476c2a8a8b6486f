"""A straightening (t^2): one tip turns the part until the other touches, then it moves with both.

The first tip sticks, or it slips a little (``slip.py``): then how far is one more variable. Once both touch, the line through them keeps its direction ``pi/2 + beta`` and so does the edge.
Nothing but the translation can follow: a motion that both tips keep in contact does not turn and
differs from it by a slide along the edge only, against which the friction of both tips together
stands (``statement.py``); one that leaves a tip is a motion of the other tip alone, which turns the
part back onto the tip that it left, for any friction at all or because it sticks; with no tip in
contact the part rests in the way of both.
"""

from __future__ import annotations

import dataclasses
import functools
from collections.abc import Sequence

from flint import arb

from meso_robust.checker import statement as st
from meso_robust.checker.contact import Contact, Turning
from meso_robust.checker.dual import Dual, Point
from meso_robust.checker.film import EVEN
from meso_robust.checker.ids import Must, Property, named
from meso_robust.checker.inputs import PoseBox
from meso_robust.checker.passage import Known, Memory, Passage, Pose, Sweep
from meso_robust.checker.pushing import (
    NEAR,
    TURNS,
    UNIT,
    comes_free,
    constant,
    free_at_start,
    on_edge,
    sticks,
    touch,
    turning,
    turns_back,
)
from meso_robust.checker.ranges import Box, Formula, Side, common, hull, shift, span
from meso_robust.checker.refusal import Refused
from meso_robust.checker.requirement import Part, Requirement, Variables, holds, prove
from meso_robust.checker.scene import NAMES, Scene, direction, negative
from meso_robust.checker.slip import SLIPPED, Slip, slip_of, slipped, spare


def check_straighten(scene: Scene, memory: Memory | None = None) -> Passage:
    """Prove a straightening from every pose of its scene.

    Parameters
    ----------
    scene
        The move.
    memory
        What the move just before, if any, leaves known.

    Raises
    ------
    Refused
        A requirement does not follow.
    """
    requirements = [
        *free_at_start(scene, (1, -1)),
        comes_free("pair", functools.partial(_aligned, scene), scene, scene.box),
    ]
    _prove(requirements)
    cases = []
    for side, box in _first_contacts(scene):
        case, more = _proved(_Case(scene, side, box))
        cases.append(case)
        requirements += more
    theta = span(functools.partial(_aligned_as_stated, scene), scene.box)
    known = None if memory is None else memory(scene)
    return Passage(
        does=named(Property.STRAIGHTENS),
        post=PoseBox(
            x=functools.reduce(hull, (span(case.x_end, case.box, within=NEAR) for case in cases)),
            y=functools.reduce(hull, (case.height(known) for case in cases)),
            theta=shift(theta, scene.turn),
        ),
        requirements=tuple(requirements),
        memory=functools.partial(_known, cases),
        swept=tuple(sweep for case in cases for sweep in case.swept(exact=len(cases) == 1)),
        slips=any(case.slip is not None for case in cases),
    )


def _prove(requirements: list[Requirement]) -> None:
    for requirement in requirements:
        prove(requirement)


def _proved(case: _Case) -> tuple[_Case, list[Requirement]]:
    """A case whose first tip sticks or, where that does not follow, slips little.

    Raises
    ------
    Refused
        Neither follows; said is what a tip that sticks lacks.
    """
    try:
        requirements = case.requirements()
        _prove(requirements)
    except Refused:
        if case.scene.equal_tips:
            raise
        aligned = functools.partial(_aligned, case.scene)
        slip = slip_of(case.scene, case.side, case.box, aligned, case.place_at)
        if slip is None:
            raise
        case = dataclasses.replace(case, box=slip.box, slip=slip)
        requirements = case.requirements()
        _prove(requirements)
    return case, requirements


def _known(cases: Sequence[_Case], scene: Scene) -> Known | None:
    """What these cases of a straightening tell of y before a move across it.

    The radii of the tips decide both where it leaves the part and at which orientation. The part that
    then turns about a contact on an edge keeps ``y + d1 theta``, but for terms of second order: of that
    a narrower range is known than y and theta have.
    """
    earlier, frame = cases[0].scene.frame, scene.frame
    quarters = earlier.quarters - frame.quarters
    if quarters % 2 == 0:
        return None
    mirrored, sign = (-1 if one else 1 for one in (frame.mirrored, earlier.mirrored))
    to_y = mirrored if quarters % 4 == 1 else -mirrored
    lever = -scene.d1 * to_y * mirrored * sign
    ranges = (span(functools.partial(c.less_lever, lever), c.box, within=NEAR) for c in cases)
    low, high = functools.reduce(hull, ranges)
    across = (low, high) if to_y > 0 else negative((low, high))
    turned = arb.pi() / 2 * (quarters * mirrored)
    return Known(
        box={"across": shift(across, scene.d1 * turned)},
        height=lambda at: at["across"] - (at["theta"] + scene.turn) * scene.d1,
    )


def _aligned(scene: Scene, at: Point) -> Dual:
    """Direction of the edge while both tips touch, from the axes of the travel."""
    return scene.aligned(at) + arb.pi() / 2


def _aligned_as_stated(scene: Scene, at: Point) -> Dual:
    return scene.stated(at, _aligned(scene, at))


def _first_contacts(scene: Scene) -> list[tuple[int, Box]]:
    """Which tip can touch first (the upper one turns the part counter-clockwise), and from where.

    The second tip stands off the line of the edge as long as the first has not turned it all the
    way: its distance is ``spacing cos(theta - beta)/cos(beta)``, positive below ``pi/2 + beta``; radii
    that differ add the same to both angles.
    """
    box = scene.box
    low, high = box["theta"]
    first, last = span(functools.partial(_aligned_as_stated, scene), box)
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
    slip: Slip | None = None
    """How far it may slip; None: it sticks."""

    def first(self, at: Point) -> Contact:
        return touch(self.scene, at, self.side)

    def turn(self, at: Point) -> Turning:
        """The turn about the first tip."""
        return turning(self.scene, at, self.side, self.side)

    def end(self, at: Point) -> Contact:
        """The first contact when the other tip touches."""
        c, s = direction(self.scene.aligned(at))
        place = self.place_at(at, _aligned(self.scene, at), at.get(SLIPPED))
        return dataclasses.replace(self.first(at), c=-s, s=c, d2=place)

    def place_at(self, at: Point, angle: Dual, creep: Dual | None) -> Dual:
        """``d2`` of the first contact, which rolls and may slip, when the edge has come to ``angle``."""
        first, start = self.first(at), self.scene.angle(at)
        place = first.d2
        if first.radius is not EVEN:
            place = place - (angle - start) * first.radius
        return place if creep is None else place - slipped(creep, start, angle)

    def other(self, at: Point) -> Dual:
        """``d2`` of the tip that touches second."""
        return self.end(at).d2 - self.scene.gap(at) * self.side

    def travel(self, at: Point) -> Dual:
        """Travel in contact."""
        return self.first(at).arm_x - self.scene.ahead_end(at, self.side)

    def place(self, at: Point) -> tuple[Dual, Dual]:
        """Where the part is at the end, x and y from where it was, axes of the travel."""
        end, scene = self.end(at), self.scene
        x = scene.ahead_end(at, self.side) - end.arm_x
        return x, scene.rise_end(at, self.side) - end.arm_y

    def x_end(self, at: Point) -> Dual:
        return at["x"] + self.scene.from_travel(at, *self.place(at))[0]

    def y_end(self, at: Point) -> Dual:
        return at["y"] + self.scene.from_travel(at, *self.place(at))[1]

    def path(self, at: Point) -> Dual:
        """Direction of the edge when a share of the first tip's turn is done."""
        first = self.scene.angle(at)
        return first + at["share"] * (_aligned(self.scene, at) - first)

    def offset(self, at: Point) -> Dual:
        """``d2`` of the first tip then."""
        if not (self.first_rolls or self.slip):
            return self.first(at).d2
        return self.place_at(at, self.path(at), at.get(SLIPPED))

    def turning(self, at: Point) -> Pose:
        """The part when a share of the first tip's turn is done."""
        if self.slip is not None:
            return self.slipping(at)
        first, scene, turn = self.first(at), self.scene, self.turn(at)
        turned = self.path(at) - turn.angle
        now = turn.contact(turned)
        ahead = first.arm_x - turn.needed(turned)
        x, y = scene.from_travel(at, ahead - now.arm_x, scene.rise_end(at, self.side) - now.arm_y)
        return at["x"] + x, at["y"] + y, at["theta"] + turned

    def slipping(self, at: Point) -> Pose:
        """The same of a tip that may slip: it can be anywhere on its way in contact then."""
        scene, angle = self.scene, self.path(at)
        s, c = angle.sin_cos()
        now = dataclasses.replace(self.first(at), c=c, s=s, d2=self.offset(at))
        ahead = scene.ahead_end(at, self.side) + self.way(at) * (1 - at["progress"])
        x, y = scene.from_travel(at, ahead - now.arm_x, scene.rise_end(at, self.side) - now.arm_y)
        return at["x"] + x, at["y"] + y, at["theta"] + angle - scene.angle(at)

    def way(self, at: Point) -> Dual:
        """How far ahead of its end a tip in contact can be at most that strays as it does now."""
        strayed = (at[f"wander_{axis}_now"] - at[f"wander_{axis}"] for axis in "xy")
        return self.travel(at) + self.scene.in_travel(at, *strayed)[0]

    def together(self, at: Point) -> Pose:
        """The part when a share of the travel of both tips is still to come, all of it at most if one slipped."""
        scene = self.scene
        if self.slip is None:
            turn = self.turn(at)
            left = self.travel(at) - turn.needed(_aligned(scene, at) - turn.angle)
        else:
            left = self.way(at)
        x, y = self.place(at)
        x, y = scene.from_travel(at, x + left * at["share"], y)
        return at["x"] + x, at["y"] + y, _aligned_as_stated(scene, at)

    def swept(self, *, exact: bool) -> tuple[Sweep, Sweep]:
        """All poses while the first tip is alone, and while both push."""
        box, exact = {**self.box, "share": UNIT}, exact and self.slip is None
        turning = box if self.slip is None else {**box, "progress": UNIT}
        return (
            Sweep(self.turning, turning, "share", exact=exact),
            Sweep(self.together, box, "share", exact=exact),
        )

    def height(self, known: Known | None) -> Side:
        """Where y of the part is at the end."""
        plain = span(self.y_end, self.box, within=NEAR)
        if known is None:
            return plain
        both = {**self.box, **known.box}
        return common(plain, span(functools.partial(self.y_after, known), both, within=NEAR))

    def y_after(self, known: Known, at: Point) -> Dual:
        """The same, where y before follows from what is known of the move before."""
        return self.y_end({**at, "y": known.height(at)})

    def less_lever(self, lever: arb, at: Point) -> Dual:
        """Where x of the part is at the end, less ``lever`` times its orientation."""
        return self.x_end(at) - (_aligned_as_stated(self.scene, at) + self.scene.turn) * lever

    def requirements(self) -> list[Requirement]:
        scene, side, box = self.scene, self.side, self.box
        first, second = NAMES[side], NAMES[-side]

        aligned = functools.partial(_aligned, scene)
        turn: Variables = {
            "travel": self.travel,
            "theta_start": scene.angle,
            "theta_end": aligned,
            "d1": lambda at: at["depth"],
            "d2": lambda at: self.first(at).d2,
            "side": constant(arb(side)),
            **scene.film_variables(),
        }
        if self.first_rolls:
            turn = {**turn, "radius": lambda at: at[f"radius_{first}"]}
        ends = tuple(
            Part({"travel": self.travel, "theta": angle, "d2": turn["d2"]}, box)
            for angle in (scene.angle, aligned)
        )
        turned = {**box, "share": UNIT}
        alone: Sequence[Requirement] = (
            sticks(first, scene, self.path, self.offset, side, side, turned, (scene.angle, aligned))
            if self.slip is None
            else self.slip.requirements
        )
        arrives = Requirement(
            name=named(Must.SECOND_TIP_TOUCHES),
            statement=st.ARRIVES,
            parts=(Part(turn, box),),
            cover=ends,
            stated_box=self.longest,
        )
        if self.slip is not None:
            left = functools.partial(spare, scene, side, aligned, self.place_at, self.travel)
            arrives = dataclasses.replace(
                arrives,
                statement=st.ARRIVES_SLIPPING,
                parts=(Part({"spare": left}, box),),
                cover=None,
                stated_box=None,
            )
        moves = self.first_rolls or self.slip is not None
        return [
            on_edge(first, scene, self.offset, turned if moves else box),
            *alone,
            on_edge(second, scene, self.other, box),
            *self.requirements_of_pair(),
            *self.second_alone(second, aligned),
            arrives,
        ]

    def requirements_of_pair(self) -> list[Requirement]:
        """Both tips press and hold the part while they carry it."""
        scene, box = self.scene, self.box
        film = scene.film_variables("_now")
        uneven = {name: of for name, of in film.items() if name != "rho"}
        sticking: Variables = {"beta": scene.aligned, "mu": lambda at: at[scene.mu(1)], **uneven}
        if scene.mu(1) != scene.mu(-1):
            sticking = {**sticking, "mu_other": lambda at: at[scene.mu(-1)]}
        pressing: Variables = {
            "beta": scene.aligned,
            "d1": lambda at: at["depth"],
            "d2": self.at_end if self.side > 0 else self.other,
            **uneven,
        }
        if scene.plain:
            pressing = {**pressing, "d4": lambda at: at["spacing"]}
        else:
            pressing = {**pressing, "gap": scene.gap}
        return [
            Requirement(
                name=named(Must.PAIR_STICKS),
                statement=st.PAIR_STICKS,
                parts=(Part(sticking, box),),
            ),
            Requirement(
                name=named(Must.PAIR_PUSHES),
                statement=st.PAIR_PRESSES,
                parts=(Part(pressing, box),),
            ),
        ]

    def second_alone(self, which: str, aligned: Formula) -> list[Requirement]:
        """The second tip alone would turn the part back onto the first one: proved in one of three ways."""
        back = turns_back(which, self.scene, self.other, -self.side, self.box)
        sticking = sticks(which, self.scene, aligned, self.other, -self.side, -self.side, self.box)
        if self.slip is not None:
            slipping = self.slips_back(which, aligned)
            back = dataclasses.replace(back, instead=(slipping,))
        ways = (back, *back.instead)
        if not any(all(holds(way.statement, part) for part in way.parts) for way in ways):
            _prove(sticking)
        return [
            dataclasses.replace(
                one,
                shown=True,
                group=f"{which} alone",
                instead=(back,) if one.name.id == back.name.id else (),
            )
            for one in sticking
        ]

    def slips_back(self, which: str, aligned: Formula) -> Requirement:
        """The second tip alone turns the part back if it sticks, and no less if it slips."""
        scene, mu = self.scene, self.scene.mu(-self.side)
        film = {key: of for key, of in scene.film_variables("_now").items() if key != "rho"}
        variables: Variables = {
            "theta": aligned,
            "d1": lambda at: at["depth"],
            "d2": self.other,
            "mu": lambda at: at[mu],
            "side": constant(arb(-self.side)),
            **film,
        }
        return Requirement(
            name=named(Must.TIP_TURNS_PART, tip=which, turn=TURNS[-self.side]),
            statement=st.TURNS_BACK,
            parts=(Part(variables, self.box),),
        )

    @property
    def first_rolls(self) -> bool:
        """Whether the first tip's contact moves along the edge."""
        return not self.scene.exact(f"radius_{NAMES[self.side]}")

    def at_end(self, at: Point) -> Dual:
        """``d2`` of the first tip when the other touches."""
        return self.end(at).d2

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
