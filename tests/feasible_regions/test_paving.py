"""The paving itself, on sets that are known exactly."""

from __future__ import annotations

import itertools
from fractions import Fraction

import numpy as np
import pytest

from meso_robust.bounds import Interval
from meso_robust.feasible_regions.paving import Axis, Paving, Region, pave, pave_line, paving_of

SIDE = Axis(name="x", unit="um", low=-1.0, high=1.0)


def disc(x: Interval, y: Interval) -> Region:
    """Inside or outside of a circle of radius 0.7, exactly."""
    far = max(Fraction(a) ** 2 + Fraction(b) ** 2 for a in (x.lo, x.hi) for b in (y.lo, y.hi))
    near = sum(min(abs(Fraction(s.lo)), abs(Fraction(s.hi))) ** 2 for s in (x, y) if 0.0 not in s)
    if far < Fraction(49, 100):
        return Region.CERTIFIED
    return Region.IMPOSSIBLE if near > Fraction(49, 100) else Region.UNDECIDED


@pytest.fixture(scope="module")
def paved() -> Paving:
    return pave(disc, SIDE, SIDE, count=128, coarse=8)


def test_cells_cover_the_rectangle_once(paved: Paving) -> None:
    hits = np.zeros((128, 128), dtype=int)
    for a, b, c, d in paved.cells:
        hits[a:b, c:d] += 1
    assert (hits == 1).all()


def test_only_the_border_is_refined(paved: Paving) -> None:
    sizes = paved.cells[:, 1] - paved.cells[:, 0]
    assert set(sizes) == {1, 2, 4, 8, 16}
    assert (sizes[paved.regions == Region.UNDECIDED] == 1).all()
    assert paved.judged < 128 * 128 / 5
    assert paved.share(Region.CERTIFIED) == pytest.approx(np.pi * 0.49 / 4, rel=0.03)
    assert paved.share(Region.UNDECIDED) < 0.04


def test_every_cell_keeps_the_verdict_of_its_judge(paved: Paving) -> None:
    for ends, code in zip(paved.ends(), paved.regions, strict=True):
        x, y = Interval(*ends[:2].tolist()), Interval(*ends[2:].tolist())
        assert disc(x, y) == code


def test_regions_at_a_point(paved: Paving) -> None:
    assert paved.at(0.01, 0.02) == {Region.CERTIFIED}
    assert paved.at(0.9, 0.9) == {Region.IMPOSSIBLE}
    assert Region.UNDECIDED in paved.at(0.7, 0.0)
    assert paved.at(2.0, 0.0) == set()


def test_a_gap_without_border_stays_coarse() -> None:
    found = pave(lambda *_: Region.UNDECIDED, SIDE, SIDE, count=64, coarse=16)
    assert found.judged == len(found.cells) == 256


def test_a_count_that_is_no_power_of_two_times_the_coarse_one_is_refused() -> None:
    with pytest.raises(ValueError, match="count = 100 must be coarse = 16 times"):
        pave(disc, SIDE, SIDE, count=100)


def test_a_line_is_paved_to_its_resolution() -> None:
    def judge(x: Interval) -> Region:
        if x.lo > 0.25 and x.hi < 0.5:
            return Region.CERTIFIED
        return Region.IMPOSSIBLE if x.hi < 0.25 or x.lo > 0.5 else Region.UNDECIDED

    pieces = pave_line(judge, 0.0, 1.0, 1e-3)
    assert [region for _, region in pieces] == [2, 0, 1, 0, 2]
    assert (pieces[0][0].lo, pieces[-1][0].hi) == (0.0, 1.0)
    for (one, _), (other, _) in itertools.pairwise(pieces):
        assert one.hi == other.lo
    for piece, region in pieces:
        assert region is not Region.UNDECIDED or piece.hi - piece.lo <= 4e-3
    certified = pieces[2][0]
    assert 0.25 < certified.lo < 0.251
    assert 0.499 < certified.hi < 0.5


@pytest.mark.parametrize(("low", "high", "resolution"), [(0.0, 1.0, 0.0), (1.0, 1.0, 0.1)])
def test_a_line_without_length_or_resolution_is_refused(
    low: float, high: float, resolution: float
) -> None:
    with pytest.raises(ValueError, match="needs resolution > 0 and low < high"):
        pave_line(lambda _: Region.UNDECIDED, low, high, resolution)


def test_known_regions_are_paved_as_they_are() -> None:
    raster = np.random.default_rng(0).integers(0, 3, (16, 16)).astype(np.int8)
    raster[5:9] = raster[5]
    paved = paving_of(raster, SIDE, SIDE, 7)
    assert (paved.raster() == raster).all()
    assert paved.judged == 7
    hits = np.zeros_like(raster)
    for a, b, c, d in paved.cells:
        hits[a:b, c:d] += 1
    assert (hits == 1).all()
    # columns that are alike, and neighbours in a column, are one cell
    assert {(5, 9)} == {(a, b) for a, b, *_ in paved.cells.tolist() if a <= 5 < b}
    assert len(paved.cells) == 13 + sum(
        np.count_nonzero(np.diff(raster[k])) for k in [*range(6), *range(9, 16)]
    )
