"""Derivation, CasADi, NumPy, intervals and balls give the same value of every generated formula."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache

import numpy as np
from hypothesis import strategies as st

from meso_robust.campaigns.property.law import Breach, Cost, Property, Verdict
from meso_robust.campaigns.property.laws.derived import derived
from meso_robust.campaigns.property.laws.routes import (
    NAMES,
    Routes,
    Sample,
    ball_over_a_box_holds_the_truth,
    balls_hold_the_truth,
    doubles_are_near_the_truth,
    enclosure_holds_the_truth,
    routes,
    sample,
)
from meso_robust.conditions.formula import inputs

Agreement = Callable[[Routes, Sample], str]


@dataclass(frozen=True, slots=True)
class Evaluation:
    """A formula, a box of its arguments and a point of the box; SI units."""

    module: str
    name: str
    at: Sample


_share = st.floats(0.0, 1.0)


@st.composite
def evaluations(draw: st.DrawFn) -> Evaluation:
    """Any formula over a box of any width within the ranges of its arguments."""
    module, name = draw(st.sampled_from(NAMES))
    names = inputs(module, name)
    shares = [[draw(_share) for _ in range(3)] for _ in names]
    return Evaluation(module, name, sample(names, np.array(shares)))


@cache
def _routes(module: str, name: str) -> Routes:
    return routes(module, name, truth=derived(module, name))


def _agree(*agreements: Agreement) -> Callable[[Evaluation], Verdict]:
    def check(example: Evaluation) -> Verdict:
        of = _routes(example.module, example.name)
        for agree in agreements:
            found = agree(of, example.at)
            if found:
                what = f"{example.module}.{example.name}: {agree.__name__.replace('_', ' ')}"
                return Breach(what=what, detail=found)
        return None

    return check


VALUES = Property(
    name="formula-values",
    statement=(
        "At a point, the derivation's formula (SymPy's expression by mpmath), NumPy, CasADi and the "
        "ball of the generated code agree for every generated formula."
    ),
    agreement=(
        "doubles within 4 times the radius of the ball at 53 bits, which adds up all rounding errors; "
        "the balls at 53 and 128 bits hold the derivation's value (256 bits)"
    ),
    examples=evaluations(),
    check=_agree(doubles_are_near_the_truth, balls_hold_the_truth),
    cost=Cost.CHEAP,
)

INTERVALS = Property(
    name="formula-intervals",
    statement=(
        "Over a box, the outward-rounded interval of every generated formula holds the derivation's "
        "value at any point of the box."
    ),
    agreement="exact: containment is decided in ball arithmetic",
    examples=evaluations(),
    check=_agree(enclosure_holds_the_truth),
    cost=Cost.CHEAP,
)

BALLS = Property(
    name="formula-balls",
    statement=(
        "Over a box, the ball of every generated formula holds the derivation's value at any point of "
        "the box, and meets the interval."
    ),
    agreement="exact: containment is decided in ball arithmetic",
    examples=evaluations(),
    check=_agree(ball_over_a_box_holds_the_truth),
    cost=Cost.CHEAP,
)
