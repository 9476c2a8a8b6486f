"""Probe tips: free, in contact, two at once, found by motion, lost and found again."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import numpy.typing as npt
import pytest

from meso_robust.errors import InputError
from meso_robust.microscope import Exposure, Oil, Optics, Part, Probe, Scene, project, render
from meso_robust.tracking import probes
from meso_robust.tracking.alpha_matting import window_of
from meso_robust.tracking.backdrop import backdrop, beyond, glimpse
from meso_robust.tracking.frames import open_frames
from meso_robust.tracking.learned import Learned, Tip
from meso_robust.tracking.needle import Needle
from meso_robust.tracking.probe_search import moving_needles, needle_at
from meso_robust.tracking.probes import ProbeTracker, refined
from meso_robust.tracking.tip_fit import Matte, fit_matte
from meso_robust.tracking.track import _unsure
from tests.tracking.pushes import HALF_SHORT, PART, PIXEL, RADIUS, push, rms

Floats = npt.NDArray[np.float64]
R_PX = RADIUS / PIXEL
CONTACT = 20  # frame of `pushed`


def seen_outline(pose: Floats) -> Floats:
    c, s = math.cos(pose[2]), math.sin(pose[2])
    return project(Optics(), PART @ np.array([[c, s], [-s, c]]) + pose[:2])


@pytest.fixture(scope="module")
def followed(tmp_path_factory: pytest.TempPathFactory) -> tuple[ProbeTracker, list[Tip], Floats]:
    """A tracker after 60 frames of a push, what it said, and the true tips in px."""
    filmed = push(tmp_path_factory.mktemp("push") / "push.avi", 60)
    truth = project(Optics(), filmed.tips[:, 0])
    tracker, tips = None, []
    for frame, pose in zip(open_frames(filmed.path), filmed.poses, strict=True):
        outline = seen_outline(pose)
        if tracker is None:
            tracker = ProbeTracker("p", needle_at(frame.image, truth[0] + (2.0, -3.0), R_PX))
            tips.append(tracker.first(frame.image, outline))
        else:
            tips.append(tracker.next(frame.image, outline))
    assert tracker is not None
    return tracker, tips, truth


def test_tips_are_right_within_their_stated_spread_free_and_in_contact(
    followed: tuple[ProbeTracker, list[Tip], Floats],
) -> None:
    tracker, tips, truth = followed
    anchor, spread, remark = tracker.anchor()
    errors = np.array([tip.shift for tip in tips]) + anchor - truth

    assert all(tip.found for tip in tips)
    assert remark == ""
    for part in (errors[:CONTACT], errors[CONTACT:]):
        # the needle points down: across its axis it is known ten times better than along it,
        # where the constant place of the tip in the learned image is the larger error
        assert rms(part)[0] < 0.06
        assert rms(part - part.mean(axis=0))[1] < 0.16
        assert rms(part)[1] < 0.35
    sigma = np.sqrt([np.diag(spread + tip.covariance) for tip in tips])
    assert np.all(rms(errors / sigma) < 2.0)
    assert sigma.max() < 0.3


def test_contact_does_not_draw_the_tip(
    followed: tuple[ProbeTracker, list[Tip], Floats],
) -> None:
    tracker, tips, truth = followed
    errors = np.array([tip.shift for tip in tips]) + tracker.anchor()[0] - truth

    assert np.abs(errors[:CONTACT].mean(axis=0) - errors[CONTACT:].mean(axis=0)).max() < 0.15


@pytest.fixture(scope="module")
def near_starts(
    tmp_path_factory: pytest.TempPathFactory,
) -> list[tuple[ProbeTracker, list[Tip], Floats]]:
    """Pushes whose tip starts 40 um (7.6 px) before the part, askew, with different dust."""
    done = []
    for seed, sideways in ((0, 0.3), (5, -0.4)):
        path = tmp_path_factory.mktemp("near") / "push.avi"
        filmed = push(path, 40, gap=40e-6, speed=4.7e-6, seed=seed, sideways=sideways)
        truth = project(Optics(), filmed.tips[:, 0])
        start = open_frames(filmed.path)
        tracker, tips = None, []
        for frame, pose in zip(start, filmed.poses, strict=True):
            outline = seen_outline(pose)
            if tracker is None:
                tracker = ProbeTracker("p", needle_at(frame.image, truth[0] + (2.0, -3.0), R_PX))
                tips.append(tracker.first(frame.image, outline))
            else:
                tips.append(tracker.next(frame.image, outline))
            tracker.remember(frame.image, tips[-1], outline)
        assert tracker is not None
        done.append((tracker, tips, truth))
    return done


def test_tip_that_starts_near_the_part_is_placed_along_its_axis(
    near_starts: list[tuple[ProbeTracker, list[Tip], Floats]],
) -> None:
    axis = np.array([math.cos(-1.45), math.sin(-1.45)])
    along, pulls = [], []
    for tracker, tips, truth in near_starts:
        found = tracker.places(tips)
        errors = found.tips - truth
        assert found.remark == ""
        assert rms(errors @ [-axis[1], axis[0]]) < 0.05
        assert rms(errors @ axis) < 0.2  # the larger part is constant in a video
        along.append(errors @ axis)
        pulls.append(
            errors @ axis / np.sqrt(np.einsum("i,tij,j->t", axis, found.covariances, axis))
        )
    assert rms(np.concatenate(along)) < 0.15
    # 90 % intervals; two constants are too few draws to ask for 85 to 95 %
    assert np.mean(np.abs(np.concatenate(pulls)) < 1.645) > 0.75
    assert rms(np.concatenate(pulls)) > 0.3


def test_tip_never_seen_free_says_so(
    near_starts: list[tuple[ProbeTracker, list[Tip], Floats]],
) -> None:
    tracker, _, _ = near_starts[0]
    blocked = [one for one in tracker.glimpses[12:22] if one is not None]

    found = refined(blocked, tracker.needle, window_of(tracker.needle))

    assert found.remark == "never seen free of the part"
    axis = tracker.needle.axis
    assert np.all(np.einsum("i,tij,j->t", axis, found.covariances, axis) > 1.0)


def test_mask_covers_the_needle_and_leaves_the_part(
    followed: tuple[ProbeTracker, list[Tip], Floats],
) -> None:
    tracker, _, truth = followed
    mask = tracker.mask((480, 640))
    u, v = np.rint(truth[-1]).astype(int)

    assert mask[v, u] == 255
    assert mask[2, int(u + (v - 2) / math.tan(1.45))] == 255  # where the shaft meets the border
    assert mask[v + 12, u] == 0
    assert mask[v, u - 20] == 0


SCENE = Scene(
    part=Part(outline=PART),
    probes=(Probe(tip_radius=RADIUS, direction=1.2), Probe(tip_radius=RADIUS, direction=-1.9)),
)
TIPS = np.array([[2e-4, 5.5e-4], [-2e-4, -6.5e-4]])


def drawn(move: Floats, seed: int = 0) -> npt.NDArray[np.uint8]:
    return render(SCENE, np.zeros(3), TIPS + move, np.random.default_rng(seed))


def test_needles_that_move_are_found_where_they_reach_in() -> None:
    frames = [drawn(np.array([0.0, -1.5e-5 * k]) * [[1], [-1]], k) for k in range(5)]

    found = moving_needles(frames, R_PX)

    truth = project(Optics(), TIPS)[::-1]  # from left to right
    assert np.array([needle.tip for needle in found]) == pytest.approx(truth, abs=2.0)
    assert [needle.direction for needle in found] == pytest.approx([1.9, -1.2], abs=0.1)


def test_needles_that_rest_are_not_taken_for_probes() -> None:
    assert moving_needles([drawn(np.zeros((2, 2)), k) for k in range(4)], R_PX) == []
    assert moving_needles([drawn(np.zeros((2, 2)))], R_PX) == []


def test_lost_probe_says_so_and_is_found_again() -> None:
    tip = project(Optics(), TIPS)[0]
    needle = Needle(tip=(float(tip[0]), float(tip[1])), direction=-1.2, taper=0.09, radius=R_PX)
    tracker = ProbeTracker("p", needle)
    without = np.array([[math.nan, math.nan], [0.0, 0.0]])

    images = [drawn(np.zeros((2, 2)), 1), drawn(without, 2)]
    images.append(drawn(np.array([[5e-5, 2e-5], [0.0, 0.0]]), 3))
    first = tracker.first(images[0])
    gone, back = tracker.next(images[1]), tracker.next(images[2])
    for image, seen in zip(images, (first, gone, back), strict=True):
        tracker.remember(image, seen, None)
    places = tracker.places([first, gone, back]).tips

    assert first.found
    assert not gone.found
    assert gone.reason
    assert np.isnan(gone.shift).all()
    assert back.found
    assert back.shift - first.shift == pytest.approx([5e-5 / PIXEL, -2e-5 / PIXEL], abs=0.5)
    assert np.isfinite(places).tolist() == [[True, True], [False, False], [True, True]]
    assert places[0] == pytest.approx(tip, abs=0.5)


def test_no_needle_where_it_is_stated() -> None:
    needle = Needle(tip=(100.0, 400.0), direction=0.3, taper=0.09, radius=R_PX)
    tracker = ProbeTracker("p", needle)

    assert "no needle" in tracker.first(drawn(np.zeros((2, 2)))).reason
    assert not tracker.next(drawn(np.zeros((2, 2)))).found
    assert not tracker.mask((480, 640)).any()


def test_a_needle_that_stands_at_its_limit_has_no_tips(
    near_starts: list[tuple[ProbeTracker, list[Tip], Floats]], monkeypatch: pytest.MonkeyPatch
) -> None:
    def widest(*given: Any) -> tuple[Matte, Floats]:
        matte, tips = fit_matte(*given)
        return replace(matte, needle=matte.needle.reshaped(0.08, 9.0, 0.02)), tips

    monkeypatch.setattr(probes, "fit_matte", widest)
    tracker, tips, _ = near_starts[0]
    found = tracker.places(tips)
    assert np.isnan(found.tips).all()
    assert np.isnan(found.covariances).all()
    assert "does not look like a needle" in found.remark


def test_a_smear_is_not_a_needle() -> None:
    """A needle of its blur would end 6 px from where it begins."""
    frame = cv2.line(np.full((160, 160), 120.0), (80, 80), (159, 80), 20.0, 9)
    frame = cv2.GaussianBlur(frame, (0, 0), 9.0) + np.random.default_rng(0).normal(size=frame.shape)
    tracker = ProbeTracker("p", Needle(tip=(80.0, 80.0), direction=0.0, taper=0.08, radius=R_PX))

    assert "no needle" in tracker.first(np.clip(frame, 0, 255).astype(np.uint8)).reason


def test_place_outside_the_image_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="outside the image"):
        needle_at(drawn(np.zeros((2, 2))), np.array([700.0, 10.0]), R_PX)


@pytest.fixture(scope="module")
def dim() -> Scene:
    """A needle not much darker than the film, and compression."""
    look = {"half_angle": 0.09, "brightness": 0.15, "highlight": 0.2}
    return Scene(
        part=Part(outline=PART),
        probes=(Probe(tip_radius=RADIUS, direction=1.45, **look),),
        exposure=Exposure(jpeg_quality=80),
    )


@pytest.mark.parametrize("seed", [2, 4])
def test_what_is_behind_a_needle_does_not_hold_it(dim: Scene, seed: int) -> None:
    """The end of the tip is before the part's edge, its flanks before a film with texture, in the one frame learned."""
    scene, rng = replace(dim, oil=Oil(seed=seed)), np.random.default_rng(seed)
    axis, outline = np.array([math.cos(1.45), math.sin(1.45)]), project(Optics(), PART)
    tips = [1e-4, HALF_SHORT] + (8.0 - 1.2 * np.arange(4)[:, None]) * PIXEL * axis
    truth = project(Optics(), tips)
    frames = [render(scene, np.zeros(3), tip[None], rng) for tip in tips]
    needle = Needle(tip=(truth[0, 0], truth[0, 1]), direction=-1.45, taper=0.09, radius=R_PX)
    learned = Learned(frames[0], needle, outline)
    for frame, tip in zip(frames[1:], truth[1:], strict=True):
        off = learned.register(frame, np.zeros(2), outline).shift - (tip - truth[0])
        assert np.hypot(*off) < 0.5


def test_film_near_the_part_tells_nothing_of_a_needle() -> None:
    """A part to the right of a line: what is nearer to it than 5 px is left out, and nothing else."""
    window = window_of(Needle(tip=(0.0, 0.0), direction=math.pi, taper=0.08, radius=R_PX))
    frame, tip = np.full((200, 200), 90, np.uint8), np.array([80.0, 100.0])
    outline = np.array([[92.0, -99.0], [299.0, -99.0], [299.0, 299.0], [92.0, 299.0]])
    one = glimpse(frame, tip, window, outline)
    needle = Needle(tip=(80.0, 100.0), direction=math.pi, taper=0.08, radius=R_PX)
    scene = backdrop(one, window, needle, None)

    used = beyond(scene, one, 5.0).used

    u = 80.0 + window.low[0] + np.arange(window.shape[1])
    assert u.max() > 88.0
    assert np.all(used[:, u < 86.5] == 1.0)
    assert np.all(used[:, u > 87.5] == 0.0)
    assert np.array_equal(beyond(scene, one, 0.0).used, scene.used)


@pytest.mark.parametrize("seed", [1, 2])
def test_a_meniscus_does_not_draw_a_tip(seed: int) -> None:
    """Before an even film with hardly any noise, which the liquid darkens at the needle and brightens a little away."""
    axis, rng = np.array([math.cos(0.7), math.sin(0.7)]), np.random.default_rng(seed)
    scene = Scene(
        part=None,
        probes=(Probe(tip_radius=RADIUS, direction=0.7),),
        oil=Oil(halo=0.25, ring=0.12, texture=0.0, grain=0.0, dust=0),
        optics=Optics(width=160, height=160),
        exposure=Exposure(shot_noise=0.0, read_noise=0.3),
    )
    tips = rng.uniform(-10.0, 10.0, (8, 2)) * PIXEL
    truth = project(scene.optics, tips)
    needle = Needle(tip=(80.0, 80.0), direction=-0.7, taper=0.08, radius=R_PX)
    window = window_of(needle)
    seen = [
        glimpse(render(scene, np.full(3, math.nan), tip[None], rng), place, window, None)
        for tip, place in zip(tips, truth, strict=True)
    ]

    errors = refined(seen, needle, window).tips - truth

    assert abs(float(errors.mean(axis=0) @ [axis[0], -axis[1]])) < 0.05


def test_a_tip_that_is_known_far_worse_than_in_most_frames_is_taken_for_unseen() -> None:
    """By its worst direction; where it is always known as badly nothing is taken away."""
    spreads = np.tile(np.diag([0.04, 0.2]), (9, 1, 1))
    spreads[3] = [[160.0, 17.0], [17.0, 2.0]]
    spreads[5] = np.diag([0.4, 2.0])
    spreads[6] = np.nan
    assert _unsure(spreads) == [3]
    assert _unsure(900.0 * spreads[[0, 1, 2]]) == _unsure(spreads[6:7]) == []
