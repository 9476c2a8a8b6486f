"""Inputs of a push, good and bad."""

from typing import Any

import numpy as np
import numpy.typing as npt
import pytest

from meso_robust.simulator import Push
from tests.simulator.problems import HALF_SHORT, RHO, UM, rectangle

F = npt.NDArray[np.float64]


def fields(**changes: Any) -> dict[str, Any]:
    good: dict[str, Any] = {
        "vertices": rectangle(),
        "poses": np.array([[0.0, 0.0, np.pi / 2]] * 2),
        "tips": np.array([[[HALF_SHORT, 0.0]]] * 2),
        "travel": np.array([[[-100 * UM, 0.0]]] * 2),
        "friction": np.array([0.3, 0.3]),
        "film_ratio": np.array([RHO, RHO]),
        "step": 1 * UM,
    }
    return good | changes


def test_arrays_are_copied_and_read_only() -> None:
    given = fields(friction=[0, 1])
    push = Push(**given)
    given["vertices"][0, 0] = 7.0
    assert push.vertices[0, 0] == -808 * UM
    assert push.friction.dtype == np.float64
    with pytest.raises(ValueError, match="read-only"):
        push.tips[0, 0, 0] = 1.0


@pytest.mark.parametrize(("step", "steps"), [(1 * UM, 100), (0.3 * UM, 334), (1.0, 1)])
def test_steps_round_up(step: float, steps: int) -> None:
    assert Push(**fields(step=step)).steps == steps


def test_no_travel_takes_no_step() -> None:
    assert Push(**fields(travel=np.zeros((2, 1, 2)))).steps == 0


STAR = np.array([[np.cos(4 * np.pi * k / 5), np.sin(4 * np.pi * k / 5)] for k in range(5)])
INSIDE = np.array([[[HALF_SHORT, 0.0]], [[HALF_SHORT - 3 * UM, 0.0]]])
BAD = [
    ({"vertices": rectangle()[:2]}, r"vertices: 2 corners; must be at least 3; give"),
    ({"vertices": rectangle()[::-1]}, r"vertices: corner \d .* counter-clockwise; give"),
    ({"vertices": rectangle()[[0, 1, 1, 2, 3]]}, r"vertices: corner 1 and the next coincide"),
    (
        {"vertices": np.insert(rectangle(), 1, [0.0, -HALF_SHORT], axis=0)},
        r"vertices: corner \d is .* strictly convex",
    ),
    ({"vertices": STAR}, r"vertices: corner \d is .* strictly convex"),
    ({"vertices": rectangle() + 1e-3}, r"vertices: the origin is .* must contain .* subtract"),
    ({"vertices": np.zeros((4, 3))}, r"vertices: shape \(4, 3\); must be \(V, 2\).*reshape"),
    ({"vertices": np.array(1.0)}, r"vertices: shape \(\); must be \(V, 2\)"),
    ({"poses": np.zeros((2, 2))}, r"poses: shape \(2, 2\); must be \(N, 3\)"),
    ({"tips": np.zeros((3, 1, 2))}, r"tips: shape \(3, 1, 2\); must be \(N, P, 2\)"),
    ({"tips": np.zeros((2, 0, 2)), "travel": np.zeros((2, 0, 2))}, r"tips: 0 tips; must be 1 to"),
    ({"travel": np.zeros((2, 2, 2))}, r"travel: shape .* must be \(N, P, 2\)"),
    ({"friction": np.zeros(3)}, r"friction: shape \(3,\); must be \(N,\)"),
    ({"film_ratio": np.zeros((2, 1))}, r"film_ratio: shape \(2, 1\); must be \(N,\)"),
    ({"poses": [[0, 0, np.nan]] * 2}, r"poses: nan at \(0, 2\); must be finite; remove"),
    ({"travel": [[[0, 0]], [[0, np.inf]]]}, r"travel: inf at \(1, 0, 1\); must be finite"),
    ({"friction": [0.1, -0.2]}, r"friction: run 1 has -0.2; must not be negative; give μ"),
    ({"film_ratio": [RHO, 0.0]}, r"film_ratio: run 1 has 0 m²; e_θ/e_x must be positive; give"),
    ({"step": 0.0}, r"step: 0.0 m; must be positive and finite; try"),
    ({"step": np.nan}, r"step: nan m; must be positive"),
    ({"step": 1e-20}, r"step: 1e-20 m for a travel of 0.0001 m; must give at most 1e\+08 steps"),
    ({"tips": INSIDE}, r"tips: tip 0 of run 1 starts 3 µm inside the part; must start outside"),
]


@pytest.mark.parametrize(("changes", "message"), BAD, ids=[b[1][:24] for b in BAD])
def test_bad_input_is_refused(changes: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        Push(**fields(**changes))


def test_depth_left_by_an_earlier_move_is_taken() -> None:
    touching = np.array([[[HALF_SHORT - 0.04 * UM, 0.0]]] * 2)
    assert Push(**fields(tips=touching)).tips.shape == (2, 1, 2)
