"""The two tips that take part in a two-sided rotation: the active one pushes, the passive one rests.

Axes are those of the travel. What a run keeps is told by the names that barriers know (``slide.py``).
"""

from __future__ import annotations

import dataclasses

from meso_robust.checker.contact import off_line
from meso_robust.checker.dual import Dual, Point
from meso_robust.checker.film import MOVING
from meso_robust.checker.ranges import Box, Formula, Side, shift, side_of, span
from meso_robust.checker.scene import Scene, direction

ACTIVE = -1
"""The lower tip of the active probe pushes."""
NEAR = 1e-9
"""How closely the ranges of what is constant are bounded; m, and 1."""


@dataclasses.dataclass(frozen=True, slots=True)
class Pair:
    """The active and the passive tip as functions of the variables of the move.

    Of the far edge the variables are ``size_far`` and ``kappa_far``: another edge than the neighbours
    of the pushed one, so that its errors are others; a run may state them.
    """

    scene: Scene
    until_rest: Side | None = None
    """How far the part turns until it rests on both, rad; None: not known yet."""

    @property
    def box(self) -> Box:
        """The variables of the move."""
        box, askew = self.scene.box, self.scene.askew
        size, turned = (box.get(f"{one}_far", box[f"{one}_other"]) for one in ("size", "kappa"))
        far = {"size_far": size, "kappa_far": turned if askew == 0 else shift(turned, askew)}
        return (
            {**box, **far} if self.until_rest is None else {**box, **far, "turned": self.until_rest}
        )

    @property
    def parallel(self) -> bool:
        """Whether both edges have exactly one direction."""
        return self.scene.exact("kappa", "kappa_other") and bool(self.scene.askew == 0)

    def exact(self, *names: str) -> bool:
        """Whether some variables are exactly zero."""
        return self.scene.exact(*names)

    def _between(self, at: Point) -> tuple[Dual, Dual]:
        """Active minus passive tip at the start, axes of the move."""
        rule, half = self.scene.rule, at["spacing"] / 2
        x = self.scene.apart(rule.dual_x, at, "x") - self.scene.lag(at, ACTIVE)
        return x, self.scene.apart(rule.dual_y, at, "y") - half

    def V(self, at: Point) -> Dual:
        """Active minus passive tip, y, on the straight line of the travel."""
        return self.scene.in_travel(at, *self._between(at))[1]

    def stray(self, at: Point, when: str = "") -> Dual:
        """How far the active tip is above that line, at the touch of both or ``_now``."""
        return self.scene.in_travel(at, at[f"wander_x{when}"], at[f"wander_y{when}"])[1]

    def Z(self, at: Point) -> Dual:
        """The part before the move minus the passive tip, y."""
        return -self.passive(at)[1]

    def passive(self, at: Point) -> tuple[Dual, Dual]:
        """The passive tip minus the part before the move."""
        scene = self.scene
        return scene.in_travel(at, scene.passive_ahead(at), scene.passive_rise(at))

    def h_end(self, at: Point) -> Dual:
        """Active tip at the end of its travel minus the passive one, x."""
        scene = self.scene
        if self.exact("direction", "scale"):
            between = scene.apart(scene.rule.dual_end_x, at, "x") - scene.lag(at, ACTIVE)
            return between + at["wander_x_now"]
        x, y = self._between(at)
        start, _ = scene.in_travel(at, x + at["wander_x_now"], y + at["wander_y_now"])
        return start - scene.travelled(at)

    def turned(self, at: Point) -> Dual | None:
        """Direction of the far edge minus that of the pushed one; None: they are parallel."""
        return None if self.parallel else at["kappa_far"] - at["kappa"]

    def depth_far(self, at: Point) -> Dual:
        """Of the far edge from the reference point, m."""
        return at["size_far"] + self.scene.far.d1

    def first_gap(self, at: Point) -> Dual:
        """Distance of the passive tip from the far edge before the move."""
        angle, turned = self.scene.angle(at), self.turned(at)
        c, s = direction(angle if turned is None else angle + turned)
        return -off_line(c, s, *self.passive(at)) - self.depth_far(at) - at["radius_passive"]

    def formulas(self) -> dict[str, Formula]:
        """What is constant during a run and not exactly zero."""
        found: dict[str, Formula] = {
            "V": self.V,
            "Z": self.Z,
            "depth": lambda at: at["depth"],
            "depth_far": self.depth_far,
            "radius": lambda at: at["radius_lower"],
            "radius_far": lambda at: at["radius_passive"],
        }
        if not self.parallel:
            found["tilt"] = lambda at: (at["kappa_far"] - at["kappa"]).tan()
        found["begun"] = self.scene.angle
        if self.until_rest is not None:
            found["turned"] = lambda at: at["turned"]
        for name in MOVING:
            if not self.exact(name):
                found[name] = lambda at, name=name: at[name]  # type: ignore[misc]
        return found

    def constants(self, at: Point) -> dict[str, Dual]:
        """The same at one point."""
        return {name: of(at) for name, of in self.formulas().items()}

    def instants(self) -> dict[str, Side]:
        """What may change at every instant."""
        box, mu = (
            self.scene.box,
            [self.scene.mu(ACTIVE), "mu" if "mu" in self.box else "mu_passive"],
        )
        found = {name: box[name] for name in ("rho", *mu)}
        found |= {
            n: box[n] for n in ("stretch", "shear", "bend", *MOVING.values()) if not self.exact(n)
        }
        if not self.exact("wander_x", "wander_y"):
            found["stray"] = span(self.stray, self.box, within=NEAR)
        return found

    def ranges(self) -> Box:
        """Sides of all that a barrier depends on."""
        found: dict[str, Side] = {}
        for name, of in self.formulas().items():
            side = span(of, self.box, within=NEAR)
            found[name] = side_of(side[0]) if side[0] == side[1] else side
        return {**found, **self.instants()}
