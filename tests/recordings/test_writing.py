"""What is written is read back, and what cannot be read is not written."""

from __future__ import annotations

import math
import tempfile
import tomllib
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest
from hypothesis import given, settings, strategies as st
from hypothesis.extra import numpy as hnp

from meso_robust.errors import InputError
from meso_robust.recordings import (
    Polygon,
    Recording,
    RecordingSet,
    Rectangle,
    SensorInfo,
    from_simulation,
    read_set,
    write_set,
)

Floats = npt.NDArray[np.float64]

UM = 1e-6
REPEATABLE = settings(derandomize=True, deadline=None, database=None, max_examples=100)
NAMES = ("probe1", "Left_2", "x", "part_x", "a" * 64)


def arrays(shape: tuple[int, ...], largest: float) -> st.SearchStrategy[Floats]:
    """Values with NaN and negative zeros among them."""
    numbers = st.one_of(
        st.floats(-largest, largest), st.sampled_from([math.nan, -0.0, -1e-20, 1e-7])
    )
    return hnp.arrays(np.float64, shape, elements=numbers)


@st.composite
def recordings(draw: st.DrawFn, file: str, directed: bool) -> Recording:
    names = tuple(draw(st.lists(st.sampled_from(NAMES), unique=True, max_size=3)))
    times = draw(st.lists(st.floats(-1e9, 1e9), unique=True, min_size=1, max_size=6))
    rows = len(times)
    poses = draw(arrays((rows, 3), 1e-2))
    poses[:, 2] *= 1e3  # a few turns
    forces = bool(names) and draw(st.booleans())
    angles = st.lists(st.floats(-7.0, 7.0), min_size=len(names), max_size=len(names))
    return Recording(
        file=file,
        probe_names=names,
        times=np.sort(times),
        poses=poses,
        probes=draw(arrays((rows, len(names), 2), 1e-2)),
        forces=draw(arrays((rows, len(names), 2), 1e-3)) if forces else None,
        tip_directions=tuple(draw(angles)) if directed else None,
    )


@st.composite
def sets(draw: st.DrawFn) -> RecordingSet:
    files = draw(
        st.lists(
            st.sampled_from(["a.csv", "µ ä.csv", "b'#,=.csv", "𝛼.x.csv"]), min_size=1, unique=True
        )
    )
    sides = sorted(draw(st.tuples(st.floats(1.0, 1e6), st.floats(1.0, 1e6))))
    stars = draw(st.lists(st.floats(5.0, 900.0), min_size=3, max_size=12))
    turn = 2 * np.pi * np.arange(len(stars)) / len(stars)
    star = np.array([stars * np.cos(turn), stars * np.sin(turn)]).T * UM
    part = (
        Rectangle(length=sides[1] * UM, width=sides[0] * UM)
        if draw(st.booleans())
        else Polygon(corners=star)
    )
    sigma = st.none() | st.floats(0.0, 0.1)
    offset = draw(st.none() | st.floats(0.0, 1e-3))
    across = None if offset is None else draw(st.none() | st.floats(0.0, 1e-3))
    return RecordingSet(
        part=part,
        tip_radius=draw(st.floats(0.0, 1e-3)),
        position_source=draw(st.sampled_from(["controller", "camera"])),
        sensor=SensorInfo(
            frame_rate=draw(st.floats(1e-3, 1e6)),
            position_sigma=draw(st.none() | st.floats(0.0, 1e-3)),
            orientation_sigma=draw(sigma),
            tip_sigma=draw(st.none() | st.floats(0.0, 1e-3)),
            tip_offset=offset,
            tip_offset_across=across,
        ),
        recordings=tuple(
            draw(recordings(file, across is not None or draw(st.booleans()))) for file in files
        ),
    )


def same(a: float | None, b: float | None) -> bool:
    return a is b is None or (a is not None and b is not None and math.isclose(a, b, rel_tol=1e-11))


@REPEATABLE
@given(sets())
def test_a_set_comes_back_within_the_digits_of_the_format(written: RecordingSet) -> None:
    with tempfile.TemporaryDirectory() as name:
        write_set(Path(name), written)
        found = read_set(Path(name))
    assert type(found.part) is type(written.part)
    np.testing.assert_allclose(found.part.outline, written.part.outline, rtol=1e-11, atol=0)
    assert same(found.tip_radius, written.tip_radius)
    assert found.position_source == written.position_source
    assert found.sensor.frame_rate == written.sensor.frame_rate
    assert same(found.sensor.position_sigma, written.sensor.position_sigma)
    assert same(found.sensor.orientation_sigma, written.sensor.orientation_sigma)
    assert same(found.sensor.tip_sigma, written.sensor.tip_sigma)
    assert same(found.sensor.tip_offset, written.sensor.tip_offset)
    assert same(found.sensor.tip_offset_across, written.sensor.tip_offset_across)
    assert len(found.recordings) == len(written.recordings)
    for back, one in zip(found.recordings, written.recordings, strict=True):
        assert (back.file, back.probe_names) == (one.file, one.probe_names)
        assert np.array_equal(back.times, one.times)
        assert (back.tip_directions is None) == (one.tip_directions is None)
        np.testing.assert_allclose(back.tip_directions or (), one.tip_directions or (), rtol=1e-11)
        um, deg = 1e-4 * UM, math.radians(1e-5)
        np.testing.assert_allclose(back.poses[:, :2], one.poses[:, :2], rtol=0, atol=um)
        np.testing.assert_allclose(back.poses[:, 2], one.poses[:, 2], rtol=0, atol=deg)
        np.testing.assert_allclose(back.probes, one.probes, rtol=0, atol=um)
        assert (back.forces is None) == (one.forces is None)
        if one.forces is not None and back.forces is not None:
            np.testing.assert_allclose(back.forces, one.forces, rtol=0, atol=1e-12)


def example(**changes: object) -> RecordingSet:
    """Two runs of two instants with one probe."""
    given = {
        "part": Rectangle(length=1616e-6, width=837e-6),
        "tip_radius": 12.5e-6,
        "position_source": "controller",
        "sensor": SensorInfo(frame_rate=30.0, position_sigma=1.2e-6),
        **changes,
    }
    poses = np.array([[[1e-6, -2e-6, math.pi / 2], [-1e-14, -4e-6, math.nan]]] * 2)
    probes = np.array([[[[5e-6, -6e-6]], [[math.nan, 7.0000004e-6]]]] * 2)
    times = np.array([0.0, 1.0 / 3.0])
    return from_simulation(times, poses, probes, **given)  # type: ignore[arg-type]


def test_the_text_of_the_files(tmp_path: Path) -> None:
    write_set(tmp_path / "new" / "folder", example())
    folder = tmp_path / "new" / "folder"
    assert sorted(path.name for path in folder.iterdir()) == [
        "push_00.csv",
        "push_01.csv",
        "set.toml",
    ]
    assert (folder / "push_01.csv").read_text() == (
        "time_s,part_x_um,part_y_um,part_theta_deg,probe1_x_um,probe1_y_um\n"
        "0.0,1.000000,-2.000000,90.000000,5.000000,-6.000000\n"
        "0.3333333333333333,0.000000,-4.000000,,,7.000000\n"
    )
    assert tomllib.loads((folder / "set.toml").read_text()) == {
        "schema": "meso-robust/recordings/1",
        "part": {"length_um": 1616.0, "width_um": 837.0},
        "probe": {"tip_radius_um": 12.5, "position_source": "controller"},
        "sensor": {"position_sigma_um": 1.2, "frame_rate_hz": 30.0},
        "recording": [
            {"file": "push_00.csv", "probes": ["probe1"]},
            {"file": "push_01.csv", "probes": ["probe1"]},
        ],
    }


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        (
            {"part": Rectangle(length=1616.0, width=837.0)},
            "key part.length_um = 1616000000.0: must",
        ),
        ({"tip_radius": 12.5}, "key probe.tip_radius_um = 12500000.0: must be less than"),
    ],
)
def test_what_could_not_be_read_is_not_written(
    tmp_path: Path, changes: dict[str, object], message: str
) -> None:
    with pytest.raises(InputError, match=f"set.toml: {message}"):
        write_set(tmp_path, example(**changes))
    assert not list(tmp_path.iterdir())


def test_a_folder_that_is_a_file_is_refused(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match="is not a writable folder"):
        write_set(tmp_path / "file", example())
