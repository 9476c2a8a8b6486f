"""Net displacement of the Y-translation: tilt about one contact, straighten about another.

While a contact sticks its height is that of the tip, so the centre moves by the change of the
arm's height. Tilt about offset ``d2`` from ``t0`` to ``t1``, straighten about ``back`` to ``t2``; the
terms in ``d1 cos(t1)`` cancel, which is why the gain does not suffer from an uncertain tilt to first
order.
"""

from __future__ import annotations

from collections.abc import Mapping

import sympy as sp
from sympy.logic.boolalg import Boolean

from derivations._claim import Claim
from derivations._derivation import Derivation, Function
from derivations._statement import (
    Finding,
    angle,
    for_all,
    identity,
    positive_by,
    require_zero,
    there_is,
)
from derivations._tex import tex
from derivations.mechanics import PAPER, a, cross, d1, d2, mu, n, rho, theta, velocity_at
from derivations.sampling import LEAST_MU, MOST_MU
from derivations.symmetries import HALF_LENGTH, limits

back, phi = sp.symbols("d2_back phi", real=True)
t0, t1, t2 = sp.symbols("theta_0 theta_1 theta_2", real=True)
alpha, end_tilt = sp.symbols("alpha beta", real=True)
"""Tilts of the edge at the start and at the end, counter-clockwise from upright."""
span = sp.Symbol("l_AB", positive=True)
APART = d2 - back
"""l_AB: the upper contact less the lower one."""
off, turn = sp.Symbol("delta", positive=True), sp.Symbol("eta", real=True)
"""Errors of l_AB and of phi: 2 s_p + 2 c_p and 2 s_theta."""
eps_p, s_p, d_v = sp.symbols("eps_p s_p d_v", positive=True)
ERRORS = {off: sp.Integer(20), **angle(sp.Rational(1, 191), turn)}
"""Of the paper: 2 (5 + 5) µm and 2 · 0.3°."""
SENSED, MISALIGNED, LEFT = sp.Rational(1, 382), sp.Rational(1, 458), sp.Rational(1, 161)
"""Half tangents of 0.3°, 0.25° and 0.71°: sensing, misalignment, theta_t of eq. (11)."""
IN_UM = "lengths in µm"


def arm(offset: sp.Expr) -> sp.Matrix:
    """From the centre to a contact."""
    return offset * a + d1 * n


def rise(offset: sp.Expr, start: sp.Expr, end: sp.Expr) -> sp.Expr:
    """Of the centre while the contact sticks to a tip that moves along x."""
    height = arm(offset)[1]
    return height.subs(theta, start) - height.subs(theta, end)


def gain() -> sp.Expr:
    """Rise over tilt and straightening."""
    return rise(d2, t0, t1) + rise(back, t1, t2)


def nominal(length: sp.Expr, tilt: sp.Expr) -> sp.Expr:
    """The printed gain, angles written out."""
    return length * (1 - sp.expand_trig(sp.cos(tilt)))


def derive() -> Derivation:
    """Derive the gain, its error and its limit, and compare."""
    compact = (
        d2 * (sp.sin(t0) - sp.sin(t1))
        + back * (sp.sin(t1) - sp.sin(t2))
        - d1 * (sp.cos(t0) - sp.cos(t2))
    )
    require_zero(gain() - compact, "cos(t1) cancels")
    ends = {t0: sp.pi / 2 + alpha, t1: sp.pi / 2 + phi, t2: sp.pi / 2 + end_tilt}
    tilted = compact.subs(ends)
    return Derivation(
        name="y_translation",
        summary="Net displacement of the Y-translation (paper, Section IX-E).",
        claims=(
            _law(compact, tilted),
            _ends(tilted),
            _error_bound(tilted),
            _upper_corner(),
            _step_1(),
            _step_3(tilted),
            _straightening(),
            _limit(),
        ),
        functions={
            "gain": Function(
                arguments=(t0, t1, t2, d1, d2, back),
                results=(compact,),
                unit="m",
                meaning="m: rise of the centre over tilt and straightening",
            ),
        },
    )


def _law(compact: sp.Expr, tilted: sp.Expr) -> Claim:
    """The printed gain from the kinematics of a sticking contact."""
    slip, omega = sp.symbols("slip omega", real=True)
    centre = sp.Symbol("v_y", real=True)
    moving = velocity_at(sp.Matrix([0, centre, omega]), arm(d2))[1] - slip * a[1]
    (speed,) = sp.solve(moving, centre)
    upright = {alpha: 0, end_tilt: 0}
    return Claim(
        key="y-gain",
        title="Net gain of the Y-translation",
        place="Section IX-E, robust translation in the Y-direction",
        printed=r"“The amount of the net vertical translation is $l_{AB}(1 - \cos\phi)$ under nominal "
        "conditions”",
        derived=rf"{tex(compact)} for a tilt about $d_2$ from $\theta_0$ to $\theta_1$ and a "
        r"straightening about $d_2^{back}$ to $\theta_2$; with both ends upright this is $l_{AB} (1 - "
        r"\cos\phi)$, $l_{AB} = d_2 - d_2^{back}$. It is a gain upwards if the part is tilted about "
        "the upper contact.",
        steps=(
            r"The contact's height is that of the tip, so $\dot Y = -v_\theta (d_2 a + d_1 n)_x = "
            r"-\frac{d}{dt} (d_2 a + d_1 n)_y$: $Y$ changes by minus the change of the arm's height.",
            r"Sum over tilt and straightening; $d_1 \cos\theta_1$ cancels.",
            r"A slip along the edge would add $\sin\theta$ times the distance slipped.",
        ),
        hypotheses=("both contacts stick throughout", "part upright at both ends"),
        of_print=(
            identity("printed $=$ derived, both ends upright",
                     (d2 - back) * (1 - sp.cos(phi)), tilted.subs(upright)),
        ),
        sharper=(
            identity("rise over both moves for any three orientations", gain(), compact),
        ),
        checks=(
            identity("speed of the centre, with slip", speed,
                     -omega * sp.diff(arm(d2)[1], theta) + slip * sp.sin(theta)),
        ),
    )  # fmt: skip


def _ends(tilted: sp.Expr) -> Claim:
    """What tilted ends add."""
    equal = tilted.subs(end_tilt, alpha)
    short_edge = HALF_LENGTH * sp.sin(sp.rad(sp.Rational(1, 4)))
    long_edge = PAPER[d1] * sp.sin(sp.rad(sp.Rational(1, 4)))
    return Claim(
        key="y-gain-ends",
        title="Gain between ends that are not upright",
        place="new; the misalignment $\\beta$ of Fig. 10 and the error of sensing",
        derived=rf"From a tilt $\alpha$ to a tilt $\beta$ (both from upright, turning point $\phi$) "
        rf"the gain is {tex(tilted)}. Of first order is only $d_1 (\sin\alpha - \sin\beta)$: 0.25° at "
        rf"one end move the part by {float(long_edge):.1f} µm on the long edge and "
        rf"{float(short_edge):.1f} µm on the short one. With equal ends, as between two pushes of the "
        r"same pair of tips, $d_1$ cancels and $l_{AB} (\cos\beta - \cos\phi)$ is left.",
        steps=(r"$\theta = \pi/2 + $ tilt in the gain for any three orientations.",),
        checks=(
            identity("gain between tilted ends", tilted,
                     d2 * (sp.cos(alpha) - sp.cos(phi)) + back * (sp.cos(phi) - sp.cos(end_tilt))
                     + d1 * (sp.sin(alpha) - sp.sin(end_tilt))),
            identity("equal ends", equal, (d2 - back) * (sp.cos(alpha) - sp.cos(phi))),
            identity("first order in the tilt of the start",
                     sp.Subs(sp.Derivative(tilted, alpha), alpha, 0), d1),
            identity("first order in the tilt of the end",
                     sp.Subs(sp.Derivative(tilted, end_tilt), end_tilt, 0), -d1),
        ),
    )  # fmt: skip


def _bounds(length: sp.Expr) -> tuple[sp.Expr, sp.Expr]:
    """The printed d_1^e and d_2^e, without the bars: both are positive where they are used."""
    return (
        nominal(length, phi) - nominal(length - off, phi - turn),
        nominal(length + off, phi + turn) - nominal(length, phi),
    )


def _within(error: sp.Expr, bounds: tuple[sp.Expr, sp.Expr]) -> Boolean:
    """Whether ``|error| <= max(bounds)``."""
    return sp.Or(*(sp.And(error <= bound, -error <= bound) for bound in bounds))


def _deviation(tilted: sp.Expr) -> sp.Expr:
    """Of a gain from the nominal one."""
    return tilted - nominal(APART, phi)


def _error_bound(tilted: sp.Expr) -> Claim:
    """d_v^u, with and without upright ends."""
    error = _deviation(tilted)
    small = [sp.cos(tilt) >= _cosine(SENSED) for tilt in (alpha, end_tilt)]
    given = [off < APART, sp.sin(phi) > 0, sp.sin(turn) > 0, *small]
    stated = _within(error, _bounds(APART))
    upright = angle(sp.Integer(0), alpha) | angle(sp.Integer(0), end_tilt)
    ahead = upright | angle(MISALIGNED, end_tilt)
    leaning = upright | angle(-SENSED, alpha)
    return Claim(
        key="y-gain-error-bound",
        title="Error bound of the Y-translation",
        place="Step 1, Section IX-E",
        printed=r"“It will have the following error bound $d_v^u = \max\{d_1^e, d_2^e\}$”, the "
        r"differences of $l_{AB}(1 - \cos\phi)$ to $(l_{AB} \mp 2 s_p^u \mp 2 c_p^u)(1 - \cos(\phi "
        r"\mp 2 s_\theta^u))$",
        derived=r"It bounds the error if both ends are upright (or equally tilted, to second order) "
        r"and both contacts stick: the gain grows with $l_{AB}$ and with $\phi$, so its extremes are "
        r"at the two corners. An end that is off by $\beta$ adds $d_1 \sin\beta$: 0.25° of "
        "misalignment alone, and the sensing error of 0.3° alone, exceed the bound.",
        steps=(
            r"$f(l, \phi) = l (1 - \cos\phi)$: $f(l_2, \phi_2) - f(l_1, \phi_1) = (l_2 - l_1)(1 - "
            r"\cos\phi_2) + l_1 (\cos\phi_1 - \cos\phi_2)$.",
            r"$\cos\phi_1 - \cos\phi_2 = 2 \sin\frac{\phi_1 + \phi_2}{2} \sin\frac{\phi_2 - "
            r"\phi_1}{2} > 0$ for $0 < \phi_1 < \phi_2 < \pi$.",
        ),
        hypotheses=(
            r"$l_{AB} > 2 s_p^u + 2 c_p^u$, $2 s_\theta^u < \phi$, $\phi + 2 s_\theta^u < \pi$",
            "both contacts stick throughout",
        ),
        added=("part upright at the start and at the end ($\\beta = 0$)",),
        of_print=(
            for_all(f"$\\beta = 0.25°$, start upright, $l_{{AB}}$ and $\\phi$ exact ({IN_UM})",
                    given, stated, at=_example(ahead)),
            for_all(f"start tilted by 0.3°, $\\beta = 0$, $l_{{AB}}$ and $\\phi$ exact ({IN_UM})",
                    given, stated, at=_example(leaning)),
        ),
        with_added=_monotone(),
        checks=(
            identity(r"no error with upright ends, $l_{AB}$ and $\phi$ exact",
                     error.subs({alpha: 0, end_tilt: 0}), sp.Integer(0)),
        ),
    )  # fmt: skip


def _example(tilts: Mapping[sp.Expr, sp.Expr]) -> dict[sp.Expr, sp.Expr]:
    """Contacts 500 um apart, turned at 10.9 degrees."""
    return {
        d1: PAPER[d1],
        d2: sp.Integer(250),
        back: sp.Integer(-250),
        **ERRORS,
        **angle(sp.Rational(2, 21), phi),
        **tilts,
    }


def _cosine(half_tangent: sp.Rational) -> sp.Rational:
    return angle(half_tangent, phi)[sp.cos(phi)]


def _monotone() -> tuple[Finding, ...]:
    """Certificates that the gain grows with both arguments."""
    x1, y1, x2, y2 = sp.symbols("cos_1 sin_1 cos_2 sin_2", real=True)  # of the half angles
    k1, k2, l1, l2 = sp.symbols("k_1 k_2 l_1 l_2", real=True)
    return (
        positive_by(
            r"$f(l_2, \phi_2) > f(l_1, \phi_1)$ for $l_2 > l_1 > 0$ and $\cos\phi_2 < \cos\phi_1$",
            l2 * (1 - k2) - l1 * (1 - k1),
            {"longer": l2 - l1, "l_1": l1, "steeper": k1 - k2, "rise_2": 1 - k2},
            multiplier="1",
            combination="longer*rise_2 + l_1*steeper",
        ),
        positive_by(
            r"$\cos\phi_1 > \cos\phi_2$ for $0 < \phi_1 < \phi_2 < \pi$, half angles",
            (x1**2 - y1**2) - (x2**2 - y2**2),
            {"x_1": x1, "y_1": y1, "x_2": x2, "y_2": y2, "later": x1 * y2 - y1 * x2},
            multiplier="1",
            combination="2*later*(x_1*y_2 + y_1*x_2)",
            on=[(x1, y1), (x2, y2)],
        ),
    )


def _upper_corner() -> Claim:
    """Which of the two is the larger."""
    lower, upper = _bounds(span)
    point = {span: sp.Integer(500), **ERRORS, **angle(sp.Rational(2, 21), phi)}
    values = [float(bound.subs(point)) for bound in (lower, upper)]
    return Claim(
        key="y-gain-upper-corner",
        title=r"The bound is always $d_2^e$",
        place=r"new; $d_v^u = \max\{d_1^e, d_2^e\}$ in Step 1",
        derived=r"$d_2^e > d_1^e$ for every $\phi \le \pi/2$: $d_v^u = (l_{AB} + \delta)(1 - \cos(\phi "
        r"+ \eta)) - l_{AB}(1 - \cos\phi)$ with $\delta = 2 s_p^u + 2 c_p^u$, $\eta = 2 s_\theta^u$, and "
        r"it is attained. Example ($l_{AB} = 500$ µm, $\phi = 10.9°$, paper's errors): $d_1^e = "
        rf"{values[0]:.2f}$, $d_2^e = {values[1]:.2f}$ µm.",
        steps=(
            r"$d_2^e - d_1^e = 2 l_{AB} \cos\phi (1 - \cos\eta) + 2 \delta \sin\phi \sin\eta$.",
        ),
        checks=(
            identity(
                r"difference of the two",
                upper - lower,
                2 * span * sp.cos(phi) * (1 - sp.cos(turn)) + 2 * off * sp.sin(phi) * sp.sin(turn),
            ),
            for_all(
                r"positive for $\cos\phi \ge 0$",
                [sp.cos(phi) >= 0, sp.sin(phi) > 0, sp.sin(turn) > 0, sp.cos(turn) > 0],
                span * sp.cos(phi) * (1 - sp.cos(turn)) + off * sp.sin(phi) * sp.sin(turn) > 0,
            ),
        ),
    )


def _step_1() -> Claim:
    """From the conditions to Y within half the tolerance."""
    sensed, e, e_g = sp.symbols("Y_s e e_g", real=True)
    _, upper = _bounds(span)
    one = nominal(span, phi)
    needed = s_p + upper
    larger = sp.sin(phi) * sp.cos(turn) - sp.cos(phi) * sp.sin(turn)
    given = [needed <= eps_p / 2, span > off, larger > 0]
    outcomes = {
        k: sp.Abs(sensed - k * one) + s_p + (upper if k else 0) for k in range(-2, 3)
    }  # motions -> largest |Y| over all errors
    point = {
        eps_p: sp.Integer(30),
        s_p: sp.Integer(5),
        span: sp.Integer(520),
        **ERRORS,
        **angle(sp.Rational(1, 7), phi),
    }
    worst = ((one + upper) / 2).subs(point)
    at = {**point, sensed: worst}
    shown = [
        f"{float(part.subs(at)):.1f}" for part in (eps_p / 2, needed, outcomes[0], outcomes[1])
    ]
    errors = [-s_p <= e, e <= s_p, -d_v <= e_g, e_g <= d_v]
    return Claim(
        key="step-1-conditions",
        title=r"Conditions for $Y \in [-\epsilon_p/2, \epsilon_p/2]$",
        place="Step 1, Section IX-E",
        printed=r"“To ensure that $Y \in [-(\epsilon_p/2), \epsilon_p/2]$ can be achieved … $s_p^u + "
        r"d_v^u \le \epsilon_p/2$, $\phi > 2 s_\theta^u$, $l_{AB} > 2 s_p^u + 2 c_p^u$”",
        derived=r"They do if the pose is sensed before the last motion and that motion's gain is made "
        r"equal to what is sensed to be left ($l_{AB}$ or $\phi$ chosen for it), with $d_v^u$ at that "
        r"choice; then they are also necessary. If all motions have one gain $g$, what is needed is "
        r"$s_p^u + (g + d_v^u)/2 \le \epsilon_p/2$. With the paper's $\epsilon_p = 76$ µm this holds as "
        "well, because no sticking motion gains that much (see the bound on the gain). Witness for a "
        rf"tolerance of $\pm {shown[0]}$ µm: $s_p^u + d_v^u = {shown[1]}$ µm, and the part ends up to "
        rf"{shown[2]} µm off without and {shown[3]} µm off after another motion.",
        steps=(
            r"$Y = Y_s + e$ with $|e| \le s_p^u$; a motion with nominal gain $-Y_s$ leaves $e$ plus the "
            "error of the gain.",
            r"With one gain $g$ the worst remainder is $(g + d_v^u)/2$: leaving it costs $(g + "
            r"d_v^u)/2$, another motion $(g - d_v^u)/2 + d_v^u$.",
        ),
        hypotheses=("upright ends and sticking, as for $d_v^u$",),
        added=("pose sensed before the last motion", "its nominal gain equals the sensed remainder"),
        of_print=(
            for_all(
                rf"one gain $l_{{AB}}(1 - \cos\phi)$ for all motions: some number of them ({min(outcomes)} "
                rf"to {max(outcomes)} from the sensed remainder) brings $Y$ into the band for all errors "
                rf"({IN_UM})",
                given,
                sp.Or(*(outcome <= eps_p / 2 for outcome in outcomes.values())),
                at=at,
            ),
        ),
        with_added=(
            for_all("gain equal to the sensed remainder",
                    [s_p + d_v <= eps_p / 2, *errors],
                    sp.And(e + e_g <= eps_p / 2, -(e + e_g) <= eps_p / 2)),
        ),
        checks=(
            identity(r"$\phi > 2 s_\theta^u$ as $\sin(\phi - \eta) > 0$", larger,
                     sp.sin(phi - turn)),
            for_all(r"necessary: where $s_p^u + d_v^u > \epsilon_p/2$ the largest errors leave the band",
                    [s_p + d_v > eps_p / 2, sp.Eq(e, s_p), sp.Eq(e_g, d_v)],
                    e + e_g > eps_p / 2),
            for_all("one gain $g$: the rest after leaving it or one more motion, at best",
                    [span > d_v, s_p + (span + d_v) / 2 <= eps_p / 2, sensed >= 0, sensed <= span],
                    sp.Or(sensed + s_p <= eps_p / 2, span - sensed + s_p + d_v <= eps_p / 2)),
        ),
    )  # fmt: skip


def _step_3(tilted: sp.Expr) -> Claim:
    """The same motion on the short edge, after the rotation."""
    tilt = sp.cos(alpha) >= _cosine(LEFT)
    given = [off < APART, sp.sin(phi) > 0, sp.sin(turn) > 0, tilt]
    left = {**_example(angle(sp.Integer(0), end_tilt)), d1: HALF_LENGTH, **angle(-LEFT, alpha)}
    start = sp.deg(2 * sp.atan(LEFT))
    added = float(d1.subs(left) * sp.sin(alpha).subs(left))
    return Claim(
        key="step-3-short-edge",
        title="Y-translation on the short edge",
        place="Step 3, Section IX-E",
        printed=r"“If necessary, move in the $Y$ direction by pushing along the short edge of the part "
        r"such that $Y \in [-(\epsilon_p/2), \epsilon_p/2]$” (gain and error bound as in Step 1)",
        derived=r"The same law with the same $l_{AB}(1 - \cos\phi)$, whatever $d_1$, once the short "
        r"edge is upright. Straight after the rotation it is not: a tilt of $\theta_t = "
        rf"{float(start):.2f}°$ alone moves the part by ${added:.1f}$ µm, more than the gain.",
        steps=(r"Gain between tilted ends with $d_1 = 808$ µm, half of the long side.",),
        hypotheses=("both contacts stick throughout",),
        added=(r"the part is straightened ($t^2$ on the short edge) before",),
        of_print=(
            for_all(
                r"gain within the error bound of $l_{AB}(1 - \cos\phi)$ for a part that the rotation "
                rf"has left within $\theta_t$ of $\pi$ ({IN_UM})",
                given,
                _within(_deviation(tilted), _bounds(APART)),
                at=left,
            ),
        ),
        with_added=(
            identity(r"upright ends: $l_{AB}(1 - \cos\phi)$ for every $d_1$",
                     tilted.subs({alpha: 0, end_tilt: 0}), (d2 - back) * (1 - sp.cos(phi))),
        ),
    )  # fmt: skip


def _straightening() -> Claim:
    """What the first t2 push after the rotation does to Y."""
    tilt = sp.Symbol("psi", real=True)
    moved = rise(d2, sp.pi / 2 - tilt, sp.pi / 2)
    short = -d1 * sp.sin(tilt) - d2 * (1 - sp.cos(tilt))
    at = {d1: HALF_LENGTH, d2: sp.Integer(150)}
    texts = []
    for degrees in (sp.Rational(71, 100), sp.Rational(392, 100)):
        value = float(moved.subs({**at, tilt: sp.rad(degrees)}))
        texts.append(f"{float(degrees):.2f}°: ${value:.1f}$ µm")
    return Claim(
        key="y-shift-of-straightening",
        title="Straightening moves the part",
        place="new; between Steps 2 and 4",
        derived=r"A $t^2$ push by an upper tip at $d_2$ that turns an edge back from a tilt $\psi$ "
        rf"moves the centre by {tex(short)}. Paper's part on its short edge, $d_2 = 150$ "
        rf"µm: {', '.join(texts)}. At the tilt that the reported push leaves (3.92°) this is more than "
        r"$\epsilon_p/2 = 38$ µm.",
        steps=(r"$Y$ changes by minus the change of the arm's height, $\theta$ from $\pi/2 - \psi$ to "
               r"$\pi/2$.",),
        hypotheses=("the upper tip sticks",),
        checks=(
            identity("shift", moved, short),
            there_is(
                "3.9° (half tangent 1/29): the shift exceeds 38 µm",
                [sp.expand_trig(moved) ** 2 > sp.Integer(38) ** 2],
                at={**at, **angle(sp.Rational(1, 29), tilt)},
            ),
        ),
    )  # fmt: skip


def _limit() -> Claim:
    """How far a Y-translation can be made to go."""
    lo, _ = limits()
    sine, cosine = sp.symbols("sin_phi cos_phi", real=True)
    reach = mu * (rho + d1**2) / d1
    most = 2 * reach * (1 - 1 / sp.sqrt(1 + mu**2))
    texts = [
        rf"$\mu = {float(friction):.2f}$: $\phi < {float(sp.deg(sp.atan(friction))):.1f}°$, "
        + " and ".join(
            f"{float(most.subs({**PAPER, mu: friction, d1: edge})):.0f} µm on the {name} edge"
            for edge, name in ((PAPER[d1], "long"), (HALF_LENGTH, "short"))
        )
        for friction in (LEAST_MU, MOST_MU)
    ]
    tilted = sp.Matrix([sine, cosine])
    given = {
        "sticks": cross(lo, tilted), "lever": d2 * cosine - d1 * sine, "sine": sine,
        "cosine": cosine, "d1": d1, "rho": rho, "d2": d2,
    }  # fmt: skip
    return Claim(
        key="y-gain-limit",
        title="A bound on the gain",
        place="new; Table III reports 11 µm computed, 18 to 20 µm measured",
        derived=r"While both pushes stick, $\phi < \tan^{-1}\mu$ and each contact is within $\mu (\rho + "
        rf"d_1^2)/d_1$ of the centre's foot, so one Y-translation gains less than {tex(most)}. It is a "
        r"bound and not sharp: no motion comes near it, as the contact that rights an edge tilted by "
        r"$\phi$ must be nearer, within $(\mu(\rho + d_1^2) - (\rho - \mu^2 d_1^2/4)\tan\phi)/d_1$. "
        rf"Paper's part, {'; '.join(texts)}.",
        steps=(
            r"Straightening is, mirrored, a push at $d_2 > 0$ on an edge tilted by $\phi$ towards "
            r"smaller $\theta$; it must stick and turn the edge back.",
            r"Sticking at a tilt $\phi \ge 0$ asks for $(\mu B - A)\cos\phi > (C - \mu A)\sin\phi \ge 0$, "
            r"hence $A < \mu B$; so does sticking upright, for the first push.",
            r"$\cos(\tan^{-1}\mu) = 1/\sqrt{1 + \mu^2}$.",
        ),
        hypotheses=(r"$\rho + d_2^2 > \mu d_1 d_2$, for which $4\rho > \mu^2 d_1^2$ is enough",),
        checks=(
            positive_by(
                r"$\tan\phi < \mu$ where a push sticks and turns the edge back",
                mu * cosine - sine,
                given,
                multiplier="cosine*rho + d1*(d2*sine + d1*cosine)",
                combination="cosine*sticks + lever*(d2*sine + d1*cosine)",
            ),
            positive_by(
                r"$d_1 d_2 < \mu (\rho + d_1^2)$ where it sticks",
                d1 * (reach - d2),
                {"sticks": given["sticks"], "sine": sine, "cosine": cosine, "clear": lo[1]},
                multiplier="cosine",
                combination="sticks + clear*sine",
            ),
            for_all(
                r"not sharp: where it sticks, $d_1 d_2 < \mu(\rho + d_1^2) - (\rho - \mu^2 d_1^2/4)"
                r"\tan\phi$",
                [given["sticks"] > 0, sine > 0, cosine > 0],
                d1 * d2 * cosine < mu * (rho + d1**2) * cosine - (rho - mu**2 * d1**2 / 4) * sine,
            ),
            for_all(
                r"$\cos\phi > 1/\sqrt{1 + \mu^2}$ where $\tan\phi < \mu$",
                [sp.sin(phi) > 0, sp.cos(phi) > 0, sp.sin(phi) < mu * sp.cos(phi)],
                sp.cos(phi) ** 2 * (1 + mu**2) > 1,
            ),
        ),
    )
