"""A folder with the example of the format, to be read or spoilt."""

from __future__ import annotations

from pathlib import Path

SET = """\
schema = "meso-robust/recordings/1"
[part]                      # rectangle, or polygon_um = [[x, y], …] counter-clockwise
length_um = 1616.0          # along the part's x axis (the long axis) at theta = 0
width_um = 837.0
[probe]
tip_radius_um = 12.5
position_source = "controller"      # "controller": commanded positions; "camera": seen positions
[sensor]
position_sigma_um = 1.2     # optional; estimated from still frames when absent
orientation_sigma_deg = 0.08
frame_rate_hz = 30.0
[[recording]]
file = "push_00.csv"
probes = ["probe1"]
"""

TABLE = """\
time_s,part_x_um,part_y_um,part_theta_deg,probe1_x_um,probe1_y_um
0.0,100.5,-20.25,179.5,-300,0.125
0.1,,,,-298,0.125
0.2,101.5,-20,-179.5,-296,
"""


def folder_of(path: Path, toml: str = SET, table: str = TABLE) -> Path:
    """Write a set with one recording."""
    (path / "set.toml").write_text(toml, encoding="utf-8")
    (path / "push_00.csv").write_text(table, encoding="utf-8", newline="")
    return path


def replaced(text: str, old: str, new: str) -> str:
    """Text with its one ``old`` replaced."""
    assert text.count(old) == 1, old
    return text.replace(old, new)
