"""Edges of polygons in intervals, against rational arithmetic and balls of many digits."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
from flint import arb, ctx, fmpq

from meso_robust.bounds import HALF_PI, Interval
from meso_robust.errors import NotApplicableError
from meso_robust.primitives.outline import Edge, Polygon, _direction, outline_of
from meso_robust.task import PolygonPart

Corners = list[tuple[float, float]]
STAR: Corners = [
    (400.0, 0.0), (90.0, 90.0), (0.0, 400.0), (-90.0, 90.0), (-400.0, 0.0), (-90.0, -90.0),
    (0.0, -400.0), (90.0, -90.0),
]  # fmt: skip
L: Corners = [(-440, -440), (760, -440), (760, -40), (-40, -40), (-40, 760), (-440, 760)]


def random_convex(rng: np.random.Generator, count: int) -> Corners:
    """Corners on an ellipse, decimals of a tenth of a micrometre; of 4, with edges along the axes."""
    angles = 2.0 * np.pi * (np.arange(count) + rng.uniform(0.1, 0.5, count)) / count
    x, y = 900.0 * np.cos(angles), 500.0 * np.sin(angles)
    found = [(round(float(a), 1), round(float(b), 1)) for a, b in zip(x, y, strict=True)]
    box = [(-1000.3, -600.1), (1000.7, -600.1), (1000.7, 600.9), (-1000.3, 600.9)]
    return box if count == 4 else found


def polygon(corners: Corners) -> Polygon:
    found = outline_of(PolygonPart(polygon_um=tuple(corners)))
    assert isinstance(found, Polygon)
    return found


def metres(corners: Corners) -> list[tuple[Fraction, Fraction]]:
    return [
        (Fraction(repr(float(x))) / 10**6, Fraction(repr(float(y))) / 10**6) for x, y in corners
    ]


def holds_ratio(side: Interval, top: Fraction, square: Fraction) -> bool:
    """Whether top/sqrt(square) lies in the side and the side is tight, in rational numbers."""

    def below(end: float) -> bool:  # end <= top/sqrt(square), by comparing squares with their signs
        low = Fraction(end)
        if (low < 0) != (top < 0):
            return low < 0
        smaller = low**2 * square <= top**2
        return smaller if top >= 0 else not smaller or low**2 * square == top**2

    return below(side.lo) and not below(np.nextafter(side.hi, np.inf)) and side.width < 2e-17


def check_edge(edge: Edge, p: tuple[Fraction, Fraction], q: tuple[Fraction, Fraction]) -> None:
    along = (q[0] - p[0], q[1] - p[1])
    square = along[0] ** 2 + along[1] ** 2
    assert holds_ratio(edge.depth, p[0] * q[1] - p[1] * q[0], square)
    assert holds_ratio(edge.first, p[0] * along[0] + p[1] * along[1], square)
    assert holds_ratio(edge.last, q[0] * along[0] + q[1] * along[1], square)
    with ctx.workprec(200):
        x, y = (arb(fmpq(side.numerator, side.denominator)) for side in along)
        off = (arb.atan2(y, x) + arb(edge.turn.lo)) / (2 * arb.pi())
        direction = arb.atan2(y, x) - 2 * arb.pi() * round(float(off.mid()))
        assert arb(edge.turn.lo) <= -direction <= arb(edge.turn.hi)
    assert edge.turn.width < 1e-14


@pytest.mark.parametrize("count", [3, 4, 6, 11])
def test_every_edge_of_a_convex_polygon_is_enclosed_tightly(count: int) -> None:
    corners = random_convex(np.random.default_rng(count), count)
    found, exact = polygon(corners), metres(corners)
    assert len(found.edges) == len(found.lines) == count
    for edge in found.edges:
        k = int(edge.name.removeprefix("edge "))
        check_edge(edge, exact[k], exact[(k + 1) % count])
        assert len(edge.beyond) == count - 1


def test_only_edges_of_the_hull_can_be_pushed() -> None:
    found, exact = polygon(L), metres(L)
    assert {edge.name for edge in found.edges} == {"edge 0", "edge 1", "edge 4", "edge 5"}
    assert len(found.lines) == 5  # and the bridge over the notch
    for edge in found.edges:
        k = int(edge.name.removeprefix("edge "))
        check_edge(edge, exact[k], exact[(k + 1) % len(L)])
    bridge = found.lines[2]
    # from (760, -40) to (-40, 760): 45 deg, 720/sqrt(2) from the centre
    assert holds_ratio(bridge.depth, Fraction(720, 10**6), Fraction(2))


def test_a_star_has_no_edge_to_push() -> None:
    with pytest.raises(NotApplicableError, match="no edge of the part can be pushed"):
        polygon(STAR).edge(0.0)


def test_the_edge_that_faces_the_probe_stands_near_upright_at_any_turn() -> None:
    found = polygon(L)
    for theta in (-7.0, -1.6, 0.1, 1.5, 3.0, 4.9, 6.2, 8.0):
        edge = found.edge(theta)
        angle = edge.angle(Interval.point(theta)).mid
        assert abs(angle - HALF_PI.mid) < 0.8
        x, y = np.cos(theta - edge.turn.mid), np.sin(theta - edge.turn.mid)
        normal = np.array([y, -x])  # outward, in the world
        c, s = np.cos(theta), np.sin(theta)
        placed = np.array(L) @ np.array([[c, s], [-s, c]]) * 1e-6
        assert (placed @ normal).max() == pytest.approx(edge.depth.mid)
        assert normal[0] > 0.69


def test_a_mirrored_outline_is_that_of_mirrored_corners() -> None:
    found = polygon(L).mirrored()
    wanted = polygon([(x, -y) for x, y in reversed(L)])
    assert len(found.edges) == len(wanted.edges) == 4
    for theta in (0.0, 1.6, 3.1, 4.7):
        one, other = found.edge(theta), wanted.edge(theta)
        for name in ("turn", "depth", "first", "last"):
            assert getattr(one, name).meets(getattr(other, name)), name
        assert {round(line.depth.mid, 9) for line in one.beyond} == {
            round(line.depth.mid, 9) for line in other.beyond
        }
    assert [x.mid for x, _ in found.corners] == [x.mid for x, _ in wanted.corners]
    assert [y.mid for _, y in found.corners] == [y.mid for _, y in wanted.corners]


@pytest.mark.parametrize("width", [1e-12, 1e-3, 0.3, 2.0])
def test_a_direction_is_enclosed_however_wide_its_cosine_and_sine(width: float) -> None:
    """Also where a wide enclosure reaches across an axis, off its middle."""
    rng = np.random.default_rng(5)
    found = []
    for angle in rng.uniform(-np.pi, np.pi, 2000):
        c, s = (
            Interval(value - low, value + high)
            for value, low, high in zip(
                (np.cos(angle), np.sin(angle)), *rng.uniform(1e-15, width, (2, 2)), strict=True
            )
        )
        direction = _direction(c, s)
        ends = direction.lo - 1e-12, direction.hi + 1e-12
        assert any(ends[0] <= angle + turn <= ends[1] for turn in (-2 * np.pi, 0.0, 2 * np.pi))
        found.append(direction.width < 1.0)
    assert np.mean(found) > 0.99 or width > 0.1
