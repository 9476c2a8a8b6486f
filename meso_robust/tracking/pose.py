"""The pose of a part from frame to frame: search, edges and appearance put together."""

from __future__ import annotations

import math

import numpy as np

from meso_robust.errors import InputError
from meso_robust.recordings.outline import outline_fault
from meso_robust.tracking.edges import (
    Lens as Lens,
    edge_fit,
    placed,
    sampled_outline,
    seen_size,
    thinned,
)
from meso_robust.tracking.frame_estimate import (
    Measured,
    Sighting as Sighting,
    apart,
    judged,
    lost,
    sighting,
    unclear,
)
from meso_robust.tracking.memory import (
    LAMP_FRAMES,
    LEARNING,
    untaught,
    with_face,
    with_light,
    with_pattern,
)
from meso_robust.tracking.sampling import patch
from meso_robust.tracking.ssd import registered
from meso_robust.tracking.template import candidates, symmetry
from meso_robust.types import Floats, Image as Bytes

SMALLEST = 24.0
"""px; width below which an outline is refused: its opposite edges would be one to the tracker."""
_NEAR, _FAR, _FINE = 6.0, 14.0, 3.0  # reach in px of the edges: following, searching, measuring
_UNLEARNED, _LEARNED = 3.0, 0.3  # px, standard deviation of δ before and after learning
_TRIED = 10  # candidates of the search that are measured
_ALIKE = 0.9  # share of the best score from which another place fits alike
_SURE = 3.0  # standard deviations from which on a part is taken for larger or smaller than stated
_MISFIT = 0.5  # px, of one pair of sides against another: oblique light on rims makes less of it
_SIZED = 3  # times that its size is measured, the later ones where its edges are near


class PartTracker:
    """Follows one part of known outline.

    Parameters
    ----------
    outline_px
        (V, 2) corners in the part's frame in ideal px, v down, in either order; the origin is the
        reference point.
    lens
        Between seen and ideal px.

    Raises
    ------
    InputError
        If the outline is not a simple polygon or too narrow to be tracked.
    """

    def __init__(self, outline_px: Floats, lens: Lens | None = None) -> None:
        """Check the outline and take its points."""
        corners = _checked_outline(np.asarray(outline_px, dtype=float))
        self._stated = sampled_outline(corners)
        self._lens = Lens() if lens is None else lens
        self._turns = symmetry(corners)
        self._start()

    def _start(self) -> None:
        self._outline, self._size = self._stated, 0.0
        self._coarse = self._stated
        self._memory = untaught(self._outline.corners)
        self._pose: Floats | None = None
        self._motion = np.zeros(3)
        self._guess: Floats | None = None

    def first(
        self, frame: Bytes, guess: Floats | None = None, mask: Bytes | None = None
    ) -> Sighting:
        """Find the part anywhere in a frame, everything learned forgotten.

        Parameters
        ----------
        frame
            (H, W) uint8 grey.
        guess
            (3,) u, v and angle; tried first, and its angle chooses between orientations that look
            alike. u and v may be NaN.
        mask
            (H, W), non-zero where a probe hides the scene; or None.

        Raises
        ------
        InputError
            If the frame or the mask is not of this kind.
        """
        _check_frame(frame, mask)
        self._start()
        self._guess = None if guess is None else np.asarray(guess, dtype=float)
        return self._search(frame, mask, self._guess)

    def next(self, frame: Bytes, mask: Bytes | None = None) -> Sighting:
        """Find the part in the frame that follows; arguments and errors as of `first`."""
        _check_frame(frame, mask)
        if self._pose is None:
            return self._search(frame, mask, self._guess)
        for predicted, reach in (
            (self._pose + self._motion, _NEAR),
            (self._pose + self._motion, _FAR),
            (self._pose, _FAR),
        ):
            measured = self._measure(frame, mask, predicted, reach)
            if not measured.fault:
                before = self._pose
                seen = self._accepted(frame, mask, measured)
                self._motion = self._pose - before
                return seen
        return self._search(frame, mask, self._pose)

    def _measure(
        self, frame: Bytes, mask: Bytes | None, predicted: Floats, reach: float
    ) -> Measured:
        known = self._memory.frames > 0
        sigma = _LEARNED if known else _UNLEARNED
        around = self._lens.seen(placed(self._outline.corners, predicted))
        piece = patch(frame, mask, around, reach + 12.0)
        pose = predicted
        for within in (reach, _FINE) if reach <= _NEAR else (reach, 0.5 * reach, _FINE):
            # a step on the way to where all points are measured needs few of them
            near = known and _FINE < within <= _NEAR
            points = self._coarse if near else self._outline
            fit = edge_fit(piece, points, pose, self._lens, self._memory.pattern, within, sigma)
            if np.hypot(*(fit.pose[:2] - pose[:2])) > 2.0 * within:
                break
            pose = fit.pose
        return judged(piece, points, fit, self._memory, self._lens)

    def _search(self, frame: Bytes, mask: Bytes | None, near: Floats | None) -> Sighting:
        corners = self._outline.corners
        placed_near = near is not None and bool(np.isfinite(near).all())
        self._motion = np.zeros(3)
        starts = candidates(frame, mask, corners, _TRIED)
        if near is not None and placed_near:
            starts.insert(0, near)
        tried = [self._measure(frame, mask, start, _FAR) for start in starts]
        good = sorted((m for m in tried if not m.fault), key=lambda m: -m.score * m.share)
        if not good:
            best = max(tried, key=lambda m: m.score * m.share, default=None)
            if best is not None and self._memory.frames == 0:
                # one that is seen much larger or smaller fits nowhere as stated
                best = self._sized(frame, mask, best)
            if best is None or best.fault:
                return lost("no place fits the outline", best)
            good = [best]
        rivals = [m for m in good[1:] if apart(m.pose, good[0].pose, self._turns)]
        rivals = [m for m in rivals if m.score * m.share > _ALIKE * good[0].score * good[0].share]
        if rivals and not placed_near:
            u, v = rivals[0].pose[:2]
            return unclear(good[0], f"a place near ({u:.0f}, {v:.0f}) px fits as well")
        chosen = good[0]
        if rivals and near is not None:
            chosen = min((good[0], *rivals), key=lambda m: np.hypot(*(m.pose - near)[:2]))
        angle = chosen.pose[2] if near is None else near[2]
        measured = self._measure(frame, mask, self._turned(chosen, angle), _NEAR)
        if self._memory.frames == 0:
            measured = self._sized(frame, mask, measured)
        if measured.fault:
            return lost(measured.fault, measured)
        return self._accepted(frame, mask, measured)

    def _sized(self, frame: Bytes, mask: Bytes | None, measured: Measured) -> Measured:
        """The same with an outline of the size that the part is seen with, where that is surely another.

        Of two opposite edges that do not both fit, one would be taken for clutter, and the pose be wrong by the
        whole misfit of the other. The size is measured with a single step first, then with what the outline
        looks like: a step may meet the rim's inner edge on one pair of sides.
        """
        stated, share, seen = self._stated, 0.0, measured
        for _ in range(_SIZED):
            more, sigma = seen_size(
                seen.piece, self._outline, seen.edges.pose, self._lens,
                self._memory.pattern, _NEAR, _UNLEARNED,
            )  # fmt: skip
            share += more * (1.0 + share)
            self._outline = sampled_outline((1.0 + share) * stated.corners)
            self._memory = untaught(self._outline.corners)
            seen = self._measure(frame, mask, seen.edges.pose, _NEAR)
            self._memory = with_pattern(
                self._memory, seen.piece, self._outline, seen.edges.pose, self._lens
            )
        away = np.sum(stated.points * stated.normals, axis=1)
        if abs(share) > _SURE * sigma and abs(share) * float(np.ptp(away)) > _MISFIT:
            self._size, self._memory = share, untaught(self._outline.corners)
            return self._measure(frame, mask, seen.edges.pose, _NEAR)
        self._outline, self._memory = stated, untaught(stated.corners)
        return measured

    def _turned(self, measured: Measured, angle: float) -> Floats:
        """The pose among those that look alike: as the face was learned, else nearest to an angle."""
        period = 2.0 * math.pi / self._turns
        pose = measured.edge_pose.copy()
        pose[2] += period * np.round((angle - pose[2]) / period)
        if self._memory.template is None or self._turns == 1:
            return pose
        likeness = []
        for k in range(self._turns):
            turned_pose = pose + np.array([0.0, 0.0, k * period])
            fit = registered(measured.piece, self._memory.template, turned_pose, self._lens)
            likeness.append(0.0 if fit is None else fit.correlation)
        best = int(np.argmax(likeness))
        clear = likeness[best] > likeness[0] + 0.2
        turn = (best + self._turns // 2) % self._turns - self._turns // 2 if clear else 0
        return pose + np.array([0.0, 0.0, turn * period])

    def _accepted(self, frame: Bytes, mask: Bytes | None, measured: Measured) -> Sighting:
        if self._memory.frames < LEARNING:
            measured = self._taught(frame, mask, measured)
        self._pose = measured.pose
        turns = self._turns if self._guess is None else 1
        return sighting(measured, self._outline, self._lens, frame.shape, turns, self._size)

    def _taught(self, frame: Bytes, mask: Bytes | None, measured: Measured) -> Measured:
        """Learn from a frame, and measure it again with what was learned."""
        memory, outline, lens = self._memory, self._outline, self._lens
        piece, edges = measured.piece, measured.edges
        if memory.frames == 0:
            self._coarse = thinned(outline)
            # a single step may have met the rim's inner edge on one side: once more, with its mean.
            # What is learned below belongs to the pose that this pattern finds, as later ones are.
            for _ in range(2):
                memory = with_pattern(memory, piece, outline, edges.pose, lens)
                edges = edge_fit(
                    piece, outline, edges.pose, lens, memory.pattern, _FINE, _UNLEARNED
                )
        if len(memory.lamps) < LAMP_FRAMES:
            memory = with_light(memory, frame, mask, outline, edges, lens, sized=self._size != 0.0)
        corrected = edges.pose.copy()
        corrected[:2] -= memory.lamp
        self._memory = with_face(memory, piece, corrected, measured.edge_covariance, lens)
        return self._measure(frame, mask, edges.pose, _FINE)


def _checked_outline(corners: Floats) -> Floats:
    if corners.ndim != 2 or corners.shape[1:] != (2,) or not np.isfinite(corners).all():
        raise InputError(f"outline_px: shape {corners.shape}; must be finite (V, 2); give corners")
    fault = outline_fault(corners)
    if fault is not None and "clockwise" in fault:
        fault = outline_fault(corners[::-1])
    if fault is not None:
        raise InputError(f"outline_px: {fault}")
    width = _width(corners)
    if width < SMALLEST:
        raise InputError(
            f"outline_px: {width:.1f} px wide; must be at least {SMALLEST:.0f}; magnify more"
        )
    return corners.copy()


def _width(corners: Floats) -> float:
    """Smallest extent in px over all directions (of a rectangle that encloses the outline)."""
    sides = np.roll(corners, -1, axis=0) - corners
    along = sides / np.linalg.norm(sides, axis=1, keepdims=True)
    across = np.column_stack((-along[:, 1], along[:, 0]))
    return float(np.ptp(corners @ across.T, axis=0).min())


def _check_frame(frame: Bytes, mask: Bytes | None) -> None:
    if frame.ndim != 2 or frame.dtype != np.uint8:
        raise InputError(
            f"frame: {frame.dtype} {frame.shape}; must be uint8 (height, width); convert to grey"
        )
    if mask is not None and mask.shape != frame.shape:
        raise InputError(f"mask: {mask.shape}; must be {frame.shape} as the frame; draw it there")
