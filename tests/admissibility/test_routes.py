"""Four evaluations of every generated formula agree, and one that is wrong is noticed.

The ball at 128 bits is the truth. What rounding may do in doubles is measured by the same ball at 53
bits: its radius adds up the rounding errors of all terms.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import pytest
from flint import arb
from hypothesis import given, settings, strategies as st

from meso_robust.admissibility import balls, condition, values
from meso_robust.bounds import Bounded, Box, Interval, enclose
from tests.admissibility.functions import NAMES, Floats, at_shares, with_a_changed_sign
from tests.strategies import REPEATABLE

MOST_ARGUMENTS = 7
ROUNDING = 4.0
"""How many times the radius at 53 bits a result in doubles may be off."""

every_function = pytest.mark.parametrize(("module", "name"), NAMES, ids=map(".".join, NAMES))


# -- routes and samples ---------------------------------------------------------------------------


@dataclass(frozen=True)
class Routes:
    """The evaluations of one function; the fourth is ``bounds.function``."""

    numbers: Callable[..., tuple[Floats, ...]]
    truth: Callable[..., tuple[arb, ...]]
    bounds: Bounded


def routes(module: str, name: str, **elsewhere: str) -> Routes:
    """Through the package; ``elsewhere`` names another module for a route."""
    at = {route: elsewhere.get(route, module) for route in ("numbers", "truth", "bounds")}
    return Routes(
        values(at["numbers"], name), balls(at["truth"], name), condition(at["bounds"], name)
    )


@dataclass(frozen=True)
class Sample:
    """A box, and a point of it."""

    lo: dict[str, float]
    hi: dict[str, float]
    point: dict[str, float]

    @property
    def box(self) -> Box:
        return {key: Interval(low, self.hi[key]) for key, low in self.lo.items()}

    @property
    def balls(self) -> dict[str, arb]:
        return {key: arb(low).union(arb(self.hi[key])) for key, low in self.lo.items()}


share = st.floats(0.0, 1.0)
shares = st.lists(
    st.tuples(share, share, share), min_size=MOST_ARGUMENTS, max_size=MOST_ARGUMENTS
).map(np.array)


def sample(of: Bounded, random: Floats) -> Sample:
    """A box of any width: the three columns give the place, the width and the point."""
    place, width, within = random[: len(of.inputs)].T
    low = place * (1.0 - width**10)
    at = [at_shares(of.inputs, low + part * width**10) for part in (0.0, 1.0, within)]
    lo, hi, point = ({key: float(value) for key, value in end.items()} for end in at)
    hi = {key: max(value, lo[key]) for key, value in hi.items()}
    point = {key: min(max(value, lo[key]), hi[key]) for key, value in point.items()}
    return Sample(lo, hi, point)


def samples(of: Bounded, count: int) -> list[Sample]:
    rng = np.random.default_rng(5)
    return [sample(of, rng.random((MOST_ARGUMENTS, 3))) for _ in range(count)]


# -- what must agree ------------------------------------------------------------------------------


def doubles_are_near_the_truth(of: Routes, at: Sample) -> None:
    """NumPy and CasADi lie within rounding errors of it, and are undefined where it is."""
    by_numpy = [float(value) for value in of.numbers(**at.point)]
    by_casadi = of.bounds.function(list(at.point.values())).full().ravel()
    rounding = of.truth(**at.point, bits=53)
    for one, other, exact, rough in zip(
        by_numpy, by_casadi, of.truth(**at.point), rounding, strict=True
    ):
        if rough.is_finite():
            assert abs(arb(one) - exact.mid()) <= ROUNDING * rough.rad()
            assert abs(arb(other) - exact.mid()) <= ROUNDING * rough.rad()
        elif not exact.is_finite():
            assert not np.isfinite([one, other]).any()


def enclosure_holds_the_truth(of: Routes, at: Sample) -> None:
    """The value at a point of a box lies in the enclosure over the box."""
    enclosures = enclose(of.bounds, at.box, boxes=8)
    for side, exact in zip(enclosures, of.truth(**at.point), strict=True):
        assert not exact < arb(side.lo)
        assert not exact > arb(side.hi)


def ball_over_a_box_meets_the_enclosure(of: Routes, at: Sample) -> None:
    """Both hold the value at every point of the box."""
    enclosures = enclose(of.bounds, at.box, boxes=1)
    over, exact = of.truth(**at.balls), of.truth(**at.point)
    for side, wide, narrow in zip(enclosures, over, exact, strict=True):
        if wide.is_finite():
            assert wide.overlaps(narrow)
            assert not wide < arb(side.lo)
            assert not wide > arb(side.hi)


Check = Callable[[Routes, Sample], None]
CHECKS: dict[Check, set[str]] = {
    doubles_are_near_the_truth: {"numbers", "truth", "bounds"},
    enclosure_holds_the_truth: {"truth", "bounds"},
    ball_over_a_box_meets_the_enclosure: {"truth", "bounds"},
}
"""Check -> routes that it compares."""


@every_function
@settings(REPEATABLE, max_examples=50)
@given(shares)
def test_routes_agree(module: str, name: str, random: Floats) -> None:
    of = routes(module, name)
    at = sample(of.bounds, random)
    for agree in CHECKS:
        agree(of, at)


@every_function
@pytest.mark.parametrize("route", ["numbers", "truth", "bounds"])
def test_a_changed_sign_is_noticed(
    route: str, module: str, name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    copies = with_a_changed_sign(module, name)
    noticed = dict.fromkeys(CHECKS, 0)
    for copy in copies:
        monkeypatch.setitem(sys.modules, copy.__name__, copy)
        wrong = routes(module, name, **{route: copy.__name__.split(".")[-1]})
        for agree in CHECKS:
            noticed[agree] += fails_somewhere(agree, wrong)
    assert noticed[doubles_are_near_the_truth] == len(copies) > 0
    for agree, compared in CHECKS.items():  # a copy that is defined nowhere proves nothing wrong
        assert (noticed[agree] > 0) == (route in compared), agree.__name__


def fails_somewhere(agree: Check, of: Routes) -> bool:
    for at in samples(of.bounds, 50):
        try:
            agree(of, at)
        except AssertionError:
            return True
    return False


# -- the checks are not empty ---------------------------------------------------------------------


@every_function
def test_most_points_are_defined_and_precise(module: str, name: str) -> None:
    of = routes(module, name)
    random = np.random.default_rng(3).random((1000, len(of.bounds.inputs)))
    arguments = at_shares(of.bounds.inputs, random)
    defined = np.isfinite(of.numbers(**arguments)).all(axis=0)
    assert defined.mean() > 0.9
    for k in np.flatnonzero(defined)[:50]:
        point = {key: float(value[k]) for key, value in arguments.items()}
        for exact, rough in zip(of.truth(**point), of.truth(**point, bits=53), strict=True):
            assert exact.rad() <= 2.0**-70 * rough.rad()
            assert rough.rad() <= 1e-10 * abs(exact.mid())


@every_function
def test_most_thin_boxes_get_thin_bounds(module: str, name: str) -> None:
    of = routes(module, name)
    thin, bounded = 0, 0
    for at in samples(of.bounds, 50):
        hi = {key: np.nextafter(value, np.inf) for key, value in at.point.items()}
        near = Sample(at.point, hi, at.point)
        over, exact = of.truth(**near.balls), of.truth(**at.point)
        sides = enclose(of.bounds, near.box, boxes=1)
        for side, wide, narrow in zip(sides, over, exact, strict=True):
            if narrow.is_finite():
                size = 1e-9 * abs(float(narrow.mid()))
                bounded += 1
                thin += bool(wide.is_finite() and wide.rad() <= size and side.width <= size)
    assert bounded >= 45
    assert thin > 0.9 * bounded
