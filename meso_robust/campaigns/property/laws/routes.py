"""The ways in which a generated formula is evaluated, and what they must have in common.

The exact value is known as a ball. What rounding may do in doubles is measured by the ball of the
generated code at 53 bits: its radius adds up the rounding errors of all terms.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from importlib import import_module
from pkgutil import iter_modules
from typing import TYPE_CHECKING

import numpy as np

from meso_robust.bounds import Bounded, Box, Interval, enclose
from meso_robust.conditions import balls, condition, values
from meso_robust.types import Floats

if TYPE_CHECKING:
    from flint import arb

Balls = Callable[..., "tuple[arb, ...]"]

PACKAGE = "meso_robust._generated"
MODULES = tuple(module.name for module in iter_modules(import_module(PACKAGE).__path__))
NAMES = tuple(
    (module, name)
    for module in MODULES
    for name, value in vars(import_module(f"{PACKAGE}.{module}")).items()
    if inspect.isfunction(value)
)
"""(module, name) of every generated formula."""

ROUNDING = 4.0
"""How many times the radius at 53 bits a result in doubles may be off."""

_RANGES = {
    (0.1, 3.0): "theta theta_0 theta_1 theta_2 exterior",
    (1.2, 2.2): "theta_start theta_end",
    (-0.5, 0.5): "beta direction bend phi psi",
    (-0.1, 0.1): "stretch shear kappa total",
    (0.05, 1.0): "mu mu_D mu_S mu_w",
    (-1.0, 1.0): "tau tau_D tau_S side f_x f_y c s",
    (0.0, 3e-5): "r r_upper r_lower r_D r_S rounding radii creep",
    (-3e-5, 3e-5): "drag_a drag_n",
    (1e-4, 4e-4): "d1 d1_next d_D d_S",
    (-8e-4, 8e-4): "d2 d2_back sigma p p_S p_D q rise dx dy x0 y0 x1 y1 x y x_f y_f",
    (4e-4, 9e-4): "x_1",  # three supports: a triangle, however they are drawn
    (-9e-4, -4e-4): "x_2",
    (1.5e-4, 4e-4): "y_1 y_2",
    (-2e-4, 3e-4): "x_3",
    (-4e-4, -1.5e-4): "y_3",
    (1e-5, 2e-4): "room clear",
    (5e-4, 1e-3): "b engaged d4 half h V T W width spacing gap",
    (5e2, 2e3): "omega",
    (1e-7, 8e-7): "rho",
}
RANGES = {name: ends for ends, names in _RANGES.items() for name in names.split()}
"""Where an argument lies, in SI units; a new one needs an entry."""


def at_shares(names: tuple[str, ...], shares: Floats) -> dict[str, Floats]:
    """Arguments at ``shares`` (..., arguments) of their ranges."""
    lo, hi = np.array([RANGES[name] for name in names]).T
    points = lo + shares * (hi - lo)
    return {name: points[..., k] for k, name in enumerate(names)}


@dataclass(frozen=True, slots=True, eq=False)
class Routes:
    """The evaluations of one formula; CasADi's numbers are ``bounds.function``."""

    numbers: Callable[..., tuple[Floats, ...]]
    """NumPy."""
    bounds: Bounded
    """CasADi, and outward-rounded intervals."""
    balls: Balls
    """The generated code over balls; takes the precision as ``bits``."""
    truth: Balls
    """Balls that hold the exact value at a point."""


def routes(module: str, name: str, *, truth: Balls | None = None, **elsewhere: str) -> Routes:
    """The evaluations of ``module.name``.

    Parameters
    ----------
    module, name
        The formula.
    truth
        Where the exact value comes from; the balls of the generated code if absent.
    elsewhere
        Another module for a route, by the route's name.
    """
    at = {route: elsewhere.get(route, module) for route in ("numbers", "balls", "bounds")}
    over = balls(at["balls"], name)
    return Routes(
        values(at["numbers"], name),
        condition(at["bounds"], name),
        over,
        over if truth is None else truth,
    )


@dataclass(frozen=True, slots=True)
class Sample:
    """A box, and a point of it."""

    lo: Mapping[str, float]
    hi: Mapping[str, float]
    point: Mapping[str, float]

    @property
    def box(self) -> Box:
        """The box as intervals."""
        return {key: Interval(low, self.hi[key]) for key, low in self.lo.items()}

    @property
    def balls(self) -> dict[str, arb]:
        """The box as balls; they hold it, and a little more."""
        from flint import arb

        return {key: arb(low).union(arb(self.hi[key])) for key, low in self.lo.items()}


def sample(names: tuple[str, ...], shares: Floats) -> Sample:
    """A box of any width: the three columns give the place, the width and the point.

    Parameters
    ----------
    names
        Arguments.
    shares
        (K, 3) numbers from 0 to 1, K at least the number of arguments.
    """
    place, width, within = shares[: len(names)].T
    low = place * (1.0 - width**10)
    at = [at_shares(names, low + part * width**10) for part in (0.0, 1.0, within)]
    lo, hi, point = ({key: float(value) for key, value in end.items()} for end in at)
    hi = {key: max(value, lo[key]) for key, value in hi.items()}
    point = {key: min(max(value, lo[key]), hi[key]) for key, value in point.items()}
    return Sample(lo, hi, point)


# -- what must agree; each gives what does not, or nothing ----------------------------------------


def doubles_are_near_the_truth(of: Routes, at: Sample) -> str:
    """NumPy and CasADi lie within rounding errors of it, and are undefined where it is."""
    from flint import arb

    by_numpy = [float(value) for value in of.numbers(**at.point)]
    by_casadi = of.bounds.function(list(at.point.values())).full().ravel()
    rough, exact = of.balls(**at.point, bits=53), of.truth(**at.point)
    for k, (one, other) in enumerate(zip(by_numpy, by_casadi, strict=True)):
        for way, value in (("NumPy", one), ("CasADi", float(other))):
            if rough[k].is_finite():
                if not abs(arb(value) - exact[k].mid()) <= ROUNDING * rough[k].rad():
                    return _off(k, f"{way} gives {value!r}", exact[k], rough[k])
            elif not exact[k].is_finite() and np.isfinite(value):
                return f"result {k} is undefined, {way} gives {value!r}"
    return ""


def balls_hold_the_truth(of: Routes, at: Sample) -> str:
    """The ball of the generated code at a point, and at 53 bits, has the exact value in common."""
    exact = of.truth(**at.point)
    for bits in (53, 128):
        for k, (ball, value) in enumerate(zip(of.balls(**at.point, bits=bits), exact, strict=True)):
            if ball.is_finite() and not (value.is_finite() and ball.overlaps(value)):
                return _off(k, f"the ball at {bits} bits is {ball.str(20)}", value, ball)
    return ""


def enclosure_holds_the_truth(of: Routes, at: Sample) -> str:
    """The value at a point of a box lies in the enclosure over the box."""
    from flint import arb

    enclosures = enclose(of.bounds, at.box, boxes=8)
    for k, (side, value) in enumerate(zip(enclosures, of.truth(**at.point), strict=True)):
        if value < arb(side.lo) or value > arb(side.hi):
            return f"result {k} is {value.str(20)}; the enclosure is [{side.lo!r}, {side.hi!r}]"
    return ""


def ball_over_a_box_holds_the_truth(of: Routes, at: Sample) -> str:
    """So does the ball over the box, which the enclosure therefore meets."""
    from flint import arb

    over, exact = of.balls(**at.balls), of.truth(**at.point)
    for k, side in enumerate(enclose(of.bounds, at.box, boxes=1)):
        wide = over[k]
        if not wide.is_finite():
            continue
        if not wide.overlaps(exact[k]):
            return f"result {k} is {exact[k].str(20)}; the ball over the box is {wide.str(20)}"
        if wide < arb(side.lo) or wide > arb(side.hi):
            return f"result {k}: ball {wide.str(20)}, enclosure [{side.lo!r}, {side.hi!r}]"
    return ""


def _off(k: int, what: str, exact: arb, allowed: arb) -> str:
    return (
        f"result {k}: {what}; it is {exact.str(25)}, rounding explains {float(allowed.rad()):.2g}"
    )
