"""Other engines of rigorous bounds on the inequality of ``ratio``."""

from collections.abc import Callable
from dataclasses import dataclass
from importlib.metadata import PackageNotFoundError, version
from importlib.util import find_spec
from typing import Any

import numpy as np
import numpy.typing as npt

from reports.benchmarks.ratio import BOX, NOMINAL, THRESHOLD, random_boxes

F = npt.NDArray[np.float64]
Ends = tuple[tuple[float, float], ...]
WHOLE: Ends = tuple((side.lo, side.hi) for side in BOX)


@dataclass(frozen=True, slots=True, kw_only=True)
class Peer:
    """What is timed of one engine."""

    name: str
    evaluate: Callable[[], object] | None
    """Natural extension over ``count`` boxes."""
    count: int
    prove: Callable[[], tuple[str, int]] | None
    """Verdict and number of boxes."""


def _ratio(d1: Any, d2: Any, rho: Any, c: Any, s: Any) -> Any:
    """lambda_n/lambda_t of eq. (5), the tangential force counted positive."""
    product = d1 * d2
    return (product * c + (rho + d1 * d1) * s) / ((rho + d2 * d2) * c + product * s)


def _halves(box: Ends) -> tuple[Ends, Ends]:
    """The box bisected across the side that is widest relative to the whole."""
    shares = [(b - a) / (q - p) for (a, b), (p, q) in zip(box, WHOLE, strict=True)]
    k = shares.index(max(shares))
    a, b = box[k]
    middle = 0.5 * (a + b)
    return (*box[:k], (a, middle), *box[k + 1 :]), (*box[:k], (middle, b), *box[k + 1 :])


def _bisect(lower: Callable[[Ends], float]) -> tuple[str, int]:
    todo, boxes = [WHOLE], 0
    while todo:
        box = todo.pop()
        boxes += 1
        if not lower(box) > THRESHOLD.hi:
            todo += _halves(box)
    return "PROVED", boxes


def _one_by_one(name: str, lower: Callable[[Ends], float], count: int) -> Peer:
    low, high = random_boxes(count)
    boxes: list[Ends] = [
        tuple(zip(a.tolist(), b.tolist(), strict=True)) for a, b in zip(low, high, strict=True)
    ]
    return Peer(
        name=name,
        evaluate=lambda: [lower(box) for box in boxes],
        count=count,
        prove=lambda: _bisect(lower),
    )


def flint() -> Peer:
    """Arb's balls."""
    from flint import arb

    def lower(box: Ends) -> float:
        d1, d2, rho, theta = (arb(a).union(arb(b)) for a, b in box)
        return float(_ratio(d1, d2, rho, theta.cos(), theta.sin()).lower())

    return _one_by_one("python-flint (Arb), 53 bits", lower, 5000)


def mpmath() -> Peer:
    """The intervals of mpmath."""
    from mpmath import iv  # type: ignore[import-untyped]

    def lower(box: Ends) -> float:
        d1, d2, rho, theta = (iv.mpf(side) for side in box)
        return float(_ratio(d1, d2, rho, iv.cos(theta), iv.sin(theta)).a)

    return _one_by_one("mpmath.iv, 53 bits", lower, 500)


def codac() -> Peer:
    """Codac's intervals."""
    from codac import Interval, cos, sin  # type: ignore[import-not-found,unused-ignore]

    def lower(box: Ends) -> float:
        d1, d2, rho, theta = (Interval(a, b) for a, b in box)
        return float(_ratio(d1, d2, rho, cos(theta), sin(theta)).lb())

    return _one_by_one("codac, intervals", lower, 5000)


def intvalpy() -> Peer:
    """The intervals of intvalpy."""
    import intvalpy as ip  # type: ignore[import-not-found,unused-ignore]

    def lower(box: Ends) -> float:
        d1, d2, rho, theta = (ip.Interval(a, b) for a, b in box)
        return float(_ratio(d1, d2, rho, ip.cos(theta), ip.sin(theta)).a)

    return _one_by_one("intvalpy", lower, 2000)


class _Pairs:
    """Arrays of intervals, every result moved outward by one double."""

    def __init__(self, lo: F, hi: F) -> None:
        self.lo, self.hi = np.nextafter(lo, -np.inf), np.nextafter(hi, np.inf)

    def __add__(self, other: "_Pairs") -> "_Pairs":
        return _Pairs(self.lo + other.lo, self.hi + other.hi)

    def __mul__(self, other: "_Pairs") -> "_Pairs":
        ends = [x * y for x in (self.lo, self.hi) for y in (other.lo, other.hi)]
        return _Pairs(np.minimum.reduce(ends), np.maximum.reduce(ends))

    def __truediv__(self, other: "_Pairs") -> "_Pairs":
        return self * _Pairs(1.0 / other.hi, 1.0 / other.lo)  # positive here


def numpy() -> Peer:
    """NumPy with nextafter, all boxes at once."""
    low, high = random_boxes(100_000)

    def lower(lo: F, hi: F) -> F:
        d1, d2, rho = (_Pairs(lo[:, k], hi[:, k]) for k in range(3))
        # the angle lies between pi/2 and pi: both fall
        c = _Pairs(np.cos(hi[:, 3]), np.cos(lo[:, 3]))
        s = _Pairs(np.sin(hi[:, 3]), np.sin(lo[:, 3]))
        return np.asarray(_ratio(d1, d2, rho, c, s).lo)

    def prove() -> tuple[str, int]:
        lo, hi = np.array([[side[0] for side in WHOLE]]), np.array([[side[1] for side in WHOLE]])
        width, boxes = (hi - lo)[0], 0
        while lo.size:
            boxes += len(lo)
            open_ = ~(lower(lo, hi) > THRESHOLD.hi)
            lo, hi = lo[open_], hi[open_]
            side = np.argmax((hi - lo) / width, axis=1)
            rows = np.arange(len(lo))
            middle = 0.5 * (lo[rows, side] + hi[rows, side])
            left, right = hi.copy(), lo.copy()
            left[rows, side] = right[rows, side] = middle
            lo, hi = np.concatenate([lo, right]), np.concatenate([left, hi])
        return "PROVED", boxes

    return Peer(
        name="NumPy and nextafter, in bulk",
        evaluate=lambda: lower(low, high),
        count=len(low),
        prove=prove,
    )


def z3() -> Peer:
    """z3's decision of polynomial inequalities, over the circle."""
    from fractions import Fraction

    import z3 as smt

    def prove() -> tuple[str, int]:
        d1, d2, rho, c, s = smt.Reals("d1 d2 rho c s")
        solver = smt.Tactic("qfnra-nlsat").solver()
        solver.set("timeout", 20_000)
        shares = Fraction("0.98"), Fraction("1.02")
        ends = [(value * shares[0], value * shares[1]) for value in NOMINAL[:3]]
        cosines = [float(np.cos(end)) for end in WHOLE[3]]
        # whole multiples of 1e-7: long fractions would only slow the solver
        ends.append(
            (
                Fraction(int(np.floor(min(cosines) * 1e7 - 1)), 10**7),
                Fraction(int(np.ceil(max(cosines) * 1e7 + 1)), 10**7),
            )
        )
        for symbol, (low, high) in zip((d1, d2, rho, c), ends, strict=True):
            solver.add(symbol >= smt.Q(low.numerator, low.denominator))
            solver.add(symbol <= smt.Q(high.numerator, high.denominator))
        solver.add(c * c + s * s == 1, s > 0)
        least = smt.Q(33581, 10000)
        product = d1 * d2
        num = product * c + (rho + d1 * d1) * s
        solver.add(num <= least * ((rho + d2 * d2) * c + product * s))
        answer = solver.check()
        return ("PROVED" if answer == smt.unsat else str(answer)), 1

    return Peer(name="z3, nlsat", evaluate=None, count=0, prove=prove)


PEERS: tuple[Callable[[], Peer], ...] = (numpy, flint, codac, intvalpy, mpmath, z3)
_MODULES = {"flint": "python-flint", "mpmath": "mpmath", "z3": "z3-solver", "numpy": "numpy"}


def missing(make: Callable[[], Peer]) -> str | None:
    """Name of the package if it is not installed."""
    name = make.__name__
    return None if find_spec(name) is not None else name


def versions() -> list[str]:
    """Names and versions of what is timed."""
    found = []
    for make in PEERS:
        package = _MODULES.get(make.__name__, make.__name__)
        try:
            found.append(f"{package} {version(package)}")
        except PackageNotFoundError:
            continue
    return found
