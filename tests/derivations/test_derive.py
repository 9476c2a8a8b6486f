"""Statuses of the printed statements, and that a broken derivation is noticed."""

from __future__ import annotations

from types import ModuleType

import pytest
import sympy as sp

from derivations import (
    generate,
    mechanics,
    one_point_sticking,
    sticking_motion,
    two_point_sticking,
    two_sided_rotation,
    y_translation,
)
from derivations._derivation import Derivation, DerivationError, Status, require_zero, verdict

STATUSES = {
    "eq. 5, lambda_n": Status.CONFIRMED,
    "eq. 5, v_theta": Status.CONFIRMED,
    "eq. 5, ratio": Status.CONFIRMED,
    "text under eq. 5": Status.REFUTED,
    "uniqueness of one-point sticking": Status.DERIVED,
    "closed form of one-point sticking": Status.DERIVED,
    "eq. 9, lambda_n^1": Status.CONFIRMED,
    "eq. 9, lambda_n^2": Status.CONFIRMED,
    "eq. 9, ratio": Status.CONFIRMED,
    "orientation of the two-sided rotation": Status.DERIVED,
    "eq. 10 and the remark on pointed cones": Status.REFUTED,
    "Section IX-E, Y-translation": Status.CONFIRMED,
}


@pytest.fixture(scope="module")
def derived() -> tuple[Derivation, ...]:
    return generate.derive_all()


def statuses(*derivations: Derivation) -> dict[str, Status]:
    return {s.place: s.status for d in derivations for s in d.statements}


def test_statuses_are_those_known(derived: tuple[Derivation, ...]) -> None:
    assert statuses(*derived) == STATUSES


def test_generated_files_are_what_the_derivations_give(derived: tuple[Derivation, ...]) -> None:
    for path, text in generate.render(derived).items():
        assert path.read_text(encoding="utf-8") == text, path.name


def test_nothing_else_lies_beside_the_generated_files(derived: tuple[Derivation, ...]) -> None:
    written = {path for path in generate.render(derived) if path.parent == generate.GENERATED}
    assert set(generate.GENERATED.glob("*.py")) == written


def test_every_derivation_file_is_a_source() -> None:
    files = {path.stem for path in (generate.ROOT / "derivations").glob("*.py")}
    helpers = {"__init__", "_derivation", "generate", "mechanics"}
    assert {source.__name__.split(".")[-1] for source in generate.SOURCES} == files - helpers


# -- broken derivations ---------------------------------------------------------------------------


def flipped_moment(force: sp.Matrix, arm: sp.Matrix) -> sp.Matrix:
    return sp.Matrix([force[0], force[1], -mechanics.cross(arm, force)])


def half_force(force: sp.Matrix, arm: sp.Matrix) -> sp.Matrix:
    return sp.Matrix([force[0] / 2, force[1] / 2, mechanics.cross(arm, force)])


def doubled_film(twist: sp.Matrix) -> sp.Matrix:
    return sp.Integer(2) * mechanics.film(twist)


BREAKS = [
    (one_point_sticking, "wrench", flipped_moment),
    (two_point_sticking, "wrench", half_force),
    (two_point_sticking, "film", doubled_film),
    (two_sided_rotation, "wrench", flipped_moment),
    (sticking_motion, "F", mechanics.rho + mechanics.d1**2),
    (y_translation, "n", -mechanics.n + 2 * mechanics.a),
]


@pytest.mark.parametrize(
    ("module", "name", "broken"), BREAKS, ids=[f"{m.__name__}.{n}" for m, n, _ in BREAKS]
)
def test_a_broken_derivation_stops_or_changes_a_status(
    module: ModuleType, name: str, broken: object, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(module, name, broken)
    try:
        found = statuses(module.derive())
    except DerivationError:
        return
    except (ValueError, TypeError):
        pytest.fail("broken in a way that says nothing about the check")
    assert found != {place: STATUSES[place] for place in found}


def test_the_sense_of_the_sentence_depends_on_the_forces() -> None:
    d2, rho, theta = mechanics.d2, mechanics.rho, mechanics.theta
    pushes = rho * sp.sin(theta)
    sense = one_point_sticking._sense_of_the_sentence
    assert sense(pushes, d2 * sp.sin(theta)) is Status.REFUTED
    assert sense(pushes, rho * sp.sin(theta)) is Status.CONFIRMED


def test_the_remark_on_existence_would_stand_without_friction_in_the_condition() -> None:
    V, w = two_sided_rotation.V, two_sided_rotation.w
    assert two_sided_rotation._printed_existence(V**2 - w**2) is Status.CONFIRMED


def test_require_zero_names_the_step_and_the_rest() -> None:
    x = mechanics.d1
    require_zero((x + 1) ** 2 - x**2 - 2 * x - 1, "binomial")
    with pytest.raises(DerivationError, match=r"binomial: expected 0, but d1 is left over"):
        require_zero((x + 1) ** 2 - x**2 - x - 1, "binomial")


def test_verdict_tells_zero_from_not_zero() -> None:
    x = mechanics.theta
    assert verdict(sp.sin(x) ** 2 + sp.cos(x) ** 2 - 1) is Status.CONFIRMED
    assert verdict(sp.sin(x)) is Status.REFUTED
    undecided = sp.Function("f")(x)  # no number can be given for it
    with pytest.raises((DerivationError, TypeError)):
        verdict(undecided)
