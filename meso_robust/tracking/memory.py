"""What a tracker has learned of a part: how its edges, its face and the light upon it look."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from meso_robust.tracking.covariance import LAMP_SIGMA, lamp_covariance, systematic
from meso_robust.tracking.edge_pattern import Pattern, single_step
from meso_robust.tracking.edges import EdgeFit, Lens, Outline, learned_pattern, rotation
from meso_robust.tracking.rim import LampFit, lamp_displacement
from meso_robust.tracking.sampling import Patch
from meso_robust.tracking.ssd import Appearance, Template, added, blank, template
from meso_robust.types import Floats, Image as Bytes

LEARNING = 12
"""Frames that the appearance is learned from; after that it is kept, so that it cannot drift."""
LAMP_FRAMES = 4
"""Frames in which the displacement by oblique light is measured."""
_MEDIAN = 1.2  # variance of a median of few over that of their mean
_REBUILT = 4  # frames between two templates while learning


@dataclass(frozen=True, eq=False)  # no slots: what each frame asks for is worked out once
class Memory:
    """What was learned so far.

    Attributes
    ----------
    pattern
        How the outline looks across (:func:`edges.learned_pattern`).
    appearance, template
        Of the face, and what is compared (None: not enough seen or nothing to see).
    frames
        How many frames were learned from.
    lamps
        Displacement by oblique light in each frame where it could be measured.
    lit
        (2 S, 2) displacement by a px of each side's modes in the first of them; None: in none.
    edge_covariance
        (3, 3) of one learned pose.
    """

    pattern: Pattern
    appearance: Appearance
    template: Template | None
    frames: int
    lamps: tuple[LampFit, ...]
    lit: Floats | None
    edge_covariance: Floats

    @property
    def lamp(self) -> Floats:
        """(2,) px to be taken off a pose from edges."""
        return self._lamp[0]

    @property
    def lamp_covariance(self) -> Floats:
        """(3, 3) of what is left after that; the model errs alike in every frame."""
        return self._lamp[1]

    @cached_property
    def _lamp(self) -> tuple[Floats, Floats]:
        if not self.lamps:
            return np.zeros(2), LAMP_SIGMA**2 * np.diag([1.0, 1.0, 0.0])
        seen = np.array([fit.displacement for fit in self.lamps])
        mean = np.mean([fit.covariance for fit in self.lamps], axis=0)
        share = _averaged(seen, mean)
        return np.median(seen, axis=0), lamp_covariance(share * mean + self.lamps[0].doubt)

    @property
    def anchor_covariance(self) -> Floats:
        """(3, 3) of the place that the appearance was learned at."""
        # neighbouring frames share half of their errors
        return self.edge_covariance / max(0.5 * self.frames, 1.0)


def _averaged(seen: Floats, covariance: Floats) -> float:
    """What is left of the covariance (2, 2) of each of some displacements (n, 2) in their median.

    Noise differs from frame to frame, and that share of their variance averages out; what grain, dust and the
    model do is the same in all.
    """
    count = len(seen)
    if count < 2:
        return 1.0
    own = float(np.var(seen, axis=0, ddof=1).sum()) / max(float(np.trace(covariance)), 1e-12)
    return 1.0 - min(own, 1.0) * (1.0 - _MEDIAN / count)


def untaught(corners: Floats) -> Memory:
    """Nothing learned yet of the part with ``corners`` (V, 2) px."""
    return Memory(single_step(), blank(corners), None, 0, (), None, np.zeros((3, 3)))


def with_pattern(of: Memory, piece: Patch, outline: Outline, pose: Floats, lens: Lens) -> Memory:
    """The memory with the edges as they look at a pose (3,)."""
    return replace(of, pattern=learned_pattern(piece, outline, pose, lens))


def with_light(
    of: Memory,
    frame: Bytes,
    mask: Bytes | None,
    outline: Outline,
    edges: EdgeFit,
    lens: Lens,
    sized: bool = False,
) -> Memory:
    """The memory with the displacement by oblique light in one more frame; ``sized`` as of `rim.lamp_displacement`."""
    if len(of.lamps) >= LAMP_FRAMES:
        return of
    near = of.lamps[-1].displacement if of.lamps else None
    lamp = lamp_displacement(frame, mask, outline, edges.pose, lens, near, sized)
    if lamp is None:
        return of
    lit = of.lit
    if lit is None:
        sides = systematic(outline.design, edges.weight, edges.residual, outline.modes)
        lit = sides.displacement(rotation(edges.pose[2]))
    return replace(of, lamps=(*of.lamps, lamp), lit=lit)


def with_face(of: Memory, piece: Patch, pose: Floats, covariance: Floats, lens: Lens) -> Memory:
    """The memory with the face as seen at one more pose (3,) with its covariance (3, 3)."""
    if of.frames >= LEARNING:
        return of
    frames = of.frames + 1
    appearance = added(of.appearance, piece, pose, lens)
    mean = of.edge_covariance + (covariance - of.edge_covariance) / frames
    compared = template(appearance) if frames % _REBUILT == 0 else of.template
    return replace(
        of, appearance=appearance, template=compared, frames=frames, edge_covariance=mean
    )
