"""What the part slides on, as a symmetric positive definite drag that may depend on the twist.

Body axes, twist ``v = (v_x, v_y, omega)`` at the reference point, resisting wrench ``D(v)``:

* viscous film, ``D = E v``, E any symmetric positive definite matrix (centred or not);
* ellipsoidal limit surface, ``D = A v / sqrt(v'Av)``: a positive multiple of ``A v``. Forces may be
  scaled without leaving a cone, so its contact modes and twists are those of the film A, as long as
  the part does not rest;
* film and limit surface at once, ``D = E v + s A v / sqrt(v'Av)``, s >= 0 of any size: a positive
  multiple of ``((1 - share) E + share A) v`` with a share in [0, 1). What is proved for every share
  holds for the mixture; it has a solution too, since the share that the twist asks for is a
  continuous function of the share that is assumed and stays in [0, 1).

Rest of the part under dry friction is no twist at all; the proof excludes it by a contact whose
obstacle moves into the part.

Coulomb points (the three-point model) are not covered: the secant drag ``c / |u|`` of a point that
may rest is unbounded, and the force of one that does rest is not along any speed. Such a support is
stated with :func:`not_covered`, and every proof about it is UNKNOWN.

Sources: the paper, Section IX-B; R. D. Howe, M. R. Cutkosky 1996, doi:10.1177/027836499601500603.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

from meso_robust.basis.contact import Quantity
from meso_robust.bounds import Interval

Entries = tuple[Quantity, Quantity, Quantity, Quantity, Quantity, Quantity]
"""xx, xy, xt, yy, yt, tt of a symmetric matrix: upper triangle by rows, t for the rotation."""


@dataclass(frozen=True, slots=True, eq=False)
class Support:
    """Drag ``(1 - share) film + share surface`` over any positive scale.

    Attributes
    ----------
    film
        Entries of E over any scale of force: 1, m, m² for translation, coupling, rotation.
    surface
        Entries of A over any scale; used where the share is not zero.
    share
        Of the limit surface.
    dry
        Whether the part may rest under load.
    missing
        Why the support has no enclosure; empty if it has.
    """

    film: Entries
    surface: Entries | None = None
    share: Quantity = 0.0
    dry: bool = False
    missing: str = ""


def film(*entries: Quantity) -> Support:
    """Viscous film with the six entries of its drag matrix (upper triangle by rows)."""
    xx, xy, xt, yy, yt, tt = entries
    return Support((xx, xy, xt, yy, yt, tt))


def diagonal_film(ratio: Quantity) -> Support:
    """The paper's film diag(1, 1, rho), ``ratio`` = rho in m²."""
    return film(1.0, 0.0, 0.0, 1.0, 0.0, ratio)


def limit_surface(*entries: Quantity) -> Support:
    """Ellipsoidal limit surface with the six entries of A, ``f' inv(A) f = 1``."""
    return replace(film(*entries), dry=True)


def mixture(of_film: Support, of_surface: Support) -> Support:
    """Film and limit surface at once, in any proportion."""
    return Support(of_film.film, of_surface.film, Interval(0.0, 1.0), dry=True)


def not_covered(reason: str) -> Support:
    """A support without enclosure: every proof about it is UNKNOWN, for the given reason."""
    return Support((1.0, 0.0, 0.0, 1.0, 0.0, 1.0), missing=reason)
