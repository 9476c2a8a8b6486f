"""The checker's formulas of a push at one value of everything, against the plant of its own."""

from __future__ import annotations

import math
import random
from typing import Any

import numpy as np
import pytest
from flint import arb, ctx
from scipy.integrate import quad

from meso_robust.checker import statement as st, straighten, tilt
from meso_robust.checker.document import RuleDocument
from meso_robust.checker.dual import Dual, Point
from meso_robust.checker.film import Arm
from meso_robust.checker.inputs import given
from meso_robust.checker.pushing import line_off, on_edge, turns_back
from meso_robust.checker.ranges import point_of, side_of
from meso_robust.checker.requirement import Requirement
from meso_robust.checker.roll import travel_of, turn_of
from meso_robust.checker.scene import Scene, scene_of
from meso_robust.checker.verdict import BITS
from tests.checker.real_tips import Vector
from tests.checker.test_turns import FULL, STRAIGHTEN, TILT, WANDER, drawn, push_of, rule, task

LARGE: dict[str, dict[str, Any]] = {
    "part": {"size_tolerance_um": 40.0, "squareness_deg": 2.0, "corner_radius_um": 30.0},
    "probe": {"tip_radius_um": [5.0, 60.0], "tip_spacing_tolerance_um": 20.0},
    "uncertainty": {
        "travel_direction_deg": [-4.0, 5.0],
        "travel_scale_percent": 5.0,
        "drag_centre_um": 60.0,
        "drag_anisotropy_percent": 40.0,
        "probe_wander_um": 5.0,
    },
}
"""So much of everything that a wrong sign is far outside of rounding."""


@pytest.fixture(autouse=True)
def precision() -> Any:
    with ctx.workprec(BITS):
        yield


class Case:
    """A push with all of its values drawn, its path bent evenly."""

    def __init__(self, of: RuleDocument, offsets: tuple[float, float, float], seed: int) -> None:
        rng = random.Random(seed)
        known = given(task(FULL, WANDER, LARGE))
        self.scene: Scene = scene_of(of, known.start, known)
        values = drawn(self.scene.box, rng, corner=False)
        if of.action == "straighten":
            values["theta"] += 0.08
        for name in ("stretch", "shear", "rho", "bend"):
            values[f"{name}_now"] = values[name]
        self.push = push = push_of(self.scene, values, offsets)
        aside = np.array([-math.sin(values["direction"]), math.cos(values["direction"])])
        push.stray = lambda share: values["bend"] * push.length * share * aside
        pose = np.array([values["x"], values["y"], values["theta"]])
        touch = push.touches(-1, pose)
        now = push.stray(1.0)
        values["wander_x"], values["wander_y"] = push.stray(touch / push.length)
        values["wander_x_now"], values["wander_y_now"] = now
        self.values, self.start = values, pose
        self.at: Point = point_of({k: side_of(arb(v)) for k, v in {**values, "share": 1.0}.items()})

    def numbers(self, requirement: Requirement) -> list[float]:
        """Values of an inequality, the whole way done."""
        part = requirement.parts[0]
        given_ = {name: of(self.at) for name, of in part.variables.items()}
        return [float(one.value) for one in requirement.statement.of(given_, arb(0))]


@pytest.mark.parametrize("seed", range(4))
def test_a_tilt_ends_where_the_balance_takes_it(seed: int) -> None:
    case = Case(rule("tilt", TILT), TILT, seed)
    pose = case.push.run(-1, second=False)
    found = [float(one.value) for one in tilt._centre(case.scene, case.at, arb(0))]
    assert found == pytest.approx(pose.tolist(), abs=2e-9)
    # what acts at its end
    case.push.stuck(-1, case.push.length, pose)
    now = case.push.instants[-1]
    contact = tilt._contact(case.scene, case.at, whole=True)
    assert float(contact.d2.value) == pytest.approx(now.d2, abs=2e-9)
    arm = Arm.of(contact.d1, contact.d2, case.scene.film(case.at, "_now"))
    factor = turning_drag(case.values, now.d2)
    bent = math.hypot(1.0, case.values["bend"])
    assert bent > 1.0
    for own, there in (
        (arm.press(contact.c, contact.s), now.press),
        (arm.shear(contact.c, contact.s), now.shear),
        (arm.turn(contact.c, contact.s), now.turn),
    ):
        assert float(own.value) == pytest.approx(factor * there, rel=1e-4)


def turning_drag(values: dict[str, float], d2: float) -> float:
    """F: the drag against a turn about the contact."""
    nu = np.array([values["drag_n"] - values["depth"], d2 - values["drag_a"], 1.0])
    st_, sh = values["stretch"], values["shear"]
    drag = np.array([[1 + st_, sh, 0], [sh, 1 - st_, 0], [0, 0, values["rho"]]])
    return float(nu @ drag @ nu)


@pytest.mark.parametrize("seed", range(3))
def test_a_straightening_ends_on_both_tips(seed: int) -> None:
    case = Case(rule("straighten", STRAIGHTEN), STRAIGHTEN, seed)
    pose = case.push.run(-1, second=True)
    own = straighten._Case(case.scene, -1, case.scene.box)
    theta = straighten._aligned_as_stated(case.scene, case.at)
    found = [float(one.value) for one in (own.x_end(case.at), own.y_end(case.at), theta)]
    assert found == pytest.approx(pose.tolist(), abs=2e-8)
    assert case.push.off(1, case.push.length, pose) == pytest.approx(0.0, abs=2e-8)
    # both contacts along the edge, and the forces that carry the part
    a, n = case.push.normal(pose)
    d2 = [float((case.push.tip(k, case.push.length) - pose[:2]) @ a) for k in (1, -1)]
    assert [float(own.other(case.at).value), float(own.end(case.at).d2.value)] == pytest.approx(
        d2, abs=2e-8
    )
    drag, _ = case.push.drag(case.push.length, pose)
    path = -np.array([math.cos(case.values["direction"]), math.sin(case.values["direction"])])
    path = path + case.values["bend"] * np.array([path[1], -path[0]])
    force = drag[:2, :2] @ path
    along, press = float(force @ a), -float(force @ n)
    first, second = d2[0] - case.values["drag_a"], d2[1] - case.values["drag_a"]
    lever = (case.values["depth"] - case.values["drag_n"]) * along
    upper = -(lever + press * second) / (first - second)  # of moments about the centre of drag
    lower = press - upper
    (pressing,) = [one for one in own.requirements_of_pair() if one.statement is st.PAIR_PRESSES]
    gap = first - second
    assert case.numbers(pressing) == pytest.approx([upper * gap, lower * gap], rel=1e-4)
    (sticking,) = [one for one in own.requirements_of_pair() if one.statement is st.PAIR_STICKS]
    held = [
        case.values[mu] * press + along * sign
        for mu in ("mu_upper", "mu_lower")
        for sign in (-1, 1)
    ]
    assert case.numbers(sticking)[:4] == pytest.approx(held, rel=1e-4)


@pytest.mark.parametrize("seed", range(3))
def test_lines_of_a_part_that_is_not_as_stated(seed: int) -> None:
    """A tip off each side of the hull, and the ends of the pushed edge, from corners of real lines."""
    case = Case(rule("tilt", TILT), TILT, seed)
    v, scene = case.values, case.scene
    pushed = v["theta"] + v["kappa"]
    place = (3.1e-4, 8.7e-4)

    def line(turn: float, depth: float, kappa: float) -> tuple[Vector, float]:
        """Outward normal and distance of an edge, ``turn`` counter-clockwise of the pushed one."""
        angle = v["theta"] + turn + kappa
        return np.array([math.sin(angle), -math.cos(angle)]), depth

    half_width, half_length = float(scene.outline.half_width), float(scene.outline.half_length)  # type: ignore[union-attr]
    depths = [None, half_length, half_width, half_length]
    lines = [line(0.0, v["depth"], v["kappa"])] + [
        line(k * math.pi / 2, float(depths[k] or 0.0) + v["size_other"], v["kappa_other"])
        for k in (1, 2, 3)
    ]
    c, s = math.cos(v["direction"]), math.sin(v["direction"])
    tip = np.array([c * place[0] - s * place[1], s * place[0] + c * place[1]])
    duals = tuple(type(case.at["x"])(arb(value)) for value in place)
    for k, edge in enumerate(scene.outline.sides(scene.edge)):
        variables = line_off(scene, edge, scene.angle, lambda at: (duals[0], duals[1]), 1)
        numbers = {name: of(case.at) for name, of in variables.items()}
        (found,) = st.CLEARANCE.of(numbers, arb(0))
        normal, depth = lines[-k % 4]
        assert float(found.value) == pytest.approx(
            float(normal @ tip) - depth - v["radius_upper"], abs=1e-12
        )
    corners = []
    for k in (3, 1):
        normals = np.array([lines[0][0], lines[k][0]])
        corner = np.linalg.solve(normals, [lines[0][1], lines[k][1]])
        exterior = math.pi / 2 + (v["kappa_other"] - v["kappa"]) * (1 if k == 1 else -1)
        along = float(corner @ np.array([math.cos(pushed), math.sin(pushed)]))
        corners.append(along + (30e-6 * math.tan(exterior / 2)) * (1 if k == 3 else -1))
    (values,) = [on_edge("pushing", scene, lambda at: at["x"] * 0, scene.box)]
    assert case.numbers(values) == pytest.approx([-corners[0], corners[1]], abs=1e-12)


@pytest.mark.parametrize("side", [1, -1])
def test_a_tip_that_turns_the_part_back_does_so_whatever_friction_does(side: int) -> None:
    case = Case(rule("straighten", STRAIGHTEN), STRAIGHTEN, 0)
    v, offset = case.values, 2.1e-4 * side
    zero = case.at["x"] * 0
    found = case.numbers(
        turns_back("second", case.scene, lambda at: zero + arb(offset), side, case.scene.box)
    )
    mu = v["mu_upper" if side > 0 else "mu_lower"]
    # moments, counter-clockwise, of one unit of pressing with friction along the edge: a x n is -1
    arm = np.array([offset - v["drag_a"], v["depth"] - v["drag_n"]])
    moments = [-(arm[0] * -1.0 - arm[1] * k) * side for k in np.linspace(-mu, mu, 9)]
    assert found == pytest.approx([min(moments)], rel=1e-9)


@pytest.mark.parametrize("side", [1, -1])
def test_slopes_of_a_turn_hold_its_differences(side: int) -> None:
    """Of the turn after a travel, and of the travel of a turn, along everything they depend on."""
    state = [1.5, 4.1e-4, side * 3.3e-4, 3e-5, 3.8e-7, 0.05, -0.04, 0.03, 2e-5, -3e-5]
    travel, step = 1.5e-4, 1e-6

    def dual(k: int, value: float) -> Dual:
        return Dual(arb(value), {str(k): arb(1)})

    def point(values: list[float]) -> list[Dual]:
        return [Dual(arb(value)) for value in values]

    box = [dual(k, value) for k, value in enumerate(state)]
    turned = turn_of(box, dual(10, travel), side)
    middle = float(turn_of(point(state), Dual(arb(travel)), side).value)
    needed = travel_of(box, dual(10, middle))
    assert float(needed.value) == pytest.approx(travel, rel=1e-9)
    for k in range(11):
        size = step * abs(([*state, travel])[k])
        ends = []
        for sign in (-1, 1):
            moved = [*state, travel]
            moved[k] += sign * size
            ends.append(float(turn_of(point(moved[:10]), Dual(arb(moved[10])), side).value))
        slope = (ends[1] - ends[0]) / (2 * size)
        room = 1e-5 * abs(slope)
        low, high = (
            float(end) for end in (turned.slopes[str(k)].lower(), turned.slopes[str(k)].upper())
        )
        assert low - room <= slope <= high + room, k
        if k < 10:  # the travel changes against the turn
            per_turn = float(1 / turned.slopes["10"].mid())
            against = -slope * per_turn
            low, high = (
                float(end) for end in (needed.slopes[str(k)].lower(), needed.slopes[str(k)].upper())
            )
            assert low - 1e-4 * abs(against) <= against <= high + 1e-4 * abs(against), k


@pytest.mark.parametrize("side", [-1, 1])
def test_a_tip_that_has_not_gone_on_has_not_turned_the_part(side: int) -> None:
    """Whatever the state is within a box: the first pose of a turn is bounded as any other."""
    state = [1.57, 418.5e-6, side * 335e-6, 12.5e-6, 0.377e-6, 0.0, 0.0, 0.0, 0.0, 0.0]
    reach = [0.004, 0.0, 4e-6, 0.0, 2e-8, 0.0, 0.0, 0.0, 0.0, 0.0]
    box = [
        Dual(arb(middle, room), {str(k): arb(1)})
        for k, (middle, room) in enumerate(zip(state, reach, strict=True))
    ]
    turned = turn_of(box, Dual(arb(0)), side)
    assert turned.value.is_finite()
    assert abs(float(turned.value)) < 1e-8
    assert float(abs(turned.value).upper()) < 1e-8


def test_a_centre_of_drag_that_moves_does_more_than_any_that_is_fixed() -> None:
    """About the middle of this turn its effect on the travel changes its sign."""
    angle, d1, d2, rho, turned, reach = 2.35, 418.5e-6, 335e-6, 0.377e-6, 0.4, 1e-6
    state = [angle, d1, d2, 0.0, rho, 0.0, 0.0, 0.0, 0.0, 0.0]
    box = [Dual(arb(value)) for value in state]
    box[8] = Dual(arb(0.0, reach), {"centre_a": arb(1)})
    way = angle + turned * (np.arange(4000) + 0.5) / 4000

    def travel(centre: Any) -> float:
        place = d2 - centre
        rate = (rho + d1**2 + place**2) / (place * np.sin(way) - d1 * np.cos(way))
        return float(rate.mean() * turned)

    upward = travel(0.5 * reach) - travel(-0.5 * reach)
    later = np.where(way > angle + 0.5 * turned, reach, -reach)
    farthest = max(travel(later), travel(-later))
    found = travel_of(box, Dual(arb(turned))).value
    fixed = max(travel(reach), travel(-reach))

    assert abs(upward) < 0.5 * (farthest - travel(0.0))
    assert fixed < farthest <= float(found.upper())


@pytest.mark.parametrize("angle", [1.3411948, 1.3301948])
def test_a_part_that_hardly_begins_to_turn_is_integrated_as_closely(angle: float) -> None:
    """The tip's push passes near the centre of drag at first: there the travel of a turn grows fast."""
    d1, d2, radius, rho = 1.5e-3, 3.7e-4, 25e-6, 8.667e-7
    turned = 0.22

    def rate(turn: float) -> float:
        place, way = d2 - radius * turn, angle + turn
        return (rho + d1**2 + place**2) / (place * math.sin(way) - d1 * math.cos(way))

    expected, error = quad(rate, 0.0, turned, epsabs=1e-15, epsrel=1e-12)
    state = [Dual(arb(value)) for value in (angle, d1, d2, radius, rho, 0, 0, 0, 0, 0)]
    found = travel_of(state, Dual(arb(turned))).value
    assert rate(0.0) > 10 * rate(turned)  # else it is no such push
    assert float(found.rad()) < 1e-10
    assert abs(float(found.mid()) - expected) < error + 1e-10


@pytest.mark.parametrize("turned", [0.1, math.nan])
def test_a_turn_that_the_push_does_not_make_has_no_travel(turned: float) -> None:
    """On the way the tip pushes straight through the centre of drag."""
    state = [Dual(arb(value)) for value in (1.3, 1.5e-3, 3.7e-4, 0.0, 8.667e-7, 0, 0, 0, 0, 0)]
    assert not travel_of(state, Dual(arb(turned))).value.is_finite()
