"""A push into the slot in which the part may touch the side walls.

Nothing is followed. Let ``m`` be the larger of the leans of the part before the move and of the line through
both tips. (1) The part never leans more than ``m``: a part with its front up that leans more than the line
through the tips is pushed by the upper tip alone, at a force with ratio ``t`` in the cone of friction. Moments
about the centre of drag, with the part's point on the slot's edge at rest across its side, give a turn of
the sign of ``-(d2 + t (d1 + p - b mu_w))`` where the edge bears on it (the part moves inwards there if it does
not turn back, so that the wall's friction is known). Else a ratio above ``-d2/d1`` turns it back, as does the
wall on a front corner; and one below needs a point that does not slip down under the tip, while the centre
comes down by ``d2/d1`` of its way ahead. (2) One wall is touched at a time, and its force and that of the tips
are never opposite: there is a motion at every instant. (3) Once a tip has touched, one touches always: with none
the part rests in their way. So the tips say how deep the part is, and the walls how far aside.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import partial, reduce

from flint import arb

from meso_robust.checker import statement as st
from meso_robust.checker.dual import Dual, Point
from meso_robust.checker.ids import Must, Named, Property, named
from meso_robust.checker.inputs import Channel, Given, PoseBox
from meso_robust.checker.outline import Rectangle
from meso_robust.checker.passage import Passage
from meso_robust.checker.pushing import UNIT, constant, free_at_start
from meso_robust.checker.ranges import ZERO, Box, Formula, Side, hull, shift, span
from meso_robust.checker.refusal import Refused
from meso_robust.checker.requirement import Part, Requirement, Variables, prove
from meso_robust.checker.scene import NAMES, Scene, aim, negative

SIGNS = (1, -1)
MOST_LEAN = arb("0.5")
"""rad"""
EXACT = ("kappa", "stretch", "shear", "drag_a", "drag_n", "centre_a", "centre_n")
"""What must be as stated: right angles, and an even film about the reference point."""


def check_guide(scene: Scene, given: Given) -> Passage:
    """Prove a guided push from every pose of its scene.

    Raises
    ------
    Refused
        A requirement does not follow, or the push is none that walls can guide here.
    """
    channel = given.channel
    if channel is None or channel.quarters != scene.frame.quarters:
        raise Refused(named(Must.GUIDE_COVERED), scene.rule.heading, "into the slot")
    covered = isinstance(scene.outline, Rectangle) and scene.exact(*EXACT)
    if not covered or given.largest_force is not None or not scene.corner_radius == 0:
        raise Refused(
            named(Must.GUIDE_COVERED), "uneven", "a sharp rectangle on an even film, no cap"
        )
    if scene.frame.mirrored:
        channel = replace(channel, y=negative(channel.y))
    push = _push(scene, given, channel)
    requirements = [*free_at_start(scene, SIGNS), *push.requirements()]
    for requirement in requirements:
        prove(requirement)
    x = _minus(channel.x, reduce(hull, (push.span(partial(push.deep_at_end, k)) for k in SIGNS)))
    return Passage(
        does=named(Property.GUIDED_BY_WALLS),
        post=PoseBox(
            x=x,
            y=(channel.y[0] - push.aside, channel.y[1] + push.aside),
            theta=shift((arb.pi() / 2 - push.most, arb.pi() / 2 + push.most), scene.turn),
        ),
        requirements=tuple(requirements),
        guided=True,
    )


def _minus(one: Side, other: Side) -> Side:
    return one[0] - other[1], one[1] - other[0]


def _largest(side: Side) -> arb:
    return abs(side[0]).max(abs(side[1]))


def _sine(angle: Dual) -> Dual:
    return angle.sin_cos()[0]


@dataclass(frozen=True, slots=True, kw_only=True)
class _Push:
    """A guided push.

    Variables beyond those of its scene: ``lean`` (either way; ``phi`` its size), ``deep`` of the centre within
    the mouth, ``rock`` and ``off`` of either sign, ``share`` of the travel, ``front`` and ``b`` of the part,
    ``veer`` of the tips' path.
    """

    scene: Scene
    channel: Channel
    box: Box
    most: arb
    """Lean, rad."""
    aside: arb
    """Of the centre off the slot's axis, at most, m."""
    far: arb
    """The same before the move."""
    ends: tuple[arb, arb]
    """Certain ends of the rear edge."""

    def span(self, of: Formula) -> Side:
        """Bounds of a formula."""
        return span(of, self.box)

    def out(self, at: Point, side: int) -> Dual:
        """A tip's centre behind the part's centre while they touch."""
        return at["depth"] + self.scene.radius(at, side)

    def high(self, side: int, at: Point) -> Dual:
        """How far a tip is off the slot's axis, on its own side."""
        scene = self.scene
        start = at["y"] + aim(scene.rule.dual_y, at, "y", "probe_") + at["spacing"] * side / 2
        s, _ = at["direction"].sin_cos()
        y = start + at["wander_y_now"] - at["share"] * scene.travelled(at) * s
        return (y - at["mouth_y"]) * side

    def tip_deep(self, side: int, at: Point) -> Dual:
        """How far a tip's centre is within the mouth at the end, m; negative outside."""
        scene = self.scene
        start = at["x"] + aim(scene.rule.dual_x, at, "x", "probe_") - scene.lag(at, side)
        _, c = at["direction"].sin_cos()
        return at["mouth_x"] - (start + at["wander_x_now"] - scene.travelled(at) * c)

    def deep_at_end(self, side: int, at: Point) -> Dual:
        """How far the part's centre is within it while a tip touches the rear edge, at the end."""
        s, c = at["phi"].sin_cos()
        return self.tip_deep(side, at) + self.out(at, side) * c + at["rock"] * s

    def edge_at(self, at: Point) -> Dual:
        """The slot's edge ahead of the centre, along the side that bears on it."""
        s, c = at["phi"].sin_cos()
        return -((at["deep"] + at["b"] * s) / c)

    def offset(self, side: int, at: Point) -> Dual:
        """A contact along the rear edge."""
        s, c = at["lean"].sin_cos()
        return (self.high(side, at) * side + at["off"] + self.out(at, side) * s) / c

    def requirements(self) -> list[Requirement]:
        """What must hold of it in particular."""

        def every(key: str) -> Formula:
            return lambda at: at[key]

        walls: Variables = {
            "b": every("b"),
            "mu_w": constant(self.channel.friction),
            "phi": every("phi"),
        }

        def one(must: Named, statement: st.Statement, keys: str, *parts: Variables) -> Requirement:
            made = tuple(
                Part({key: {**walls, **part}[key] for key in keys.split()}, self.box)
                for part in parts
            )
            return Requirement(name=must, statement=statement, parts=made)

        spare: Formula = lambda at: (  # noqa: E731
            self.deep_at_end(1, at)
            - at["rock"] * _sine(at["phi"])
            - self._rocks(at)
            - self._before(at)
        )
        found = [
            one(named(Must.TIP_REACHES_PART), st.REACHES, "travel", {"travel": spare}),
            one(named(Must.PART_IN_SLOT), st.IN_SLOT, "front rear end aside", self._within()),
            one(
                named(Must.ONE_WALL_AT_A_TIME),
                st.ONE_WALL,
                "b room engaged phi",
                {
                    "room": constant(self.channel.half * 2),
                    "engaged": lambda at: at["front"] - self.edge_at(at),
                },
            ),
            one(
                named(Must.NO_JAM),
                st.NO_JAM_IN_SLOT,
                "mu mu_w phi",
                *({"mu": every(k)} for k in self._mu()),
            ),
            one(
                named(Must.WALL_TURNS_BACK),
                st.CORNER_TURNS,
                "d1 b mu_w phi",
                {"d1": every("depth")},
                {"d1": every("front")},
            ),
            one(
                named(Must.FILM_TURNS_WITH),
                st.STIFF,
                "rho b mu_w",
                {"rho": every(self.scene.rho_now)},
            ),
        ]
        for side in SIGNS:
            tip = NAMES[side]
            found += [
                one(
                    named(Must.TIP_ON_EDGE, tip=tip),
                    st.ON_EDGE,
                    "d2 first last",
                    {
                        "d2": partial(self.offset, side),
                        "first": constant(self.ends[0]),
                        "last": constant(self.ends[1]),
                    },
                ),
                one(
                    named(Must.EDGE_TURNS_BACK, tip=tip),
                    st.BEARS,
                    "d1 d2 p b mu mu_w",
                    {
                        "d1": every("depth"),
                        "d2": partial(self._bearing, side),
                        "p": self.edge_at,
                        "mu": every(self.scene.mu(side)),
                    },
                ),
                one(
                    named(Must.TIP_STEERS, tip=tip),
                    st.STEERS,
                    "d1 d2 psi",
                    {
                        "d1": every("depth"),
                        "d2": partial(self._free, side),
                        "psi": lambda at: at["phi"] + at["veer"],
                    },
                ),
            ]
        angle: Formula = lambda at: at["lean"] + at["veer"] + arb.pi() / 2  # noqa: E731
        withdraws = named(Must.WITHDRAWS_FREE, tips="pair")
        return [*found, one(withdraws, st.COMES_FREE, "theta", {"theta": angle})]

    def _mu(self) -> tuple[str, ...]:
        return tuple(dict.fromkeys(map(self.scene.mu, SIGNS)))

    def _rocks(self, at: Point) -> Dual:
        return _sine(at["phi"]) * self._reach

    @property
    def _reach(self) -> arb:
        return self.ends[1].max(-self.ends[0])

    def _before(self, at: Point) -> Dual:
        return at["mouth_x"] - at["x"]

    def _within(self) -> Variables:
        """What of the part is how far within the slot, or outside."""
        channel, far = self.channel, self.far

        def front(at: Point) -> Dual:
            s, c = at["phi"].sin_cos()
            return at["deep"] + at["front"] * c - at["b"] * s

        def rear(at: Point) -> Dual:
            s, c = at["phi"].sin_cos()
            return at["depth"] * c - at["deep"] - at["b"] * s

        return {
            "front": front,
            "rear": rear,
            "end": lambda at: (
                -(at["deep"] + at["front"] + at["b"] * _sine(at["phi"])) + channel.depth
            ),
            "aside": lambda at: -(at["front"] * _sine(at["phi"])) + (channel.half - far),
        }

    def _bearing(self, side: int, at: Point) -> Dual:
        """A contact's offset where the slot's edge bears on the part, at least: it is far to that side then."""
        return self.high(side, at) + self.channel.half - at["b"]

    def _free(self, side: int, at: Point) -> Dual:
        """The same wherever the walls leave the part."""
        _, c = at["phi"].sin_cos()
        return (self.high(side, at) - self.channel.half) / c + at["b"]


def _push(scene: Scene, given: Given, channel: Channel) -> _Push:
    def leans(at: Point) -> Dual:
        return -at["theta"] + arb.pi() / 2

    def tips_lean(at: Point) -> Dual:
        off = scene.lean(at)
        return at["beta"] if off is None else at["beta"] + off

    most = _largest(span(leans, scene.box)).max(_largest(span(tips_lean, scene.box)))
    if not most < MOST_LEAN:
        raise Refused(named(Must.GUIDE_COVERED), float(most), "a small lean")
    ends = (
        scene.edge.first - scene.box["size_other"][0],
        scene.edge.last + scene.box["size_other"][0],
    )
    reach = ends[1].max(-ends[0])
    veer = _largest(scene.box["direction"]) + _largest(scene.box["bend_now"])
    box = {
        **scene.box,
        "phi": (ZERO, most),
        "lean": (-most, most),
        "rock": (-reach, reach),
        "share": UNIT,
        "front": shift(scene.box["size_other"], scene.far.d1),
        "b": shift(scene.box["size_other"], scene.edge.last),
        "veer": (-veer, veer),
        "mouth_x": channel.x,
        "mouth_y": channel.y,
    }
    push = _Push(
        scene=scene,
        channel=channel,
        box=box,
        most=most,
        aside=ZERO,
        far=_largest(span(lambda at: at["y"] - at["mouth_y"], box)),
        ends=ends,
    )
    before = push.span(push._before)
    at_end = reduce(hull, (push.span(partial(push.deep_at_end, k)) for k in SIGNS))
    # a tip at the touch against the other one later: misalignment, wander, radius, lean
    c, s = most.cos(), most.sin()
    radius = given.radius[1] - given.radius[0]
    slack = (
        2 * _largest(span(lambda at: scene.lag(at, 1), box))
        + 2 * _largest(scene.box["wander_x_now"])
        + (scene.box["depth"][1] + given.radius[1]) * (1 - c)
        + radius
        + 2 * reach * s
    )
    deep = (before[0] - slack, before[1].max(at_end[1]))
    push = replace(push, box={**box, "deep": deep})
    ahead = span(push.edge_at, push.box)[1].max(ZERO)
    aside = channel.half - push.box["b"][0] * c + ahead * s
    return replace(push, aside=aside, box={**push.box, "off": (-aside, aside)})
