"""Parts out of true: where their corners and the ends of their edges can be, by crossing their lines."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from meso_robust.bounds import HALF_PI, Interval
from meso_robust.planning.y_translation import y_translation
from meso_robust.primitives.outline import EXACT, Polygon, Rectangle, Tolerance, outline_of
from meso_robust.primitives.setup import Setup, setup_of
from meso_robust.task import load_task
from meso_robust.types import Floats

UM, DEG = 1e-6, math.pi / 180.0
TASKS = Path(__file__).parents[2] / "meso_robust" / "tasks"
NEAR = Tolerance(
    size=Interval(-1 * UM, 1 * UM),
    squareness=Interval(-0.1 * DEG, 0.1 * DEG),
    rounding=Interval.point(10 * UM),
)


def perturbed(turns: Floats, depths: Floats, rng: np.random.Generator) -> tuple[Floats, Floats]:
    """Directions and distances of lines out of true, each by its own amount."""
    sign = rng.choice([-1.0, 1.0], (2, len(turns)))
    return turns + sign[0] * 0.1 * DEG, depths + sign[1] * 1 * UM


def crossing(first: tuple[float, float], second: tuple[float, float]) -> Floats:
    """Where two lines (direction, distance from the origin) cross."""
    rows = np.array([[math.sin(angle), -math.cos(angle)] for angle, _ in (first, second)])
    return np.linalg.solve(rows, np.array([first[1], second[1]]))


@pytest.mark.parametrize("name", ["hexagon", "l_shape"])
def test_corners_and_ends_of_a_polygon_out_of_true_are_held(name: str) -> None:
    outline = outline_of(load_task(TASKS / f"{name}.toml").part)
    assert isinstance(outline, Polygon)
    body, rng, count = outline.within(NEAR), np.random.default_rng(0), len(outline.corners)
    turns = np.array([-line.turn.mid for line in outline.walls])
    depths = np.array([line.depth.mid for line in outline.walls])
    for _ in range(60):
        angles, out = perturbed(turns, depths, rng)
        lines = list(zip(angles.tolist(), out.tolist(), strict=True))
        corners = [crossing(lines[k - 1], lines[k]) for k in range(count)]
        for (x, y), corner in zip(body.corners, corners, strict=True):
            assert x.lo <= corner[0] <= x.hi
            assert y.lo <= corner[1] <= y.hi
        for line in body.lines:  # the hull's sides hold every corner, for some error of direction
            normal = np.array([-math.sin(line.turn.mid), -math.cos(line.turn.mid)])
            slack = 0.5 * line.turn.width * max(np.linalg.norm(corner) for corner in corners)
            assert max(normal @ corner for corner in corners) <= line.depth.hi + slack
        for edge in body.edges:
            k = int(edge.name.split()[1])
            along = np.array([math.cos(angles[k]), math.sin(angles[k])])
            lean = (angles[(k + 1) % count] - angles[k]) % (2.0 * math.pi)
            rounded = 10 * UM * math.tan(0.5 * lean)
            assert edge.last.hi <= along @ corners[(k + 1) % count] - rounded + 1e-12
            assert edge.first.lo >= along @ corners[k]
            assert edge.depth.lo <= out[k] <= edge.depth.hi


def test_ends_of_edges_are_not_given_away() -> None:
    """A square corner out of true by 2 k moves by d1 tan(2 k), its rounding takes its radius."""
    part = Rectangle(half_length=Interval.point(808 * UM), half_width=Interval.point(418.5 * UM))
    edge = NEAR.edge(part.edge(HALF_PI.mid))
    lean = math.tan(0.2 * DEG)
    reached = (807 / math.cos(0.2 * DEG)) * UM - 419.5 * UM * lean - 10 * UM * (1 + lean)
    assert edge.last.hi == pytest.approx(reached, abs=0.3 * UM)
    assert edge.first.lo == pytest.approx(-reached, abs=0.3 * UM)


def test_an_exact_part_is_as_stated() -> None:
    setup = setup_of(load_task(TASKS / "paper.toml"))
    assert setup.tolerance == EXACT
    assert setup.body == setup.outline
    assert setup.edge(HALF_PI.mid) == setup.outline.edge(HALF_PI.mid)


def test_a_rectangle_out_of_true_is_held_by_a_larger_one() -> None:
    part, rng = Rectangle(half_length=Interval.point(3.0), half_width=Interval.point(2.0)), None
    wide = replace(NEAR, size=Interval(-0.1, 0.1), squareness=Interval(-0.05, 0.05))
    body, rng = part.within(wide), np.random.default_rng(1)
    for _ in range(200):
        long = (rng.choice([-0.05, 0.05]), 2.0 + rng.choice([-0.1, 0.1]))
        short = (0.5 * math.pi + rng.choice([-0.05, 0.05]), 3.0 + rng.choice([-0.1, 0.1]))
        x, y = np.abs(crossing(long, short))
        assert x <= body.half_length.hi
        assert y <= body.half_width.hi


def real(factor: float, spacing: float = 600 * UM) -> Setup:
    """The paper's task with real probes and parts, all ranges times ``factor``."""
    setup = setup_of(load_task(TASKS / "paper.toml"))

    def both(reach: float) -> Interval:
        return Interval(-factor * reach, factor * reach)

    u = replace(
        setup.uncertainty.scaled(factor),
        tip_radius=Interval(7.5 * UM, 7.5 * UM) + both(5 * UM),
        size=both(1 * UM),
        squareness=both(0.1 * DEG),
        travel_direction=both(0.1 * DEG),
        drag_centre=both(20 * UM),
        drag_anisotropy=both(0.025),
    )
    apart = Interval.point(spacing)
    return replace(setup, uncertainty=u, stated_spacing=apart, friction_common=False)


def test_a_tilt_and_a_straightening_are_proved_for_real_probes_and_parts() -> None:
    setup = real(1.0)
    found = y_translation(setup.start, setup, 1e-6, 1)
    assert found is not None
    assert [step.verdict.word for step in found] == ["PROVED", "PROVED"]
    assert y_translation(setup.start, setup, -1e-6, 1) is not None


def test_twice_as_much_of_everything_is_too_much() -> None:
    setup = real(2.0)
    assert y_translation(setup.start, setup, 1e-6, 1) is None
