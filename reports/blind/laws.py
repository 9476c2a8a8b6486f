"""What acts in the world of the blind benchmark: one number a name, zero where nothing acts.

Units are um, s and rad. Forces are over the film's translational drag and hence speeds, um/s; the
mass over that drag is a time, stiffness a rate.
"""

from __future__ import annotations

from typing import NamedTuple


class Laws(NamedTuple):
    """The physics of one set of recordings; the defaults are a linear film and a rigid tip."""

    mu: float = 0.3
    """Coulomb friction of tip and part."""
    footprint: float = 1.0
    """Side of the wetted footprint over that of the part."""
    mass: float = 2e-4
    """Time in which a free part comes to rest, s."""
    stiffness: float = 1.2e4
    """Of tip against part, 1/s."""
    damping: float = 0.3
    """Of tip against part, over the drag of the film."""

    dry: float = 0.0
    """Coulomb friction under the film."""
    stribeck: float = 0.0
    stribeck_speed: float = 30.0
    ageing: float = 0.0
    ageing_distance: float = 2.0
    uneven: float = 0.0
    """Coulomb friction with a pressure that is linear over the footprint."""
    uneven_x: float = 0.0
    uneven_y: float = 0.0
    thinning: float = 0.0
    """1 − n of a power law about 75 um/s."""
    quadratic: float = 0.0
    """Drag that grows by this fraction at 75 um/s."""
    anisotropy: float = 0.0
    anisotropy_angle: float = 0.0
    part_anisotropy: float = 0.0
    part_anisotropy_angle: float = 0.0
    centre_x: float = 0.0
    """Place of the footprint's centre on the part."""
    centre_y: float = 0.0
    gradient_x: float = 0.0
    """Relative growth of the drag with the place, 1/um."""
    gradient_y: float = 0.0
    growth: float = 0.0
    """Relative growth of the drag with time, 1/s."""
    patch: float = 0.0
    """Coulomb friction within a disc of the stage."""
    patch_x: float = 0.0
    patch_y: float = 0.0
    patch_radius: float = 1.0
    memory: float = 0.0
    """Fraction of the drag that is elastic at first."""
    memory_time: float = 1.0

    force_x: float = 0.0
    force_y: float = 0.0
    flow_x: float = 0.0
    flow_y: float = 0.0
    moment: float = 0.0
    """Couple on the part, um²/s."""
    wall: float = 0.0
    """Pull of a wall where it stands, along its normal."""
    wall_angle: float = 0.0
    wall_place: float = 0.0
    wall_range: float = 300.0
    centre_pull: float = 0.0
    """Attraction to a point, at the distance of 500 um."""
    pull_x: float = 0.0
    pull_y: float = 0.0
    post_radius: float = 0.0
    post_x: float = 0.0
    post_y: float = 0.0

    adhesion: float = 0.0
    adhesion_range: float = 2.0
    attraction: float = 0.0
    attraction_range: float = 5.0
    wear: float = 0.0
    """Fraction of the tip's friction that is lost with time."""
    wear_time: float = 3.0
    load_exponent: float = 0.0
    """Friction coefficient goes as load, over 75 um/s, to this power."""
    edge_change: float = 0.0
    edge: int = 0

    tip_radius: float = 12.5
    compliance: float = 0.0
    """Tip's displacement over the force on it, s."""
    backlash: float = 0.0
    drift_x: float = 0.0
    drift_y: float = 0.0
    runout: float = 0.0
    """Radius of a circle that the tip makes."""
    runout_rate: float = 6.0
    runout_phase: float = 0.0
