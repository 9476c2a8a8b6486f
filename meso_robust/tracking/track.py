"""A video to poses: probes, then what they hide, then the part, frame by frame, then the world."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from itertools import islice

import numpy as np

from meso_robust.tracking.calibration import Calibration
from meso_robust.tracking.frame_estimate import size_words
from meso_robust.tracking.frames import Frames
from meso_robust.tracking.learned import Tip
from meso_robust.tracking.needle import Needle
from meso_robust.tracking.pose import Lens, PartTracker, Sighting
from meso_robust.tracking.probe_search import SPREAD, moving_needles, needle_at
from meso_robust.tracking.probes import ProbeTracker
from meso_robust.tracking.reading_ahead import read_ahead
from meso_robust.tracking.scene import Scene as Scene, Start as Start
from meso_robust.types import Flags, Floats, Image

_UNSURE = 10.0  # times the standard deviation of a tip in most frames, from which on it is taken for unseen
_MOTION_FRAMES = 300  # searched for moving probes
_SIDES = 8  # pieces of an edge, so that its image may bend
_MOVED = 5.0  # standard deviations between the frames around a repeated one


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Track:
    """What was seen in one video: T frames, P probes; NaN where it was not found.

    Attributes
    ----------
    frames
        What was read.
    times
        (T,) s.
    poses
        (T, 3) x, y in m and θ in rad, world, continuous.
    covariances
        (T, 3, 3) of them.
    names
        P names of the probes.
    tips
        (T, P, 2) centres of the tips in m, world.
    tip_covariances
        (T, P, 2, 2) of them.
    states
        T words: found, occluded, leaving, lost, ambiguous or repeated.
    reasons
        T explanations, empty where all is well.
    tip_reasons
        T tuples of P explanations.
    scores
        (T,) of the part, 0 to 1.
    notes
        What a user should know.
    turns
        Orientations in which the part looks alike and among which no start angle chose; 1: none.
    """

    frames: Frames
    times: Floats
    poses: Floats
    covariances: Floats
    names: tuple[str, ...]
    tips: Floats
    tip_covariances: Floats
    states: tuple[str, ...]
    reasons: tuple[str, ...]
    tip_reasons: tuple[tuple[str, ...], ...]
    scores: Floats
    notes: tuple[str, ...]
    turns: int = 1

    @property
    def found(self) -> Flags:
        """(T,) whether the part has a pose."""
        return np.asarray(np.isfinite(self.poses[:, 0]))


def track(frames: Frames, scene: Scene, each: Callable[[], object] = lambda: None) -> Track:
    """Track the part and the probes through a video.

    Parameters
    ----------
    frames
        The video; it is read once, and its first frames twice if probes are to be found.
    scene
        What is known.
    each
        Called after every frame.

    Raises
    ------
    InputError
        The frames break a rule, the image's size is not that of the calibration, or a stated tip lies
        outside the image.
    """
    calibration = scene.calibration
    radius = scene.tip_radius / calibration.pixel_size
    probes = _probes(frames, scene, radius)
    follower = _Follower(scene, probes)
    times: list[float] = []
    sightings: list[Sighting] = []
    tips: list[list[Tip]] = []
    repeats: list[bool] = []
    before: Image | None = None
    for frame in read_ahead(frames):
        seen, found = follower.step(frame.image)
        times.append(frame.time)
        sightings.append(seen)
        tips.append(found)
        repeats.append(before is not None and np.array_equal(before, frame.image))
        before = frame.image
        each()
    return _finished(frames, scene, probes, times, sightings, tips, repeats)


class _Follower:
    """State from frame to frame."""

    def __init__(self, scene: Scene, probes: list[ProbeTracker]) -> None:
        calibration = scene.calibration
        self._calibration = calibration
        self._probes = probes
        bent = calibration.k1 != 0.0
        lens = (
            Lens(to_ideal=calibration.to_ideal, to_image=calibration.to_image) if bent else Lens()
        )
        corners = calibration.outline_px(scene.outline)
        self._part = PartTracker(corners, lens=lens)
        self._border = _densified(corners) if bent else corners
        self._guess = None if scene.pose is None else calibration.pose_to_pixels(scene.pose)
        self._outline: Floats | None = None
        self._started = False

    def step(self, image: Image) -> tuple[Sighting, list[Tip]]:
        """The part and the probes in the next frame."""
        if self._started:
            tips = [probe.next(image, self._outline) for probe in self._probes]
            seen = self._part.next(image, self._mask(image))
        else:
            # needles are learned clear of the part, so the part is found first, behind rough masks
            seen = self._part.first(image, self._guess, self._mask(image))
            if seen.found:
                self._outline = self._seen_outline(seen.pose)
            tips = [probe.first(image, self._outline) for probe in self._probes]
            self._started = True
        if seen.found:
            self._outline = self._seen_outline(seen.pose)
        for probe, tip in zip(self._probes, tips, strict=True):
            probe.remember(image, tip, self._outline if seen.found else None)
        return seen, tips

    def _mask(self, image: Image) -> Image | None:
        if not self._probes:
            return None
        mask, *others = [probe.mask(image.shape) for probe in self._probes]
        for other in others:
            np.maximum(mask, other, out=mask)
        return mask

    def _seen_outline(self, pose: Floats) -> Floats:
        """(V, 2) of the part's border in seen px."""
        c, s = math.cos(pose[2]), math.sin(pose[2])
        turned = self._border @ np.array([[c, s], [-s, c]])
        return self._calibration.to_image(turned + pose[:2])


def _densified(corners: Floats) -> Floats:
    share = np.arange(_SIDES)[None, :, None] / _SIDES
    after = np.roll(corners, -1, axis=0)
    return ((1.0 - share) * corners[:, None] + share * after[:, None]).reshape(-1, 2)


def _probes(frames: Frames, scene: Scene, radius: float) -> list[ProbeTracker]:
    """Trackers of the stated probes, or of those that move."""
    if scene.probes is not None:
        first = next(iter(frames)).image
        return [
            ProbeTracker(
                start.name,
                needle_at(first, scene.calibration.to_pixels(np.array(start.tip)), radius),
            )
            for start in scene.probes
        ]
    most = min(frames.promised or _MOTION_FRAMES, _MOTION_FRAMES)
    apart = max(most // SPREAD, 1)
    images = [frame.image for frame in islice(frames, 0, most, apart)]
    found: list[Needle] = moving_needles(images, radius)
    return [ProbeTracker(f"probe{k + 1}", needle) for k, needle in enumerate(found)]


def _finished(
    frames: Frames,
    scene: Scene,
    probes: list[ProbeTracker],
    times: list[float],
    sightings: list[Sighting],
    tips: list[list[Tip]],
    repeats: list[bool],
) -> Track:
    calibration = scene.calibration
    notes = list(frames.notes)
    if frames.promised is not None and len(times) < frames.promised:
        notes.append(f"truncated: {len(times)} of {frames.promised} declared frames are used")
    turns = sightings[0].turns
    if turns > 1:
        notes.append(
            f"the part looks alike in {turns} orientations and no start angle was given: every theta "
            f"is right up to {360 / turns:g} deg; give --start"
        )
    if said := size_words(sightings[0].size):
        notes.append(said)
    if scene.probes is None and not probes:
        notes.append("no probe was seen to move in from the border; give --probe if there is one")
    places, spreads, tip_reasons = _placed(calibration, probes, tips, notes)
    poses = calibration.pose_to_world(np.array([seen.pose for seen in sightings]))
    covariances = calibration.pose_covariance(np.array([seen.covariance for seen in sightings]))
    states = [seen.state for seen in sightings]
    reasons = [seen.reason for seen in sightings]
    for k in _stale(repeats, poses, covariances):
        states[k], reasons[k] = "repeated", "the same image as the frame before, in motion"
        poses[k], covariances[k], places[k], spreads[k] = math.nan, math.nan, math.nan, math.nan
    return Track(
        frames=frames,
        times=np.array(times),
        poses=poses,
        covariances=covariances,
        names=tuple(probe.name for probe in probes),
        tips=places,
        tip_covariances=spreads,
        states=tuple(states),
        reasons=tuple(reasons),
        tip_reasons=tip_reasons,
        scores=np.array([seen.score for seen in sightings]),
        notes=tuple(notes),
        turns=turns,
    )


def _placed(
    calibration: Calibration, probes: list[ProbeTracker], tips: list[list[Tip]], notes: list[str]
) -> tuple[Floats, Floats, tuple[tuple[str, ...], ...]]:
    """Tips (T, P, 2) in m, their covariances (T, P, 2, 2) in m², and why there is none."""
    places = np.full((len(tips), len(probes), 2), math.nan)
    spreads = np.full((len(tips), len(probes), 2, 2), math.nan)
    reasons = [[tip.reason for tip in row] for row in tips]
    for p, probe in enumerate(probes):
        found = probe.places([row[p] for row in tips])
        if found.remark:
            notes.append(f"{probe.name}: {found.remark}")
        places[:, p] = calibration.to_world(found.tips)
        spreads[:, p] = calibration.point_covariance(found.tips, found.covariances)
        for k in np.flatnonzero(np.isnan(found.tips[:, 0])):
            reasons[k][p] = reasons[k][p] or found.remark
        for frame in _unsure(spreads[:, p]):
            places[frame, p] = spreads[frame, p] = math.nan
            reasons[frame][p] = "its end is known far worse than in other frames"
    return places, spreads, tuple(map(tuple, reasons))


def _unsure(spreads: Floats) -> list[int]:
    """Frames in which a tip is known so much worse than in most, (T, 2, 2) m², that its neighbours tell better.

    So where it is about to touch, and its end is hardly told from the part's edge.
    """
    seen = np.flatnonzero(np.isfinite(spreads).all(axis=(1, 2)))
    if not seen.size:
        return []
    worst = np.sqrt(np.linalg.eigvalsh(spreads[seen])[:, -1])
    return [int(k) for k in seen[worst > _UNSURE * np.median(worst)]]


def _stale(repeats: list[bool], poses: Floats, covariances: Floats) -> list[int]:
    """Frames that repeat the one before although the part moved meanwhile.

    A camera that drops a frame may hand out the last one again; its instant is then wrong. A part at
    rest in a compressed video may well look the same twice.
    """
    found = [k for k, repeated in enumerate(repeats) if not repeated and np.isfinite(poses[k, 0])]
    stale = []
    for k in np.flatnonzero(repeats).tolist():
        before = max((j for j in found if j < k), default=None)
        after = min((j for j in found if j > k), default=None)
        if before is None or after is None:
            continue
        step = poses[after] - poses[before]
        spread = covariances[after] + covariances[before]
        if float(step @ np.linalg.solve(spread, step)) > 3.0 * _MOVED**2:
            stale.append(k)
    return stale
