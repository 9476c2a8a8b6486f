"""No jam is passed over: a part between two tips that come too near is stopped where they do.

Between two tips on opposite edges, a width w apart, the part jams where the line from tip to tip is
at the edge of both friction cones: with D from one tip to the other, at ``|D|² = w² (1 + μ²)``, for
D is w long across the edges. That is known whatever the part did before, and whatever the film.
"""

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from meso_robust.simulator.batch import simulate
from meso_robust.simulator.events import integrate
from meso_robust.simulator.outcome import Outcome
from meso_robust.simulator.push import Push
from meso_robust.simulator.support_models import Film
from tests.laboratory.paper import exactly
from tests.simulator.events.reference import RHO, UM, F, turn

HALF = [float.fromhex("0x1.a79fec99f1ae2p-11"), float.fromhex("0x1.b6d43d03968d8p-12")]
PLATE = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1.0]]) * HALF  # 1616 um by 837 um
WIDTH = 2 * HALF[1]

MOVES = [
    # the forces grow without bound, change sign, and the slip reverses between two looks at them
    """0x1.a157f8804613bp-10 0x1.2a4aecc867505p-19 0x1.942b200b19053p+0 0x1.0af63da615b21p-9
    0x1.3c9e990931792p-10 0x1.0b91ad956ff35p-9 0x1.4926e9d181809p-11 0x1.334f1aacd73e9p-10
    -0x1.1782b0dff0e0cp-12 -0x1.57689ca18bd65p-10 0x1.8240bfbe9ee8bp-2 0x1.68fc4dd3e98d8p-22""",
    """0x1.9e61fd25865a8p-10 -0x1.25ab904bb451ap-16 0x1.9498203c40257p+0 0x1.084b2e0d5d9d8p-9
    0x1.3eff9124f434ap-10 0x1.0906fd0ff6b02p-9 0x1.4de8da0906f7bp-11 0x1.2c9e809233280p-10
    -0x1.0f899909ddc27p-12 -0x1.57689ca18bd66p-10 0x1.875c0a227d934p-2 0x1.688cfef2b7b87p-22""",
    """0x1.a3cbca1bf1dc5p-10 -0x1.9494266e10958p-17 0x1.94a35d3c6d3b4p+0 0x1.0b8b8f3e088b1p-9
    0x1.41ff37d8666abp-10 0x1.0c4ab4b004fc5p-9 0x1.53e8276feb63cp-11 0x1.27bde88e6a6b6p-10
    -0x1.0942d29bab489p-12 -0x1.57689ca18bd66p-10 0x1.99b232e7c19a0p-2 0x1.bbaef47009d3cp-22""",
    """0x1.a4e1baa9e79b4p-10 -0x1.5bb7e646e22a1p-16 0x1.95bba2c222411p+0 0x1.0bde83893014bp-9
    0x1.3d50ef90a2a22p-10 0x1.0cf0e6ccb7989p-9 0x1.4a8b96e063d2ap-11 0x1.2cd74347daf0fp-10
    -0x1.2a223fba0f57ap-12 -0x1.57689ca18bd66p-10 0x1.c3ed882998194p-2 0x1.aed7d10c99422p-22""",
    # both tips slide; at the jam the two forces are on one line to the last bit
    """0x1.975d4b1223332p-10 -0x1.618cc2b7aa1a1p-16 0x1.8f54d23ae5e92p+0 0x1.09a5f5605b2cep-9
    0x1.3b4e8aa78e4eep-10 0x1.08d1a84365520p-9 0x1.4686cd0e3b2c1p-11 0x1.248b9c5e46216p-10
    -0x1.0ebe08e4ab0fdp-12 -0x1.57689ca18bd65p-10 0x1.9eb851eb851f0p-2 0x1.c747ab240071ep-22""",
    """0x1.a916028f9e19cp-10 -0x1.af1ff74253f3ep-16 0x1.969786ecd778cp+0 0x1.0e2774380d8e9p-9
    0x1.395739a2b8fd0p-10 0x1.0f7b282e66c63p-9 0x1.42982b0490886p-11 0x1.364453dbc1080p-10
    -0x1.06e0c4d155c88p-12 -0x1.57689ca18bd65p-10 0x1.cccccccccccd2p-2 0x1.43c12fbe94391p-22""",
]
"""Turns of the paper's plan with its uncertainties 2.5 and 4 times as large: pose, two tips that go
together and one at rest, their travel in x, friction, and ratio of the film."""


def move_of(text: str) -> dict[str, Any]:
    """A turn as `integrate` takes it."""
    numbers = np.array([float.fromhex(word) for word in text.split()])
    travel, friction, film = numbers[9:]
    return {
        "vertices": PLATE,
        "poses": numbers[None, :3],
        "tips": numbers[3:9].reshape(1, 3, 2),
        "travel": np.array([[[travel, 0.0], [travel, 0.0], [0.0, 0.0]]]),
        "friction": np.full((1, 3), friction),
        "drag": np.diag([1.0, 1.0, film]),
    }


@pytest.mark.parametrize("text", MOVES)
def test_jam_is_where_the_line_of_the_tips_leaves_the_cones_and_in_fine_steps(text: str) -> None:
    move = move_of(text)
    tips, way, friction = move["tips"], move["travel"], move["friction"]
    steps = simulate(
        Push(
            vertices=PLATE,
            poses=move["poses"],
            waypoints=np.stack([tips, tips + way], axis=1),
            times=np.array([[0.0, 1.0]]),
            friction=friction,
            support=Film(drag=move["drag"]),
            step=0.05 * UM,
        ),
        workers=1,
    )
    found = integrate(**move)
    assert found.outcomes[0] == steps.outcomes[0] == Outcome.JAM
    assert np.abs(found.poses[0] - steps.poses[0]).max() < 2e-4  # m and rad
    at = (tips + found.ended_at[0] * way)[0]
    along, across = (at[1] - at[2]) @ turn(found.poses[0, 2])
    assert abs(across) == pytest.approx(WIDTH, abs=1e-15)
    assert abs(along) == pytest.approx(friction[0, 0] * WIDTH, abs=1e-15)


def grazing(runs: int, rng: np.random.Generator) -> tuple[F, F, F, F]:
    """Tips, travel, friction, and part of the move at which the part jams, infinite if it does not.

    The first tip goes by the second, at rest on the opposite edge, so closely that the part just
    jams or just does not.
    """
    friction = rng.uniform(0.2, 0.5, runs)
    jam = WIDTH * np.hypot(1.0, friction)
    beyond = friction * WIDTH * rng.uniform(1.02, 1.3, runs)  # along the edges, at the start
    start = np.column_stack([np.full(runs, WIDTH), beyond])
    # at its least the distance is `jam` less a part of what there is to go, of either sign
    far = np.hypot(*start.T)
    least = jam - (far - jam) * rng.uniform(-0.9, 0.9, runs) * 10.0 ** rng.uniform(-5, 0, runs)
    way = np.arctan2(start[:, 1], start[:, 0]) + np.pi - np.arcsin(least / far)
    heading = np.column_stack([np.cos(way), np.sin(way)])
    closest = -np.sum(start * heading, axis=1)
    travel = (closest * rng.uniform(1.2, 1.8, runs))[:, None] * heading
    before = np.sqrt(np.where(least < jam, jam**2 - least**2, np.nan))
    at = (closest - before) / np.hypot(*travel.T)
    tips = np.stack([0.5 * start, -0.5 * start], axis=1)
    rest = np.zeros_like(travel)
    return tips, np.stack([travel, rest], axis=1), friction, np.where(np.isnan(at), np.inf, at)


@pytest.mark.parametrize("seed", range(3))
def test_part_jams_if_and_only_if_the_tips_come_as_near_as_that(seed: int) -> None:
    tips, travel, friction, at = grazing(400, np.random.default_rng(seed))
    result = integrate(
        vertices=PLATE,
        poses=np.tile([0, 0, np.pi / 2], (len(tips), 1)),
        tips=tips,
        travel=travel,
        friction=np.repeat(friction[:, None], 2, axis=1),
        drag=np.diag([1.0, 1.0, RHO]),
    )
    jams = at < np.inf
    assert 100 < jams.sum() < 300
    np.testing.assert_array_equal(result.outcomes == Outcome.JAM, jams)
    np.testing.assert_allclose(result.ended_at[jams], at[jams], rtol=0, atol=1e-9)


def reversal() -> dict[str, Any]:
    """A run of the plan for real probes that was called jammed, as `integrate` takes it."""
    numbers = json.loads((Path(__file__).parent / "reversal.json").read_text())
    return {name: np.array(value) for name, value in numbers.items()}


@pytest.mark.parametrize("seed", range(3))
def test_slip_that_reverses_between_two_tips_is_no_jam(seed: int) -> None:
    """At the reversal the slip is nought but for rounding.

    Of these neighbours four or five in 400 were taken for jams, where what was left of the slip after
    the search for its reversal was by chance too much for a tie.
    """
    move = reversal()
    rows = ("poses", "tips", "travel", "friction")
    near = move | {name: np.repeat(move[name], 400, axis=0) for name in rows}
    near["friction"] *= 1 + 1e-9 * np.random.default_rng(seed).normal(size=(400, 2, 3))
    found = integrate(**near)
    assert (found.outcomes == Outcome.COMPLETED).all()
    assert np.ptp(found.poses, axis=0).max() < 1e-9  # m and rad


def test_poses_in_a_channel_are_those_of_shorter_moves() -> None:
    # both tips slip along the part's long edges, which are parallel here
    move = reversal() | {"stage_lay": np.zeros(2), "vertices": PLATE}
    move["travel"], move["friction"] = move["travel"][:, :1], move["friction"][:, :1]
    path = integrate(**move, samples=40).path[0]
    for k in range(0, 41, 3):
        shorter = integrate(**move | {"travel": move["travel"] * k / 40}).poses[0]
        np.testing.assert_allclose(path[k], shorter, rtol=0, atol=3e-14)  # m and rad


def test_runs_with_large_uncertainties_end_as_in_fine_steps() -> None:
    """All of them: of 4,000 such runs none ended otherwise, even in steps of 1 um."""
    player = exactly(2.5)
    rows = player.draw(2000, np.random.default_rng(11))
    found = player.run(rows)
    steps = replace(player, engine="stepper").run(rows, step=0.5 * UM)
    assert {-1, 0, 1} <= set(found.outcomes.tolist())
    np.testing.assert_array_equal(found.outcomes, steps.outcomes)
    np.testing.assert_array_equal(found.failed_in, steps.failed_in)


def test_a_jam_to_the_last_bit_is_no_pose_out_of_range() -> None:
    """Two forces on one line leave no velocity where the step up to the jam ends: 7 of these were NaN."""
    player = exactly(2.5)
    row = player.draw(2000, np.random.default_rng(11))[[1542]]
    other = np.random.default_rng(0).uniform(-1e-15, 1e-15, (4000, row.shape[1]))
    found = player.run(row * (1.0 + other), record=8)
    assert set(found.outcomes.tolist()) == {Outcome.JAM}
    assert set(found.failed_in.tolist()) == {2}
    paths = found.moves[2].path
    assert np.ptp(paths, axis=0).max() < 1e-7  # m and rad
