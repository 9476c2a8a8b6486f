"""A kernel takes half a minute to compile: whatever the push, each engine needs one."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numba import typeof

from meso_robust.kernels import share_out
from meso_robust.simulator import Effects, Push, batch, exact, simulate
from meso_robust.simulator.events import engine
from meso_robust.types import Floats

SQUARE = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]) * 1e-3


def push(vertices: Floats, friction: Floats) -> Push:
    return Push.straight(
        vertices=vertices,
        poses=np.zeros((2, 3)),
        tips=np.full((2, 1, 2), 5e-3),
        travel=np.full((2, 1, 2), 1e-6),
        friction=friction,
        film_ratio=1e-6,
        step=1e-6,
    )


def test_parts_and_friction_of_each_run_need_no_other_kernel(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """The types of the arguments say so; nothing is compiled here."""
    types: dict[str, set[str]] = {"stepped": set(), "events": set()}

    def stepped(*given: object) -> None:
        types["stepped"].add(str([typeof(one) for one in given]))

    def events(*given: object) -> None:
        types["events"].add(str([typeof(one) for one in given]))

    monkeypatch.setattr(batch, "run_range", stepped)
    monkeypatch.setattr(engine, "_kernel", events)
    alike = push(SQUARE, np.zeros((1, 1)))
    each = push(np.stack([SQUARE, 1.1 * SQUARE]), np.full((2, 1), 0.3))
    for one in (alike, each):
        exact(one)
        simulate(one)
    absent = Effects({"friction_spread": {"change": 0.1, "tip": 3.0}})
    simulate(replace(alike, effects=absent))

    assert [len(found) for found in types.values()] == [1, 1]


def test_pieces_are_shared_out_and_each_is_done_once() -> None:
    done: list[int] = []
    share_out(done.append, range(50), 3)
    assert sorted(done) == list(range(50))


def test_what_goes_wrong_in_a_piece_is_raised() -> None:
    def call(piece: int) -> None:
        if piece == 7:
            raise ValueError("piece 7")

    with pytest.raises(ValueError, match="piece 7"):
        share_out(call, range(9), 3)
