"""Turns of real parts by real tips: what the checker proves, against pushes integrated from balance."""

from __future__ import annotations

import math
import random
from collections.abc import Callable
from functools import cache, partial
from typing import Any

import numpy as np
import pytest
from flint import arb, ctx

from meso_robust.checker.document import AimDocument, RuleDocument
from meso_robust.checker.dual import Dual
from meso_robust.checker.inputs import Given, PoseBox, given
from meso_robust.checker.moves import verify_move
from meso_robust.checker.passage import Passage
from meso_robust.checker.ranges import Box, least
from meso_robust.checker.requirement import Requirement
from meso_robust.checker.scene import Scene
from meso_robust.checker.verdict import BITS
from meso_robust.task import Task
from tests.checker.real_tips import Push, Vector
from tests.nightly import often

FULL: dict[str, dict[str, Any]] = {
    "part": {"size_tolerance_um": 4.0, "squareness_deg": 0.1},
    "probe": {
        "tip_radius_um": [2.5, 12.5],
        "tip_spacing_um": 580.0,
        "tip_spacing_tolerance_um": 2.0,
    },
    "uncertainty": {
        "friction": [0.38, 0.42],
        "travel_direction_deg": [-0.1, 0.1],
        "travel_scale_percent": 0.5,
        "drag_centre_um": 20.0,
        "drag_anisotropy_percent": 5.0,
    },
}
WANDER: dict[str, dict[str, Any]] = {"uncertainty": {"probe_wander_um": 1.0}}
MOVING: dict[str, dict[str, Any]] = {"uncertainty": {"drag_centre_moves": True}}
TILT, STRAIGHTEN = (485.0, 600.0, 290.0), (540.0, 30.0, 80.0)
"""Offsets of a push from the sensed part: x, y, x at the end, um."""
SCALES = {"tip_pushes": 1e-7, "tip_sticks": 5e-8, "tip_turns_part": 1e-4}
"""How far runs at corners may stay above what is proved for all; m^2, and m."""
PER_RUN = ("stretch", "shear", "rho", "centre_a", "centre_n")


@pytest.fixture(autouse=True)
def precision() -> Any:
    with ctx.workprec(BITS):
        yield


def task(*changes: dict[str, dict[str, Any]]) -> Task:
    """The paper's task with real tips."""
    values = Task.paper().to_dict()
    values["schema"] = "meso-robust/task/2"
    for change in ({"probe": {"tip_radius_um": [0.0, 0.0]}}, *changes):
        for section, own in change.items():
            values[section] |= own
    return Task.from_dict(values)


def rule(
    action: str, offsets: tuple[float, float, float], *, mirrored: bool = False
) -> RuleDocument:
    aims = [AimDocument(relative_to="sensed part", offset_um=value) for value in offsets]
    return RuleDocument(
        step=1, primitive="t", action=action, side=1 if action == "tilt" else 0, dual_x=aims[0],
        dual_y=aims[1], dual_end_x=aims[2], single_x=None, single_y=None, heading="-x",
        mirrored=mirrored,
    )  # fmt: skip


class Proved:
    """A tilt and the straightening after it."""

    def __init__(self, known: Given) -> None:
        self.given = known
        self.tilt, self.tilted = verify_move(rule("tilt", TILT), known.start, known, None)
        self.post = self.tilt.frame.world(self.tilted.post)
        self.straighten, self.straightened = verify_move(
            rule("straighten", STRAIGHTEN), self.post, known, self.tilted.memory
        )


@cache
def proved(*, wander: bool = False, moving: bool = False) -> Proved:
    return Proved(given(task(FULL, *[WANDER] * wander, *[MOVING] * moving)))


def drawn(box: Box, rng: random.Random, *, corner: bool) -> dict[str, float]:
    """A point of a box of variables."""

    def of(low: float, high: float) -> float:
        return rng.choice((low, high)) if corner else rng.uniform(low, high)

    # a centre of drag that moves last: what is drawn without one stays as it is
    names = sorted(box, key=lambda name: (name.startswith("centre"), name))
    return {name: of(*map(float, box[name])) for name in names}


def push_of(scene: Scene, values: dict[str, float], offsets: tuple[float, float, float]) -> Push:
    """The push that a rule asks for at one value of everything, its middle on a grid of no kind."""
    x, y, end = (offset * 1e-6 for offset in offsets)
    sensed = np.array([values["x"] + values["sensed_x"], values["y"] + values["sensed_y"]])
    return Push(values, sensed + np.array([x, y]), x - end)


def changing(box: Box, rng: random.Random) -> Callable[[float], Vector]:
    """A film that changes on the way, from end to end of its ranges."""
    ends = [[float(end) for end in box[name]] for name in PER_RUN]
    switches = [[rng.random() for _ in range(3)] for _ in PER_RUN]
    first = [rng.getrandbits(1) for _ in PER_RUN]

    def film(share: float) -> Vector:
        return np.array(
            [
                ends[k][(first[k] + sum(share > one for one in switches[k])) % 2]
                for k in range(len(PER_RUN))
            ]
        )

    return film


def straying(box: Box, rng: random.Random, length: float) -> Callable[[float], Vector]:
    """A path that strays as far and as fast as it may."""
    most = float(box["wander_x"][1])
    phase, share = rng.uniform(0, 2 * math.pi), rng.uniform(0.2, 1.0)
    wave = share * length / 100e-6  # its slope is at most the wander in 100 um

    def stray(at: float) -> Vector:
        return most * np.array([math.cos(phase + wave * at), math.sin(phase + wave * at)])

    return stray if most > 0 else (lambda _: np.zeros(2))


def inside(pose: Vector, box: PoseBox, room: float = 3e-8) -> bool:
    sides = (box.x, box.y, box.theta)
    return all(
        float(low) - room <= value <= float(high) + room
        for value, (low, high) in zip(pose, sides, strict=True)
    )


def own_box(scene: Scene, passage: Passage) -> PoseBox:
    """The box after a move, with the stated direction of the edge in the place of the orientation."""
    post = passage.post
    low, high = (end - scene.turn for end in post.theta)
    return PoseBox(x=post.x, y=post.y, theta=(low, high))


@pytest.mark.parametrize("more", ["", "wander", "moving"])
def test_runs_end_in_the_box_that_is_proved(more: str) -> None:
    """The box after a tilt, and after a straightening from where the tilt leaves the part."""
    known, rng = proved(**{more: True} if more else {}), random.Random(3)
    after_tilt, after = (
        own_box(known.tilt, known.tilted),
        own_box(known.straighten, known.straightened),
    )
    for k in range(often(8, 24)):
        values = drawn(known.tilt.box, rng, corner=k % 2 == 0)
        push = push_of(known.tilt, values, TILT)
        push.film = changing(known.tilt.box, rng)
        push.stray = straying(known.tilt.box, rng, push.length)
        pose = push.run(-1, second=False)
        assert inside(pose, after_tilt)
        # the part, the tips and the centre of drag are the same in the next move
        later = drawn(known.straighten.box, rng, corner=k % 2 == 0)
        lasting = (
            "beta",
            "spacing",
            "radius_upper",
            "radius_lower",
            "depth",
            "kappa",
            "drag_a",
            "drag_n",
        )
        later |= {name: values[name] for name in lasting}
        later |= dict(zip(("x", "y", "theta"), pose, strict=True))
        push = push_of(known.straighten, later, STRAIGHTEN)
        push.film = changing(known.straighten.box, rng)
        push.stray = straying(known.straighten.box, rng, push.length)
        assert inside(push.run(-1, second=True), after)


def test_the_box_after_a_tilt_is_no_larger_than_it_must_be() -> None:
    """Corners of the errors reach its ends: found by climbing from corner to corner."""
    known = proved()
    box, names = own_box(known.tilt, known.tilted), sorted(known.tilt.box)

    def pose(values: dict[str, float]) -> Vector:
        return push_of(known.tilt, values, TILT).run(-1, second=False)

    elsewhere = ("_now", "_other", "_passive", "_upper", "passive_x", "passive_y", "mu_lower")
    moving = [
        name
        for name, (low, high) in known.tilt.box.items()
        if low is not high and not name.endswith(elsewhere)
    ]
    middle = {n: sum(float(end) for end in known.tilt.box[n]) / 2 for n in names}
    slopes: dict[str, Vector] = {}
    for name in moving:
        low, high = (float(end) for end in known.tilt.box[name])
        reach = (high - low) / 20
        more, less = ({**middle, name: middle[name] + sign * reach} for sign in (1, -1))
        slopes[name] = pose(more) - pose(less)
    for axis, side in enumerate((box.x, box.y, box.theta)):
        width = float(side[1] - side[0])
        for end, sign in ((0, -1), (1, 1)):
            corner = dict(middle)
            for name in moving:
                low, high = (float(e) for e in known.tilt.box[name])
                corner[name] = high if slopes[name][axis] * sign > 0 else low
            assert abs(pose(corner)[axis] - float(side[end])) < 0.03 * width


def stated(passage: Passage, id_: str) -> list[Requirement]:
    return [one for one in passage.requirements if one.name.id == id_]


@pytest.mark.parametrize("move", ["tilt", "straighten"])
def test_what_acts_on_the_way_is_what_was_bounded(move: str) -> None:
    """Normal force, friction left, and turn, of runs: never below the bound over the whole move."""
    known, rng = proved(), random.Random(5)
    scene, passage, offsets = (
        (known.tilt, known.tilted, TILT) if move == "tilt" else (known.straighten, known.straightened, STRAIGHTEN)
    )  # fmt: skip
    which = {"tip": "pushing" if move == "tilt" else "lower"}
    bounds = {}
    for id_ in ("tip_pushes", "tip_sticks", "tip_turns_part"):
        (one,) = [r for r in stated(passage, id_) if r.name.about["tip"] == which["tip"]]
        part = one.parts[0]

        def value(k: int, at: Any, one: Any = one, part: Any = part) -> Dual:
            found = one.statement.of({n: of(at) for n, of in part.variables.items()}, arb(0))
            return found[k]

        count = 2 if id_ == "tip_sticks" else 1
        bounds[id_] = min(
            float(least(partial(value, k), part.box, within=1e-10)) for k in range(count)
        )
    attained = dict.fromkeys(bounds, math.inf)
    for k in range(16):
        values = drawn(scene.box, rng, corner=k % 4 != 0)
        push = push_of(scene, values, offsets)
        push.run(-1, second=move == "straighten")
        turns = 1 if move == "tilt" else -1
        for now in push.instants:
            d1, d2 = values["depth"] - values["drag_n"], now.d2 - values["drag_a"]
            st, sh = values["stretch"], values["shear"]
            nu = np.array([-d1, d2, 1.0])
            drag = np.array([[1 + st, sh, 0], [sh, 1 - st, 0], [0, 0, values["rho"]]])
            F = float(nu @ drag @ nu)
            attained["tip_pushes"] = min(attained["tip_pushes"], F * now.press)
            spare = values["mu_lower"] * now.press - abs(now.shear)
            attained["tip_sticks"] = min(attained["tip_sticks"], F * spare)
            attained["tip_turns_part"] = min(attained["tip_turns_part"], F * now.turn * turns)
    for id_, bound in bounds.items():
        assert 0.0 < bound <= attained[id_] + 1e-15
        assert attained[id_] < bound + SCALES[id_]  # and not far below
