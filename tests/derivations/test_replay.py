"""Witnesses of the register, replayed in the simulator, which shares no code with the derivations."""

from __future__ import annotations

import json
from functools import cache

import numpy as np
import numpy.typing as npt
import pytest
import sympy as sp

from derivations import report
from meso_robust.simulator import Outcome, Push, simulate
from tests.simulator.problems import UM, in_body, rectangle

F = npt.NDArray[np.float64]


@cache
def witness(key: str, number: int = 0) -> dict[str, float]:
    """The values at which a printed statement fails (or an existence holds), lengths in µm."""
    register = json.loads((report.FOLDER / "register.json").read_text(encoding="utf-8"))
    (claim,) = [claim for claim in register["claims"] if claim["key"] == key]
    shown = [finding["witness"] for finding in claim["findings"] if finding["witness"]]
    return {name: float(sp.Rational(value)) for name, value in shown[number].items()}


def pushed(
    at: dict[str, float], theta: float, tips: list[list[float]], travel: F, step: float
) -> Push:
    """The witness's part at the origin, with given tips (µm)."""
    half_short = at["d1"] * UM
    return Push.straight(
        vertices=rectangle(808 * UM, half_short),
        poses=np.array([[0.0, 0.0, theta]]),
        tips=np.array([tips]) * UM,
        travel=travel[None] * UM,
        friction=np.array([at["mu"]]),
        film_ratio=np.array([at["rho"] * UM**2]),
        step=step * UM,
    )


def contact(at: dict[str, float], theta: float, offset: float) -> list[float]:
    """Where a tip at ``offset`` along the edge touches it, in µm."""
    a = np.array([np.cos(theta), np.sin(theta)])
    n = np.array([np.sin(theta), -np.cos(theta)])
    return list(offset * a + at["d1"] * n)


def offsets(push: Push, path: F, tip: int = 0) -> F:
    """Place of a tip along the edge during the push, in m."""
    start, end = push.waypoints[0, :, tip]
    share = np.linspace(0, 1, path.shape[0])[:, None]
    return in_body(path, start + share * (end - start))[:, 0]


def test_lemma_1_the_contact_slips_before_the_printed_limit() -> None:
    at = witness("lemma-1")
    start = np.arctan2(at["sin(theta_0)"], at["cos(theta_0)"])
    refuted = np.arctan2(at["sin(theta)"], at["cos(theta)"])
    A, B, C = at["d1"] * at["d2"], at["rho"] + at["d1"] ** 2, at["rho"] + at["d2"] ** 2
    limit = np.pi - np.arctan2(C + at["mu"] * A, A + at["mu"] * B)
    printed = np.pi - max(np.arctan(at["d1"] / at["d2"]), np.arctan(A / B))
    assert limit < refuted < printed
    travel = np.array([[-1000.0, 0.0]])
    push = pushed(at, start, [contact(at, start, at["d2"])], travel, 0.1)
    path = simulate(push, record=10000).path[0]
    theta, drift = path[:, 2], np.abs(offsets(push, path) - at["d2"] * UM)
    sticking = theta < limit - np.radians(0.3)
    assert np.degrees(theta[0]) < 91
    assert theta[-1] > refuted  # the push reaches the witness
    assert np.max(drift[sticking]) < 0.2 * UM
    assert drift[np.argmin(np.abs(theta - refuted))] > 2 * UM
    assert np.degrees(limit) == pytest.approx(120.96, abs=0.01)


@pytest.mark.parametrize(
    ("separation", "outcome"), [(857.0, Outcome.JAM), (885.0, Outcome.COMPLETED)]
)
def test_equation_10_the_part_jams_at_the_printed_separation(
    separation: float, outcome: Outcome
) -> None:
    at = witness("eq-10")
    assert at["V"] == 857
    width = 2 * at["d1"]
    along = np.sqrt(at["h"] ** 2 + separation**2 - width**2)
    theta = np.arctan2(separation, at["h"]) + np.arcsin(width / np.hypot(at["h"], separation))
    if separation == at["V"]:
        assert along == pytest.approx(at["T"])
        assert np.sin(theta) == pytest.approx(at["sin(theta)"])
    n = np.array([np.sin(theta), -np.cos(theta)])
    active = np.array(contact(at, theta, along / 2)) + 1e-3 * n  # a nanometre clear of the part
    passive = -active
    travel = np.array([[0.0, 0.0], [-20.0, 0.0]])
    push = pushed(at, theta, [list(passive), list(active)], travel, 0.05)
    assert simulate(push).outcomes[0] == outcome


def test_equation_11_the_tilt_after_the_reported_push() -> None:
    """At a friction for which the part does not jam at that separation."""
    at = {**witness("eq-11"), "mu": 0.1, "rho": 376_900.0}
    tilt = np.arctan2(at["sin(psi)"], at["cos(psi)"])
    printed = np.arctan2(at["sin(psi_end)"], at["cos(psi_end)"])
    width = 2 * at["d1"]
    tips = [[-width / 2, -at["V"] / 2], [width / 2, at["V"] / 2]]
    travel = np.array([[0.0, 0.0], [at["h"] - width, 0.0]])
    result = simulate(pushed(at, np.pi / 2, tips, travel, 0.2))
    assert result.outcomes[0] == Outcome.COMPLETED
    assert np.pi - result.poses[0, 2] == pytest.approx(tilt, abs=np.radians(0.01))
    assert tilt > 5 * printed


def test_lemma_3_the_first_contact_slips_although_12_holds() -> None:
    at = witness("lemma-3")
    theta = np.arctan2(at["p_y"], at["p_x"])
    travel = np.array([[-20.0, 0.0]])
    push = pushed(at, theta, [contact(at, theta, at["d2"])], travel, 0.05)
    path = simulate(push, record=400).path[0]
    drift = offsets(push, path) - at["d2"] * UM
    assert np.all(np.abs(np.diff(drift)) > 1e-3 * push.step)  # from the first step on


def test_lemma_3_the_first_tip_leaves_although_12_holds() -> None:
    """The centre is not between the tips: once both touch, the part goes on turning on tip 2."""
    at = witness("lemma-3", 1)
    theta = np.arctan2(at["p_y"], at["p_x"])
    beta = np.arctan2(at["sin(beta)"], at["cos(beta)"])
    first = contact(at, theta, at["d2"])
    # the line through the tips is at pi/2 - beta, tip 2 a spacing d4 below
    second = [first[0] - at["d4"] * np.tan(beta), first[1] - at["d4"]]
    travel = np.array([[-300.0, 0.0], [-300.0, 0.0]])
    push = pushed(at, theta, [first, second], travel, 0.1)
    result = simulate(push, record=3000)
    assert result.poses[0, 2] > np.pi / 2 - beta + np.radians(1)  # past the two-point orientation
    narrow = {**at, "d4": 580.0}  # with the centre between the tips it stays
    second = [first[0] - narrow["d4"] * np.tan(beta), first[1] - narrow["d4"]]
    push = pushed(narrow, theta, [first, second], travel, 0.1)
    settled = simulate(push).poses[0, 2]
    assert settled == pytest.approx(np.pi / 2 - beta, abs=np.radians(0.01))
