"""Two round tips on roughly opposite edges of a part.

Generated from derivations/opposite_edges.py by `meso-robust derive`; do not edit.
Every function takes `ops`, the arithmetic to use (casadi, numpy, ...), and returns a tuple.
"""

from __future__ import annotations

from typing import Any


def width(ops: Any, q: Any, d_D: Any, d_S: Any, r_D: Any, r_S: Any, kappa: Any) -> tuple[Any, ...]:
    """Return W, m: distance of the centres of both tips across D's edge."""
    return (
        d_D - q*ops.sin(kappa) + r_D + (d_S + r_S)*ops.cos(kappa),
    )


def apart(ops: Any, h: Any, clear: Any, W: Any) -> tuple[Any, ...]:
    """Return T, m: distance of the centres of both tips along D's edge."""
    return (
        ops.sqrt(clear*(2*W + clear) + h**2),
    )


def clear(ops: Any, q: Any, d_S: Any, r_S: Any, kappa: Any, room: Any) -> tuple[Any, ...]:
    """Return V - W, m, of the distance of the tips across the travel less both radii and depths."""
    return (
        q*ops.sin(kappa) + room + (2*d_S + 2*r_S)*ops.sin((1/2)*kappa)**2,
    )


def direction(ops: Any, h: Any, V: Any, W: Any, T: Any) -> tuple[Any, ...]:
    """Return cos and sin of the direction of D's edge while both tips touch."""
    x0 = 1/(V**2 + h**2)
    return (
        x0*(T*h - V*W),
        x0*(T*V + W*h),
    )


def active_offset(ops: Any, T: Any, q: Any, d_S: Any, r_S: Any, kappa: Any) -> tuple[Any, ...]:
    """Return p_D, m: contact of D along its edge from the foot of the reference point."""
    return (
        T - q*ops.cos(kappa) - (d_S + r_S)*ops.sin(kappa),
    )


def place(ops: Any, c: Any, s: Any, q: Any, d_S: Any, r_S: Any, kappa: Any) -> tuple[Any, ...]:
    """Return x and y of the reference point minus those of the centre of S, m."""
    x0 = ops.cos(kappa)
    x1 = ops.sin(kappa)
    x2 = d_S + r_S
    x3 = q*x0 + x1*x2
    x4 = q*x1 - x0*x2
    return (
        c*x3 - s*x4,
        c*x4 + s*x3,
    )


def stick_rates(ops: Any, c: Any, s: Any, T: Any, q: Any, d_D: Any, d_S: Any, r_D: Any, r_S: Any, kappa: Any, bend: Any) -> tuple[Any, ...]:
    """Return dq/d(travel) at which D, S stick; above it the part slips towards +a over the tip."""
    x0 = ops.cos(kappa)
    x1 = ops.sin(kappa)
    x2 = d_D - q*x1 + x0*(d_S + r_S)
    x3 = bend*c + s
    return (
        (-T*(-bend*s + c) - x2*x3)/(T*x0 - x1*x2),
        -r_S*x3/(T - r_S*x1),
    )


def corner(ops: Any, c: Any, s: Any, T: Any, q: Any, d_D: Any, d_S: Any, r_D: Any, r_S: Any, kappa: Any, drag_a: Any, drag_n: Any, rho: Any, stretch: Any, shear: Any, bend: Any, tau_D: Any, tau_S: Any, total: Any) -> tuple[Any, ...]:
    """Return dq/d(travel) at friction ratios tau_D, tau_S, of the sum total; the same less that at which D, S stick."""
    x0 = ops.sin(kappa)
    x1 = shear*x0
    x2 = ops.cos(kappa)
    x3 = stretch + 1
    x4 = shear*x2
    x5 = 1 - stretch
    x6 = tau_S*x2 + x0
    x7 = -tau_S*x0 + x2
    x8 = 1/x7
    x9 = drag_a*x0 + drag_n*x2
    x10 = d_S + x9
    x11 = -tau_S*x10
    x12 = drag_a*x2 - drag_n*x0 + q
    x13 = d_S + r_S
    x14 = x13 + x9
    x15 = (total*x2 + x0*(-tau_D*tau_S + 1))/(x0*(x12*x6 - x14*x7) + x11 + x7*(T + tau_D*(d_D - drag_n)))
    x16 = -x15*x8*(x11 + x12) + x6*x8
    x17 = -(rho*x15 + x12*(x0*x3 - x16*(x1 + x2*x5) + x4))/(-x1 - x16*(-x0*x5 + x4) + x2*x3)
    x18 = x14 + x17
    x19 = -x18
    x20 = bend*c + s
    x21 = x20/(T + x0*x19)
    x22 = -bend*s + c
    x23 = (-T*x22 - x20*(d_D - q*x0 + x13*x2))/(x0*x22 + x2*x20)
    x24 = T*x21
    return (
        x19*x21,
        x24*(-x18 - x23)/(T + x0*x23),
        x24*(-x10 - x17)/(T - r_S*x0),
    )


def corner_forces(ops: Any, c: Any, s: Any, T: Any, q: Any, d_D: Any, d_S: Any, r_S: Any, kappa: Any, drag_a: Any, drag_n: Any, rho: Any, stretch: Any, shear: Any, bend: Any, mu_D: Any, mu_S: Any) -> tuple[Any, ...]:
    """Return normal force at S, at friction ratios -mu_D and mu_D, then at D, at -mu_S and mu_S, then at S if D has no friction, over e_x and travel rate, times the grip."""
    x0 = ops.cos(kappa)
    x1 = ops.sin(kappa)
    x2 = shear*x0 - x1*(1 - stretch)
    x3 = mu_D*x2
    x4 = shear*x1
    x5 = stretch + 1
    x6 = -x0*x5 + x4
    x7 = mu_D*(d_D - drag_n)
    x8 = drag_a*x0 - drag_n*x1 + q
    x9 = x0*x8
    x10 = d_S + drag_a*x1 + drag_n*x0
    x11 = x1*(r_S + x10)
    x12 = -T + x11 + x9
    x13 = x8*(-shear**2 - stretch**2 + 1)
    x14 = (bend*c + s)/T
    x15 = mu_S*x1
    x16 = -x6
    x17 = mu_S*x0
    x18 = mu_S*x10
    return (
        x14*(rho*(-x3 - x6) - x13*(-x12 - x7)),
        x14*(rho*(x0*x5 + x3 - x4) - x13*(T - x11 + x7 - x9)),
        x14*(rho*(x16*(x0 + x15) - x2*(x1 - x17)) + x13*(x18 + x8)),
        x14*(rho*(x16*(x0 - x15) - x2*(x1 + x17)) + x13*(-x18 + x8)),
        x14*(rho*x16 + x12*x13),
    )


def corner_grips(ops: Any, c: Any, s: Any, T: Any, q: Any, d_D: Any, d_S: Any, r_S: Any, kappa: Any, drag_a: Any, drag_n: Any, rho: Any, stretch: Any, shear: Any, bend: Any, mu_D: Any, mu_S: Any) -> tuple[Any, ...]:
    """Return grip, m, at the same ratios: where positive the tips cannot close on the part."""
    x0 = ops.sin(kappa)
    x1 = mu_D*mu_S
    x2 = x0*(1 - x1)
    x3 = ops.cos(kappa)
    x4 = mu_D + mu_S
    x5 = x2 - x3*x4
    x6 = drag_a*x3 - drag_n*x0 + q
    x7 = shear*x0
    x8 = 1 - stretch
    x9 = x3*x8 + x7
    x10 = mu_S*x0
    x11 = x10 + x3
    x12 = 1/x11
    x13 = d_S + drag_a*x0 + drag_n*x3
    x14 = mu_S*x13
    x15 = x12*(x14 + x6)
    x16 = x15*x5
    x17 = mu_S*x3
    x18 = x0 - x17
    x19 = x12*x18
    x20 = shear*x3
    x21 = stretch + 1
    x22 = x0*x21 + x20
    x23 = -x19*x9 + x22
    x24 = mu_D*(d_D - drag_n)
    x25 = T - x24
    x26 = r_S + x13
    x27 = x0*(-x11*x26 + x18*x6) + x14
    x28 = x11*x25 + x27
    x29 = -x0*x8 + x20
    x30 = -x21*x3 + x7
    x31 = -x19*x29 - x30
    x32 = x16*x29 + x28*x31
    x33 = x0/T
    x34 = mu_D - mu_S
    x35 = x0*(x1 + 1)
    x36 = -x3*x34 + x35
    x37 = -x10 + x3
    x38 = 1/x37
    x39 = -x14
    x40 = x38*(x39 + x6)
    x41 = x36*x40
    x42 = x0 + x17
    x43 = x38*x42
    x44 = x22 - x43*x9
    x45 = x0*(-x26*x37 + x42*x6) + x39
    x46 = x25*x37 + x45
    x47 = -x29*x43 - x30
    x48 = x29*x41 + x46*x47
    x49 = x3*x34 + x35
    x50 = x15*x49
    x51 = T + x24
    x52 = x11*x51 + x27
    x53 = x29*x50 + x31*x52
    x54 = x2 + x3*x4
    x55 = x40*x54
    x56 = x37*x51 + x45
    x57 = x29*x55 + x47*x56
    return (
        x32 + x33*(rho*x5 - x26*x32 + x6*(x16*x9 + x23*x28)),
        x33*(rho*x36 - x26*x48 + x6*(x41*x9 + x44*x46)) + x48,
        x33*(rho*x49 - x26*x53 + x6*(x23*x52 + x50*x9)) + x53,
        x33*(rho*x54 - x26*x57 + x6*(x44*x56 + x55*x9)) + x57,
    )


def stiffness(ops: Any, p_D: Any, d_D: Any, drag_a: Any, drag_n: Any, rho: Any, stretch: Any, shear: Any, tau: Any) -> tuple[Any, ...]:
    """Return m^2: positive where D alone, at friction ratio tau, presses if it advances."""
    return (
        -rho*(-shear*tau - stretch - 1) + (-drag_a + p_D)*(-drag_a + p_D + tau*(d_D - drag_n))*(-shear**2 - stretch**2 + 1),
    )


def pressing(ops: Any, c: Any, s: Any, p_D: Any, d_D: Any, drag_a: Any, drag_n: Any, rho: Any, stretch: Any, shear: Any, bend: Any) -> tuple[Any, ...]:
    """Return m^2: positive where D alone presses if it sticks; what the slip grows by per ratio."""
    x0 = bend*c + s
    x1 = d_D - drag_n
    x2 = -shear**2 - stretch**2 + 1
    return (
        rho*x0*(1 - stretch) + x0*x1**2*x2 + (-bend*s + c)*(rho*shear + x1*x2*(-drag_a + p_D)),
    )


def slip_alone(ops: Any, c: Any, s: Any, p_D: Any, d_D: Any, drag_a: Any, drag_n: Any, rho: Any, stretch: Any, shear: Any, bend: Any) -> tuple[Any, ...]:
    """Return m^2: slip towards +a of the part over D that pushes alone without friction, per travel, times the stiffness."""
    x0 = bend*c + s
    x1 = -drag_a + p_D
    x2 = -shear**2 - stretch**2 + 1
    return (
        rho*shear*x0 + x0*x1*x2*(d_D - drag_n) + (-bend*s + c)*(-rho*(-stretch - 1) + x1**2*x2),
    )


def stick_ratio(ops: Any, c: Any, s: Any, p_D: Any, d_D: Any, drag_a: Any, drag_n: Any, rho: Any, stretch: Any, shear: Any, bend: Any) -> tuple[Any, ...]:
    """Return friction ratio at which D alone sticks."""
    x0 = bend*c + s
    x1 = d_D - drag_n
    x2 = -shear**2 - stretch**2 + 1
    x3 = -bend*s + c
    x4 = rho*shear
    x5 = -drag_a + p_D
    x6 = x1*x2*x5
    return (
        (-x0*x4 - x0*x6 - x3*(-rho*(-stretch - 1) + x2*x5**2))/(rho*x0*(1 - stretch) + x0*x1**2*x2 + x3*(x4 + x6)),
    )


def gap_per_turn(ops: Any, c: Any, s: Any, p_D: Any, V: Any, gap: Any, d_D: Any, d_S: Any, r_D: Any, r_S: Any, kappa: Any, drag_a: Any, drag_n: Any, rho: Any, stretch: Any, shear: Any, tau: Any) -> tuple[Any, ...]:
    """Return how much S's edge closes on S per turn while D alone pushes at friction ratio tau, m."""
    x0 = -drag_a + p_D + tau*(d_D - drag_n)
    x1 = -shear**2 - stretch**2 + 1
    x2 = ops.sin(kappa)
    x3 = ops.cos(kappa)
    x4 = 1/(c*x2 + s*x3)
    x5 = d_S + gap + r_S
    x6 = -V - c*(d_D + r_D + x3*x5) + s*(p_D + x2*x5)
    x7 = x0*x1
    return (
        (-x2*(rho*(shear + tau*(1 - stretch)) + x7*(-d_S*x3 - drag_n - x2*x4*x6)) - x3*(rho*(-shear*tau - stretch - 1) - x7*(-d_S*x2 - drag_a + x3*x4*x6)))/(x0*x1),
    )


def gap_per_rolling(ops: Any, c: Any, s: Any, p_D: Any, V: Any, gap: Any, d_D: Any, d_S: Any, r_D: Any, r_S: Any, kappa: Any, drag_a: Any, drag_n: Any, rho: Any, stretch: Any, shear: Any, bend: Any) -> tuple[Any, ...]:
    """Return the same while the contact of D sticks, m."""
    x0 = ops.cos(kappa)
    x1 = ops.sin(kappa)
    x2 = 1/(c*x1 + s*x0)
    x3 = d_S + gap + r_S
    x4 = -V - c*(d_D + r_D + x0*x3) + s*(p_D + x1*x3)
    x5 = bend*c + s
    x6 = bend*s - c
    x7 = -x5
    x8 = d_D**2
    x9 = drag_a**2
    x10 = drag_n**2
    x11 = p_D**2
    x12 = 2*d_D
    x13 = drag_n*x12
    x14 = 2*drag_a
    x15 = p_D*x14
    x16 = shear*x14
    x17 = p_D*shear
    return (
        x0*(-d_S*x1 - p_D + x0*x2*x4) - x1*(-d_D - d_S*x0 - x1*x2*x4) + (x0*x5 - x1*x6)*(d_D*x16 - drag_n*x16 + 2*drag_n*x17 + rho + stretch*x10 - stretch*x11 - stretch*x13 + stretch*x15 + stretch*x8 - stretch*x9 + x10 + x11 - x12*x17 - x13 - x15 + x8 + x9)/((d_D - drag_n)*(shear*x7 + x6*(stretch + 1)) - (-drag_a + p_D)*(shear*x6 + x7*(1 - stretch))),
    )


def turn_rolling(ops: Any, c: Any, s: Any, p_D: Any, d_D: Any, drag_a: Any, drag_n: Any, rho: Any, stretch: Any, shear: Any, bend: Any) -> tuple[Any, ...]:
    """Return turn per travel while D alone pushes and its contact sticks, rad/m."""
    x0 = -bend*c - s
    x1 = bend*s - c
    x2 = d_D**2
    x3 = drag_a**2
    x4 = drag_n**2
    x5 = p_D**2
    x6 = 2*d_D
    x7 = drag_n*x6
    x8 = 2*drag_a
    x9 = p_D*x8
    x10 = shear*x8
    x11 = p_D*shear
    return (
        ((d_D - drag_n)*(shear*x0 + x1*(stretch + 1)) - (-drag_a + p_D)*(shear*x1 + x0*(1 - stretch)))/(d_D*x10 - drag_n*x10 + 2*drag_n*x11 + rho + stretch*x2 - stretch*x3 + stretch*x4 - stretch*x5 - stretch*x7 + stretch*x9 - x11*x6 + x2 + x3 + x4 + x5 - x7 - x9),
    )


def creep_per_turn(ops: Any, c: Any, s: Any, p_D: Any, d_D: Any, r_D: Any, drag_a: Any, drag_n: Any, rho: Any, stretch: Any, shear: Any, bend: Any, tau: Any) -> tuple[Any, ...]:
    """Return change of p_D per turn while D alone pushes at friction ratio tau, m; the lever by which it turns the part, positive where it does so counter-clockwise, m."""
    x0 = bend*c + s
    x1 = d_D - drag_n
    x2 = -drag_a + p_D + tau*x1
    x3 = -shear**2 - stretch**2 + 1
    x4 = x0*x2*x3
    return (
        (-r_D*x4 - rho*x0*(shear + tau*(1 - stretch)) - x1*x4 - (-bend*s + c)*(-rho*(-shear*tau - stretch - 1) + x2*x3*(-drag_a + p_D)))/(x0*x2*x3),
        x2,
    )


def passive_place(ops: Any, c: Any, s: Any, p_D: Any, V: Any, gap: Any, d_D: Any, d_S: Any, r_D: Any, r_S: Any, kappa: Any) -> tuple[Any, ...]:
    """Return q and T, m, while S's edge is gap away from S and D touches at p_D."""
    x0 = ops.sin(kappa)
    x1 = ops.cos(kappa)
    x2 = d_S + gap + r_S
    x3 = p_D + x0*x2
    x4 = (-V - c*(d_D + r_D + x1*x2) + s*x3)/(c*x0 + s*x1)
    return (
        -x4,
        -x1*x4 + x3,
    )


def no_jam(ops: Any, V: Any, width: Any, radii: Any, mu: Any) -> tuple[Any, ...]:
    """Return m: positive where two tips on parallel edges, of radii that add up to radii, cannot jam the part; mu is the smaller one of both tips."""
    x0 = mu**2 + 1
    return (
        V*ops.sqrt(x0) - radii - width*x0,
    )
