"""The importers on recordings of others, where a folder of them lies beside the repository."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from meso_robust.recordings import RecordingSet, unwrapped
from meso_robust.recordings.importers import FORMATS, Imported

REAL = Path(__file__).resolve().parents[4] / "shared" / "recordings"
pytestmark = pytest.mark.skipif(not REAL.is_dir(), reason="no recordings of others beside it")


def imported(folder: str) -> Imported:
    """The one format that recognises a folder, and what it reads."""
    mine = [name for name, form in FORMATS.items() if form.recognises(REAL / folder)]
    assert len(mine) == 1, mine
    return FORMATS[mine[0]].read(REAL / folder)


def in_part(recordings: RecordingSet) -> list[np.ndarray]:
    """(T, P, 2) tips in the part's frame, of each recording, where both are known."""
    found = []
    for recording in map(unwrapped, recordings.recordings):
        cos, sin = np.cos(recording.poses[:, 2]), np.sin(recording.poses[:, 2])
        d = recording.probes - recording.poses[:, None, :2]
        body = np.stack(
            [
                cos[:, None] * d[..., 0] + sin[:, None] * d[..., 1],
                -sin[:, None] * d[..., 0] + cos[:, None] * d[..., 1],
            ],
            axis=-1,
        )
        found.append(body[np.isfinite(body).all(axis=(1, 2))])
    return found


def gap(recordings: RecordingSet, tips: np.ndarray) -> np.ndarray:
    """(T, P) distance of tips from a convex outline less the radius; negative inside."""
    outline = recordings.part.outline
    side = np.roll(outline, -1, axis=0) - outline
    normal = np.stack([side[:, 1], -side[:, 0]], axis=-1) / np.linalg.norm(side, axis=1)[:, None]
    out = np.einsum("tpk,sk->tps", tips, normal) - np.sum(outline * normal, axis=1)
    return out.max(axis=-1) - recordings.tip_radius


@pytest.mark.parametrize(
    ("folder", "pushes", "deepest"),
    [
        ("mit_plywood", 20, 2.0e-3),
        ("cmu_two_finger/bigrect_3pts_30_50_60", 15, 6.0e-3),
        ("cmu_two_finger/tri_0_0_90", 15, 9.0e-3),
        ("cmu_support_points/wood_30_90_30_30_30_90", 50, 3.0e-3),
    ],
)
def test_outline_frame_and_tips_agree(folder: str, pushes: int, deepest: float) -> None:
    """The tips come near the outline, but not far inside: units and frames are right.

    The depth that is left is real: the camera of the two fingers lags by a tenth of a second.
    """
    recordings = imported(folder).recordings
    assert len(recordings.recordings) == pushes
    nearest = [np.quantile(gap(recordings, tips), 0.05) for tips in in_part(recordings)]
    assert -deepest < np.median(nearest) < 1.0e-3
    assert np.sum(np.array(nearest) < -deepest) <= pushes // 10


def test_forces_push_into_the_part() -> None:
    """The mean direction of the forces at the end of a push is into the touched side, each log.

    The cosine of a force within a friction cone of half-angle 30° about the normal exceeds 0.85.
    """
    recordings = imported("cmu_support_points/30_90_30_30_30_90").recordings
    for log in ("exp3_30", "exp8_35", "exp_08_11_30", "exp08_11_20"):
        cosines = []
        for recording in recordings.recordings:
            if recording.file.startswith(log):
                assert recording.forces is not None
                force = np.nanmean(recording.forces[-15:, 0], axis=0)
                moved = recording.probes[-1, 0] - recording.probes[-15, 0]
                cosines.append(force @ moved / np.linalg.norm(force) / np.linalg.norm(moved))
        assert np.median(cosines) > 0.8, log


def test_what_the_files_lack_is_told() -> None:
    left = imported("cmu_support_points/30_90_30_30_30_90").left
    assert {entry.file for entry in left} == {"exp9_15.txt.gz", "exp_08_11_50_mixed.txt.gz"}
    assert any("states 15 pushes and holds 11" in str(entry) for entry in left)
    assert all(entry.rows and entry.reason for entry in imported("mit_plywood").left)
