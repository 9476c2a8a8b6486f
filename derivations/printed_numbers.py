"""Arithmetic of what is printed: units, sizes, tables and comparisons.

A printed decimal stands for every value that rounds to it; contradictions below are contradictions
of all of them. SI units unless a name says otherwise (``_um``, ``_mm``).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import sympy as sp
from sympy.logic.boolalg import Boolean

from derivations._claim import Claim
from derivations._derivation import Derivation
from derivations._statement import (
    DerivationError,
    Finding,
    angle,
    for_all,
    identity,
    there_is,
    together,
)
from derivations.invariances import TWIST, contact
from derivations.mechanics import coulomb, e_x, film, rho

MICRO = sp.Rational(1, 10**6)
LONG_UM, SHORT_UM, THICK_UM = sp.Integer(1616), sp.Integer(837), sp.Integer(40)
DRAG, TURNING_DRAG = "160.89", "60.64"
SPEEDS_UM = (sp.Integer(140), sp.Integer(75), sp.Rational(74, 10))
DENSITY = sp.Integer(8250)
"""kg/m^3, beryllium copper: from handbooks, not printed."""
GRAVITY = sp.Rational(981, 100)
MASS = DENSITY * LONG_UM * SHORT_UM * THICK_UM * MICRO**3
force, travel, turn = sp.symbols("force travel turn", real=True)
psi = sp.Symbol("psi", real=True)
NEEDED = LONG_UM * sp.sin(psi) + SHORT_UM * sp.cos(psi)
"""Extent of the part across a slot at the tilt psi, 0 to 90°, in µm."""
e_th, length, width = sp.symbols("e_theta l w", positive=True)
PART = {length: LONG_UM * MICRO, width: SHORT_UM * MICRO}
LARGEST_RHO = (length**2 + width**2) / 4
"""Square of the half diagonal; a uniform film has a third of it."""
PI = (sp.Rational(314_159, 100_000), sp.Rational(31_416, 10_000))
"""Rational bounds of pi; checked in :func:`_degrees`."""


def rounded(quantity: sp.Expr, printed: str) -> Boolean:
    """That a quantity rounds to a printed decimal."""
    digits = len(printed.partition(".")[2])
    half = sp.Rational(1, 2 * 10**digits)
    value = sp.Rational(printed)
    return sp.And(quantity >= value - half, quantity <= value + half)


def _degrees(value: sp.Expr) -> sp.Expr:
    """Radians that are surely less than so many degrees.

    Raises
    ------
    DerivationError
        If the bounds of pi are wrong.
    """
    if not PI[0] < sp.pi < PI[1]:
        raise DerivationError(f"no bounds of pi: {PI}")
    return sp.sympify(value) * PI[0] / 180


def derive() -> Derivation:
    """Compare what is printed with itself."""
    return Derivation(
        name="printed_numbers",
        summary="Printed numbers, compared with each other.",
        claims=(
            _turn_limit(),
            _film_units(),
            _film_force(),
            _unit_repair(),
            _film_not_uniform(),
            _inertia(),
            _dry_friction(),
            _playpen(),
            _playpen_room(),
            _thickness(),
            _pixels(),
            _orientation_error(),
            _speeds(),
            _slot_clearance(),
            _goal_and_slot(),
            _corner_pushes(),
            _table_2(),
            *_tables(),
            _gain_of_table_3(),
            _errors_of_table_3(),
            _margins_of_table_5(),
            _tests_1_and_2(),
        ),
    )


# the film


def _power() -> tuple[Finding, ...]:
    """Power of the contacts, in every mode."""
    pair = (contact("1"), contact("2"))
    work, parts = [], []
    for one in pair:
        pushed = -one.out * one.normal + one.along * one.tangential
        work.append(one.push().dot(TWIST) - pushed.dot(one.tip))
        parts.append(one.normal * one.opening(TWIST) + one.tangential * one.slip(TWIST))
    normal, shear, slip, opening = sp.symbols("lambda_n lambda_t slip opening", real=True)
    return (
        identity(
            r"power of a contact on the part: force times tip velocity, plus $\lambda_n$ times "
            r"opening plus $\lambda_t$ times slip",
            work,
            parts,
        ),
        for_all(
            "the latter two are never positive, in every mode of Coulomb's law",
            coulomb(normal, shear, slip, opening),
            normal * opening + shear * slip <= 0,
        ),
        identity(
            r"the film takes $e_x (v^2 + \rho\omega^2)$",
            [film(TWIST).dot(TWIST)],
            [e_x * (TWIST[0] ** 2 + TWIST[1] ** 2 + rho * TWIST[2] ** 2)],
        ),
    )


def most_turn(travel_um: sp.Expr, rho_um2: sp.Expr) -> float:
    """Largest turn for a travel of the tip, in degrees."""
    return float(sp.deg(travel_um / (2 * sp.sqrt(rho_um2))))


def _turn_limit() -> Claim:
    """No push turns the part faster than 1/(2 sqrt(rho)) per travel."""
    x, y, w = TWIST
    slack = -x - x**2 - y**2 - rho * w**2  # unit tip speed along -x
    ratio = sp.Symbol("rho_mm", positive=True)
    R = sp.Symbol("R", positive=True)
    printed_rho = sp.Integer(376_900)
    least = float(2 * sp.sqrt(printed_rho) * sp.pi / 4)
    shown = " and ".join(
        f"{most_turn(sp.Integer(t), printed_rho):.1f}° in {t} µm" for t in (600, 700)
    )
    return Claim(
        key="turn-limit",
        title="How far a push can turn the part at most",
        place="new; bears on “a translation of about 600 µm” and “a 45° rotation” (Section X-A)",
        derived=r"On a film, tips that all move alike turn the part by at most $1/(2\sqrt{\rho})$ per "
        r"unit of travel, whatever the shape, the contacts, their modes and $\mu$. With $\rho = "
        rf"0.3769$ mm²: {shown}; 45° needs at least {least:.0f} µm. With the "
        "paper's own fit the 45° rotation cannot belong to a push of 600 µm, nor to one of the 700 µm "
        "of Section VI.",
        steps=(
            r"Contacts give the part at most the power of their forces at the tip velocity $u$, "
            r"$\sum f_i \cdot u = e_x v \cdot u$: friction and separation only take.",
            r"So $|v|^2 + \rho\omega^2 \le v \cdot u$. With $|u| = 1$ along $-x$: $1 - 4\rho\omega^2 = "
            r"(1 + 2 v_x)^2 + 4 v_y^2 + 4(-v_x - |v|^2 - \rho\omega^2) \ge 0$.",
            r"One sticking contact with $R^2 = \rho$, pushed square to $r$, attains it.",
        ),
        hypotheses=("all touching tips move with the same velocity (no resting probe)",),
        checks=(
            *_power(),
            identity(
                r"$1 - 4\rho\omega^2$ is a sum of squares and four times the power left over",
                1 - 4 * rho * w**2,
                (1 + 2 * x) ** 2 + 4 * y**2 + 4 * slack,
            ),
            identity(
                "attained at $R^2 = \\rho$",
                sp.Subs(R / (rho + R**2), R, sp.sqrt(rho)),
                1 / (2 * sp.sqrt(rho)),
            ),
            for_all(
                r"45° (from 44.5° on) at $\rho = 0.3769$ mm² needs more than 953 µm",
                [
                    rounded(ratio, "0.3769"),
                    turn >= _degrees(sp.Rational(89, 2)),
                    4 * ratio * turn**2 <= travel**2,
                    travel >= 0,
                ],
                travel > sp.Rational(953, 1000),
            ),
        ),
    )


def _as_printed(drag: sp.Symbol) -> list[Boolean]:
    """Printed constants, with the printed units."""
    return [rounded(drag, DRAG), rounded(e_th, TURNING_DRAG)]


def _part() -> list[Boolean]:
    """Printed sides of the part in metres."""
    return [rounded(length / MICRO, "1616"), rounded(width / MICRO, "837")]


def _film_bounds() -> tuple[Finding, ...]:
    """Rho of a film under the part: at most the largest r^2; a uniform one by integration."""
    x, y = sp.symbols("x y", real=True)
    under = [x <= length / 2, -x <= length / 2, y <= width / 2, -y <= width / 2]
    square = x**2 + y**2
    over = (x, -length / 2, length / 2), (y, -width / 2, width / 2)
    return (
        for_all(
            r"everywhere under the part $r^2 \le (l^2 + w^2)/4$, so $e_\theta = \int k r^2 \le e_x "
            r"(l^2 + w^2)/4$ for every density $k \ge 0$ of drag",
            under,
            square <= LARGEST_RHO,
        ),
        identity(
            r"a uniform film has $\rho = (l^2 + w^2)/12$",
            sp.Integral(square, *over) / (length * width),
            LARGEST_RHO / 3,
        ),
    )


def _film_units() -> Claim:
    """The printed units of e_theta."""
    ratio = sp.Rational(TURNING_DRAG) / sp.Rational(DRAG)
    most = LARGEST_RHO.subs(PART)
    view = sp.Integer(3370)
    little = most_turn(view * MICRO, ratio)
    times = f"{round(float(ratio / most), -3):,.0f}".replace(",", " ")
    return Claim(
        key="film-units",
        title=r"Units of $e_x$ and $e_\theta$",
        place="Section X-A",
        printed=r"$e_x = e_y = 160.89$ N·s/m and $e_\theta = 60.64$ N·m·s, for a part of 1616 µm × "
        "837 µm",
        derived=rf"$\rho = e_\theta/e_x = {float(ratio):.4f}$ m² is {times} times "
        r"what a film under this part can have, $\rho \le (l^2 + w^2)/4 = "
        rf"{float(most / MICRO):.3f}$ mm². A push across the whole field of view would turn the part "
        rf"by less than {little:.2f}°. Read as mm² the number {float(ratio):.4f} makes sense.",
        steps=(
            r"$e_x = \int k\,dA$ and $e_\theta = \int k r^2 dA$ for a film of density $k \ge 0$.",
            r"A push turns by at most its travel over $2\sqrt{\rho}$ (see the turn limit).",
        ),
        consistent=(
            together(
                r"the printed constants fit a film under a part of the printed size",
                *_as_printed(e_x),
                *_part(),
                e_th <= LARGEST_RHO * e_x,
            ),
            together(
                "with them, a push across the field of view (3.37 mm) turns the part by 45°",
                *_as_printed(e_x),
                rounded(travel * 1000, "3.37"),
                turn >= _degrees(sp.Rational(89, 2)),
                4 * e_th * turn**2 <= e_x * travel**2,
            ),
        ),
        checks=_film_bounds(),
    )


def _film_force() -> Claim:
    """The printed unit of e_x against the printed size of forces."""
    shown = ", ".join(f"{float(sp.Rational(DRAG) * v / 1000):.3g}" for v in SPEEDS_UM)
    speed = sp.Symbol("speed", positive=True)
    return Claim(
        key="film-force",
        title="Forces that the printed drag means",
        place="Section X-A against Sections I and V",
        printed=r"$e_x = 160.89$ N·s/m; probe speeds 140, 75 and 7.4 µm/s; “the frictional forces are "
        "on the order of micro-newtons”, “the micronewton level (0–50 µN range)”",
        derived=rf"Pushing straight takes $e_x |v_p|$: {shown} mN at the three speeds. Even the "
        "slowest is more than twenty times the stated range.",
        steps=(r"A part that moves with the tip is resisted with $e_x v_p$.",),
        consistent=(
            together(
                "a straight push at one of the printed speeds takes at most 50 µN",
                rounded(e_x, DRAG),
                sp.Or(*(sp.Eq(speed, v * MICRO) for v in SPEEDS_UM)),
                sp.Eq(force, e_x * speed),
                force <= 50 * MICRO,
            ),
        ),
    )


def _unit_repair() -> Claim:
    """Which units make the printed constants fit."""
    unit_f, unit_l = sp.symbols("unit_force unit_length", positive=True)
    choices = [sp.Integer(1), sp.Rational(1, 1000), MICRO]
    one_of = [sp.Or(*(sp.Eq(unit, one) for one in choices)) for unit in (unit_f, unit_l)]
    drag, ratio = sp.Rational(DRAG), sp.Rational(TURNING_DRAG) / sp.Rational(DRAG)
    most = LARGEST_RHO.subs(PART)
    # the two factors are written out: force in unit_f, 1/length in 1/unit_l
    drags = [drag * unit_f * v * MICRO for v in SPEEDS_UM]  # times 1/unit_l
    fits = [
        *(d >= MICRO / 10 * unit_l for d in drags),
        *(d <= 50 * MICRO * unit_l for d in drags),
        ratio * unit_l**2 <= most,
        ratio * unit_l**2 >= most / 30,
    ]
    good = {unit_f: MICRO, unit_l: sp.Rational(1, 1000)}
    shown = ", ".join(f"{float(d.subs(good) * 1000 / MICRO):.3g}" for d in drags)
    film_um = sp.Rational(2, 10) * LONG_UM * SHORT_UM * MICRO**2 / (drag / 1000) / MICRO
    return Claim(
        key="film-unit-repair",
        title="Units in which the printed film constants make sense",
        place="new; Section X-A",
        derived=r"Of all combinations of N, mN, µN with m, mm, µm only (µN, mm) fits the size of the "
        r"part and the stated forces: $e_x = 160.89$ µN·s/mm and $e_\theta = 60.64$ µN·mm·s. Then "
        rf"$\rho = {float(ratio):.4f}$ mm² and the drag at the three speeds is {shown} µN.",
        steps=(
            r"$e_x$ is in force·time/length, $e_\theta$ in force·length·time; their ratio is in the "
            "square of the unit of length.",
            r"Asked of a unit: drag between 0.1 and 50 µN at all three speeds, and $\rho$ between a "
            rf"tenth of that of a uniform film, {float(most / MICRO / 30):.4f} mm², and the largest "
            rf"possible, {float(most / MICRO):.4f} mm².",
            rf"Plausible too: a film of an oil of 0.2 Pa·s (assumed) would be {float(film_um):.1f} µm "
            "thick; with the printed units a thousandth of that.",
        ),
        checks=(
            there_is(r"(µN, mm) fits", [*one_of, *fits], good),
            for_all(
                "no other of the nine combinations does",
                [*one_of, *fits],
                sp.And(*(sp.Eq(unit, value) for unit, value in good.items())),
            ),
        ),
    )


def _film_not_uniform() -> Claim:
    """Rho against a uniform film."""
    ratio = sp.Rational(TURNING_DRAG) / sp.Rational(DRAG)
    uniform = LARGEST_RHO.subs(PART) / 3 / MICRO
    low = sp.Rational(136, 100)
    return Claim(
        key="film-not-uniform",
        title="The fitted film is not uniform under the part",
        place="new; Section X-A and “the support plane is uniform” (Section IX-B)",
        derived=rf"A uniform film has $\rho = (l^2 + w^2)/12 = {float(uniform):.4f}$ mm²; the fitted "
        rf"{float(ratio):.4f} mm² is {float(ratio / uniform):.2f} times that. The drag sits further "
        "out than evenly: thinner film or contact towards the rim. A plane that is the same "
        "everywhere on the slide does not contradict this.",
        steps=(r"$\rho = \int k r^2 dA / \int k\,dA$ is the mean square distance of the drag.",),
        hypotheses=("the printed numbers read in (µN, mm)",),
        checks=(
            *_film_bounds(),
            for_all(
                r"for all values that round to the print: $\rho > 1.36\,(l^2 + w^2)/12$",
                [
                    rounded(e_x, DRAG),
                    rounded(e_th, TURNING_DRAG),
                    rounded(1000 * length, "1616"),
                    rounded(1000 * width, "837"),
                ],
                3 * e_th > low * LARGEST_RHO * e_x,
            ),
        ),
    )


# forces


def _acceleration() -> tuple[Finding, ...]:
    """Acceleration of the centre in one-point sticking, and its largest value."""
    R, L, v, q = sp.symbols("R L v q", positive=True)
    phi, t = sp.symbols("phi t", real=True)
    turned = sp.Function("p")(t)
    rate = v * L * sp.sin(phi)
    arm = R * sp.Matrix([sp.cos(turned), sp.sin(turned)])
    second = sp.diff(rate, phi) * rate
    swap = [(sp.diff(turned, t, 2), second), (sp.diff(turned, t), rate), (turned, phi)]
    centre = (-sp.diff(arm, t, 2)).subs(swap)
    return (
        identity(
            r"with $\dot\phi = v L \sin\phi$ the centre accelerates with $R v^2 L^2 |\sin\phi|$",
            centre.dot(centre),
            R**2 * v**4 * L**4 * sp.sin(phi) ** 2,
        ),
        for_all(
            r"$R L^2 \le \frac{3\sqrt3}{16\sqrt\rho}$, squared and with $q = R^2$, $L = R/(\rho + R^2)$",
            [],
            256 * rho * q**3 <= 27 * (rho + q) ** 4,
        ),
    )


def _inertia() -> Claim:
    """Inertial against frictional forces."""
    speed, way = sp.symbols("speed way", positive=True)
    drag, ratio = sp.Rational(DRAG) / 1000, sp.Rational(TURNING_DRAG) / sp.Rational(DRAG) * MICRO
    fastest = SPEEDS_UM[0] * MICRO
    steady = MASS * 3 * sp.sqrt(3) / 16 * fastest**2 / sp.sqrt(ratio)
    start = MASS * fastest**2 / (2 * MICRO / 10)
    return Claim(
        key="inertia",
        title="Inertial forces",
        place="Section V",
        printed="“The inertial forces are then on the order of nano-newtons for the accelerations "
        "involved […] the frictional forces dominate the inertial forces”",
        derived=rf"The part weighs {float(MASS * 10**6):.3f} mg. A start to 140 µm/s within one least "
        rf"increment of the manipulator, 0.1 µm, takes {float(start * 10**9):.0f} nN; 1 nN is an "
        rf"acceleration of {float(1 / MASS / 10**6):.1f} mm/s². In a steady sticking push at 140 µm/s "
        rf"inertia is at most {float(steady * 10**12):.1f} pN, far less than printed. The film's drag is "
        "larger than all of these at every speed of the manipulator.",
        steps=(
            r"Start: $a = v^2/(2 s)$ over the way $s$. Drag $e_x v$ is larger if $m v < 2 s e_x$.",
            r"Steady: the tip moves uniformly, so the centre accelerates by the turning of $r$ only, "
            r"with at most $\frac{3\sqrt3}{16} v^2/\sqrt\rho$.",
        ),
        hypotheses=(
            "density 8250 kg/m³ (beryllium copper, assumed), thickness 40 µm",
            "film constants read in (µN, mm); with the printed units drag is larger still",
            "starts take at least 0.1 µm",
        ),
        of_print=(
            for_all(
                "starting within 0.1 µm or more, up to 1.7 mm/s, inertia is below the drag",
                [speed <= 1700 * MICRO, way >= MICRO / 10],
                MASS * speed**2 < drag * speed * 2 * way,
            ),
            for_all(
                "and below 50 nN up to 140 µm/s",
                [speed <= fastest, way >= MICRO / 10],
                MASS * speed**2 < 2 * way * 50 * MICRO / 1000,
            ),
        ),
        sharper=(
            *_acceleration(),
            there_is(
                "steady sticking at 140 µm/s: less than 5 pN",
                [256 * ratio * force**2 > 27 * MASS**2 * speed**4],
                {force: 5 * MICRO**2, speed: fastest},
            ),
        ),
    )


def _dry_friction() -> Claim:
    """mu_s times the weight against the stated size of friction."""
    weight = MASS * GRAVITY
    values = {"p_1^*": sp.Rational("0.757"), "p_2^*": sp.Rational("0.013")}
    shown = " and ".join(
        rf"{float(value * weight / MICRO):.2g} µN for ${name}$" for name, value in values.items()
    )
    return Claim(
        key="dry-friction-force",
        title=r"Friction that the estimates of $\mu_s$ mean",
        place="Table I against Section V",
        printed=r"“the frictional forces are on the order of micro-newtons”; $\mu_s = 0.757$ and "
        r"$\mu_s = 0.013$",
        derived=rf"The part weighs {float(weight / MICRO):.1f} µN, so dry friction is at most {shown}: "
        r"the second is of the order of the inertial forces of a start. It shows that $\mu_s$ of "
        r"Table I is not a measurement: no path depends on it.",
        steps=(r"$\sum |f_i| \le \mu_s \sum N_i = \mu_s m g$.",),
        hypotheses=(
            "density 8250 kg/m³ (assumed), thickness 40 µm",
            "“on the order of micro-newtons” is taken as 0.1 to 100 µN",
        ),
        consistent=tuple(
            together(
                rf"friction of ${name}$ between 0.1 and 100 µN",
                sp.Eq(force, value * weight),
                force >= MICRO / 10,
                force <= 100 * MICRO,
            )
            for name, value in values.items()
        ),
    )


# sizes


def _playpen() -> Claim:
    """Millimetres and inches."""
    mm, inch = sp.symbols("mm inch", positive=True)
    same = sp.Eq(mm, sp.Rational(254, 10) * inch)
    sides = (("1.63", "0.641"), ("1.15", "0.454"))
    exact = " and ".join(f"{float(25.4 * float(i)):.2f} mm" for _, i in sides)
    return Claim(
        key="playpen",
        title="Size of the playpen",
        place="Section IV",
        printed=r"“1.63 mm × 1.15 mm (0.641″ × 0.454″)”",
        derived=f"The inches are {exact}: ten times the millimetres. The inches are right if the "
        "playpen is to serve for test pushes (see the room in it).",
        steps=("1 inch is 25.4 mm.",),
        consistent=tuple(
            together(f"{m} mm is {i} inch", rounded(mm, m), rounded(inch, i), same)
            for m, i in sides
        ),
        checks=tuple(
            together(f"ten times {m} mm is {i} inch", rounded(mm / 10, m), rounded(inch, i), same)
            for m, i in sides
        ),
    )


def _playpen_room() -> Claim:
    """Room for the part in the playpen, in millimetres as printed."""
    x, c, s = sp.Symbol("x", real=True), sp.cos(psi), sp.sin(psi)
    long, short = sp.Integer(1635), sp.Integer(1155)
    inside = [
        *(c >= 0, s >= 0, x >= 0),
        NEEDED.subs({c: s, s: c}, simultaneous=True) + 2 * x <= long,
        short >= NEEDED,
    ]
    return Claim(
        key="playpen-room",
        title="Room for the part in the playpen",
        place="new; Section IV, “unconstrained motion tests” and pushes of about 700 µm (Section VI)",
        derived="In 1.63 mm × 1.15 mm a part of 1616 µm × 837 µm can turn by less than 1.4° and shift "
        "by less than 10 µm to either side along its length, even with both sides rounded in its "
        "favour. Pushes of 600 or 700 µm and rotations of 45° need the ten times larger one.",
        steps=(
            r"Tilted by $\psi$ the part needs $l\cos\psi + w\sin\psi$ along and $l\sin\psi + "
            r"w\cos\psi$ across.",
        ),
        checks=(
            for_all("less than 1.4°", inside, s < sp.Rational(2443, 100_000)),
            for_all(
                "less than 10 µm to either side",
                [*inside, s <= sp.Rational(2443, 100_000)],
                x < 10,
            ),
        ),
    )


def _thickness() -> Claim:
    """Thickness of the material."""
    t = sp.Symbol("t_um", positive=True)
    exact = sp.Rational(15, 10_000) * 25_400
    return Claim(
        key="thickness",
        title="Thickness of the part",
        place="Section IV",
        printed=r"“1.5 mil (0.0015″) or 40 µm”",
        derived=f"0.0015 inch is {float(exact)} µm; 40 µm is that to one digit.",
        steps=("1 mil is 25.4 µm.",),
        of_print=(
            there_is(
                "0.0015 inch rounds to 40 µm, to ten micrometres",
                [t >= 35, t < 45, sp.Eq(t, sp.Rational(15, 10) * sp.Rational(254, 10))],
                {t: exact},
            ),
        ),
    )


def _pixels() -> Claim:
    """Field of view, pixel and camera."""
    pitch, across, up = sp.symbols("pixel_um n_x n_y", positive=True)
    view = [rounded(across * pitch / 1000, "3.37"), rounded(up * pitch / 1000, "2.52")]
    camera = {across: sp.Integer(640), up: sp.Integer(480)}
    low, high = sp.Rational(525_781, 100_000), sp.Rational(526_042, 100_000)
    return Claim(
        key="field-of-view",
        title="Field of view and pixel",
        place="Sections IV and IX-A",
        printed="field of view 3.37 mm × 2.52 mm; “each pixel subtends only 5.26 µm”",
        derived=r"The three numbers fit a camera of 640 × 480 pixels; then a pixel is between "
        rf"{float(low):.4f} and {float(high):.4f} µm, and ±1 pixel is the stated ±5 µm.",
        steps=(r"$640 \cdot 5.26 = 3366$ and $480 \cdot 5.26 = 2525$.",),
        hypotheses=("the number of pixels is not printed",),
        of_print=(
            there_is(
                "640 × 480 pixels of 5.26 µm",
                [rounded(pitch, "5.26"), *view],
                {pitch: sp.Rational(526, 100), **camera},
            ),
        ),
        sharper=(
            for_all(
                "all pixels of a 640 × 480 camera with that field of view",
                [relation.subs(camera) for relation in view],
                sp.And(pitch > low, pitch < high),
            ),
        ),
    )


def _orientation_error() -> Claim:
    """Two printed errors of the same measurement."""
    degrees, radians = sp.symbols("error_deg error_rad", positive=True)
    pixel = sp.Rational(526, 100)
    both_ends = float(sp.deg(2 * pixel / LONG_UM))
    needed = float(sp.rad(sp.Rational(5, 1000)) * LONG_UM)
    return Claim(
        key="orientation-error",
        title="Error of the measured orientation",
        place="Section VI against Section IX-A",
        printed="“angular measurements of roughly ±0.005° error” (Section VI); “the error in "
        "estimating the orientation […] is ±0.3°” (Section IX-A), both for ±1 pixel of the same "
        "microscope",
        derived="The two differ by a factor of 60. 0.005 rad is 0.29°: the degree sign of "
        "Section VI most likely stands for radians. One pixel at each end of the part is "
        rf"{both_ends:.2f}°; 0.005° would mean {needed:.2f} µm over its length, "
        rf"1/{float(pixel) / needed:.0f} of a pixel.",
        steps=(
            r"Two points 1616 µm apart, each off by one pixel of 5.26 µm across: $2 \cdot 5.26/1616$ "
            "rad at most.",
        ),
        consistent=(
            together(
                "one error of the orientation rounds to 0.005° and to 0.3°",
                rounded(degrees, "0.005"),
                rounded(degrees, "0.3"),
            ),
        ),
        checks=(
            there_is(
                "0.005 rad rounds to 0.3°",
                [rounded(180 * radians / sp.pi, "0.3")],
                {radians: sp.Rational(5, 1000)},
            ),
            there_is(
                "one pixel at each end is more than 0.3° (5.26 µm, 1616 µm)",
                [LONG_UM * radians <= 2 * pixel, radians > _degrees(sp.Rational(3, 10))],
                {radians: sp.Rational(65, 10_000)},
            ),
        ),
    )


def _speeds() -> Claim:
    """Speeds of the probe."""
    speed, frame, pitch = sp.symbols("speed_um frame_um pixel_um", positive=True)
    shown = ", ".join(f"{float(v / 30):.2g}" for v in SPEEDS_UM)
    return Claim(
        key="probe-speeds",
        title="Probe speeds",
        place="Sections IV and V",
        printed="“speeds ranging from 1.6 µm/s to 1.7 mm/s”; “140.0, 75.0, or 7.4 µm/s”; “30 Hz”",
        derived=f"The three speeds are within range; they are {shown} µm per frame at 30 Hz, less than "
        "a pixel. At 26 frames a second or fewer the fastest moves more than a pixel per frame.",
        steps=(r"$140/30 = 4.67 < 5.26$; $140/5.26 = 26.6$.",),
        of_print=(
            for_all(
                "each of the three is in range",
                [sp.Or(*(sp.Eq(speed, v) for v in SPEEDS_UM))],
                sp.And(speed >= sp.Rational(16, 10), speed <= 1700),
            ),
        ),
        sharper=(
            for_all(
                "and at 30 Hz moves by less than a pixel per frame",
                [
                    sp.Or(*(sp.Eq(speed, v) for v in SPEEDS_UM)),
                    sp.Eq(30 * frame, speed),
                    rounded(pitch, "5.26"),
                ],
                frame < pitch,
            ),
        ),
    )


def _slot_clearance() -> Claim:
    """Channel, part and clearance."""
    channel, part, gap = sp.symbols("channel part gap", positive=True)
    room = channel - part
    return Claim(
        key="slot-clearance",
        title="Clearance of the slot",
        place="Section VII against Sections IV and IX-A",
        printed="“the clearance between the rectangular part and the slot is 137 µm”; channel of "
        "976 µm; part of 1616 µm × 837 µm",
        derived=f"976 − 837 is {976 - 837} µm; rounding explains at most 1.5 µm of the 2 µm. Small, but "
        "whoever checks a plan needs one number.",
        steps=("Clearance is channel less part.",),
        hypotheses=("all three numbers describe one part and one slot, and are in whole µm",),
        consistent=(
            together(
                "channel, part and clearance fit",
                rounded(channel, "976"),
                rounded(part, "837"),
                rounded(gap, "137"),
                sp.Eq(gap, room),
            ),
        ),
        checks=(
            together(
                "139 µm would fit",
                rounded(channel, "976"),
                rounded(part, "837"),
                rounded(gap, "139"),
                sp.Eq(gap, room),
            ),
        ),
    )


def _needed_width() -> tuple[Finding, ...]:
    """That no point of the tilted part reaches further, and that a corner does."""
    x, y = sp.symbols("x y", real=True)
    height = x * sp.sin(psi) + y * sp.cos(psi)
    under = [2 * x <= LONG_UM, -2 * x <= LONG_UM, 2 * y <= SHORT_UM, -2 * y <= SHORT_UM]
    corner = {x: LONG_UM / 2, y: SHORT_UM / 2}
    return (
        for_all(
            r"no point of the tilted part is further from its middle line than half of $l\sin\psi + "
            r"w\cos\psi$",
            [sp.cos(psi) >= 0, sp.sin(psi) >= 0, *under],
            4 * height**2 <= NEEDED**2,
        ),
        identity(
            "a corner is as far", 2 * sp.Subs(height, *zip(*corner.items(), strict=True)), NEEDED
        ),
    )


def _goal_and_slot() -> Claim:
    """The tolerances of the goal against the room in the slot."""
    Y, slot = sp.symbols("Y slot", real=True)
    takes = 2 * Y + NEEDED
    five = angle(sp.Rational(4366, 100_000), psi)  # tan(2.5°) is 0.043661
    straight, wide, narrow = angle(sp.Integer(0), psi), sp.Integer(976), sp.Integer(837 + 137)
    spare = wide - NEEDED.subs(five)
    least = sp.Rational(401, 10_000)  # sin(2.3°) is 0.04013
    return Claim(
        key="goal-and-slot",
        title="Goal tolerance against the slot",
        place=r"new; $\epsilon_p = 76$ µm, $\epsilon_\theta = 5°$ (Section IX-E), slot of Section IV",
        derived=r"A part tilted by $\psi$ and off by $Y$ is inside the slot if $2|Y| + l\sin|\psi| + "
        r"w\cos\psi \le 976$ µm. A pose within the goal tolerance need not be: straight parts fit "
        rf"up to $|Y| = 69.5$ µm only; 5° fits with {float(spare):.1f} µm to spare at $Y = 0$, and not "
        r"at all with the printed clearance of 137 µm; with $|Y| = 38$ µm ($\epsilon_p/2$, Step 1) the "
        r"tilt must be below 2.3°. $\epsilon_p$ is a whole side in Steps 1, 3 and 4 ($Y$ within $\pm"
        r"\epsilon_p/2$, a box narrower than $\epsilon_p$); Section IX-E calls it the tolerance of the "
        "goal, which may be read as a half side, ±76 µm. Reaching the goal set is not the same as being in the slot.",
        steps=(
            r"The extent of the rectangle across the slot is $l\sin|\psi| + w\cos\psi$.",
            r"Numbers in µm; $\tan(\psi/2) = 0.04366$ is 5.00°, from below; $\sin 2.3° = 0.0401$.",
        ),
        hypotheses=("the goal is the middle of the slot, the part lies wholly within it",),
        checks=(
            *_needed_width(),
            there_is(
                r"$|Y| = 75$, straight: outside", [takes > slot], {Y: 75, slot: wide, **straight}
            ),
            there_is(
                r"$Y = 0$, 5.00°: inside a slot of 976 µm",
                [takes < slot],
                {Y: 0, slot: wide, **five},
            ),
            there_is(
                r"$Y = 0$, 5.00°: outside with a clearance of 137 µm",
                [takes > slot],
                {Y: 0, slot: narrow, **five},
            ),
            for_all(
                r"$|Y| = 38$, 2.3° or more: outside",
                [sp.cos(psi) > 0, sp.sin(psi) >= least, sp.Eq(Y, 38)],
                takes > wide,
            ),
            for_all(
                r"straight parts fit up to 69.5 µm only",
                [sp.Eq(sp.sin(psi), 0), sp.Eq(sp.cos(psi), 1), takes <= wide],
                2 * Y <= 139,
            ),
        ),
    )


def _corner_pushes() -> Claim:
    """Places of the test pushes."""
    offset = sp.Symbol("offset", real=True)
    return Claim(
        key="corner-pushes",
        title="Four of the eight test pushes are at corners",
        place=r"new; “midpoint $\pm l_{ls}/2$” and “$\pm l_{ss}/2$” (Section VI, Fig. 3)",
        derived=r"With $l_{ls}$ “the length of the long side” the points A and E at midpoint $\pm "
        r"l_{ls}/2$ are the corners of the part, and so are F and H on the short side. An error of "
        "5 µm puts the middle of the tip beside the part, so that it touches the corner with less than "
        r"half of its 25 µm. Read as parts of half the side, $\pm l/8$ and $\pm l/4$, all eight are on "
        "the edges.",
        steps=(r"The edge reaches $l_{ls}/2 = 808$ µm from its midpoint.",),
        checks=(
            there_is(
                "within 5 µm of the nominal place, beside the edge (µm)",
                [sp.Abs(offset - LONG_UM / 2) <= 5, sp.Abs(offset) > LONG_UM / 2],
                {offset: sp.Integer(812)},
            ),
        ),
    )


MOVES_UM = ((0, -600), (-1500, 0), (0, 50), (0, -50), (1550, 0), (0, 775), (-2550, 0))


def _table_2() -> Claim:
    """The scripted plan: where the tip goes."""
    tip, part = (3050, 1240), (2330, 1210)
    places = [tip]
    for dx, dy in MOVES_UM:
        places.append((places[-1][0] + dx, places[-1][1] + dy))
    xs, ys = zip(*places, strict=True)
    x, y, gap = sp.symbols("x y gap", real=True)
    lever = part[1] - places[1][1]
    return Claim(
        key="table-2",
        title="The scripted plan of Table II",
        place="Table II, Section VII",
        printed=r"$\Delta u_1 \ldots \Delta u_7$: the tip moves “from it's initial position at the "
        "midpoint of the long side of the peg towards the top end of the peg”",
        derived=f"The moves keep the tip within {min(xs)} to {max(xs)} µm by {min(ys)} to {max(ys)} "
        f"µm, inside the field of view. The tip starts {tip[1] - part[1]} µm from the height of the "
        rf"centre; after $\Delta u_1$ it is {lever} µm towards the top end, on the edge, which ends "
        "at 808 µm. It starts free of the part.",
        steps=("Sums of the printed moves from the printed start; y points down in the image.",),
        of_print=(
            *(
                there_is(
                    rf"tip after $\Delta u_{j}$ in the field of view" if j else "tip at the start",
                    [x >= 0, x <= 3370, y >= 0, y <= 2520],
                    {x: sp.Integer(place[0]), y: sp.Integer(place[1])},
                )
                for j, place in enumerate(places)
            ),
            there_is(
                r"the tip is towards the top end after $\Delta u_1$, on the edge (89°, so within 1 µm "
                "of its height)",
                [y < part[1], part[1] - y < 807],
                {y: sp.Integer(places[1][1])},
            ),
            there_is(
                "at the start the tip is clear of the upright part, by 301.5 µm",
                [sp.Eq(x, part[0] + SHORT_UM / 2 + gap), gap > 0],
                {x: sp.Integer(tip[0]), gap: sp.Rational(3015, 10)},
            ),
        ),
    )


# tables of Section X


TABLES: Mapping[str, Mapping[str, tuple[Sequence[str], str]]] = {
    "III": {
        "X": (("1996", "1975", "1559"), "1843"),
        "Y": (("19", "18", "20"), "19"),
        "theta": (("0.6", "0.5", "1.1"), "0.7"),
    },
    "IV": {
        "X": (("381", "434", "370"), "382"),
        "Y": (("34", "32", "14"), "27"),
        "theta": (("88", "90", "90"), "89"),
    },
    "V": {
        "X": (("954", "944", "965", "959", "954"), "955"),
        "Y": (("5", "11", "11", "5", "0"), "6"),
        "theta": (("0.1", "0.7", "0.7", "0.5", "0.0"), "0.4"),
    },
}
"""Printed rows and printed average of every column."""
SIMULATED = {"III": "1443", "IV": "295", "V": "949"}
"""Printed X of the simulation."""
UNIT = {"X": " µm", "Y": " µm", "theta": "°"}
NUMBER = {"III": 3, "IV": 4, "V": 5}
REMARK = {
    "III": " The text calls simulation and average comparable.",
    "IV": " The text puts the mismatch down to uncertainties.",
    "V": "",
}


def _column(table: str, name: str) -> tuple[Finding, Finding]:
    """Whether rows and average can be true together, and whether the printed rows give it."""
    rows, printed = TABLES[table][name]
    entries = sp.symbols(f"{name}_1:{len(rows) + 1}", real=True)
    mean = sp.Symbol(f"{name}_mean", real=True)
    what = f"column {name.replace('theta', 'θ')}: the average of {', '.join(rows)} is {printed}{UNIT[name]}"
    average = sum(entries) / len(rows)
    return (
        together(
            what,
            *(rounded(entry, row) for entry, row in zip(entries, rows, strict=True)),
            rounded(mean, printed),
            sp.Eq(len(rows) * mean, sum(entries)),
        ),
        there_is(
            f"{what}, from the rows as printed",
            [rounded(average, printed)],
            {entry: sp.Rational(row) for entry, row in zip(entries, rows, strict=True)},
        ),
    )


def _tables() -> tuple[Claim, ...]:
    """Averages of Tables III to V."""
    return tuple(_table(name) for name in TABLES)


def _table(name: str) -> Claim:
    findings = [_column(name, column) for column in TABLES[name]]
    means = []
    for column, (rows, printed) in TABLES[name].items():
        mean = sum(sp.Rational(row) for row in rows) / len(rows)
        means.append(f"{column.replace('theta', 'θ')} {float(mean):.4g} (printed {printed})")
    rows = [sp.Rational(row) for row in TABLES[name]["X"][0]]
    simulated = sp.Rational(SIMULATED[name])
    outside = min(rows) > simulated
    beside = f"below every trial ({min(rows)} to {max(rows)})" if outside else "within the trials"
    x = sp.Symbol("X_simulated", real=True)
    return Claim(
        key=f"table-{NUMBER[name]}",
        title=f"Averages of Table {name}",
        place=f"Table {name}, Section X-C",
        printed=f"the row “Average” of Table {name}",
        derived=f"Averages of the printed rows: {', '.join(means)}. The simulated X, {simulated} µm, "
        f"is {beside}.{REMARK[name]}",
        steps=("Every printed number stands for all values that round to it.",),
        consistent=tuple(pair[0] for pair in findings),
        of_print=tuple(pair[1] for pair in findings),
        checks=(
            there_is(
                f"the simulated X is {beside}",
                [sp.And(*(x < row for row in rows)) if outside else sp.And(x >= min(rows), x <= max(rows))],
                {x: simulated},
            ),
        ),
    )  # fmt: skip


def _gain_of_table_3() -> Claim:
    """Experiments against the predicted Y translation."""
    measured = sp.symbols("Y_1:4", real=True)
    excess = sp.symbols("excess_1:4", real=True)
    predicted = sp.Symbol("Y_theory", real=True)
    values = zip((*measured, *excess), (19, 18, 20, 8, 7, 9), strict=True)
    at = {name: sp.Integer(value) for name, value in values} | {predicted: sp.Integer(11)}
    return Claim(
        key="table-3-gain",
        title="Excess of the measured Y translation",
        place="Section X-C on Table III",
        printed="“Experiments show a somewhat higher (7–9 µm) net displacement than the predicted Y "
        "translation”",
        derived="19, 18 and 20 µm less the predicted 11 µm are 8, 7 and 9 µm.",
        steps=("Rows of the column Y less the entry “Theory”.",),
        of_print=(
            there_is(
                "all three are 7 to 9 µm above 11 µm, both ends taken",
                [
                    *(sp.Eq(m, predicted + e) for m, e in zip(measured, excess, strict=True)),
                    sp.Eq(sp.Min(*excess), 7),
                    sp.Eq(sp.Max(*excess), 9),
                ],
                at,
            ),
        ),
    )


def _errors_of_table_3() -> Claim:
    """Whether the stated error of sensing explains the excess."""
    excess, start, end = sp.symbols("excess e_start e_end", real=True)
    small = [sp.And(error >= -5, error <= 5) for error in (start, end)]
    seen = sp.And(excess >= 7, excess <= 9)
    return Claim(
        key="table-3-errors",
        title="Measurement error as the reason of the excess",
        place="Section X-C on Table III",
        printed="the excess of 7–9 µm “is likely due to measurement errors—errors in estimating "
        "position are ±5 µm”",
        derived="One error of ±5 µm is too small; a displacement has two. With both the excess is "
        "possible, if in every one of the three trials both err by at least 2 µm, the last position "
        "upwards and the first downwards: a bias rather than scatter.",
        steps=("A net displacement is the last position less the first.",),
        hypotheses=("the last and the first position are both off by up to 5 µm",),
        added=("the last and the first position are both off by up to 5 µm",),
        of_print=(
            together("an error of ±5 µm makes an excess of 7 to 9 µm", seen, sp.Eq(excess, end), small[1]),
        ),
        with_added=(
            together(
                "two errors of ±5 µm make an excess of 7 to 9 µm",
                seen,
                sp.Eq(excess, end - start),
                *small,
            ),
        ),
        checks=(
            for_all(
                "then the last is at least 2 µm too high and the first at least 2 µm too low",
                [seen, sp.Eq(excess, end - start), *small],
                sp.And(end >= 2, -start >= 2),
            ),
        ),
    )  # fmt: skip


def _margins_of_table_5() -> Claim:
    """Simulation within the margins of the experiments."""
    measured, simulated, off = sp.symbols("X_measured X_simulated off", real=True)
    far = {measured: sp.Integer(965), simulated: sp.Integer(949), off: sp.Integer(16)}
    trials = [sp.Rational(row) for row in TABLES["V"]["X"][0]]
    x, y, tilt = sp.symbols("X Y theta", real=True)
    return Claim(
        key="table-5-margins",
        title="Simulation within the margins of the experiments",
        place="Section X-C on Table V",
        printed="“The predicted results are within the error margins of the experimental observations”",
        derived="With the stated error of ±5 µm, at both ends of a displacement ±10 µm, the predicted "
        "949 µm is 6 µm outside the margin of trial 3 (965 µm). It is within the spread of the five "
        "trials in all three columns.",
        steps=(
            "A net displacement is a difference of two measured positions, so its error is twice ±5 µm.",
            "$965 - 949 = 16 > 10$.",
        ),
        hypotheses=("“margin” means the spread of the trials, not the stated error of sensing",),
        added=("“margin” means the spread of the trials, not the stated error of sensing",),
        of_print=(
            for_all(
                "the prediction is within ±10 µm of every trial",
                [
                    sp.Or(*(sp.Eq(measured, row) for row in trials)),
                    sp.Eq(simulated, 949),
                    sp.Eq(measured, simulated + off),
                ],
                sp.Abs(off) <= 10,
                at=far,
            ),
        ),
        with_added=(
            there_is(
                "949 µm, 0.2 µm and 0.0° are within the spread of the trials",
                [x >= min(trials), x <= max(trials), y >= 0, y <= 11, tilt >= 0, tilt <= sp.Rational(7, 10)],
                {x: sp.Integer(949), y: sp.Rational(2, 10), tilt: sp.Integer(0)},
            ),
        ),
    )  # fmt: skip


def _tests_1_and_2() -> Claim:
    """Robust against nonrobust."""
    first = sp.symbols("X_1 Y_1 theta_1", real=True)
    second = sp.symbols("X_2 Y_2 theta_2", real=True)
    printed = ("20", "15", "0.023", "15", "25", "0.1")
    at = {name: sp.Rational(value) for name, value in zip((*first, *second), printed, strict=True)}
    known = [sp.Eq(name, value) for name, value in at.items()]
    smaller = [p < q for p, q in zip(first, second, strict=True)]
    return Claim(
        key="tests-1-and-2",
        title="Robust and nonrobust pushes compared",
        place="Section X-B",
        printed="“Test 1 has maximal trajectory differences of 20 µm in X, 15 µm in Y, and 0.023 "
        "radians in θ, which are smaller than the corresponding numbers for Test 2 (maximal "
        "trajectory differences at 15 µm in X, 25 µm in Y, and 0.1 radians in θ)”",
        derived="True in Y and θ; in X the robust push scatters more, 20 µm against 15 µm.",
        steps=("The printed numbers, compared one by one.",),
        of_print=(
            for_all(
                "each number of Test 1 is below that of Test 2", known, sp.And(*smaller), at=at
            ),
        ),
        checks=(there_is("Y and θ of Test 1 are below those of Test 2", smaller[1:], at),),
    )
