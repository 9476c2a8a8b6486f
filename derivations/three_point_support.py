"""The part on three frictional support points (Section V, eq. 1; Section VI, Table I).

The supports carry the weight; each resists sliding with at most ``mu_s`` times its load. The probe
is a Coulomb contact with coefficient ``mu`` (printed ``mu_t``). All statements about motions are
about the complete conditions: balance, friction of three supports that slide or rest, and the
probe that sticks, slips either way or is apart.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import sympy as sp
from sympy.logic.boolalg import Boolean

from derivations._claim import Claim
from derivations._derivation import Derivation
from derivations._statement import (
    Finding,
    Point,
    angle,
    as_written,
    combined,
    for_all,
    identity,
    there_is,
    together,
)
from derivations._tex import tex
from derivations.invariances import (
    TWIST,
    Contact,
    contact,
    k,
    k_force,
    k_speed,
    law_is_a_cone,
    math,
    placed,
    rotation,
)
from derivations.mechanics import a, cross, d1, d2, mu, n, rho, theta, v_p, velocity_at, wrench
from derivations.one_point_sticking import F

W, mu_s = sp.symbols("W mu_s", positive=True)
q_xx, q_xy, q_yy, epsilon, delta = sp.symbols("q_xx q_xy q_yy epsilon delta", real=True)
HALF_LONG, HALF_SHORT, THICKNESS = sp.Integer(808), sp.Rational(837, 2), sp.Integer(40)
Table = tuple[tuple[str, str], ...]
TABLE_I: dict[str, tuple[Table, str, str]] = {
    "p_1^*": ((("411.3", "-563.3"), ("-409.1", "605.9"), ("-273.2", "-102.1")), "0.666", "0.757"),
    "p_2^*": ((("-412.4", "794.0"), ("-217.8", "774.5"), ("278.8", "-538.8")), "0.536", "0.013"),
}
"""Printed: places of the supports from the centre in µm, mu_t, mu_s."""


class Support(NamedTuple):
    """One support point."""

    place: sp.Matrix
    load: sp.Symbol
    force: sp.Matrix


def support(j: int) -> Support:
    """Support number ``j``, all data free."""
    x, y, load, f_x, f_y = sp.symbols(f"x_{j} y_{j} N_{j} f_x{j} f_y{j}", real=True)
    return Support(sp.Matrix([x, y]), load, sp.Matrix([f_x, f_y]))


SUPPORTS = (support(1), support(2), support(3))


def friction(force: sp.Matrix, velocity: sp.Matrix, limit: sp.Expr) -> Boolean:
    """Coulomb's law of a support: at rest any force up to ``limit``, sliding the full one against it."""
    size = force.dot(force)
    rests = sp.And(*(sp.Eq(entry, 0) for entry in velocity))
    opposes = sp.And(
        sp.Eq(cross(force, velocity), 0), force.dot(velocity) <= 0, sp.Eq(size, limit**2)
    )
    return sp.And(limit >= 0, size <= limit**2, sp.Or(rests, opposes))


def loads_balance(height: sp.Expr) -> list[sp.Expr]:
    """Out-of-plane rows: vertical forces, and moments about the two axes in the support plane.

    The weight acts in the centre, friction in the support plane, the push ``(P_x, P_y)`` in a
    horizontal plane ``height`` above it.
    """
    P_x, P_y, p_x, p_y, z_c = sp.symbols("P_x P_y p_x p_y z_c", real=True)
    forces = [((0, 0, z_c), (0, 0, -W)), ((p_x, p_y, height), (P_x, P_y, 0))]
    forces += [((*one.place, 0), (*one.force, one.load)) for one in SUPPORTS]
    total = sum((sp.Matrix(force) for _, force in forces), sp.zeros(3, 1))
    moment = sum((sp.Matrix(at).cross(sp.Matrix(f)) for at, f in forces), sp.zeros(3, 1))
    return [sp.expand(row) for row in (total[2], moment[0], moment[1])]


def areas() -> tuple[sp.Expr, list[sp.Expr]]:
    """Twice the signed area of the triangle, and of its three parts seen from the centre."""
    first, second, third = (one.place for one in SUPPORTS)
    parts = [cross(second, third), cross(third, first), cross(first, second)]
    return sp.expand(sum(parts)), parts


def load_identities(rows: Sequence[sp.Expr]) -> Finding:
    """``S N_i = W S_i`` as a combination of the balance rows: no other loads balance."""
    area, parts = areas()
    places = [one.place for one in SUPPORTS]
    left, right = [], []
    for j, one in enumerate(SUPPORTS):
        p, q = places[(j + 1) % 3], places[(j + 2) % 3]
        left.append(area * one.load - W * parts[j])
        right.append(parts[j] * rows[0] + (q[0] - p[0]) * rows[1] + (q[1] - p[1]) * rows[2])
    return identity(
        r"$S N_i - W S_i$ is a combination of the three balance rows, so the loads satisfy "
        r"$S N_i = W S_i$ ($S$ twice the area of the triangle, $S_i$ of centre and the other two)",
        left,
        right,
    )


def _loads(at: Point | None = None) -> dict[sp.Symbol, sp.Expr]:
    """The loads that balance the weight."""
    area, parts = areas()
    found = {one.load: W * part / area for one, part in zip(SUPPORTS, parts, strict=True)}
    return {load: value.subs(at or {}) for load, value in found.items()}


def derive() -> Derivation:
    """Loads, friction, invariances and Table I of the three-point support."""
    return Derivation(
        name="three_point_support",
        summary="The three-point support model of Sections V and VI.",
        claims=(
            _balance_of_equation_1(),
            _columns(),
            _support_loads(),
            _hull(),
            _centre_of_friction(),
            _maximum_dissipation(),
            _linearised(),
            _complete_conditions(),
            _mu_s(),
            _rate(),
            _not_unique(),
            _straight_push(),
            _table_1(),
            _table_1_margin(),
        ),
    )


# equation 1


def _columns_from_power() -> tuple[Finding, ...]:
    """Columns of W_n and W_f: what force . velocity is in terms of the twist."""
    arm = sp.Matrix(sp.symbols("x y", real=True))
    force = sp.Matrix(sp.symbols("f_x f_y", real=True))
    lifting = sp.Symbol("N", real=True)
    planar = velocity_at(TWIST, arm)
    power = force.dot(planar)
    return (
        identity(
            "the power of a force at a point of the part is its column $(f_x, f_y, x f_y - y f_x)$ "
            "times the twist, for every force, point and twist",
            [sp.Derivative(power, entry) for entry in TWIST],
            list(wrench(force, arm)),
        ),
        identity(
            "the vertical load of a support does no work on a planar twist: its column is zero",
            sp.MatMul(sp.Matrix([[0, 0, lifting]]), sp.Matrix([*planar, 0])),
            sp.Integer(0),
        ),
    )


def _inertia_of_the_part() -> Finding:
    """Virtual power of the inertia of a rectangular part, integrated over it."""
    x, y, m, length, width = sp.symbols("x y m l w", positive=True)
    t, omega = sp.symbols("t omega", real=True)
    rates = sp.symbols("a_x a_y alpha", real=True)
    trial = sp.Matrix(sp.symbols("u_x u_y u_omega", real=True))
    pose = [sp.Function(name)(t) for name in ("X", "Y", "q")]
    arm = rotation(pose[2]) * sp.Matrix([x, y])
    moved = sp.Matrix(pose[:2]) + arm
    power = sp.diff(moved, t, 2).dot(velocity_at(trial, arm)) * m / (length * width)
    swap = [(sp.diff(entry, t, 2), rate) for entry, rate in zip(pose, rates, strict=True)]
    here = power.subs([*swap, (sp.diff(pose[2], t), omega), (pose[2], theta)])
    over_x = sp.integrate(sp.expand(here), (x, -length / 2, length / 2))
    total = sp.expand(sp.integrate(sp.expand(over_x), (y, -width / 2, width / 2)))
    return identity(
        r"the inertia that (1) leaves out is exactly $(m a_x, m a_y, I\alpha)$ with "
        r"$I = m(l^2 + w^2)/12$, at every angular velocity",
        [sp.diff(total, entry) for entry in trial],
        [m * rates[0], m * rates[1], m * (length**2 + width**2) / 12 * rates[2]],
    )


def _balance_of_equation_1() -> Claim:
    """Equation (1)."""
    return Claim(
        key="equation-1",
        title="Eq. (1): the quasi-static balance",
        place="eq. (1), Section V-A",
        printed=r"$0 = W_n \lambda_n^{l+1} + W_f \lambda_f^{l+1} + F_{ext}$",
        derived=r"The wrench of a force $f$ at $(x, y)$ from the centre is $(f_x, f_y, x f_y - y "
        r"f_x)$; loads of supports have zero columns in the plane and enter through friction only. "
        r"The exact balance has $(m a_x, m a_y, I\alpha)$ on the left: (1) is it with inertia left "
        "out, which the text justifies by its size (checked under the printed numbers).",
        steps=(
            r"Power of a contact force: $f \cdot (v + \omega \times r)$. It is linear in the "
            "twist; its three coefficients are the column.",
            r"A point of the part accelerates with $a + \alpha \times r - \omega^2 r$. Its virtual "
            "power, integrated over the rectangle, is the left side.",
        ),
        hypotheses=("inertia left out (the paper's quasi-static assumption)",),
        of_print=_columns_from_power(),
        sharper=(_inertia_of_the_part(),),
    )


def _columns() -> Claim:
    """The number of columns of W_f."""
    n_c, n_s, n_d = sp.symbols("n_c n_s n_d", positive=True)
    each, printed = n_d * (n_c + n_s), 2 * n_c + n_d * n_s
    return Claim(
        key="friction-columns",
        title="Columns of the friction matrix",
        place="under eq. (2), Section V-A",
        printed=r"$W_f \in \mathbb{R}^{n_\nu \times (2n_c + n_d n_s)}$ “with the friction cone "
        r"linearized into $n_d$ directions for each contact”",
        derived=r"$n_d$ directions for each contact would be $n_d(n_c + n_s)$ columns. The printed "
        r"size is right for $n_d$ directions at each support and the two senses of sliding at each "
        "pushing contact, whose friction acts along the edge only.",
        steps=(r"$n_d(n_c + n_s) - (2 n_c + n_d n_s) = n_c (n_d - 2)$.",),
        hypotheses=(
            r"$n_c \ge 1$ and $n_d \ge 3$: fewer directions do not span the friction of a support",
        ),
        consistent=(
            together(
                r"$n_d$ directions for each contact make $2n_c + n_d n_s$ columns",
                sp.Eq(each, printed),
                n_d >= 3,
            ),
        ),
        checks=(
            identity("the two numbers differ by $n_c (n_d - 2)$", each - printed, n_c * (n_d - 2)),
        ),
    )


# loads of the supports


def _support_loads() -> Claim:
    """Existence and uniqueness of the loads."""
    rows = loads_balance(sp.Integer(0))
    other = sp.symbols("M_1:4", real=True)
    swap = {one.load: load for one, load in zip(SUPPORTS, other, strict=True)}
    both = [sp.Eq(r, 0) for row in rows for r in (row, row.subs(swap))]
    same = sp.And(*(sp.Eq(load, swap[load]) for load in swap))
    third, half = sp.Rational(1, 3), sp.Rational(1, 2)
    places = [e for one in SUPPORTS for e in one.place]
    line = dict(zip(places, (-400, 0, 0, 0, 400, 0), strict=True))
    line |= {W: 1, **dict.fromkeys(swap, third), **dict(zip(other, (half, 0, half), strict=True))}
    return Claim(
        key="support-loads",
        title="Loads of three supports from the out-of-plane balance",
        place="Section V-A",
        printed="With three point contacts “the normal force distribution can be found based on a "
        "out-of-plane force balance”",
        derived=r"$N_i = W S_i/S$: the share of the weight is the share of the triangle's area "
        "opposite to the support, as seen from the centre of mass. The loads are unique exactly "
        "because the three points do not lie on a line.",
        steps=(
            f"Vertical forces and moments about two axes: {', '.join(tex(row) for row in rows)} "
            "all vanish.",
            r"Three linear equations with determinant $\pm S$, twice the area of the triangle.",
        ),
        hypotheses=(
            "the push acts at the height of the support plane or its tipping moment is neglected; "
            "the probe exerts no vertical force",
            "the three points do not lie on a line",
        ),
        added=("the three points do not lie on a line",),
        of_print=(
            for_all(
                "two sets of loads that balance the weight are equal (µm)", both, same, at=line
            ),
        ),
        with_added=(load_identities(rows),),
    )


def _hull() -> Claim:
    """The centre of mass in the convex hull."""
    area, part, load = sp.symbols("S S_i N_i", real=True)
    known = [sp.Eq(area * load, W * part), sp.Ne(area, 0)]
    return Claim(
        key="support-hull",
        title="Supports around the centre of mass",
        place="Section VI",
        printed="“their convex hull must include the part's center-of-mass so that the appropriate "
        "normal force at each support point can be calculated”",
        derived="All three loads press upwards if and only if the centre of mass is in the "
        "triangle, and strictly so if and only if it is strictly inside. On an edge the opposite "
        "support is idle; outside, a support would have to pull.",
        steps=(
            r"$S N_i = W S_i$. The centre is on the inner side of the edge opposite to support $i$ "
            r"exactly if $S_i$ has the sign of $S$.",
        ),
        hypotheses=("the three points do not lie on a line",),
        of_print=(
            load_identities(loads_balance(sp.Integer(0))),
            for_all(
                "a load that presses: the centre is on the inner side of the edge",
                [*known, load >= 0],
                area * part >= 0,
            ),
            for_all(
                "the centre on the inner side of the edge: the load presses",
                [*known, area * part >= 0],
                load >= 0,
            ),
        ),
        sharper=(
            for_all(
                "a load above 0: strictly on the inner side", [*known, load > 0], area * part > 0
            ),
            for_all(
                "strictly on the inner side: a load above 0", [*known, area * part > 0], load > 0
            ),
        ),
    )


def _centre_of_friction() -> Claim:
    """Weighted mean of the supports, with the height of the push."""
    h, P_x, P_y = sp.symbols("h P_x P_y", real=True)
    weighted = sum((one.load * one.place for one in SUPPORTS), sp.zeros(2, 1))
    rows = loads_balance(h)
    f, u, limit = (
        sp.symbols("f_x f_y", real=True),
        sp.symbols("u_x u_y", real=True),
        sp.Symbol("L", positive=True),
    )
    limits = [_table_limits(name) for name in TABLE_I]
    inside, shifted = (
        " and ".join(f"{float(x):.2f}" for x in xs) for xs in zip(*limits, strict=True)
    )
    return Claim(
        key="centre-of-friction",
        title="The centre of friction is the centre of mass, up to the height of the push",
        place="new; bears on the support points of Section VI and on the centre of friction of [39]",
        derived=r"The mean of the supports weighted with their loads is the centre of mass for every "
        r"triangle. If the probe pushes with $P$ at a height $h$ above the slide, it is $hP/W$ "
        rf"from it, at most $\mu_s h$. The part is 40 µm thick: up to {shifted} µm for the two sets of "
        rf"Table I, whose triangles hold the centre of mass by {inside} µm.",
        steps=(
            r"Moments about the two axes in the support plane: $\sum N_i r_i = h P$.",
            r"$P = -\sum f_i$ and $|f_i| \le \mu_s N_i$, so $|P| \le \mu_s W$.",
        ),
        hypotheses=("no vertical force at the probe", "quasi-static"),
        checks=(
            identity(
                r"$N_i = W S_i / S$ gives $\sum N_i r_i = 0$",
                list(weighted.subs(_loads())),
                [sp.Integer(0), sp.Integer(0)],
            ),
            identity(
                r"with the push at height $h$ the moment rows are $\sum N_i r_i = hP$",
                [-rows[2], rows[1]],
                combined(*((one.load, one.place) for one in SUPPORTS), (-h, sp.Matrix([P_x, P_y]))),
            ),
            for_all(
                r"a force of size at most $L$ has at most $L$ in every direction; summed over the "
                r"supports: $|P| \le \mu_s W$",
                [f[0] ** 2 + f[1] ** 2 <= limit**2, sp.Eq(u[0] ** 2 + u[1] ** 2, 1)],
                sp.Matrix(f).dot(sp.Matrix(u)) <= limit,
            ),
        ),
    )


# friction of a support


def _maximum_dissipation() -> Claim:
    """Coulomb friction of a support as the maximiser of the dissipation."""
    force, trial = (sp.Matrix(sp.symbols(f"{x}_x {x}_y", real=True)) for x in "fg")
    velocity = sp.Matrix(sp.symbols("v_x v_y", real=True))
    limit, speed = sp.symbols("L s", positive=True)
    best = -limit * velocity / speed
    unit = sp.Eq(velocity.dot(velocity), speed**2)
    inside = [force.dot(force) <= limit**2]
    return Claim(
        key="support-maximum-dissipation",
        title="Support friction is the force of maximum dissipation",
        place="new; the friction law behind Section V-A",
        derived=r"Among all forces with $|f| \le \mu_s N$ the one that dissipates most, $-f\cdot v$, "
        r"is $-\mu_s N\, v/|v|$, and no other if $v \ne 0$; at rest every force of the disc is "
        "allowed. This is what the model means by Coulomb friction of a support.",
        steps=(
            r"$-f \cdot v \le |f||v| \le \mu_s N |v|$ (Cauchy–Schwarz: $|f|^2|v|^2 - (f\cdot v)^2 = "
            r"(f \times v)^2$), with equality only for $f$ against $v$ and of full size.",
        ),
        checks=(
            identity(
                r"$|f|^2|v|^2 - (f \cdot v)^2 = (f \times v)^2$",
                force.dot(force) * velocity.dot(velocity) - force.dot(velocity) ** 2,
                cross(force, velocity) ** 2,
            ),
            for_all(
                "Coulomb's law of a support: no force of the disc dissipates more",
                [friction(force, velocity, limit), trial.dot(trial) <= limit**2],
                force.dot(velocity) <= trial.dot(velocity),
            ),
            for_all(
                r"a force of the disc that dissipates as much as $-L v/|v|$ is that force",
                [*inside, unit, -force.dot(velocity) >= limit * speed],
                sp.And(*(sp.Eq(speed * (p - q), 0) for p, q in zip(force, best, strict=True))),
            ),
            for_all(
                r"$-L v/|v|$ obeys Coulomb's law of a support",
                [unit, *(sp.Eq(speed * (p - q), 0) for p, q in zip(force, best, strict=True))],
                friction(force, velocity, limit),
            ),
        ),
    )


def _linearised() -> Claim:
    """Four directions in place of the disc."""
    u = sp.symbols("u_x u_y", real=True)
    unit = sp.Eq(u[0] ** 2 + u[1] ** 2, 1)
    corners = [(1, 0), (0, 1), (-1, 0), (0, -1)]
    work = [-(x * u[0] + y * u[1]) for x, y in corners]  # per unit of limit and speed
    slanted = {u[0]: sp.Rational(3, 5), u[1]: sp.Rational(4, 5)}
    off = sp.deg(sp.acos(sp.Rational(4, 5))).evalf(4)
    return Claim(
        key="linearised-support-friction",
        title="What linearising the friction of a support costs",
        place="new; the linearisation into $n_d$ directions under eq. (2)",
        derived=r"With $n_d$ equally spaced directions a sliding support resists in the nearest of "
        r"them: up to $180°/n_d$ off the direction of sliding, and with $\cos(180°/n_d)$ of the "
        r"dissipation. For $n_d = 4$: 45° and 0.71. The model then depends on how the "
        "directions are laid: it is no longer the same in every orientation.",
        steps=(
            "Maximum dissipation over the polygon is attained at a corner, the one nearest to the "
            "direction against the sliding.",
            rf"Sliding along $(3/5, 4/5)$: the force is along $(0, -1)$, {off}° off.",
        ),
        checks=(
            for_all(
                r"$n_d = 4$: the best corner dissipates at least $1/\sqrt{2}$ of the full friction",
                [unit],
                sp.Or(*(sp.And(w > 0, 2 * w**2 >= 1) for w in work)),
            ),
            for_all("and at most all of it", [unit], sp.And(*(w <= 1 for w in work))),
            there_is(
                "sliding along (3/5, 4/5) the corner (0, -1) dissipates most",
                [work[3] > work[j] for j in range(3)],
                slanted,
            ),
        ),
    )


# the complete conditions and their invariances


def quantities(twist: sp.Matrix, probe: Contact) -> tuple[list[sp.Expr], list[sp.Expr]]:
    """In-plane balance; and all speeds: of the three supports, slip and opening at the probe."""
    pushes = [wrench(one.force, one.place) for one in SUPPORTS]
    balance = sum(pushes, probe.push())
    speeds = [entry for one in SUPPORTS for entry in velocity_at(twist, one.place)]
    return list(balance), [*speeds, probe.slip(twist), probe.opening(twist)]


def conditions(probe: Contact, at: Point) -> list[Boolean]:
    """All conditions on a twist and on the forces, with the numbers of ``at`` put in."""
    here = placed(probe, at)
    rows = [*loads_balance(sp.Integer(0)), *quantities(TWIST, here)[0]]
    found = [sp.Eq(row.subs(at), 0) for row in rows]
    for one in SUPPORTS:
        limit = (mu_s * one.load).subs(at)
        found.append(friction(one.force, velocity_at(TWIST, one.place.subs(at)), limit))
    return [*found, *here.motion(TWIST)]


def _friction_is_a_cone() -> Finding:
    """The law of a support under scaled forces and speeds."""
    force, velocity = (sp.Matrix(sp.symbols(f"{x}_x {x}_y", real=True)) for x in "fv")
    limit = sp.Symbol("L", real=True)
    return for_all(
        r"Coulomb's law of a support, sliding or at rest, stays true when its force and its limit "
        r"$\mu_s N$ are multiplied by $k_f > 0$ and its velocity by $k_v > 0$ (and back)",
        [friction(force, velocity, limit)],
        friction(k_force * force, k_speed * velocity, k_force * limit),
    )


def _carried(
    what: str, change: dict[sp.Symbol, sp.Expr], forces: sp.Expr, speeds: sp.Expr
) -> Finding:
    """Whether a change multiplies the balance and all speeds as said."""
    balance, moves = before = quantities(TWIST, contact("0"))
    after = [entry.subs(change, simultaneous=True) for part in before for entry in part]
    return identity(what, after, [*(forces * e for e in balance), *(speeds * e for e in moves)])


def _all_forces() -> dict[sp.Symbol, sp.Expr]:
    """Every in-plane force times k."""
    probe = contact("0")
    entries = [probe.normal, probe.tangential, *(f for one in SUPPORTS for f in one.force)]
    return {entry: k * entry for entry in entries}


TRIANGLE = ((0, -600), (-240, 100), (280, 360))
"""Places in µm with rational distances from the first: a turn about it has exact speeds."""


def _placed(triangle: Sequence[tuple[sp.Expr, sp.Expr]]) -> dict[sp.Symbol, sp.Expr]:
    """Places and loads of three supports, weight 1."""
    at = {
        e: sp.sympify(v)
        for one, p in zip(SUPPORTS, triangle, strict=True)
        for e, v in zip(one.place, p, strict=True)
    }
    return {
        **at,
        W: sp.Integer(1),
        **{load: value.subs(W, 1) for load, value in _loads(at).items()},
    }


def _probe(tip: sp.Matrix) -> Contact:
    """The probe on the long edge."""
    return Contact(d2 * a + d1 * n, a, n, tip, *sp.symbols("lambda_n lambda_t", real=True))


def _motion(probe: Contact, at: Point, twist: tuple[int, int, int], *closed: sp.Expr) -> Point:
    """All numbers of a motion with a given twist; a support that rests takes what is left over."""
    at = {**at, **dict(zip(TWIST, map(sp.Integer, twist), strict=True))}
    unknown = [probe.normal, probe.tangential]
    for one in SUPPORTS:
        velocity = velocity_at(TWIST, one.place).subs(at)
        speed = sp.sqrt(velocity.dot(velocity))
        if speed == 0:
            unknown += list(one.force)
        else:
            force = -mu_s.subs(at) * one.load.subs(at) * velocity / speed
            at |= dict(zip(one.force, force, strict=True))
    rows = [entry.subs(at) for entry in (*quantities(TWIST, probe)[0], *closed)]
    (solution,) = sp.solve(rows, unknown, dict=True)
    moves = (probe.slip(TWIST), probe.opening(TWIST))
    at |= {
        **solution,
        **{name: move.subs(at) for name, move in zip(probe.speeds(), moves, strict=True)},
    }
    return at


def _fixed(at: Point) -> dict[sp.Expr, sp.Expr]:
    """The data of a witness without twist, forces and speeds."""
    return {
        name: value for name, value in at.items() if name in _DATA or name.func in (sp.cos, sp.sin)
    }


_DATA = {d1, d2, mu, mu_s, W, v_p, *(e for one in SUPPORTS for e in (*one.place, one.load))}


def _straight(triangle: Sequence[tuple[sp.Expr, sp.Expr]], coefficient: sp.Expr) -> Point:
    """A push through the centre of an upright edge: the part translates."""
    at = {
        **_placed(triangle),
        mu_s: coefficient,
        mu: sp.Rational(1, 3),
        d1: HALF_SHORT,
        d2: sp.Integer(0),
    }
    at |= {v_p: sp.Integer(-1), **angle(1, theta)}
    return _motion(_probe(sp.Matrix([v_p, 0])), at, (-1, 0, 0))


def _pivoting() -> Point:
    """A push that slips along the edge while the part turns about a support that rests."""
    at = {**_placed(TRIANGLE), mu_s: sp.Rational(757, 1000), mu: sp.Rational(1, 3)}
    at |= {d1: HALF_SHORT, d2: sp.Integer(500), v_p: sp.Integer(-1100), **angle(1, theta)}
    probe = _probe(sp.Matrix([v_p, 0]))
    return _motion(probe, at, (-600, 0, 1), probe.tangential + mu * probe.normal)


def _complete_conditions() -> Claim:
    """Exact motions that satisfy everything."""
    probe = _probe(sp.Matrix([v_p, 0]))
    straight, pivot = _straight(TRIANGLE, sp.Rational(757, 1000)), _pivoting()
    away = _probe(-sp.Matrix([v_p, 0]))
    apart = {**straight, away.speeds()[1]: sp.Integer(1)}
    still = (*TWIST, probe.normal, probe.tangential, *(f for one in SUPPORTS for f in one.force))
    apart |= dict.fromkeys(still, sp.Integer(0))
    return Claim(
        key="three-point-conditions",
        title="The complete conditions of the three-point model have motions",
        place="new; what the invariances of the three-point model are statements about",
        derived=r"A motion is a twist with loads and forces such that the loads balance the weight, "
        r"in-plane forces balance, every support obeys its friction law with limit $\mu_s N_i$, and "
        "the probe obeys Coulomb's law with unilateral contact. Shown by exact motions: all "
        "supports slide and the probe sticks; one support rests and the probe slips; the probe "
        "leaves and all rest.",
        steps=(
            "A twist fixes the friction of every sliding support; the balance then gives the "
            "force of the probe and of a support at rest.",
            rf"Supports in µm: {TRIANGLE}; the turn is about the first of them.",
        ),
        checks=(
            there_is("translation, sticking", conditions(probe, _fixed(straight)), straight),
            there_is(
                "turning about the first support, slipping", conditions(probe, _fixed(pivot)), pivot
            ),
            there_is("the probe leaves, all rests", conditions(away, _fixed(apart)), apart),
        ),
    )


def _mu_s() -> Claim:
    """The coefficient of the support does not move the part."""
    values = {name: sp.Rational(row[2]) for name, row in TABLE_I.items()}
    probe = _probe(sp.Matrix([v_p, 0]))
    large = _pivoting()
    small = _scaled(large, values["p_2^*"] / values["p_1^*"])
    weight = {one.load: k * one.load for one in SUPPORTS} | {W: k * W}
    rows = loads_balance(sp.Integer(0))
    return Claim(
        key="mu-s-has-no-effect",
        title=r"$\mu_s$ and the weight have no effect on the path",
        place="Section VI-2",
        printed=r"“in simulation the value of $\mu_s$ has minimal affect on the trajectory of the part”",
        derived=r"The effect is exactly none: a motion under $\mu_s$ is a motion under every other "
        r"$\mu_s > 0$, with all in-plane forces multiplied by the same factor; likewise for the "
        r"weight. $\mu_s$ and $W$ enter through the product $\mu_s W$ only, and that cancels. So "
        r"$\mu_s$ cannot be estimated from paths (the two estimates of Table I differ by a factor "
        rf"of {float(values['p_1^*'] / values['p_2^*']):.0f}), and at most seven of the eight "
        "parameters can matter.",
        steps=(
            r"Multiply $\mu_s$, all $f_i$ and the probe's $\lambda$ by $k$: the balance is multiplied "
            "by $k$, all velocities stay.",
            r"Friction laws compare a force with its own limit (support) or two forces with each "
            "other (probe): both are kept, in every mode.",
        ),
        hypotheses=(
            "no other in-plane force: the slide is level and nothing but probe and supports acts "
            r"($F_{ext} = 0$ in the plane)",
            r"the push acts at the height of the support plane (else loads depend on $\mu_s h$, see "
            "the centre of friction)",
        ),
        of_print=(
            there_is(
                r"the motion with one support at rest (see the complete conditions) has the same twist "
                r"under $\mu_s = 0.013$ as under $0.757$",
                [*conditions(probe, _fixed(small)), *(sp.Eq(e, large[e]) for e in TWIST)],
                small,
            ),
        ),
        sharper=(
            _carried(
                r"in-plane forces times $k$: balance times $k$, velocities, slip and opening "
                "unchanged",
                _all_forces(),
                k,
                sp.Integer(1),
            ),
            _friction_is_a_cone(),
            law_is_a_cone(),
            identity(
                "weight and loads times $k$: the out-of-plane balance times $k$",
                [row.subs(weight, simultaneous=True) for row in rows],
                [k * row for row in rows],
            ),
        ),
        checks=(_rest_under(),),
    )  # fmt: skip


def _scaled(at: Point, factor: sp.Expr) -> Point:
    """The same motion with mu_s and all in-plane forces times a factor."""
    probe = _probe(sp.zeros(2, 1))
    forces = [mu_s, probe.normal, probe.tangential, *(f for one in SUPPORTS for f in one.force)]
    return {**at, **{force: factor * at[force] for force in forces}}


def _rest_under() -> Finding:
    """Why the hypothesis of no other in-plane force is needed."""
    pull = sp.Symbol("G", positive=True)
    loads = [one.load for one in SUPPORTS]
    along = [one.force[0] for one in SUPPORTS]
    within = [f >= -mu_s * load for f, load in zip(along, loads, strict=True)]
    return for_all(
        r"with an in-plane force $G$ the part can rest only if $G \le \mu_s W$: there $\mu_s$ matters",
        [sp.Eq(sum(loads), W), sp.Eq(sum(along) + pull, 0), *within],
        pull <= mu_s * W,
    )


def _rate() -> Claim:
    """Rate independence."""
    probe = contact("0")
    speeds = {entry: k * entry for entry in (*TWIST, *probe.tip)}
    return Claim(
        key="rate-three-points",
        title="The path on three supports does not depend on the speed of the push",
        place="new; bears on the three probe speeds of Section V",
        derived=r"Multiply the velocity of the probe by any $k > 0$: the twist is multiplied by $k$, "
        "all forces stay the same, the path is the same. (On the film the forces grow with $k$, the "
        "path is the same too.) So no path distinguishes speeds in either model.",
        steps=(
            "The balance contains forces only; all speeds are linear in twist and tip velocity.",
            "Friction laws look at directions and signs of velocities, not at their size.",
        ),
        checks=(
            _carried(
                r"tip velocity and twist times $k$: balance unchanged, all speeds times $k$",
                speeds,
                sp.Integer(1),
                k,
            ),
            _friction_is_a_cone(),
            law_is_a_cone(),
        ),
    )


# what the support points do, and what they do not


def _translation_wrench() -> Finding:
    """Friction of any three supports in a translation."""
    u = sp.Matrix([sp.cos(theta), sp.sin(theta)])
    pushes = [wrench(-mu_s * one.load * u, one.place) for one in SUPPORTS]
    total = sum(pushes, sp.zeros(3, 1)).subs(_loads())
    return identity(
        r"in a translation along $u$ the friction of any three supports is $-\mu_s W u$ through the "
        "centre of mass, without moment",
        list(total),
        [*(-mu_s * W * u), sp.Integer(0)],
    )


def _printed_triangle(name: str) -> list[tuple[sp.Rational, sp.Rational]]:
    return [(sp.Rational(x), sp.Rational(y)) for x, y in TABLE_I[name][0]]


def _radius(name: str) -> sp.Expr:
    """Mean distance of the supports from the centre, weighted with the loads."""
    at = _placed(_printed_triangle(name))
    return sum(
        at[one.load] * sp.sqrt(one.place.subs(at).dot(one.place.subs(at))) for one in SUPPORTS
    )


def _straight_balance() -> Finding:
    """The probe balances the friction of any three supports in a straight push."""
    probe = _probe(sp.zeros(2, 1))
    loads = _loads()
    pushes = [wrench(-mu_s * one.load * sp.Matrix([-1, 0]), one.place) for one in SUPPORTS]
    centred = {probe.normal: mu_s * W, probe.tangential: 0, d2: 0, theta: sp.pi / 2}
    total = sum(pushes, probe.push().subs(centred)).subs(loads)
    return identity(
        r"a straight push with $\lambda_n = \mu_s W$, $\lambda_t = 0$ at the middle of an upright "
        "edge balances the friction of any three supports that slide along $-x$",
        list(total),
        [sp.Integer(0)] * 3,
    )


def _not_unique() -> Claim:
    """The same trajectory from different triangles."""
    radii = {name: _radius(name) for name in TABLE_I}
    shown = " and ".join(rf"{float(r):.0f} µm for ${name}$" for name, r in radii.items())
    first, second = radii.values()
    names = sp.symbols("R_1 R_2 gap", positive=True)
    return Claim(
        key="support-points-not-unique",
        title="Different support points, same path",
        place="Section VI-2, Note",
        printed="“the solution for the support point locations are not unique, i.e., the same "
        "trajectory can be solved for using different sets of support points”",
        derived="A sticking push through the centre of mass translates the part for every triangle "
        "around it: this path says nothing about the supports. Other pushes do: the friction moment "
        r"of a turn about the centre is $\mu_s W$ times the mean distance of the supports, and that "
        rf"is {shown}.",
        steps=(
            r"In a translation all supports slide in one direction: $\sum f_i = -\mu_s W u$, and its "
            r"moment is that of $\sum N_i r_i = 0$.",
            "The probe's force through the centre balances it, with any share of the three.",
        ),
        hypotheses=("for the printed sentence: the path of a straight push",),
        of_print=(_translation_wrench(), _straight_balance()),
        checks=(
            there_is(
                "the mean distances of the two sets of Table I differ by more than 27 µm",
                [sp.Eq(names[1], names[0] + names[2]), names[2] > 27],
                dict(zip(names, (first, second, second - first), strict=True)),
            ),
        ),
    )


def _mean(expression: sp.Expr, x: sp.Symbol, y: sp.Symbol) -> sp.Expr:
    """Sum over the supports of load times a polynomial of the place; centre of mass at 0."""
    moments = {
        (0, 0): W,
        (1, 0): 0,
        (0, 1): 0,
        (2, 0): q_xx * W,
        (1, 1): q_xy * W,
        (0, 2): q_yy * W,
    }
    terms = sp.Poly(sp.expand(expression), x, y).terms()
    return sum(factor * moments[power] for power, factor in terms)


def near_the_straight_push() -> tuple[sp.Expr, sp.Expr]:
    """Turn per travel, and slope of the probe's force, to first order in the deviation.

    The edge is off upright by ``t epsilon``, the contact off the centre by ``t delta``.
    """
    t = sp.Symbol("t", positive=True)
    x, y = sp.symbols("x y", real=True)
    drift, force = sp.symbols("u_x u_y u_omega", real=True), sp.symbols("P_x P_y", real=True)
    twist = sp.Matrix([v_p, 0, 0]) + t * sp.Matrix(drift)
    velocity = velocity_at(twist, sp.Matrix([x, y]))
    speed = sp.sqrt(velocity.dot(velocity))
    each = wrench(-mu_s * velocity / speed, sp.Matrix([x, y]))
    arm = (d2 * a + d1 * n).subs({theta: sp.pi / 2 + t * epsilon, d2: t * delta})
    push = wrench(sp.Matrix([-mu_s * W, 0]) + t * sp.Matrix(force), arm)
    held = velocity_at(twist, arm)  # the tip's velocity does not change
    rows = [
        _mean(sp.diff(p, t).subs(t, 0), x, y) + sp.diff(q, t).subs(t, 0)
        for p, q in zip(each, push, strict=True)
    ]
    rows += [sp.diff(entry, t).subs(t, 0) for entry in held]
    (solution,) = sp.solve(rows, [*drift, *force], dict=True)
    return sp.factor(solution[drift[2]] / -v_p), sp.factor(solution[force[1]] / (-mu_s * W))


def _second_moment(name: str) -> sp.Expr:
    """Mean square distance of the supports across the long axis, weighted with the loads."""
    at = _placed(_printed_triangle(name))
    return sum(at[one.load] * one.place[0].subs(at) ** 2 for one in SUPPORTS)


def _growth(moment: sp.Expr) -> float:
    """Growth of a deviation over the 700 µm of a test push on the long edge."""
    return float(sp.exp(HALF_SHORT * 700 / (moment + HALF_SHORT**2)))


def _straight_push() -> Claim:
    """The straight push is unstable, and how strongly."""
    rate, slope = near_the_straight_push()
    start = float(sp.deg(5 / HALF_SHORT)) + 0.005
    shown = ", ".join(rf"{_growth(_second_moment(name)):.2f} for ${name}$" for name in TABLE_I)
    on_film = (d2 * sp.sin(theta) - d1 * sp.cos(theta)) / F
    t = sp.Symbol("t", positive=True)
    deviating = on_film.subs({theta: sp.pi / 2 + t * epsilon, d2: t * delta})
    film = sp.Subs(sp.Derivative(deviating, t), t, 0)
    most = _growth(sp.Integer(0))
    return Claim(
        key="straight-push-is-unstable",
        title="The straight push through the centre",
        place="Section VI-1",
        printed="“A horizontal push directly at the center-of-mass of the part should intuitively "
        "result in a pure translation […] In general, small perturbations from this starting "
        "configuration will yield either clockwise or counterclockwise rotations”",
        derived=r"To first order in the tilt $\epsilon$ of the edge and the offset $\delta$ of the "
        rf"contact, $d\theta/d\xi = {math(rate)}$ with $q_{{xx}} = \sum N_i x_i^2/W$: the deviation "
        r"$\epsilon + \delta/d_1$ grows as $\exp(d_1\xi/(q_{xx} + d_1^2))$ for every triangle, and "
        r"in the same way on a film, with $\rho$ for $q_{xx}$. Over 700 µm on the long edge the "
        rf"factor is {shown}, {_growth(sp.Integer(376_900)):.2f} on the film, and never above "
        rf"{most:.1f}: errors of 5 µm and 0.005° ({start:.2f}° together) turn the part by at most "
        rf"{start * (most - 1):.1f}° on any three supports.",
        steps=(
            "Expand the friction of a sliding support and the sticking contact to first order about "
            r"the translation; sums over the supports are $\sum N_i = W$, $\sum N_i r_i = 0$ and "
            r"$\sum N_i x_i^2$.",
            rf"The probe's force gets the slope {tex(slope)}, of first order like the tilt of the edge, "
            r"so the contact sticks for every $\mu_t > 0$.",
        ),
        hypotheses=("first order in the deviation; the probe pushes along $-x$",),
        of_print=(
            _translation_wrench(),
            for_all(
                "tilt and offset to one side turn the part further to that side",
                [epsilon > 0, delta > 0, q_xx >= 0],
                rate > 0,
            ),
        ),
        sharper=(
            identity(
                r"$d\theta/d\xi = (d_1 \epsilon + \delta)/(q_{xx} + d_1^2)$",
                as_written(lambda: rate * (q_xx + d1**2)),
                d1 * epsilon + delta,
            ),
            identity(r"on the film $q_{xx}$ becomes $\rho$", film, sp.Subs(rate, q_xx, rho)),
        ),
    )


# Table I


def _table_point(name: str) -> Point:
    """Places, loads (weight 1) and coefficients of one printed set."""
    _, mu_t, coefficient = TABLE_I[name]
    return {
        **_placed(_printed_triangle(name)),
        mu: sp.Rational(mu_t),
        mu_s: sp.Rational(coefficient),
    }


def _table_limits(name: str) -> tuple[sp.Expr, sp.Expr]:
    """Distance of the centre of mass from the nearest edge; shift of friction by the push's height."""
    at = _placed(_printed_triangle(name))
    places = [one.place.subs(at) for one in SUPPORTS]
    edges = [q - p for p, q in zip(places[1:] + places[:1], places[2:] + places[:2], strict=True)]
    _, parts = areas()
    gaps = [abs(part.subs(at)) / sp.sqrt(e.dot(e)) for part, e in zip(parts, edges, strict=True)]
    return sp.Min(*gaps), sp.Rational(TABLE_I[name][2]) * THICKNESS


def _inside(half_x: sp.Expr, half_y: sp.Expr) -> list[Boolean]:
    """All supports under the part."""
    places = [one.place for one in SUPPORTS]
    return [abs(p[j]) <= half for p in places for j, half in ((0, half_x), (1, half_y))]


def _table_1() -> Claim:
    """Both printed sets against the printed constraints."""
    loads = [one.load > 0 for one in SUPPORTS]
    coefficients = [mu >= 0, mu <= 1, mu_s >= 0, mu_s <= 1]
    points = {name: _table_point(name) for name in TABLE_I}
    gaps = {name: _table_limits(name)[0] for name in TABLE_I}
    shares = {name: min(float(points[name][one.load]) for one in SUPPORTS) for name in TABLE_I}
    across = sp.And(*_inside(HALF_LONG, HALF_SHORT))
    return Claim(
        key="table-1",
        title="Table I: are the estimated supports valid",
        place="Table I, Section VI",
        printed=r"$p_1^*$ and $p_2^*$ of Table I, with supports that “lie within the dimensions of "
        r"the part”, a hull that includes the centre of mass, and coefficients in $[0, 1]$",
        derived="Both sets are valid, with the first printed coordinate along the short axis. The "
        "centre of mass is "
        + " and ".join(
            rf"{float(gap):.3g} µm inside the nearest edge of the triangle of ${name}$ (least load "
            rf"{100 * shares[name]:.2g} % of the weight)"
            for name, gap in gaps.items()
        )
        + ".",
        steps=(
            r"$N_i/W = S_i/S$ in exact arithmetic from the printed digits; the distance from an edge "
            r"is $S_i$ over the length of the edge.",
            "With the first coordinate along the long axis a support would lie outside the part.",
        ),
        of_print=tuple(
            there_is(
                rf"${name}$: under the part, all loads positive, coefficients in range",
                [*_inside(HALF_SHORT, HALF_LONG), *loads, *coefficients],
                points[name],
            )
            for name in TABLE_I
        ),
        sharper=(
            there_is(
                r"$p_2^*$: the second support bears less than 0.35 % of the weight",
                [SUPPORTS[1].load > 0, 10_000 * SUPPORTS[1].load < 35],
                points["p_2^*"],
            ),
        ),
        checks=tuple(
            there_is(
                rf"${name}$ does not fit under the part with the axes exchanged",
                [sp.Not(across)],
                points[name],
            )
            for name in TABLE_I
        ),
    )


def _table_1_margin() -> Claim:
    """The second printed set against its own stated uncertainty."""
    x, y = sp.Integer(2), SUPPORTS[2].place
    moved = _printed_triangle("p_2^*")
    moved[2] = (moved[2][0] + x, moved[2][1])
    at = _placed(moved)
    printed = _printed_triangle("p_2^*")[2]
    gap, shift = _table_limits("p_2^*")
    return Claim(
        key="table-1-uncertainty",
        title=r"$p_2^*$ is not valid within its own uncertainty",
        place="new; Table I and “set to 10 µm” (Section VI-2)",
        derived=r"Moving one support of $p_2^*$ by 2 µm, a fifth of the stated uncertainty of 10 µm, "
        "puts the centre of mass outside the triangle: a support would have to pull and the model "
        rf"has no loads. The margin is {float(gap):.2f} µm; the height of the push alone can use "
        rf"{float(shift):.2f} µm of it.",
        steps=(
            r"$N_2 = W S_2/S$ with $S_2$ the cross product of the third and the first support: it "
            "changes sign when the third moves by 2 µm along the short axis.",
        ),
        checks=(
            there_is(
                "third support 2 µm further out: the second load is negative",
                [SUPPORTS[1].load < 0, abs(y[0] - printed[0]) <= 10, sp.Eq(y[1], printed[1])],
                at,
            ),
            there_is(
                "the loads of the witness balance the weight",
                [sp.Eq(row, 0) for row in loads_balance(sp.Integer(0))],
                at,
            ),
        ),
    )
