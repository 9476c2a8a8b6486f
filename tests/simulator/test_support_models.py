"""Support models as users state them: loads, tables, limits and refusals."""

from typing import Any

import numpy as np
import numpy.typing as npt
import pytest

from meso_robust.simulator import Film, LimitSurface, Mixture, PressurePoints, ThreePoints

F = npt.NDArray[np.float64]

UM = 1e-6
TRIANGLE = np.array([[0.0, 300.0], [-300.0, -300.0], [300.0, -300.0]]) * UM
# Table I of the paper, µm.
FIRST = np.array([[411.3, -563.3], [-409.1, 605.9], [-273.2, -102.1]]) * UM
SECOND = np.array([[-412.4, 794.0], [-217.8, 774.5], [278.8, -538.8]]) * UM
BRICK = np.array([[-808.0, -418.5], [808.0, -418.5], [808.0, 418.5], [-808.0, 418.5]]) * UM
ELL = np.array([[-2.0, -2.0], [4.0, -2.0], [4.0, 0.0], [0.0, 0.0], [0.0, 4.0], [-2.0, 4.0]]) * 1e-4


def unpacked(rows: F) -> F:
    """Symmetric matrix of an upper triangle by rows."""
    a, b, c, d, e, f = rows
    return np.array([[a, b, c], [b, d, e], [c, e, f]])


def moments(pieces: list[tuple[float, float, float, float]]) -> F:
    """Drag (3, 3) of an area of rectangles (x, X, y, Y), by the integrals of x, y, x² + y²."""
    drag, whole = np.zeros((3, 3)), 0.0
    for x, X, y, Y in pieces:
        size = (X - x) * (Y - y)
        mx, my = size * (x + X) / 2, size * (y + Y) / 2
        rr = (X**3 - x**3) / 3 * (Y - y) + (Y**3 - y**3) / 3 * (X - x)
        drag += [[size, 0, -my], [0, size, mx], [-my, mx, rr]]
        whole += size
    return drag / whole


def test_loads_by_hand() -> None:
    # The lower pair shares equally; levers: c 0.3 = (1 − c) 0.3 puts half on the top.
    loads = ThreePoints(points=TRIANGLE).loads
    np.testing.assert_allclose(loads, [[0.5, 0.25, 0.25]], rtol=1e-14)


@pytest.mark.parametrize(
    ("points", "centre"),
    [
        (FIRST, (0.0, 0.0)),
        (FIRST, (5 * UM, -3 * UM)),
        (SECOND, (0.0, 0.0)),
        (TRIANGLE[::-1], (-20 * UM, 50 * UM)),
    ],
)
def test_loads_balance_the_weight(points: F, centre: tuple[float, float]) -> None:
    system = np.vstack([points.T, np.ones(3)])
    wanted = np.linalg.solve(system, [*centre, 1.0])
    model = ThreePoints(points=points, centre_of_mass=centre)
    np.testing.assert_allclose(model.loads[0], wanted, rtol=1e-11)
    rows = model.tables().points[0]
    np.testing.assert_array_equal(rows[:, :2], points)
    np.testing.assert_allclose(rows[:, 2], 75e-6 * wanted, rtol=1e-11)


def test_loads_of_every_run() -> None:
    both = ThreePoints(points=np.stack([FIRST, TRIANGLE])).loads
    np.testing.assert_array_equal(both[0], ThreePoints(points=FIRST).loads[0])
    np.testing.assert_array_equal(both[1], ThreePoints(points=TRIANGLE).loads[0])


def test_friction_of_the_points_is_in_no_table() -> None:
    low, high = (ThreePoints(points=FIRST, friction=mu).tables() for mu in (0.013, 0.757))
    for a, b in zip(low, high, strict=True):
        np.testing.assert_array_equal(a, b)


def test_film_under_a_brick_is_the_papers_film() -> None:
    rho = (1616.0**2 + 837.0**2) / 12 * UM**2
    film = unpacked(Film.under(BRICK).tables().film[0])
    np.testing.assert_allclose(film, np.diag([1.0, 1.0, rho]), rtol=1e-12, atol=1e-18)
    np.testing.assert_allclose(film, unpacked(Film.ratio(rho).tables().film[0]), atol=1e-18)


def test_film_under_an_ell_is_the_integral_over_it() -> None:
    wanted = moments([(-2e-4, 4e-4, -2e-4, 0.0), (-2e-4, 0.0, 0.0, 4e-4)])
    np.testing.assert_allclose(unpacked(Film.under(ELL).tables().film[0]), wanted, rtol=1e-12)


@pytest.mark.parametrize("outline", [BRICK, ELL])
@pytest.mark.parametrize("cells", [1, 3, 6])
def test_pressure_points_have_the_moments_of_the_film(outline: F, cells: int) -> None:
    x, y, c = PressurePoints.under(outline, cells).tables().points[0].T
    w = c / 75e-6
    got = np.array([w.sum(), -(w @ y), w @ x, w @ (x * x + y * y)])
    film = unpacked(Film.under(outline).tables().film[0])
    wanted = [film[0, 0], film[0, 2], film[1, 2], film[2, 2]]
    np.testing.assert_allclose(got, wanted, rtol=1e-11, atol=1e-17)


def test_finer_cells_tend_to_the_mean_distance() -> None:
    # Torque of a spinning square of uniform pressure over its force: side (√2 + asinh 1) / 6.
    side = 1e-3
    square = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * side / 2
    exact = side * (np.sqrt(2) + np.arcsinh(1.0)) / 6
    errors = []
    for cells in (2, 4, 8):
        x, y, c = PressurePoints.under(square, cells).tables().points[0].T
        errors.append(abs(c @ np.hypot(x, y) / c.sum() / exact - 1))
    assert errors[2] < 5e-4
    assert errors[2] < errors[1] / 3 < errors[0] / 9


def test_scale_of_film_and_surface_is_of_no_effect() -> None:
    matrix = np.array([[2.0, 0.3, 1e-4], [0.3, 1.0, -2e-4], [1e-4, -2e-4, 1e-6]])
    film = Film(matrix).tables().film[0]
    np.testing.assert_allclose(film, Film(7e-3 * matrix).tables().film[0], rtol=1e-14)
    assert film[0] == 1.0
    surface = LimitSurface(matrix).tables().surface[0]
    np.testing.assert_allclose(unpacked(surface), matrix / 2 * (75e-6) ** 2, rtol=1e-14)


def test_mixture_scales_the_largest_force() -> None:
    dry, film = ThreePoints(points=FIRST), Film.ratio(0.4e-6)
    tables = Mixture(film=film, dry=dry, ratio=np.array([0.0, 0.5])).tables()
    np.testing.assert_allclose(tables.points[..., 2].sum(axis=1), [0.0, 0.5 * 75e-6], rtol=1e-14)
    np.testing.assert_array_equal(tables.film, film.tables().film)
    round_one = LimitSurface(np.diag([1.0, 1.0, 0.3e-6]))
    surface = Mixture(film=film, dry=round_one, ratio=0.5).tables().surface[0]
    # A force of the translation (1, 0, 0) is A₀₀ / √A₀₀.
    assert np.sqrt(surface[0]) == pytest.approx(0.5 * 75e-6, rel=1e-14)


def test_arrays_are_copied_and_read_only() -> None:
    given = FIRST.copy()
    model = ThreePoints(points=given)
    given[0, 0] = 7.0
    assert model.points[0, 0, 0] == FIRST[0, 0]
    with pytest.raises(ValueError, match="read-only"):
        model.points[0, 0, 0] = 1.0
    with pytest.raises(ValueError, match="read-only"):
        Film.ratio(1e-7).drag[0, 0, 0] = 2.0


OUTSIDE = TRIANGLE + np.array([0.0, 301 * UM])
LINE = np.array([[-1.0, 0.0], [0.0, 0.0], [1.0, 0.0]]) * 1e-4
SKEW = np.array([[1.0, 0.2, 0.0], [0.1, 1.0, 0.0], [0.0, 0.0, 1e-7]])
FILM = Film.ratio(1e-7)
BAD: list[tuple[type, dict[str, Any], str]] = [
    (ThreePoints, {"points": OUTSIDE}, r"points: point 0 of run 0 carries -.*; must stand around"),
    (ThreePoints, {"points": LINE}, r"points: point 0 of run 0 carries nan"),
    (ThreePoints, {"points": np.stack([FIRST, OUTSIDE])}, r"point 0 of run 1 carries -"),
    (ThreePoints, {"points": FIRST * np.nan}, r"points: "),
    (ThreePoints, {"points": FIRST[:2]}, r"points: shape .*2, 2\); must be \(3, 2\)"),
    (ThreePoints, {"points": FIRST, "friction": 0.0}, r"friction: 0.0; must be positive"),
    (ThreePoints, {"points": FIRST, "friction": np.nan}, r"friction: nan; must be positive"),
    (ThreePoints, {"points": FIRST, "centre_of_mass": (1e-3, 0.0)}, r"must stand around"),
    (PressurePoints, {"points": FIRST, "shares": np.ones(2)}, r"points: shape .* K shares"),
    (PressurePoints, {"points": FIRST, "shares": [1, 0, 1]}, r"shares: share 1 is 0.0; must be"),
    (PressurePoints, {"points": FIRST, "shares": [1, 1, np.nan]}, r"shares: share 2 is nan"),
    (PressurePoints, {"points": np.zeros((0, 2)), "shares": np.zeros(0)}, r"points: shape \(0, 2"),
    (Film, {"drag": np.diag([1.0, 1.0, 0.0])}, r"drag: run 0 .*; must be positive definite"),
    (Film, {"drag": np.diag([1.0, -1.0, 1e-7])}, r"drag: run 0 .*; must be positive definite"),
    (Film, {"drag": SKEW}, r"drag: not symmetric"),
    (Film, {"drag": np.full((3, 3), np.nan)}, r"drag: a number that is not finite"),
    (Film, {"drag": np.eye(2)}, r"drag: shape \(2, 2\)|drag: shape \(1, 2, 2\)"),
    (LimitSurface, {"matrix": np.diag([1.0, 1.0, -1e-7])}, r"matrix: run 0 .* positive definite"),
    (Mixture, {"film": FILM, "dry": ThreePoints(points=FIRST), "ratio": -0.1}, r"ratio: run 0 has"),
    (Mixture, {"film": FILM, "dry": ThreePoints(points=FIRST), "ratio": [1, np.inf]}, r"ratio: ru"),
]


@pytest.mark.parametrize(("model", "values", "message"), BAD)
def test_bad_models_are_refused(model: type, values: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        model(**values)


@pytest.mark.parametrize("value", [0.0, -1e-7, np.nan, np.inf])
def test_film_ratios_must_be_positive(value: float) -> None:
    with pytest.raises(ValueError, match=r"film_ratio: run 1 has .* m²; .* must be positive.*give"):
        Film.ratio(np.array([1e-7, value]))
