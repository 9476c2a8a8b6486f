"""Maps of the shipped plan against brute force: plain formulas at points, and integrated motions."""

from __future__ import annotations

import itertools
import json
import math
from collections.abc import Iterator

import numpy as np
import pytest

from meso_robust.bounds import HALF_PI, Interval
from meso_robust.conditions import condition, values
from meso_robust.errors import NotApplicableError
from meso_robust.feasible_regions import Map, Region, admissible_offsets, map_of, moves_of
from meso_robust.feasible_regions.document import document
from meso_robust.primitives.setup import PoseBox
from meso_robust.reporting.admissible import map_figure
from tests.motion.sticking_reference import after
from tests.nightly import at_night
from tests.strategies import paper_chain, paper_task

UM = 1e-6
D1, HALF, RHO, SPACING = 418.5 * UM, 808 * UM, 0.3769e-6, 580 * UM
MU = (0.30, 0.36)
OFF = 10 * UM  # camera and probe together
BETA = math.radians(0.25)
COUNT = 32


@pytest.fixture(scope="module")
def tilt() -> Map:
    chain = paper_chain()
    moves, number = moves_of(chain.steps, chain.setup, "tilt")
    return map_of("tilt", moves, number, COUNT)


@pytest.fixture(scope="module")
def straighten() -> Map:
    chain = paper_chain()
    moves, number = moves_of(chain.steps, chain.setup, "straighten")
    return map_of("straighten", moves, number, COUNT)


def cells(found: Map, region: Region, most: int = 40) -> Iterator[np.ndarray]:
    ends = found.paving.ends()[found.paving.regions == region]
    assert len(ends) >= 10
    yield from ends[:: max(1, len(ends) // most)]


def points(cell: np.ndarray, rng: np.random.Generator) -> list[tuple[float, float]]:
    """Corners, middle and a random point of a cell."""
    x, y = cell[:2], cell[2:]
    inside = tuple(rng.random(2) * [x[1] - x[0], y[1] - y[0]] + [x[0], y[0]])
    return [*itertools.product(x, y), (float(x.mean()), float(y.mean())), inside]


def holds(name: str, **at: float) -> bool:
    return all(float(v) > 0.0 for v in values("one_point_sticking", name)(**at))


def tilt_works(height: float, angle: float, error: tuple[float, ...]) -> bool:
    """By integration of the balance of forces, at one value of the uncertainties."""
    dy, dx, mu, rho, beta = error
    chain = paper_chain()
    reach_end = chain.steps[0].rule.dual_end.offset_um * UM
    rise = height + dy
    d2 = (D1 * math.cos(angle) + rise) / math.sin(angle)
    reach = (D1 + rise * math.cos(angle)) / math.sin(angle)
    travel = reach - (reach_end + dx + 0.5 * SPACING * math.tan(beta))
    if abs(d2) >= HALF or travel <= 0.0:
        return False
    _, _, end = after(angle, travel, D1, d2, rho)
    for theta in (angle, 0.5 * (angle + end), end):
        at = {"theta": theta, "d1": D1, "d2": d2, "rho": rho}
        sticks = holds("friction_margin", mu=mu, **at) and holds("normal_force", **at)
        turns = -D1 * math.cos(theta) + d2 * math.sin(theta) > 0.0
        idle = -SPACING * math.tan(beta), SPACING
        behind = idle[0] * math.sin(theta) - idle[1] * math.cos(theta) < 0.0
        along = d2 + idle[0] * math.cos(theta) + idle[1] * math.sin(theta)
        if not (sticks and turns) or (behind and along < HALF):
            return False
    return True


ERRORS = tuple(
    itertools.product((-OFF, OFF), (-OFF, OFF), MU[:1], (0.95 * RHO, 1.05 * RHO), (-BETA, BETA))
)


@at_night
def test_a_certified_tilt_works_at_all_corners_and_inside(tilt: Map) -> None:
    rng = np.random.default_rng(1)
    for cell in cells(tilt, Region.CERTIFIED):
        for height, angle in points(cell, rng)[:3:2] + points(cell, rng)[-1:]:
            drawn = (*rng.uniform(-OFF, OFF, 2), rng.uniform(*MU), RHO, rng.uniform(-BETA, BETA))
            for error in (*ERRORS[::3], drawn):
                assert tilt_works(height, angle, error), (height, angle, error)


def test_an_impossible_tilt_fails_for_some_corner(tilt: Map) -> None:
    rng = np.random.default_rng(2)
    for cell in cells(tilt, Region.IMPOSSIBLE):
        for height, angle in points(cell, rng):
            assert not all(tilt_works(height, angle, e) for e in ERRORS), (height, angle)


def straightens(middle: float, angle: float, error: tuple[float, ...]) -> bool:
    """Whether both tips come to touch and stick, by the closed forms at one value."""
    dy, _, mu, rho, beta = error
    half, d1 = D1, HALF  # move 4 pushes the short edge
    aligned = math.pi / 2 + beta
    side = 1.0 if angle < aligned else -1.0
    rise = middle + dy + side * 0.5 * SPACING
    d2 = (d1 * math.cos(angle) + rise) / math.sin(angle)
    other = d2 - side * SPACING / math.cos(beta)
    if max(abs(d2), abs(other)) >= half:
        return False
    for theta in (angle, aligned):
        at = {"theta": theta, "d1": d1, "d2": d2, "rho": rho}
        turns = side * (-d1 * math.cos(theta) + d2 * math.sin(theta)) > 0.0
        if not (turns and holds("friction_margin", mu=mu, **at) and holds("normal_force", **at)):
            return False
    press = d1 * math.sin(beta) + max(d2, other) * math.cos(beta)
    return 0.0 < press < SPACING and mu * math.cos(beta) > abs(math.sin(beta))


@at_night
def test_a_certified_straightening_works_at_all_corners_and_inside(straighten: Map) -> None:
    rng = np.random.default_rng(3)
    for cell in cells(straighten, Region.CERTIFIED):
        for middle, angle in points(cell, rng):
            drawn = (rng.uniform(-OFF, OFF), 0.0, rng.uniform(*MU), RHO, rng.uniform(-BETA, BETA))
            for error in (*ERRORS, drawn):
                assert straightens(middle, angle, error), (middle, angle, error)


def test_an_impossible_straightening_fails_for_some_corner(straighten: Map) -> None:
    rng = np.random.default_rng(4)
    for cell in cells(straighten, Region.IMPOSSIBLE):
        for middle, angle in points(cell, rng):
            assert not all(straightens(middle, angle, e) for e in ERRORS), (middle, angle)


@pytest.mark.parametrize("which", ["tilt", "straighten"])
def test_the_plan_lies_in_the_certified_region(which: str, request: pytest.FixtureRequest) -> None:
    found: Map = request.getfixturevalue(which)
    across, up = found.plan
    assert found.paving.share(Region.CERTIFIED) > 0.02
    offsets = admissible(which)
    assert any(
        region is Region.CERTIFIED and piece.lo <= across.lo and across.hi <= piece.hi
        for piece, region in offsets
    )
    assert up.width < math.radians(3.0)


def admissible(which: str) -> list[tuple[Interval, Region]]:
    chain = paper_chain()
    step = chain.steps[0 if which == "tilt" else 3]
    return admissible_offsets(step, chain.setup, step.pre, resolution=1e-6)


def test_offsets_end_where_the_friction_of_the_worst_corner_ends() -> None:
    """Tilt from nearly upright: the outer end by a root of eq. (5) at the worst corner."""
    chain = paper_chain()
    step = chain.steps[0]
    pieces = admissible("tilt")
    ((certified, _),) = [piece for piece in pieces if piece[1] is Region.CERTIFIED]
    theta = step.pre.theta.lo
    c, s = math.cos(theta), math.sin(theta)

    def margin(d2: float) -> float:
        rho, mu = 0.95 * RHO, 0.30
        return min(
            mu * (D1 * d2 * c + (D1**2 + r) * s) - (D1 * d2 * s + (d2**2 + r) * c)
            for r in (rho, 1.05 * RHO)
        )

    low, high = 200 * UM, 600 * UM
    while high - low > 1e-12:
        middle = 0.5 * (low + high)
        low, high = (middle, high) if margin(middle) > 0.0 else (low, middle)
    height = low * s - D1 * c - OFF  # of the tip: its own error is still to come
    assert height - 3 * UM < certified.hi <= height + 1e-9
    beyond = [piece for piece, region in pieces if region is Region.IMPOSSIBLE]
    assert any(height - 1e-9 <= piece.lo <= height + 3 * UM for piece in beyond)


def test_a_push_that_works_at_all_corners_is_not_impossible(tilt: Map) -> None:
    """Section IX-D as written: samples along the edge, tried at the extremes of all that is uncertain."""
    found = 0
    for angle in np.radians(np.arange(80.0, 104.0, 3.0)):
        for d2 in np.linspace(SPACING - 300 * UM, HALF, 33):
            sides = ((d2 - OFF, d2 + OFF), (0.95 * RHO, 1.05 * RHO), MU)
            offset, ratio, mu = np.array(list(itertools.product(*sides))).T
            known = {"theta": angle, "d1": D1, "d2": offset, "rho": ratio, "mu": mu, "side": 1.0}
            margins = [
                np.array(values("one_point_sticking", name)(**{k: known[k] for k in asked}))
                for name in ("normal_force", "friction_margin", "turning")
                for asked in [condition("one_point_sticking", name).inputs]
            ]
            if all((margin > 0.0).all() for margin in margins):
                found += 1
                rise = float(d2 * math.sin(angle) - D1 * math.cos(angle))
                assert tilt.paving.at(rise, float(angle)) != {Region.IMPOSSIBLE}
    assert found >= 30


def test_offsets_of_a_rotation_are_refused() -> None:
    chain = paper_chain()
    with pytest.raises(NotApplicableError, match="offsets are for a tilt or a t\\^2 push"):
        admissible_offsets(chain.steps[2], chain.setup, chain.steps[2].pre)


def test_a_plan_without_the_primitive_is_refused() -> None:
    chain = paper_chain()
    with pytest.raises(NotApplicableError, match="the plan has no rotation"):
        moves_of(chain.steps[:2], chain.setup, "rotation")


def test_a_wide_box_of_starts_leaves_nothing_certified() -> None:
    chain = paper_chain()
    step = chain.steps[0]
    around = HALF_PI + Interval(-0.2, 0.2)
    pre = PoseBox(x=step.pre.x, y=step.pre.y, theta=around)
    pieces = admissible_offsets(step, chain.setup, pre, resolution=50e-6)
    assert all(region is not Region.CERTIFIED for _, region in pieces)


def test_the_document_and_the_drawing_hold_every_cell_and_the_plan(tilt: Map) -> None:
    task = paper_task()
    written = json.loads(document(task, [tilt]))
    assert written["task_hash"] == task.hash
    (one,) = written["maps"]
    assert [cell[0] for cell in one["cells"]] == [Region(int(r)).name for r in tilt.paving.regions]
    edges = [float.fromhex(edge) for edge in one["across"]["edges"]]
    first = [[edges[cell[1]], edges[cell[2]]] for cell in one["cells"]]
    assert np.array_equal(first, tilt.paving.ends()[:, :2])
    figure = map_figure(tilt)
    (axes,) = figure.axes
    assert axes.get_xlabel().endswith("µm")
    assert "deg" in axes.get_ylabel()
    texts = [text.get_text() for text in figure.legends[0].get_texts()]
    assert "works for all uncertainties (proved)" in texts
    assert "the plan's own choice, move 1" in texts
    (dot,) = axes.get_lines()
    x, y = (float(np.ravel(values_)[0]) for values_ in dot.get_data())
    assert x == pytest.approx(tilt.plan[0].mid / UM)
    assert y == pytest.approx(math.degrees(tilt.plan[1].mid))
    drawn = sum(len(c.get_paths()) for c in axes.collections)
    assert drawn >= tilt.paving.count
