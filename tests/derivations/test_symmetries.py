"""Symmetries against a brute-force contact solver that shares nothing with the derivations."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction

import numpy as np
import numpy.typing as npt
import pytest
import sympy as sp

from derivations import symmetries
from derivations._claim import Claim, Verdict
from derivations._statement import DerivationError
from derivations.mechanics import d1, d2, mu, n, rho, theta, velocity_at, wrench
from derivations.one_point_sticking import solve_sticking

F = npt.NDArray[np.float64]
VERDICTS = {
    "symmetry-mirror": Verdict.NEW,
    "symmetry-direction": Verdict.NEW,
    "symmetry-scale": Verdict.NEW,
    "other-cases": Verdict.SHARPENED,
    "lemma-1-clockwise": Verdict.NEW,
    "left-hand-push": Verdict.NEW,
    "sticking-upright-edge": Verdict.NEW,
    "two-points-mirrored": Verdict.NEW,
    "two-sided-mirrored": Verdict.NEW,
}


@pytest.fixture(scope="module")
def claims() -> dict[str, Claim]:
    return {claim.key: claim for claim in symmetries.derive().claims}


def test_verdicts(claims: dict[str, Claim]) -> None:
    assert {key: claim.verdict for key, claim in claims.items()} == VERDICTS


def frame(angle: float) -> tuple[F, F]:
    """Along an edge, and outward."""
    return np.array([np.cos(angle), np.sin(angle)]), np.array([np.sin(angle), -np.cos(angle)])


def motion(
    angle: float, depth: float, offset: float, ratio: float, friction: float, tip: F
) -> tuple[F, str]:
    """Twist and mode of a part pushed by one tip: all modes of Coulomb's law are tried in turn."""
    a, n = frame(angle)
    arm = offset * a + depth * n
    jacobian = np.array([[1.0, 0.0, -arm[1]], [0.0, 1.0, arm[0]]])  # velocity at the contact
    compliance = np.diag([1.0, 1.0, 1.0 / ratio])
    pushes = {
        "stick": None,
        "slip up": -n - friction * a,  # the part's point moves along +a relative to the tip
        "slip down": -n + friction * a,
    }
    if tip @ n >= 0.0:
        return np.zeros(3), "apart"
    for mode, direction in pushes.items():
        if direction is None:
            force = np.linalg.solve(jacobian @ compliance @ jacobian.T, tip)
            normal, tangential = -force @ n, force @ a
            if normal > 0 and abs(tangential) <= friction * normal:
                return compliance @ jacobian.T @ force, mode
            continue
        speed = jacobian @ compliance @ jacobian.T @ direction
        size = (tip @ n) / (speed @ n)
        slip = (size * speed - tip) @ a
        if size > 0 and slip * (1 if mode == "slip up" else -1) > 0:
            return compliance @ jacobian.T @ (size * direction), mode
    raise AssertionError("no mode fits")


Setup = tuple[float, float, float, float]
"""Direction of the edge, d1, d2 and rho."""


def random_contacts(count: int) -> list[tuple[Setup, float, F]]:
    """Setup, friction and velocity of a tip that presses on the edge."""
    rng = np.random.default_rng(7)
    found: list[tuple[Setup, float, F]] = []
    while len(found) < count:
        angle, offset = rng.uniform(0, 2 * np.pi), rng.uniform(-1.5, 1.5)
        tip = rng.normal(size=2)
        if tip @ frame(angle)[1] < -0.1:
            found.append(((angle, 1.0, offset, rng.uniform(0.5, 3)), rng.uniform(0.1, 0.6), tip))
    return found


Image = tuple[Setup, F, Callable[[F], F]]
"""Setup and tip velocity of the image, and what becomes of the twist."""


def mirrored(setup: Setup, tip: F) -> Image:
    angle, depth, offset, ratio = setup
    flip = np.array([1.0, -1.0])
    return (np.pi - angle, depth, -offset, ratio), flip * tip, lambda v: v * [1, -1, -1]


def turned(setup: Setup, tip: F) -> Image:
    angle, depth, offset, ratio = setup
    c, s = np.cos(0.7), np.sin(0.7)
    turn = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    return (angle + 0.7, depth, offset, ratio), turn[:2, :2] @ tip, lambda v: turn @ v


def enlarged(setup: Setup, tip: F) -> Image:
    angle, depth, offset, ratio = setup
    return (angle, 3 * depth, 3 * offset, 9 * ratio), tip, lambda v: v / [1, 1, 3]


@pytest.mark.parametrize("move", [mirrored, turned, enlarged])
def test_images_of_motions_are_motions(move: Callable[[Setup, F], Image]) -> None:
    modes = set()
    for setup, friction, tip in random_contacts(150):
        twist, mode = motion(*setup, friction, tip)
        setup_after, tip_after, image = move(setup, tip)
        after, mode_after = motion(*setup_after, friction, tip_after)
        assert after == pytest.approx(image(twist), abs=1e-12)
        swap = {"slip up": "slip down", "slip down": "slip up"} if move is mirrored else {}
        assert mode_after == swap.get(mode, mode)
        modes.add(mode)
    assert modes == {"stick", "slip up", "slip down"}


@pytest.mark.parametrize(("depth", "offset"), [(418.5, 200.0), (418.5, -350.0), (808.0, 200.0)])
def test_sticking_arc_by_brute_force(depth: float, offset: float) -> None:
    """The limits are where the solver above changes its mode."""
    ratio, friction = 376_900.0, 0.33
    lo, hi = sticking_range(depth, offset, ratio, friction)
    left = np.array([-1.0, 0.0])
    for angle in np.linspace(0.02, np.pi - 0.02, 400):
        sticks = motion(angle, depth, offset, ratio, friction, left)[1] == "stick"
        assert sticks == (lo < angle < hi)


def sticking_range(depth: float, offset: float, ratio: float, friction: float) -> list[float]:
    """The derived limits of the sticking arc."""
    at = {d1: depth, d2: offset, rho: ratio, mu: friction}
    return [float(sp.atan2(k[1], k[0]).subs(at)) for k in symmetries.limits()]


def test_forces_are_those_of_the_five_equations() -> None:
    """Mobility in the edge's frame and the linear system in the world give the same."""
    solved, found = solve_sticking(), symmetries.sticking_at()
    here = {symmetries.q_x: sp.cos(theta), symmetries.q_y: sp.sin(theta)}
    at = {d1: 3, d2: sp.Rational(-5, 4), rho: 2, theta: sp.Rational(4, 3)}
    e_x, v_p = sp.Symbol("e_x", positive=True), sp.Symbol("v_p", negative=True)
    scale = -e_x * v_p / symmetries.F
    for by_five, by_mobility in zip(
        (solved.normal / scale, solved.tangential / scale, -solved.twist[2] * symmetries.F / v_p),
        found,
        strict=True,
    ):
        assert float((by_five - by_mobility.subs(here)).subs(at).evalf(30)) == pytest.approx(0.0)


def test_left_hand_push_by_brute_force() -> None:
    """Push along +x on the left edge, ``e`` above the centre."""
    right = np.array([1.0, 0.0])
    for height in (350.0, -350.0):
        lo, hi = sticking_range(418.5, -height, 376_900.0, 0.33)
        for angle in np.linspace(0.05, np.pi - 0.05, 200):
            twist, mode = motion(angle + np.pi, 418.5, -height, 376_900.0, 0.33, right)
            assert (mode == "stick") == (lo < angle < hi)
            if mode == "stick":
                assert twist[2] * (-height * np.sin(angle) - 418.5 * np.cos(angle)) > 0


def test_clockwise_rotation_ends_at_the_lower_limit(claims: dict[str, Claim]) -> None:
    """Euler steps of the rotation from upright, counted in the part's own orientation."""
    angle, left = np.pi / 2, np.array([-1.0, 0.0])
    while True:
        twist, mode = motion(angle, 418.5, -350.0, 376_900.0, 0.33, left)
        assert twist[2] < 0
        if mode != "stick":
            break
        angle += twist[2] * 0.5
    assert f"{np.degrees(angle):.0f}°" == "59°"
    assert "59.04°" in claims["lemma-1-clockwise"].derived


def test_mirrored_pair_by_numbers() -> None:
    x, y, spacing, depth, offset = np.cos(0.1), np.sin(0.1), 300.0, 418.5, 120.0
    symbols = (*symmetries.BETA, sp.Symbol("d4", positive=True), d1, d2)
    forces = sp.lambdify(symbols, symmetries.two_points(d2))
    upper, lower, shear = forces(x, y, spacing, depth, offset)
    image = forces(x, -y, spacing, depth, spacing / x - offset)
    assert image == pytest.approx((lower, upper, -shear))
    # moments about the contact of the lower tip: the drag acts at the centre
    a, n = frame(np.pi / 2 + 0.1)
    below = (offset - spacing / x) * a + depth * n
    drag_moment = -below[0] * 0.0 + below[1] * -1.0
    assert upper * spacing / x == pytest.approx(drag_moment)


@pytest.mark.parametrize(("above", "sense"), [(857.0, 1), (-857.0, -1)])
def test_two_sided_rotation_either_way(above: float, sense: int) -> None:
    """Orientation from the closure of both contacts, by root finding on the closure itself."""
    width, previous = 837.0, np.pi / 2
    for ahead in np.linspace(837.0, -600.0, 60)[1:]:
        angles = np.linspace(1e-3, np.pi - 1e-3, 20_001)
        gap = ahead * np.sin(angles) - above * np.cos(angles) - width  # (h, V) . n = w
        crossings = angles[:-1][np.diff(np.sign(gap)) != 0]
        angle = min(crossings, key=lambda found: abs(found - previous))
        assert (angle - previous) * sense > -1e-3
        previous = angle
    assert (previous > np.pi / 2) == (sense > 0)


def test_upright_reach(claims: dict[str, Claim]) -> None:
    """0.30 (376900 + d1^2)/d1 in exact fractions."""
    text = claims["sticking-upright-edge"].derived
    for edge in (Fraction(837, 2), Fraction(808)):
        reach = Fraction(3, 10) * (376_900 + edge**2) / edge
        assert f"{float(reach):.1f} µm" in text


def lopsided_film(twist: sp.Matrix) -> sp.Matrix:
    return sp.diag(1, 2, rho) * twist


def clockwise() -> Claim:
    return symmetries._clockwise(*symmetries.limits())


def one_way_friction(*contact: sp.Expr) -> tuple[sp.Basic, ...]:
    normal, tangential, slip, opening = contact
    return (normal >= 0, tangential <= mu * normal, opening >= 0, slip <= 0)


@pytest.mark.parametrize(
    ("name", "wrong", "claim"),
    [
        ("film", lopsided_film, symmetries._direction_claim),
        ("coulomb", one_way_friction, symmetries._mirror_claim),
        ("wrench", lambda f, r: wrench(f, -r), clockwise),
        ("velocity_at", lambda v, r: velocity_at(v, -r), clockwise),
        ("n", n + sp.Matrix([0, 2 * sp.cos(theta)]), symmetries._mirror_claim),
    ],
)
def test_a_wrong_law_is_noticed(
    monkeypatch: pytest.MonkeyPatch, name: str, wrong: object, claim: Callable[[], object]
) -> None:
    monkeypatch.setattr(symmetries, name, wrong)
    with pytest.raises(DerivationError):
        claim()


def test_a_wrong_map_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    def keeps_offset(contact: symmetries.Contact) -> symmetries.Image:
        image = right(contact)
        same_side = symmetries.Contact(
            edge=image.contact.edge,
            depth=image.contact.depth,
            offset=contact.offset,
            tip=image.contact.tip,
            normal=image.contact.normal,
            tangential=image.contact.tangential,
        )
        return image._replace(contact=same_side)

    right = symmetries.mirror
    monkeypatch.setattr(symmetries, "mirror", keeps_offset)
    with pytest.raises(DerivationError, match="wrench of the image"):
        symmetries._mirror_claim()
