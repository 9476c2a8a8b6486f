"""The part in one frame after the other: its pose with a covariance, or why it cannot be trusted."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import cv2
import numpy as np

from meso_robust.live.lab_file import CameraSection, Lab
from meso_robust.tracking.calibration import Calibration
from meso_robust.tracking.frame_estimate import size_words
from meso_robust.tracking.needle import Needle
from meso_robust.tracking.pose import Lens, PartTracker
from meso_robust.tracking.template import symmetry
from meso_robust.types import Floats, Image

UM, DEG = 1e-6, math.pi / 180.0
SIGMAS = 3.0
"""Standard deviations of a pose that must lie within the error that the task states."""
_MARGIN = 4.0  # px about a probe that hides the part, for its meniscus
_TAPER = 0.1  # rad, of a usual etched needle
_FAR_TURN = 0.25  # of the turn after which the part looks alike: beyond it the angle is a guess


@dataclass(frozen=True, slots=True, kw_only=True)
class Sight:
    """What a frame shows of the part; um and deg, world frame."""

    pose: tuple[float, float, float] | None
    """x_um, y_um, theta_deg; None if it cannot be trusted."""
    sigma: tuple[float, float, float] | None
    """Standard deviations of them."""
    covariance: tuple[float, ...] | None
    """Upper triangle of their covariance, row by row; um and deg."""
    state: str
    """found, occluded, leaving, lost, ambiguous or doubtful."""
    reason: str
    """Why it cannot be trusted, or what to know; empty if all is well."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Trust:
    """How accurate a pose must be, so that what is proved of it holds; um and deg."""

    position_um: float
    orientation_deg: float


def calibration_of(camera: CameraSection) -> Calibration:
    """Where the camera looks.

    Parameters
    ----------
    camera
        As the laboratory's file states it.

    Returns
    -------
    Calibration
        For the tracker, SI.
    """
    return Calibration(
        pixel_size=camera.pixel_size_um * UM,
        size=(camera.width_px, camera.height_px),
        centre=(camera.centre_um[0] * UM, camera.centre_um[1] * UM),
        rotation=camera.rotation_deg * DEG,
        k1=camera.k1,
    )


class Eye:
    """Looks at frames.

    Parameters
    ----------
    outline
        (V, 2) corners of the part, m.
    lab
        The camera and the tips that may hide the part.
    guess
        (3,) where the part may be at first, m and rad; its angle chooses between orientations in which
        the part looks alike.
    trust
        What the task states of sensed poses.
    """

    def __init__(self, outline: Floats, lab: Lab, guess: Floats, trust: Trust) -> None:
        self.calibration = calibration_of(lab.camera)
        bent = self.calibration.k1 != 0.0
        lens = (
            Lens(to_ideal=self.calibration.to_ideal, to_image=self.calibration.to_image)
            if bent
            else Lens()
        )
        self._tracker = PartTracker(self.calibration.outline_px(outline), lens=lens)
        self._camera, self._trust, self._guess = lab.camera, trust, np.asarray(guess, dtype=float)
        self._tips = {tip.name: tip for one in lab.manipulators for tip in one.tips}
        self._turns = symmetry(self.calibration.outline_px(outline))
        self._begun = False
        self.outline = outline

    def look(self, image: Image, lowered: Mapping[str, Floats]) -> Sight:
        """What a frame shows.

        Parameters
        ----------
        image
            (H, W) uint8.
        lowered
            (2,) centres of the tips that are in the plane, um: what lies below their shafts is not
            looked at.
        """
        if image.shape != (self._camera.height_px, self._camera.width_px):
            high, wide = image.shape[:2]
            return _nothing(
                "lost",
                f"the image has {wide} x {high} px; the laboratory's file states "
                f"{self._camera.width_px} x {self._camera.height_px}",
            )
        mask = self._mask(lowered)
        if self._begun:
            seen = self._tracker.next(image, mask)
        else:
            guess = self.calibration.pose_to_pixels(self._guess)
            seen = self._tracker.first(image, guess, mask)
            turn = self.calibration.rotation - float(seen.pose[2])
            if seen.found and self._either_way(turn):
                shown = math.degrees(turn)
                return _nothing(
                    "ambiguous",
                    f"the part looks alike in {self._turns} orientations, and {shown:.1f} deg is no nearer "
                    "to the expected one than another; turn it nearer, or give --start-deg",
                )
            self._begun = seen.found
        if not seen.found:
            return _nothing(seen.state, seen.reason)
        pose = self.calibration.pose_to_world(seen.pose)
        spread = self.calibration.pose_covariance(seen.covariance)
        words = "; ".join(filter(None, (seen.reason, size_words(seen.size))))
        return self._judged(pose, spread, seen.state, words)

    def _judged(self, pose: Floats, spread: Floats, state: str, reason: str) -> Sight:
        scale = np.array([1.0 / UM, 1.0 / UM, 1.0 / DEG])
        shown, covariance = pose * scale, spread * np.outer(scale, scale)
        sigma = np.sqrt(np.maximum(np.diag(covariance), 0.0))
        fault = self._fault(pose, sigma)
        return Sight(
            pose=None if fault else (float(shown[0]), float(shown[1]), float(shown[2])),
            sigma=(float(sigma[0]), float(sigma[1]), float(sigma[2])),
            covariance=tuple(float(v) for v in covariance[np.triu_indices(3)]),
            state="doubtful" if fault else state,
            reason=fault or reason,
        )

    def _fault(self, pose: Floats, sigma: Floats) -> str:
        camera, trust = self._camera, self._trust
        position = SIGMAS * float(sigma[:2].max()) + camera.position_error_um
        turn = SIGMAS * float(sigma[2]) + camera.orientation_error_deg
        if not position <= trust.position_um:
            return f"the position is known to {position:.2f} um; the task needs {trust.position_um:g} um"
        if not turn <= trust.orientation_deg:
            return (
                f"the orientation is known to {turn:.3f} deg; the task needs "
                f"{trust.orientation_deg:g} deg"
            )
        return ""

    def _mask(self, lowered: Mapping[str, Floats]) -> Image | None:
        if not lowered:
            return None
        shape = (self._camera.height_px, self._camera.width_px)
        hidden = np.zeros(shape, np.uint8)
        for name, place in lowered.items():
            corners = self._shadow(name, place, math.hypot(*shape))
            cv2.fillPoly(hidden, [np.rint(corners * 16.0).astype(np.int32)], 255, cv2.LINE_8, 4)
        return hidden

    def _shadow(self, name: str, place: Floats, long: float) -> Floats:
        """(V, 2) px that a probe hides."""
        tip = self._tips[name]
        at = self.calibration.to_pixels(np.asarray(place) * UM)
        # v runs down, so an angle of the world is mirrored, and the camera's turn is taken off
        angle = self.calibration.rotation - tip.direction_deg * DEG
        needle = Needle(
            tip=(float(at[0]), float(at[1])),
            direction=angle,
            taper=_TAPER,
            radius=tip.radius_um * UM / self.calibration.pixel_size,
        )
        return needle.polygon(_MARGIN, long)

    def _either_way(self, angle: float) -> bool:
        """Whether a first angle is so far from the guess that another one is about as likely."""
        if self._turns == 1:
            return False
        period = 2.0 * math.pi / self._turns
        off = angle - float(self._guess[2])
        return abs((off + 0.5 * period) % period - 0.5 * period) > _FAR_TURN * period


def _nothing(state: str, reason: str) -> Sight:
    return Sight(pose=None, sigma=None, covariance=None, state=state, reason=reason)


def spread_of(poses: Sequence[tuple[float, float, float]]) -> tuple[float, float]:
    """By how much some poses differ at most: um of x or y, and deg.

    Parameters
    ----------
    poses
        um and deg.

    Returns
    -------
    tuple
        Largest less least.
    """
    table = np.array(poses)
    turns = (table[:, 2] - table[0, 2] + 180.0) % 360.0 - 180.0
    return float(np.ptp(table[:, :2], axis=0).max()), float(np.ptp(turns))
