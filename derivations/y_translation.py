"""Net displacement of the Y-translation: tilt about one contact, straighten about another.

While a contact sticks its height is that of the tip, so the centre moves by the change of the
arm's height. Tilt about offset ``d2`` from ``t0`` to ``t1``, straighten about ``d2'`` to ``t2``; the terms in
``cos(t1)`` cancel, which is why the gain does not suffer from an uncertain tilt to first order.
"""

from __future__ import annotations

import sympy as sp

from derivations._derivation import Derivation, Statement, require_zero, verdict
from derivations.mechanics import a, d1, d2, n, theta


def derive() -> Derivation:
    """Derive the gain and compare with ``l_AB (1 - cos phi)``."""
    back, phi = sp.symbols("d2_back phi", real=True)
    t0, t1, t2 = sp.symbols("theta_0 theta_1 theta_2", real=True)

    def height(offset: sp.Expr, angle: sp.Expr) -> sp.Expr:
        return (offset * a + d1 * n)[1].subs(theta, angle)

    gain = height(d2, t0) - height(d2, t1) + height(back, t1) - height(back, t2)
    compact = (
        d2 * (sp.sin(t0) - sp.sin(t1))
        + back * (sp.sin(t1) - sp.sin(t2))
        - d1 * (sp.cos(t0) - sp.cos(t2))
    )
    require_zero(gain - compact, "cos(t1) cancels")
    upright = {t0: sp.pi / 2, t1: sp.pi / 2 + phi, t2: sp.pi / 2}
    return Derivation(
        name="y_translation",
        summary="Net displacement of the Y-translation (paper, Section IX-E).",
        statements=(
            Statement(
                place="Section IX-E, Y-translation",
                text="net gain l_AB (1 - cos phi) with l_AB the distance of the two contacts",
                status=verdict(compact.subs(upright) - (d2 - back) * (1 - sp.cos(phi))),
            ),
        ),
        functions={
            "gain": (
                (t0, t1, t2, d1, d2, back),
                (compact,),
                "m: rise of the centre over tilt and straightening",
            ),
        },
    )
