"""The part tracker as a whole."""

from __future__ import annotations

import math

import numpy as np
import pytest

from meso_robust.errors import InputError
from meso_robust.tracking.frame_estimate import size_words
from meso_robust.tracking.pose import PartTracker, Sighting
from meso_robust.types import Floats, Image as Bytes
from tests.tracking.drawing import (
    CORNERS,
    body_coordinates,
    covered,
    digitised,
    obliquely_lit,
    plain,
    textured,
)

POSE = np.array([300.4, 236.7, 0.3])
UP = np.array([np.nan, np.nan, 0.3])
EMPTY = np.full((480, 640), 60, np.uint8)


def image(pose: Floats, seed: int = 0, texture: bool = True) -> Bytes:
    grey = textured(pose) if texture else plain(pose)
    return digitised(grey, np.random.default_rng(seed))


def close(seen: Sighting, pose: Floats) -> bool:
    error = np.abs(seen.pose - pose)
    return bool(seen.found and error[:2].max() < 0.1 and error[2] < math.radians(0.05))


def nothing(seen: Sighting) -> bool:
    return not seen.found and bool(np.isnan([*seen.pose, *seen.covariance.ravel()]).all())


def test_a_part_is_found_followed_lost_and_found_again() -> None:
    tracker = PartTracker(CORNERS)
    assert close(tracker.first(image(POSE), UP), POSE)
    pose = POSE
    for k in range(1, 8):
        pose = POSE + k * np.array([4.0, -1.5, 0.02])
        seen = tracker.next(image(pose, k))
        assert close(seen, pose)
        assert seen.state == "found"
        assert np.linalg.eigvalsh(seen.covariance).min() > 0.0
    for _ in range(2):
        gone = tracker.next(digitised(EMPTY.astype(float), np.random.default_rng(8)))
        assert nothing(gone)
        assert gone.state == "lost"
        assert gone.reason
    elsewhere = pose + np.array([-70.0, 30.0, -0.6])
    assert close(tracker.next(image(elsewhere, 9)), elsewhere)


def test_oblique_light_is_taken_off_the_first_frame_as_off_the_next() -> None:
    """The displacement is that of the edges as the learned pattern finds them."""
    lamp = np.array([60.0, 0.0])
    lit = digitised(obliquely_lit(POSE, lamp, width=4.0), np.random.default_rng(4))
    tracker = PartTracker(CORNERS)
    poses = [tracker.first(lit, UP).pose, *(tracker.next(lit).pose for _ in range(3))]
    assert np.ptp(poses, axis=0)[:2].max() < 0.01


def test_a_jump_of_a_dozen_px_is_followed() -> None:
    tracker = PartTracker(CORNERS)
    tracker.first(image(POSE), UP)
    jumped = POSE + np.array([11.0, -7.0, 0.03])
    assert close(tracker.next(image(jumped, 1)), jumped)


def test_orientations_that_look_alike_are_reported_unless_one_is_chosen() -> None:
    unsure = PartTracker(CORNERS).first(image(POSE, texture=False))
    assert unsure.found
    assert unsure.turns == 2
    assert "alike in 2" in unsure.reason
    assert (unsure.pose[2] - POSE[2]) % math.pi == pytest.approx(0.0, abs=1e-3)
    for turn in (0.0, math.pi):
        told = PartTracker(CORNERS).first(
            image(POSE, texture=False), np.array([np.nan, np.nan, 0.4 + turn])
        )
        assert told.turns == 1
        assert told.pose[2] == pytest.approx(POSE[2] + turn, abs=1e-3)


def test_a_start_angle_is_kept_while_the_part_is_not_there_yet() -> None:
    tracker = PartTracker(CORNERS)
    assert nothing(tracker.first(EMPTY, np.array([np.nan, np.nan, 0.4 + math.pi])))
    seen = tracker.next(image(POSE, texture=False))
    assert seen.pose[2] == pytest.approx(POSE[2] + math.pi, abs=1e-3)


def test_a_turned_part_is_recognised_by_its_face() -> None:
    """Away for a while, and then back half a turn later: the texture tells."""
    tracker = PartTracker(CORNERS)
    tracker.first(image(POSE), UP)
    for k in range(1, 6):
        tracker.next(image(POSE, k))
    assert nothing(tracker.next(EMPTY))
    back = np.array([330.0, 250.0, POSE[2] + math.pi - 0.2])
    seen = tracker.next(image(back, 7))
    assert seen.found
    assert (seen.pose[2] - back[2] + math.pi) % (2.0 * math.pi) - math.pi == pytest.approx(
        0.0, abs=1e-3
    )


def test_two_parts_that_fit_alike_are_ambiguous() -> None:
    both = plain(np.array([170.0, 240.0, 1.5])) + plain(np.array([440.0, 240.0, 1.5])) - 60.0
    seen = PartTracker(CORNERS).first(digitised(both, np.random.default_rng(0)))
    assert nothing(seen)
    assert seen.state == "ambiguous"
    assert nothing(
        PartTracker(CORNERS).first(
            digitised(both, np.random.default_rng(0)), UP + np.array([0.0, 0.0, 1.2])
        )
    )
    near = np.array([440.0, 240.0, 1.5])
    told = PartTracker(CORNERS).first(digitised(both, np.random.default_rng(0)), near)
    assert close(told, near)


def test_a_part_under_a_probe_is_occluded_and_still_right() -> None:
    tracker = PartTracker(CORNERS)
    tracker.first(image(POSE), UP)
    for k in range(1, 4):
        covered, mask = image(POSE, k), np.zeros((480, 640), np.uint8)
        covered[:, 330:420], mask[:, 330:420] = 15, 1
        seen = tracker.next(covered, mask)
        assert close(seen, POSE)
        assert seen.state == "occluded"
        assert seen.share < 0.9
    unmasked = tracker.next(covered)  # nobody said what hides it
    assert close(unmasked, POSE) or nothing(unmasked)


def test_a_part_that_leaves_the_frame_is_reported_until_too_little_is_left() -> None:
    tracker = PartTracker(CORNERS)
    tracker.first(image(POSE), UP)
    states = []
    for k in range(1, 36):
        pose = POSE + k * np.array([-13.0, 0.0, 0.0])
        seen = tracker.next(image(pose, k))
        states.append(seen.state)
        if not seen.found:
            break
        error, sigma = np.abs(seen.pose - pose), np.sqrt(np.diag(seen.covariance))
        assert np.all(error < 4.0 * sigma)
        assert np.all(error[:2] < 1.0)
    assert states[0] == "found"
    assert "leaving" in states
    assert states[-1] == "lost"


def test_a_part_half_of_which_is_covered_unannounced_has_no_pose() -> None:
    tracker = PartTracker(CORNERS)
    tracker.first(image(POSE, texture=False), UP)
    stripes = image(POSE, 1, texture=False)
    stripes[:, np.arange(640) % 24 < 13] = 115
    assert nothing(tracker.next(stripes))


@pytest.mark.parametrize(
    ("corners", "says"),
    [
        (np.zeros((2, 2)), "3"),
        (np.array([[0.0, 0], [90, 90], [90, 0], [0, 90]]), "cross"),
        (CORNERS * [1.0, 0.1], "px wide"),
        (CORNERS * np.nan, "finite"),
    ],
)
def test_outlines_that_cannot_be_tracked_are_refused(corners: Floats, says: str) -> None:
    with pytest.raises(InputError, match=says):
        PartTracker(corners)


@pytest.mark.parametrize(
    ("frame", "mask", "says"),
    [
        (np.zeros((48, 64, 3), np.uint8), None, "frame: uint8"),
        (np.zeros((48, 64)), None, "frame: float64"),
        (np.zeros((480, 640), np.uint8), np.zeros((48, 64), np.uint8), "mask"),
    ],
)
def test_frames_of_another_kind_are_refused(frame: Bytes, mask: Bytes | None, says: str) -> None:
    with pytest.raises(InputError, match=says):
        PartTracker(CORNERS).first(frame, None, mask)


@pytest.mark.parametrize("share", [0.015, -0.015])
def test_a_part_that_is_seen_larger_or_smaller_than_stated_is_found_where_it_is(
    share: float,
) -> None:
    """Else of two opposite edges one is taken for clutter, and the pose is off by the misfit of the other."""
    stated = CORNERS / (1.0 + share)
    tracker = PartTracker(stated)
    seen = [tracker.first(image(POSE), UP), *(tracker.next(image(POSE, k)) for k in (1, 2))]
    assert all(close(one, POSE) for one in seen)
    assert [one.size for one in seen] == pytest.approx(3 * [share], abs=0.002)


def test_a_part_of_the_stated_size_is_not_said_to_have_another() -> None:
    for seed in range(3):
        assert PartTracker(CORNERS).first(image(POSE, seed), UP).size == 0.0


def test_a_square_seen_larger_is_an_outline_displaced_alike_and_is_found_all_the_same() -> None:
    """Its size and the displacement of all edges are one; neither moves it."""
    half = 60.0
    corners = half * np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
    x, y = body_coordinates(POSE)
    grey = 60.0 + 110.0 * covered(x, 1.02 * half, 1.0) * covered(y, 1.02 * half, 1.0)
    frame = digitised(grey, np.random.default_rng(0))
    seen = PartTracker(corners).first(frame, UP)
    assert close(seen, POSE)
    assert seen.size == 0.0


@pytest.mark.parametrize(
    ("size", "said"),
    [(0.0, ""), (0.0104, "seen 1.0 % larger than"), (-0.02, "seen 2.0 % smaller than")],
)
def test_the_size_is_said_in_words(size: float, said: str) -> None:
    assert said in size_words(size)
    assert bool(size_words(size)) == bool(size)
