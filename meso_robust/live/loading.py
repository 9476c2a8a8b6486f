"""A laboratory read from its file, with the calibration that the file names."""

from __future__ import annotations

from pathlib import Path

from meso_robust.errors import InputError
from meso_robust.live.calibration_file import CalibrationDocument, load_calibration
from meso_robust.live.lab_file import Lab, parse_lab
from meso_robust.toml_files import read_toml


def load_lab(path: Path) -> Lab:
    """Read ``lab.toml``, with the calibration that it names.

    Parameters
    ----------
    path
        The file.

    Returns
    -------
    Lab
        Checked, with the measured axes, offsets and errors.

    Raises
    ------
    InputError
        A file cannot be read, or a value breaks its rule.
    """
    lab = parse_lab(read_toml(path, "give a lab.toml, or virtual"), str(path))
    if not lab.calibration:
        return lab
    return calibrated(lab, load_calibration(path.parent / lab.calibration))


def calibrated(lab: Lab, measured: CalibrationDocument) -> Lab:
    """A laboratory with what was measured in place of what its file states.

    Parameters
    ----------
    lab, measured
        As read.

    Returns
    -------
    Lab
        With the measured axes, offsets and errors.

    Raises
    ------
    InputError
        A manipulator or a tip was not measured.
    """
    manipulators = []
    for one in lab.manipulators:
        found = measured.manipulators.get(one.name)
        missing = [] if found is None else [t.name for t in one.tips if t.name not in found.tips]
        if found is None or missing:
            what = one.name if found is None else f"{one.name}, tip {missing[0]}"
            raise InputError(f"calibration: has no {what}; run meso-robust calibrate again")
        tips = tuple(
            tip.model_copy(update={"offset_um": found.tips[tip.name].offset_um}) for tip in one.tips
        )
        error = found.tip_error_um + measured.camera_um
        changes = {
            "axes": found.axes,
            "tips": tips,
            "tip_error_um": error,
            "direction_error_deg": found.direction_error_deg,
            "scale_error_percent": found.scale_error_percent,
        }
        manipulators.append(one.model_copy(update=changes))
    return lab.model_copy(update={"manipulators": tuple(manipulators)})
