"""Support models, as users state them: film, dry contact, or both.

Every model answers one question, `tables`: which film matrix, dry points and limit surface the
kernels shall use (`support`). A film alone has no scale of force, and neither has dry contact alone;
only `Mixture` needs the ratio of the two.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import NamedTuple, Protocol

import numpy as np

from meso_robust.simulator.outline import quadrature, refuse
from meso_robust.simulator.stage import REFERENCE_SPEED
from meso_robust.types import Flags, Floats

_UPPER = ((0, 0, 0, 1, 1, 2), (0, 1, 2, 1, 2, 2))  # packed order of a symmetric matrix


class Tables(NamedTuple):
    """What the kernels read; the leading length is 1 or N runs."""

    film: Floats
    """(1|N, 6) packed drag matrix over e_x; zeros without a film."""
    points: Floats
    """(1|N, K, 3) x, y in m and strength over e_x in m/s of the dry points."""
    surface: Floats
    """(1|N, 6) packed matrix of the limit surface over e_x², m²/s²; zeros without one."""
    lay: Floats = np.zeros((1, 4))
    """(1|N, 4) of the stage, over e_x, and the centre of drag at which it acts, m."""


class Support(Protocol):
    """What a part may slide on."""

    def tables(self) -> Tables:
        """Tables of this support for the kernels."""


_NO_FILM = np.zeros((1, 6))
_NO_POINTS = np.zeros((1, 0, 3))


def packed(matrix: Floats) -> Floats:
    """Upper triangles (…, 6) by rows of symmetric matrices (…, 3, 3)."""
    return np.ascontiguousarray(matrix[..., _UPPER[0], _UPPER[1]])


def _positive_definite(name: str, matrix: Floats) -> Floats:
    """Copy as (1|N, 3, 3), refusing what is not symmetric and positive definite."""
    array = np.array(matrix, dtype=np.float64)
    if array.ndim not in (2, 3) or array.shape[-2:] != (3, 3):
        refuse(name, f"shape {array.shape}", "must be (3, 3) or (N, 3, 3)", "reshape it")
    array = array.reshape(-1, 3, 3)
    if not np.all(np.isfinite(array)):
        refuse(name, "a number that is not finite", "must be finite", "correct the value")
    if not np.allclose(array, array.transpose(0, 2, 1), rtol=1e-12, atol=0.0):
        refuse(name, "not symmetric", "must equal its transpose", "give (E + Eᵀ) / 2")
    scale = np.sqrt(np.abs(array[:, [0, 1, 2], [0, 1, 2]]))
    scaled = array / np.maximum(scale[:, :, None] * scale[:, None, :], 1e-300)
    least = np.ones(len(array))
    mixed = (packed(array)[:, [1, 2, 4]] != 0.0).any(
        axis=1
    )  # the eigenvalues of the others are one
    least[mixed] = np.linalg.eigvalsh(scaled[mixed]).min(axis=1)
    diagonal = array[:, [0, 1, 2], [0, 1, 2]].min(axis=1)
    for run in np.flatnonzero(~((least > 1e-12) & (diagonal > 0.0))):
        value = f"run {run} has a least eigenvalue that is not positive"
        refuse(name, value, "must be positive definite", "every motion must be resisted")
    array.flags.writeable = False
    return array


@dataclass(frozen=True, slots=True, eq=False)
class Film:
    """Viscous film, ``D = E v``.

    Attributes
    ----------
    drag
        (3, 3) or (N, 3, 3) symmetric positive definite drag of the twist (m/s, m/s, rad/s) about the
        reference point, body axes; any scale. Off-centre and anisotropic films have full matrices.
    stage_lay
        (2,) or (N, 2) what the stage adds to the drag of a translation, ``[[p, q], [q, −p]]`` in the
        world's axes, at the centre of drag and in the unit of `drag`.

    Raises
    ------
    ValueError
        If a matrix is not symmetric and positive definite, or if the lay leaves no drag in some
        direction.
    """

    drag: Floats
    stage_lay: Floats = field(default_factory=lambda: np.zeros((1, 2)))

    def __post_init__(self) -> None:
        """Copy, freeze and check."""
        drag = _positive_definite("drag", self.drag)
        lay = np.array(self.stage_lay, dtype=np.float64).reshape(-1, 2)
        mean, across = 0.5 * (drag[:, 0, 0] + drag[:, 1, 1]), 0.5 * (drag[:, 0, 0] - drag[:, 1, 1])
        least = mean - np.hypot(across, drag[:, 0, 1]) - np.hypot(lay[:, 0], lay[:, 1])
        for run in np.flatnonzero(~(least > 0.0)):
            value = f"that of run {run} leaves a least drag of {least[run]:g}"
            refuse("stage_lay", value, "must leave a positive drag in every direction", "lower it")
        lay.flags.writeable = False
        object.__setattr__(self, "drag", drag)
        object.__setattr__(self, "stage_lay", lay)

    @classmethod
    def ratio(cls, film_ratio: float | Floats) -> Film:
        """The paper's film, ``diag(1, 1, ρ)``.

        Parameters
        ----------
        film_ratio
            ρ = e_θ / e_x in m², a number or (N,).

        Raises
        ------
        ValueError
            If a value is not positive and finite.
        """
        values = np.atleast_1d(np.asarray(film_ratio, dtype=np.float64))
        for run in np.flatnonzero(~((values > 0.0) & (values < np.inf))):
            refuse(
                "film_ratio",
                f"run {run} has {values[run]:g} m²",
                "e_θ/e_x must be positive and finite",
                "give the ratio of rotational to translational drag in m²",
            )
        drag = np.zeros((len(values), 3, 3))
        drag[:, 0, 0] = drag[:, 1, 1] = 1.0
        drag[:, 2, 2] = values
        return cls(drag)

    @classmethod
    def under(cls, vertices: Floats) -> Film:
        """Uniform film under the whole of an outline (V, 2), m."""
        nodes = quadrature(vertices, 1)
        x, y, w = nodes.T
        jacobian = np.zeros((len(nodes), 2, 3))
        jacobian[:, 0, 0] = jacobian[:, 1, 1] = 1.0
        jacobian[:, 0, 2], jacobian[:, 1, 2] = -y, x
        return cls(np.einsum("q,qia,qib->ab", w, jacobian, jacobian))

    def some(self, runs: slice | Flags) -> Film:
        """The film of some of the runs."""
        if isinstance(runs, slice):  # all of them
            return self
        drag, lay = (a[runs] if len(a) > 1 else a for a in (self.drag, self.stage_lay))
        return Film(drag, lay)

    def tables(self) -> Tables:
        """Film only."""
        scaled = packed(self.drag / self.drag[:, :1, :1])
        if not self.stage_lay.any():
            return Tables(scaled, _NO_POINTS, _NO_FILM)
        # a force at the centre of drag does not turn the part: there the coupling vanishes
        arm = np.linalg.solve(self.drag[:, :2, :2], self.drag[:, :2, 2:])[..., 0]
        centre = np.column_stack([arm[:, 1], -arm[:, 0]])
        lay = self.stage_lay / self.drag[:, 0, 0, None]
        runs = max(len(lay), len(centre))
        both = [np.broadcast_to(numbers, (runs, 2)) for numbers in (lay, centre)]
        return Tables(scaled, _NO_POINTS, _NO_FILM, np.concatenate(both, axis=1))


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class ThreePoints:
    """Three support points with Coulomb friction, the model of the paper's Section V.

    The normal forces follow from the balance out of the plane: they are the shares of the weight
    that put the centre of mass into the points' centroid (`loads`).

    Attributes
    ----------
    points
        (3, 2) or (N, 3, 2) support points in m, body frame.
    centre_of_mass
        (2,) in m, body frame.
    friction
        μ_s. It multiplies every force alike and so leaves the motion as it is (the paper's remark on
        Table I); only in a `Mixture` would it count, and there the ratio holds it.

    Raises
    ------
    ValueError
        If μ_s is not positive, or if the points do not stand around the centre of mass.
    """

    points: Floats
    centre_of_mass: tuple[float, float] = (0.0, 0.0)
    friction: float = 1.0

    def __post_init__(self) -> None:
        """Copy, freeze and check."""
        array = np.array(self.points, dtype=np.float64)
        if array.ndim not in (2, 3) or array.shape[-2:] != (3, 2):
            refuse("points", f"shape {array.shape}", "must be (3, 2) or (N, 3, 2)", "reshape it")
        array = array.reshape(-1, 3, 2)
        for name, values in (("points", array), ("centre_of_mass", self.centre_of_mass)):
            if not np.all(np.isfinite(values)):
                refuse(name, "a number that is not finite", "must be finite", "correct the value")
        if not 0.0 < self.friction < np.inf:
            refuse("friction", f"{self.friction}", "must be positive and finite", "give μ_s")
        array.flags.writeable = False
        object.__setattr__(self, "points", array)
        loads = self.loads
        for run, point in np.argwhere(~(loads > 0.0)):
            refuse(
                "points",
                f"point {point} of run {run} carries {loads[run, point]:.4g} of the weight",
                "must stand around the centre of mass, so that each carries some",
                "move the points or the centre of mass",
            )

    @property
    def loads(self) -> Floats:
        """(1|N, 3) shares of the weight on the points."""
        d = self.points - np.asarray(self.centre_of_mass)
        b, c = np.roll(d, -1, axis=1), np.roll(d, -2, axis=1)
        pieces = b[..., 0] * c[..., 1] - b[..., 1] * c[..., 0]
        whole = np.sum(pieces, axis=1, keepdims=True)
        return np.asarray(pieces / np.where(whole == 0.0, np.nan, whole))

    def tables(self) -> Tables:
        """Three dry points."""
        rows = np.concatenate([self.points, REFERENCE_SPEED * self.loads[..., None]], axis=2)
        return Tables(_NO_FILM, rows, _NO_FILM)


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class PressurePoints:
    """Any number of dry points with given shares of the load, such as an area cut into pieces.

    Attributes
    ----------
    points
        (K, 2) in m, body frame.
    shares
        (K,) positive shares of the load; they are divided by their sum.

    Raises
    ------
    ValueError
        If the shapes do not agree or a share is not positive.
    """

    points: Floats
    shares: Floats

    def __post_init__(self) -> None:
        """Copy, freeze and check."""
        points = np.array(self.points, dtype=np.float64)
        shares = np.array(self.shares, dtype=np.float64)
        if points.ndim != 2 or points.shape != (len(shares), 2) or not len(points):
            refuse("points", f"shape {points.shape}", "must be (K, 2) with K shares", "reshape it")
        if not np.all(np.isfinite(points)):
            refuse("points", "a number that is not finite", "must be finite", "correct the value")
        for k in np.flatnonzero(~((shares > 0.0) & (shares < np.inf))):
            refuse("shares", f"share {k} is {shares[k]}", "must be positive", "leave it out")
        points.flags.writeable = shares.flags.writeable = False
        object.__setattr__(self, "points", points)
        object.__setattr__(self, "shares", shares)

    @classmethod
    def under(cls, vertices: Floats, cells: int = 6) -> PressurePoints:
        """Uniform pressure under the whole of an outline (V, 2), m, cut into cells."""
        nodes = quadrature(vertices, cells)
        return cls(points=nodes[:, :2], shares=nodes[:, 2])

    def tables(self) -> Tables:
        """Dry points only."""
        strength = REFERENCE_SPEED * self.shares / self.shares.sum()
        return Tables(_NO_FILM, np.column_stack([self.points, strength])[None], _NO_FILM)


@dataclass(frozen=True, slots=True, eq=False)
class LimitSurface:
    """Ellipsoidal limit surface: the force lies on ``fᵀ A⁻¹ f = 1`` and the twist is normal to it.

    Attributes
    ----------
    matrix
        (3, 3) or (N, 3, 3) symmetric positive definite A, body axes at the reference point; any
        scale. ``diag(1, 1, r²)`` has a largest torque of r times the largest force.

    Raises
    ------
    ValueError
        If a matrix is not symmetric and positive definite.
    """

    matrix: Floats

    def __post_init__(self) -> None:
        """Copy, freeze and check."""
        object.__setattr__(self, "matrix", _positive_definite("matrix", self.matrix))

    def tables(self) -> Tables:
        """Limit surface only."""
        scaled = packed(self.matrix / self.matrix[:, :1, :1]) * REFERENCE_SPEED**2
        return Tables(_NO_FILM, _NO_POINTS, scaled)


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Mixture:
    """Film and dry contact at once.

    Attributes
    ----------
    film, dry
        The two.
    ratio
        Largest dry force of a translation over the film's drag at 75 µm/s, a number or (N,).

    Raises
    ------
    ValueError
        If a ratio is negative or not finite.
    """

    film: Film
    dry: ThreePoints | PressurePoints | LimitSurface
    ratio: float | Floats

    def __post_init__(self) -> None:
        """Copy, freeze and check."""
        ratio = np.atleast_1d(np.array(self.ratio, dtype=np.float64))
        for run in np.flatnonzero(~((ratio >= 0.0) & (ratio < np.inf))):
            refuse(
                "ratio", f"run {run} has {ratio[run]:g}", "must not be negative", "give 0 or more"
            )
        ratio.flags.writeable = False
        object.__setattr__(self, "ratio", ratio)

    def tables(self) -> Tables:
        """Film and dry contact, the latter scaled by the ratio."""
        dry, ratio = self.dry.tables(), np.asarray(self.ratio)
        points = dry.points * np.ones((len(ratio), 1, 1))
        points[..., 2] *= ratio[:, None]
        film = self.film.tables()
        return Tables(film.film, points, dry.surface * ratio[:, None] ** 2, film.lay)
