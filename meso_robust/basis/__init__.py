"""The basis certificate: contact modes proved over whole boxes, for polygons and contacts at large."""

from meso_robust.basis.contact import (
    FIXTURE as FIXTURE,
    Corner as Corner,
    Mode as Mode,
    Mover as Mover,
    Part as Part,
    Tip as Tip,
    symbol as symbol,
)
from meso_robust.basis.motion import MotionProof as MotionProof, prove_motion as prove_motion
from meso_robust.basis.prove import BasisProof as BasisProof, prove_basis as prove_basis
from meso_robust.basis.support import (
    Support as Support,
    diagonal_film as diagonal_film,
    film as film,
    limit_surface as limit_surface,
    mixture as mixture,
    not_covered as not_covered,
)
