"""A part that lies on the film from instant to instant, and what its film is made of."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from meso_robust.plant.kernel import COARSE, DONE, TIP, Grain, advance, nearest
from meso_robust.plant.world import World

Floats = npt.NDArray[np.float64]
_ROWS = 11  # of nodes across the longer side, where the drag is not the same linear one everywhere


def outline_of(outline: Floats, world: World) -> Floats:
    """The true outline.

    Parameters
    ----------
    outline
        (V, 2) um, as stated.
    world
        What is true of it.

    Returns
    -------
    Floats
        (V, 2) um, with the edges that stand out.
    """
    return np.asarray(outline + np.sign(outline) * np.array(world.grown))


def nodes_of(outline: Floats, film_ratio: float, world: World) -> Floats:
    """Nodes of the film.

    Parameters
    ----------
    outline
        (V, 2) um.
    film_ratio
        Rotational over translational drag, um².
    world
        With the laws and the centre of drag.

    Returns
    -------
    Floats
        (Q, 3) of equal weight: x and y in the part's frame, and the relative pressure. Their second
        moment is the film's ratio, whatever their number.
    """
    if world.laws.uniform:
        arm = np.sqrt(0.5 * film_ratio)
        nodes = arm * np.array([[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]])
    else:
        low, high = outline.min(axis=0), outline.max(axis=0)
        pitch = float((high - low).max()) / _ROWS
        axes = [np.arange(a + 0.5 * pitch, b, pitch) for a, b in zip(low, high, strict=True)]
        grid = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 2)
        nodes = grid[_inside(outline, grid)]
        nodes -= nodes.mean(axis=0)
        nodes *= np.sqrt(film_ratio / np.mean(np.sum(nodes**2, axis=1)))
    lean = np.array([world.laws.uneven_x, world.laws.uneven_y])
    pressure = 1.0 + nodes @ (lean / np.mean(nodes**2, axis=0))
    return np.column_stack([nodes + np.array(world.centre), pressure])


def _inside(outline: Floats, points: Floats) -> npt.NDArray[np.bool_]:
    odd = np.zeros(len(points), dtype=np.bool_)
    for a, b in zip(outline, np.roll(outline, -1, axis=0), strict=True):
        crosses = (a[1] > points[:, 1]) != (b[1] > points[:, 1])
        rise = b[1] - a[1] if b[1] != a[1] else 1.0
        odd ^= crosses & (points[:, 0] < a[0] + (points[:, 1] - a[1]) / rise * (b[0] - a[0]))
    return odd


class LyingPart:
    """A part on its film, pushed by whatever tips are in the plane.

    Parameters
    ----------
    outline
        (V, 2) stated corners, um, counter-clockwise.
    film_ratio
        Of its film, um².
    world
        What is true besides.
    pose
        (3,) at the start, um and rad.
    grain
        How fine the plant is.
    """

    def __init__(
        self, outline: Floats, film_ratio: float, world: World, pose: Floats, grain: Grain = COARSE
    ) -> None:
        self._outline = outline_of(outline, world)
        nodes = nodes_of(self._outline, film_ratio, world)
        self._support = (nodes, np.array(world.lay), world.laws)
        self._state = (np.array(pose, dtype=float), np.zeros(3), np.zeros(1), np.zeros(1))
        self._grain, self._tips = grain, np.zeros((0, TIP))
        self._names: tuple[str, ...] = ()
        self._post = np.array([*world.post[1:], world.post[0]])
        self.stuck = False

    @property
    def pose(self) -> Floats:
        """(3,) now, um and rad."""
        return self._state[0].copy()

    def pushed(self, tips: dict[str, tuple[Floats, Floats, float, float]], duration: float) -> None:
        """Let a time pass.

        Parameters
        ----------
        tips
            Of each tip in the plane, by its name: place before and after (2,), radius and friction;
            um.
        duration
            s.
        """
        known = dict(zip(self._names, self._tips, strict=True))
        rows, ways, friction = [], [], []
        for name, (before, after, radius, mu) in tips.items():
            row = known.get(name, np.zeros(TIP)).copy()
            row[:2], row[4] = before, radius
            rows.append(row)
            ways.append(after - before)
            friction.append(mu)
        names = tuple(tips)
        if self._post[2] > 0.0:
            row = known.get("", np.zeros(TIP)).copy()
            row[:2], row[4] = self._post[:2], self._post[2]
            rows.append(row)
            ways.append(np.zeros(2))
            friction.append(0.3)
            names = (*names, "")
        self._names, self._tips = names, np.array(rows).reshape(-1, TIP)
        way = np.array(ways, dtype=float).reshape(-1, 2)
        mu_of = np.array(friction, dtype=float)
        ended = advance(
            self._outline, self._support, self._tips, way, mu_of, self._grain, self._state, duration
        )
        self.stuck = self.stuck or ended != DONE

    def gap(self, place: Floats) -> float:
        """Distance of a place (2,) from the part's edge, um; negative inside."""
        x, y, theta = self._state[0]
        c, s = np.cos(theta), np.sin(theta)
        dx, dy = place[0] - x, place[1] - y
        return float(nearest(self._outline, c * dx + s * dy, c * dy - s * dx)[0])

    def move_by(self, shift: Floats) -> None:
        """Lay the part elsewhere: (3,) um and rad."""
        self._state[0][:] += shift
