"""What things look like: the part, the fixture, the probes, the oil film; two ways of lighting them."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass, field

import numpy as np

from meso_robust.microscope.optics import Optics
from meso_robust.microscope.outline import area
from meso_robust.microscope.sensor import Exposure
from meso_robust.types import Floats


@dataclass(frozen=True, slots=True, kw_only=True)
class Metal:
    """Surface of etched sheet metal. Brightness 1 is what the sensor shows as white.

    Attributes
    ----------
    brightness
        Mean brightness of the face.
    texture
        Standard deviation of the texture (rolling lines and grain) relative to the brightness.
    scratches, specks
        Numbers of scratches and of specks (etch pits, stains) on the face.
    bevel
        Width in m of the rim that etching leaves sloping.
    bevel_brightness
        Factor on the brightness where the slope is steepest: below 1 a dark rim, above 1 a bright
        one.
    bevel_relief
        How much brighter a rim that faces the lamp is, and darker one that faces away, relative to
        the brightness.
    corner_radius
        Rounding of convex corners in m.
    seed
        Of texture, scratches and specks, which are fixed in the body frame.
    """

    brightness: float = 0.62
    texture: float = 0.05
    scratches: int = 14
    specks: int = 18
    bevel: float = 15e-6
    bevel_brightness: float = 0.55
    bevel_relief: float = 0.25
    corner_radius: float = 12e-6
    seed: int = 1


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Part:
    """The part.

    Attributes
    ----------
    outline
        (V, 2) corners of a simple polygon in m, body frame, about the reference point; the visible
        edge between metal and background.
    metal
        Its surface.
    """

    outline: Floats
    metal: Metal = Metal()

    def __post_init__(self) -> None:
        """Copy, orient and check the outline."""
        object.__setattr__(self, "outline", _ring("part outline", self.outline))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Fixture:
    """A plate that does not move, with holes if rings lie in each other.

    Attributes
    ----------
    rings
        Polygons (V, 2) in m, world frame; metal is where a point is inside an odd number of them.
    metal
        Its surface.
    """

    rings: tuple[Floats, ...]
    metal: Metal = Metal(brightness=0.55, corner_radius=0.0, seed=2)

    def __post_init__(self) -> None:
        """Copy and check the rings."""
        rings = tuple(_ring(f"fixture ring {i}", ring) for i, ring in enumerate(self.rings))
        object.__setattr__(self, "rings", rings)


@dataclass(frozen=True, slots=True, kw_only=True)
class Probe:
    """A needle whose round tip lies in the plane and whose shaft rises out of it.

    Attributes
    ----------
    tip_radius
        m.
    direction
        Angle in rad, world frame, in which the shaft runs away from the tip.
    half_angle
        Taper in rad: angle between axis and flank.
    shaft_radius
        m; where the taper ends.
    defocus
        Blur (standard deviation) gained a length of shaft.
    brightness, highlight
        Of the metal at the flanks and of the bright line along its middle.
    """

    tip_radius: float = 12.5e-6
    direction: float = 0.0
    half_angle: float = 0.09
    shaft_radius: float = 125e-6
    defocus: float = 0.03
    brightness: float = 0.12
    highlight: float = 0.3


@dataclass(frozen=True, slots=True, kw_only=True)
class Oil:
    """The oil film and what lies under it.

    Attributes
    ----------
    brightness
        Of the background.
    halo, halo_width
        The meniscus darkens the background at the edge of part and tips by this fraction, fading
        over this length in m.
    ring
        Fraction by which a band further out is brighter, where the meniscus focuses the light.
    texture, texture_length
        Standard deviation relative to the brightness, and correlation length in m, of slow shading.
    grain
        Standard deviation, relative, of shading from pixel to pixel.
    dust
        Number of dust particles in the field of view.
    seed
        Of texture, grain and dust.
    """

    brightness: float = 0.3
    halo: float = 0.25
    halo_width: float = 12e-6
    ring: float = 0.08
    texture: float = 0.06
    texture_length: float = 250e-6
    grain: float = 0.01
    dust: int = 25
    seed: int = 3


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Scene:
    """Everything but the poses. Two scenes are never equal: what is drawn ahead is kept a scene.

    Attributes
    ----------
    part
        The part, or None.
    probes
        One for each tip.
    fixture
        The fixture, or None.
    oil
        Film and background.
    optics, exposure
        The camera and the light.
    """

    part: Part | None
    probes: tuple[Probe, ...] = ()
    fixture: Fixture | None = None
    oil: Oil = Oil()
    optics: Optics = field(default_factory=Optics)
    exposure: Exposure = field(default_factory=Exposure)


def _ring(name: str, corners: Floats) -> Floats:
    ring = np.array(corners, dtype=np.float64)
    if ring.ndim != 2 or ring.shape[0] < 3 or ring.shape[1] != 2 or not np.isfinite(ring).all():
        raise ValueError(f"{name}: shape {ring.shape}; must be finite corners (V >= 3, 2) in m")
    if area(ring) == 0.0:
        raise ValueError(f"{name}: has no area; give the corners in order")
    ring = ring if area(ring) > 0.0 else ring[::-1].copy()
    ring.flags.writeable = False
    return ring


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
