"""Bounds of second order hold every value, and are narrow where much is known of the variables together."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest

from meso_robust.bounds import Bounded, Curved, Interval, bounded, curved, enclose, enclose_where
from meso_robust.types import Floats

SHIFT = Interval.point(0.25)
SIDES = {"x": Interval(0.97, 1.03), "y": Interval(-0.35, -0.25), "z": Interval(0.27, 0.33)}
BOX = {**SIDES, "sum": Interval(0.99, 1.04), "shift": SHIFT}


def prepared() -> tuple[Bounded, Curved]:
    """Two curved functions of four variables, and x + y + z less the fourth."""
    names = ("x", "y", "z", "sum", "shift")
    at = ca.SX.sym("at", len(names))
    x, y, z, total, shift = ca.vertsplit(at)
    one = x * (x + y + z) + ca.sin(y) * shift * ca.sqrt(x + z)
    two = x * total - y * y + shift
    results = ca.vertcat(one, two, x + y + z - total)
    of = bounded("of", names, ca.Function("of", [at], [results]))
    return of, curved(of, {"shift"})


def drawn(count: int) -> Floats:
    """(N, 4) x, y, z where their sum is in its range, and the sum; their ends are drawn often."""
    lo, hi = (np.array([getattr(side, end) for side in SIDES.values()]) for end in ("lo", "hi"))
    share = np.clip(np.random.default_rng(3).uniform(-0.5, 1.5, (count, 3)), 0.0, 1.0)
    points = lo + share * (hi - lo)
    sums = points.sum(axis=1, keepdims=True)
    kept = (sums >= BOX["sum"].lo) & (sums <= BOX["sum"].hi)
    return np.hstack([points, sums])[kept[:, 0]]


def test_every_value_is_held() -> None:
    of, second = prepared()
    points = drawn(20_000)
    inputs = np.hstack([points, np.full((len(points), 1), SHIFT.lo)])
    values = np.array(of.function.map(len(inputs))(inputs.T))[:2]
    for side, own in zip(enclose_where(second, BOX), values, strict=True):
        assert side.lo <= own.min()
        assert own.max() <= side.hi
        assert side.width < 1.3 * float(np.ptp(own))


def test_what_is_nought_narrows_a_bound() -> None:
    of, second = prepared()
    loose = enclose(of, BOX, boxes=4096)
    close = enclose_where(second, BOX)
    assert close[0].width < 0.8 * loose[0].width


def test_what_was_told_to_be_exact_must_be() -> None:
    _, second = prepared()
    with pytest.raises(ValueError, match="shift"):
        enclose_where(second, {**BOX, "shift": Interval(0.0, 0.5)})


def test_nothing_is_claimed_where_a_root_may_not_be() -> None:
    _, second = prepared()
    found = enclose_where(second, {**BOX, "x": Interval(-1.0, 0.5)})
    assert not np.isfinite(found[0].hi)
