"""What one frame says about the part, and whether to believe it."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from meso_robust.tracking.covariance import clustered, fused, systematic, turned
from meso_robust.tracking.edges import EdgeFit, Lens, Outline, placed, rotation
from meso_robust.tracking.memory import Memory
from meso_robust.tracking.sampling import Patch
from meso_robust.tracking.ssd import registered
from meso_robust.types import Flags, Floats

AGREES = 0.8
"""px; a found edge this near to the outline at the fitted pose agrees with it."""
LEAST_SCORE = 0.6
"""Share of the visible edge points that must agree."""
LEAST_SHARE = 0.3
"""Share of all edge points that must be used."""
LEAST_SUPPORT = 0.35
"""Share of what the visible outline could tell of any one motion that must agree: one of two opposite
sides may be taken for something else, as where it touches a wall."""
WORST_PX, WORST_RAD = 0.5, math.radians(0.5)
"""Standard deviations beyond which what is seen does not determine the pose."""
_LIKE_SELF = 0.5  # least correlation with the learned face
_APART = (0.7, 0.01)  # px and rad between edges and appearance beyond which the latter is set aside


@dataclass(frozen=True, slots=True, eq=False)
class Sighting:
    """What a frame says about the part.

    Attributes
    ----------
    pose
        (3,) u, v in ideal px and angle in rad: the point p of the outline is seen at
        (u, v) + R(angle) p with R acting on (u, v), v down, so a positive angle is clockwise on the
        screen. NaN when not found.
    covariance
        (3, 3) of it, systematic errors included; NaN when not found.
    found
        Whether the pose can be trusted.
    state
        "found", "occluded" (found, a part of the outline is hidden or covered), "leaving" (a part
        is outside the frame), "lost", or "ambiguous" (several places fit alike).
    reason
        In words; empty when all is well.
    score
        Share of the visible edge points that agree with the pose, 0...1.
    share
        Share of all edge points that were used.
    turns
        1, or n if the part looks alike in n orientations and nothing chose one.
    size
        Share of its lengths by which the part is seen longer than stated; 0 where that is not told.
    """

    pose: Floats
    covariance: Floats
    found: bool
    state: str
    reason: str
    score: float
    share: float
    turns: int = 1
    size: float = 0.0


class Measured(NamedTuple):
    """A pose near to a predicted one, before it is accepted."""

    edges: EdgeFit
    piece: Patch
    pose: Floats
    """(3,) edges and appearance together."""
    covariance: Floats
    """(3, 3)"""
    edge_pose: Floats
    """(3,) from edges alone, oblique light taken off."""
    edge_covariance: Floats
    """(3, 3) of it, without what is systematic."""
    score: float
    share: float
    fault: str
    """Why it cannot be trusted, or empty."""


def judged(piece: Patch, outline: Outline, fit: EdgeFit, memory: Memory, lens: Lens) -> Measured:
    """The pose from both stages with its covariance, and whether it can be trusted."""
    agrees = fit.visible & (fit.weight > 0.0) & (np.abs(fit.residual) < AGREES)
    score = float(agrees.sum() / max(fit.visible.sum(), 1))
    share = float(agrees.mean())
    edge_pose = fit.pose.copy()
    edge_pose[:2] -= memory.lamp
    turn = rotation(edge_pose[2])
    noise = turned(clustered(outline.design, fit.weight, fit.residual, outline.starts), turn)
    sides = systematic(outline.design, fit.weight, fit.residual, outline.modes)
    common = sides.covariance(turn, None)
    pose, covariance = edge_pose, noise
    if memory.template is not None:
        face = registered(piece, memory.template, edge_pose, lens)
        gap = None if face is None else np.abs(face.pose - edge_pose)
        if (
            face is not None
            and gap is not None
            and face.correlation > _LIKE_SELF
            and gap[:2].max() < _APART[0]
            and gap[2] < _APART[1]
        ):
            anchored = face.covariance + memory.anchor_covariance
            pose, covariance = fused(edge_pose, noise, face.pose, anchored)
    # a side's error was taken off together with the light's, as it was in the frames of that
    covariance = covariance + sides.covariance(turn, memory.lit) + memory.lamp_covariance
    support = _support(outline.moves, fit.visible, agrees)
    fault = _fault(score, share, support, noise + common)
    return Measured(fit, piece, pose, covariance, edge_pose, noise, score, share, fault)


def _support(design: Floats, visible: Flags, agrees: Flags) -> float:
    """How much of what the visible outline could tell of any motion agrees, 0...1, at worst.

    A rectangle that slides along itself agrees along its long sides; its short ones object.
    """
    from meso_robust.tracking.covariance_kernels import support

    return float(np.linalg.eigvalsh(support(design, visible, agrees))[0])


def _fault(score: float, share: float, support: float, covariance: Floats) -> str:
    """Why a pose cannot be trusted, or nothing."""
    sigma = np.sqrt(np.maximum(np.diag(covariance), 0.0))
    if share < LEAST_SHARE:
        return (
            f"only {100 * share:.0f} % of the outline is seen; at least {100 * LEAST_SHARE:.0f} %"
        )
    if score < LEAST_SCORE:
        return (
            f"only {100 * score:.0f} % of the visible outline agrees; "
            f"at least {100 * LEAST_SCORE:.0f} %"
        )
    if support < LEAST_SUPPORT:
        return (
            f"the visible edges across one direction of motion agree to {100 * support:.0f} % only; "
            f"at least {100 * LEAST_SUPPORT:.0f} %"
        )
    if not (sigma[:2].max() < WORST_PX and sigma[2] < WORST_RAD):
        return "what is seen of the outline does not determine the pose"
    return ""


def apart(a: Floats, b: Floats, turns: int) -> bool:
    """Whether two poses are different places, orientations that look alike being the same."""
    period = 2.0 * math.pi / turns
    turn = abs((a[2] - b[2] + 0.5 * period) % period - 0.5 * period)
    return bool(np.hypot(*(a[:2] - b[:2])) > 4.0 or turn > 0.05)


def sighting(
    measured: Measured,
    outline: Outline,
    lens: Lens,
    shape: tuple[int, ...],
    turns: int,
    size: float,
) -> Sighting:
    """What is reported of an accepted pose in a frame of ``shape`` (height, width)."""
    seen = lens.seen(placed(outline.corners, measured.pose))
    outside = ((seen < 0.0) | (seen > np.array(shape[::-1]) - 1.0)).any()
    hidden = 1.0 - measured.share
    state, reason = "found", ""
    if outside:
        state, reason = "leaving", "a part of the outline is outside the frame"
    elif hidden > 0.1:
        state, reason = "occluded", f"{100 * hidden:.0f} % of the outline is hidden or covered"
    if turns > 1:
        alike = f"looks alike in {turns} orientations and no start angle was given"
        reason = f"{reason}; {alike}" if reason else alike
    return Sighting(
        measured.pose,
        measured.covariance,
        True,
        state,
        reason,
        measured.score,
        measured.share,
        turns,
        size,
    )


def size_words(size: float) -> str:
    """What to know of a part that is seen longer than stated.

    Parameters
    ----------
    size
        Share of its lengths by which it is; negative: shorter.

    Returns
    -------
    str
        In words; empty if it is not.
    """
    if size == 0.0:
        return ""
    more = "larger" if size > 0.0 else "smaller"
    return (
        f"the part is seen {100 * abs(size):.1f} % {more} than stated; "
        "check the size of a pixel and that of the part"
    )


def lost(reason: str, best: Measured | None) -> Sighting:
    """No pose; ``best`` is what came nearest to one."""
    score, share = (0.0, 0.0) if best is None else (best.score, best.share)
    detail = f": {best.fault}" if best is not None and best.fault and best.fault != reason else ""
    nothing = np.full(3, np.nan)
    return Sighting(nothing, np.full((3, 3), np.nan), False, "lost", reason + detail, score, share)


def unclear(best: Measured, reason: str) -> Sighting:
    """No pose, since there are several."""
    nothing = np.full(3, np.nan)
    return Sighting(
        nothing, np.full((3, 3), np.nan), False, "ambiguous", reason, best.score, best.share
    )
