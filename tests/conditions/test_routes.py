"""Four evaluations of every generated formula agree, and one that is wrong is noticed.

The ball at 128 bits is the truth here; the derivation's own value is held against all of them in
``tests/campaigns/property``.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from meso_robust.bounds import Bounded, enclose
from meso_robust.campaigns.property.laws.routes import (
    NAMES,
    Routes,
    Sample,
    at_shares,
    ball_over_a_box_holds_the_truth,
    doubles_are_near_the_truth,
    enclosure_holds_the_truth,
    routes,
    sample,
)
from meso_robust.types import Floats
from tests.conditions.functions import with_a_changed_sign
from tests.nightly import by_day, often
from tests.strategies import REPEATABLE

MOST_ARGUMENTS = 24  # of a formula

every_function = pytest.mark.parametrize(("module", "name"), NAMES, ids=map(".".join, NAMES))
share = st.floats(0.0, 1.0)
shares = st.lists(
    st.tuples(share, share, share), min_size=MOST_ARGUMENTS, max_size=MOST_ARGUMENTS
).map(np.array)


def samples(of: Bounded, count: int) -> list[Sample]:
    rng = np.random.default_rng(5)
    return [sample(of.inputs, rng.random((MOST_ARGUMENTS, 3))) for _ in range(count)]


Check = Callable[[Routes, Sample], str]
CHECKS: dict[Check, set[str]] = {
    doubles_are_near_the_truth: {"numbers", "balls", "bounds"},
    enclosure_holds_the_truth: {"balls", "bounds"},
    ball_over_a_box_holds_the_truth: {"balls", "bounds"},
}
"""Check -> routes that it compares."""
ROUTES = ("numbers", "balls", "bounds")
EACH_ROUTE = [
    (*one, ROUTES[(k + turn) % len(ROUTES)])
    for turn in range(len(ROUTES))
    for k, one in enumerate(NAMES)
]
"""Every function by every route; the first of each function differ."""


@every_function
@settings(REPEATABLE, max_examples=often(10, 30))
@given(shares)
def test_routes_agree(module: str, name: str, random: Floats) -> None:
    of = routes(module, name)
    at = sample(of.bounds.inputs, random)
    for agree in CHECKS:
        assert not agree(of, at)


@pytest.mark.parametrize(("module", "name", "route"), by_day(len(NAMES), EACH_ROUTE))
def test_a_changed_sign_is_noticed(
    module: str, name: str, route: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    copies = with_a_changed_sign(module, name)
    noticed = dict.fromkeys(CHECKS, 0)
    for copy in copies:
        monkeypatch.setitem(sys.modules, copy.__name__, copy)
        elsewhere: dict[str, Any] = {route: copy.__name__.split(".")[-1]}
        wrong = routes(module, name, **elsewhere)
        for agree in CHECKS:
            noticed[agree] += fails_somewhere(agree, wrong)
    assert noticed[doubles_are_near_the_truth] == len(copies) > 0
    for agree, compared in CHECKS.items():  # a copy that is defined nowhere proves nothing wrong
        assert (noticed[agree] > 0) == (route in compared), agree.__name__


def fails_somewhere(agree: Check, of: Routes) -> bool:
    return any(agree(of, at) for at in samples(of.bounds, 30))


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
