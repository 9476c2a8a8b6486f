"""Enclosures hold exact values and are tight."""

from __future__ import annotations

import inspect
from importlib import import_module

import mpmath  # type: ignore[import-untyped]
import numpy as np
import pytest

from meso_robust.bounds import Interval, enclose, enclose_rows
from meso_robust.conditions import condition
from tests.bounds.formulas import corners, inside

EXACT = mpmath.mp.clone()
EXACT.dps = 50
UM = 1e-6
THETA, DEPTH = Interval(1.55, 1.70), Interval(418.0 * UM, 419.0 * UM)
OFFSET, RHO, MU = Interval(200 * UM, 300 * UM), Interval(0.36e-6, 0.40e-6), Interval(0.30, 0.36)
H, V, SIGMA = Interval(-400 * UM, 600 * UM), Interval(890 * UM, 920 * UM), Interval(-40e-6, 90e-6)
TAU = Interval(-0.36, 0.36)
RISE = Interval(-50 * UM, 200 * UM)
SIDE = Interval.point(1.0)

CORNER = tuple(
    Interval(at - 2 * UM, at + 2 * UM) for at in (400 * UM, -800 * UM, 430 * UM, 810 * UM)
)

BOXES = {
    "polygon_edge.edge_direction": CORNER,
    "polygon_edge.edge_offsets": CORNER,
    "polygon_edge.end_offset": (
        *(DEPTH, Interval(803.0 * UM, 813.0 * UM)),
        *(Interval(1.55, 1.60), Interval(0.0, 30.0 * UM)),
    ),
    "one_point_sticking.normal_force": (THETA, DEPTH, OFFSET, RHO),
    "one_point_sticking.friction_margin": (THETA, DEPTH, OFFSET, RHO, MU),
    "one_point_sticking.stick_ratio": (THETA, DEPTH, OFFSET, RHO),
    "one_point_sticking.turning": (THETA, DEPTH, OFFSET, SIDE),
    "one_point_sticking.only_solution": (DEPTH, OFFSET, RHO, MU),
    "sticking_motion.travel": (
        Interval(1.55, 1.58),
        Interval(1.63, 1.70),
        DEPTH,
        OFFSET,
        RHO,
    ),
    "sticking_motion.arm": (THETA, DEPTH, OFFSET),
    "sticking_motion.contact_offset": (THETA, DEPTH, RISE),
    "sticking_motion.contact_reach": (THETA, DEPTH, RISE),
    "sticking_motion.shortening": (THETA, DEPTH, OFFSET, RHO),
    "sticking_motion.lift": (THETA, THETA, DEPTH, OFFSET),
    "sticking_motion.clearance": (THETA, DEPTH, Interval(400 * UM, 500 * UM), RISE),
    "sticking_motion.beside": (
        THETA,
        OFFSET,
        Interval.point(808 * UM),
        Interval(-5 * UM, 5 * UM),
        Interval(570 * UM, 590 * UM),
        SIDE,
    ),
    "two_point_sticking.normal_forces": (Interval(-0.1, 0.1), DEPTH, OFFSET, Interval(5e-4, 6e-4)),
    "two_point_sticking.friction_margin": (Interval(-0.1, 0.1), MU),
    "two_sided_rotation.orientation": (H, V, DEPTH),
    "two_sided_rotation.pair_position": (THETA, V, DEPTH),
    "two_sided_rotation.slide_rates": (H, V, DEPTH, SIGMA, RHO, MU),
    "two_sided_rotation.pair": (H, V, DEPTH),
    "two_sided_rotation.no_jam": (V, DEPTH, MU),
    "two_sided_rotation.passive_force": (
        Interval(500 * UM, 600 * UM),
        V,
        DEPTH,
        SIGMA,
        RHO,
        TAU,
        TAU,
    ),
    "two_sided_rotation.one_contact_motion": (THETA, DEPTH, OFFSET, RHO, TAU),
    "two_sided_rotation.one_contact_turning": (THETA, DEPTH, OFFSET, RHO, TAU),
    "two_sided_rotation.closing": (THETA, DEPTH, OFFSET, SIGMA, RHO, TAU),
    "y_translation.gain": (THETA, THETA, THETA, DEPTH, OFFSET, OFFSET),
}
LOOSE = {  # 64 boxes are few for wide sides that enter many times
    "polygon_edge.edge_direction": 0.9,
    "two_sided_rotation.one_contact_motion": 0.06,
    "two_sided_rotation.slide_rates": 0.4,
    "two_sided_rotation.passive_force": 0.3,
    "sticking_motion.travel": 2.5,  # the package asks for it at single points only
}


def exact_values(name: str, point: list[float]) -> list[mpmath.mpf]:
    module, function = name.split(".")
    generated = getattr(import_module(f"meso_robust._generated.{module}"), function)
    return list(generated(EXACT, *(EXACT.mpf(value) for value in point)))


@pytest.mark.parametrize("name", BOXES)
@pytest.mark.parametrize("boxes", [1, 64])
def test_enclosure_holds_exact_values_at_corners_and_inside(name: str, boxes: int) -> None:
    sides = BOXES[name]
    of = condition(*name.split("."))
    found = enclose(of, dict(zip(of.inputs, sides, strict=True)), boxes=boxes)
    for point in [*corners(sides), *inside(sides, 40)]:
        for side, value in zip(found, exact_values(name, point), strict=True):
            assert EXACT.mpf(side.lo) <= value <= EXACT.mpf(side.hi), point


@pytest.mark.parametrize("name", BOXES)
def test_enclosure_is_tight(name: str) -> None:
    sides = BOXES[name]
    of = condition(*name.split("."))
    found = enclose(of, dict(zip(of.inputs, sides, strict=True)))
    points = np.array([*corners(sides), *inside(sides, 5000)]).T
    sampled = np.array(of.function.map(points.shape[1])(points))
    share = LOOSE.get(name, 0.05)
    for row, side in zip(sampled, found, strict=True):
        spread = float(np.ptp(row))
        size = float(np.abs(row).max())
        assert side.hi - side.lo <= (1.0 + share) * spread + 1e-12 * size


def test_every_generated_function_is_covered() -> None:
    modules = {name.split(".")[0] for name in BOXES}
    defined = {
        f"{module}.{name}"
        for module in modules
        for name, value in vars(import_module(f"meso_robust._generated.{module}")).items()
        if inspect.isfunction(value)
    }
    assert defined == set(BOXES)


def test_an_infinite_side_gives_the_whole_line() -> None:
    of = condition("one_point_sticking", "normal_force")
    box = dict(zip(of.inputs, (THETA, DEPTH, OFFSET, RHO), strict=True))
    for side in (Interval(0.0, np.inf), Interval(-np.inf, 0.0), Interval(-np.inf, np.inf)):
        assert enclose(of, {**box, "d2": side}) == (Interval(-np.inf, np.inf),)


def test_a_box_across_a_pole_gives_the_whole_line() -> None:
    of = condition("sticking_motion", "contact_offset")
    box = {"theta": Interval(-0.1, 0.1), "d1": DEPTH, "rise": RISE}
    assert enclose(of, box) == (Interval(-np.inf, np.inf),)


def test_a_missing_side_is_named() -> None:
    of = condition("two_sided_rotation", "no_jam")
    with pytest.raises(ValueError, match=r"no_jam lacks d1, mu; it has V"):
        enclose(of, {"V": V})


def test_rows_are_enclosed_as_each_box_alone() -> None:
    """The second box has no end, so nothing is known of it."""
    of = condition("one_point_sticking", "normal_force")
    box = dict(zip(of.inputs, (THETA, DEPTH, OFFSET, RHO), strict=True))
    offsets = (OFFSET, Interval(0.0, np.inf), Interval(-300 * UM, -100 * UM))
    rows = [{"d2": offset} for offset in offsets]
    for boxes in (1, 16):
        alone = [enclose(of, {**box, **row}, boxes=boxes) for row in rows]
        assert enclose_rows(of, box, rows, boxes=boxes) == alone
    assert alone[1] == (Interval(-np.inf, np.inf),)
    assert alone[0] != alone[2]
