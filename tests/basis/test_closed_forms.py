"""The basis certificate against the lemmas' closed forms on random boxes."""

from __future__ import annotations

from random import Random

import casadi as ca

from meso_robust.basis import Mode, Tip, diagonal_film, prove_basis, symbol
from meso_robust.bounds import HALF_PI, Box, Interval, Verdict, prove_positive
from meso_robust.conditions import condition
from tests.basis.examples import LEFT, ONE, RECTANGLE, SHORT

DEPTH = Interval.point(0.5 * SHORT)
PROVED, REFUTED = Verdict.PROVED, Verdict.REFUTED


def around(random: Random, low: float, high: float, width: float) -> Interval:
    middle = random.uniform(low, high)
    return Interval(middle - width / 2, middle + width / 2)


def closed(box: Box, *named: tuple[str, str]) -> Verdict:
    """Verdict of several closed-form conditions together."""
    found = [prove_positive(condition(*name), box).verdict for name in named]
    if all(verdict is PROVED for verdict in found):
        return PROVED
    return REFUTED if REFUTED in found else Verdict.UNKNOWN


def test_one_tip_agrees_with_the_sticking_interval() -> None:
    random, both, neither = Random(5), 0, 0
    for _ in range(150):
        box = {
            "theta": around(random, 1.2, 2.4, random.choice([0.01, 0.1])),
            "d2": around(random, -5e-4, 5e-4, 2e-5),
            "mu": around(random, 0.2, 0.6, 0.04),
            "rho": around(random, 2e-7, 5e-7, 2e-8),
        }
        lemma = closed(
            {**box, "d1": DEPTH},
            ("one_point_sticking", "normal_force"),
            ("one_point_sticking", "friction_margin"),
        )
        proof = prove_basis(RECTANGLE, ONE, diagonal_film("rho"), [Mode.STICK], box)
        assert {lemma, proof.verdict} != {PROVED, REFUTED}
        assert lemma is proof.verdict
        if (
            proof.verdict is PROVED
            and closed({**box, "d1": DEPTH}, ("one_point_sticking", "only_solution")) is PROVED
        ):
            assert proof.unique is PROVED
        both += proof.verdict is PROVED
        neither += proof.verdict is REFUTED
    assert both > 20
    assert neither > 20


def test_two_tips_agree_with_equation_9() -> None:
    """The line of the tips is tilted by beta against the push; the edge lies on it."""
    random, both, neither = Random(7), 0, 0
    second = symbol("d2") - symbol("d4") / ca.sin(symbol("theta"))  # theta = pi/2 + beta
    tips = (*ONE, Tip(edge=0, at=second, friction="mu", mover=LEFT))
    for _ in range(150):
        beta = around(random, -0.5, 0.5, random.choice([0.01, 0.05]))
        spacing = 3e-4
        d2 = around(random, -2e-4, 5e-4, 1e-5)
        mu = around(random, 0.25, 0.4, 0.02)
        lemma = closed(
            {"beta": beta, "mu": mu, "d1": DEPTH, "d2": d2, "d4": Interval.point(spacing)},
            ("two_point_sticking", "normal_forces"),
            ("two_point_sticking", "friction_margin"),
        )
        box = {
            "theta": HALF_PI + beta,
            "d2": d2,
            "d4": Interval.point(spacing),
            "mu": mu,
            "rho": Interval(3.0e-7, 4.0e-7),
        }
        proof = prove_basis(RECTANGLE, tips, diagonal_film("rho"), [Mode.STICK] * 2, box)
        assert {lemma, proof.verdict} != {PROVED, REFUTED}
        both += lemma is proof.verdict is PROVED
        neither += lemma is proof.verdict is REFUTED
    assert both > 15
    assert neither > 40
