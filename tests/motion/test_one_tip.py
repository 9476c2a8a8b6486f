"""Turns by one tip: against forces and integration, run by run, and over boxes."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np
import pytest

from meso_robust.bounds import HALF_PI, Interval
from meso_robust.bounds.implicit import Ends, Implicit, bound
from meso_robust.motion import one_tip
from meso_robust.types import Floats
from tests.motion import pushed_disc as plant

UM, DEG = 1e-6, np.pi / 180.0
RHO = 376900.0 * UM**2
MIDDLE = {
    "theta": np.pi / 2,
    "spacing": 600 * UM,
    "radius_upper": 7.5 * UM,
    "radius_lower": 7.5 * UM,
    "depth": 418.5 * UM,
    "rho": RHO,
    "rho_now": RHO,
    "mu_upper_now": 0.33,
    "mu_lower_now": 0.33,
    "share": 0.5,
}
REACH = {
    **dict.fromkeys(("x", "y", "sensed_x", "sensed_y", "probe_x", "probe_y"), 5 * UM),
    **{"theta": 0.3 * DEG, "beta": 0.25 * DEG, "direction": 0.1 * DEG, "scale": 0.001},
    **dict.fromkeys(("wander_x", "wander_y", "wander_x_now", "wander_y_now"), 1 * UM),
    **{"spacing": 1 * UM, "radius_upper": 5 * UM, "radius_lower": 5 * UM, "depth": 1 * UM},
    **{"kappa": 0.1 * DEG, "drag_a": 20 * UM, "drag_n": 20 * UM},
    **{"rho": 0.05 * RHO, "stretch": 0.025, "shear": 0.025, "bend": 0.01},
    **{"rho_now": 0.05 * RHO, "stretch_now": 0.025, "shear_now": 0.025, "bend_now": 0.01},
    **{"mu_upper_now": 0.03, "mu_lower_now": 0.03, "share": 0.5},
}


def aimed(offset: float, ahead: float, end: float) -> dict[str, float]:
    """Commands, um: height of the pair, where it starts and where it stops."""
    lines = {f"{when}_turn": -np.pi / 2 for when in one_tip.LINES}
    depths = {f"{when}_depth": 808 * UM for when in one_tip.LINES}
    return {
        "turn": 0.0,
        **dict.fromkeys(("part_x", "part_y", "part_end"), 1.0),
        **{"offset_x": ahead * UM, "offset_y": offset * UM, "offset_end": end * UM},
        **{"first": -808 * UM, "last": 808 * UM, "stray_x": 0.0, "stray_y": 0.0},
        **lines,
        **depths,
    }


TILT = aimed(offset=250 + 300, ahead=452, end=278)
BACK = aimed(offset=-250 - 300, ahead=452, end=278)
STRAIGHT = {**aimed(offset=110, ahead=480, end=150), "theta": np.pi / 2 + 4.5 * DEG}


def middle(aim: Mapping[str, float]) -> dict[str, float]:
    return {**dict.fromkeys(one_tip.PARAMETERS, 0.0), **MIDDLE, **aim}


def drawn(
    aim: Mapping[str, float], rng: np.random.Generator, share: float = 1.0
) -> dict[str, float]:
    found = middle(aim)
    for name, reach in REACH.items():
        found[name] += share * reach * rng.uniform(-1.0, 1.0)
    return found


def point(v: Mapping[str, float]) -> dict[str, Interval]:
    return {name: Interval.point(value) for name, value in v.items()}


def around(aim: Mapping[str, float], share: float = 1.0) -> dict[str, Interval]:
    box = point(middle(aim))
    for name, reach in REACH.items():
        centre = middle(aim)[name]
        box[name] = Interval(centre - share * reach, centre + share * reach)
    return box


def margins(of: Implicit) -> list[str]:
    return [name for name in of.outputs if name not in one_tip.POSE]


def at(of: Implicit, v: Mapping[str, float], guess: float) -> Ends:
    ends = bound(of, point(v), guess, both=of.outputs)
    assert ends is not None
    return ends


def close(ends: Ends, name: str, value: float, room: float) -> None:
    assert ends.lower[name] - room <= value <= ends.upper[name] + room, name
    assert ends.upper[name] - ends.lower[name] < 20.0 * room, name


def after_tilt(v: Mapping[str, float], side: int) -> tuple[Floats, Floats]:
    """Pose and place of the disc at the end, from the plant; what strays at the end is added."""
    length, way = plant.travel(v)
    c, s = -way
    astray = [v[f"wander_{axis}_now"] - v[f"wander_{axis}"] for axis in "xy"]
    last = length - astray[0] * c - astray[1] * s
    pose, disc, _ = plant.turn(v, -side, last)
    return pose, disc


@pytest.mark.parametrize(("side", "aim"), [(1, TILT), (-1, BACK)])
def test_a_tilt_is_that_of_a_disc_that_pushes_a_part(side: int, aim: dict[str, float]) -> None:
    rng, of = np.random.default_rng(5), one_tip.tilt(side)
    for _ in range(12):
        v = drawn(aim, rng) | {"share": 1.0, "bend": 0.0, "last": 790 * UM}
        ends = at(of, v, np.pi / 2 + side * 0.06)
        pose, disc = after_tilt(v, side)
        end = plant.tips(v, "_now")[-side] + plant.travel(v)[0] * plant.travel(v)[1]
        pose[:2] += end - disc  # across the push: the part goes along
        for name, value, room in zip("xy", pose[:2], (1e-9, 1e-9), strict=True):
            close(ends, name, value, room)
        close(ends, "theta", pose[2], 1e-6)
        _, offset = plant.contact(v, pose, -side, end)
        close(ends, "pushing_below_end", v["last"] - offset, 1e-9)
        close(ends, "reaches", plant.travel(v)[0] - plant.touch(v, -side), 5e-6)
        force = plant.balance(v, pose, -side, end, "_now")[1]
        mu = v["mu_lower_now" if side > 0 else "mu_upper_now"]
        pushes = ends.lower["pushing_pushes"]
        for name, sign in (("sticks_up", 1.0), ("sticks_down", -1.0)):
            ratio = ends.lower[f"pushing_{name}"] / pushes
            assert ratio == pytest.approx(mu - sign * force[0] / force[1], abs=1e-5)
        twist = plant.balance(v, pose, -side, end, "_now")[0]
        scale = pushes / force[1]
        assert ends.lower["pushing_turns"] / scale == pytest.approx(side * twist[2], rel=1e-5)
        more = plant.balance(v, pose, -side, end, "_now", slip=1.0)[1] - force
        for name, sign in (("only_up", -1.0), ("only_down", 1.0)):
            stiffness = ends.lower[f"pushing_{name}"] / scale
            assert stiffness == pytest.approx(more[0] + sign * mu * more[1], rel=1e-5)


@pytest.mark.parametrize(("side", "aim"), [(1, TILT), (-1, BACK)])
def test_clearances_of_a_tilt_are_distances(side: int, aim: dict[str, float]) -> None:
    rng, of = np.random.default_rng(6), one_tip.tilt(side)
    for _ in range(5):
        v = drawn(aim, rng) | {"bend": 0.0, "share": 0.0}
        for axis in "xy":
            v[f"stray_{axis}"] = v[f"wander_{axis}_now"] = v[f"wander_{axis}"]
        ends = at(of, v, np.pi / 2 + side * 0.06)
        before = np.array([v["x"], v["y"], v["theta"]])
        for tip in (1, -1):
            of_tip = one_tip.passing(tip)
            there = v | {"line_turn": v["turn"] - v["kappa"], "line_depth": v["depth"]}
            for share, along in ((0.0, 0.0), (0.5, 0.5)):
                inputs = [(there | {"share": share})[name] for name in of_tip.inputs]
                place = plant.tips(v)[tip] + along * plant.travel(v)[0] * plant.travel(v)[1]
                apart = plant.off_line(v, before, tip, place)
                assert float(of_tip.function(inputs)) == pytest.approx(apart, abs=1e-11)
        pose, _ = after_tilt(v, side)
        idle = plant.tips(v)[side] + plant.travel(v)[0] * plant.travel(v)[1]
        for when, at_pose, place in (
            ("before_touch", before, plant.tips(v)[side]),
            ("on_withdrawal", pose, idle),
        ):
            normal = at_pose[2] + np.pi / 2  # of the line that is a quarter turn on
            out = np.array([np.sin(normal), -np.cos(normal)])
            distance = out @ (place - at_pose[:2]) - 808 * UM - plant.radius(v, side)
            close(ends, when, float(distance), 2e-9)


@pytest.mark.parametrize("path", [(0.01, "bend"), (0.0, "straight")])
def test_a_path_that_is_bent_all_the_way_turns_the_part_as_integrated(
    path: tuple[float, str],
) -> None:
    """A tangent of the deviation of ``path[0]`` all along, which ends as far astray as it must."""
    rng = np.random.default_rng(7)
    v = drawn(TILT, rng) | {"bend": path[0]}
    _, way = plant.travel(v)
    length = plant.travel(v)[0]
    pose, _, progress = plant.turn(v, -1, length)
    across = np.array([way[1], -way[0]]) * -path[0] * progress
    v |= {f"wander_{axis}_now": v[f"wander_{axis}"] + across[k] for k, axis in enumerate("xy")}
    ends = at(one_tip.tilt(1), v, np.pi / 2 + 0.06)
    for name, value in zip("xy", pose[:2], strict=True):
        close(ends, name, value, 1e-9)
    close(ends, "theta", pose[2], 1e-6)


@pytest.mark.parametrize("part_end", [1.0, 0.0], ids=["to the part", "to the world"])
def test_a_straightening_is_that_of_two_discs(part_end: float) -> None:
    rng, of = np.random.default_rng(8), one_tip.straighten(-1)
    for _ in range(12):
        v = drawn(STRAIGHT, rng) | {"share": 1.0, "bend": 0.0, "part_end": part_end}
        v |= {f"wander_{axis}_now": v[f"wander_{axis}"] for axis in "xy"}
        ends = at(of, v, np.pi / 2)
        length, way = plant.travel(v)
        apart = plant.tips(v)[1] - plant.tips(v)[-1]
        pose, disc, progress = plant.turn(v, -1, length, both_touch(v))
        left = length - plant.touch(v, -1) - progress
        close(ends, "spare", left, 2e-9)
        for k, axis in enumerate("xy"):
            close(ends, axis, pose[k] + left * way[k], 2e-9)
        close(ends, "theta", pose[2], 1e-6)
        _, first = plant.contact(v, pose, -1, disc)
        _, second = plant.contact(v, pose, 1, disc + apart)
        close(ends, "second_below_end", v["last"] - second, 1e-9)
        close(ends, "first_below_end", v["last"] - first, 1e-9)
        _pair(v, ends, pose, first, second)


def both_touch(v: Mapping[str, float]) -> Callable[[Floats, Floats], float]:
    """How far the upper tip is off the line when the lower one is at a place."""
    apart = plant.tips(v)[1] - plant.tips(v)[-1]
    return lambda pose, disc: plant.off_line(v, pose, 1, disc + apart)


def turned_to(theta: float) -> Callable[[Floats, Floats], float]:
    return lambda pose, _: float(pose[2] - theta)


def _pair(v: Mapping[str, float], ends: Ends, pose: Floats, first: float, second: float) -> None:
    """Forces that a translation takes, shared by two contacts so that nothing turns the part."""
    along, out = plant.edge(v, pose[2])
    phi, bend = v["direction"], v["bend_now"]
    speed = -np.array([np.cos(phi) - bend * np.sin(phi), np.sin(phi) + bend * np.cos(phi)])
    drag = np.array(
        [[1 + v["stretch_now"], v["shear_now"]], [v["shear_now"], 1 - v["stretch_now"]]]
    )
    force = drag @ np.array([along @ speed, out @ speed])
    pressing = -force[1]
    assert ends.lower["pair_sticks_0"] == pytest.approx(v["mu_upper_now"] * pressing - force[0])
    assert ends.lower["pair_sticks_1"] == pytest.approx(v["mu_upper_now"] * pressing + force[0])
    turning = [
        (second - v["drag_a"]) + share * v["mu_upper_now"] * (v["depth"] - v["drag_n"])
        for share in (-1.0, 0.0, 1.0)  # of the cone: moment of a force that presses by 1
    ]
    assert ends.lower["second_turns_any_way"] == pytest.approx(min(turning), abs=1e-9)
    # moments about the upper contact tell the force of the lower one: the drag acts at its centre
    arm = np.array([v["drag_a"] - second, v["drag_n"] - v["depth"]])
    moment = arm[0] * force[1] - arm[1] * force[0]
    lower = moment / (second - first)
    assert ends.lower["pair_pushes_1"] / (second - first) == pytest.approx(lower, rel=1e-6)
    assert ends.lower["pair_pushes_0"] / (second - first) == pytest.approx(
        pressing - lower, rel=1e-6
    )


@pytest.mark.parametrize(("side", "aim"), [(1, TILT), (-1, BACK)])
def test_runs_within_a_box_end_in_its_box_of_poses(side: int, aim: dict[str, float]) -> None:
    """Of parameters at corners and in between; the box is at most 1.1 times what they fill."""
    of, rng, guess = one_tip.tilt(side), np.random.default_rng(9), np.pi / 2 + side * 0.06
    ends = bound(of, around(aim), guess, both=one_tip.POSE, lower=margins(of))
    assert ends is not None
    seen = []
    for _ in range(60):
        v = drawn(aim, rng)
        one = at(of, v, guess)
        seen.append([one.lower[name] for name in one_tip.POSE])
        assert all(one.upper[name] >= ends.lower[name] for name in margins(of))
    for name, low, high in zip(one_tip.POSE, np.min(seen, 0), np.max(seen, 0), strict=True):
        assert ends.lower[name] <= low
        assert high <= ends.upper[name]
        assert ends.upper[name] - ends.lower[name] < 1.1 * _widest(of, aim, guess, name)


def _widest(of: Implicit, aim: Mapping[str, float], guess: float, name: str) -> float:
    """What corners of the box reach: every parameter at the end to which a single change points."""
    base, found = middle(aim), []
    ends = {}
    for key, reach in REACH.items():
        up, down = (at(of, base | {key: base[key] + sign * reach}, guess) for sign in (1.0, -1.0))
        ends[key] = reach if up.lower[name] > down.lower[name] else -reach
    for sign in (1.0, -1.0):
        corner = base | {key: base[key] + sign * reach for key, reach in ends.items()}
        found.append(at(of, corner, guess).lower[name])
    return found[0] - found[1]


def test_friction_that_differs_and_a_film_that_changes_stay_in_the_box() -> None:
    """rho jumps on the way, from one end of its range to the other."""
    of, rng = one_tip.tilt(1), np.random.default_rng(10)
    ends = bound(of, around(TILT), np.pi / 2 + 0.06, both=one_tip.POSE)
    assert ends is not None
    for _ in range(6):
        v = drawn(TILT, rng) | {"bend": 0.0}
        v |= {f"wander_{axis}_now": v[f"wander_{axis}"] for axis in "xy"}
        length, way = plant.travel(v)
        half = 0.5 * (length + plant.touch(v, -1))
        pose, disc, _ = plant.turn(v | {"rho": 0.95 * RHO}, -1, half)
        now = v | dict(zip(one_tip.POSE, pose, strict=True)) | {"rho": 1.05 * RHO}
        now |= {"offset_x": disc[0] - v["probe_x"] - v["wander_x"], "part_x": 0.0, "part_y": 0.0}
        now |= {"offset_y": disc[1] - v["probe_y"] - v["wander_y"]}
        lower = 0.5 * v["spacing"] * np.array([-np.tan(v["beta"]), 1.0])
        now["offset_x"] += lower[0]
        now["offset_y"] += lower[1]
        now |= {"part_end": 0.0, "offset_end": now["offset_x"] - (length - half) / (1 + v["scale"])}
        later, _, _ = plant.turn(now, -1, length - half)
        for name, value in zip(one_tip.POSE, later, strict=True):
            assert ends.lower[name] - 1e-9 <= value <= ends.upper[name] + 1e-9
        assert np.isclose(plant.travel(now)[0], length - half)
        del way


def test_a_margin_that_a_corner_breaks_is_not_proved() -> None:
    """Farther off the middle the contact slips somewhere in the box, though not in its middle."""
    of = one_tip.tilt(1)
    proved = bound(of, around(TILT), np.pi / 2 + 0.06, lower=["pushing_sticks_down"])
    farther = aimed(offset=320 + 300, ahead=452, end=278)
    broken = bound(of, around(farther), np.pi / 2 + 0.06, lower=["pushing_sticks_down"])
    nominal = at(of, middle(farther) | {"share": 1.0}, np.pi / 2 + 0.06)
    assert proved is not None
    assert broken is not None
    assert proved.lower["pushing_sticks_down"] > 0.0 >= broken.lower["pushing_sticks_down"]
    assert nominal.lower["pushing_sticks_down"] > 0.0
    assert bound(of, around(farther), np.pi / 2 + 0.06, lower=margins(of), proofs_only=True) is None


def test_the_poses_on_the_way_are_in_the_tube() -> None:
    box = around(TILT)
    guess = np.pi / 2 + 0.06
    for low in (0.0, 0.5):
        there = bound(
            one_tip.tilt_tube(1),
            box | {"share": Interval(low, low + 0.5)},
            guess,
            both=one_tip.POSE,
        )
        assert there is not None
        rng = np.random.default_rng(11)
        for _ in range(8):
            v = drawn(TILT, rng) | {"bend": 0.0}
            v |= {f"wander_{axis}_now": v[f"wander_{axis}"] for axis in "xy"}
            end, _ = after_tilt(v, 1)
            for part in (low + 0.1, low + 0.4):
                target = v["theta"] + part * (end[2] - v["theta"])
                pose, _, _ = plant.turn(v, -1, plant.travel(v)[0], turned_to(target))
                for name, value in zip(one_tip.POSE, pose, strict=True):
                    assert there.lower[name] - 1e-9 <= value <= there.upper[name] + 1e-9


def test_the_height_after_a_tilt_and_a_straightening_is_kept_together() -> None:
    """Both moves by the plant, one after the other, with errors of their own."""
    of, rng = one_tip.straighten_height(-1, 1), np.random.default_rng(12)
    mine = (*one_tip.BEFORE, *one_tip.BEFORE_AIM)
    for _ in range(6):
        first = drawn(TILT, rng) | {"bend": 0.0, "wander_x_now": 0.0, "wander_y_now": 0.0}
        first |= {"wander_x": 0.0, "wander_y": 0.0}
        tilted, _ = after_tilt(first, 1)
        second = drawn(STRAIGHT, rng) | dict(zip(one_tip.POSE, tilted, strict=True))
        shared = (*one_tip.TIPS, *one_tip.PART)
        second |= {name: first[name] for name in shared} | {"bend": 0.0}
        second |= dict.fromkeys(("wander_x", "wander_y", "wander_x_now", "wander_y_now"), 0.0)
        length, way = plant.travel(second)
        pose, _, progress = plant.turn(second, -1, length, both_touch(second))
        left = length - plant.touch(second, -1) - progress
        together = second | {f"tilt_{name}": first[name] for name in mine}
        ends = bound(of, point(together), HALF_PI.lo, both=("y",))
        assert ends is not None
        close(ends, "y", pose[1] + left * way[1], 2e-9)
