"""Checks of the inputs of a push, each with the argument, its value, the rule and what to do."""

from collections.abc import Mapping
from typing import NoReturn

import numpy as np
import numpy.typing as npt

from meso_robust.simulator.contact import polygon_faces
from meso_robust.simulator.support import check_film_ratio

_F = npt.NDArray[np.float64]

MAX_TIPS = 6
"""Most tips in one move: the proof of a jam tries 4^tips contact modes."""
MAX_STEPS = 10**8
"""Most steps in one move."""
START_DEPTH = 0.05
"""Depth of a tip at the start, in steps, that counts as touching.

The part is left this deep in a tip, at most, by the linear steps of a move before; the first step
takes it back.
"""

_STRICT = 1e-9  # of the size of the part: a corner this flat is no corner


def _refuse(argument: str, value: str, rule: str, advice: str) -> NoReturn:
    raise ValueError(f"{argument}: {value}; {rule}; {advice}")


def check_arrays(arrays: Mapping[str, _F]) -> None:
    """Refuse arrays of the wrong shape or with values that are not finite.

    Parameters
    ----------
    arrays
        The array fields of a push by name.

    Raises
    ------
    ValueError
        Naming the argument, its shape or value, and what it should be.
    """
    runs = arrays["poses"].shape[0] if arrays["poses"].ndim else 0
    tips = arrays["tips"].shape[1] if arrays["tips"].ndim > 1 else 0
    corners = arrays["vertices"].shape[0] if arrays["vertices"].ndim else 0
    shapes = {
        "vertices": ((corners, 2), "(V, 2)"),
        "poses": ((runs, 3), "(N, 3)"),
        "tips": ((runs, tips, 2), "(N, P, 2)"),
        "travel": ((runs, tips, 2), "(N, P, 2)"),
        "friction": ((runs,), "(N,)"),
        "film_ratio": ((runs,), "(N,)"),
    }
    for name, (shape, letters) in shapes.items():
        if arrays[name].shape != shape:
            _refuse(
                name,
                f"shape {arrays[name].shape}",
                f"must be {letters} with N runs as in poses and P tips as in tips",
                f"reshape it to {shape}",
            )
        if not np.all(np.isfinite(arrays[name])):
            where = tuple(int(k) for k in np.argwhere(~np.isfinite(arrays[name]))[0])
            value = f"{arrays[name][where]} at {where}"
            _refuse(name, value, "must be finite", "remove the run or mend the value")
    if not 1 <= tips <= MAX_TIPS:
        advice = "leave out the tips that stay away from the part"
        _refuse("tips", f"{tips} tips", f"must be 1 to {MAX_TIPS}", advice)


def check_polygon(vertices: _F) -> None:
    """Refuse corners that are not those of a convex part about its reference point.

    Parameters
    ----------
    vertices
        (V, 2) corners in m, body frame.

    Raises
    ------
    ValueError
        If there are fewer than three corners, if they are not in counter-clockwise order or not
        strictly convex, or if the origin is not inside.
    """
    count = vertices.shape[0]
    if count < 3:
        _refuse("vertices", f"{count} corners", "must be at least 3", "give the whole outline")
    advice = "give the corners of a convex outline counter-clockwise, each once"
    flat = _STRICT * float(np.max(np.ptp(vertices, axis=0)))
    edge = np.roll(vertices, -1, axis=0) - vertices
    short = np.flatnonzero(np.hypot(edge[:, 0], edge[:, 1]) <= flat)
    if short.size:
        corner = int(short[0])
        _refuse("vertices", f"corner {corner} and the next coincide", "must differ", advice)
    faces = polygon_faces(vertices)
    distance = faces[:, 2:4] @ vertices.T - faces[:, 4:5]  # of corner j out of edge i
    for i in range(count):
        others = [j for j in range(count) if j not in (i, (i + 1) % count)]
        worst = max(others, key=lambda j: float(distance[i, j]))
        if distance[i, worst] > -flat:
            value = f"corner {worst} is {distance[i, worst]:g} m outside the edge from corner {i}"
            _refuse("vertices", value, "must be strictly convex and counter-clockwise", advice)
    if np.any(faces[:, 4] <= 0.0):
        _refuse(
            "vertices",
            f"the origin is {-np.min(faces[:, 4]):g} m outside",
            "must contain the reference point, the origin of the body frame",
            "subtract the centre of the part from the corners",
        )


def check_numbers(friction: _F, film_ratio: _F, step: float) -> None:
    """Refuse a negative friction, a film ratio or a step that is not positive.

    Parameters
    ----------
    friction
        (N,) values of μ.
    film_ratio
        (N,) values of ρ in m².
    step
        Longest tip displacement of one step in m.

    Raises
    ------
    ValueError
        Naming the argument and the first wrong run.
    """
    wrong = np.flatnonzero(friction < 0.0)
    if wrong.size:
        value = f"run {wrong[0]} has {friction[wrong[0]]:g}"
        _refuse("friction", value, "must not be negative", "give μ as a number such as 0.33")
    check_film_ratio(film_ratio)
    if not (np.isfinite(step) and step > 0.0):
        _refuse("step", f"{step} m", "must be positive and finite", "try 1e-6 m")


def check_steps(longest: float, step: float) -> None:
    """Refuse a step so small that the move would not end.

    Parameters
    ----------
    longest
        Longest travel of any tip in m.
    step
        Longest tip displacement of one step in m.

    Raises
    ------
    ValueError
        If the move has more than `MAX_STEPS` steps.
    """
    if not longest / step <= MAX_STEPS:
        _refuse(
            "step",
            f"{step:g} m for a travel of {longest:g} m",
            f"must give at most {MAX_STEPS:g} steps",
            "give lengths in m and a longer step",
        )


def check_tips_outside(vertices: _F, poses: _F, tips: _F, step: float) -> None:
    """Refuse a tip that starts inside the part.

    Parameters
    ----------
    vertices
        (V, 2) corners in m, body frame.
    poses
        (N, 3) poses at the start, m, m, rad.
    tips
        (N, P, 2) tips at the start in m, world frame.
    step
        Longest tip displacement of one step in m; depths below `START_DEPTH` of it pass.

    Raises
    ------
    ValueError
        Naming the run, the tip and its depth.
    """
    faces = polygon_faces(vertices)
    offset = tips - poses[:, None, :2]
    cos, sin = np.cos(poses[:, 2])[:, None], np.sin(poses[:, 2])[:, None]
    x = cos * offset[..., 0] + sin * offset[..., 1]
    y = cos * offset[..., 1] - sin * offset[..., 0]
    gap = np.full(x.shape, -np.inf)
    for face in faces:  # edge by edge, to keep the memory at one number per tip
        gap = np.maximum(gap, face[2] * x + face[3] * y - face[4])
    inside = np.argwhere(gap < -START_DEPTH * step)
    if inside.size:
        run, tip = (int(k) for k in inside[0])
        _refuse(
            "tips",
            f"tip {tip} of run {run} starts {-1e6 * gap[run, tip]:.4g} µm inside the part",
            "must start outside or touching",
            "move the tip or the part apart",
        )
