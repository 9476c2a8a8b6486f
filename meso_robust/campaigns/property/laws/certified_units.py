"""A certificate in other units of length is the same certificate."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from hypothesis import strategies as st

from meso_robust.bounds import Interval
from meso_robust.campaigns.property.law import Breach, Cost, Property, Verdict
from meso_robust.campaigns.property.laws.variants import Variant, paper_rules, variants
from meso_robust.primitives.certify import certify_move
from meso_robust.primitives.move import Aim, MoveRule, Point
from meso_robust.primitives.obligation import Step
from meso_robust.primitives.outline import Rectangle
from meso_robust.primitives.setup import PoseBox, Setup, setup_of
from meso_robust.types import Floats

ALIKE = 1e-12
"""Of half the part's length, and of a radian: how far the ends of two boxes may be apart. Not of the
coordinate itself, which may be 0 but for rounding."""


@dataclass(frozen=True, slots=True, kw_only=True)
class InUnits:
    """A variant, and the unit of length as a power of two."""

    variant: Variant
    power: int


def scaled(range_: Interval, factor: float) -> Interval:
    """Times a power of two: exact."""
    return Interval(range_.lo * factor, range_.hi * factor)


def _box(box: PoseBox, factor: float) -> PoseBox:
    return replace(box, x=scaled(box.x, factor), y=scaled(box.y, factor))


def _setup(setup: Setup, factor: float) -> Setup:
    u = setup.uncertainty
    return replace(
        setup,
        outline=Rectangle(
            half_length=scaled(setup.half_length, factor),
            half_width=scaled(setup.half_width, factor),
        ),
        stated_spacing=scaled(setup.stated_spacing, factor),
        uncertainty=replace(
            u,
            sensed_position=scaled(u.sensed_position, factor),
            probe_position=scaled(u.probe_position, factor),
            film_ratio=scaled(u.film_ratio, factor**2),
        ),
        start=_box(setup.start, factor),
        goal=_box(setup.goal, factor),
    )


def _rule(rule: MoveRule, factor: float) -> MoveRule:
    def aim(one: Aim) -> Aim:
        return replace(one, offset_um=one.offset_um * factor)

    def point(one: Point) -> Point:
        return Point(x=aim(one.x), y=aim(one.y))

    single = None if rule.single is None else point(rule.single)
    return replace(rule, dual=point(rule.dual), dual_end=aim(rule.dual_end), single=single)


def _steps(rules: Sequence[MoveRule], setup: Setup) -> list[Step]:
    """The steps as they are certified, without the grid of decimals on which boxes are stated."""
    state: PoseBox | None = setup.start
    found: list[Step] = []
    for rule in rules:
        if state is None:
            break
        found.append(certify_move(rule, state, setup, found[-1] if found else None))
        state = found[-1].post
    return found


def check(example: InUnits) -> Verdict:
    """Certify twice, and compare."""
    factor = 2.0**example.power
    rules, setup = paper_rules(), setup_of(example.variant.task())
    length = setup.half_length.hi * factor
    apart = ALIKE * np.array([length, length, 1.0])
    one = _steps(rules, setup)
    other = _steps([_rule(rule, factor) for rule in rules], _setup(setup, factor))
    if len(one) != len(other):
        return _breach("verdict", f"{len(one)} and {len(other)} steps have a box")
    for k, (step, seen) in enumerate(zip(one, other, strict=True)):
        if step.verdict != seen.verdict:
            return _breach("verdict", f"step {k + 1}: {step.verdict.name}, {seen.verdict.name}")
        wanted = None if step.post is None else _box(step.post, factor)
        if not _alike(wanted, seen.post, apart):
            return _breach("boxes", f"step {k + 1} ends in {wanted}, and {seen.post}")
        tubes = zip(step.tube, seen.tube, strict=False)
        alike = all(_alike(_box(a.box, factor), b.box, apart) for a, b in tubes)
        if not alike or len(step.tube) != len(seen.tube):
            return _breach("tubes", f"step {k + 1} goes through other boxes")
    return None


def _alike(wanted: PoseBox | None, seen: PoseBox | None, apart: Floats) -> bool:
    if wanted is None or seen is None:
        return wanted is seen
    return bool((np.abs(wanted.ends - seen.ends) <= apart).all())


def _breach(what: str, detail: str) -> Breach:
    return Breach(what=f"certificate in other units: {what}", detail=detail)


UNITS = Property(
    name="other-units-certificate",
    statement=(
        "The paper's plan and variants of its task with all lengths times a power of two, rho times its "
        "square: the certificate has the same verdicts, and boxes and tubes times the power."
    ),
    agreement=(
        "to 1e-12 of half the part's length (before boxes are widened to decimals): micrometres are "
        "rounded to metres at either length"
    ),
    examples=st.builds(InUnits, variant=variants(1.5), power=st.integers(-8, 8)),
    check=check,
    cost=Cost.MODERATE,
)
