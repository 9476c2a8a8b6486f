"""Support points from forces: the law by another route, and known truths recovered."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from meso_robust.recordings import Recording, RecordingSet, SensorInfo
from meso_robust.recordings.importers.support_point_log import PART
from reports.identification.real.wrenches import (
    Pairs,
    apart,
    friction_at,
    loads_of,
    pairs_of,
    points_by_forces,
    unit_wrenches,
)

LENGTH = 0.07
KNOWN = np.array([[-0.02, -0.025], [0.04, -0.015], [-0.018, 0.045]])
FRICTION = np.array([1.5, 2.0, 1.2])


def dissipated(twist: np.ndarray) -> float:
    """Power that the points dissipate; its gradient along the twist is the wrench."""
    vx, vy, turn = twist
    speeds = np.hypot(vx - turn * KNOWN[:, 1], vy + turn * KNOWN[:, 0])
    return float(FRICTION @ speeds)


def pairs(friction: np.ndarray, noise: float = 0.0) -> Pairs:
    """Forty pushes of random twists."""
    rng = np.random.default_rng(5)
    twists = rng.normal(size=(40, 3)) * (0.01, 0.01, 0.15)
    wrenches = unit_wrenches(KNOWN, twists) @ friction
    wrenches += noise * rng.normal(size=wrenches.shape) * (1.0, 1.0, LENGTH)
    return Pairs(files=tuple(map(str, range(40))), wrenches=wrenches, twists=twists, length=LENGTH)


def test_the_wrench_is_the_gradient_of_the_dissipated_power() -> None:
    for twist in np.random.default_rng(1).normal(size=(20, 3)) * (0.01, 0.01, 0.2):
        step = 1e-6 * np.eye(3)
        slope = [(dissipated(twist + s) - dissipated(twist - s)) / 2e-6 for s in step]
        wrench = unit_wrenches(KNOWN, twist[None])[0] @ FRICTION
        assert np.allclose(wrench, slope, atol=1e-6)


def test_friction_at_known_points_is_recovered() -> None:
    friction, explained = friction_at(KNOWN, pairs(FRICTION))
    assert np.allclose(friction, FRICTION, atol=1e-9)
    assert explained == pytest.approx(1.0)
    friction, explained = friction_at(KNOWN, pairs(FRICTION, noise=0.3))
    assert np.allclose(friction, FRICTION, atol=0.3)
    assert 0.8 < explained < 0.99


def test_points_are_recovered_from_loads_that_balance() -> None:
    loads = loads_of(KNOWN)
    assert loads.sum() == pytest.approx(1.0)
    assert np.allclose(loads @ KNOWN, 0.0, atol=1e-15)  # the centre of mass is the origin
    start = np.array([[[-0.03, -0.03], [0.03, -0.03], [-0.03, 0.03]]])
    found = points_by_forces(pairs(4.2 * loads), start, PART.corners)
    assert apart(found.points, KNOWN) < 1e-5
    assert found.friction == pytest.approx(4.2, rel=1e-4)


def test_distance_of_points_does_not_depend_on_their_order() -> None:
    shifted = KNOWN + np.array([0.003, 0.004])
    for order in ([0, 1, 2], [2, 0, 1], [2, 1, 0], [1, 0, 2]):
        assert apart(shifted[order], KNOWN) == pytest.approx(0.005)


def test_a_pair_is_the_mean_wrench_and_the_whole_displacement_in_the_parts_frame() -> None:
    """A constant force along the world's y at a tip that the part carries with it, a quarter turn on."""
    count = 40
    share = np.linspace(0.0, 1.0, count)
    poses = np.full((count, 3), np.nan)
    poses[[0, -1]] = [[0.1, 0.2, 0.5 * np.pi], [0.1, 0.21, 0.5 * np.pi]]
    tips = np.stack([np.full(count, 0.13), 0.15 + 0.01 * share], axis=-1)[:, None]
    forces = np.tile([0.0, 3.0], (count, 1))[:, None]
    recording = Recording(
        file="a.csv", probe_names=("tip",), times=share, poses=poses, probes=tips, forces=forces
    )
    recordings = RecordingSet(
        part=PART,
        tip_radius=1e-3,
        position_source="controller",
        sensor=SensorInfo(frame_rate=40.0),
        recordings=(recording, replace(recording, file="b.csv", forces=None)),
    )
    found = pairs_of(recordings, LENGTH)
    assert found.files == ("a.csv",)
    assert np.allclose(found.twists, [[0.01, 0.0, 0.0]])
    # the tip is 30 mm to the right and 50 mm below: its force along y turns the part by 3 N x 30 mm
    assert np.allclose(found.wrenches, [[3.0, 0.0, 0.09]], atol=1e-12)
