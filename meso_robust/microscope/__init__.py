"""A synthetic microscope: what a camera sees of a part that probes push under oil, pose known.

It shares no code with the tracker. World: SI, x right, y up, θ counter-clockwise. Pixels: u right,
v down, the centre of the first one at (0, 0).
"""

from meso_robust.microscope.faults import Faults as Faults, truncate as truncate
from meso_robust.microscope.filming import film as film
from meso_robust.microscope.frame import irradiance as irradiance, render as render
from meso_robust.microscope.looks import (
    Fixture as Fixture,
    Metal as Metal,
    Oil as Oil,
    Part as Part,
    Probe as Probe,
    Scene as Scene,
    rectangle as rectangle,
    reflected as reflected,
    transmitted as transmitted,
)
from meso_robust.microscope.optics import (
    Optics as Optics,
    project as project,
    unproject as unproject,
)
from meso_robust.microscope.sensor import Exposure as Exposure
from meso_robust.microscope.stage_grid import grid_image as grid_image, grid_points as grid_points
