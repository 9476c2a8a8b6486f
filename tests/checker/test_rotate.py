"""A rotation between real tips: pushes integrated from balance end where the checker proves."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest
from flint import arb, ctx

from meso_robust.checker.document import AimDocument, RuleDocument
from meso_robust.checker.inputs import Given, PoseBox, given
from meso_robust.checker.moves import verify_scene
from meso_robust.checker.pair import Pair
from meso_robust.checker.passage import Passage
from meso_robust.checker.refusal import Refused
from meso_robust.checker.rotate import _far_force_faces
from meso_robust.checker.scene import Scene, scene_of
from meso_robust.checker.verdict import BITS
from meso_robust.task import Task
from tests.checker.balance import Alone, Held, Numbers
from tests.nightly import often

UM = 1e-6
SPACING, RISE, APART = 580.0, 150.0, 960.0
"""um: of the tips of the active probe; of the middle of both that push; between these, across."""
AHEAD, BACK, END = 480.0, -445.0, -850.0
"""Where the active and the passive tip start and the active one ends, from the part along x, um."""


@pytest.fixture(autouse=True)
def precision() -> Iterator[None]:
    with ctx.workprec(BITS):
        yield


def task(share: float, **changes: Any) -> Task:
    """The paper's, with a share of what may be uncertain about real tips and parts."""
    values = Task.paper().to_dict()
    values["schema"] = "meso-robust/task/2"
    values["part"] |= {"size_tolerance_um": 2 * share, "squareness_deg": 0.1 * share}
    values["probe"] |= {
        "tip_radius_um": [5 - 2 * share, 5 + 2 * share],
        "passive_tip_radius_um": [9 - 2 * share, 9 + 2 * share],
        "tip_spacing_tolerance_um": 0.5 * share,
        **changes.get("probe", {}),
    }
    values["uncertainty"] |= {
        "friction": [0.33 - 0.03 * share, 0.33 + 0.03 * share],
        "travel_direction_deg": [0.1 - 0.1 * share, 0.1 + 0.1 * share],
        "travel_scale_percent": 0.5 * share,
        "drag_centre_um": 20 * share,
        "drag_anisotropy_percent": 5 * share,
        "sensed_position_um": 5 * share,
        "probe_position_um": 5 * share,
        "film_ratio_percent": 5 * share,
        "tip_misalignment_deg": [-0.25 * share, 0.25 * share],
    }
    if "film" in changes:
        values["film"] = changes["film"]
    return Task.from_dict(values)


def rule(apart: float = APART) -> RuleDocument:
    x, y, end, x_passive, y_passive = (
        AimDocument(relative_to="sensed part", offset_um=value)
        for value in (AHEAD, RISE + (apart + SPACING) / 2, END, BACK, RISE - apart / 2)
    )
    return RuleDocument(
        step=4, primitive="t", action="rotate", side=1, dual_x=x, dual_y=y, dual_end_x=end,
        single_x=x_passive, single_y=y_passive, heading="-x", mirrored=False,
    )  # fmt: skip


def scene(known: Given, share: float, apart: float = APART) -> Scene:
    reach = arb(5 * share * UM)
    side, right = (-reach, reach), arb.pi() / 2
    lean = arb(0.005 * share)
    pre = PoseBox(x=side, y=side, theta=(right - lean, right + lean))
    return scene_of(rule(apart), pre, known)


SHARE = 0.1


@cache
def proved() -> tuple[Scene, Passage]:
    known = given(task(SHARE))
    found = scene(known, SHARE)
    return found, verify_scene(found, known, None)


@pytest.mark.parametrize(("friction", "refused"), [("1.19", False), ("1.20", True)])
def test_a_force_in_the_far_cone_of_friction_faces_the_pushed_edge(
    friction: str, refused: bool
) -> None:
    """Edges 40 deg out of parallel: friction up to 1 / tan(40 deg) = 1.1918, with squareness."""
    known = given(task(SHARE))
    found = scene(known, SHARE)
    turned = max(abs(end) for end in found.box["kappa"]) + max(
        abs(end) for end in found.box["kappa_other"]
    )
    askew = 2 * arb.pi() / 9 - turned
    box = dict(found.box) | {
        name: (arb(0), arb(friction)) for name in found.box if name[:2] == "mu"
    }
    pair = Pair(replace(found, askew=askew, box=box))
    if not refused:
        _far_force_faces(pair)
        return
    with pytest.raises(Refused) as told:
        _far_force_faces(pair)
    assert told.value.name.id == "edges_opposite"


def pushed(values: Numbers, rng: np.random.Generator) -> tuple[float, float, float]:
    """Pose of the part after the push, axes of the move, and the largest normal force."""
    phi = values["direction"]
    turn = np.array([[np.cos(phi), -np.sin(phi)], [np.sin(phi), np.cos(phi)]])  # from the travel's
    commanded = np.array([values["x"] + values["sensed_x"], values["y"] + values["sensed_y"]])
    active = commanded + np.array([AHEAD, RISE + (APART + SPACING) / 2]) * UM
    active += [values["probe_x"], values["probe_y"]]
    lower = active - values["spacing"] / 2 * np.array([-np.tan(values["beta"]), 1.0])
    passive = commanded + np.array([BACK, RISE - APART / 2]) * UM
    passive += [values["passive_x"], values["passive_y"]]
    tip, rest, part = (turn.T @ place for place in (lower, passive, [values["x"], values["y"]]))
    angle = values["theta"] + values["kappa"] - phi
    left = (AHEAD - END) * UM * (1 + values["scale"])
    n = {
        **values,
        "V": tip[1] - rest[1],
        "depth_far": 418.5 * UM + values["size_far"],
        "radius": values["radius_lower"],
        "radius_far": values["radius_passive"],
        "tilt": np.tan(values["kappa_far"] - values["kappa"]),
    }
    friction = values["mu_lower"], values["mu_passive"]
    instants = {name: values[name] for name in ("rho", "stretch", "shear")}

    def out(place: np.ndarray, direction: float) -> float:
        return float((place - part) @ [np.sin(direction), -np.cos(direction)])

    flight = (out(tip, angle) - n["depth"] - n["radius"]) / np.sin(angle)
    tip, left = tip - [flight, 0.0], left - flight
    step = UM
    far = angle + np.arctan(n["tilt"])
    while -out(rest, far) - n["depth_far"] - n["radius_far"] > 0:
        motion = Alone(angle, tip - part, {**n, **instants}).motion(friction[0])
        part, angle, far = (
            part + step * motion[:2],
            angle + step * motion[2],
            far + step * motion[2],
        )
        tip, left = tip - [step, 0.0], left - step
    ahead = float((part - rest) @ [np.cos(angle), np.sin(angle)])
    step = 2 * UM
    h = tip[0] - rest[0]
    while left > 0:
        step = min(step, left)
        held = Held.at({**n, **instants}, h, ahead)
        ahead += step * held.rate(held.motions(friction)[0], 1)
        h, left = h - step, left - step
    held = Held.at({**n, **instants}, h, ahead)
    place = turn @ (rest - held.centres[1])
    edge = np.arctan2(held.edges[0][1], held.edges[0][0])
    return float(place[0]), float(place[1]), float(edge - values["kappa"] + phi)


def test_pushes_end_in_the_box() -> None:
    found, passage = proved()
    box = {**found.box, "size_far": found.box["size_other"], "kappa_far": found.box["kappa_other"]}
    rng, ends = np.random.default_rng(0), []
    for run in range(often(6, 12)):
        values = {}
        for name, (low, high) in sorted(box.items()):
            share = rng.choice((0.0, 1.0)) if run % 2 else rng.uniform()
            values[name] = float(low) + share * float(high - low)
        ends.append(pushed(values, rng))
    post = [passage.post.x, passage.post.y, passage.post.theta]
    for end in ends:
        for value, (low, high) in zip(end, post, strict=True):
            assert float(low) - 2e-7 <= value <= float(high) + 2e-7  # of the steps of the runs
    spread = np.ptp(np.array(ends), axis=0)
    widths = [float(high - low) for low, high in post]
    assert np.all(spread > 0.15 * np.array(widths))


def test_tips_that_could_jam_the_part_are_refused() -> None:
    known = given(task(0.0))
    with pytest.raises(Refused, match=r"jam|close"):
        verify_scene(scene(known, 0.0, 885.0), known, None)
