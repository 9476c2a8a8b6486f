"""Numbers, boxes and commands in words: um, deg and a sensible number of digits."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction

from meso_robust import units
from meso_robust.certificates.document import WitnessDocument
from meso_robust.certificates.margin import LARGEST
from meso_robust.planning.document import AimDocument, Pair
from meso_robust.planning.plan_file import ExactBox, HexPair
from meso_robust.wording import down, down_to, up, up_to

MINUS = "−"
_CONVERSION = 4  # units in the last place


@dataclass(frozen=True, slots=True)
class Quantity:
    """How a side of a box is shown."""

    meaning: str
    unit: str
    scale: float
    """SI value of one unit."""


LENGTH, ANGLE = ("µm", units.UM), ("deg", units.DEG)
QUANTITIES = {
    "theta": Quantity("angle of the pushed edge; 90 deg is upright", *ANGLE),
    "theta_0": Quantity("angle of the edge before the tilt", *ANGLE),
    "theta_1": Quantity("angle of the edge after the tilt", *ANGLE),
    "theta_2": Quantity("angle of the edge when straightened", *ANGLE),
    "beta": Quantity("tip misalignment", *ANGLE),
    "x": Quantity("centre of the part", *LENGTH),
    "y": Quantity("centre of the part", *LENGTH),
    "d1": Quantity("distance from the centre to the edge", *LENGTH),
    "d2": Quantity("contact, measured along the edge from its middle", *LENGTH),
    "d2_back": Quantity("contact of the straightening push along the edge", *LENGTH),
    "d4": Quantity("tip spacing", *LENGTH),
    "dx": Quantity("tip ahead of the centre in x", *LENGTH),
    "dy": Quantity("tip above the centre in y", *LENGTH),
    "p_S": Quantity("passive tip, measured along its edge from the middle", *LENGTH),
    "half": Quantity("half the length of the edge", *LENGTH),
    "first": Quantity("lower end of the edge, from the foot of the centre", *LENGTH),
    "last": Quantity("upper end of the edge, from the foot of the centre", *LENGTH),
    "h": Quantity("distance of active and passive tip in x", *LENGTH),
    "V": Quantity("distance of active and passive tip in y", *LENGTH),
    "travel": Quantity("travel of the tip in contact", *LENGTH),
    "rho": Quantity("film ratio", "µm²", units.UM**2),
    "mu": Quantity("friction coefficient", "", 1.0),
    "side": Quantity("+1 turns counter-clockwise, −1 clockwise", "", 1.0),
}


@dataclass(frozen=True, slots=True)
class Side:
    """One side of a box, ready to be shown."""

    name: str
    meaning: str
    value: str


def signed(text: str) -> str:
    """Text with a typographic minus."""
    return text.replace("-", MINUS)


def number(value: float, digits: int = 1) -> str:
    """Fixed digits after the point; no negative zero."""
    return signed(f"{round(value, digits) + 0.0:.{digits}f}")


_WRITTEN_OUT = 1e6  # below it 2.8e+03 is written 2800


def significant(value: float, digits: int = 6) -> str:
    """At most ``digits`` significant digits, no exponent where it can be helped."""
    if math.isinf(value):
        return signed("-∞") if value < 0 else "∞"
    short = f"{value:.{digits}g}"
    plain = "e+" in short and abs(value) < _WRITTEN_OUT
    return signed(f"{float(short):.0f}" if plain else short)


def outward(low: float, high: float, digits: int) -> str:
    """A range rounded outward, so that it still holds everything."""
    # so little is the rounding of the conversion to um and deg, and of an end that is a decimal
    below, above = low + _CONVERSION * math.ulp(low), high - _CONVERSION * math.ulp(high)
    return f"{signed(down(below, digits))} … {signed(up(above, digits))}"


def box_words(box: ExactBox) -> tuple[str, str, str]:
    """x, y in um and theta in deg, rounded outward."""
    x, y = (
        outward(units.to_um(float.fromhex(low)), units.to_um(float.fromhex(high)), 1)
        for low, high in (box.x_m, box.y_m)
    )
    low, high = (units.to_deg(float.fromhex(end)) for end in box.theta_rad)
    return x, y, outward(low, high, 2)


def sides(over: Mapping[str, HexPair]) -> tuple[Side, ...]:
    """Sides of a box of hexadecimal SI numbers in readable units."""
    return tuple(_side(name, pair) for name, pair in over.items())


def _side(name: str, pair: HexPair) -> Side:
    quantity = QUANTITIES.get(name, Quantity("", "SI", 1.0))
    low, high = (significant(float.fromhex(end) / quantity.scale) for end in pair)
    value = low if low == high else f"{low} … {high}"
    return Side(name, quantity.meaning, f"{value} {quantity.unit}".rstrip())


def command(coordinate: str, aim: AimDocument | None) -> str:
    """What to command, from the sensed pose."""
    if aim is None:
        return "—"
    if aim.relative_to == "world":
        return f"{number(aim.offset_um)} µm"
    sign = MINUS if aim.offset_um < 0 else "+"
    return f"sensed {coordinate} {sign} {number(abs(aim.offset_um))} µm"


def point(values: Pair) -> str:
    """A point in um."""
    return f"({number(values[0])}, {number(values[1])})"


def factor(value: float, digits: int = 2) -> str:
    """A margin, rounded down: the plan is proved at what is shown."""
    if value >= LARGEST:
        return f"≥ {LARGEST:g}"
    return down(value, digits)


def about(value: float) -> str:
    """About four digits, without an exponent."""
    return number(value, 0) if abs(value) >= 1000.0 else significant(value, 4)


def low_end(value: float) -> str:
    """The lower end of an interval, as ``about`` but rounded down."""
    return signed(down(value, 0) if abs(value) >= 1000.0 else down_to(value, 4))


def high_end(value: float) -> str:
    """The upper end of an interval, as ``about`` but rounded up."""
    return signed(up(value, 0) if abs(value) >= 1000.0 else up_to(value, 4))


def small(value: float) -> str:
    """A length or angle that something is off by at most, often zero: two digits, rounded up."""
    if value == 0.0:
        return "0"
    decimals = max(1 - math.floor(math.log10(abs(value))), 0)
    return signed(up(Fraction(repr(float(value))), decimals))


def sentence(text: str) -> str:
    """With a capital and a full stop; nothing of nothing."""
    return f"{text[:1].upper()}{text[1:]}." if text else ""


@dataclass(frozen=True, slots=True)
class Witness:
    """A run that breaks the claim, in words."""

    outcome: str
    facts: tuple[tuple[str, str], ...]
    moves: tuple[tuple[str, ...], ...]
    """Number, and errors of sensing and of both probes."""


def witness_words(witness: WitnessDocument, outcome: str) -> Witness:
    """A witness in um, um^2 and deg; ``outcome`` says how its run ends."""
    x, y, theta = (float.fromhex(value) for value in witness.start)
    ratio = float.fromhex(witness.film_ratio_m2) / units.UM**2
    facts = (
        ("start", _pose(x, y, theta)),
        ("friction coefficient", significant(float.fromhex(witness.friction), 4)),
        ("film ratio", f"{number(ratio, 0)} µm²"),
        ("tip misalignment", f"{_degrees(witness.misalignment_rad)} deg"),
    )
    moves = zip(witness.sensing, witness.dual_probe, witness.single_probe, strict=True)
    return Witness(
        outcome=outcome,
        facts=facts,
        moves=tuple(
            (
                str(index),
                _pose(*(float.fromhex(value) for value in sensing)),
                _offset(dual),
                _offset(single),
            )
            for index, (sensing, dual, single) in enumerate(moves, start=1)
        ),
    )


def _pose(x: float, y: float, theta: float) -> str:
    place = f"{number(units.to_um(x), 2)} µm, {number(units.to_um(y), 2)} µm"
    return f"({place}, {number(units.to_deg(theta), 3)} deg)"


def _offset(pair: HexPair) -> str:
    x, y = (number(units.to_um(float.fromhex(value)), 2) for value in pair)
    return f"({x}, {y}) µm"


def _degrees(value: str) -> str:
    return number(units.to_deg(float.fromhex(value)), 3)
