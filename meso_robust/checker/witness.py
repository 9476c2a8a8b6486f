"""The run of a REFUTED certificate must keep within the bounds of the task.

``witness.more`` holds what has no key of its own: ``<tip> radius_m``, ``edge <number> turned_rad``,
``move <number> friction <leg> <tip>`` and so on, by the names of :data:`BOUNDS`.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping

from flint import arb

from meso_robust.checker.document import Certificate, WitnessDocument
from meso_robust.checker.ids import place
from meso_robust.checker.inputs import Given
from meso_robust.checker.numbers import double
from meso_robust.checker.ranges import Side
from meso_robust.checker.refusal import Refused
from meso_robust.checker.run import TIPS

ROUNDING = arb(4e-15)
"""m, rad and m^2: bounds of the task are decimals, the numbers of a run doubles close to them. Of an
orientation up to a whole turn, start and sensing error are four roundings of at most 1e-15 away."""
_WHICH = f"(?:{'|'.join(TIPS)})"
_MOVE = "move ([1-9][0-9]{0,3})"
BOUNDS: Mapping[str, Callable[[Given], Side]] = {
    "tip_spacing_m": lambda given: given.spacing,
    "(?:dtp_top|dtp_bottom) radius_m": lambda given: given.radius,
    "stp radius_m": lambda given: given.passive_radius,
    "edge [1-9][0-9]{0,3} out_m": lambda given: given.size,
    "edge [1-9][0-9]{0,3} turned_rad": lambda given: given.squareness,
    "drag_centre [xy]_m": lambda given: given.drag_centre,
    "drag_anisotropy (?:along|across)": lambda given: given.anisotropy,
    "drag_anisotropy of_stage": lambda given: (arb(0), arb(1)),
    f"{_MOVE} direction_rad": lambda given: given.direction,
    f"{_MOVE} scale": lambda given: given.scale,
    f"{_MOVE} wander [0-9]{{1,3}} [xy]_m": lambda given: given.wander,
    f"{_MOVE} friction [1-9][0-9]{{0,2}} {_WHICH}": lambda given: given.friction,
}
"""What a number of ``witness.more`` must lie within, by its name."""


def check_witness(certificate: Certificate, given: Given) -> WitnessDocument:
    """The run of a certificate, every number of it proved to lie within its bounds.

    Raises
    ------
    Refused
        One does not, or there are not as many as moves.
    """
    witness, moves = certificate.witness, len(certificate.policy)
    if witness is None:
        raise Refused(place("witness"), "null", "a run")
    for name in ("sensing", "dual_probe", "single_probe"):
        count = len(getattr(witness, name))
        if count != moves:
            raise Refused(place(f"witness.{name}"), count, moves)
    for name, text, bounds in _bounded(witness, given):
        told = arb(double(text, place(f"witness.{name}")))
        if not (bounds[0] - ROUNDING <= told and told <= bounds[1] + ROUNDING):
            inside = f"within {float(bounds[0]):.9g} and {float(bounds[1]):.9g}"
            raise Refused(place(f"witness.{name}"), float(told), inside)
    _first_sensing(witness, given)
    return witness


def _bounded(witness: WitnessDocument, given: Given) -> Iterator[tuple[str, str, Side]]:
    start = given.start
    yield from zip(("start.x", "start.y", "start.theta"), witness.start, (start.x, start.y, start.theta), strict=True)  # fmt: skip
    yield "friction", witness.friction, given.friction
    yield "film_ratio_m2", witness.film_ratio_m2, given.film_ratio
    yield "misalignment_rad", witness.misalignment_rad, given.misalignment
    for k, (x, y, theta) in enumerate(witness.sensing):
        yield f"sensing.{k}.x", x, given.sensed
        yield f"sensing.{k}.y", y, given.sensed
        yield f"sensing.{k}.theta", theta, given.turned
    for name in ("dual_probe", "single_probe"):
        for k, (x, y) in enumerate(getattr(witness, name)):
            yield f"{name}.{k}.x", x, given.probe
            yield f"{name}.{k}.y", y, given.probe
    for name, text in witness.more.items():
        yield f"more.{name}", text, _bounds(name, len(witness.sensing), given)


def _bounds(name: str, moves: int, given: Given) -> Side:
    for pattern, bounds in BOUNDS.items():
        found = re.fullmatch(pattern, name)
        if found and all(int(number) <= moves for number in found.groups()):
            return bounds(given)
    raise Refused(place(f"witness.more.{name}"), name, "a quantity of a run")


def _first_sensing(witness: WitnessDocument, given: Given) -> None:
    """The first pose is sensed as the task states it: its error follows from the start."""
    sides = (given.start.x, given.start.y, given.start.theta)
    for true, error, range_ in zip(witness.start, witness.sensing[0], sides, strict=True):
        sensed = arb(double(true, place("witness.start"))) + arb(
            double(error, place("witness.sensing.0"))
        )
        stated = (range_[0] + range_[1]) / 2
        if not abs(sensed - stated) <= ROUNDING:
            raise Refused(place("witness.sensing.0"), error, stated)
