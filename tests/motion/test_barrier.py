"""Bounds of rates over a stretch of a tube against rates at points of it."""

from __future__ import annotations

import numpy as np
import pytest

from meso_robust.bounds.bulk import program
from meso_robust.motion import barrier
from meso_robust.motion.barrier import ALL, RATES, Known
from meso_robust.motion.two_sided import _exact, _formulas, known, parameters_of
from meso_robust.types import Floats
from tests.motion.test_two_sided import GRIPS, UM, um
from tests.nightly import at_night

LABELS = {"label": um(-10, 10)}
COUNT = 300


def stretch(kind: str, h: float, rng: np.random.Generator, count: int) -> barrier._Frame:
    """A stretch whose curve follows no motion: bent and spread at will."""
    bent = {"straight": 0.0, "bent one way": 4e4, "the other": -4e4}[kind]
    reach = 30 * UM
    return barrier._Frame(
        h,
        h - reach,
        rng.uniform(-100, 250) * UM,
        rng.uniform(-1.0, 1.0),
        bent,
        rng.uniform(-1.0, 1.0, count) * 1e-3,
        rng.uniform(-1.0, 1.0, count) * 30.0,
    )


def sampled(
    at: Floats, frame: barrier._Frame, ranges: Known, inputs: Floats, rng: np.random.Generator
) -> tuple[Floats, Floats]:
    """Inputs of the rates at points of the stretch (h, share of s), and the rate of the curve there."""
    gone = frame.h_first - at[0]
    off = at[1]
    labels = rng.uniform(ranges.dev_lo, ranges.dev_hi, (COUNT, ranges.dev_lo.size)).T
    ends = rng.random(labels.shape) < 0.5
    labels = np.where(
        ends, np.where(labels > 0, ranges.dev_hi[:, None], ranges.dev_lo[:, None]), labels
    )
    constants = ranges.constants
    middle = 0.5 * (ranges.lo + ranges.hi)
    inputs = inputs.copy()
    inputs[2 : 2 + constants] = middle[2 : 2 + constants, None] + labels[:constants]
    curve = frame.centre + frame.rate * gone
    curve = curve - 0.5 * frame.bend * gone * ((frame.h_first - frame.h_last) - gone)
    slopes = frame.spread[:, None] + frame.drift[:, None] * gone
    inputs[0], inputs[1] = at[0], curve + (slopes * labels).sum(axis=0) + off
    rate = frame.rate + frame.bend * (gone - 0.5 * (frame.h_first - frame.h_last))
    return inputs, rate + (frame.drift[:, None] * labels).sum(axis=0)


@pytest.mark.parametrize("kind", ["straight", "bent one way", "the other"])
@pytest.mark.parametrize("name", GRIPS)
@pytest.mark.parametrize("h", [700 * UM, pytest.param(100 * UM, marks=at_night), -250 * UM])
def test_bounds_hold_at_every_point_of_a_stretch(name: str, kind: str, h: float) -> None:
    grip = GRIPS[name]
    box = grip.box()
    formulas = _formulas(_exact(box), grip.common)
    parameters = parameters_of(grip, LABELS)
    sides = [um(0, 0), um(0, 0), *(box[each] for each in formulas.inputs[2:])]
    ranges = known(parameters, sides, len(parameters) - 1)
    rng = np.random.default_rng(7)
    for _ in range(6):
        frame = stretch(kind, h, rng, len(parameters))
        s_lo, s_hi = -3 * UM, 2 * UM
        bounds = np.empty((2, ALL))
        barrier._bound(program(formulas.rates), frame, ranges, s_lo, s_hi, RATES, bounds)
        at = np.array([rng.uniform(frame.h_last, h, COUNT), rng.uniform(s_lo, s_hi, COUNT)])
        at[0, :80:2], at[0, 1:80:2] = frame.h_last, h
        anywhere = rng.uniform(ranges.lo, ranges.hi, (COUNT, ranges.lo.size)).T
        inputs, rate = sampled(at, frame, ranges, anywhere, rng)
        values = np.array(formulas.rates.function(inputs))
        values[:RATES] -= rate
        slack = 1e-9 * np.abs(values).max(axis=1)
        assert (values.min(axis=1) >= bounds[0] - slack).all()
        assert (values.max(axis=1) <= bounds[1] + slack).all()
        assert np.isfinite(bounds[:, :RATES]).all()


@pytest.mark.parametrize("bend", [0.0, 3e3, -3e3])
def test_a_stretch_is_a_parabola_through_both_knots(bend: float) -> None:
    rng, h = np.random.default_rng(5), 100 * UM
    made = stretch("straight", h, rng, 1)
    frame = made._replace(h_first=h, h_last=-140 * UM, bend=bend)
    ranges = known({"label": um(-10, 10)}, [um(0, 0), um(0, 0)])
    places = barrier._places(frame, ranges, 0.0, 0.0)
    ends = frame.centre, frame.centre + frame.rate * 240 * UM
    through = np.polynomial.Polynomial.fit([0, 240 * UM], ends, 1).convert()
    curve = through + 0.5 * bend * np.polynomial.Polynomial.fromroots([0, 240 * UM])
    for k, gone in enumerate([240 * UM, 120 * UM, 0.0]):
        for side, value in ((places.centre[k], curve(gone)), (places.rate[k], curve.deriv()(gone))):
            assert side[0] <= value + 1e-15
            assert value - 1e-15 <= side[1]
            assert side[1] - side[0] < 1e-12
    low, high = barrier.beside_chords(np.array([h, frame.h_last]), np.array([bend]))
    assert sorted([low, high]) == [low, high]
    assert low + high == pytest.approx(curve(120 * UM) - 0.5 * sum(ends), rel=1e-9, abs=1e-300)
