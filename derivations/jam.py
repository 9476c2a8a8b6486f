"""The jam of a part between two tips: any linear film, round tips, edges out of parallel.

Notation of ``opposite_edges``. All determinants below are of wrenches about S's contact. Divided by the
grip, slide and forces are quotients of determinants that share two columns, so that where a ratio of
friction moves, the slide moves in the sense of a product: the force at that tip, and the moment of the
other tip's force about that tip's contact. Neither the film nor the speed of the push is in the latter:
where the line through both contacts lies within both cones of friction the part can jam.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator

import sympy as sp
from sympy.logic.boolalg import Boolean

from derivations._claim import Claim
from derivations._derivation import Derivation
from derivations._statement import as_written, for_all, identity
from derivations.opposite_edges import (
    CK,
    FORCES,
    SK,
    arms,
    determinant,
    pushes,
    slips,
    wrenches,
)
from derivations.two_sided_rotation import T, tau_D, tau_S

other = sp.Symbol("tau", real=True)
"""Another ratio of friction of the same tip."""
slip_D, slip_S, i, j = sp.symbols("v_D v_S i j", real=True)
"""Slips over both tips; shares of the way from -mu to mu in both cones."""
GRIPS = {(p, q): sp.Symbol(f"N_{p}{q}", real=True) for p in (0, 1) for q in (0, 1)}
OVER_D = {(p, q): sp.Symbol(f"D_{p}{q}", real=True) for p in (0, 1) for q in (0, 1)}
OVER_S = {(p, q): sp.Symbol(f"S_{p}{q}", real=True) for p in (0, 1) for q in (0, 1)}
"""At the corners of both cones, 0 for -mu and 1 for mu: the grip, and the slips times the grip."""
FIRST, MIDDLE, LAST = (0, 0), (0, 1), (1, 1)
"""The walk through the ratios."""
Corners = dict[tuple[int, int], sp.Symbol]


def lever_D() -> sp.Expr:
    """Moment of D's force about S's contact, over its normal part."""
    return arms()[0][0] + tau_D * arms()[0][1]


def lever_S() -> sp.Expr:
    """Moment of S's force about D's contact, over its normal part."""
    to_D, force = arms()[0], sp.Matrix([SK + tau_S * CK, CK - tau_S * SK])
    return pushes(-to_D, force)[2]


def derive() -> Derivation:
    """Derive when no motion is left."""
    return Derivation(
        name="jam",
        summary="The jam of a part between two tips.",
        claims=(_senses(), _between(), _no_motion()),
    )


def _senses() -> Claim:
    """In which sense the slide moves with either ratio."""
    x, y, z, a, b = (sp.Matrix(sp.symbols(f"{name}1:4", real=True)) for name in "xyzab")
    to_D = arms()[0]
    on_D, on_S = wrenches(tau_D, tau_S, to_D)
    again_D, again_S = wrenches(other, other, to_D)
    one, more = sp.symbols("u_1 u_2", real=True)
    return Claim(
        key="jam-senses",
        title="In which sense the slide moves with friction, any film",
        place="new; the jam of real tips and real parts",
        derived=r"Let $u = q'$ be the slide rate at a pair of ratios and $N$ the grip there. Between two "
        r"ratios of S at which $N > 0$, that of D being one, $u$ grows with S's ratio in the sense of $L_S N\,"
        r"M_D$, with $M_D = x + \tau_D y$ the moment of D's force about S's contact, $(x, y)$ the way from "
        r"there to D's contact along and across D's edge. So it does with D's ratio in the sense of "
        r"$L_D N\,M_S$, $M_S = (\cos\kappa - \tau_S\sin\kappa)\,x - (\sin\kappa + \tau_S\cos\kappa)\,y$ "
        r"the moment of S's force about D's contact. The slips at both tips grow with $u$ if $x > 0$ and "
        r"$x\cos\kappa > y\sin\kappa$.",
        steps=(
            r"$u = |w_D, w_S, EV_0| / N$ with $N = -|w_D, w_S, EV_1|$, $L_S N = -|w_D, EV_0, EV_1|$ and $L_D N "
            r"= -|EV_0, w_S, EV_1|$ (see slide and forces between two tips, any drag).",
            r"Two such quotients with $w_S$ and $w_S'$ differ by $|w_D, w_S, w_S'|\,|w_D, EV_0, EV_1|$ over both "
            r"grips (Plücker), so that the film is in the force alone.",
            r"Both forces at S pass through its contact, so $|w_D, w_S, w_S'|$ is the moment of $w_D$ about it.",
        ),
        hypotheses=(FORCES, "both tips touch their edges between the vertices"),
        checks=(
            identity(
                "Plücker's relation of five columns",
                as_written(
                    lambda: (
                        determinant(x, y, a) * determinant(x, z, b)
                        - determinant(x, z, a) * determinant(x, y, b)
                    )
                ),
                determinant(x, y, z) * determinant(x, a, b),
            ),
            identity(
                "the same of three forces, the last column being that of D",
                as_written(
                    lambda: (
                        determinant(y, x, a) * determinant(z, x, b)
                        - determinant(z, x, a) * determinant(y, x, b)
                    )
                ),
                -determinant(y, z, x) * determinant(a, x, b),
            ),
            identity(
                "two forces at S, and one at D",
                determinant(on_D, on_S, again_S),
                (tau_S - other) * lever_D(),
            ),
            identity(
                "two forces at D, and one at S",
                determinant(on_D, again_D, on_S),
                (other - tau_D) * lever_S(),
            ),
            identity(
                "the slips grow with the slide rate",
                [of - less for of, less in zip(slips(one), slips(more), strict=True)],
                [(one - more) * lean / T for lean in _leans()],
            ),
        ),
    )


def _leans() -> tuple[sp.Expr, sp.Expr]:
    """How the slips at D and at S grow with the slide rate, times T."""
    x, y = arms()[0]
    return x * CK - y * SK, x


def _between_corners(of: Corners) -> sp.Expr:
    """What is of first degree in either ratio, from its values at the corners."""
    weights = {(p, q): (i if p else 1 - i) * (j if q else 1 - j) for p, q in of}
    return sum((weights[at] * value for at, value in of.items()), sp.Integer(0))


def _motion() -> tuple[Boolean, ...]:
    """Both tips press, slips and grip fit the ratios, and friction opposes the slips."""
    grip = _between_corners(GRIPS)
    return (
        grip > 0,
        sp.Eq(slip_D * grip, _between_corners(OVER_D)),
        sp.Eq(slip_S * grip, _between_corners(OVER_S)),
        *(share >= 0 for share in (i, j)),
        *(share <= 1 for share in (i, j)),
        *(sp.Or(slip <= 0, sp.Eq(share, 0)) for slip, share in ((slip_D, i), (slip_S, j))),
        *(sp.Or(slip >= 0, sp.Eq(share, 1)) for slip, share in ((slip_D, i), (slip_S, j))),
        sp.Or(slip_S < 0, slip_D > 0),
    )


OUTER = (OVER_S[FIRST] < 0, OVER_D[LAST] > 0)
"""The part slips neither forward over both tips nor backward over both, where the grip is positive."""
FALLS = (
    GRIPS[MIDDLE] <= 0,
    OVER_S[MIDDLE] * GRIPS[FIRST] - OVER_S[FIRST] * GRIPS[MIDDLE] <= 0,
    OVER_D[MIDDLE] * GRIPS[LAST] - OVER_D[LAST] * GRIPS[MIDDLE] >= 0,
)
"""The grip is closed at the middle, and towards it the slips go away from zero."""
ORDER = r"the part slips towards $+a$ over D where it does not slip towards $-a$ over S: contacts that approach each other"
PRESS = (
    r"every motion has a positive grip: $L_D N > 0$ at all ratios, and no tip is left (see contact with "
    r"both tips is kept where both forces are positive)"
)
WORDS = (
    r"Forces and slips, times the grip, are of first degree in either ratio, so that their values at the "
    r"corners of both cones tell all.",
)


def _between() -> Claim:
    """What bounds the slide while it is open whether a motion exists."""
    motion = _motion()
    return Claim(
        key="jam-between",
        title="The slide between two tips, whether or not they jam the part",
        place="new; the jam of real tips and real parts",
        derived=r"Let the slip at S, times $N$, be negative at $(-\mu_D, -\mu_S)$ and that at D positive at "
        r"$(\mu_D, \mu_S)$. Then in every motion the part slips at most at $0$ over S and at least at $0$ over "
        r"D: the slide rate lies between those at which D and S stick, even where the grip can close.",
        steps=WORDS,
        hypotheses=(FORCES, PRESS, ORDER),
        checks=tuple(
            for_all(what, [*OUTER, *motion], then)
            for what, then in (
                ("no motion slips towards +a over S", slip_S <= 0),
                ("no motion slips towards -a over D", slip_D >= 0),
            )
        ),
    )


def _no_motion() -> Claim:
    """The jam itself."""
    return Claim(
        key="jam-any-film",
        title="Two tips jam the part, any film, round tips, edges out of parallel",
        place="new; “the part jams” for real tips and real parts",
        derived=r"Let moreover the grip not be positive at $(-\mu_D, \mu_S)$, and let the line through both "
        r"contacts lie within both cones: $M_D < 0$ at $\tau_D = -\mu_D$ and $M_S < 0$ at $\tau_S = \mu_S$. "
        r"Then no motion exists: the part jams.",
        steps=(
            *WORDS,
            r"$M_D < 0$ and $L_S N > 0$: from $(-\mu_D, -\mu_S)$ to $(-\mu_D, \mu_S)$ the slide rate falls "
            r"where the grip is positive, and with it the slip at S, which is negative from the start: S never "
            r"sticks. Likewise D does not from $(\mu_D, \mu_S)$ on.",
        ),
        hypotheses=(
            FORCES,
            PRESS,
            ORDER,
            r"slips grow with the slide rate: $x > 0$ and $x\cos\kappa > y\sin\kappa$",
        ),
        checks=tuple(
            for_all(
                f"no motion in which the part slips {what}",
                [*OUTER, *FALLS, *ways],
                sp.Not(sp.And(*_motion())),
            )
            for what, ways in _ways()
        ),
    )


def _ways() -> Iterator[tuple[str, tuple[Boolean, ...]]]:
    """All signs of both slips."""
    for at_D, at_S in itertools.product(("towards +a", "not", "towards -a"), repeat=2):
        yield f"{at_D} over D, {at_S} over S", (_way(slip_D, at_D), _way(slip_S, at_S))


def _way(slip: sp.Symbol, way: str) -> Boolean:
    return {"towards +a": slip > 0, "not": sp.Eq(slip, 0), "towards -a": slip < 0}[way]
