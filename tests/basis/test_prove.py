"""Named boxes, checked point by point in exact arithmetic."""

from __future__ import annotations

import itertools
from collections.abc import Mapping
from fractions import Fraction
from random import Random

import pytest

from meso_robust.basis import (
    BasisProof,
    Mode,
    Mover,
    Part,
    Tip,
    diagonal_film,
    limit_surface,
    not_covered,
    prove_basis,
)
from meso_robust.bounds import Interval, Verdict
from meso_robust.errors import InputError
from tests.basis.exact import Instant, rational_turn
from tests.basis.examples import LEFT, ONE, RECTANGLE, Example, examples

NAMES = [example.name for example in examples()]
Proofs = dict[str, tuple[Example, BasisProof, BasisProof]]


def point(box: Mapping[str, Interval], random: Random, corners: bool) -> dict[str, Fraction]:
    """A point of a box, or one of its corners, exactly."""
    share = {name: Fraction(random.randint(0, 1 if corners else 64)) for name in box}
    parts = 1 if corners else 64
    return {
        name: Fraction(side.lo) + share[name] / parts * (Fraction(side.hi) - Fraction(side.lo))
        for name, side in box.items()
    }


def instant(e: Example, box: Mapping[str, Interval], random: Random, corners: bool) -> Instant:
    """The problem at an exact point of a box; corners within 1e-6 of the angle's width."""
    share = Fraction(random.choice([1, 10**6 - 1] if corners else range(1, 10**6)), 10**6)
    turn = rational_turn(box["theta"], share)
    assert turn is not None
    return Instant(e.part, e.contacts, e.support, turn, point(box, random, corners), random)


@pytest.mark.parametrize("name", NAMES)
def test_the_named_boxes_are_proved_and_no_other_mode_is_possible(
    name: str, proofs: Proofs
) -> None:
    _, proof, _ = proofs[name]
    assert (proof.verdict, proof.unique, proof.reason) == (Verdict.PROVED, Verdict.PROVED, "")


@pytest.mark.parametrize("name", NAMES)
def test_what_is_proved_holds_at_exact_points_and_corners(name: str, proofs: Proofs) -> None:
    e, random = proofs[name][0], Random(name)
    for trial in range(24):
        at = instant(e, e.box, random, corners=trial % 2 == 0)
        assert at.holds(e.modes)
        if trial < 4:
            for modes in itertools.product(Mode, repeat=len(e.contacts)):
                assert modes == e.modes or not at.holds(modes), modes


@pytest.mark.parametrize("name", NAMES)
def test_the_widened_boxes_are_refuted_at_a_point_that_fails(name: str, proofs: Proofs) -> None:
    e, _, proof = proofs[name]
    assert proof.verdict is Verdict.REFUTED
    witness = {**e.wide_box, **proof.box}
    near = witness["theta"]
    witness["theta"] = Interval(near.lo - 1e-9, near.hi + 1e-9)
    assert not instant(e, witness, Random(name), corners=False).holds(e.modes)


BOX = examples()[0].box


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"rho": Interval(-1e-8, 3e-7)}, "positive definite"),
        ({"mu": Interval(0.0, 0.3)}, "friction"),
        ({"d2": Interval(7e-4, 8.2e-4)}, "beyond the end"),
    ],
)
def test_nothing_is_proved_about_what_is_no_contact_problem(
    change: dict[str, Interval], words: str
) -> None:
    proof = prove_basis(RECTANGLE, ONE, diagonal_film("rho"), [Mode.STICK], {**BOX, **change})
    assert proof.verdict is Verdict.UNKNOWN
    assert words in proof.reason


def test_a_support_without_enclosure_is_unknown_with_its_reason() -> None:
    proof = prove_basis(RECTANGLE, ONE, not_covered("three points"), [Mode.STICK], BOX)
    assert proof.verdict is proof.unique is Verdict.UNKNOWN
    assert "three points" in proof.reason


def test_a_part_that_may_rest_on_a_dry_support_is_unknown() -> None:
    away = (Tip(edge=0, at="d2", friction="mu", mover=Mover((1.0, 0.0))),)
    entries = (1.0, 0.0, 0.0, 1.0, 0.0, "rho")
    dry = prove_basis(RECTANGLE, away, limit_surface(*entries), [Mode.OPEN], BOX)
    wet = prove_basis(RECTANGLE, away, diagonal_film("rho"), [Mode.OPEN], BOX)
    assert (dry.verdict, wet.verdict) == (Verdict.UNKNOWN, Verdict.PROVED)
    assert "rest" in dry.reason


def test_the_jam_of_two_tips_that_close_on_the_part_is_never_proved() -> None:
    """Tips from both sides with no room between them: no mode has a solution."""
    tips = (
        Tip(edge=0, at=0.0, friction="mu", mover=LEFT),
        Tip(edge=2, at=0.0, friction="mu", mover=Mover((1.0, 0.0))),
    )
    box = {**BOX, "theta": Interval(1.56, 1.58)}
    for modes in itertools.product(Mode, repeat=2):
        proof = prove_basis(RECTANGLE, tips, diagonal_film("rho"), modes, box, most_boxes=500)
        assert proof.verdict is not Verdict.PROVED


def test_too_few_boxes_leave_the_verdict_open() -> None:
    e = examples()[3]
    box = {**e.box, "d2": Interval(3.1e-4, 4.5e-4), "theta": Interval(1.5, 1.64)}
    proof = prove_basis(e.part, e.contacts, e.support, e.modes, box, most_boxes=3)
    assert proof.verdict is not Verdict.PROVED


@pytest.mark.parametrize(
    ("contacts", "modes", "box", "words"),
    [
        (ONE, [], BOX, "one for each"),
        (ONE, [Mode.STICK], {k: v for k, v in BOX.items() if k != "d2"}, "'d2' is missing"),
        ((Tip(edge=4, at=0.0, friction=0.3, mover=LEFT),), [Mode.STICK], BOX, "no more corners"),
    ],
)
def test_bad_input_is_refused(
    contacts: tuple[Tip, ...], modes: list[Mode], box: dict[str, Interval], words: str
) -> None:
    with pytest.raises(InputError, match=words):
        prove_basis(RECTANGLE, contacts, diagonal_film("rho"), modes, box)


def test_a_clockwise_outline_is_refused() -> None:
    with pytest.raises(InputError, match="counter-clockwise"):
        Part(((0.0, 0.0), (0.0, 1.0), (1.0, 0.0)))


def test_two_motions_at_once_are_never_called_unique() -> None:
    """A tip that leaves a part which hardly resists turning: it may stick, slip or open."""
    box = {
        "theta": Interval(-0.05, -0.049),
        "d2": Interval(5.0e-5, 5.1e-5),
        "mu": Interval(0.5, 0.51),
        "rho": Interval(1.0e-9, 1.1e-9),
    }
    held = {}
    for modes in itertools.product(Mode, repeat=1):
        proof = prove_basis(RECTANGLE, ONE, diagonal_film("rho"), modes, box)
        held[modes] = proof.verdict is Verdict.PROVED
        assert proof.unique is not Verdict.PROVED, modes
    assert [mode.name for (mode,), proved in held.items() if proved] == [
        "OPEN",
        "STICK",
        "SLIP_PLUS",
    ]
