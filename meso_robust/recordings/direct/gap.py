"""The gap between tip and face while the part moves: zero, unless frames, scales or clocks disagree.

A part that moves is touched. So the distance from the tip's surface to the outline, as the files have
it, is the error of what they are seen by, in first order

    gap = -n·s - n_b·c + ψ (n_b × q) + φ (n_b × q - n·J r) - n·D r + e + |n_b|·d + τ n·v,

n and n_b the outward normal in world and body frame, q the tip in the body frame, r the seen place
in the world, v the tip's velocity: registration shift s, reference offset c, yaw ψ of the
part's frame, rotation φ and stretch D of the camera, radius e, outline d and latency τ.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from meso_robust.recordings.contact import size
from meso_robust.recordings.direct.finding import Finding, possible
from meso_robust.recordings.direct.pushing import Contacts
from meso_robust.recordings.direct.selection import Columns, selected, spread
from meso_robust.recordings.rules import DEG, UM
from meso_robust.recordings.values import RecordingSet
from meso_robust.types import Floats, Ints

_FEWEST = 10
_MS = 1e-3
_PERCENT = 1e-2


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class GapTest:
    """Distances between tips and the faces that they push.

    Attributes
    ----------
    recording
        (n,) number of the recording of each row.
    before, after
        (n,) gap in m as the files have it, and with what was found taken out.
    findings
        What explains it.
    """

    recording: Ints
    before: Floats
    after: Floats
    findings: tuple[Finding, ...]

    @property
    def rms(self) -> tuple[float, float]:
        """Root mean square in m, far frames clipped, before and after."""
        return spread(self.before), spread(self.after)


def gap_test(
    recordings: RecordingSet, pairs: Contacts, known: frozenset[str] = frozenset()
) -> GapTest | None:
    """Explain the gap between tip and face while the part moves.

    Parameters
    ----------
    recordings
        The set.
    pairs
        Of its pushing frames.
    known
        Effects that are taken out of the pairs already.

    Returns
    -------
    GapTest or None
        None of fewer than ten frames.
    """
    if pairs.gap.size < _FEWEST:
        return None
    size_um = size(recordings.part.outline) / UM
    seen = recordings.position_source == "camera"
    chosen = selected(
        pairs.gap,
        np.unique(pairs.recording, return_inverse=True)[1],
        {name: one for name, one in _columns(pairs, seen).items() if name not in known},
        lambda effect, key, value: possible(effect, key, value, size_um),
    )
    findings = tuple(
        Finding(
            test="gap",
            effect=step.effect,
            estimates=chosen.estimates[step.effect],
            before=step.before,
            after=step.after,
            p_value=step.p_value,
            alike=step.alike,
        )
        for step in chosen.steps
    )
    return GapTest(
        recording=pairs.recording, before=pairs.gap, after=chosen.residual, findings=findings
    )


def _columns(pairs: Contacts, tips_seen: bool) -> Mapping[str, Columns]:
    """Change of the gap for each number; a camera that sees the tips as well moves both alike."""
    own, tip = pairs.normal, pairs.tip
    cos, sin = np.cos(pairs.poses[:, 2]), np.sin(pairs.poses[:, 2])
    normal = np.stack((cos * own[:, 0] - sin * own[:, 1], sin * own[:, 0] + cos * own[:, 1]), -1)
    place = pairs.poses[:, :2]
    lever = own[:, 0] * tip[:, 1] - own[:, 1] * tip[:, 0]
    xy = ("x_um", "y_um")
    columns = {
        "reference_offset": Columns(xy, -UM * own),
        "part_yaw": Columns(("angle_deg",), DEG * lever[:, None]),
        "tip_radius": Columns(("excess_um",), np.full((len(own), 1), UM)),
        "part_geometry": Columns(xy, UM * np.abs(own)),
    }
    if tips_seen:
        return columns
    speed = np.sum(normal * pairs.tip_velocities, axis=1)
    swing = -normal[:, 0] * place[:, 1] + normal[:, 1] * place[:, 0]
    stretch = -_PERCENT * normal * place
    return columns | {
        "registration_shift": Columns(xy, -UM * normal),
        "camera_rotation": Columns(("angle_deg",), DEG * (lever - swing)[:, None]),
        "camera_scale": Columns(("percent",), stretch.sum(axis=1, keepdims=True)),
        "camera_anisotropy": Columns(("x_percent", "y_percent"), stretch),
        "camera_latency": Columns(("time_ms",), _MS * speed[:, None]),
    }
