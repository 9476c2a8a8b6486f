"""The run of a witness in exact numbers, and each of its moves with ranges put to them.

What the witness states replaces the task's range: errors, tips, the edge that is pushed and the travel.
Friction at a tip changes from leg to leg, so that its range becomes the one that its values span. Drag and
the ways of wandering probes keep the task's ranges, and so do edges that no tip touches: what is proved
holds for the run as well.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace

from flint import arb

from meso_robust.checker.document import RuleDocument, WitnessDocument
from meso_robust.checker.ids import place
from meso_robust.checker.inputs import Given, PoseBox
from meso_robust.checker.numbers import double
from meso_robust.checker.outline import Edge, Polygon
from meso_robust.checker.ranges import ZERO, Side, hull, shift, side_of
from meso_robust.checker.scene import Scene, frame_of, negative, scene_of

TIPS = ("dtp_top", "dtp_bottom", "stp")
"""Both tips of the active probe, and the passive one."""
TURNED = frozenset({"kappa", "kappa_far", "direction"})
"""Angles: in mirrored axes they have the other sign."""
Three = tuple[arb, arb, arb]


@dataclass(frozen=True, slots=True, kw_only=True)
class Run:
    """A run in exact numbers."""

    given: Given
    """The task, what is constant during the run put to one number."""
    start: PoseBox
    sensing: tuple[Three, ...]
    """Sensed minus true pose before each move."""
    dual: tuple[tuple[arb, arb], ...]
    """True minus commanded position of the active probe in each move."""
    single: tuple[tuple[arb, arb], ...]
    more: Mapping[str, str]
    """What else the witness states."""

    @classmethod
    def of(cls, witness: WitnessDocument, given: Given) -> Run:
        """The run that a witness states, its numbers put back into bounds where rounding took them out."""
        start, sensed, probe = given.start, given.sensed, given.probe
        at = _numbers(witness.start, (start.x, start.y, start.theta))
        # the first pose is sensed as the task states it
        first = [
            (low + high) / 2 - own
            for own, (low, high) in zip(at, (start.x, start.y, start.theta), strict=True)
        ]
        later = (_numbers(one, (sensed, sensed, given.turned)) for one in witness.sensing[1:])

        def pairs(texts: Iterable[tuple[str, str]]) -> tuple[tuple[arb, arb], ...]:
            return tuple((_number(x, probe), _number(y, probe)) for x, y in texts)

        return cls(
            given=replace(
                given,
                # of tips that each have a friction of their own the witness's one number tells nothing
                friction=side_of(_number(witness.friction, given.friction))
                if given.common_friction
                else given.friction,
                film_ratio=side_of(_number(witness.film_ratio_m2, given.film_ratio)),
                misalignment=side_of(_number(witness.misalignment_rad, given.misalignment)),
            ),
            start=_box(*at),
            sensing=((first[0], first[1], first[2]), *later),
            dual=pairs(witness.dual_probe),
            single=pairs(witness.single_probe),
            more=witness.more,
        )

    def scene(self, rule: RuleDocument, number: int, pose: PoseBox) -> Scene:
        """A move of the run from some poses: all that the witness states put to one number."""
        scene, frame = scene_of(rule, pose, self.given), frame_of(rule)
        errors = {
            "sensed": self.sensing[number][:2],
            "probe": self.dual[number],
            "passive": self.single[number],
        }
        box = dict(scene.box)
        for name, (x, y) in errors.items():
            own = frame.own(_box(x, y, ZERO))  # an error turns with the axes as a position does
            box[f"{name}_x"], box[f"{name}_y"] = side_of(own.x[0]), side_of(own.y[0])
        tips = dict(zip(("upper", "lower", "passive"), TIPS, strict=True))
        if frame.mirrored:
            tips["upper"], tips["lower"] = tips["lower"], tips["upper"]
        return replace(
            scene, box=box | self._constants(scene, tips, number) | self._friction(tips, number)
        )

    def _constants(self, scene: Scene, tips: Mapping[str, str], number: int) -> dict[str, Side]:
        """Of tips, pushed and far edge and travel, as variables of the scene."""
        edge, far = (f"edge {number_of(scene, one)}" for one in (scene.edge, scene.far))
        move, given = f"move {number + 1}", self.given
        stated = {
            "spacing": ("tip_spacing_m", given.spacing),
            "depth": (f"{edge} out_m", given.size),
            "kappa": (f"{edge} turned_rad", given.squareness),
            "size_far": (f"{far} out_m", given.size),
            "kappa_far": (f"{far} turned_rad", given.squareness),
            "direction": (f"{move} direction_rad", given.direction),
            "scale": (f"{move} scale", given.scale),
            "radius_passive": (f"{tips['passive']} radius_m", given.passive_radius),
        }
        found = {key: self._told(*one) for key, one in stated.items() if one[0] in self.more}
        for key in TURNED & found.keys() if scene.frame.mirrored else ():
            found[key] = negative(found[key])
        for key, by in (("spacing", given.apart), ("depth", scene.d1)):
            if key in found:
                found[key] = shift(found[key], by)
        for side in ("upper", "lower"):
            name = f"{tips[side]} radius_m"
            if name in self.more:
                radius, _ = self._told(name, given.radius)
                # not one and the same end, by which radii of both tips are known to be equal
                found[f"radius_{side}"] = (radius, +radius)
        return found

    def _friction(self, tips: Mapping[str, str], number: int) -> dict[str, Side]:
        """What the frictions of each tip span in a move."""
        found: dict[str, Side] = {}
        for side, tip in tips.items():
            legs = re.compile(f"move {number + 1} friction [0-9]+ {tip}")
            for name in filter(legs.fullmatch, self.more):
                value = self._told(name, self.given.friction)
                before = found.get(f"mu_{side}", value)
                found[f"mu_{side}"] = hull(before, (value[0], +value[0]))
        return found

    def _told(self, name: str, bounds: Side) -> Side:
        return side_of(_number(self.more[name], bounds))


def number_of(scene: Scene, edge: Edge) -> int:
    """Number of an edge, counter-clockwise from 1: a rectangle's first one lies at -y."""
    name, mirrored = edge.name, scene.frame.mirrored
    if isinstance(scene.outline, Polygon):
        return (-name - 2 if mirrored else name) % len(scene.outline.corners) + 1
    return (name + 2 if mirrored else -name) % 4 + 1


def _number(text: str, bounds: Side) -> arb:
    """A number of the run, put back into its bounds where rounding took it out."""
    return arb(double(text, place("witness"))).max(bounds[0]).min(bounds[1])


def _numbers(texts: tuple[str, str, str], bounds: tuple[Side, Side, Side]) -> Three:
    x, y, theta = (_number(text, side) for text, side in zip(texts, bounds, strict=True))
    return x, y, theta


def _box(x: arb, y: arb, theta: arb) -> PoseBox:
    return PoseBox(x=side_of(x), y=side_of(y), theta=side_of(theta))
