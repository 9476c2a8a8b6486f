"""What acts on the part beyond a linear film and Coulomb friction: one number a name, zero if off."""

from __future__ import annotations

from typing import NamedTuple


class Laws(NamedTuple):
    """Physics of the plant; um, s, rad, forces over the film's drag."""

    dry: float = 0.0
    """Coulomb friction under the film."""
    stribeck: float = 0.0
    """More of it at rest, fading with the speed."""
    stribeck_speed: float = 30.0
    breakaway: float = 0.0
    """Coulomb friction that grows as the logarithm of the time at rest."""
    breakaway_distance: float = 2.0
    """Slip after which the contact is renewed."""
    uneven: float = 0.0
    """Coulomb friction with a pressure that is linear over the footprint."""
    uneven_x: float = 0.0
    uneven_y: float = 0.0
    thinning: float = 0.0
    """1 - n of a power law about 75 um/s."""
    gradient_x: float = 0.0
    """Relative growth of the drag with the place, 1/um."""
    gradient_y: float = 0.0
    growth: float = 0.0
    """Relative growth of the drag with time, 1/s."""
    force_x: float = 0.0
    force_y: float = 0.0
    flow_x: float = 0.0
    flow_y: float = 0.0
    wall: float = 0.0
    """Pull of a wall where it stands, along its normal."""
    wall_angle: float = 0.0
    wall_place: float = 0.0
    wall_range: float = 300.0
    adhesion: float = 0.0
    """Pull between a tip that has touched and the part, up to a gap."""
    adhesion_range: float = 2.0
    attraction: float = 0.0
    """Pull between a tip and the part, falling off with the gap."""
    attraction_range: float = 5.0
    edge_change: float = 0.0
    """Relative change of the friction coefficient at one edge."""
    edge: int = 0
    compliance: float = 0.0
    """Displacement of a tip over the force on it, s."""

    @property
    def uniform(self) -> bool:
        """Whether the drag is the same linear one all over the footprint, so that few nodes do."""
        local = (self.dry, self.stribeck, self.breakaway, self.uneven, self.thinning)
        return not any((*local, self.gradient_x, self.gradient_y))
