"""``calibrate``: where the tips of a laboratory's manipulators are in the world, and how well that is known."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from meso_robust.api.call import call
from meso_robust.api.inputs import files_of, task_of
from meso_robust.api.options import Seed, StrPath
from meso_robust.api.progress import SILENT, Progress
from meso_robust.api.result import Result
from meso_robust.errors import InputError, NotApplicableError

if TYPE_CHECKING:
    from meso_robust.live.calibration_file import CalibrationDocument

VIRTUAL = "virtual"


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Calibrated(Result):
    """Measured manipulators.

    Attributes
    ----------
    document
        The content of ``calibration.json``.
    """

    document: CalibrationDocument

    @property
    def positive(self) -> bool:
        """Always: what cannot be measured ends it."""
        return True

    @property
    def shown(self) -> dict[str, str]:
        """The calibration."""
        return {"calibration": "calibration.json"}

    def __str__(self) -> str:
        lines = [
            f"CALIBRATED: state probe_position_um = {self.document.probe_position_um:.3g} or more"
        ]
        for name, one in self.document.manipulators.items():
            lines.append(
                f"  {name}: {one.places} places, tips known to {one.tip_error_um:.2f} um "
                f"(scatter {one.scatter_um:.2f} um), travels to {one.direction_error_deg:.3f} deg and "
                f"{one.scale_error_percent:.3f} %"
            )
        return "\n".join(lines)

    def files(self) -> dict[str, str]:
        """The text of ``calibration.json``."""
        return {"calibration.json": self.text()}


@call
def calibrate(*, lab: StrPath = VIRTUAL, seed: Seed = 0, progress: Progress = SILENT) -> Calibrated:
    """Send each manipulator to a grid of places, see its tips there, and fit where they are.

    The laboratory's file names the result by ``calibration = "calibration.json"``; then `run` takes
    it, and refuses a task that states a smaller ``probe_position_um`` than was measured.

    Parameters
    ----------
    lab
        The laboratory (``lab.toml``), its axes and offsets right to about five pixels; or ``virtual``.
    seed
        Seed of the virtual laboratory.
    progress
        Shows what is being done.

    Returns
    -------
    Calibrated
        With its uncertainty.

    Raises
    ------
    InputError
        The file is wrong.
    NotApplicableError
        A tip was not seen, or a manipulator does not obey; everything is lifted.
    """
    from meso_robust.live.backends import devices_of
    from meso_robust.live.calibrating import calibrate as measuring
    from meso_robust.live.devices import DeviceError
    from meso_robust.live.loading import load_lab
    from meso_robust.live.placing import PlacingError
    from meso_robust.tasks import MICROSCOPE

    task = task_of(MICROSCOPE)  # whose part and probes the virtual laboratory has
    if str(lab) == VIRTUAL:
        from meso_robust.live.virtual_bench import uncalibrated_lab

        given, beside = uncalibrated_lab(task, seed), Path()
    else:
        given, beside = load_lab(Path(lab)), Path(lab).parent
        if given.calibration and not (beside / given.calibration).exists():
            raise InputError(
                f"{lab}: calibration = {given.calibration!r}: is not there; leave it out"
            )
    try:
        with progress.following() as told, devices_of(given, task, beside) as devices:
            document = measuring(devices, given, told)
    except (DeviceError, PlacingError) as error:
        raise NotApplicableError(f"not calibrated, the probes are lifted: {error}") from error
    return Calibrated(document=document, inputs=files_of(*([] if lab == VIRTUAL else [lab])))
