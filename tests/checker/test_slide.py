"""The turn between two round tips: formulas, barriers and forces against balance by elimination."""

from __future__ import annotations

import dataclasses
import itertools
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from flint import arb

from meso_robust.checker import grip as grips
from meso_robust.checker.dual import Dual, Remembered
from meso_robust.checker.grip import D, Drag, Grip, S, Sides
from meso_robust.checker.ranges import Box, Side, whole
from meso_robust.checker.rows import Boxes, boxes_of
from meso_robust.checker.slide import (
    STRETCH,
    Between,
    Cubic,
    Curve,
    Piece,
    Start,
    _Barrier,
    enclose,
    grip_of,
    least_leads,
)
from meso_robust.types import Floats
from tests.checker.balance import Held, Numbers
from tests.nightly import often

UM = 1e-6
Change = Callable[[Any], Any]


def side(low: float, high: float) -> Side:
    return arb(low), arb(high)


def dual(value: float) -> Dual:
    return Dual(arb(value))


def whatever(rng: np.random.Generator) -> Numbers:
    """A part, tips, drag and path that are far from ideal; lengths in units of about a mm."""
    return {
        "V": rng.uniform(1.0, 1.2),
        "depth": rng.uniform(0.3, 0.45),
        "depth_far": rng.uniform(0.3, 0.45),
        "radius": rng.uniform(0.0, 0.04),
        "radius_far": rng.uniform(0.0, 0.04),
        "tilt": rng.uniform(-0.1, 0.1),
        "drag_a": rng.uniform(-0.1, 0.1),
        "drag_n": rng.uniform(-0.1, 0.1),
        "rho": rng.uniform(0.2, 0.5),
        "stretch": rng.uniform(-0.2, 0.2),
        "shear": rng.uniform(-0.2, 0.2),
        "bend": rng.uniform(-0.05, 0.05),
    }


def grip_at(numbers: Numbers, h: float, ahead: float, tip: int) -> Grip:
    """The checker's, ahead of S or, by the same distance less T, of D."""
    sides = Sides(*(
        dual(numbers[name])
        for name in ("depth", "depth_far", "radius", "radius_far", "tilt", "drag_a", "drag_n")
    ))  # fmt: skip
    place = (dual(h), dual(numbers["V"]))
    found = Grip.at(sides, *place, S, dual(ahead), dual(numbers["bend"]))
    if tip == S:
        return found
    return Grip.at(sides, *place, D, dual(ahead) - found.T, dual(numbers["bend"]))


def off_balance(seed: int, tip: int) -> float:
    """By how much a formula differs at most from the balance."""
    rng = np.random.default_rng(seed)
    numbers = whatever(rng)
    h, ahead = rng.uniform(-0.4, 0.8), rng.uniform(0.1, 0.7)
    grip, held = grip_at(numbers, h, ahead, tip), Held.at(numbers, h, ahead)
    drag = Drag(*(dual(numbers[name]) for name in ("rho", "stretch", "shear")))
    mu = (rng.uniform(0.1, 0.3), rng.uniform(0.1, 0.3))
    own = {
        "c": (grip.c, held.edges[0][0]),
        "s": (grip.s, held.edges[0][1]),
        "D": (grip.D_place, held.contacts[D] @ held.edges[0]),
        "S": (grip.S_place, held.contacts[S] @ held.edges[1]),
    }
    for ways in itertools.product((-1, 1), (-1, 1)):
        motion = held.motion(ways, mu)
        assert motion is not None
        k, k_S = (dual(way * friction) for way, friction in zip(ways, mu, strict=True))
        forces = grip.forces(drag, k, k_S)
        leaning = held.edges[0] @ held.edges[1], held.normals[1] @ held.edges[0]
        across = (
            leaning[0] - ways[1] * mu[1] * leaning[1]
        )  # of S's force, along the pushed edge's n
        own |= {
            f"rate {ways}": (grip.rate(drag, k, k_S), held.rate(motion, tip)),
            f"D {ways}": (forces.moving / forces.divisor, motion[3]),
            f"S {ways}": (forces.resting / forces.divisor, motion[5] * across),
        }
    one, other = (held.motion(ways, mu) for ways in ((1, 1), (-1, 1)))
    assert one is not None
    assert other is not None
    for stuck in (D, S):  # the rate is linear in the slip
        slips = held.slip(one, stuck), held.slip(other, stuck)
        rates = held.rate(one, tip), held.rate(other, tip)
        level = rates[0] - slips[0] * (rates[1] - rates[0]) / (slips[1] - slips[0])
        own[f"stick {stuck}"] = grip.stick(stuck), level
    return max(abs(float(found.value) - by_hand) for found, by_hand in own.values())


@pytest.mark.parametrize("tip", [D, S])
@pytest.mark.parametrize("seed", range(20))
def test_formulas_are_those_of_the_balance(seed: int, tip: int) -> None:
    assert off_balance(seed, tip) < 1e-11


def _sign(of: str) -> Change:
    return lambda value: dataclasses.replace(value, **{of: -getattr(value, of)})


@pytest.mark.parametrize("field", ["f", "g", "p", "r", "e_moving", "e_resting", "level_moving", "level_resting", "tilt"])  # fmt: skip
def test_a_sign_that_is_wrong_is_noticed(field: str, monkeypatch: pytest.MonkeyPatch) -> None:
    right = Grip.at.__func__  # type: ignore[attr-defined]
    monkeypatch.setattr(grips.Grip, "at", classmethod(lambda *args: _sign(field)(right(*args))))
    assert max(off_balance(seed, tip) for seed in range(2) for tip in (D, S)) > 1e-3


def test_slopes_are_those_of_differences() -> None:
    rng = np.random.default_rng(3)
    numbers = {**whatever(rng), "ahead": 0.4}
    step = 1e-6

    def grip(at: Numbers, tip: int) -> Grip:
        point = {name: Dual(arb(value), {name: arb(1)}) for name, value in at.items()}
        h = Dual(arb(at["h"]), {"h": arb(1)})
        return grip_of(point, h, tip, point["ahead"] - (0 if tip == S else 1))

    there = {**numbers, "h": 0.3}
    for tip, field, name in itertools.product((D, S), ("c", "s", "T"), ("h", "V", "depth", "tilt", "ahead")):  # fmt: skip
        ends = (
            float(getattr(grip({**there, name: there[name] + sign * step}, tip), field).value)
            for sign in (-1, 1)
        )
        low, high = ends
        slope = float(getattr(grip(there, tip), field).slopes[name])
        assert slope == pytest.approx((high - low) / (2 * step), abs=1e-7)


POINTS: dict[str, tuple[float, float]] = {
    "V": (900 * UM, 912 * UM),
    "Z": (240 * UM, 260 * UM),
    "depth": (418.5 * UM, 418.5 * UM),
    "depth_far": (418.5 * UM, 418.5 * UM),
    "radius": (0.0, 0.0),
    "radius_far": (0.0, 0.0),
    "rho": (3.6e-7, 3.9e-7),
    "mu": (0.30, 0.36),
}
ROUND = {
    **POINTS,
    "V": (1010 * UM, 1012 * UM),
    "Z": (249 * UM, 251 * UM),
    "depth": (418.3 * UM, 418.7 * UM),
    "depth_far": (418.3 * UM, 418.7 * UM),
    "radius": (4.0 * UM, 6.0 * UM),
    "radius_far": (2.0 * UM, 4.0 * UM),
    "tilt": (-2e-4, 2e-4),
    "drag_a": (-2 * UM, 2 * UM),
    "drag_n": (-2 * UM, 2 * UM),
    "stretch": (-0.002, 0.002),
    "shear": (-0.002, 0.002),
    "stray": (-1 * UM, 1 * UM),
    "bend": (-0.01, 0.01),
    "mu_lower": (0.32, 0.33),
    "mu_passive": (0.33, 0.34),
}
del ROUND["mu"]
MOVING = {**POINTS, "centre_a": (-8 * UM, 8 * UM), "centre_n": (-8 * UM, 8 * UM)}
H, H_END = (770 * UM, 776 * UM), (-320 * UM, -300 * UM)


def box_of(ranges: dict[str, tuple[float, float]]) -> Box:
    ends = {name: (arb(low), arb(high)) for name, (low, high) in ranges.items()}
    return {n: e if ranges[n][0] < ranges[n][1] else (e[0], e[0]) for n, e in ends.items()}


def first(at: Any, h: Any) -> Any:
    """How far the part is ahead of S when it is ``Z`` above it."""
    grip = grip_of({**at, "stray": h * 0}, h, S, h * 0)
    return (at["Z"] + grip.out_resting * grip.c) / grip.s


def start_in(box: Box, h: tuple[float, float]) -> Start:
    """Turns that begin anywhere in a range of h."""
    return Start(
        {**box, "h": side(*h)},
        lambda at, barrier: barrier(at["h"])[0] - first(at, at["h"]),
        lambda at: at,
        side(*h),
    )


def tube_of(ranges: dict[str, tuple[float, float]]) -> tuple[Piece, ...]:
    box = box_of(ranges)
    return enclose(box, [start_in(box, H)], side(*H), side(*H_END))


@pytest.fixture(scope="module")
def tubes() -> dict[str, tuple[Piece, ...]]:
    return {"points": tube_of(POINTS), "round": tube_of(ROUND), "moving": tube_of(MOVING)}


@pytest.mark.parametrize(
    ("name", "ranges"), [("points", POINTS), ("round", ROUND), ("moving", MOVING)]
)
def test_motions_stay_between_the_barriers(
    name: str, ranges: dict[str, tuple[float, float]], tubes: dict[str, tuple[Piece, ...]]
) -> None:
    """Friction, drag and path at the ends of their ranges, changed on the way."""
    rng, step, seen = np.random.default_rng(0), 3 * UM, []
    instants = [
        n
        for n in (
            *("rho", "stretch", "shear", "bend", "mu", "mu_lower", "mu_passive"),
            *("centre_a", "centre_n"),
        )
        if n in ranges
    ]
    for run in range(often(4, 12)):
        numbers = {n: float(rng.choice(ends)) for n, ends in ranges.items()}
        numbers["stray"] = 0.0
        h = float(rng.uniform(*H))
        ahead = float(first({n: dual(v) for n, v in numbers.items()}, dual(h)).value)
        for piece in tubes[name]:
            while piece.last < h <= piece.first:
                at = {n: dual(v) for n, v in numbers.items() if n in ranges}
                low, high = (
                    float((-piece.grip_at(dual(h), {**at, "share": dual(share)}).b).value)
                    for share in (0.0, 1.0)
                )
                assert low - 1e-8 <= ahead <= high + 1e-8
                centre = {f"drag_{n[-1]}": numbers[n] for n in instants if n.startswith("centre")}
                held = Held.at({**numbers, **centre}, h, ahead)
                mu = (numbers.get("mu", 0.0) or numbers["mu_lower"], numbers.get("mu", 0.0) or numbers["mu_passive"])  # fmt: skip
                ahead += step * held.rate(held.motions(mu)[0], S)
                h -= step
                if "bend" in numbers:
                    strayed = numbers["stray"] - step * numbers["bend"]
                    if abs(strayed) > ranges["stray"][1]:
                        numbers["bend"] *= -1
                    else:
                        numbers["stray"] = strayed
                if run % 3 == 0 and rng.uniform() < 0.05:
                    numbers |= {n: float(rng.choice(ranges[n])) for n in instants if n != "bend"}
        seen.append((ahead - low) / (high - low))
    assert max(seen) - min(seen) > 0.2  # the tube is not much wider than what is seen


@pytest.mark.parametrize("which", [-1, 1])
@pytest.mark.parametrize(("pieces", "like"), [(1, (0,)), (4, (0,)), (1, (0, 0, 0)), (3, (0, 1, 0))])
def test_every_piece_holds_the_turns_that_begin_on_it(
    which: int, pieces: int, like: tuple[int, ...]
) -> None:
    """Turns may begin over a way that is cut into pieces; that an earlier piece goes on says nothing."""
    box, early = box_of(POINTS), 660 * UM
    parts = itertools.pairwise(np.linspace(H[1], early, len(like) + 1).tolist())
    starts = [
        dataclasses.replace(start_in(box, (low, high)), like=kind)
        for (high, low), kind in zip(parts, like, strict=True)
    ]
    barrier = _Barrier(box, starts, which)
    knots = [*np.linspace(H[1], early, pieces + 1).tolist(), 600 * UM, 500 * UM]
    legs = barrier._path(knots, {})
    curves = barrier._curves(legs, np.full(len(legs), 1e-5))
    rng = np.random.default_rng(0)
    for run in range(200):
        at = {n: dual(float(rng.choice(ends))) for n, ends in POINTS.items()}
        h = float(rng.uniform(early, H[1])) if run % 2 else early
        curve = next(one for one in curves if one.last <= h <= one.first)
        beyond = curve.at(curve.done(dual(h)), at) - first(at, dual(h))
        assert (beyond * which).value > 0


@pytest.mark.parametrize("name", ["round", "moving"])
def test_grips_of_many_pieces_are_those_of_each(
    name: str, tubes: dict[str, tuple[Piece, ...]]
) -> None:
    """Values and slopes in arrays hold those in balls: at points, over boxes and at their middles."""
    ranges = {**{"round": ROUND, "moving": MOVING}[name], "done": (0.1, 0.8), "share": (0.2, 0.9)}
    rng = np.random.default_rng(1)
    assert any(one.first < one.lower.first for one in tubes[name])  # shorter than its curve
    told = [(one.lower.tip, one.upper.tip) for one in tubes[name]]
    assert {(D, D), (S, S)} < set(told)  # and some whose barriers are ahead of unlike tips
    for tips in set(told):
        pieces = [one for one, own in zip(tubes[name], told, strict=True) if own == tips]
        between, (boxes, exact) = Between(pieces), boxes_of(box_of(ranges), len(pieces))
        places = {n: k for k, n in enumerate(boxes.names)}
        low, high = boxes.low, boxes.high
        at = low + rng.random(low.shape) * (high - low)
        for wide in (False, True):
            some = Boxes(boxes.names, low, high) if wide else Boxes(boxes.names, at, at)
            which = np.tile(np.arange(len(pieces)), 2)
            many = between.grip({**exact, **some.points()}, places, which)
            middle = np.clip(0.5 * (some.low + some.high), some.low, some.high)
            for k, place in enumerate(np.hstack([at, middle]).T):  # a column each, as in rows
                point = {n: Dual(whole(ends)) for n, ends in box_of(ranges).items()}
                point |= {n: Dual(arb(float(place[j])), {n: arb(1)}) for n, j in places.items()}
                one = pieces[k % len(pieces)].grip(point)
                for of in ("T", "s", "b", "D_place"):
                    rows, true = getattr(many, of), getattr(one, of)
                    assert held_by(rows.ends[:, k], true.value), (of, k)
                    for n, slope in true.slopes.items() if k < len(pieces) else ():
                        assert held_by(rows.slopes()[:, places[n], k], slope), (of, k, n)


def held_by(ends: Floats, value: arb) -> bool:
    """Whether ends as in :class:`Rows` hold a number of which a ball is known, as far as the ball tells."""
    return bool(-ends[0] <= value.upper() and value.lower() <= ends[1])


@pytest.mark.parametrize("end", ["lower", "upper"])
@pytest.mark.parametrize("name", ["points", "round", "moving"])
def test_curves_go_on_where_the_last_one_ends(
    name: str, end: str, tubes: dict[str, tuple[Piece, ...]]
) -> None:
    """Or beyond it, at all corners of the constants that were drawn, whichever tip they are ahead of."""
    ranges = {"points": POINTS, "round": ROUND, "moving": MOVING}[name]
    curves = list({getattr(one, end).key: getattr(one, end) for one in tubes[name]}.values())
    assert len(curves) > 2 * STRETCH
    rng, sign = np.random.default_rng(2), 1 if end == "upper" else -1
    drawn = [{n: dual(float(rng.choice(e))) for n, e in ranges.items()} for _ in range(20)]
    for before, after in itertools.pairwise(curves):
        assert before.last == after.first
        for numbers in drawn:
            at = {**numbers, "stray": numbers.get("stray", dual(0.0))}
            old, new = (
                -grip_of(at, dual(before.last), one.tip, one.at(dual(done), at)).b
                for one, done in ((before, 1.0), (after, 0.0))
            )
            assert float((new - old).value) * sign > -1e-15


@pytest.mark.parametrize(("ends", "told"), [((0.1, 0.1), set()), ((0.1, 0.2), {"V"})])
def test_a_label_that_grows_with_a_number_has_no_slope_along_it(
    ends: tuple[float, float], told: set[str]
) -> None:
    """Of a single run a label varies by rounding alone, and what it grows with not at all."""
    box = box_of(POINTS)
    start = start_in(box, H)
    own = {**start.box, **box_of({"theta": ends})}
    start = dataclasses.replace(start, box=own, labels={"V": "theta"})
    assert set(_Barrier(box, [start], 1)._labelled([H[1], H[0]])) == told


def test_the_tube_is_hardly_wider_than_the_motions(tubes: dict[str, tuple[Piece, ...]]) -> None:
    last = tubes["points"][-1]
    middle = {n: dual((low + high) / 2) for n, (low, high) in POINTS.items()}
    low, high = (
        float((-last.grip({**middle, "done": dual(1.0), "share": dual(share)}).b).value)
        for share in (0.0, 1.0)
    )
    assert high - low < 12 * UM


def test_a_point_remembers_the_grip_of_each_piece(tubes: dict[str, tuple[Piece, ...]]) -> None:
    first, last = tubes["points"][0], tubes["points"][-1]
    middle = {n: dual((low + high) / 2) for n, (low, high) in POINTS.items()}
    point = Remembered({**middle, "done": dual(0.5), "share": dual(0.5)})
    for piece in (first, last, first):
        afresh = piece.grip_at(piece.h(point["done"]), point)
        assert piece.grip(point).b.value.overlaps(afresh.b.value)
    assert first.grip(point) is first.grip(point)


@pytest.mark.parametrize("which", [-1, 1])
def test_a_curve_that_motions_overtake_is_no_barrier(which: int) -> None:
    box = box_of({**POINTS, "V": (905 * UM, 906 * UM), "Z": (250 * UM, 250 * UM)})
    h, ahead = 500 * UM, 80 * UM
    numbers = {n: (low + high) / 2 for n, (low, high) in POINTS.items()}
    held = Held.at(numbers, h, ahead)
    rate = held.rate(held.motions((0.33, 0.33))[0], S)
    for lead, is_one in ((0.1, True), (-0.1, False)):
        cubic = Cubic((ahead, (rate + which * lead) * 10 * UM, 0.0, 0.0))
        curve = Curve(h, h - 10 * UM, S, cubic, {}, numbers)
        leads, _ = least_leads([curve], {**box, "done": side(0.0, 1.0)}, which)
        assert bool(leads[0] > 0) is is_one


def test_a_cubic_of_a_ball_holds_its_values_and_slopes() -> None:
    cubic, low, high = Cubic((0.3, -1.2, 2.5, -0.7)), -0.4, 0.9
    found = cubic(Dual(arb(low).union(arb(high)), {"x": arb(2)}))
    assert set(found.slopes) == {"x"}
    for x in np.linspace(low, high, 21):
        assert found.value.contains(cubic(arb(x)).mid())
        assert found.slopes["x"].contains(2 * (-1.2 + 5.0 * x - 2.1 * x * x))
