"""The paper's part, and the two ways of lighting it."""

from __future__ import annotations

import dataclasses

import numpy as np

from meso_robust.microscope.looks import Fixture, Metal, Oil, Part, Probe, Scene
from meso_robust.microscope.optics import Optics
from meso_robust.microscope.sensor import Exposure
from meso_robust.types import Floats


def rectangle(length: float = 1616e-6, width: float = 837e-6) -> Floats:
    """(4, 2) corners in m about the centre, counter-clockwise; by default the paper's part."""
    x, y = 0.5 * length, 0.5 * width
    return np.array([[-x, -y], [x, -y], [x, y], [-x, y]])


def reflected(
    outline: Floats | None = None,
    probes: tuple[Probe, ...] = (),
    fixture: Fixture | None = None,
    optics: Optics | None = None,
    exposure: Exposure | None = None,
) -> Scene:
    """Lit from above, as under a stereo microscope: bright metal before a dark background."""
    part = Part(outline=rectangle() if outline is None else outline)
    light = exposure or Exposure(vignetting=0.12, gradient=(0.04, 0.03), jpeg_quality=90)
    return Scene(
        part=part, probes=probes, fixture=fixture, optics=optics or Optics(), exposure=light
    )


def transmitted(
    outline: Floats | None = None,
    probes: tuple[Probe, ...] = (),
    fixture: Fixture | None = None,
    optics: Optics | None = None,
    exposure: Exposure | None = None,
) -> Scene:
    """Lit through the slide, as in an inverted microscope: dark metal before a bright background."""
    shadow = Metal(brightness=0.07, texture=0.08, bevel=8e-6, bevel_brightness=1.6)
    dark = tuple(dataclasses.replace(probe, brightness=0.04, highlight=0.07) for probe in probes)
    plate = fixture and dataclasses.replace(
        fixture, metal=dataclasses.replace(shadow, corner_radius=0.0, seed=2)
    )
    return Scene(
        part=Part(outline=rectangle() if outline is None else outline, metal=shadow),
        probes=dark,
        fixture=plate,
        oil=Oil(brightness=0.8, halo=0.3, ring=0.06, texture=0.03),
        optics=optics or Optics(),
        exposure=exposure or Exposure(vignetting=0.12, gradient=(0.04, 0.03), jpeg_quality=90),
    )
