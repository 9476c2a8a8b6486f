"""Motions with a fixed basis: tubes against closed form and integration, and modes that end."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from meso_robust.basis import Mode, MotionProof, Tip, diagonal_film, prove_motion, symbol
from meso_robust.bounds import Box, Interval, Verdict
from meso_robust.errors import InputError
from tests.basis.examples import LEFT, LONG, ONE, PAIR, RECTANGLE, SHORT
from tests.motion.sticking_reference import after

DEPTH = 0.5 * SHORT
FILM = diagonal_film("rho")
BOX = {
    "theta": Interval(1.65, 1.70),
    "d2": Interval(3.4e-4, 3.6e-4),
    "mu": Interval(0.30, 0.36),
    "rho": Interval(3.6e-7, 3.9e-7),
}
TRAVEL = 3e-4


@pytest.fixture(scope="module")
def sticking() -> MotionProof:
    return prove_motion(RECTANGLE, ONE, FILM, [Mode.STICK], BOX, TRAVEL)


def column(proof: MotionProof, name: str, knot: int = -1) -> Interval:
    return Interval(*proof.tube[knot, proof.names.index(name)].tolist())


def test_the_tube_holds_every_motion_by_force_balance(sticking: MotionProof) -> None:
    assert (sticking.verdict, sticking.unique) == (Verdict.PROVED, Verdict.PROVED)
    random = np.random.default_rng(2)
    ends = []
    for _ in range(12):
        theta, d2, rho = (
            random.choice([BOX[name].lo, BOX[name].hi]) for name in ("theta", "d2", "rho")
        )
        x, y, angle = after(theta, TRAVEL, DEPTH, d2, rho)
        ends.append(angle)
        assert x in column(sticking, "x")
        assert y in column(sticking, "y")
        assert angle in column(sticking, "theta")
    widest = max(ends) - min(ends)
    assert column(sticking, "theta").width < 1.3 * widest  # the tube is not idle


@pytest.mark.parametrize("steps", [2, 4, 8])
def test_a_few_long_steps_from_one_pose_hold_its_motion(steps: int) -> None:
    """One pose and one film: all the width there is comes from the curvature within a step."""
    values = {"theta": 1.68, "d2": 3.5e-4, "mu": 0.33, "rho": 3.75e-7}
    box = {name: Interval.point(value) for name, value in values.items()}

    proof = prove_motion(RECTANGLE, ONE, FILM, [Mode.STICK], box, TRAVEL, steps=steps)

    assert proof.verdict is Verdict.PROVED
    x, y, angle = after(values["theta"], TRAVEL, DEPTH, values["d2"], values["rho"])
    assert x in column(proof, "x")
    assert y in column(proof, "y")
    assert angle in column(proof, "theta")
    euler = column(proof, "theta").width  # 0.1 rad of turn: a step's curvature shows
    assert 1e-7 < euler < 0.1 / steps


def test_the_swept_boxes_hold_the_knots_on_both_sides(sticking: MotionProof) -> None:
    for knots in (sticking.tube[:-1], sticking.tube[1:]):
        assert np.all(sticking.swept[..., 0] <= knots[..., 0])
        assert np.all(knots[..., 1] <= sticking.swept[..., 1])


def test_a_motion_that_leaves_the_modes_is_refuted() -> None:
    """The part would have to turn past the end of the sticking interval (129 deg in print)."""
    proof = prove_motion(RECTANGLE, ONE, FILM, [Mode.STICK], BOX, 1.2e-3)
    assert proof.verdict is Verdict.REFUTED
    assert proof.tube.size == 0


def slipping(theta: float, d2: float, mu: float, rho: float, travel: float) -> tuple[float, float]:
    """Angle and place of a slipping tip, integrated from force balance in world axes."""

    def rate(_: float, state: np.ndarray) -> list[float]:
        c, s = np.cos(state[0]), np.sin(state[0])
        along, out = np.array([c, s]), np.array([s, -c])
        arm = state[1] * along + DEPTH * out
        # friction on the part along +along: the part slides along -along past the tip
        force = -out + mu * along
        v = force
        turn = (arm[0] * force[1] - arm[1] * force[0]) / rho
        point = v + turn * np.array([-arm[1], arm[0]])
        size = (-1.0 * out[0]) / (point @ out)
        slide = size * (point @ along) + 1.0 * along[0]
        return [size * turn, -slide]

    found = solve_ivp(rate, (0.0, travel), [theta, d2], rtol=1e-10, atol=1e-14)
    return float(found.y[0, -1]), float(found.y[1, -1])


def test_a_slipping_tip_drifts_as_integrated() -> None:
    box = {**BOX, "theta": Interval(2.30, 2.32), "mu": Interval(0.30, 0.31)}
    proof = prove_motion(RECTANGLE, ONE, FILM, [Mode.SLIP_MINUS], box, 1e-4)
    assert (proof.verdict, proof.unique) == (Verdict.PROVED, Verdict.PROVED)
    for theta, d2, mu, rho in ((2.30, 3.4e-4, 0.30, 3.6e-7), (2.32, 3.6e-4, 0.31, 3.9e-7)):
        angle, place = slipping(theta, d2, mu, rho, 1e-4)
        assert angle in column(proof, "theta")
        assert place - d2 in column(proof, "drift 0")
    assert column(proof, "drift 0").width < 2e-5


def test_two_sticking_tips_carry_the_part_along() -> None:
    box = {**BOX, "theta": Interval(1.53, 1.61), "d2": Interval(1.2e-4, 1.8e-4)}
    box["d4"] = Interval(3.0e-4, 3.1e-4)
    proof = prove_motion(RECTANGLE, PAIR, FILM, [Mode.STICK, Mode.STICK], box, 1e-3, steps=8)
    assert (proof.verdict, proof.unique) == (Verdict.PROVED, Verdict.PROVED)
    assert -1e-3 in column(proof, "x")
    assert 0.0 in column(proof, "y")
    assert column(proof, "theta").within(Interval(1.53 - 1e-12, 1.61 + 1e-12))


def test_a_tip_that_may_slide_off_its_edge_is_not_proved() -> None:
    box = {
        **BOX,
        "theta": Interval(2.30, 2.32),
        "d2": Interval(0.5 * LONG - 1e-6, 0.5 * LONG - 5e-7),
    }
    proof = prove_motion(RECTANGLE, ONE, FILM, [Mode.SLIP_MINUS], box, 1e-4, steps=16)
    assert proof.verdict is not Verdict.PROVED


@pytest.mark.parametrize(
    ("modes", "duration", "steps", "words"),
    [
        ([Mode.OPEN], 1e-4, 8, "OPEN"),
        ([Mode.STICK], 0.0, 8, "duration"),
        ([Mode.STICK], 1e-4, 12, "power"),
    ],
)
def test_bad_input_is_refused(modes: list[Mode], duration: float, steps: int, words: str) -> None:
    box: Box = BOX
    with pytest.raises(InputError, match=words):
        prove_motion(RECTANGLE, ONE, FILM, modes, box, duration, steps=steps)


def test_a_place_that_depends_on_the_current_angle_is_refused() -> None:
    contacts = (Tip(edge=0, at=symbol("d2") + symbol("theta"), friction="mu", mover=LEFT),)
    with pytest.raises(InputError, match="depends on theta"):
        prove_motion(RECTANGLE, contacts, FILM, [Mode.STICK], BOX, 1e-4)
