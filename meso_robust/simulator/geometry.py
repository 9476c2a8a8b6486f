"""Effects of geometry: the part, the tip or the reference point is not what it is taken for."""

from __future__ import annotations

import numpy as np

from meso_robust.simulator.outline import refuse
from meso_robust.simulator.stage import FORM, Effect, Parameter, Stage
from meso_robust.types import Floats

_UM, _DEG = 1e-6, np.pi / 180.0

GEOMETRY = Stage(
    name="geometry",
    base=72,
    slots=12,
        effects=(
        Effect(
            name="part_geometry",
            equation="x → x (1 + d_x / h_x), y → y (1 + d_y / h_y), h half the extent of the part",
            source="etching: undercut and bevel",
            forms=(
                "both edges across an axis alike",
                *(f"those towards {x}x and {y}y only, by 2 d" for x, y in ("++", "+−", "−+", "−−")),
            ),
            parameters=(
                Parameter(
                    key="x_um", unit="µm", to_si=_UM,
                    meaning="d_x: by how much an edge across the part's x axis stands out",
                ),
                Parameter(
                    key="y_um", unit="µm", to_si=_UM,
                    meaning="d_y: by how much an edge across the part's y axis stands out",
                ),
            ),
        ),
        Effect(
            name="part_skew",
            equation="y → y + x tan κ",
            source="a mask or a cut that is out of square",
            forms=(
                "edges across the part's y axis lean", "edges across the part's x axis lean",
                "both do, by half", "edges across the part's y axis converge towards −x",
                "edges across the part's x axis converge towards −y",
            ),
            parameters=(
                Parameter(
                    key="angle_deg", unit="°", to_si=_DEG, low=-10.0 * _DEG, high=10.0 * _DEG,
                    meaning="κ: by how much two corners are sharper than stated, and the two others blunter",
                ),
            ),
        ),
        Effect(
            name="tip_radius",
            equation="r = stated radius + e",
            source="wear or dirt of the tip",
            forms=("every tip", "the first tip only", "the second tip only"),
            parameters=(
                Parameter(key="excess_um", unit="µm", to_si=_UM, meaning="e, of the tips of the form"),
            ),
        ),
        Effect(
            name="reference_offset",
            equation="tracked point = reference point + R(θ) c",
            source="template of the tracker",
            parameters=(
                Parameter(key="x_um", unit="µm", to_si=_UM, meaning="c_x, frame of the part"),
                Parameter(key="y_um", unit="µm", to_si=_UM, meaning="c_y, frame of the part"),
            ),
        ),
        Effect(
            name="part_yaw",
            equation="tracked angle = θ + ψ",
            source="template of the tracker: its axes are not the outline's",
            parameters=(
                Parameter(
                    key="angle_deg", unit="°", to_si=_DEG, low=-45.0 * _DEG, high=45.0 * _DEG,
                    meaning="ψ, by which the tracked frame is turned against the part's outline",
                ),
            ),
        ),
    ),
)  # fmt: skip

_OUT_X = GEOMETRY.slot("part_geometry", "x_um")
_OUT_Y = GEOMETRY.slot("part_geometry", "y_um")
_OUT_FORM = GEOMETRY.slot("part_geometry", FORM)
_SKEW = GEOMETRY.slot("part_skew", "angle_deg")
_SKEW_FORM = GEOMETRY.slot("part_skew", FORM)
# by form: of edges across x, and across y
_LEANING = np.array([[0.0, 1.0], [1.0, 0.0], [0.5, 0.5], [0.0, 0.0], [0.0, 0.0]])
_CONVERGING = np.array([*3 * [[0.0, 0.0]], [0.0, 1.0], [1.0, 0.0]])
_SIDES = np.array([[0.0, 0.0], [1.0, 1.0], [1.0, -1.0], [-1.0, 1.0], [-1.0, -1.0]])
EXCESS = GEOMETRY.slot("tip_radius", "excess_um")
"""Column of the excess of the tips' radius."""
_EXCESS_FORM = GEOMETRY.slot("tip_radius", FORM)
_OFFSET_X = GEOMETRY.slot("reference_offset", "x_um")
_OFFSET_Y = GEOMETRY.slot("reference_offset", "y_um")
_YAW = GEOMETRY.slot("part_yaw", "angle_deg")


def outlines(vertices: Floats, table: Floats) -> Floats:
    """True outlines of the part.

    The part is stretched about its reference point by ``1 + d / h`` along each of its axes, h half
    its extent: an edge across an axis then stands out by d. Of a part of which one edge of two is out
    of place it is moved on by d, so that the other edge is where it was. What is out of square then has edges
    that lean, or converge, by the angle κ.

    Parameters
    ----------
    vertices
        (V, 2) or (N, V, 2) stated corners, m.
    table
        (1|N, SLOTS) of `Effects`.

    Returns
    -------
    ndarray
        (1|N, V, 2) corners, m.
    """
    moved = table[:, _OUT_X : _OUT_Y + 1] * _SIDES[table[:, _OUT_FORM].astype(int)]
    return _skewed(vertices * stretch(vertices, table)[:, None] + moved[:, None], table)


def _skewed(corners: Floats, table: Floats) -> Floats:
    """Corners (N, V, 2) in m of parts that are out of square."""
    form = table[:, _SKEW_FORM].astype(int)
    lean, taper = (np.tan(table[:, _SKEW, None] * of[form]) for of in (_LEANING, _CONVERGING))
    narrowed = 1.0 + (taper / (0.5 * np.ptp(corners, axis=-2)))[:, None] * corners[..., ::-1]
    for run in np.flatnonzero(np.any(narrowed <= 0.0, axis=(-1, -2))):
        refuse(
            "effects.part_skew",
            f"edges of run {run} meet within the part",
            "must leave something of the part",
            "give a smaller angle",
        )
    return np.asarray(corners * narrowed + lean[:, None] * corners[..., ::-1])


def stretch(vertices: Floats, table: Floats) -> Floats:
    """(1|N, 2) factors by which the part is longer than stated along its axes.

    Parameters
    ----------
    vertices
        (V, 2) or (N, V, 2) outline in the part's frame, m.
    table
        (1|N, S) of `Effects`.

    Returns
    -------
    Floats
        Along the part's x and y.

    Raises
    ------
    ValueError
        If an edge would stand in by as much as half the part.
    """
    factor = 1.0 + table[:, _OUT_X : _OUT_Y + 1] / (0.5 * np.ptp(vertices, axis=-2))
    for run, axis in np.argwhere(~(factor > 0.0)):
        refuse(
            "effects.part_geometry",
            f"run {run} leaves a part of {factor[run, axis]:.3g} times its extent along {'xy'[axis]}",
            "must leave something of the part",
            "give a smaller deficit",
        )
    return np.asarray(factor)


def radii(stated: Floats, table: Floats) -> Floats:
    """(1|N, P) true radii of the tips in m, for stated radii (P,) or (1|N, P).

    Parameters
    ----------
    stated, table
        Radii in m, and the (1|N, S) table of `Effects`.

    Returns
    -------
    Floats
        (1|N, P) m.
    """
    form = table[:, _EXCESS_FORM, None]
    own = (form == 0.0) | (form == np.arange(1.0, np.shape(stated)[-1] + 1.0))
    return np.asarray(stated + own * table[:, EXCESS : EXCESS + 1])


def reference_of_tracked(poses: Floats, table: Floats) -> Floats:
    """Poses (N, …, 3) of the reference point for those of the tracked point.

    Parameters
    ----------
    poses
        (N, …, 3) m and rad, world frame.
    table
        (1|N, S) of `Effects`.

    Returns
    -------
    Floats
        (N, …, 3) m and rad; the argument itself where there is no offset.
    """
    return _shifted(_turned(poses, table, -1.0), table, -1.0)


def tracked_of_reference(poses: Floats, table: Floats) -> Floats:
    """Poses (N, …, 3) of the tracked point for those of the reference point.

    Parameters
    ----------
    poses, table
        As for `reference_of_tracked`.

    Returns
    -------
    Floats
        As of `reference_of_tracked`.
    """
    return _turned(_shifted(poses, table, 1.0), table, 1.0)


def _turned(poses: Floats, table: Floats, sign: float) -> Floats:
    yaw = sign * table[:, _YAW]
    if not np.any(yaw):
        return poses
    turned = poses.copy()
    turned[..., 2] += yaw.reshape(-1, *[1] * (poses.ndim - 2))
    return turned


def _shifted(poses: Floats, table: Floats, sign: float) -> Floats:
    offset = sign * table[:, _OFFSET_X : _OFFSET_Y + 1]
    if not np.any(offset):
        return poses
    offset = offset.reshape(-1, *[1] * (poses.ndim - 2), 2)
    cos, sin = np.cos(poses[..., 2]), np.sin(poses[..., 2])
    moved = poses.copy()
    moved[..., 0] += cos * offset[..., 0] - sin * offset[..., 1]
    moved[..., 1] += sin * offset[..., 0] + cos * offset[..., 1]
    return moved
