"""The format as printed, and every refusal with its message."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from meso_robust.errors import InputError
from meso_robust.recordings import Polygon, Rectangle, SetDocument, read_set, write_set
from tests.recordings.examples import SET, TABLE, folder_of, replaced
from tests.recordings.planted import MIDDLE, clean

RECTANGLE = """\
length_um = 1616.0          # along the part's x axis (the long axis) at theta = 0
width_um = 837.0
"""


def test_the_example_of_the_format_is_read_as_it_stands(tmp_path: Path) -> None:
    found = read_set(folder_of(tmp_path))
    assert isinstance(found.part, Rectangle)
    assert found.part.length == pytest.approx(1.616e-3, rel=1e-15)
    assert found.part.width == pytest.approx(0.837e-3, rel=1e-15)
    assert found.tip_radius == pytest.approx(12.5e-6, rel=1e-15)
    assert found.position_source == "controller"
    assert found.sensor.frame_rate == 30.0
    assert found.sensor.position_sigma == pytest.approx(1.2e-6, rel=1e-15)
    assert found.sensor.orientation_sigma == pytest.approx(math.radians(0.08), rel=1e-15)
    (recording,) = found.recordings
    assert recording.file == "push_00.csv"
    assert recording.probe_names == ("probe1",)
    assert recording.times.tolist() == [0.0, 0.1, 0.2]
    nan = math.nan
    np.testing.assert_allclose(
        recording.poses,
        [
            [100.5e-6, -20.25e-6, math.radians(179.5)],
            [nan, nan, nan],
            [101.5e-6, -20e-6, math.radians(-179.5)],  # wrapped, as in the file
        ],
        rtol=1e-15,
    )
    np.testing.assert_allclose(
        recording.probes[:, 0],
        [[-300e-6, 0.125e-6], [-298e-6, 0.125e-6], [-296e-6, nan]],
        rtol=1e-15,
    )
    assert recording.forces is None


def test_a_polygon_absent_sigmas_and_no_probes(tmp_path: Path) -> None:
    toml = replaced(SET, RECTANGLE, "polygon_um = [[-10, -10], [20.5, -10], [0, 30]]\n")
    toml = re.sub(r"(position|orientation)_sigma.*\n", "", toml)
    toml = replaced(toml, '["probe1"]', "[]")
    table = "time_s,part_x_um,part_y_um,part_theta_deg\n1,2,3,4\n"
    found = read_set(folder_of(tmp_path, toml, table))
    assert isinstance(found.part, Polygon)
    corners = np.array([[-10, -10], [20.5, -10], [0, 30]]) * 1e-6
    np.testing.assert_allclose(found.part.corners, corners, rtol=1e-15)
    assert found.sensor.position_sigma is None
    assert found.sensor.orientation_sigma is None
    assert found.recordings[0].probes.shape == (1, 0, 2)


def test_forces_may_be_there_for_some_probes(tmp_path: Path) -> None:
    toml = replaced(SET, '["probe1"]', '["left", "right"]')
    table = (
        "time_s,part_x_um,part_y_um,part_theta_deg,left_x_um,left_y_um,right_x_um,right_y_um,"
        "right_fx_un,right_fy_un\n"
        "0,0,0,0,1,2,3,4,5,6\n1,0,0,0,1,2,3,4,,-7\n"
    )
    (recording,) = read_set(folder_of(tmp_path, toml, table)).recordings
    assert recording.forces is not None
    nan = math.nan
    expected = [[[nan, nan], [5e-6, 6e-6]], [[nan, nan], [nan, -7e-6]]]
    np.testing.assert_allclose(recording.forces, expected, rtol=1e-15)
    np.testing.assert_allclose(recording.probes[0], [[1e-6, 2e-6], [3e-6, 4e-6]], rtol=1e-15)


def test_columns_count_by_name_and_spreadsheets_may_leave_their_marks(tmp_path: Path) -> None:
    table = (
        "\ufeffpart_theta_deg,part_y_um,part_x_um,probe1_y_um,time_s,probe1_x_um\r\n"
        '90,2,"1",4,0.5,3\r\n180,2e0,+1.,4,.75,3\r\n\r\n'
    )
    (recording,) = read_set(folder_of(tmp_path, table=table)).recordings
    assert recording.times.tolist() == [0.5, 0.75]
    expected = [[1e-6, 2e-6, math.pi / 2], [1e-6, 2e-6, math.pi]]
    np.testing.assert_allclose(recording.poses, expected, rtol=1e-15)
    np.testing.assert_allclose(recording.probes[:, 0], [[3e-6, 4e-6]] * 2, rtol=1e-15)


# what stands in set.toml, what is put there, and what the message says after the name of the file
WRONG_SETS = [
    ('schema = "meso-robust/recordings/1"\n', "", "key schema is missing; `meso-robust schema rec"),
    ("recordings/1", "recordings/2", "key schema = 'meso-robust/recordings/2': "),
    ("[sensor]\n", "[camera]\n", "key sensor is missing"),
    ("width_um = 837.0\n", "", "key part: no outline; give length_um and width_um, or polygon_um"),
    ("width_um = 837.0\n", "width_um = 1700\n", "key part: width_um = 1700.0 exceeds length_um"),
    ("width_um = 837.0\n", 'width_um = "837"\n', "key part.width_um = '837': must be a v"),
    ("width_um = 837.0\n", "width_um = 0.5\n", "key part.width_um = 0.5: must be greater"),
    ("width_um = 837.0\n", "width_um = true\n", "key part.width_um = True: must be a val"),
    (
        "width_um = 837.0\n",
        "depth_um = 837.0\n",
        "key part.depth_um is unknown; did you mean 'width_um'?",
    ),
    (
        "width_um = 837.0\n",
        "polygon_um = [[0, 0], [1, 0], [0, 1]]\n",
        "key part: length_um or width_um beside polygon_um; give one outline only",
    ),
    (RECTANGLE, "polygon_um = [[0, 0], [9, 0]]\n", "key part: polygon_um: 2 corners; must be at"),
    (RECTANGLE, "polygon_um = []\n", "key part: polygon_um: 0 corners; must be at least 3; give"),
    (
        RECTANGLE,
        "polygon_um = [[0, 0], [0, 9], [9, 0]]\n",
        "key part: polygon_um: the corners run clockwise; must run counter-clockwise; reverse",
    ),
    (RECTANGLE, "polygon_um = [[0, 0], [9], [0, 9]]\n", "key part.polygon_um[1][1] is missing"),
    (
        RECTANGLE,
        "polygon_um = [[0, 0], [1e-323, 0], [0, 9]]\n",
        "key part.polygon_um, in metres: corners: corners 0 and 1 coincide",
    ),
    (
        "= 12.5\n",
        "= -1\n",
        "key probe.tip_radius_um = -1: must be greater than or equal to",
    ),
    ("= 12.5\n", "= nan\n", "key probe.tip_radius_um = nan: must be a finite number"),
    (
        'position_source = "controller"',
        'position_source = "guess"',
        "key probe.position_source = 'guess': must be 'controller' or 'camera'",
    ),
    ("frame_rate_hz = 30.0\n", "", "key sensor.frame_rate_hz is missing"),
    ("frame_rate_hz = 30.0", "frame_rate_hz = 0", "key sensor.frame_rate_hz = 0: must be"),
    ("= 0.08", "= inf", "key sensor.orientation_sigma_deg = inf: must be a finite number"),
    ("position_sigma_um = 1.2", "position_sigma_um = -1", "key sensor.position_sigma_um = -1: "),
    ('"push_00.csv"', '"../a.csv"', "key recording[0].file: '../a.csv'; must be the plain name of"),
    ('"push_00.csv"', '"/etc/a.csv"', "key recording[0].file: '/etc/a.csv'; must be the plain nam"),
    ('"push_00.csv"', '"c:\\\\a.csv"', r"key recording[0].file: 'c:\\a.csv'; must be the plain"),
    ('"push_00.csv"', '"a\\n.csv"', r"key recording[0].file: 'a\n.csv'; must be the plain name"),
    ('"push_00.csv"', '"set.toml"', "key recording[0].file: 'set.toml'; must be the plain name"),
    ('"push_00.csv"', '".csv"', "key recording[0].file: '.csv'; must be the plain name of a file"),
    ('["probe1"]', '["part"]', "key recording[0].probes[0]: 'part'; must be a letter, then lett"),
    ('["probe1"]', '["a b"]', "key recording[0].probes[0]: 'a b'; must be a letter, then letter"),
    ('["probe1"]', '["a", "A"]', "key recording[0]: 'A' appears twice; names must differ"),
    ('["probe1"]', '"probe1"', "key recording[0].probes = 'probe1': must be a valid arra"),
    (
        'probes = ["probe1"]\n',
        'probes = []\n[[recording]]\nfile = "PUSH_00.csv"\nprobes = []\n',
        "key set: recording: file 'PUSH_00.csv' appears twice; names must differ, not only in case",
    ),
    (
        '["probe1"]\n',
        '["probe1"]\ntip_directions_deg = [1, 2]\n',
        "key recording[0]: tip_directions_deg: 2 values; must be 1, one of each probe",
    ),
    (
        "= 0.08\n",
        "= 0.08\ntip_offset_um = 2\ntip_offset_across_um = 1\n",
        "key set: sensor.tip_offset_across_um: needs tip_directions_deg of every recording; push_00.csv",
    ),
    (
        "= 0.08\n",
        "= 0.08\ntip_offset_across_um = 1\n",
        "key set: sensor.tip_offset_across_um: needs tip_offset_um, along the needle",
    ),
    (
        '[[recording]]\nfile = "push_00.csv"\nprobes = ["probe1"]\n',
        "",
        "key recording is missing",
    ),
    ("= 12.5\n", "= 1979-05-27\n", "has a date, a time, NaN or infinity (Object of type date"),
    ("= 12.5\n", f"= {'9' * 5000}\n", "is not a TOML file in UTF-8 (Exceeds the limit"),
    ("= 12.5\n", f"= 0x{'f' * 5000}\n", "has a date, a time, NaN or infinity (Exceeds the li"),
    ("= 12.5\n", "= 12,5\n", "is not a TOML file in UTF-8 ("),
    ("= 12.5\n", f"= '{'x' * 500}'\n", f"key probe.tip_radius_um = '{'x' * 59}…: must"),
]


@pytest.mark.parametrize(("old", "new", "message"), WRONG_SETS)
def test_a_wrong_set_file_is_refused(tmp_path: Path, old: str, new: str, message: str) -> None:
    folder_of(tmp_path, replaced(SET, old, new))
    with pytest.raises(InputError) as error:
        read_set(tmp_path)
    assert str(error.value).startswith(f"{tmp_path / 'set.toml'}: {message}")


def test_an_empty_list_of_recordings_is_refused(tmp_path: Path) -> None:
    toml = replaced(SET, '[[recording]]\nfile = "push_00.csv"\nprobes = ["probe1"]\n', "")
    folder_of(tmp_path, "recording = []\n" + toml)
    with pytest.raises(InputError, match=r"set.toml: key recording = \[\]: Tuple should have at l"):
        read_set(tmp_path)


# what stands in the table, what is put there, and what the message says after the name of the file
WRONG_TABLES = [
    (TABLE, "", ": column 'time_s' is missing; add it, empty where not seen"),
    ("part_theta_deg", "part_theta_rad", ": column 'part_theta_rad' is unknown; must be one of t"),
    (",probe1_y_um", ",probe1_x_um", ": duplicate column 'probe1_x_um'; leave one out"),
    ("probe1_y_um\n", "probe2_y_um\n", ": column 'probe2_y_um' is unknown; must be one of time_s"),
    ("probe1_y_um\n", "probe1_fy_un\n", ": column 'probe1_y_um' is missing; add it, empty where"),
    ("time_s,", " time_s,", ": column ' time_s' is unknown; must be one of time_s, part_x_um, "),
    (TABLE, TABLE.splitlines()[0], ": no rows; must have at least one; leave the recording out"),
    ("-296,\n", "-296\n", ", line 4: 5 cells; must be 6 as in the header; leave a cell empty"),
    ("-296,\n", "-296,,\n", ", line 4: 7 cells; must be 6 as in the header; leave a cell empty"),
    ("0.1,,,,", "\n0.1,,,,", ", line 3: 0 cells; must be 6 as in the header; leave a cell empty"),
    ("0.2,", "nan,", ", line 4, column time_s = 'nan': must be a finite number; correct the cell"),
    ("0.2,", ",", ", line 4, column time_s = '': must be a finite number; correct the cell"),
    (
        "0.2,",
        "0.1,",
        ", line 4, column time_s = 0.1 s; must be after the instant of the row before",
    ),
    (
        "0.2,",
        "0.05,",
        ", line 4, column time_s = 0.05 s; must be after the instant of the row befo",
    ),
    ("101.5", "nan", ", line 4, column part_x_um = 'nan': must be a finite number, or empty where"),
    ("101.5", "inf", ", line 4, column part_x_um = 'inf': must be a finite number, or empty where"),
    ("101.5", "1e999", ", line 4, column part_x_um = '1e999': must be a finite number, or empty"),
    ("101.5", "1_0", ", line 4, column part_x_um = '1_0': must be a finite number, or empty wher"),
    ("101.5", "١", ", line 4, column part_x_um = '١': must be a finite number, or empty where not"),
    ("101.5", " 1", ", line 4, column part_x_um = ' 1': must be a finite number, or empty where n"),
    (
        "101.5",
        "2e15",
        ", line 4, column part_x_um = '2e15': must be at most 1e+15 in size; correct the",
    ),
    (
        "0.2,",
        "1e300,",
        ", line 4, column time_s = '1e300': must be at most 1e+15 in size; correct the",
    ),
    ("101.5", '"1"2', ": is not a CSV file in UTF-8 ("),
    ("101.5", '"1', ": is not a CSV file in UTF-8 (unexpected end of data)"),
]


@pytest.mark.parametrize(("old", "new", "message"), WRONG_TABLES)
def test_a_wrong_table_is_refused(tmp_path: Path, old: str, new: str, message: str) -> None:
    folder_of(tmp_path, table=replaced(TABLE, old, new))
    with pytest.raises(InputError) as error:
        read_set(tmp_path)
    assert str(error.value).startswith(f"{tmp_path / 'push_00.csv'}{message}")


def test_half_a_force_is_refused(tmp_path: Path) -> None:
    table = "\n".join(f"{line},0" for line in TABLE.splitlines())
    folder_of(tmp_path, table=replaced(table, "probe1_y_um,0", "probe1_y_um,probe1_fy_un"))
    with pytest.raises(InputError, match=r"push_00.csv: column 'probe1_fx_un' is missing; add it"):
        read_set(tmp_path)


def test_files_that_are_not_there_or_no_text_are_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"set.toml: cannot be read \(No such file or directory\)"):
        read_set(tmp_path)
    folder_of(tmp_path)
    with pytest.raises(InputError, match=r"set.toml: cannot be read \(Not a directory\)"):
        read_set(tmp_path / "push_00.csv")
    (tmp_path / "push_00.csv").write_bytes(b"\xff\xfe")
    with pytest.raises(InputError, match=r"push_00.csv: is not a CSV file in UTF-8 \('utf-8' cod"):
        read_set(tmp_path)
    (tmp_path / "push_00.csv").unlink()
    with pytest.raises(InputError, match=r"push_00.csv: cannot be read \(No such file"):
        read_set(tmp_path)
    (tmp_path / "set.toml").write_bytes(b"\xff\xfe")
    with pytest.raises(InputError, match=r"set.toml: is not a TOML file in UTF-8 \('utf-8' codec"):
        read_set(tmp_path)


def test_the_schema_lists_the_keys_of_the_format() -> None:
    schema = SetDocument.model_json_schema(by_alias=True)
    assert set(schema["properties"]) == {"schema", "part", "probe", "sensor", "recording"}
    assert schema["required"] == ["schema", "part", "probe", "sensor", "recording"]
    sections = {name: set(one["properties"]) for name, one in schema["$defs"].items()}
    assert sections == {
        "PartSection": {"length_um", "width_um", "polygon_um"},
        "ProbeSection": {"tip_radius_um", "position_source"},
        "SensorSection": {
            "position_sigma_um",
            "orientation_sigma_deg",
            "tip_sigma_um",
            "tip_offset_um",
            "tip_offset_across_um",
            "frame_rate_hz",
        },
        "RecordingSection": {"file", "probes", "alike_orientations", "tip_directions_deg"},
    }
    assert json.loads(json.dumps(schema)) == schema


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda text: text.replace(",", ";"), "parted by semicolons"),
        (lambda text: text.replace(",", ";").replace(".", ","), "parted by semicolons"),
        (lambda text: text.replace(",", "\t"), "parted by tabs"),
        (lambda text: _rows(text, lambda row: row.replace(".", ",")), "decimal commas"),
        (lambda text: _rows(text, lambda row: row.replace(",", ";")), "parted by semicolons"),
        (lambda text: _rows(text, _quoted), "decimal commas"),
    ],
)
def test_tables_of_other_countries_get_a_hint(
    tmp_path: Path, change: Callable[[str], str], words: str
) -> None:
    write_set(tmp_path, clean())
    table = tmp_path / MIDDLE
    table.write_text(change(table.read_text()))

    with pytest.raises(InputError, match=words) as error:
        read_set(tmp_path)
    assert str(error.value).startswith(str(table))


def _rows(text: str, change: Callable[[str], str]) -> str:
    header, *rows = text.splitlines()
    return "\n".join([header, *map(change, rows)]) + "\n"


def _quoted(row: str) -> str:
    return ",".join(f'"{cell.replace(".", ",")}"' for cell in row.split(","))
