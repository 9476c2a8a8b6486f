"""What no named law explains: a wrench on the part that is a sum of named bases.

A fit chooses few of the bases and gives each a coefficient. The sum predicts; it does not say what the
physics is, and no base is the name of a cause. Forces are over the film's drag e_x, as everywhere.

Four kinds of bases: a force or torque that acts on a part at rest too (constant, even in place, even in
time); a force across the motion and a torque that grow with the speed and follow the heading of the
motion on the stage or in the part (a force along the motion only scales the drag, which no motion
shows); and a resistance to turning that differs where turning outweighs sliding. Bases that follow the
motion take it from the step before.
"""

import numpy as np

from meso_robust.kernels import sealed
from meso_robust.simulator.stage import Effect, Parameter, Stage
from meso_robust.types import Floats

_UM = 1e-6
_MOST = 0.9  # of the film's drag: the motion of a step before could not hold back more


def _base(key: str, unit: str, to_si: float, meaning: str, most: float = np.inf) -> Parameter:
    return Parameter(key=key, unit=unit, to_si=to_si, low=-most, high=most, meaning=meaning)


def _forces(prefix: str, frame: str) -> tuple[Parameter, ...]:
    return tuple(
        _base(f"{prefix}force_{axis}_um_s", "µm/s", _UM, f"constant force along {axis}, {frame}")
        for axis in "xy"
    )


def _slopes() -> tuple[Parameter, ...]:
    return tuple(
        _base(
            f"force_{axis}_along_{place}_per_s", "1/s", 1.0, f"force along {axis} by place {place}"
        )
        for axis in "xy"
        for place in "xy"
    )


def _drifts() -> tuple[Parameter, ...]:
    return tuple(
        _base(f"force_{axis}_um_s2", "µm/s²", _UM, f"force along {axis} by time, stage frame")
        for axis in "xy"
    )


def _harmonics(prefix: str, unit: str, to_si: float, ending: str, what: str, most: float,
               orders: tuple[int, ...]) -> tuple[Parameter, ...]:  # fmt: skip
    return tuple(
        _base(f"{prefix}_{wave}{order}{ending}", unit, to_si, f"{what} × {wave} {order}φ", most)
        for order in orders
        for wave in ("cos", "sin")
    )


RESIDUAL = Stage(
    name="residual",
    base=136,
    slots=32,
    effects=(
        Effect(
            name="residual",
            equation="w = Σ c_i b_i(pose, motion, time) beyond all named laws",
            source="sparse regression on a library of bases; S. L. Brunton et al. 2016, "
            "doi:10.1073/pnas.1517384113",
            parameters=(
                *_forces("", "stage frame"),
                *_forces("part_", "frame of the part"),
                _base("torque_um2_s", "µm²/s", _UM**2, "constant torque"),
                *_slopes(),
                *_drifts(),
                _base("across", "", 1.0, "force across the motion over the drag along it", _MOST),
                *_harmonics(
                    "across", "", 1.0, "", "the same, φ the heading on the stage", _MOST, (1, 2, 4)
                ),
                *_harmonics(
                    "part_across", "", 1.0, "", "the same, φ the heading in the part", _MOST, (1, 2, 4)
                ),
                _base("torque_um", "µm", _UM, "torque over the drag along the motion"),
                *_harmonics(
                    "torque", "µm", _UM, "_um", "the same, φ the heading in the part", np.inf, (1, 2)
                ),
                _base(
                    "spin", "", 1.0,
                    "drag of turning, more by this share where turning outweighs sliding", _MOST,
                ),
            ),
        ),
    ),
)  # fmt: skip

BASES = tuple(parameter.key for parameter in RESIDUAL.effects[0].parameters)
"""Names of the bases, in the order of their columns."""
RESIDUAL_SLOTS = tuple(RESIDUAL.base + k for k in range(len(BASES)))
"""Columns of the coefficients."""

_FORCE = RESIDUAL.slot("residual", "force_x_um_s")
_PART_FORCE = RESIDUAL.slot("residual", "part_force_x_um_s")
_TORQUE = RESIDUAL.slot("residual", "torque_um2_s")
_SLOPE = RESIDUAL.slot("residual", "force_x_along_x_per_s")
_DRIFT = RESIDUAL.slot("residual", "force_x_um_s2")
_ACROSS = RESIDUAL.slot("residual", "across")
_WAVES = RESIDUAL.slot("residual", "across_cos1")
_PART_WAVES = RESIDUAL.slot("residual", "part_across_cos1")
_TURN = RESIDUAL.slot("residual", "torque_um")
_TURN_WAVES = RESIDUAL.slot("residual", "torque_cos1_um")
_SPIN = RESIDUAL.slot("residual", "spin")


@sealed
def _second(c: float, s: float) -> tuple[float, float]:
    """Cosine and sine of the double angle."""
    return c * c - s * s, 2.0 * c * s


@sealed
def _wave(effects: Floats, first: int, c: float, s: float, fourth: bool) -> float:
    """Sum of the harmonics 1, 2 and, if asked, 4 of an angle, coefficients from a column on."""
    c2, s2 = _second(c, s)
    total = effects[first] * c + effects[first + 1] * s
    total += effects[first + 2] * c2 + effects[first + 3] * s2
    if fourth:
        c4, s4 = _second(c2, s2)
        total += effects[first + 4] * c4 + effects[first + 5] * s4
    return float(total)


@sealed
def residual_wrench(
    effects: Floats,
    film: Floats,
    pose: Floats,
    velocity: tuple[float, float, float],
    time: float,
    cos: float,
    sin: float,
    out: Floats,
) -> None:
    """Add the wrench of the bases on the part, body frame, over e_x.

    Parameters
    ----------
    effects
        (S,) values of the effects.
    film
        (6,) packed drag matrix of the film at this pose.
    pose
        (3,) x, y in m and θ in rad.
    velocity
        Of the last step, world frame, m/s and rad/s.
    time
        Since the start of the run, s.
    cos, sin
        Of the angle at which displacements are taken.
    out
        (3,) receives the wrench.
    """
    x, y = pose[0], pose[1]
    fx = effects[_FORCE] + effects[_SLOPE] * x + effects[_SLOPE + 1] * y + effects[_DRIFT] * time
    fy = effects[_FORCE + 1] + effects[_SLOPE + 2] * x + effects[_SLOPE + 3] * y
    fy += effects[_DRIFT + 1] * time
    bx, by, turn = effects[_PART_FORCE], effects[_PART_FORCE + 1], effects[_TORQUE]
    vx, vy, omega = velocity
    speed = np.sqrt(vx * vx + vy * vy)
    spun = film[5] * omega * omega
    if speed > 0.0:
        c, s = vx / speed, vy / speed
        own_c, own_s = c * cos + s * sin, s * cos - c * sin
        across = effects[_ACROSS] + _wave(effects, _WAVES, c, s, True)
        across += _wave(effects, _PART_WAVES, own_c, own_s, True)
        fx -= across * vy
        fy += across * vx
        turn += speed * (effects[_TURN] + _wave(effects, _TURN_WAVES, own_c, own_s, False))
    slid = film[0] * speed * speed
    if spun > 0.0:
        turn -= effects[_SPIN] * film[5] * omega * spun / (spun + slid)
    out[0] += cos * fx + sin * fy + bx
    out[1] += cos * fy - sin * fx + by
    out[2] += turn
