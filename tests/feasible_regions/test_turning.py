"""The map of a rotation, cell by cell: against proofs of each alone, and against integrated motions."""

from __future__ import annotations

import numpy as np
import pytest

from meso_robust.bounds import Interval, Verdict
from meso_robust.feasible_regions import Map, Region, map_of, moves_of
from meso_robust.feasible_regions.turning import Turning, _certify
from meso_robust.primitives.family import Family
from meso_robust.primitives.rotation import certify_rotation
from meso_robust.types import Floats
from tests.primitives.replay import Draws, Tips, World, rotate
from tests.strategies import paper_chain

UM = 1e-6
COUNT = 32
HALF_LENGTH, SPACING = 808 * UM, 580 * UM


@pytest.fixture(scope="module")
def found() -> Map:
    chain = paper_chain()
    return map_of("rotation", *moves_of(chain.steps, chain.setup, "rotation"), COUNT)


@pytest.fixture(scope="module")
def turning(found: Map) -> Turning:
    chain = paper_chain()
    (move,), _ = moves_of(chain.steps, chain.setup, "rotation")
    sides = {"across": found.paving.across.edges(COUNT), "up": found.paving.up.edges(COUNT)}
    return Turning(rule=move.rule, pre=move.pre, setup=move.setup, **sides)


def borders(found: Map, region: Region, rows: int = COUNT) -> list[tuple[int, int, int]]:
    """Column, lowest and highest row of a region, among so many rows."""
    each = enumerate(found.paving.raster()[:, :rows] == region)
    return [(k, *np.flatnonzero(row)[[0, -1]].tolist()) for k, row in each if row.any()]


def alone(turning: Turning, column: int, row: int) -> bool:
    rule = turning.rule_of((column, column + 1), (row, row + 1))
    step = certify_rotation(rule, turning.pre, turning.setup, rough=True)
    return step.verdict is Verdict.PROVED


@pytest.mark.parametrize("share", [0.1, 0.5, 0.95])
def test_a_cell_that_is_certified_alone_is_certified(
    found: Map, turning: Turning, share: float
) -> None:
    certified = borders(found, Region.CERTIFIED)
    column, low, high = certified[int(share * len(certified))]
    assert low + 2 < high - 2
    assert not alone(turning, column, low - 1)
    assert not alone(turning, column, high + 1)
    assert alone(turning, column, low + 1)


def test_tips_that_may_jam_on_the_part_are_undecided(found: Map, turning: Turning) -> None:
    first = borders(found, Region.CERTIFIED)[0][0]
    assert not alone(turning, first - 1, COUNT // 2)
    assert (found.paving.raster()[:first] == Region.UNDECIDED).all()


def played(
    turning: Turning, cells: list[tuple[int, int]], draw: Draws, up: Floats | float
) -> tuple[Floats, World, World]:
    """How far both tips are along their edges after a push of each cell; the part after and before.

    The separation is drawn from each cell; the end is a share ``up`` of it.
    """
    setup, u = turning.setup, turning.setup.uncertainty
    world = World(
        x=draw(turning.pre.x),
        y=draw(turning.pre.y),
        theta=draw(turning.pre.theta),
        rho=draw(u.film_ratio),
        mu=draw(u.friction),
        beta=draw(u.misalignment),
    )
    columns, rows = np.array(cells).T
    side = draw(Interval(0.0, 1.0))
    apart = (1 - side) * turning.across[columns] + side * turning.across[columns + 1]
    end = (1 - up) * turning.up[rows] + up * turning.up[rows + 1]
    rule, still = turning.rule, turning.passive
    sensed_x, sensed_y = world.x + draw(u.sensed_position), world.y + draw(u.sensed_position)
    middle = sensed_y + 0.5 * UM * (rule.dual.y.offset_um + still.y.offset_um) - SPACING / 4
    single_x = sensed_x + UM * still.x.offset_um
    start = sensed_x + UM * rule.dual.x.offset_um
    err = [draw(u.probe_position) for _ in range(4)]
    lag = 0.5 * SPACING * np.tan(world.beta)
    lower = start + err[0] + lag, middle + 0.5 * apart + err[1]
    passive = single_x + err[2], middle - 0.5 * apart + err[3]
    travel = start - (single_x + end)
    upper = lower[0] - 2 * lag, lower[1] + SPACING
    after = rotate(world, Tips(upper=upper, lower=lower, passive=passive, travel=travel), setup)
    along = np.stack([np.cos(after.theta), np.sin(after.theta)])
    places = [
        (x - after.x) * along[0] + (y - after.y) * along[1]
        for x, y in ((lower[0] - travel, lower[1]), passive)
    ]
    return np.abs(places), after, world


def test_both_tips_are_on_the_part_after_every_certified_push(found: Map, turning: Turning) -> None:
    certified = borders(found, Region.CERTIFIED)[::3]
    cells = [(k, row) for k, *ends in certified for row in ends] * 6
    draw = Draws(len(cells), 5)
    places, after, before = played(turning, cells, draw, draw(Interval(0.0, 1.0)))
    assert (places < HALF_LENGTH).all()
    assert (after.theta > before.theta + 0.05).all()


def test_a_push_that_goes_on_too_far_leaves_a_tip_off_its_edge(
    found: Map, turning: Turning
) -> None:
    """At some extreme of what is uncertain, in the middle of each cell."""
    cells = [(k, high) for k, _, high in borders(found, Region.IMPOSSIBLE, COUNT // 2)[::3]]
    assert len(cells) > 5
    places, *_ = played(turning, cells * 20, Draws(20 * len(cells), 6), 0.5)
    off = (places > HALF_LENGTH).any(axis=0).reshape(20, -1)
    assert off.any(axis=0).all()


def test_rows_are_tried_apart_where_tips_are_not_clear_for_all(
    turning: Turning, monkeypatch: pytest.MonkeyPatch
) -> None:
    columns, rows = (20, 22), (0, COUNT)
    together, apart = np.zeros((2, COUNT, COUNT), dtype=np.int8)
    tried = _certify(turning, columns, rows, together)
    clear = Family.clear

    def for_few(family: Family, longer: int, shorter: int) -> bool:
        return shorter - longer <= 12 and clear(family, longer, shorter)

    monkeypatch.setattr(Family, "clear", for_few)
    assert _certify(turning, columns, rows, apart) > tried
    assert np.count_nonzero(together) > 30
    assert (apart == together).all()
