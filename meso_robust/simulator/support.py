r"""What the part slides on: the resistance of film and dry contact to a twist of the part.

The support resists the twist ``v = (v_x, v_y, ω)`` (body axes, at the reference point) with the
wrench ``D(v)``. Everything is divided by the film's translational drag e_x, so that forces are speeds;
without a film the scale of the forces is of no effect. Four laws add up:

* film, ``D = E v``, E symmetric and positive definite; the paper's is ``diag(1, 1, ρ)``, ρ = e_θ / e_x;
* Coulomb points, ``D = Σ c_i J_iᵀ u_i / |u_i|`` with the speed ``u_i = J_i v`` of the point i: the
  three support points of the paper's Section V are of this kind, and so is an area;
* ellipsoidal limit surface, ``D = A v / √(vᵀ A v)``, the law whose forces lie on ``fᵀ A⁻¹ f = 1``
  (R. D. Howe, M. R. Cutkosky 1996, doi:10.1177/027836499601500603);
* the effects below but inertia, integrated over the area of the part by `outline.quadrature`. Its nodes are
  drawn together or apart until the second moment of the area is ρ, so that the nodes of a plain film
  have just the drag ``diag(1, 1, ρ)``.

Source of the film and the points: the paper, Sections V-A and IX-B; derivations/three_point_support.py
derives the points' law from maximum dissipation.

A step solves ``K Δ − s = contact forces`` with the tangent K of D at the last twist, again and again
until the twist agrees. For the Coulomb laws K is the primal-dual tangent of M. Hintermüller and
G. Stadler 2006, doi:10.1137/040613263: for a point with force f, ``(c I − f ûᵀ) / |u|``, made symmetric.
The law of a point is smoothed to ``c u / √(|u|² + ε²)``, ε = `_CREEP` tip speeds: a point that rests
creeps at about ε.
"""

import numpy as np

from meso_robust.kernels import sealed
from meso_robust.simulator.stage import FORM, REFERENCE_SPEED, Effect, Parameter, Stage
from meso_robust.simulator.tables import STEP
from meso_robust.types import Floats

_RATIO = Parameter(
    key="ratio", unit="", to_si=REFERENCE_SPEED, low=0.0, meaning="force over film drag at 75 µm/s"
)
_UM, _DEG = 1e-6, np.pi / 180.0
_LAY_FORMS = ("a tensor: it deflects the slip", "against the slip, its size an ellipse 1 ± a")

SUPPORT = Stage(
    name="support",
    base=0,
    slots=32,
    effects=(
        Effect(
            name="dry_friction",
            equation="f = −τ u/|u| on every part of the area",
            source="E. C. Bingham 1922; Coulomb friction under the film",
            forms=(
                "even pressure",
                "pressure as the square of the distance from the reference point",
            ),
            parameters=(_RATIO,),
        ),
        Effect(
            name="stribeck_friction",
            equation="f = −τ exp(−(|u|/v_s)²) u/|u|, in addition to dry friction",
            source="B. Armstrong-Hélouvry et al. 1994, doi:10.1016/0005-1098(94)90209-7",
            forms=("falls as exp(−(|u|/v_s)²)", "falls as exp(−|u|/v_s)"),
            parameters=(
                _RATIO,
                Parameter(
                    key="speed_um_s",
                    unit="µm/s",
                    to_si=_UM,
                    default=30.0 * _UM,
                    low=1e-3 * _UM,
                    size=False,
                    meaning="speed over which the excess decays",
                ),
            ),
        ),
        Effect(
            name="shear_thinning",
            equation="f = −|u/v₀|^(n−1) u on every part of the area, n = 1 − drop",
            source="W. Ostwald 1925; power-law fluid; P. J. Carreau 1972, doi:10.1122/1.549276",
            forms=(
                "a power of the speed",
                "(1 + (u/v)²)^((n−1)/2): constant well below v, a power well above",
            ),
            parameters=(
                Parameter(
                    key="exponent_drop",
                    unit="",
                    to_si=1.0,
                    low=-0.9,
                    high=0.9,
                    meaning="1 − n, positive for thinning",
                ),
                Parameter(
                    key="speed_um_s",
                    unit="µm/s",
                    to_si=_UM,
                    default=30.0 * _UM,
                    low=1e-3 * _UM,
                    size=False,
                    meaning="v, of the second form",
                ),
            ),
        ),
        Effect(
            name="anisotropic_drag",
            equation="f = −(I + a S(φ − θ)) u, S(φ) = [[cos 2φ, sin 2φ], [sin 2φ, −cos 2φ]]",
            source="lay of the stage's surface; D. Ma, A. Rodriguez 2018, doi:10.1109/LRA.2018.2851026",
            forms=_LAY_FORMS,
            parameters=(
                Parameter(
                    key="fraction",
                    unit="",
                    to_si=1.0,
                    low=-0.9,
                    high=0.9,
                    meaning="a: drag along the direction over the mean, less one",
                ),
                Parameter(
                    key="direction_deg",
                    unit="deg",
                    to_si=_DEG,
                    size=False,
                    meaning="φ, direction of the largest drag, stage frame",
                ),
            ),
        ),
        Effect(
            name="part_anisotropic_drag",
            equation="f = −(I + a S(φ)) u, in the frame of the part",
            source="finish of the part's lower side; as anisotropic_drag",
            forms=_LAY_FORMS,
            parameters=(
                Parameter(
                    key="fraction",
                    unit="",
                    to_si=1.0,
                    low=-0.9,
                    high=0.9,
                    meaning="a: drag along the direction over the mean, less one",
                ),
                Parameter(
                    key="direction_deg",
                    unit="deg",
                    to_si=_DEG,
                    size=False,
                    meaning="φ, direction of the largest drag, frame of the part",
                ),
            ),
        ),
        Effect(
            name="drag_centre_offset",
            equation="E → Tᵀ E T, T v = velocity at the centre of drag c",
            source="uneven film; derivations/mechanics.py, `film` at another point",
            parameters=(
                Parameter(key="x_um", unit="µm", to_si=_UM, meaning="c_x, frame of the part"),
                Parameter(key="y_um", unit="µm", to_si=_UM, meaning="c_y, frame of the part"),
            ),
        ),
        Effect(
            name="drag_gradient",
            equation="k(x) = exp(g · x), x the place on the stage",
            source="thickness of the film; drag η A / h",
            forms=("grows exponentially", "grows linearly"),
            parameters=(
                Parameter(
                    key="x_per_mm", unit="1/mm", to_si=1e3, low=-2e3, high=2e3, meaning="g_x"
                ),
                Parameter(
                    key="y_per_mm", unit="1/mm", to_si=1e3, low=-2e3, high=2e3, meaning="g_y"
                ),
            ),
        ),
        Effect(
            name="drag_drift",
            equation="E(t) = E exp(r t)",
            source="draining, drying or warming film; J. Stefan 1874",
            parameters=(
                Parameter(
                    key="rate_percent_s",
                    unit="%/s",
                    to_si=0.01,
                    low=-1.0,
                    high=1.0,
                    meaning="r, relative growth of the drag",
                ),
            ),
        ),
        Effect(
            name="breakaway_friction",
            equation="f = −τ ln(1 + a/a₀) u/|u|, age a' = 1 − a v/D, a₀ = 1 s",
            source="A. Ruina 1983, doi:10.1029/JB088iB12p10359 (ageing law)",
            forms=(
                "grows with the logarithm of the age",
                "saturates, a/(a + a₀)",
                "grows with the root of the age",
            ),
            parameters=(
                _RATIO,
                Parameter(
                    key="distance_um",
                    unit="µm",
                    to_si=_UM,
                    default=2.0 * _UM,
                    low=1e-3 * _UM,
                    size=False,
                    meaning="D, distance over which the age is lost",
                ),
            ),
        ),
        Effect(
            name="uneven_support",
            equation="f = −τ max(1 + q · r, 0) u/|u| on every part of the area",
            source="pressure that varies linearly over the area; M. T. Mason 1986",
            parameters=(
                _RATIO,
                Parameter(
                    key="x_um",
                    unit="µm",
                    to_si=_UM,
                    size=False,
                    meaning="centre of pressure x, frame of the part, exact while no pressure is negative",
                ),
                Parameter(
                    key="y_um",
                    unit="µm",
                    to_si=_UM,
                    size=False,
                    meaning="centre of pressure y, likewise",
                ),
            ),
        ),
        Effect(
            name="sticky_spot",
            equation="k(x) = 1 + s exp(−(|x − m|/r)²), x the place on the stage",
            source="dirt, a scratch or a thin place of the film",
            forms=("the film drags more", "dry friction besides the film"),
            parameters=(
                _RATIO,
                Parameter(key="x_um", unit="µm", to_si=_UM, size=False, meaning="m_x, stage frame"),
                Parameter(key="y_um", unit="µm", to_si=_UM, size=False, meaning="m_y, stage frame"),
                Parameter(
                    key="radius_um",
                    unit="µm",
                    to_si=_UM,
                    default=300.0 * _UM,
                    low=1.0 * _UM,
                    size=False,
                    meaning="r: distance from m over which the resistance falls",
                ),
            ),
        ),
        Effect(
            name="inertia",
            equation="D(v) + e_x τ dv/dt = forces of the contacts, J dω/dt for turns",
            source="I. Newton 1687; the paper's Section IV leaves it out",
            parameters=(
                Parameter(
                    key="time_ms",
                    unit="ms",
                    to_si=1e-3,
                    low=0.0,
                    meaning="τ = m / e_x: time in which a free part stops, its mass spread evenly",
                ),
            ),
        ),
    ),
)

_DRY = SUPPORT.slot("dry_friction", "ratio")
_DRY_FORM = SUPPORT.slot("dry_friction", FORM)
_STRIBECK = SUPPORT.slot("stribeck_friction", "ratio")
_STRIBECK_SPEED = SUPPORT.slot("stribeck_friction", "speed_um_s")
_STRIBECK_FORM = SUPPORT.slot("stribeck_friction", FORM)
_DROP = SUPPORT.slot("shear_thinning", "exponent_drop")
_DROP_SPEED = SUPPORT.slot("shear_thinning", "speed_um_s")
_DROP_FORM = SUPPORT.slot("shear_thinning", FORM)
_STAGE_LAY = SUPPORT.slot("anisotropic_drag", "fraction")
_STAGE_LAY_ANGLE = SUPPORT.slot("anisotropic_drag", "direction_deg")
_STAGE_LAY_FORM = SUPPORT.slot("anisotropic_drag", FORM)
_PART_LAY = SUPPORT.slot("part_anisotropic_drag", "fraction")
_PART_LAY_ANGLE = SUPPORT.slot("part_anisotropic_drag", "direction_deg")
_PART_LAY_FORM = SUPPORT.slot("part_anisotropic_drag", FORM)
_CENTRE_X = SUPPORT.slot("drag_centre_offset", "x_um")
_CENTRE_Y = SUPPORT.slot("drag_centre_offset", "y_um")
_GRADIENT_X = SUPPORT.slot("drag_gradient", "x_per_mm")
_GRADIENT_Y = SUPPORT.slot("drag_gradient", "y_per_mm")
_GRADIENT_FORM = SUPPORT.slot("drag_gradient", FORM)
_DRIFT = SUPPORT.slot("drag_drift", "rate_percent_s")
_AGEING = SUPPORT.slot("breakaway_friction", "ratio")
_AGEING_DISTANCE = SUPPORT.slot("breakaway_friction", "distance_um")
_AGEING_FORM = SUPPORT.slot("breakaway_friction", FORM)
_UNEVEN = SUPPORT.slot("uneven_support", "ratio")
_PRESSURE_X = SUPPORT.slot("uneven_support", "x_um")
_PRESSURE_Y = SUPPORT.slot("uneven_support", "y_um")

_SPOT = SUPPORT.slot("sticky_spot", "ratio")
_SPOT_X = SUPPORT.slot("sticky_spot", "x_um")
_SPOT_Y = SUPPORT.slot("sticky_spot", "y_um")
_SPOT_RADIUS = SUPPORT.slot("sticky_spot", "radius_um")
_SPOT_FORM = SUPPORT.slot("sticky_spot", FORM)

INERTIA_TIME = SUPPORT.slot("inertia", "time_ms")
"""Column of the time in which a free part stops."""

NODE_SLOTS = (
    _DRY,
    _STRIBECK,
    _DROP,
    _AGEING,
    _UNEVEN,
    _STAGE_LAY,
    _PART_LAY,
    _GRADIENT_X,
    _GRADIENT_Y,
    _SPOT,
)
"""Columns of effects that act on every part of the area."""
DRY_SLOTS = (_DRY, _STRIBECK, _DROP, _AGEING, _UNEVEN, _STAGE_LAY_FORM, _PART_LAY_FORM, _SPOT_FORM)
"""Columns of effects that are not linear in the twist."""
LAYS = [_STAGE_LAY, _PART_LAY]
"""Columns of the fractions of the two lays."""
THINNING = _DROP
"""Column of the effect that needs a film although it is not linear."""
FILM_SLOTS = (
    _STAGE_LAY, _PART_LAY, _GRADIENT_X, _GRADIENT_Y, _CENTRE_X, _CENTRE_Y, _DRIFT, _SPOT
)  # fmt: skip
"""Columns of effects that change the film's drag matrix."""
AGE = _AGEING
"""Column of the effect that needs the age of the contact."""

DRY = 6
"""Columns of the table of dry points: force in x and y, body frame, and of the last twist the slip's
inverse speed, its direction in x and y, and the strength."""
_SLOW, _ALONG, _MOST = 2, 3, 5
_CREEP = 1e-6  # tip speeds
_LEAST_DRAG = 0.05  # of the film's at the origin: a line that falls must not end below nothing
_RIDGE = 1e-3  # share of the secant in the tangent, for a matrix that is positive definite


@sealed
def add_point(K: Floats, x: float, y: float, a: float, b: float, c: float) -> None:
    """Add ``Jᵀ [[a, b], [b, c]] J`` of the point (x, y) to a packed matrix.

    A symmetric 3×3 matrix is packed as its upper triangle by rows, (6,).
    """
    K[0] += a
    K[1] += b
    K[2] += b * x - a * y
    K[3] += c
    K[4] += c * x - b * y
    K[5] += a * y * y - 2.0 * b * x * y + c * x * x


@sealed
def multiply(K: Floats, v: Floats, out: Floats, sign: float) -> None:
    """Add ``sign K v`` of a packed matrix to `out`."""
    out[0] += sign * (K[0] * v[0] + K[1] * v[1] + K[2] * v[2])
    out[1] += sign * (K[1] * v[0] + K[3] * v[1] + K[4] * v[2])
    out[2] += sign * (K[2] * v[0] + K[4] * v[1] + K[5] * v[2])


@sealed
def film_matrix(
    film: Floats, points: Floats, effects: Floats, pose: Floats, time: float, out: Floats
) -> None:
    """Write the film's drag matrix with the effects that leave it linear.

    Parameters
    ----------
    film
        (6,) packed drag matrix without effects, over e_x.
    points
        (K, 4) table of `Inputs.points`; the fourth column holds the share of the area.
    effects
        (S,) values of the effects.
    pose
        (3,) x, y in m and θ in rad.
    time
        Since the start of the run, s.
    out
        (6,) receives the matrix, packed.
    """
    for k in range(6):
        out[k] = film[k]
    cos, sin = np.cos(pose[2]), np.sin(pose[2])
    gx, gy = effects[_GRADIENT_X], effects[_GRADIENT_Y]
    stage = effects[_STAGE_LAY] if effects[_STAGE_LAY_FORM] == 0.0 else 0.0
    part = effects[_PART_LAY] if effects[_PART_LAY_FORM] == 0.0 else 0.0
    spotted = effects[_SPOT] != 0.0 and effects[_SPOT_FORM] == 0.0
    if gx != 0.0 or gy != 0.0 or stage != 0.0 or part != 0.0 or spotted:
        angle = 2.0 * (effects[_STAGE_LAY_ANGLE] - pose[2])
        own = 2.0 * effects[_PART_LAY_ANGLE]
        along = stage * np.cos(angle) + part * np.cos(own)
        across = stage * np.sin(angle) + part * np.sin(own)
        for i in range(points.shape[0]):
            w, x, y = points[i, 3], points[i, 0], points[i, 1]
            if w == 0.0:
                continue
            wx, wy = pose[0] + cos * x - sin * y, pose[1] + sin * x + cos * y
            grown = gx * wx + gy * wy
            k = np.exp(grown) if effects[_GRADIENT_FORM] == 0.0 else max(1.0 + grown, _LEAST_DRAG)
            more = _spot(effects, wx, wy) / REFERENCE_SPEED if spotted else 0.0
            plus, minus = k * (1.0 + along) - 1.0 + more, k * (1.0 - along) - 1.0 + more
            add_point(out, x, y, w * plus, w * k * across, w * minus)
    cx, cy = effects[_CENTRE_X], effects[_CENTRE_Y]
    if cx != 0.0 or cy != 0.0:
        _move_centre(out, cx, cy)
    if effects[_DRIFT] != 0.0:
        growth = np.exp(effects[_DRIFT] * time)
        for k in range(6):
            out[k] *= growth


@sealed
def _spot(effects: Floats, x: float, y: float) -> float:
    """What a spot of the stage resists with at a place, over the film's drag, m/s."""
    dx, dy = x - effects[_SPOT_X], y - effects[_SPOT_Y]
    return float(effects[_SPOT] * np.exp(-(dx * dx + dy * dy) / effects[_SPOT_RADIUS] ** 2))


@sealed
def add_lay(lay: Floats, cos: float, sin: float, out: Floats) -> None:
    """Add what the stage's lay adds to the film's matrix, packed.

    Parameters
    ----------
    lay
        (4,) p and q of ``[[p, q], [q, −p]]``, world axes, and the centre of drag, m, body frame.
    cos, sin
        Of the part's angle.
    out
        (6,) packed drag matrix.
    """
    double, twice = cos * cos - sin * sin, 2.0 * cos * sin
    p, q = lay[0] * double + lay[1] * twice, lay[1] * double - lay[0] * twice
    add_point(out, lay[2], lay[3], p, q, -p)


@sealed
def _move_centre(K: Floats, x: float, y: float) -> None:
    """Congruence ``K → Tᵀ K T`` with ``T v = (v_x − y ω, v_y + x ω, ω)``."""
    K[5] += 2.0 * (x * K[4] - y * K[2]) + y * y * K[0] - 2.0 * x * y * K[1] + x * x * K[3]
    K[2] += x * K[1] - y * K[0]
    K[4] += x * K[3] - y * K[1]


@sealed
def pressure_slope(points: Floats, effects: Floats) -> tuple[float, float, float]:
    """Slope q of the pressure ``1 + q · r`` that has the given centre, 1/m, and p of ``p r²``, 1/m²."""
    xx, xy, yy = 0.0, 0.0, 0.0
    for i in range(points.shape[0]):
        w, x, y = points[i, 3], points[i, 0], points[i, 1]
        xx, xy, yy = xx + w * x * x, xy + w * x * y, yy + w * y * y
    size = xx * yy - xy * xy
    if size <= 0.0:
        return 0.0, 0.0, 0.0
    px, py = effects[_PRESSURE_X], effects[_PRESSURE_Y]
    return (yy * px - xy * py) / size, (xx * py - xy * px) / size, 1.0 / (xx + yy)


@sealed
def resist_dry(
    points: Floats,
    surface: Floats,
    effects: Floats,
    slope: tuple[float, float, float],
    heading: tuple[float, float, float, float],
    age: float,
    creep: float,
    v: Floats,
    dry: Floats,
    K: Floats,
    out: Floats,
) -> None:
    """Add tangent and offset of all laws but the film's at the twist v.

    Parameters
    ----------
    points
        (K, 4) rows x, y in m, strength c and share of the area of each point.
    surface
        (6,) packed matrix A of the limit surface; zeros for none.
    effects
        (S,) values of the effects.
    slope
        From `pressure_slope`.
    heading
        Cosine and sine of the part's angle, and x and y of its reference point in m.
    age
        Age of the contact, s.
    creep
        ε, the speed at which a resting point creeps, m/s.
    v
        (3,) twist, body frame.
    dry
        (K, DRY) table of the points: their forces by the Coulomb law as far as they are known; what
        `update_forces` needs of the twist v is written beside them.
    K
        (6,) packed matrix, receives the tangent.
    out
        (3,) receives ``K v − D(v)``.
    """
    aged = _aged(effects, age)
    laid, part, stage = _laid(effects, heading)
    spotted = effects[_SPOT] != 0.0 and effects[_SPOT_FORM] != 0.0
    # sums in numbers of their own: an array might be one of those that are read
    k0, k1, k2, k3, k4, k5, o0, o1, o2 = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for i in range(points.shape[0]):
        x, y = points[i, 0], points[i, 1]
        ux, uy = v[0] - v[2] * y, v[1] + v[2] * x
        m = np.sqrt(ux * ux + uy * uy + creep * creep)
        slow = 1.0 / m
        hx, hy = ux * slow, uy * slow
        c, film, drop = _strength(points, i, effects, slope, aged, m)
        if spotted:
            wx = heading[2] + heading[0] * x - heading[1] * y
            wy = heading[3] + heading[1] * x + heading[0] * y
            c += points[i, 3] * _spot(effects, wx, wy)
        if laid:
            film += points[i, 3] * _lays(effects, part, stage, hx, hy)
        dry[i, _SLOW], dry[i, _ALONG], dry[i, _ALONG + 1], dry[i, _MOST] = slow, hx, hy, c
        a = c * (1.0 + _RIDGE) * slow + film - drop * hx * hx
        b = -drop * hx * hy
        d = c * (1.0 + _RIDGE) * slow + film - drop * hy * hy
        if c != 0.0:
            fx, fy = dry[i, 0] * slow, dry[i, 1] * slow
            a -= fx * hx
            b -= 0.5 * (fx * hy + fy * hx)
            d -= fy * hy
        ax, ay, bx, by = b * x - a * y, d * x - b * y, a * ux + b * uy, b * ux + d * uy
        k0, k1, k2 = k0 + a, k1 + b, k2 + ax
        k3, k4, k5 = k3 + d, k4 + ay, k5 + ay * x - ax * y
        whole = c * slow + film
        px, py = bx - whole * ux, by - whole * uy
        o0, o1, o2 = o0 + px, o1 + py, o2 + x * py - y * px
    K[0], K[1], K[2], K[3], K[4], K[5] = (
        K[0] + k0, K[1] + k1, K[2] + k2, K[3] + k3, K[4] + k4, K[5] + k5
    )  # fmt: skip
    out[0], out[1], out[2] = out[0] + o0, out[1] + o1, out[2] + o2
    if surface[0] > 0.0:
        _resist_surface(surface, creep, v, K, out)


@sealed
def _laid(
    effects: Floats, heading: tuple[float, float, float, float]
) -> tuple[bool, tuple[float, float], tuple[float, float]]:
    """Whether a lay acts against the slip, and directions of those of part and stage, body frame."""
    part, stage = effects[_PART_LAY_ANGLE], effects[_STAGE_LAY_ANGLE]
    cos, sin = np.cos(stage), np.sin(stage)
    return (
        bool(effects[_PART_LAY_FORM] != 0.0 or effects[_STAGE_LAY_FORM] != 0.0),
        (np.cos(part), np.sin(part)),
        (heading[0] * cos + heading[1] * sin, heading[0] * sin - heading[1] * cos),
    )


@sealed
def _aged(effects: Floats, age: float) -> float:
    """Coulomb strength of the area by the age of the contact."""
    if effects[_AGEING] == 0.0:
        return 0.0
    grown = np.log(1.0 + age)
    if effects[_AGEING_FORM] != 0.0:
        grown = age / (1.0 + age) if effects[_AGEING_FORM] == 1.0 else np.sqrt(age)
    return float(effects[_AGEING] * grown)


@sealed
def _lays(
    effects: Floats, part: tuple[float, float], stage: tuple[float, float], ux: float, uy: float
) -> float:
    """Drag over the film's, less one, of both lays that act against a slip of a direction (body frame)."""
    more = 0.0
    if effects[_PART_LAY_FORM] != 0.0:
        more += _ellipse(effects[_PART_LAY], part, ux, uy)
    if effects[_STAGE_LAY_FORM] != 0.0:
        more += _ellipse(effects[_STAGE_LAY], stage, ux, uy)
    return more


@sealed
def _ellipse(fraction: float, axis: tuple[float, float], ux: float, uy: float) -> float:
    """Friction ellipse of axes ``1 ± a``, the larger along a direction, less one."""
    along = (1.0 + fraction) * (axis[0] * ux + axis[1] * uy)
    across = (1.0 - fraction) * (axis[0] * uy - axis[1] * ux)
    # of a part at rest, that slips nowhere, the film as it is
    rest = max(1.0 - ux * ux - uy * uy, 0.0)
    return float(np.sqrt(along * along + across * across + rest) - 1.0)


@sealed
def _strength(
    points: Floats,
    i: int,
    effects: Floats,
    slope: tuple[float, float, float],
    aged: float,
    speed: float,
) -> tuple[float, float, float]:
    """Coulomb strength of a point, viscous coefficient beyond the film's, and its loss with speed."""
    c, w = points[i, 2], points[i, 3]
    if w == 0.0:
        return c, 0.0, 0.0
    dry = effects[_DRY]
    if effects[_DRY_FORM] != 0.0:
        dry *= slope[2] * (points[i, 0] * points[i, 0] + points[i, 1] * points[i, 1])
    dry += aged
    if effects[_STRIBECK] != 0.0:
        fast = speed / effects[_STRIBECK_SPEED]
        dry += effects[_STRIBECK] * np.exp(
            -fast * (fast if effects[_STRIBECK_FORM] == 0.0 else 1.0)
        )
    if effects[_UNEVEN] != 0.0:
        pressure = 1.0 + slope[0] * points[i, 0] + slope[1] * points[i, 1]
        dry += effects[_UNEVEN] * max(pressure, 0.0)
    drop = effects[_DROP]
    if drop == 0.0:
        return c + w * dry, 0.0, 0.0
    if effects[_DROP_FORM] == 0.0:
        thin = w * (speed / REFERENCE_SPEED) ** -drop
        return c + w * dry, thin - w, drop * thin
    fast = (speed / effects[_DROP_SPEED]) ** 2
    thin = w * (1.0 + fast) ** (-0.5 * drop)
    return c + w * dry, thin - w, drop * thin * fast / (1.0 + fast)


@sealed
def _resist_surface(surface: Floats, creep: float, v: Floats, K: Floats, out: Floats) -> None:
    """Add tangent and offset of the limit surface, ``D = A v / n`` with ``n = √(vᵀ A v)``."""
    px = surface[0] * v[0] + surface[1] * v[1] + surface[2] * v[2]
    py = surface[1] * v[0] + surface[3] * v[1] + surface[4] * v[2]
    pz = surface[2] * v[0] + surface[4] * v[1] + surface[5] * v[2]
    floor = creep * np.sqrt(surface[0])
    norm = np.sqrt(max(px * v[0] + py * v[1] + pz * v[2], 0.0))
    moving = norm > floor
    n = max(norm, floor)
    share = (1.0 - _RIDGE) / n**3 if moving else 0.0
    K[0] += surface[0] / n - share * px * px
    K[1] += surface[1] / n - share * px * py
    K[2] += surface[2] / n - share * px * pz
    K[3] += surface[3] / n - share * py * py
    K[4] += surface[4] / n - share * py * pz
    K[5] += surface[5] / n - share * pz * pz
    loss = share * norm * norm  # of K v against D
    out[0] -= loss * px
    out[1] -= loss * py
    out[2] -= loss * pz


@sealed
def update_forces(points: Floats, v: Floats, new: Floats, dry: Floats) -> None:
    """Update the forces of the Coulomb law from the last twist to the new one, inside their discs.

    Parameters
    ----------
    points, dry
        As in `resist_dry`, which was called with the last twist.
    v, new
        (3,) the last twist and the new one, body frame.
    """
    mx, my, turn = new[0] - v[0], new[1] - v[1], new[2] - v[2]
    for i in range(points.shape[0]):
        c = dry[i, _MOST]
        if c == 0.0:
            dry[i, 0], dry[i, 1] = 0.0, 0.0
            continue
        slow, hx, hy = dry[i, _SLOW], dry[i, _ALONG], dry[i, _ALONG + 1]
        dx, dy = (mx - turn * points[i, 1]) * slow, (my + turn * points[i, 0]) * slow
        along = hx * dx + hy * dy
        fx = c * (hx + dx) - dry[i, 0] * along
        fy = c * (hy + dy) - dry[i, 1] * along
        square = fx * fx + fy * fy
        if square > c * c:
            shrink = c / np.sqrt(square)
            fx, fy = shrink * fx, shrink * fy
        dry[i, 0], dry[i, 1] = fx, fy


@sealed
def add_film(film: Floats, K: Floats) -> None:
    """Add a packed film matrix to the tangent; a linear law has no offset."""
    for k in range(6):
        K[k] += film[k]


@sealed
def older(age: float, distance: float, dt: float, effects: Floats) -> float:
    """Age of the contact after a step of `dt` in which it slid by `distance`.

    Exact for a constant speed: ``a' = 1 − a v / D``.
    """
    if distance == 0.0:
        return age + dt
    steady = dt * effects[_AGEING_DISTANCE] / distance
    return float(steady + (age - steady) * np.exp(-distance / effects[_AGEING_DISTANCE]))


@sealed
def factorise(K: Floats, step: Floats) -> bool:
    """Write the lower triangle of ``L⁻¹`` by rows and k, ``K / k = L Lᵀ``; False if impossible."""
    k = K[0]
    if not (k > 0.0 and k < np.inf):
        return False
    l21, l31 = K[1] / k, K[2] / k
    s22 = K[3] / k - l21 * l21
    if not s22 > 0.0:
        return False
    l22 = np.sqrt(s22)
    l32 = (K[4] / k - l31 * l21) / l22
    s33 = K[5] / k - l31 * l31 - l32 * l32
    if not s33 > 0.0:
        return False
    l33 = np.sqrt(s33)
    step[STEP.factor], step[STEP.factor + 2], step[STEP.factor + 5] = 1.0, 1.0 / l22, 1.0 / l33
    step[STEP.factor + 1] = -l21 / l22
    step[STEP.factor + 4] = -l32 / (l22 * l33)
    step[STEP.factor + 3] = -(l31 + l32 * step[STEP.factor + 1]) / l33
    step[STEP.factor + 6] = k
    return True


@sealed
def creep_speed(speed: float) -> float:
    """Speed at which a resting point creeps, for tips of the given speed."""
    return _CREEP * speed
