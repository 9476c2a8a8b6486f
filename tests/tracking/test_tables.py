"""One table of everything, in memory and in files, and what is said where it cannot be written."""

from __future__ import annotations

import re
import sys
from base64 import b64decode
from pathlib import Path

import cv2
import numpy as np
import pytest

import meso_robust as mr
from meso_robust.api.track import Tracked
from meso_robust.errors import InputError
from meso_robust.tracking.tables import Format
from tests.tracking.pushes import PIXEL, RADIUS, Filmed, push


@pytest.fixture(scope="module")
def filmed(tmp_path_factory: pytest.TempPathFactory) -> Filmed:
    return push(tmp_path_factory.mktemp("film") / "push.avi", 10)


@pytest.fixture(scope="module")
def tracked(filmed: Filmed) -> Tracked:
    x, y = (1e6 * filmed.tips[0, 0]).tolist()
    return mr.track(
        filmed.path,
        length_um=1616.0,
        width_um=837.0,
        tip_radius_um=1e6 * RADIUS,
        pixel_um=1e6 * PIXEL,
        start=(None, None, 0.0),
        probes={"tip": (x, y)},
    )


def test_a_data_frame_has_a_row_for_every_frame(tracked: Tracked, filmed: Filmed) -> None:
    frame = tracked.to_frame()

    assert list(frame["recording"].unique()) == ["push.csv"]
    assert np.allclose(frame["time_s"], filmed.times, atol=1e-6)
    assert np.abs(frame["part_x_um"] * 1e-6 - filmed.poses[:, 0]).max() < PIXEL
    assert np.abs(frame["tip_y_um"] * 1e-6 - filmed.tips[:, 0, 1]).max() < PIXEL
    sigma = np.sqrt(tracked.found.tracks[0].covariances[:, 2, 2])
    assert np.allclose(np.radians(frame["part_theta_sigma_deg"]), sigma)


def test_the_report_shows_frames_with_what_was_seen(tracked: Tracked) -> None:
    page = tracked.files()["report.html"]
    pictures = re.findall(r'src="data:image/jpeg;base64,([^"]*)".*?<figcaption>([^<]*)', page)

    words = [caption for _, caption in pictures]
    assert "push.avi, frame 0: first" in words
    assert "push.avi, frame 9: last" in words
    shown = cv2.imdecode(np.frombuffer(b64decode(pictures[0][0]), np.uint8), cv2.IMREAD_COLOR)
    assert shown is not None
    assert shown.shape == (480, 640, 3)
    assert (np.ptp(shown.astype(int), axis=2) > 40).sum() > 300  # drawn in colours


def test_files_hold_the_same_table(tracked: Tracked, tmp_path: Path) -> None:
    import h5py
    import pandas

    tracked.save(tmp_path, overlay=False, tables="parquet")
    tracked.save(tmp_path, overlay=False, tables="hdf5")

    frame = tracked.to_frame()
    pandas.testing.assert_frame_equal(
        pandas.read_parquet(tmp_path / "track.parquet"), frame, check_dtype=False
    )
    with h5py.File(tmp_path / "track.h5") as file:
        assert set(file) == set(frame.columns)
        assert np.array_equal(file["part_y_um"][:], frame["part_y_um"], equal_nan=True)
        assert [text.decode() for text in file["state"][:]] == list(frame["state"])


@pytest.mark.parametrize(("form", "module"), [("parquet", "pyarrow"), ("hdf5", "h5py")])
def test_a_missing_library_is_told_with_its_extra(
    tracked: Tracked, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, form: Format, module: str
) -> None:
    monkeypatch.setitem(sys.modules, module, None)

    with pytest.raises(InputError, match=f"needs {module}.*extra `tables`"):
        tracked.save(tmp_path / "out", overlay=False, tables=form)
    assert not (tmp_path / "out" / "track.json").exists()
