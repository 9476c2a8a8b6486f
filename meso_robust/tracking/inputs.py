"""What the user states of part, camera and start, from files and short texts."""

from __future__ import annotations

import math
import re
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from meso_robust.errors import InputError
from meso_robust.recordings import Polygon, Rectangle
from meso_robust.recordings.document import load_document
from meso_robust.recordings.rules import DEG, UM, probe_fault
from meso_robust.task import PolygonPart, load_task
from meso_robust.tracking.calibration import Calibration
from meso_robust.tracking.calibration_document import load_calibration
from meso_robust.tracking.pixels import Grey, decoded
from meso_robust.tracking.scene import Start
from meso_robust.types import Floats

if TYPE_CHECKING:
    from meso_robust.tracking.grid_fit import GridFit

_PROBE = re.compile(r"([A-Za-z][A-Za-z0-9_]*)=([^,]+),([^,]+)")


def stated_part(
    task: Path | None, set_file: Path | None, length_um: float | None, width_um: float | None
) -> tuple[Rectangle | Polygon, float | None]:
    """The part, and the radius of the tips in m where a set states it.

    Raises
    ------
    InputError
        Not exactly one of task, set and sides is given, or it breaks a rule.
    """
    sides = length_um is not None or width_um is not None
    if (task is not None) + (set_file is not None) + sides != 1:
        raise InputError(
            "the part: give one of --task TASK.toml, --set SET.toml, or --length-um and --width-um"
        )
    if task is not None:
        part = load_task(task).part
        if isinstance(part, PolygonPart):
            return Polygon(corners=np.array(part.polygon_um) * UM), None
        return _rectangle(part.length_um, part.width_um), None
    if set_file is not None:
        document = load_document(set_file)
        radius = document.probe.tip_radius_um * UM
        if document.part.polygon_um is not None:
            return Polygon(corners=np.array(document.part.polygon_um) * UM), radius
        return _rectangle(document.part.length_um, document.part.width_um), radius
    return _rectangle(length_um, width_um), None


def _rectangle(length_um: float | None, width_um: float | None) -> Rectangle:
    if length_um is None or width_um is None:
        raise InputError("--length-um, --width-um: one is missing; give both sides of the part")
    try:
        return Rectangle(length=length_um * UM, width=width_um * UM)
    except ValueError as error:
        raise InputError(f"--length-um {length_um}, --width-um {width_um}: {error}") from error


def stated_camera(
    size: tuple[int, int],
    calibration: Path | None,
    pixel_um: float | None,
    grid: Path | None,
    pitch_um: float | None,
    own_pixel: float | None = None,
) -> tuple[Calibration, GridFit | None]:
    """The calibration for images of a size (width, height), and the fit it is from, if it is.

    Of all ways to state the camera at most one is given; if none is, ``own_pixel`` counts, the side of
    a pixel in m that the videos state themselves.

    Raises
    ------
    InputError
        No way or more than one is given, a file breaks a rule, or it is for another size.
    """
    ways = (calibration is not None) + (pixel_um is not None) + (grid is not None)
    if ways == 0 and pitch_um is None and own_pixel:
        return Calibration(pixel_size=own_pixel, size=size), None
    if ways != 1 or (pitch_um is None) != (grid is None):
        raise InputError(
            "the camera: give one of --calibration FILE, --pixel-um X, or --grid IMAGE with --pitch-um, "
            "or a TIFF stack that states the size of its pixels"
        )
    fit = None
    if calibration is not None:
        found = load_calibration(calibration)
    elif grid is not None and pitch_um is not None:
        from meso_robust.tracking.grid_fit import calibrate  # statistics take a second to import

        image = decoded(grid)
        fit = calibrate(Grey.of(grid, image).eight_bits(grid, image), pitch_um * UM)
        found = fit.calibration
    else:
        if not (pixel_um is not None and 0.0 < pixel_um < math.inf):
            raise InputError(f"--pixel-um {pixel_um}: must be positive; give um per pixel")
        found = Calibration(pixel_size=pixel_um * UM, size=size)
    if found.size != size:
        raise InputError(
            f"{calibration or grid}: is for images of {found.size[0]} x {found.size[1]} px, but the "
            f"video has {size[0]} x {size[1]}; calibrate with the same camera setting"
        )
    return found, fit


def stated_pose(text: str | None) -> Floats | None:
    """Pose (3,) in m and rad from "x_um,y_um,theta_deg"; NaN where a place is empty.

    Raises
    ------
    InputError
        The text is no pose.
    """
    if text is None:
        return None
    cells = text.split(",")
    try:
        values = np.array([float(cell) if cell.strip() else math.nan for cell in cells])
    except ValueError:
        values = np.empty(0)
    good = values.shape == (3,) and math.isfinite(values[2]) and not np.isinf(values).any()
    if not good or np.isnan(values[0]) != np.isnan(values[1]):
        raise InputError(
            f"--start {text!r}: must be x_um,y_um,theta_deg, or ,,theta_deg; correct the pose"
        )
    return values * np.array([UM, UM, DEG])


def stated_probes(texts: tuple[str, ...]) -> tuple[Start, ...] | None:
    """Probes from "NAME=x_um,y_um"; None if there is none.

    Raises
    ------
    InputError
        A text is not a probe, or a name appears twice.
    """
    found: list[Start] = []
    for text in texts:
        match = _PROBE.fullmatch(text.strip())
        try:
            x, y = (float(match[2]), float(match[3])) if match else (math.nan, math.nan)
        except ValueError:
            x = y = math.nan
        if match is None or not (math.isfinite(x) and math.isfinite(y)) or match[1] == "part":
            raise InputError(f"--probe {text!r}: must be NAME=x_um,y_um, such as probe1=820,-40")
        fault = probe_fault(match[1])
        if fault:
            raise InputError(f"--probe {text!r}: {fault}")
        if match[1].lower() in [start.name.lower() for start in found]:
            raise InputError(f"--probe {text!r}: duplicate name; names must differ")
        found.append(Start(name=match[1], tip=(x * UM, y * UM)))
    return tuple(found) or None
