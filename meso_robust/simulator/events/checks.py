"""Checks of the arguments of the event-driven integrator."""

from collections.abc import Mapping, Sequence

import numpy as np

from meso_robust.simulator.events.outline import CONVEX, LENGTH, edge_table
from meso_robust.types import Floats

_CLOSE = 1e-12  # relative asymmetry of a drag that is that of rounding


def check_move(move: Mapping[str, Floats], fixture: Sequence[Floats], samples: int) -> None:
    """Refuse a move that is not one.

    Parameters
    ----------
    move
        The arrays of `integrate`, under the names they have there.
    fixture
        Polygons of the fixture.
    samples
        Number of intervals of the path.

    Raises
    ------
    ValueError
        With the argument, its value, the rule, and what to do.
    """
    _check_shapes(move)
    for name, array in (*move.items(), *((f"fixture[{k}]", p) for k, p in enumerate(fixture))):
        if not np.isfinite(array).all():
            _refuse(name, "has numbers that are not finite", "must be finite", "look for NaN")
    _check_outlines(move["vertices"])
    for k, polygon in enumerate(fixture):
        _check_polygon(f"fixture[{k}]", polygon, turns=(1, -1))
    for name in ("friction", "radii", "fixture_friction"):
        if (move[name] < 0).any():
            _refuse(name, move[name].min(), "must not be negative", "give zero for none")
    drag = move["drag"]
    skew = np.abs(drag - np.swapaxes(drag, -1, -2)).max()
    if skew > _CLOSE * np.abs(drag).max() or not _is_positive(drag.reshape(-1, 3, 3)):
        rule = "must be symmetric and positive definite"
        _refuse("drag", drag.tolist(), rule, "for a plain film give diag(1, 1, ρ)")
    _check_lay(drag.reshape(-1, 3, 3), move["stage_lay"].reshape(-1, 2))
    if samples < 0:
        _refuse("samples", samples, "must not be negative", "give 0 for no path")


def _check_outlines(vertices: Floats) -> None:
    """Refuse outlines that are none: the first is looked at, the others must have its corners."""
    outlines = vertices.reshape(-1, *vertices.shape[-2:])
    _check_polygon("vertices", outlines[0], turns=(1,))
    table = edge_table([outlines])
    convex = table[..., CONVEX]
    if not ((table[..., LENGTH] > 0.0).all() and (convex == convex[0]).all()):
        rule = "must have the same convex corners as the first"
        _refuse("vertices", "outlines that differ", rule, "push parts of one shape together")


def _is_positive(matrices: Floats) -> bool:
    """Whether symmetric matrices (N, 3, 3) are positive definite: their leading minors are positive."""
    first, second, third = matrices[:, 0].T, matrices[:, 1].T, matrices[:, 2].T
    minor = first[0] * second[1] - first[1] * second[0]
    whole = np.sum(third * np.cross(first, second, axis=0), axis=0)
    return bool(((first[0] > 0.0) & (minor > 0.0) & (whole > 0.0)).all())


def _check_lay(drag: Floats, lay: Floats) -> None:
    """Refuse a lay of the stage that leaves no drag in some direction."""
    across = 0.5 * (drag[:, 0, 0] - drag[:, 1, 1])
    least = 0.5 * (drag[:, 0, 0] + drag[:, 1, 1]) - np.hypot(across, drag[:, 0, 1])
    worst = np.hypot(lay[:, 0], lay[:, 1]) - least
    if (worst >= 0.0).any():
        rule = "must be less than the least drag of a translation"
        _refuse("stage_lay", float(np.hypot(lay[:, 0], lay[:, 1]).max()), rule, "lower it")


def _check_shapes(move: Mapping[str, Floats]) -> None:
    """Refuse arrays whose shapes do not go together."""
    poses, tips, travel = move["poses"], move["tips"], move["travel"]
    runs = len(poses)
    count = tips.shape[1] if tips.ndim == 3 else 0
    legs = travel.shape[1] if travel.ndim == 4 else 1
    corners = move["vertices"].shape[-2:]
    wanted: dict[str, list[tuple[int, ...]]] = {
        "vertices": [corners, (1, *corners), (runs, *corners)],
        "poses": [(runs, 3)],
        "tips": [(runs, count, 2)],
        "travel": [(runs, count, 2), (runs, legs, count, 2)],
        "friction": [(runs, count), (runs, legs, count)],
        "radii": [(count,), (runs, count)],
        "drag": [(3, 3), (1, 3, 3), (runs, 3, 3)],
        "stage_lay": [(2,), (1, 2), (runs, 2)],
    }
    for name, shapes in wanted.items():
        if move[name].shape not in shapes:
            rule = f"must have the shape {' or '.join(map(str, shapes))}"
            _refuse(name, f"shape {move[name].shape}", rule, "give one row for each run and tip")


def _check_polygon(name: str, corners: Floats, turns: tuple[int, ...]) -> None:
    """Refuse a polygon that is none, or is in the wrong order."""
    if corners.ndim != 2 or corners.shape[1] != 2 or len(corners) < 3:
        _refuse(name, f"shape {corners.shape}", "must be (K, 2), K ≥ 3", "list the corners")
    after = np.roll(corners, -1, axis=0)
    area = 0.5 * float(np.sum(corners[:, 0] * after[:, 1] - corners[:, 1] * after[:, 0]))
    if (corners == after).all(axis=1).any():
        _refuse(name, "a corner is there twice", "corners must differ", "leave one of them out")
    if np.sign(area) not in turns:
        rule = "must be counter-clockwise" if turns == (1,) else "must not be flat"
        _refuse(name, f"area {area:.6g} m²", rule, "reverse the order of the corners")


def _refuse(argument: str, value: object, rule: str, advice: str) -> None:
    """Raise the error of an argument."""
    raise ValueError(f"{argument}: {value}; {rule}; {advice}")
