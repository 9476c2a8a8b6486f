"""What acts on the part besides support and tips: forces of the stage, and things in the way."""

import numpy as np

from meso_robust.kernels import sealed
from meso_robust.simulator.stage import FORM, Effect, Parameter, Stage
from meso_robust.types import Floats

_UM, _DEG = 1e-6, np.pi / 180.0


def _speed(key: str, meaning: str) -> Parameter:
    return Parameter(key=key, unit="µm/s", to_si=_UM, meaning=meaning)


ENVIRONMENT = Stage(
    name="environment",
    base=32,
    slots=24,
    effects=(
        Effect(
            name="body_force",
            equation="F = e_x b at the reference point, constant in the stage's frame",
            source="tilted stage, F = W sin α; a curved one has another tilt at another place",
            forms=("alike everywhere", "F = e_x (b + k (n · x) n): a stage that is curved along n"),
            parameters=(
                _speed("x_um_s", "b_x: speed at which the force alone drags the part"),
                _speed("y_um_s", "b_y"),
                Parameter(
                    key="growth_um_s_per_mm", unit="µm/s/mm", to_si=1e-3,
                    meaning="k: of a curved stage, by how much the speed grows with the place along n",
                ),
                Parameter(
                    key="direction_deg", unit="deg", to_si=_DEG, size=False,
                    meaning="direction of n, stage frame",
                ),
            ),
        ),
        Effect(
            name="film_flow",
            equation="the film resists v − v_f: D(v) − E (v_f, 0)",
            source="flow of the oil",
            parameters=(_speed("x_um_s", "v_f,x"), _speed("y_um_s", "v_f,y")),
        ),
        Effect(
            name="wall_capillarity",
            equation="F = e_x p exp(−(s − n · x)/l) n, n the direction to the wall",
            source="lateral meniscus; P. A. Kralchevsky, K. Nagayama 2000, "
            "doi:10.1016/S0001-8686(99)00016-0",
            forms=("falls exponentially", "falls as 1/(1 + gap/l)²"),
            parameters=(
                _speed("pull_um_s", "p: speed at which the force drags the part at the wall"),
                Parameter(
                    key="direction_deg", unit="deg", to_si=_DEG, size=False,
                    meaning="direction of n, from the free space to the wall",
                ),
                Parameter(
                    key="position_um", unit="µm", to_si=_UM, size=False,
                    meaning="s: place of the wall along n, from the origin of the stage",
                ),
                Parameter(
                    key="range_um", unit="µm", to_si=_UM, default=300.0 * _UM, low=1.0 * _UM, size=False,
                    meaning="l: length of the decay",
                ),
            ),
        ),
        Effect(
            name="point_pull",
            equation="F = e_x p (a/l) exp(½ − a²/(2 l²)) towards a place of the stage, a the distance from it",
            source="charge or magnet under the stage, a dimple in it",
            forms=("falls exponentially", "falls as the distance, 2 (a/l)/(1 + (a/l)²)"),
            parameters=(
                _speed("pull_um_s", "p: speed at which the largest force drags the part"),
                Parameter(
                    key="x_um", unit="µm", to_si=_UM, size=False, meaning="the place, x, stage frame"
                ),
                Parameter(
                    key="y_um", unit="µm", to_si=_UM, size=False, meaning="the place, y, stage frame"
                ),
                Parameter(
                    key="range_um", unit="µm", to_si=_UM, default=300.0 * _UM, low=1.0 * _UM, size=False,
                    meaning="l: distance from the place at which the force is largest",
                ),
            ),
        ),
        Effect(
            name="unmodelled_wall",
            equation="a round post of the radius r is a contact like any other",
            source="debris or a burr on the stage",
            parameters=(
                Parameter(
                    key="radius_um", unit="µm", to_si=_UM, low=0.0, meaning="radius of the post"
                ),
                Parameter(
                    key="x_um", unit="µm", to_si=_UM, size=False, meaning="centre x, stage frame"
                ),
                Parameter(
                    key="y_um", unit="µm", to_si=_UM, size=False, meaning="centre y, stage frame"
                ),
            ),
        ),
    ),
)  # fmt: skip

_FORCE_X = ENVIRONMENT.slot("body_force", "x_um_s")
_FORCE_Y = ENVIRONMENT.slot("body_force", "y_um_s")
_FORCE_GROWTH = ENVIRONMENT.slot("body_force", "growth_um_s_per_mm")
_FORCE_WAY = ENVIRONMENT.slot("body_force", "direction_deg")
_FORCE_FORM = ENVIRONMENT.slot("body_force", FORM)
_FLOW_X = ENVIRONMENT.slot("film_flow", "x_um_s")
_FLOW_Y = ENVIRONMENT.slot("film_flow", "y_um_s")
_PULL = ENVIRONMENT.slot("wall_capillarity", "pull_um_s")
_PULL_ANGLE = ENVIRONMENT.slot("wall_capillarity", "direction_deg")
_PULL_PLACE = ENVIRONMENT.slot("wall_capillarity", "position_um")
_PULL_RANGE = ENVIRONMENT.slot("wall_capillarity", "range_um")
_PULL_FORM = ENVIRONMENT.slot("wall_capillarity", FORM)
_POINT = ENVIRONMENT.slot("point_pull", "pull_um_s")
_POINT_X = ENVIRONMENT.slot("point_pull", "x_um")
_POINT_Y = ENVIRONMENT.slot("point_pull", "y_um")
_POINT_RANGE = ENVIRONMENT.slot("point_pull", "range_um")
_POINT_FORM = ENVIRONMENT.slot("point_pull", FORM)
POST_RADIUS = ENVIRONMENT.slot("unmodelled_wall", "radius_um")
"""Column of the radius of the unmodelled post; its centre is in the two after it."""

FLOW_SLOTS = (_FLOW_X, _FLOW_Y)
"""Columns of the flow of the film."""
FORCE_SLOTS = (_FORCE_X, _FORCE_Y, _FORCE_GROWTH, _FLOW_X, _FLOW_Y, _PULL, _POINT)
"""Columns of effects that push the part without a contact."""


@sealed
def stage_wrench(
    effects: Floats, film: Floats, pose: Floats, cos: float, sin: float, out: Floats
) -> None:
    """Add the wrench of the stage on the part, body frame, over e_x.

    Parameters
    ----------
    effects
        (S,) values of the effects.
    film
        (6,) packed drag matrix of the film at this pose.
    pose
        (3,) x, y in m and θ in rad.
    cos, sin
        Of the angle at which displacements are taken.
    out
        (3,) receives the wrench.
    """
    fx, fy = effects[_FORCE_X], effects[_FORCE_Y]
    if effects[_FORCE_FORM] != 0.0:
        nx, ny = np.cos(effects[_FORCE_WAY]), np.sin(effects[_FORCE_WAY])
        grown = effects[_FORCE_GROWTH] * (nx * pose[0] + ny * pose[1])
        fx += grown * nx
        fy += grown * ny
    if effects[_PULL] != 0.0:
        nx, ny = np.cos(effects[_PULL_ANGLE]), np.sin(effects[_PULL_ANGLE])
        gap = effects[_PULL_PLACE] - nx * pose[0] - ny * pose[1]
        away = gap / effects[_PULL_RANGE]
        near = np.exp(-away) if effects[_PULL_FORM] == 0.0 else (1.0 + max(away, 0.0)) ** -2
        pull = effects[_PULL] * near
        fx += pull * nx
        fy += pull * ny
    if effects[_POINT] != 0.0:
        ax = (effects[_POINT_X] - pose[0]) / effects[_POINT_RANGE]
        ay = (effects[_POINT_Y] - pose[1]) / effects[_POINT_RANGE]
        square = ax * ax + ay * ay
        near = np.exp(0.5 - 0.5 * square) if effects[_POINT_FORM] == 0.0 else 2.0 / (1.0 + square)
        fx += effects[_POINT] * near * ax
        fy += effects[_POINT] * near * ay
    out[0] += cos * fx + sin * fy
    out[1] += cos * fy - sin * fx
    wx, wy = effects[_FLOW_X], effects[_FLOW_Y]
    if wx != 0.0 or wy != 0.0:
        bx, by = cos * wx + sin * wy, cos * wy - sin * wx
        out[0] += film[0] * bx + film[1] * by
        out[1] += film[1] * bx + film[3] * by
        out[2] += film[2] * bx + film[4] * by
