"""What the film of a task is beside an even one, of the same drag everywhere under the part.

An even film has its centre of drag at the centroid of the outline, and its ratio of rotational to
translational drag is the polar second moment of the area about that centroid over the area: for a
rectangle (l² + w²)/12. A real film may be uneven; but an origin put in the wrong place or a ratio of the
wrong unit is a proof about another part, so both differences are said.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Sequence
from dataclasses import dataclass
from fractions import Fraction

from meso_robust.corners import Corner
from meso_robust.task import PolygonPart, Task

RATIO = "uncertainty.film_ratio_um2"
"""Key of the task."""
_SEEN = 0.05
"""um: an origin nearer to the centroid is at it: corners are written to a tenth."""


@dataclass(frozen=True, slots=True)
class EvenFilm:
    """An even film under an outline.

    Attributes
    ----------
    centre_um
        Its centre of drag, um, in the axes of the corners.
    ratio_um2
        Of its rotational drag about that centre to its translational one.
    largest_um2
        Largest ratio about the origin of any drag that is nowhere negative: all of it at the
        farthest corners.
    """

    centre_um: tuple[float, float]
    ratio_um2: float
    largest_um2: float


def even_film(corners: Sequence[Corner]) -> EvenFilm:
    """The even film under a simple polygon; exact up to the last rounding.

    Parameters
    ----------
    corners
        Counter-clockwise, um.

    Returns
    -------
    EvenFilm
        In the axes of the corners.

    Examples
    --------
    >>> from fractions import Fraction as F
    >>> even_film([(F(0), F(0)), (F(6), F(0)), (F(6), F(2)), (F(0), F(2))])
    EvenFilm(centre_um=(3.0, 1.0), ratio_um2=3.3333333333333335, largest_um2=40.0)
    """
    area = moment_x = moment_y = polar = Fraction(0)
    for (ax, ay), (bx, by) in zip(corners, [*corners[1:], corners[0]], strict=True):
        wedge = ax * by - bx * ay  # twice the area of the triangle with the origin
        area += wedge / 2
        moment_x += wedge * (ax + bx) / 6
        moment_y += wedge * (ay + by) / 6
        polar += wedge * (ax * ax + ax * bx + bx * bx + ay * ay + ay * by + by * by) / 12
    x, y = moment_x / area, moment_y / area
    ratio = polar / area - x * x - y * y
    far = max(a * a + b * b for a, b in corners)
    return EvenFilm((float(x), float(y)), float(ratio), float(far))


def remarks(task: Task, fitted: Collection[str] = ()) -> tuple[str, ...]:
    """What differs from an even film under the part: the origin of a polygon, the ratio of drags.

    Parameters
    ----------
    task
        As it is planned for.
    fitted
        Keys of the task whose values are a fitted model's, not the user's, such as `RATIO`.

    Returns
    -------
    tuple of str
        A line each, with what to do about it.
    """
    even = even_film(corners_of(task))
    said = []
    distance = math.hypot(*even.centre_um)
    if distance >= _SEEN:
        x, y = even.centre_um
        said.append(
            f"part.polygon_um: the origin, which is taken for the centre of drag, lies {distance:.1f} um "
            f"from the centroid of the outline, ({x:.1f}, {y:.1f}) um, where that of an even film is: "
            f"{distance / math.sqrt(even.ratio_um2):.2g} of the outline's radius of gyration, "
            f"{math.sqrt(even.ratio_um2):.1f} um; move the corners if the film is even"
        )
    known = task.uncertainty
    ratio, share = known.film_ratio_um2, known.film_ratio_percent / 100.0
    if not ratio * (1.0 - share) <= even.ratio_um2 <= ratio * (1.0 + share):
        never = (
            f", and more than any drag under this part can have, {even.largest_um2:.6g} um^2"
            if ratio * (1.0 - share) > even.largest_um2
            else ""
        )
        advice = (
            "the value is the fitted model's: compare the outline of the recordings with the part, and "
            "let `meso-robust diagnose` say what the model leaves out"
            if RATIO in fitted
            else "`meso-robust identify` measures it"
        )
        said.append(
            f"{RATIO} = {ratio:.6g} +- {known.film_ratio_percent:g} %: "
            f"{ratio / even.ratio_um2:.3g} x that of an even film under this outline, "
            f"{even.ratio_um2:.6g} um^2{never}{_unit(ratio / even.ratio_um2)}; {advice}"
        )
    return tuple(said)


def _unit(share: float) -> str:
    """The unit in which a ratio would be that of an even film, to a factor of four."""
    units = {"mm^2": 1e-6, "m^2": 1e-12}
    return next(
        (f", as if it were in {name}" for name, of in units.items() if 0.25 < share / of < 4.0), ""
    )


def corners_of(task: Task) -> Sequence[Corner]:
    """Corners of a task's part.

    Parameters
    ----------
    task
        With a rectangle or a polygon.

    Returns
    -------
    sequence of corners
        As stated, counter-clockwise, um.
    """
    part = task.part
    if isinstance(part, PolygonPart):
        return part.corners_um
    x, y = Fraction(repr(part.length_um)) / 2, Fraction(repr(part.width_um)) / 2
    return (x, y), (-x, y), (-x, -y), (x, -y)
