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
from dataclasses import dataclass, replace

import numpy as np

from meso_robust.recordings.contact import size
from meso_robust.recordings.direct.finding import Finding, possible
from meso_robust.recordings.direct.pushing import Contacts, pair
from meso_robust.recordings.direct.selection import Columns, Comparison, Selection, selected, spread
from meso_robust.recordings.rules import DEG, UM
from meso_robust.recordings.values import RecordingSet
from meso_robust.types import Floats

_FEWEST = 10
_PASSES = 4
_MS = 1e-3
_PERCENT = 1e-2


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class GapTest(Comparison):
    """Distances between tips and the faces that they push."""


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
    groups = np.unique(pairs.recording, return_inverse=True)[1]

    def explained(at: Contacts, values: Floats) -> Selection:
        columns = {name: one for name, one in _columns(at, seen).items() if name not in known}
        return selected(
            values,
            groups,
            columns,
            lambda effect, key, value: possible(effect, key, value, size_um),
        )

    chosen = explained(pairs, pairs.gap)
    for _ in range(_PASSES if chosen.steps else 0):  # the nearest face may be another one then
        sizes = {
            (name, one.key): one.value for name, each in chosen.estimates.items() for one in each
        }
        moved = _undone(recordings.part.outline, pairs, sizes)
        columns = _columns(moved, seen)
        already = sum(
            (
                columns[name].values @ np.array([one.value for one in each])
                for name, each in chosen.estimates.items()
            ),
            np.zeros(moved.gap.size),
        )
        again = explained(moved, moved.gap + already)
        if spread(again.residual) >= spread(chosen.residual):
            break
        chosen = again
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


def _undone(outline: Floats, pairs: Contacts, sizes: Mapping[tuple[str, str], float]) -> Contacts:
    """The pairs with all that moves a part or a tip taken out; what changes the outline stays."""

    def size_of(effect: str, key: str) -> float:
        return sizes.get((effect, key), 0.0)

    poses = pairs.poses.copy()
    cos, sin = np.cos(poses[:, 2]), np.sin(poses[:, 2])
    x, y = pairs.tip.T
    tips = poses[:, :2] + np.column_stack((cos * x - sin * y, sin * x + cos * y))
    tips -= _MS * size_of("camera_latency", "time_ms") * pairs.tip_velocities
    poses[:, :2] -= UM * np.array([size_of("registration_shift", key) for key in ("x_um", "y_um")])
    stretch = [size_of("camera_anisotropy", key) for key in ("x_percent", "y_percent")]
    poses[:, :2] /= 1.0 + _PERCENT * (np.array(stretch) + size_of("camera_scale", "percent"))
    turn = DEG * size_of("camera_rotation", "angle_deg")
    c, s = np.cos(turn), np.sin(turn)
    poses[:, :2] = poses[:, :2] @ np.array([[c, -s], [s, c]])
    poses[:, 2] -= turn + DEG * size_of("part_yaw", "angle_deg")
    cos, sin = np.cos(poses[:, 2]), np.sin(poses[:, 2])
    x, y = (UM * size_of("reference_offset", key) for key in ("x_um", "y_um"))
    poses[:, :2] -= np.column_stack((cos * x - sin * y, sin * x + cos * y))
    gap, normal, tip = pair(outline, poses, tips)
    return replace(pairs, poses=poses, gap=gap - pairs.tip_radius, normal=normal, tip=tip)


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
