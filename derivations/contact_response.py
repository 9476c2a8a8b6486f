"""How a part on a film answers to forces at its contacts: what every contact mode is solved from.

The film's drag over ``e_x`` is ``[[1 + stretch, shear], [shear, 1 - stretch]]`` for the translation of
its centre and ``rho`` for the turn, in axes that are fixed in the part; points are given from the
centre of drag. The pages that move put contacts together from this response: sticking is two
equations for a contact, slipping one with the force at the edge of the friction cone, whatever the
number of contacts, the edges they lie on and the radii of the tips.
"""

from __future__ import annotations

import sympy as sp

from derivations._claim import Claim
from derivations._derivation import Derivation, Function
from derivations._statement import identity
from derivations.drag_tensor import (
    A_HAT,
    C_HAT,
    DRAG,
    F_HAT,
    D_aa,
    D_an,
    D_at,
    D_nn,
    D_nt,
    D_tt,
    solve_sticking,
)
from derivations.mechanics import cross, d1, d2, rho, theta, velocity_at

stretch, shear = sp.symbols("stretch shear", real=True)
x, y, x_f, y_f, f_x, f_y = sp.symbols("x y x_f y_f f_x f_y", real=True)
tau = sp.Symbol("tau", real=True)
TENSOR = sp.Matrix([[1 + stretch, shear], [shear, 1 - stretch]])
CENTRED = {D_aa: 1 + stretch, D_an: shear, D_nn: 1 - stretch, D_tt: rho, D_at: 0, D_nt: 0}
"""The drag of ``drag_tensor`` about its own centre."""
FORCE = sp.Matrix([f_x, f_y])
TURN = cross(sp.Matrix([x_f, y_f]), FORCE) / rho
DETERMINANT = 1 - stretch**2 - shear**2
FLOW = sp.Matrix([(1 - stretch) * f_x - shear * f_y, (1 + stretch) * f_y - shear * f_x])
TWIST = sp.Matrix([*(FLOW / DETERMINANT), TURN])
VELOCITY = velocity_at(TWIST, sp.Matrix([x, y]))


def derive() -> Derivation:
    """Derive the velocity of any point of the part under a force at any other."""
    return Derivation(
        name="contact_response",
        summary="The answer of a part on a film to a force at a contact.",
        claims=(_response(),),
        functions={
            "velocity": Function(
                arguments=(x, y, x_f, y_f, f_x, f_y, rho, stretch, shear),
                results=tuple(VELOCITY),
                unit="1",
                meaning="velocity of the part's point (x, y) where a force (f_x, f_y), over e_x, acts at "
                "(x_f, y_f); both from the centre of drag, in axes of the part",
            ),
            "turning": Function(
                arguments=(x_f, y_f, f_x, f_y, rho),
                results=(TURN,),
                unit="1/m",
                meaning="rate of the turn under that force",
            ),
        },
    )


def _response() -> Claim:
    """The response solves the balance, and gives the contacts of `drag_tensor`."""
    drag = sp.Matrix([*(TENSOR * TWIST[:2, :]), rho * TURN])
    push = sp.Matrix([f_x, f_y, cross(sp.Matrix([x_f, y_f]), FORCE)])
    # along a and n of an edge, which run clockwise: n is a turned by -90 deg, so shear and turn change sign
    at_contact = VELOCITY.subs({x: d2, y: -d1, x_f: d2, y_f: -d1, shear: -shear})
    pushed = at_contact.subs({f_x: tau, f_y: 1}, simultaneous=True)
    opening = pushed[1]  # of the contact along -n, under the force -n + tau a
    sticking = [part.subs(CENTRED) / F_HAT.subs(CENTRED) for part in solve_sticking()]
    turn, pressing, along = sticking
    held = at_contact.subs({f_x: along, f_y: pressing}, simultaneous=True)
    turned = TURN.subs({x_f: d2, y_f: -d1, f_x: along, f_y: pressing}, simultaneous=True)
    det = sp.Determinant(sp.ImmutableMatrix(DRAG.subs(CENTRED)))
    return Claim(
        key="contact-response",
        title="The answer of a part to a force at a contact",
        place="new; the paper solves each contact mode by itself",
        derived=r"Under a force $f$ at $q_f$ from the centre of drag, the point $q$ of the part moves with "
        r"$D^{-1} f + \rho^{-1} (q_f \times f)\, \hat z \times q$ and the part turns at $(q_f \times f)/\rho$, "
        r"over $e_x$. With the forces of a sticking tip the contact moves with the tip; under $-n + \tau a$ it "
        r"gives way at $(\hat C + \tau\hat A)/\det D$.",
        hypotheses=("the drag is linear in the twist, symmetric and positive definite",),
        checks=(
            identity("drag of the motion = force and its moment", drag, list(push)),
            identity(
                "a sticking contact moves with the tip, along $a$ and $-n$",
                held,
                [-sp.cos(theta), sp.sin(theta)],
            ),
            identity("and the part turns as there", turned, turn),
            identity(
                r"a contact under $-n + \tau a$ gives way at $(\hat C + \tau\hat A)/\det D$",
                opening * det,
                (C_HAT + tau * A_HAT).subs(CENTRED),
            ),
        ),
    )
