"""What the letters mean, and how a reader checks what the register says."""

from __future__ import annotations

ABOUT_REGISTER = (
    "Statements of “Automated Assembly for Mesoscale Parts” (below: the paper), each derived anew from "
    "the balance of forces, rigid-body motion and Coulomb's law. Every verdict is computed from "
    "findings that can be checked; none is typed."
)
FRAME = (
    "Everything is planar: $x$ to the right, $y$ up, angles counter-clockwise. The drawings show the "
    "paper's part to scale; misalignment and tilt are larger than in use."
)
SYMBOLS = (
    (r"$\theta$", "orientation of the part: angle from $x$ to the pushed edge, counter-clockwise"),
    (r"$a$, $n$", r"unit vectors along that edge and outward: $a = (\cos\theta, \sin\theta)$, "
     r"$n = (\sin\theta, -\cos\theta)$"),
    (r"$d_1$, $d_2$", "distance of the pushed edge from the centre; offset of the tip along $a$"),
    (r"$\beta$, $d_4$", "misalignment of the two tips of the active probe; their spacing across the "
     "push"),
    (r"$v_p$, $\xi$", r"velocity of the tip along $x$, negative; its travel along $-x$"),
    (r"$\lambda_n$, $\lambda_t$", "contact force on the part, along $-n$ and along $a$; a raised "
     "index names the tip"),
    (r"$\mu$", "coefficient of friction between tip and part"),
    (r"$E$", r"drag of the film, wrench $= E \cdot$ velocity, $E = \mathrm{diag}(e_x, e_x, "
     r"e_\theta)$"),
    (r"$\rho$", r"$e_\theta/e_x$, an area"),
    (r"$A$, $B$, $C$, $F$", r"$d_1 d_2$, $\rho + d_1^2$, $\rho + d_2^2$, $\rho + d_1^2 + d_2^2$"),
    (r"$N$, $D$", r"$A\cos\theta + B\sin\theta$, $C\cos\theta + A\sin\theta$; in one-point sticking "
     r"$\lambda_n = -e_x v_p N/F$ and $\lambda_t = e_x v_p D/F$"),
    ("D, S", "moving and passive tip of the two-sided rotation"),
    (r"$h$, $V$, $w$", r"S to D along and across the push ($V$ is printed $d_v$); width of the part, "
     r"$w = 2 d_1$ (printed $d_w$)"),
    (r"$T$, $\sigma$", r"distance of the two contacts along $a$; offset of the centre along $a$ from "
     "their middle"),
)  # fmt: skip
"""(letters, meaning), both with LaTeX between dollar signs."""

ROUTES = (
    ("identity", "the difference of both sides simplifies to zero"),
    ("certificate", "the goal, times a positive factor, is written out as a sum of products of "
     "quantities that are given as positive; whoever expands both sides has checked it"),
    ("z3", "the solver z3 was asked for values at which the statement fails; the question is stored"),
    ("witness", "exact rational values at which the statement fails or, for an existence, holds; "
     "putting them in checks it"),
)  # fmt: skip
"""(route, what it means)."""

RERUN = (
    "A stored question is SMT-LIB 2 text (logic QF_NRA) that any solver for it reads: "
    "`z3 file.smt2` must print the answer given beside the link. For a proof that is `unsat`: no "
    "values make the premises true and the conclusion false."
)
"""How to put a stored query to a solver; commands between backquotes."""

REMAKE = (
    "`meso-robust derive` decides everything anew and writes this folder; `meso-robust derive "
    "--check` tells whether it would change."
)
"""How to make the register again; commands between backquotes."""


def headline(stands: int, printed: int) -> str:
    """The one line at the top."""
    if not printed:
        return "No printed statement is in the register"
    return f"{stands} of {printed} printed statements stand as printed"
