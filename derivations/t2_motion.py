"""From one-point to two-point sticking: the t^2 motion (paper, Lemma 3 and eq. 12).

Here ``beta`` has the sense of eq. (12): the line through the tips is at ``theta = pi/2 - beta``, so
that ``beta + theta < pi/2`` at the start leaves a counter-clockwise turn to be made. Directions are
vectors of any length (``_arc.py``): the start, one on the way, and the one at which both tips touch.
"""

from __future__ import annotations

from typing import NamedTuple

import sympy as sp
from sympy.logic.boolalg import Boolean

from derivations._arc import Direction, turn
from derivations._circle import tidy
from derivations._claim import Claim
from derivations._derivation import Derivation
from derivations._statement import Finding, Point, angle, crossed, for_all, identity, there_is
from derivations.mechanics import PAPER, beta, d1, d2, d4, mu, theta
from derivations.one_point_sticking import UPPER, A, B, C, scaled, solve_sticking
from derivations.two_point_sticking import solve_two_points

c, s = sp.cos(beta), sp.sin(beta)
BOTH: Direction = (s, c)
"""Cosine and sine of pi/2 - beta, at which both tips touch."""


class Conditions(NamedTuple):
    """What the parts of a t^2 motion need, as derived elsewhere."""

    normal: sp.Expr
    tangential: sp.Expr
    turning: sp.Expr
    first: sp.Expr
    """Normal force of tip 1 once both touch, up to a positive factor."""
    second: sp.Expr

    @classmethod
    def derived(cls) -> Conditions:
        """One-point forces from eq. 5's balance, two-point forces from eq. 9's, beta reversed."""
        pair = [force.subs(beta, -beta) for force in solve_two_points()[:2]]
        scale = tidy((pair[0] + pair[1]) / d4)  # both carry the drag: positive
        return cls(*scaled(solve_sticking()), *(sp.expand(tidy(f / scale)) for f in pair))

    def sticks(self, where: Direction) -> tuple[Boolean, ...]:
        """One-point contact strictly inside the cone."""
        return (
            self._at(mu * self.normal - self.tangential, where) > 0,
            self._at(mu * self.normal + self.tangential, where) > 0,
        )

    def turns(self, where: Direction) -> Boolean:
        """The part turns counter-clockwise."""
        return self._at(self.turning, where) > 0

    def settles(self) -> tuple[Boolean, ...]:
        """Two-point sticking at the end."""
        return (*steep(), self.first > 0, self.second > 0)

    @staticmethod
    def _at(expression: sp.Expr, where: Direction) -> sp.Expr:
        pair = {sp.cos(theta): where[0], sp.sin(theta): where[1]}
        return expression.subs(pair, simultaneous=True)


def steep() -> tuple[Boolean, ...]:
    """``|tan beta| < mu``."""
    return s < mu * c, -s < mu * c


def printed() -> tuple[Boolean, ...]:
    """Eq. (12), multiplied out; beta within a quarter turn."""
    return (
        c > 0, d2 > 0, *steep(),
        s * d1 < d2 * c, -s * d1 < d2 * c,
        s * C < A * c, -s * C < A * c,
    )  # fmt: skip


def derive() -> Derivation:
    """Check Lemma 3 as printed, complete it, and give the exact form."""
    needs = Conditions.derived()
    return Derivation(
        name="t2_motion",
        summary="From one-point to two-point sticking (Lemma 3, eq. 12).",
        claims=(_lemma_3(needs), _exact(needs), _sense_of_beta()),
    )


START = sp.symbols("p_x p_y", real=True)
NOW = sp.symbols("q_x q_y", real=True)
AHEAD = (START[1] > 0, turn(START, BOTH) > 0)
"""The start lies in (0, pi), before the orientation at which both tips touch."""
ON_THE_WAY = (NOW[1] > 0, turn(START, NOW) > 0, turn(NOW, BOTH) > 0)
BEFORE = sp.Symbol("theta", real=True)


def _start(half_tangent: sp.Rational, offset: int, spacing: int) -> Point:
    """The paper's part at mu = 0.33, tips misaligned by tan(beta/2) = 1/1000 (0.11 deg)."""
    orientation = angle(half_tangent, BEFORE)
    return {
        **PAPER, d2: sp.Integer(offset), d4: sp.Integer(spacing),
        **angle(sp.Rational(1, 1000), beta),
        START[0]: orientation[sp.cos(BEFORE)], START[1]: orientation[sp.sin(BEFORE)],
    }  # fmt: skip


def _lemma_3(needs: Conditions) -> Claim:
    begins = (*needs.sticks(START), needs.turns(START))
    slipping = _start(sp.Rational(28, 29), offset=600, spacing=1000)
    lifting = _start(sp.Rational(60, 61), offset=350, spacing=300)
    return Claim(
        key="lemma-3",
        title="Lemma 3: one-point sticking leads to two-point sticking",
        place="Lemma 3 and eq. (12), Section IX-E",
        printed=r"If the top tip touches first and $|\tan\beta| < \min\{\mu,\ d_2/d_1,\ d_1 d_2 e_x/"
        r"(e_\theta + d_2^2 e_x)\}$, $\beta + \theta < \pi/2$, a counter-clockwise rotation with "
        "one-point sticking contact can be followed by two-point sticking",
        derived=r"True if moreover the first contact sticks and turns the part counter-clockwise "
        r"at the start (eq. (5), not implied by (12)) and tip 1 presses at the end: $d_2 < d_4/"
        r"\cos\beta + d_1 \tan\beta$ in this sense of $\beta$.",
        steps=(
            r"$D > 0$ where both tips touch is the third bound, $A\cos\beta + C\sin\beta > 0$: the "
            r"force ratio still grows there, so sticking that holds at the start holds on the way.",
            r"At the start nothing in (12) keeps $|D| < \mu N$: for a contact far from the centre "
            "or a start far from upright the tip slips.",
            r"$\lambda_n^2 > 0$ follows from turning counter-clockwise; $\lambda_n^1 > 0$ does not.",
        ),
        hypotheses=(
            r"the contact sticks at the start: $|D| < \mu N$ at $\theta_0$",
            r"it turns the part counter-clockwise: $d_2 \sin\theta_0 > d_1 \cos\theta_0$",
            r"$\lambda_n^1 > 0$: $d_2\cos\beta - d_1 \sin\beta < d_4$",
        ),
        added=(
            r"the contact sticks at the start: $|D| < \mu N$ at $\theta_0$",
            r"it turns the part counter-clockwise: $d_2 \sin\theta_0 > d_1 \cos\theta_0$",
            r"$\lambda_n^1 > 0$: $d_2\cos\beta - d_1 \sin\beta < d_4$",
        ),
        of_print=(
            for_all(
                "(12) implies that the first contact sticks at the start (lengths in µm)",
                [*printed(), *AHEAD],
                sp.And(*needs.sticks(START)),
                at=slipping,
            ),
            for_all(
                "(12) and a start that sticks and turns imply two-point sticking at the end "
                "(lengths in µm)",
                [*printed(), *AHEAD, *begins],
                sp.And(*needs.settles()),
                at=lifting,
            ),
        ),
        with_added=(
            *_stays(needs, [*printed(), *AHEAD, *begins], _third_bound()),
            for_all(
                "both tips press and stick at the end",
                [*printed(), *AHEAD, *begins, needs.first > 0],
                sp.And(*needs.settles()),
            ),
        ),
    )


def _third_bound() -> Boolean:
    """Both tips touch before the force ratio stops growing."""
    return A * c + C * s > 0


def _stays(needs: Conditions, given: list[Boolean], last: Boolean) -> tuple[Finding, ...]:
    """Sticking and turning at the end, and then at every direction between start and end."""
    at_end = [*needs.sticks(BOTH), needs.turns(BOTH)]
    end = sp.symbols("e_x0 e_y0", real=True)  # any direction instead of that of beta
    onward = [NOW[1] > 0, end[1] > 0, turn(START, NOW) > 0, turn(NOW, end) > 0]
    arc = [START[1] > 0, *needs.sticks(START), needs.turns(START), *needs.sticks(end)]
    return (
        for_all(
            "the contact still sticks and turns where both tips touch",
            [*given, last],
            sp.And(*at_end),
        ),
        for_all(
            "a contact that sticks at two directions sticks at those between",
            [*arc, *onward],
            sp.And(*needs.sticks(NOW)),
        ),
        for_all(
            "a part that turns counter-clockwise at the start does so on the way",
            [START[1] > 0, NOW[1] > 0, needs.turns(START), turn(START, NOW) > 0],
            needs.turns(NOW),
        ),
    )


def _exact(needs: Conditions) -> Claim:
    """The exact conditions: each printed bound is either redundant or replaced by a wider one."""
    begins = [c > 0, *AHEAD, *needs.sticks(START), needs.turns(START)]
    limit = (A + mu * B) * c + (C + mu * A) * s > 0
    return Claim(
        key="lemma-3-exact",
        title="Exact conditions of the t² motion",
        place="new; sharpens Lemma 3",
        derived=r"Let the first contact stick and turn counter-clockwise at a start with $\theta_0 "
        r"+ \beta < \pi/2$. Then one-point sticking lasts until both tips touch exactly if "
        r"$(A + \mu B)\cos\beta + (C + \mu A)\sin\beta > 0$, and two-point sticking follows exactly "
        r"if in addition $|\tan\beta| < \mu$ and $d_2\cos\beta - d_1\sin\beta < d_4$. For $\beta \ge "
        r"0$ the first always holds; for $\beta < 0$ it is $\tan|\beta| < (A + \mu B)/(C + \mu A)$ "
        r"(where $C + \mu A > 0$, as for $d_2 \ge 0$), which the printed third bound implies, and "
        r"which follows from $|\tan\beta| < \mu$ if $|d_2| \le d_1$, $\mu \le 1$. The printed bound "
        r"$d_2/d_1$ is not needed.",
        steps=(
            r"One-point sticking ends at $\theta_{hi}$ (exact sticking interval). Both tips touch at "
            r"$\pi/2 - \beta$; it comes first exactly if the turn from there to $\theta_{hi}$ is "
            r"positive, $(A + \mu B)\cos\beta + (C + \mu A)\sin\beta > 0$.",
            r"With $\beta > 0$ that holds whenever the start does.",
            r"Counter-clockwise turning at the start already makes $d_2\cos\beta > d_1\sin\beta$ at "
            "the end.",
        ),
        hypotheses=(
            r"the first contact sticks and turns the part counter-clockwise at $\theta_0$",
            r"$\theta_0 \in (0, \pi/2 - \beta)$, $|\beta| < \pi/2$",
        ),
        checks=(
            identity(
                r"turn from the two-point orientation to $\theta_{hi}$",
                turn(BOTH, UPPER),
                (A + mu * B) * c + (C + mu * A) * s,
            ),
            for_all(
                "sticking until both tips touch is equivalent to the exact bound",
                begins,
                sp.Equivalent(sp.And(*needs.sticks(BOTH)), limit),
            ),
            *_stays(needs, begins, limit),
            for_all(
                r"the printed third bound implies the exact one",
                [*begins, _third_bound()],
                limit,
            ),
            for_all(
                r"for $\beta \ge 0$ the exact bound holds by itself",
                [*begins, s >= 0],
                limit,
            ),
            for_all(
                r"for $|d_2| \le d_1$, $\mu \le 1$ it follows from $|\tan\beta| < \mu$",
                [*begins, *steep(), d2 <= d1, d2 >= -d1, mu <= 1],
                limit,
            ),
            for_all(r"$\tan\beta < d_2/d_1$ holds by itself", begins, d2 * c > d1 * s),
            for_all(r"$C + \mu A > 0$ for $d_2 \ge 0$", [d2 >= 0], C + mu * A > 0),
            for_all(
                r"and so is $\lambda_n^2 > 0$",
                begins,
                needs.second > 0,
            ),
            _room_beyond_the_print(needs),
        ),
    )


def _room_beyond_the_print(needs: Conditions) -> Finding:
    """A t^2 motion that the printed bounds refuse and the exact ones prove."""
    refused = {
        **_start(sp.Rational(63, 64), offset=60, spacing=580),
        **angle(sp.Rational(-1, 20), beta),
    }
    return there_is(
        "a motion that (12) refuses and the exact conditions allow (lengths in µm)",
        [
            c > 0, *AHEAD, *needs.sticks(START), needs.turns(START), *needs.sticks(BOTH),
            *needs.settles(), -s * C > A * c,
        ],
        at=refused,
    )  # fmt: skip


def _sense_of_beta() -> Claim:
    """Eqs. (9) and (12) measure beta in opposite senses."""
    slope = sp.Symbol("theta_0", real=True)
    first = solve_two_points()[0]
    e_x, v_p = sp.Symbol("e_x", positive=True), sp.Symbol("v_p", negative=True)
    printed_9 = e_x * v_p * c * (d1 * s + d2 * c - d4) / d4
    start = (sp.cos(slope), sp.sin(slope))
    before = start[0] * c - start[1] * s  # cos(beta + theta_0)
    tilted = {**angle(sp.Integer(1), slope), **angle(sp.Rational(-1, 1000), beta)}
    here = {d1: PAPER[d1], d2: 350, d4: 580, e_x: 1, v_p: -1, **angle(sp.Rational(1, 1000), beta)}
    return Claim(
        key="sense-of-beta",
        title="Sense of the misalignment",
        place="eqs. (9) and (12), Fig. 10",
        printed=r"$\lambda_n^1 = e_x v_p \cos\beta\,(d_1 \sin\beta + d_2\cos\beta - d_4)/d_4$ in (9); "
        r"$\beta + \theta < \pi/2$, so that a counter-clockwise rotation precedes, in (12)",
        derived=r"(9) holds for an edge at $\theta = \pi/2 + \beta$ only; there a counter-clockwise "
        r"rotation precedes if $\theta < \pi/2 + \beta$. The inequality of (12) is right for the "
        "opposite sense. No one sense of $\\beta$ makes both true.",
        steps=(
            r"In the sense of (9) tip 1, the upper one, is ahead for $\beta > 0$; in that of (12) it "
            "lags behind.",
        ),
        consistent=(
            for_all(
                r"in the sense of (9): $\beta + \theta_0 < \pi/2$ leaves a counter-clockwise turn "
                r"to $\pi/2 + \beta$",
                [c > 0, start[1] > 0, before > 0],
                turn(start, (-s, c)) > 0,
                at=tilted,
            ),
            identity(
                "in the sense of (12): (9) gives the force of tip 1 (lengths in µm)",
                printed_9,
                first.subs(beta, -beta),
                at=here,
            ),
        ),
        checks=(
            identity(
                r"in the sense of (12): the turn from $\theta_0$ to $\pi/2 - \beta$ is $\cos(\beta + "
                r"\theta_0)$, counter-clockwise for $\beta + \theta_0 < \pi/2$",
                crossed(start, BOTH),
                sp.cos(beta + slope),
            ),
            identity("in the sense of (9): (9) gives the force of tip 1", printed_9, first),
        ),
    )
