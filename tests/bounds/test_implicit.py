"""Ranges of a motion's outputs over boxes: against closed forms and corners."""

from __future__ import annotations

import math
from functools import cache

import casadi as ca
import numpy as np
import pytest

from meso_robust.bounds import Interval
from meso_robust.bounds.implicit import (
    Implicit,
    Quadrature,
    at_middle,
    bound,
    bound_slices,
    failing_point,
    implicit,
)


@cache
def growth() -> Implicit:
    """The end e of the integral of exp-like 1/(a + b t) from s to e that is h: (log((a+be)/(a+bs)))/b."""
    names = ("a", "b", "s", "h", "r", "share")
    v = {name: ca.SX.sym(name) for name in names}
    end, clock, total = ca.SX.sym("end"), ca.SX.sym("clock"), ca.SX.sym("total")
    rate = v["r"] / (v["a"] + v["b"] * clock)
    c = ca.SX.sym("c")
    return implicit(
        "growth",
        v,
        {"c": c},
        ("r",),
        end,
        [(total, Quadrature(rate=rate, clock=clock, start=v["s"], stop=end))],
        total - v["h"],
        {
            "end": end,
            "scaled": c * end - v["h"],
            "bowl": (end - c * v["s"]) ** 2 + v["share"] * (1 - v["share"]),
            "total": total,
        },
    )


BOX = {
    "a": Interval(1.0, 1.2),
    "b": Interval(0.4, 0.6),
    "s": Interval(0.0, 0.1),
    "h": Interval(0.5, 0.55),
    "r": Interval(0.95, 1.05),
    "share": Interval(0.0, 1.0),
    "c": Interval(3.0, 3.0),
}


def end_of(a: float, b: float, s: float, h: float, r: float) -> float:
    return ((a + b * s) * math.exp(b * h / r) - a) / b


def test_the_end_lies_between_its_corners_and_no_wider() -> None:
    found = bound(growth(), BOX, 0.6, both=("end", "scaled", "total"))
    assert found is not None
    least, most = end_of(1.0, 0.4, 0.0, 0.5, 1.05), end_of(1.2, 0.6, 0.1, 0.55, 0.95)
    assert found.lower["end"] <= least
    assert most <= found.upper["end"]
    assert found.lower["end"] == pytest.approx(least, abs=2e-5)
    assert found.upper["end"] == pytest.approx(most, abs=2e-5)
    assert found.end.lo <= least
    assert most <= found.end.hi
    assert found.lower["total"] <= 0.5
    assert found.upper["total"] >= 0.55
    assert (found.lower["total"], found.upper["total"]) == pytest.approx((0.5, 0.55), abs=2e-5)
    assert found.lower["scaled"] == pytest.approx(
        3.0 * end_of(1.0, 0.4, 0.0, 0.5, 1.05) - 0.5, abs=2e-5
    )


def test_an_output_that_is_not_monotone_is_enclosed_and_cut_until_it_is_positive() -> None:
    """With s up to 0.4 the bowl's bottom is inside the box."""
    box = BOX | {"s": Interval(0.0, 0.4)}
    found = bound(growth(), box, 0.8, both=("bowl",))
    assert found is not None
    assert found.lower["bowl"] <= 0.0
    rng = np.random.default_rng(1)
    for _ in range(300):
        a, b, s, h, r, share = (rng.uniform(side.lo, side.hi) for side in list(box.values())[:6])
        value = (end_of(a, b, s, h, r) - 3.0 * s) ** 2 + share * (1 - share)
        assert found.lower["bowl"] <= value <= found.upper["bowl"]
    away = bound(growth(), BOX, 0.6, lower=("bowl",))
    assert away is not None
    assert 0.0 < away.lower["bowl"] <= (end_of(1.0, 0.4, 0.1, 0.5, 1.05) - 0.3) ** 2


def test_what_may_change_on_the_way_may_change() -> None:
    """r is 0.95 on some of the way and 1.05 on the rest: the end is still in its range."""
    found = bound(growth(), BOX, 0.6, both=("end",))
    assert found is not None
    for share in (0.2, 0.5, 0.8):
        half = end_of(1.0, 0.4, 0.0, 0.5 * share, 0.95)
        later = end_of(1.0, 0.4, half, 0.5 * (1 - share), 1.05)
        assert found.lower["end"] < later < found.upper["end"]


def test_an_integrand_that_depends_on_what_changes_in_both_senses_is_not_put_to_a_corner() -> None:
    """The integral of r (t - 1/2) over [0, 1] is 0 for every constant r, but not if r changes."""
    r, end, clock, total = (ca.SX.sym(name) for name in ("r", "end", "clock", "total"))
    of = implicit(
        "swing",
        {"r": r},
        {},
        ("r",),
        end,
        [(total, Quadrature(rate=r * (clock - 0.5), clock=clock, start=ca.SX(0), stop=end))],
        end - 1,
        {"total": total},
    )
    found = bound(of, {"r": Interval(-1.0, 1.0)}, 0.9, both=("total",))
    assert found is not None
    # r = 1 where t > 1/2 and -1 where t < 1/2: 1/4
    assert found.upper["total"] >= 0.25
    assert found.lower["total"] <= -0.25
    assert found.upper["total"] < 0.32


def test_what_changes_between_two_integrals_moves_both() -> None:
    """r acts one way on the first eighth of the way, and the other way on the rest of it."""
    r, end, clock, total, so_far = (
        ca.SX.sym(name) for name in ("r", "end", "clock", "total", "so_far")
    )
    rate, first = 1 + 0.125 * r, 0.125
    of = implicit(
        "two lengths",
        {"r": r},
        {},
        ("r",),
        end,
        [
            (total, Quadrature(rate=rate, clock=clock, start=ca.SX(0), stop=end)),
            (so_far, Quadrature(rate=rate, clock=clock, start=ca.SX(0), stop=first * end)),
        ],
        total - 1,
        {"so_far": so_far},
    )
    found = bound(of, {"r": Interval(-1.0, 1.0)}, 0.9, both=("so_far",))
    assert found is not None

    def until_there(before: float, after: float) -> float:
        whole = 1.0 / (first * (1 + 0.125 * before) + (1 - first) * (1 + 0.125 * after))
        return first * whole * (1 + 0.125 * before)

    assert found.upper["so_far"] >= until_there(1.0, -1.0)
    assert found.lower["so_far"] <= until_there(-1.0, 1.0)
    assert found.upper["so_far"] < 0.18


def test_slices_are_what_each_of_them_is_alone() -> None:
    slices = bound_slices(growth(), BOX, 0.6, "h", [(0.5, 0.525), (0.525, 0.55)], ("end",))
    assert len(slices) == 2
    assert slices[0].lower["end"] <= end_of(1.0, 0.4, 0.0, 0.5, 1.05)
    assert slices[0].upper["end"] >= end_of(1.2, 0.6, 0.1, 0.525, 0.95)
    assert slices[1].upper["end"] >= end_of(1.2, 0.6, 0.1, 0.55, 0.95)
    assert slices[0].lower["end"] == pytest.approx(end_of(1.0, 0.4, 0.0, 0.5, 1.05), abs=2e-5)
    assert slices[0].upper["end"] == pytest.approx(end_of(1.2, 0.6, 0.1, 0.525, 0.95), abs=2e-5)
    assert slices[1].upper["end"] == pytest.approx(end_of(1.2, 0.6, 0.1, 0.55, 0.95), abs=2e-5)


def test_what_is_bound_to_fail_is_given_up() -> None:
    assert bound(growth(), BOX, 0.6, lower=("scaled",), proofs_only=True) is not None
    negative = BOX | {"c": Interval(0.5, 0.5)}
    assert bound(growth(), negative, 0.6, lower=("scaled",), proofs_only=True) is None
    kept = bound(growth(), negative, 0.6, lower=("scaled",))
    assert kept is not None
    assert kept.lower["scaled"] < 0.0


def test_a_point_refutes_an_output_only_where_it_is_not_positive() -> None:
    """The output c end - h is least where the end is nearest, at the end 0.524 of h = 0.5."""
    box = {**BOX, "c": Interval.point(0.9)}
    point = failing_point(growth(), box, 0.6, ("total", "scaled"))
    assert point is not None
    at = {name: side.lo for name, side in point.items()}
    assert all(BOX[name].lo <= value <= BOX[name].hi for name, value in at.items())
    end = end_of(*(at[name] for name in ("a", "b", "s", "h", "r")))
    assert 0.9 * end - at["h"] < 0.0
    assert failing_point(growth(), {**BOX, "c": Interval.point(1.0)}, 0.6, ("scaled",)) is None


def test_ends_that_do_not_follow_a_parameter_one_way_are_all_found() -> None:
    """The end is 1 + p (1 - p): largest in the middle of the box, where its slope is nothing."""
    p, end, clock, total = (ca.SX.sym(name) for name in ("p", "end", "clock", "total"))
    of = implicit(
        "hill",
        {"p": p},
        {},
        (),
        end,
        [(total, Quadrature(rate=ca.SX(1) + 0 * clock, clock=clock, start=ca.SX(0), stop=end))],
        total - 1 - p * (1 - p),
        {"end": end},
    )
    found = bound(of, {"p": Interval(0.4, 0.6)}, 1.0, both=("end",))
    assert found is not None
    for bounds in (found.end, Interval(found.lower["end"], found.upper["end"])):
        assert bounds.lo <= 1.24
        assert bounds.hi >= 1.25
        assert bounds.width < 0.2


def test_no_end_is_no_bound() -> None:
    """The integral has a limit: with b < 0 it diverges before a + b t = 0, without one never ends."""
    flat = BOX | {"a": Interval(-0.1, 0.1)}
    assert bound(growth(), flat, 0.6, both=("end",)) is None
    infinite = BOX | {"h": Interval(0.5, math.inf)}
    assert bound(growth(), infinite, 0.6, both=("end",)) is None


def test_the_middle_in_plain_numbers() -> None:
    values = at_middle(growth(), BOX, 0.6)
    assert values["end"] == pytest.approx(end_of(1.1, 0.5, 0.05, 0.525, 1.0), abs=2e-5)


def test_dependence_through_the_end_is_seen() -> None:
    of = growth()
    uses = dict(zip(of.outputs, of.uses.tolist(), strict=True))
    assert uses["end"] == [True, True, True, True, True, False]
    assert uses["bowl"] == [True] * 6
