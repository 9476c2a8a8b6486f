r"""Motions in a form that gives the pose at any instant: straight, sticking, or a Hermite cubic.

One sticking contact: with ``V`` the velocity of the tip, ``p`` the point of contact in the body
frame and ``j = (p_y, −p_x, 1)`` the twist of a unit turn about it, the velocity of the part is
``(R(−θ) V, 0) + ω j``. The film has no moment about ``p``, ``j · E v = 0``, hence
``ω = h · R(−θ) V`` with the constant ``h = −(E j)_{1,2} / (j · E j)``. With κ = |h| |V| and ψ the
angle from the direction where the turn is fastest, ``dψ/dξ = κ cos ψ``, whose solution is

    tan(ψ/2 + π/4) = tan(ψ₀/2 + π/4) exp(κ ξ).

For E = diag(1, 1, ρ) this is ``dθ/dξ = r_y/(ρ + R²)`` of Gauss's law for a pushed rod.
"""

import numpy as np

from meso_robust.kernels import sealed as inner
from meso_robust.simulator.events.contact import Place, tip_in_body
from meso_robust.simulator.events.scene import FIRST, Scene, Work

_STRAIGHT, _STICKING, _CUBIC = 0.0, 1.0, 2.0
_JUST = 0.999  # a ratio of tangents below one is that of a root just passed, or of none


@inner
def start_straight(work: Work) -> None:
    """Let the part go on with its present twist, without a turn."""
    curve = work.curve
    curve[0] = _STRAIGHT
    cos, sin = np.cos(work.pose[2]), np.sin(work.pose[2])
    for k in range(3):
        curve[1 + k] = work.pose[k]
    curve[4] = cos * work.twist[0] - sin * work.twist[1]
    curve[5] = sin * work.twist[0] + cos * work.twist[1]


@inner
def start_sticking(scene: Scene, work: Work, contact: int, clock: float) -> float:
    """Let the part turn about a tip that sticks.

    Returns
    -------
    float
        The instant, counted from now, at which the force leaves the friction cone.
    """
    curve, pose, i = work.curve, work.pose, work.contact[contact, FIRST]
    cos, sin = np.cos(pose[2]), np.sin(pose[2])
    px, py = tip_in_body(scene, i, (pose[0], pose[1], cos, sin), clock)
    drag, vx, vy = work.drag, scene.tips[i, 2], scene.tips[i, 3]
    ex = drag[0, 0] * py - drag[0, 1] * px + drag[0, 2]
    ey = drag[1, 0] * py - drag[1, 1] * px + drag[1, 2]
    ez = drag[2, 0] * py - drag[2, 1] * px + drag[2, 2]
    whole = py * ex - px * ey + ez
    hx, hy = -ex / whole, -ey / whole
    kappa = np.hypot(hx, hy) * np.hypot(vx, vy)
    psi = pose[2] - np.arctan2(vy, vx) + np.arctan2(hy, hx)
    half = 0.5 * psi + 0.25 * np.pi
    curve[0], curve[3] = _STICKING, pose[2]
    curve[1] = scene.tips[i, 0] + vx * clock
    curve[2] = scene.tips[i, 1] + vy * clock
    curve[4], curve[5], curve[6], curve[7] = vx, vy, px, py
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


@inner
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
    kappa, ratio0 = curve[8], curve[9] / curve[10]
    turning = curve[9] * curve[10]  # has the sign of cos ψ
    root = np.arctan2(-c, s)
    best = np.inf
    for k in range(2):
        theta = root + k * np.pi
        falling = (s * np.cos(theta) - c * np.sin(theta)) * turning < 0.0
        ratio = np.tan(0.5 * (theta - curve[3]) + np.arctan2(curve[9], curve[10])) / ratio0
        if falling and ratio > _JUST and kappa > 0.0:
            best = min(best, max(np.log(ratio), 0.0) / kappa)
    return best


@inner
def start_cubic(work: Work, step: float, after: tuple[float, float, float]) -> None:
    """Join the present pose and the trial pose, with their slopes, by a cubic."""
    curve = work.curve
    curve[0] = _CUBIC
    curve[13] = step
    for k in range(3):
        y, d = work.pose[k], work.trial[k] - work.pose[k]
        f, g = step * work.slope[0, k], step * after[k]
        curve[1 + k] = y
        curve[4 + k] = f
        curve[7 + k] = 3.0 * d - 2.0 * f - g
        curve[10 + k] = f + g - 2.0 * d


@inner
def pose_at(work: Work, time: float) -> tuple[float, float, float]:
    """Pose (x, y, θ) on the curve at an instant counted from its start."""
    curve = work.curve
    if curve[0] == _CUBIC:
        u = time / curve[13]
        return (
            curve[1] + u * (curve[4] + u * (curve[7] + u * curve[10])),
            curve[2] + u * (curve[5] + u * (curve[8] + u * curve[11])),
            curve[3] + u * (curve[6] + u * (curve[9] + u * curve[12])),
        )
    if curve[0] == _STRAIGHT:
        return curve[1] + time * curve[4], curve[2] + time * curve[5], curve[3]
    growth = np.exp(curve[8] * time)
    # Difference of two arctangents, without the loss of digits of a small one.
    sin, cos = curve[9], curve[10]
    turn = 2.0 * np.arctan2(sin * cos * np.expm1(curve[8] * time), cos * cos + sin * sin * growth)
    theta = curve[3] + turn
    c, s = np.cos(theta), np.sin(theta)
    x = curve[1] + time * curve[4] - (c * curve[6] - s * curve[7])
    y = curve[2] + time * curve[5] - (s * curve[6] + c * curve[7])
    return x, y, theta


@inner
def place_at(work: Work, time: float) -> Place:
    """Pose on the curve as (x, y, cos θ, sin θ)."""
    x, y, theta = pose_at(work, time)
    return x, y, np.cos(theta), np.sin(theta)
