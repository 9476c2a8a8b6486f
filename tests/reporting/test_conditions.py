"""Formulas of the conditions: those of the code that is bounded, and none where there is no code."""

from __future__ import annotations

import re
from xml.etree import ElementTree

import numpy as np
import pytest

from meso_robust._generated import one_point_sticking, two_sided_rotation
from meso_robust.pipeline import Planned
from meso_robust.primitives.names import ObligationId
from meso_robust.reporting.conditions import condition, conditions
from meso_robust.reporting.steps import step_rows

LETTERS = {"θ": "theta", "μ": "mu", "ρ": "rho", "\u2062": "*", "−": "-", "\u2061": ""}


def value(formula: str, **at: float) -> float:
    """A formula of sums, products, powers and functions, read off its MathML by other rules."""
    text = re.sub(r"&#(\d+);", lambda found: chr(int(found[1])), formula)
    left = _python(next(iter(ElementTree.fromstring(text))), at)
    return float(eval(left.replace(">0", ""), {"sin": np.sin, "cos": np.cos}))


def _python(element: ElementTree.Element, at: dict[str, float]) -> str:
    text = element.text or ""
    if element.tag == "msub":
        return repr(at["".join(child.text or "" for child in element)])
    parts = [_python(child, at) for child in element]
    if element.tag == "msup":
        return f"({parts[0]})**({parts[1]})"
    if element.tag == "mi" and text not in ("sin", "cos"):
        return repr(at[LETTERS.get(text, text)])
    return "".join(parts) if parts else LETTERS.get(text, text)


def test_a_formula_has_the_values_of_the_code() -> None:
    at = {"theta": 1.7, "d1": 0.4, "d2": -0.3, "rho": 0.38, "mu": 0.33, "V": 0.9}
    found = condition("one_point_sticking.friction_margin")
    assert found is not None
    code = one_point_sticking.friction_margin(
        np, *(at[k] for k in ("theta", "d1", "d2", "rho", "mu"))
    )
    assert [value(str(text), **at) for text in found.formulas] == pytest.approx(list(code))
    found = condition("two_sided_rotation.no_jam")
    assert found is not None
    code = two_sided_rotation.no_jam(np, at["V"], at["d1"], at["mu"])
    assert [value(str(text), **at) for text in found.formulas] == pytest.approx(list(code))


def test_a_condition_says_what_it_means_and_where_it_is_derived() -> None:
    found = condition("two_sided_rotation.passive_force")
    assert found is not None
    assert found.file == "derivations/two_sided_rotation.py"
    assert found.meaning.startswith("normal force at S")
    assert (
        found.module
        == "Rotation between a moving and a passive tip on opposite edges (eqs. 10, 11)."
    )
    assert found.anchor == "derivation-two_sided_rotation-passive_force"


@pytest.mark.parametrize("text", ["within_edge", "nothing.known", ""])
def test_an_inequality_without_code_has_no_condition(text: str) -> None:
    assert condition(text) is None


def test_each_condition_stands_once() -> None:
    names = ["one_point_sticking.turning", "one_point_sticking.turning"]
    assert len(conditions([*names, "travel"])) == 1


def test_what_is_left_is_the_proved_bound_over_the_one_without_errors(proved: Planned) -> None:
    """Friction margin of the pair: mu cos(beta) - |sin(beta)|, worst at both ends, best at neither."""
    told = proved.certificate.steps[1].obligations
    index = next(k for k, one in enumerate(told) if one.id == ObligationId.PAIR_STICKS)
    row = step_rows(proved)[1].obligations[index]
    u = proved.task.uncertainty
    low, turn = u.friction[0], np.radians(max(map(abs, u.tip_misalignment_deg)))
    worst = low * np.cos(turn) - np.sin(turn)
    ideal = sum(u.friction) / 2.0
    assert row.left == int(100.0 * worst / ideal)


def test_what_is_left_is_a_share_wherever_there_is_a_bound(refuted: Planned) -> None:
    rows = [item for step in step_rows(refuted) for item in step.obligations]
    assert all((item.left is None) == (item.lower == "—") for item in rows)
    assert all(item.left is None or 0 <= item.left <= 100 for item in rows)
    assert any(item.left is None for item in rows)
