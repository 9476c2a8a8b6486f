r"""Motions with the pose at any instant: straight, sticking, guided by two tips, or a cubic.

One sticking contact: with ``V`` the velocity of the tip, ``p`` the point of contact in the body
frame and ``j = (p_y, −p_x, 1)`` the twist of a unit turn about it, the velocity of the part is
``(R(−θ) V, 0) + ω j``. The film has no moment about ``p``, ``j · E v = 0``, hence
``ω = h · R(−θ) V`` with the constant ``h = −(E j)_{1,2} / (j · E j)``. With κ = |h| |V| and ψ the
angle from the direction where the turn is fastest, ``dψ/dξ = κ cos ψ``, whose solution is

    tan(ψ/2 + π/4) = tan(ψ₀/2 + π/4) exp(κ ξ).

For E = diag(1, 1, ρ) this is ``dθ/dξ = r_y/(ρ + R²)`` of Gauss's law for a pushed rod.

One tip that sticks and one that slips along an edge: the two hold the part fast whatever the film
does. With ``D`` the way from the first tip to the second and ``d`` the distance of the second from
the line through the first along the edge, the normal ``m`` of the edge has ``m · D = d``, hence

    |D|² m = d D ± (|D|² − d²)^{1/2} J D,    J a turn by 90°.
"""

import numpy as np

from meso_robust.simulator.events.contact import Place, tip_in_body
from meso_robust.simulator.events.fused import inlined, sealed
from meso_robust.simulator.events.outline import NX, NY, VX, VY
from meso_robust.simulator.events.scene import FIRST, SECOND, SLIP_MINUS, Scene, Work
from meso_robust.types import Floats

_STRAIGHT, STICKING, _GUIDED, CUBIC = 0.0, 1.0, 2.0, 3.0
_JUST = 0.999  # a ratio of tangents below one is that of a root just passed, or of none
_START = 1e-13  # of the clock; what is nearer is the event at which the curve starts


@sealed
def start_straight(work: Work, place: Place) -> None:
    """Let the part go on from its place with its present twist, without a turn."""
    curve = work.curve
    curve[0] = _STRAIGHT
    cos, sin = place[2], place[3]
    curve[16], curve[17] = cos, sin
    for k in range(3):
        curve[1 + k] = work.pose[k]
    curve[4] = cos * work.twist[0] - sin * work.twist[1]
    curve[5] = sin * work.twist[0] + cos * work.twist[1]


@sealed
def start_sticking(scene: Scene, work: Work, contact: int, place: Place, clock: float) -> float:
    """Let the part turn from its place about a tip that sticks.

    Returns
    -------
    float
        The instant, counted from now, at which the force leaves the friction cone.
    """
    curve, pose, i = work.curve, work.pose, work.contact[contact, FIRST]
    _start_pivot(scene, curve, i, (pose, place[2], place[3]), clock)
    drag, vx, vy, px, py = work.drag, curve[4], curve[5], curve[6], curve[7]
    ex = drag[0, 0] * py - drag[0, 1] * px + drag[0, 2]
    ey = drag[1, 0] * py - drag[1, 1] * px + drag[1, 2]
    ez = drag[2, 0] * py - drag[2, 1] * px + drag[2, 2]
    whole = py * ex - px * ey + ez
    hx, hy = -ex / whole, -ey / whole
    kappa = np.hypot(hx, hy) * np.hypot(vx, vy)
    psi = pose[2] - np.arctan2(vy, vx) + np.arctan2(hy, hx)
    half = 0.5 * psi + 0.25 * np.pi
    curve[0] = STICKING
    curve[8], curve[9], curve[10] = kappa, np.sin(half), np.cos(half)
    # Force on the part in the body frame: the square matrix (E + E j hᵀ) times R(−θ) V.
    force = (
        drag[0, 0] + ex * hx,
        drag[0, 1] + ex * hy,
        drag[1, 0] + ey * hx,
        drag[1, 1] + ey * hy,
    )
    return min(
        _leaves(scene, work, contact, force, 1.0), _leaves(scene, work, contact, force, -1.0)
    )


@sealed
def start_guided(
    scene: Scene, work: Work, curve: Floats, guides: tuple[int, int], clock: float
) -> None:
    """Let the part turn about a tip that sticks so that another slips along its edge.

    A tip that slips along an edge parallel to the other's makes the part turn alike.
    """
    pose = work.pose
    i, k = work.contact[guides[0], FIRST], work.contact[guides[1], FIRST]
    cos, sin = np.cos(pose[2]), np.sin(pose[2])
    _start_pivot(scene, curve, i, (pose, cos, sin), clock)
    edge = scene.edges[work.contact[guides[1], SECOND]]
    nx, ny = cos * edge[NX] - sin * edge[NY], sin * edge[NX] + cos * edge[NY]
    ux, uy = scene.tips[k, 2] - curve[4], scene.tips[k, 3] - curve[5]
    dx = scene.tips[k, 0] + scene.tips[k, 2] * clock - curve[1]
    dy = scene.tips[k, 1] + scene.tips[k, 3] * clock - curve[2]
    curve[0], curve[8], curve[9] = _GUIDED, nx, ny
    curve[10], curve[11], curve[12], curve[13] = dx, dy, ux, uy
    curve[14] = edge[NX] * (edge[VX] - curve[6]) + edge[NY] * (edge[VY] - curve[7])
    curve[14] += scene.tips[k, 4]
    curve[15] = np.copysign(1.0, dx * ny - dy * nx)


@sealed
def guided_reach(scene: Scene, work: Work, guides: tuple[int, int]) -> float:
    """How far the part can go on a curve guided by two tips, which was started before.

    The place ``s`` of the slider along its edge, counted from the foot of the tip that sticks, has
    ``s² = |D|² − d²``, a quadratic in time. The forces grow without bound where the line of the
    force at the slider goes through the tip that sticks, which is at a fixed place; the slip
    reverses where the tips are closest.

    Returns
    -------
    float
        The instant of the first of the two, counted from now, or infinity.
    """
    curve, slider = work.curve, guides[1]
    dx, dy, ux, uy, far = curve[10], curve[11], curve[12], curve[13], curve[14]
    mu = scene.tips[work.contact[slider, FIRST], 5]
    square, half = ux * ux + uy * uy, dx * ux + dy * uy
    closest = -half / square
    reach = closest if mu > 0.0 and closest > _START else np.inf
    lever = far - scene.tips[work.contact[slider, FIRST], 4]
    jam = -mu * lever if work.mode[slider] == SLIP_MINUS else mu * lever
    if jam * curve[15] >= 0.0:  # the place of the slider has the sign against that of the side
        return reach
    root = np.sqrt(half * half - square * (dx * dx + dy * dy - far * far - jam * jam))
    # both roots of square·t² + 2 half·t + rest, without loss of digits
    large = -half - np.copysign(root, half)
    for time in (large / square, (dx * dx + dy * dy - far * far - jam * jam) / large):
        if _START < time < reach:
            reach = time
    return float(reach)


@sealed
def _start_pivot(
    scene: Scene, curve: Floats, i: int, start: tuple[Floats, float, float], clock: float
) -> None:
    """Write where a tip that sticks is, in the world and in the part, and its velocity.

    The start is the pose now with its cosine and sine.
    """
    pose, cos, sin = start
    curve[3], curve[4], curve[5] = pose[2], scene.tips[i, 2], scene.tips[i, 3]
    curve[1] = scene.tips[i, 0] + curve[4] * clock
    curve[2] = scene.tips[i, 1] + curve[5] * clock
    curve[6], curve[7] = tip_in_body(scene, i, (pose[0], pose[1], cos, sin), clock)
    curve[16], curve[17] = cos, sin


@sealed
def fastest_turn(work: Work) -> float:
    """Largest speed of turning on the rest of a straight curve or of one that sticks."""
    kappa, sin, cos = work.curve[8], work.curve[9], work.curve[10]
    if work.curve[0] == _STRAIGHT:
        return 0.0
    # it grows until the turn is fastest, and falls from there on
    return float(kappa if abs(sin) < abs(cos) else 2.0 * kappa * abs(sin * cos))


@inlined
def fastest_between(work: Work, span: tuple[float, float]) -> float:
    """Largest speed of turning between two instants of a curve that sticks.

    With r the tangent of the half angle, which grows as exp(κ ξ), it is κ 2 r / (1 + r²): κ at r = 1.
    """
    kappa, ratio = work.curve[8], abs(work.curve[9] / work.curve[10])
    first, last = ratio * np.exp(kappa * span[0]), ratio * np.exp(kappa * span[1])
    r = last if last < 1.0 else max(first, 1.0)
    return float(2.0 * kappa / (r + 1.0 / r))


@sealed
def _leaves(
    scene: Scene, work: Work, contact: int, force: tuple[float, float, float, float], side: float
) -> float:
    """Instant at which the share of one edge of the cone falls to zero."""
    curve, edge = work.curve, scene.edges[work.contact[contact, 2]]
    mu = scene.tips[work.contact[contact, FIRST], 5]
    # A vector across the other edge of the cone, towards this one; its product with the force is
    # a multiple of the share.
    ax = -mu * edge[2] - side * edge[3]
    ay = -mu * edge[3] + side * edge[2]
    bx, by = ax * force[0] + ay * force[2], ax * force[1] + ay * force[3]
    # share = c cos θ + s sin θ with R(−θ) V = (V_x cos + V_y sin, V_y cos − V_x sin).
    c = bx * curve[4] + by * curve[5]
    s = bx * curve[5] - by * curve[4]
    kappa, sin, cos = curve[8], curve[9], curve[10]
    turning = sin * cos  # has the sign of cos ψ, hence of the turn
    if turning == 0.0 or not kappa > 0.0:
        return np.inf
    # the share grows with θ at the one of its roots, and falls with it at the other
    root = np.arctan2(-c, s) if turning < 0.0 else np.arctan2(c, -s)
    half = np.tan(0.5 * (root - curve[3]))
    ratio = (half * cos + sin) * cos / ((cos - half * sin) * sin)
    return max(np.log(ratio), 0.0) / kappa if ratio > _JUST else np.inf


@sealed
def start_cubic(work: Work, step: float, after: tuple[float, float, float]) -> None:
    """Join the present pose and the trial pose, with their slopes, by a cubic."""
    curve = work.curve
    curve[0] = CUBIC
    curve[13] = step
    for k in range(3):
        y, d = work.pose[k], work.trial[k] - work.pose[k]
        f, g = step * work.slope[0, k], step * after[k]
        curve[1 + k] = y
        curve[4 + k] = f
        curve[7 + k] = 3.0 * d - 2.0 * f - g
        curve[10 + k] = f + g - 2.0 * d


@inlined
def pose_at(work: Work, time: float) -> tuple[float, float, float]:
    """Pose (x, y, θ) on the curve at an instant counted from its start."""
    curve = work.curve
    if curve[0] == CUBIC:
        return _on_cubic(curve, time)
    if curve[0] == _STRAIGHT:
        return curve[1] + time * curve[4], curve[2] + time * curve[5], curve[3]
    sin, cos = _turn(curve, time)
    x, y, _, _ = about_pivot(curve, time, (sin, cos), (curve[6], curve[7]))
    return x, y, curve[3] + angle_of((sin, cos))


@inlined
def place_at(work: Work, time: float) -> Place:
    """Pose on the curve as (x, y, cos θ, sin θ)."""
    curve = work.curve
    if curve[0] == CUBIC:
        x, y, theta = _on_cubic(curve, time)
        return x, y, np.cos(theta), np.sin(theta)
    if curve[0] == _STRAIGHT:
        return curve[1] + time * curve[4], curve[2] + time * curve[5], curve[16], curve[17]
    return about_pivot(curve, time, _turn(curve, time), (curve[6], curve[7]))


@inlined
def _on_cubic(curve: Floats, time: float) -> tuple[float, float, float]:
    """Pose (x, y, θ) on a cubic."""
    u = time / curve[13]
    return (
        curve[1] + u * (curve[4] + u * (curve[7] + u * curve[10])),
        curve[2] + u * (curve[5] + u * (curve[8] + u * curve[11])),
        curve[3] + u * (curve[6] + u * (curve[9] + u * curve[12])),
    )


@inlined
def about_pivot(
    curve: Floats, time: float, turn: tuple[float, float], pivot: tuple[float, float]
) -> Place:
    """Pose (x, y, cos θ, sin θ) from sine and cosine of the turn and where in the part the tip is."""
    sin, cos = turn
    c, s = curve[16] * cos - curve[17] * sin, curve[17] * cos + curve[16] * sin
    x = curve[1] + time * curve[4] - (c * pivot[0] - s * pivot[1])
    y = curve[2] + time * curve[5] - (s * pivot[0] + c * pivot[1])
    return x, y, c, s


@inlined
def angle_of(turn: tuple[float, float]) -> float:
    """Angle of a turn by less than half a circle from its sine and cosine."""
    return float(2.0 * np.arctan(turn[0] / (1.0 + turn[1])))


@inlined
def _turn(curve: Floats, time: float) -> tuple[float, float]:
    """Sine and cosine of the turn from the start of a curve that turns."""
    if curve[0] == _GUIDED:
        return guided_turn(curve, time)[0]
    kappa, sin, cos = curve[8], curve[9], curve[10]
    # Difference of two half angles, without the loss of digits of a small one.
    grown = np.expm1(kappa * time)
    half = sin * cos / (1.0 / grown + sin * sin)
    whole = 1.0 + half * half
    return 2.0 * half / whole, (1.0 - half * half) / whole


@inlined
def guided_turn(
    curve: Floats, time: float
) -> tuple[tuple[float, float], tuple[float, float], float]:
    """Motion of a part that two tips hold; NaN beyond their reach.

    Returns sine and cosine of the turn from the start of the curve, the way between the tips, and
    how fast the part turns.
    """
    far, nx, ny = curve[14], curve[8], curve[9]
    dx, dy = curve[10] + time * curve[12], curve[11] + time * curve[13]
    square = dx * dx + dy * dy
    rest = curve[15] * np.sqrt(square - far * far)
    mx, my = (far * dx - rest * dy) / square, (far * dy + rest * dx) / square
    speed = (mx * curve[12] + my * curve[13]) / rest
    return (nx * my - ny * mx, nx * mx + ny * my), (dx, dy), speed
