"""The search for a robust motion of Section IX-D and of Lemma 1, as written, and with a proof.

As written (paper, Section IX-D; Lemma 1 gives the same for the contact along the edge):

1. In every dimension of the input the dispersion starts at half of the largest distance.
2. The samples of all dimensions are combined to all inputs.
3. Every input is tested under the nominal state and parameters.
4. One that passes is tested under all combinations of the maximal uncertainties; if it passes, it
   is returned as the robust motion.
5. If none was returned, the dispersion of every dimension is halved, and all is done again, until it
   is no larger than the control uncertainty of that dimension.
6. If nothing was found by then, "there exists no robust motion".

Two of these steps promise more than they hold. Step 4 looks at corners only: a property can hold at
all corners of the uncertainties and fail between them (``tests/planning/test_motion_search.py`` has a
push on a long part for which it does), so passing is no proof. Step 6 concludes from samples: a robust
motion can lie between them. :func:`over_the_box` replaces the corners by a proof over the whole box;
what exists and what does not is answered by the pavings of :mod:`meso_robust.feasible_regions`.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from meso_robust.bounds import Box, Interval, Verdict, prove_positive
from meso_robust.conditions import condition, values
from meso_robust.planning.sampling import levels

Conditions = Sequence[tuple[str, str]]
"""Generated functions (module, name), all outputs of which must be positive."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Choice:
    """One dimension of the input."""

    name: str
    """Argument of the conditions."""
    low: float
    high: float
    control: float
    """Largest error of what is commanded; positive."""

    def __post_init__(self) -> None:
        """Refuse what cannot be sampled."""
        if not (self.low < self.high and self.control > 0.0):
            raise ValueError(
                f"choice {self.name} needs low < high and control > 0, got {self.low!r}, "
                f"{self.high!r}, {self.control!r}"
            )


@dataclass(frozen=True, slots=True, kw_only=True)
class RobustMotion:
    """What the search returned."""

    inputs: Mapping[str, float]
    dispersion: Mapping[str, float]
    """At which each dimension was sampled."""
    tested: int
    """How many inputs were tested under the uncertainties."""


Test = Callable[[Conditions, Box], bool]


def robust_motion(
    conditions: Conditions,
    choices: Sequence[Choice],
    uncertain: Box,
    test: Test,
) -> RobustMotion | None:
    """The first robust motion of the search; None if no sample passes.

    Parameters
    ----------
    conditions
        The property.
    choices
        The dimensions of the input.
    uncertain
        Ranges of everything else that the conditions depend on; the nominal value is the middle.
    test
        Step 4: :func:`at_all_corners` as written, :func:`over_the_box` with a proof.

    Raises
    ------
    ValueError
        An argument of a condition is neither chosen nor uncertain.
    """
    _check_arguments(conditions, choices, uncertain)
    nominal = {name: Interval.point(side.mid) for name, side in uncertain.items()}
    tested = 0
    for dispersion in _dispersions(choices):
        for inputs in _samples(choices, dispersion):
            here = {name: Interval.point(value) for name, value in inputs.items()}
            if not at_all_corners(conditions, {**nominal, **here}):
                continue
            tested += 1
            around = {
                c.name: Interval(inputs[c.name] - c.control, inputs[c.name] + c.control)
                for c in choices
            }
            if test(conditions, {**uncertain, **around}):
                return RobustMotion(inputs=inputs, dispersion=dispersion, tested=tested)
    return None


def at_all_corners(conditions: Conditions, box: Box) -> bool:
    """Whether the conditions hold at every corner of the box, in plain numbers: no proof."""
    sides = {n: [s.lo] if s.lo == s.hi else [s.lo, s.hi] for n, s in box.items()}
    points = np.array(list(itertools.product(*sides.values()))).T
    corner = dict(zip(sides, points, strict=True))
    for module, name in conditions:
        used = {key: corner[key] for key in condition(module, name).inputs}
        if not np.all(np.array(values(module, name)(**used)) > 0.0):
            return False
    return True


def over_the_box(conditions: Conditions, box: Box) -> bool:
    """Whether the conditions are proved at every point of the box."""
    return all(
        prove_positive(condition(module, name), box).verdict is Verdict.PROVED
        for module, name in conditions
    )


STICKING_TURN = tuple(
    ("one_point_sticking", name) for name in ("normal_force", "friction_margin", "turning")
)
"""Eq. (5): one contact pushes, sticks and turns the part to ``side``."""


def _check_arguments(conditions: Conditions, choices: Sequence[Choice], uncertain: Box) -> None:
    known = {choice.name for choice in choices} | set(uncertain)
    for module, name in conditions:
        missing = [key for key in condition(module, name).inputs if key not in known]
        if missing:
            raise ValueError(
                f"{module}.{name} depends on {', '.join(missing)}: add a choice or a range for it"
            )


def _dispersions(choices: Sequence[Choice]) -> Iterator[dict[str, float]]:
    """Dispersion of every dimension, halved until each has reached its control uncertainty."""
    now = {choice.name: 0.5 * (choice.high - choice.low) for choice in choices}
    while True:
        yield dict(now)
        open_ = [choice for choice in choices if now[choice.name] > choice.control]
        if not open_:
            return
        for choice in open_:
            now[choice.name] *= 0.5


def _samples(
    choices: Sequence[Choice], dispersion: Mapping[str, float]
) -> Iterator[dict[str, float]]:
    """All combinations of the samples of every dimension."""
    axes = [_points(choice, dispersion[choice.name]) for choice in choices]
    names = [choice.name for choice in choices]
    return (dict(zip(names, point, strict=True)) for point in itertools.product(*axes))


def _points(choice: Choice, dispersion: float) -> list[float]:
    """All samples of one dimension, from one end to the other, the ends left out."""
    return sorted(itertools.chain(*levels(choice.low, choice.high, dispersion)))
