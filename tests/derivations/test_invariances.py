"""Invariances and identifiability against motions solved by elimination in exact rationals."""

from __future__ import annotations

import random
from collections.abc import Callable
from fractions import Fraction
from functools import cache
from typing import Any, NamedTuple

import pytest
import sympy as sp

from derivations import invariances, mechanics
from derivations._claim import Claim, Verdict
from derivations._statement import DerivationError
from tests.derivations.exact import (
    Vector,
    balance_rows,
    dot,
    force_column,
    moment,
    plus,
    solve,
    velocity_row,
)

Q = Fraction
HALF, RHO = Q(837, 2), Q(376_900)
VERDICTS = {
    "complete-conditions": Verdict.NEW,
    "film-scale": Verdict.NEW,
    "rate-film": Verdict.NEW,
    "size-invariance": Verdict.NEW,
    "film-isotropy": Verdict.NEW,
    "twist-of-one-contact": Verdict.NEW,
    "identify-from-a-twist": Verdict.NEW,
    "identify-while-sticking": Verdict.NEW,
    "straight-pushes-tell-nothing": Verdict.NEW,
    "estimated-film-constants": Verdict.REFUTED,
}


class Motion(NamedTuple):
    """One Coulomb contact on a film, all modes tried."""

    mode: str
    twist: tuple[Fraction, Fraction, Fraction]
    normal: Fraction
    tangential: Fraction


class Push(NamedTuple):
    """A contact at ``offset`` along and ``depth`` out of the edge at angle (cos, sin)."""

    cos: Fraction
    sin: Fraction
    offset: Fraction
    depth: Fraction = HALF
    tip: Vector = (Q(-1), Q(0))
    mu: Fraction = Q(1, 3)
    rho: Fraction = RHO
    drag: Fraction = Q(1)

    @property
    def along(self) -> Vector:
        return self.cos, self.sin

    @property
    def out(self) -> Vector:
        return self.sin, -self.cos

    @property
    def arm(self) -> Vector:
        return plus((self.offset, self.along), (self.depth, self.out))


def motion(push: Push) -> Motion:
    """Tries sticking, slipping either way and leaving; exactly one must fit."""
    inward = plus((Q(-1), push.out))
    columns = [force_column(push.arm, f) for f in (inward, push.along)]
    rows = balance_rows(push.drag, push.rho, columns)
    zero = [Q(0)] * 2
    closed = [*velocity_row(push.arm, push.out), *zero]
    sticks = [*velocity_row(push.arm, push.along), *zero]
    right = [Q(0), Q(0), Q(0), dot(push.out, push.tip)]
    found = []
    if dot(push.out, push.tip) >= 0:
        return Motion("apart", (Q(0), Q(0), Q(0)), Q(0), Q(0))
    tries = {
        "stick": (sticks, dot(push.along, push.tip)),
        "up": ([Q(0)] * 3 + [push.mu, Q(-1)], Q(0)),
        "down": ([Q(0)] * 3 + [push.mu, Q(1)], Q(0)),
    }
    for mode, (row, value) in tries.items():
        *twist, normal, tangential = solve([*rows, closed, row], [*right, value])
        slip = sum((p * q for p, q in zip(sticks, [*twist, *zero], strict=True)), Q(0))
        slip -= dot(push.along, push.tip)
        fits = {
            "stick": abs(tangential) <= push.mu * normal,
            "up": slip < 0 < normal,
            "down": slip > 0 and normal > 0,
        }
        if fits[mode]:
            found.append(Motion(mode, (twist[0], twist[1], twist[2]), normal, tangential))
    assert len(found) == 1
    return found[0]


def some_pushes(count: int, seed: int = 7) -> list[Push]:
    """Pushes of the paper's part at random angles, offsets and coefficients."""
    rng = random.Random(seed)
    found = []
    for _ in range(count):
        t = Q(rng.randint(40, 160), 100)  # tan(theta/2)
        cos, sin = (1 - t * t) / (1 + t * t), 2 * t / (1 + t * t)
        mu = Q(rng.randint(30, 36), 100)
        found.append(Push(cos, sin, Q(rng.randint(-800, 800)), mu=mu))
    return found


PUSHES = some_pushes(40)


def times(k: Fraction, values: tuple[Fraction, ...]) -> tuple[Fraction, ...]:
    return tuple(k * value for value in values)


@cache
def claims() -> dict[str, Claim]:
    return {claim.key: claim for claim in invariances.derive().claims}


def test_verdicts() -> None:
    assert {key: claim.verdict for key, claim in claims().items()} == VERDICTS


def test_the_sample_contains_all_modes() -> None:
    assert {motion(push).mode for push in PUSHES} == {"stick", "up", "down"}


@pytest.mark.parametrize("push", PUSHES)
def test_invariances_of_solved_motions(push: Push) -> None:
    k, before = Q(7, 3), motion(push)
    stronger = motion(push._replace(drag=k))
    assert stronger.twist == before.twist
    assert (stronger.normal, stronger.tangential) == times(k, (before.normal, before.tangential))
    faster = motion(push._replace(tip=(-k, Q(0))))
    assert faster.twist == times(k, before.twist)
    assert faster.mode == before.mode
    larger = motion(
        push._replace(
            depth=k * push.depth, offset=k * push.offset, rho=k * k * push.rho, tip=(-k, Q(0))
        )
    )
    assert larger.twist == (k * before.twist[0], k * before.twist[1], before.twist[2])


@pytest.mark.parametrize("push", PUSHES)
def test_mirror_and_half_turn_of_solved_motions(push: Push) -> None:
    before = motion(push)
    image = motion(push._replace(cos=-push.cos, offset=-push.offset))
    v_x, v_y, omega = before.twist
    assert image.twist == (v_x, -v_y, -omega)
    assert image.tangential == -before.tangential
    left = motion(push._replace(cos=-push.cos, sin=-push.sin, tip=(Q(1), Q(0))))
    assert left.twist == (-v_x, -v_y, omega)


@pytest.mark.parametrize("push", PUSHES)
def test_rho_and_mu_from_one_solved_twist(push: Push) -> None:
    found = motion(push)
    velocity = found.twist[:2]
    ratio = -dot(velocity, push.along) / dot(velocity, push.out)
    assert moment(push.arm, velocity) / found.twist[2] == push.rho
    if found.mode == "stick":
        assert abs(ratio) <= push.mu
    else:
        assert abs(ratio) == push.mu


def _ratio(push: Push) -> Fraction:
    found = motion(push)
    return found.tangential / found.normal


@pytest.mark.parametrize("push", PUSHES[:8])
def test_the_derived_twist_is_the_solved_one(push: Push) -> None:
    twist, normal = invariances.twist_at_ratio()
    value = {
        mechanics.d1: push.depth, mechanics.d2: push.offset, mechanics.rho: push.rho,
        mechanics.e_x: 1, mechanics.v_p: -1, invariances.tau: _ratio(push),
        sp.cos(mechanics.theta): push.cos, sp.sin(mechanics.theta): push.sin,
    }  # fmt: skip
    at = {name: sp.Rational(str(number)) for name, number in value.items()}
    found = motion(push)
    assert [Q(str(v.subs(at))) for v in (*twist, normal)] == [*found.twist, found.normal]


def test_a_sticking_path_is_the_same_under_every_larger_coefficient() -> None:
    push = Push(Q(0), Q(1), Q(350), mu=Q(30, 100))
    assert motion(push) == motion(push._replace(mu=Q(36, 100)))
    assert motion(push).mode == "stick"
    slipping = Push(Q(9, 41), Q(40, 41), Q(350), mu=Q(30, 100))
    assert motion(slipping).twist != motion(slipping._replace(mu=Q(36, 100))).twist


def test_straight_pushes_do_not_depend_on_rho() -> None:
    centred = Push(Q(0), Q(1), Q(0))
    assert motion(centred).twist == motion(centred._replace(rho=Q(1))).twist == (Q(-1), Q(0), Q(0))
    slanted = Push(Q(3, 5), Q(4, 5), HALF / 3)  # force through the centre at tau = -1/3
    assert motion(slanted).mode == "down"
    assert motion(slanted).twist == motion(slanted._replace(rho=Q(1))).twist
    assert motion(slanted).twist[2] == 0


def _flipped_moment(force: sp.Matrix, arm: sp.Matrix) -> sp.Matrix:
    return sp.Matrix([force[0], force[1], -mechanics.cross(arm, force)])


def _uneven_film(twist: sp.Matrix) -> sp.Matrix:
    return mechanics.film(twist) + sp.Matrix([0, mechanics.e_x * twist[1], 0])


def _dry_film(twist: sp.Matrix) -> sp.Matrix:
    return mechanics.film(twist) + sp.Matrix([1, 0, 0])


def _pushing_friction(n: Any, t: Any, slip: Any, opening: Any) -> Any:
    return mechanics.coulomb(n, t, -slip, opening)


def _sticky(n: Any, t: Any, slip: Any, opening: Any) -> Any:
    return mechanics.coulomb(n + 1, t, slip, opening)


@pytest.mark.parametrize(
    ("name", "broken", "claim"),
    [
        ("wrench", _flipped_moment, invariances._identify_from_a_twist),
        ("wrench", _flipped_moment, invariances._twist_of_one_contact),
        ("film", _uneven_film, invariances._isotropy),
        ("film", _dry_film, invariances._rate),
        ("film", _dry_film, invariances._film_scale),
        ("coulomb", _sticky, invariances._rate),
        ("coulomb", _sticky, invariances._film_scale),
    ],
)
def test_a_broken_ingredient_is_noticed(
    monkeypatch: pytest.MonkeyPatch,
    name: str,
    broken: Callable[..., Any],
    claim: Callable[[], Claim],
) -> None:
    monkeypatch.setattr(invariances, name, broken)
    with pytest.raises(DerivationError):
        claim()


def test_friction_that_pushes_leaves_the_slipping_modes_without_a_motion(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(invariances, "coulomb", _pushing_friction)
    holds = [finding.holds for finding in invariances._one_contact_modes()]
    assert holds == [True, False, False, True]  # sticking and leaving do not slip
