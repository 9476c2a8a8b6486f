"""Counts and promised figures as they are told: on the safe side, to the last digit."""

from __future__ import annotations

import ast
import re
from fractions import Fraction
from pathlib import Path

import pytest
from hypothesis import given, strategies as st

import meso_robust
from meso_robust.certificates.words import claim_words
from meso_robust.checker.words import claim
from meso_robust.wording import counted, do, down, down_to, up, up_to
from tests.conftest import paper_task
from tests.sources import tree
from tests.strategies import REPEATABLE

PACKAGE = Path(meso_robust.__file__).parent
NUMBERS = st.floats(min_value=-1e9, max_value=1e9, allow_subnormal=False)


@REPEATABLE
@given(value=NUMBERS, digits=st.integers(0, 6))
def test_fixed_digits_hold_the_very_double_between_them(value: float, digits: int) -> None:
    below, above = Fraction(down(value, digits)), Fraction(up(value, digits))

    assert below <= Fraction(value) <= above
    assert above - below in (0, Fraction(1, 10**digits))


@REPEATABLE
@given(value=NUMBERS, digits=st.integers(1, 12))
def test_significant_digits_hold_the_spelled_decimal_between_them(
    value: float, digits: int
) -> None:
    spelled = Fraction(repr(value))

    assert Fraction(down_to(value, digits)) <= spelled <= Fraction(up_to(value, digits))
    assert len(re.sub(r"e.*|[-.]", "", down_to(value, digits)).strip("0")) <= digits


@pytest.mark.parametrize(
    ("value", "said"), [(1.21875, "1.21"), (1.2499999999999998, "1.24"), (8.0, "8.00")]
)
def test_a_factor_is_not_above_what_was_proved(value: float, said: str) -> None:
    assert down(value, 2) == said


def test_what_is_no_number_is_told_as_such() -> None:
    assert (down(float("inf"), 2), up_to(float("-inf"), 2), up(float("nan"), 1)) == (
        "inf",
        "-inf",
        "nan",
    )


def test_one_is_no_plural() -> None:
    assert [counted(n, "run") for n in (0, 1, 2)] == ["0 runs", "1 run", "2 runs"]
    assert counted(3, "push", "pushes") == "3 pushes"


PROMISED = re.compile(
    r"margin|factor|bears|each_alone|certified|worst|excess|improvement|\blow\b|\bhigh\b"
)
_NEAREST = re.compile(r"\.\d+[fge%]$")
MEASURED = {
    "campaigns/falsify/threshold.py",
    "recordings/checks/sensors.py",
}
"""Files whose ``low``, ``high`` … are no promise."""


def nearest(path: Path) -> list[str]:
    """Figures of promises that an f-string rounds to the nearest."""
    found = []
    for node in ast.walk(tree(path)):
        if not (isinstance(node, ast.FormattedValue) and node.format_spec is not None):
            continue
        spec = ast.unparse(node.format_spec).strip("f'\"")
        if _NEAREST.search(spec) and PROMISED.search(ast.unparse(node.value)):
            found.append(f"{path.name}:{node.lineno} {ast.unparse(node.value)}")
    return found


@pytest.mark.parametrize(
    "room",
    ["transfer", "certificates", "policy", "laboratory", "reporting", "campaigns", "pipeline.py"],
)
def test_no_promise_is_rounded_to_the_nearest(room: str) -> None:
    files = [PACKAGE / room] if room.endswith(".py") else sorted((PACKAGE / room).rglob("*.py"))

    assert files
    assert [line for path in files for line in nearest(path)] == []


def test_one_of_anything_is_told_as_one() -> None:
    told = [words(paper_task(), 1) for words in (claim, claim_words)]

    assert [do(1, "end"), do(0, "end"), do(2, "show")] == ["ends", "end", "show"]
    for one in told:
        assert "policy of 1 move can be carried out" in one
