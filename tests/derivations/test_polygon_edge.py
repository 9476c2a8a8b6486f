"""Edges of polygons against geometry by hand and by brute force."""

from __future__ import annotations

import math
from collections.abc import Callable
from fractions import Fraction

import numpy as np
import pytest
import sympy as sp

from derivations import polygon_edge, symmetries
from derivations._claim import Claim, Verdict
from derivations._derivation import Derivation, Function
from derivations._statement import DerivationError
from derivations.mechanics import d1, d2, n, rho

Point = tuple[float, float]
HALF_LENGTH, HALF_WIDTH = 808.0, 418.5
RECTANGLE = [(-808.0, -418.5), (808.0, -418.5), (808.0, 418.5), (-808.0, 418.5)]
PENTAGON = [(-700.0, -300.0), (500.0, -450.0), (900.0, 50.0), (200.0, 520.0), (-650.0, 310.0)]


@pytest.fixture(scope="module")
def derived() -> Derivation:
    return polygon_edge.derive()


@pytest.fixture(scope="module")
def claims(derived: Derivation) -> dict[str, Claim]:
    return {claim.key: claim for claim in derived.claims}


def test_all_claims_are_new(claims: dict[str, Claim]) -> None:
    assert {key: claim.verdict for key, claim in claims.items()} == dict.fromkeys(
        (
            "polygon-edge-frame",
            "polygon-edge-distance",
            "polygon-edge-conditions",
            "polygon-edge-end",
            "rectangle-edges",
            "polygon-edge-two-points",
            "polygon-even-film",
        ),
        Verdict.NEW,
    )


def call(function: Function, *values: float | Fraction | sp.Expr) -> tuple[sp.Expr, ...]:
    at = dict(zip(function.arguments, values, strict=True))
    return tuple(result.subs(at) for result in function.results)


@pytest.fixture(scope="module")
def functions(derived: Derivation) -> dict[str, Function]:
    return dict(derived.functions)


def test_a_3_4_5_edge_by_hand(functions: dict[str, Function]) -> None:
    """From (5, 0) to (5 - 3, 4), the line 4 x + 3 y = 20 at distance 4."""
    assert call(functions["edge_direction"], 5, 0, 2, 4) == (sp.Rational(-3, 5), sp.Rational(4, 5))
    # feet: (5, 0) . a = -3; (2, 4) . a = 2
    assert call(functions["edge_offsets"], 5, 0, 2, 4) == (4, -3, 2)
    assert functions["edge_direction"].unit == "1"
    assert functions["edge_offsets"].unit == "m"


def test_an_edge_of_vertices_takes_plain_arithmetic(functions: dict[str, Function]) -> None:
    for name in ("edge_direction", "edge_offsets"):
        for result in functions[name].results:
            assert not result.atoms(sp.Function)
            powers = {power.exp for power in result.atoms(sp.Pow)}
            assert powers <= {2, sp.Rational(1, 2), sp.Rational(-1, 2)}


@pytest.mark.parametrize("corners", [RECTANGLE, PENTAGON])
def test_frame_by_distances(functions: dict[str, Function], corners: list[Point]) -> None:
    """d1 is the least distance of the edge's line; points of the edge are d2 a + d1 n."""
    for p, q in zip(corners, corners[1:] + corners[:1], strict=True):
        c, s = map(float, call(functions["edge_direction"], *p, *q))
        depth, first, last = map(float, call(functions["edge_offsets"], *p, *q))
        line = [np.hypot(*(np.add(p, t * np.subtract(q, p)))) for t in np.linspace(-3, 4, 20_001)]
        assert depth == pytest.approx(min(line), rel=1e-5)
        assert depth > 0  # the origin is inside
        assert last - first == pytest.approx(math.dist(p, q))
        for share in (0.0, 0.3, 1.0):
            offset = first + share * (last - first)
            point = np.array([offset * c + depth * s, offset * s - depth * c])
            assert point == pytest.approx(np.add(p, share * np.subtract(q, p)))


def test_rectangle_by_hand(functions: dict[str, Function]) -> None:
    found = [
        tuple(map(float, call(functions["edge_offsets"], *p, *q)))
        for p, q in zip(RECTANGLE, RECTANGLE[1:] + RECTANGLE[:1], strict=True)
    ]
    long, short = (HALF_WIDTH, -HALF_LENGTH, HALF_LENGTH), (HALF_LENGTH, -HALF_WIDTH, HALF_WIDTH)
    assert found == [long, short, long, short]


def test_push_of_a_turned_polygon(functions: dict[str, Function]) -> None:
    """The turn at every edge: solved in the world, and by d1, d2 and the direction."""
    turn, ratio = 0.4, 250_000.0
    rotation = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
    lever = sp.lambdify((*symmetries.Q, d1, d2, rho), symmetries.sticking_at().turning)
    for p, q in zip(PENTAGON, PENTAGON[1:] + PENTAGON[:1], strict=True):
        place = rotation @ np.add(p, 0.4 * np.subtract(q, p))
        c, s = map(float, call(functions["edge_direction"], *p, *q))
        depth, first, last = map(float, call(functions["edge_offsets"], *p, *q))
        angle, offset = turn + math.atan2(s, c), first + 0.4 * (last - first)
        by_edge = lever(np.cos(angle), np.sin(angle), depth, offset, ratio)
        # in the world: film drag balances a force at the contact, which moves with the tip
        at_contact = np.array([[1, 0, -place[1]], [0, 1, place[0]]])
        yielding = np.diag([1, 1, 1 / ratio]) @ at_contact.T
        twist = yielding @ np.linalg.solve(at_contact @ yielding, [-1.0, 0.0])
        assert twist[2] == pytest.approx(by_edge / (ratio + depth**2 + offset**2))


def test_film_by_many_points(claims: dict[str, Claim]) -> None:
    """Force and moment of a triangle's film at many random points; and the rectangle's rho."""
    assert f"{(1616**2 + 837**2) / 12 / 1e6:.4f} mm²" in claims["polygon-even-film"].derived
    p, q, twist = (3.0, 1.0), (1.0, 4.0), np.array([0.3, -0.7, 0.9])
    at = dict(zip(sp.symbols("v_x v_y omega", real=True), twist, strict=True))
    at |= dict(zip(sp.symbols("x0 y0 x1 y1", real=True), (*p, *q), strict=True))
    force, moment = polygon_edge._drag_of_triangle()
    found = np.array([*map(float, force.subs(at)), float(moment.subs(at))])
    share = np.random.default_rng(5).dirichlet((1, 1, 1), 400_000)  # even over a triangle
    place = np.outer(share[:, 0], p) + np.outer(share[:, 1], q)
    area = (3 * 4 - 1 * 1) / 2
    flow = twist[:2] + twist[2] * np.stack([-place[:, 1], place[:, 0]], axis=1)
    spin = place[:, 0] * flow[:, 1] - place[:, 1] * flow[:, 0]
    assert found == pytest.approx(area * np.array([*flow.mean(axis=0), spin.mean()]), rel=0.01)


@pytest.mark.parametrize("misaligned", [0.0, 0.2, -0.2])
def test_which_edges_take_two_tips(functions: dict[str, Function], misaligned: float) -> None:
    """All pairs of places on a grid against the claim ``u < -d1 tan(beta) < v``."""
    corners = [tuple(map(float, corner)) for corner in polygon_edge.OBTUSE]
    verdicts = []
    for p, q in zip(corners, corners[1:] + corners[:1], strict=True):
        depth, first, last = map(float, call(functions["edge_offsets"], *p, *q))
        places = np.linspace(first, last, 203)[1:-1]
        # the drag's line through the centre meets the edge's line here: it must pass between
        foot = -depth * math.tan(misaligned)
        possible = bool(np.any(places < foot) and np.any(places > foot))
        forces = (_balance(depth, misaligned, x, y) for x in places for y in places if x > y)
        found = any(min(pair) > 0 for pair in forces)
        assert found == possible == (first < foot < last)
        verdicts.append(found)
    assert not all(verdicts)
    assert any(verdicts)


def _balance(depth: float, misaligned: float, x: float, y: float) -> tuple[float, float]:
    """Normal forces of tips at x > y along the edge; drag of 1 against the push, at the centre."""
    drag_along, drag_in = math.sin(misaligned), math.cos(misaligned)
    # moments about the tip at y, then about the tip at x, of the drag at (0, -depth) of the edge
    return (
        (-y * drag_in - depth * drag_along) / (x - y),
        (x * drag_in + depth * drag_along) / (x - y),
    )


@pytest.mark.parametrize(
    ("name", "wrong"),
    [
        ("film", lambda twist: sp.diag(1, 3, rho) * twist),
        ("cross", lambda p, q: p[0] * q[1] + p[1] * q[0]),
        ("n", -n),
        ("two_points", lambda top: (top, top, top)),
    ],
)
def test_a_wrong_ingredient_is_noticed(
    monkeypatch: pytest.MonkeyPatch, name: str, wrong: Callable[..., object]
) -> None:
    monkeypatch.setattr(polygon_edge, name, wrong)
    with pytest.raises(DerivationError):
        polygon_edge.derive()
