"""What draws make of a task: true outlines of the part, its film, and the true ways of the tips."""

from __future__ import annotations

import numpy as np

from meso_robust.laboratory.draws import Draws
from meso_robust.primitives.setup import Setup
from meso_robust.simulator.support_models import Film
from meso_robust.types import Floats

WANDERS_WITHIN = 100e-6
"""m of travel in which a probe may stray by all that it wanders."""
ROUND = 3  # points of an arc in place of a rounded corner


def outline(setup: Setup) -> Floats:
    """The part's corners as stated.

    Parameters
    ----------
    setup
        The task.

    Returns
    -------
    Floats
        (V, 2) body frame, counter-clockwise, m.
    """
    return np.array([[x.mid, y.mid] for x, y in setup.outline.corners])


def true_outlines(setup: Setup, draws: Draws) -> Floats:
    """The parts' corners.

    Parameters
    ----------
    setup, draws
        The task, and what is uncertain in N runs.

    Returns
    -------
    Floats
        (1|N, V, 2) body frame, counter-clockwise, m; rounded corners as the polygons of `ROUND`
        points on their arcs.
    """
    corners = outline(setup)[None]
    if draws.edges is not None:
        corners = _out_of_true(corners[0], draws.edges)
    return _rounded(corners, setup.corner_radius.hi) if setup.corner_radius.hi > 0.0 else corners


def _out_of_true(corners: Floats, edges: Floats) -> Floats:
    """(N, V, 2) corners where edges meet that lie farther out and are turned, (N, V, 2)."""
    side = np.roll(corners, -1, axis=0) - corners
    normal = np.column_stack([side[:, 1], -side[:, 0]]) / np.linalg.norm(side, axis=1)[:, None]
    far = np.sum(normal * corners, axis=1) + edges[..., 0]
    c, s = np.cos(edges[..., 1]), np.sin(edges[..., 1])
    nx, ny = c * normal[:, 0] - s * normal[:, 1], s * normal[:, 0] + c * normal[:, 1]
    mx, my, before = (np.roll(a, 1, axis=1) for a in (nx, ny, far))
    det = mx * ny - my * nx
    return np.stack([(before * ny - far * my) / det, (far * mx - before * nx) / det], axis=-1)


def _rounded(corners: Floats, radius: float) -> Floats:
    """(N, V', 2) outlines (N, V, 2) with each convex corner replaced by points of an arc."""
    ahead, back = np.roll(corners, -1, axis=1) - corners, np.roll(corners, 1, axis=1) - corners
    ahead /= np.linalg.norm(ahead, axis=2, keepdims=True)
    back /= np.linalg.norm(back, axis=2, keepdims=True)
    found = []
    for k in range(corners.shape[1]):
        to, fro = ahead[:, k], back[:, k]
        bend = np.pi - np.arccos(np.sum(to * fro, axis=1))  # exterior angle
        if to[0, 0] * fro[0, 1] - to[0, 1] * fro[0, 0] <= 0.0:
            found.append(corners[:, k])
            continue
        middle = to + fro
        middle /= np.linalg.norm(middle, axis=1, keepdims=True)
        centre = corners[:, k] + (radius / np.cos(0.5 * bend))[:, None] * middle
        for share in np.linspace(-0.5, 0.5, ROUND):
            c, s = np.cos(share * bend), np.sin(share * bend)
            way = np.stack(
                [c * middle[:, 0] - s * middle[:, 1], s * middle[:, 0] + c * middle[:, 1]]
            )
            found.append(centre - radius * way.T)
    return np.stack(found, axis=1)


def film_of(setup: Setup, draws: Draws) -> Film:
    """The films under the parts.

    Parameters
    ----------
    setup, draws
        The task, and what is uncertain in N runs.

    Returns
    -------
    Film
        One for each run.
    """
    if draws.drag_centre is None and draws.lay is None:
        return Film.ratio(draws.film_ratio)
    runs, u = len(draws.film_ratio), setup.uncertainty
    centre = _within(draws.drag_centre, u.drag_centre.hi, runs)
    lay = _within(None if draws.lay is None else draws.lay[:, :2], u.drag_anisotropy.hi, runs)
    stage = np.zeros(runs) if draws.lay is None else draws.lay[:, 2]
    along, across = ((1.0 - stage)[:, None] * lay).T
    arms = np.zeros((runs, 2, 3))  # velocity of the centre of drag by the part's twist
    arms[:, 0, 0] = arms[:, 1, 1] = 1.0
    arms[:, 0, 2], arms[:, 1, 2] = -centre[:, 1], centre[:, 0]
    tensor = np.array([[1.0 + along, across], [across, 1.0 - along]])
    drag = np.einsum("nia,ijn,njb->nab", arms, tensor, arms)
    drag[:, 2, 2] += draws.film_ratio
    return Film(0.5 * (drag + drag.transpose(0, 2, 1)), stage[:, None] * lay)


def _within(vectors: Floats | None, longest: float, runs: int) -> Floats:
    """(N, 2) vectors, cut to a length."""
    if vectors is None:
        return np.zeros((runs, 2))
    length = np.linalg.norm(vectors, axis=1, keepdims=True)
    return np.asarray(vectors * np.minimum(1.0, longest / np.maximum(length, longest)))


def true_ways(setup: Setup, draws: Draws, k: int, tips: Floats, travel: Floats) -> Floats:
    """Where the tips really go.

    Parameters
    ----------
    setup, draws, k
        The task, what is uncertain in N runs, and the number of the move.
    tips, travel
        (N, P, 2) true starts and commanded displacements, m; a tip without travel rests.

    Returns
    -------
    Floats
        (N, L + 1, P, 2) ends of the legs, m.
    """
    legs = draws.legs
    turn = np.zeros(len(tips)) if draws.direction is None else draws.direction[:, k]
    if draws.direction is not None or draws.scale is not None:
        scale = 1.0 + (0.0 if draws.scale is None else draws.scale[:, k])
        c, s = (scale * np.cos(turn))[:, None], (scale * np.sin(turn))[:, None]
        x, y = travel[..., 0], travel[..., 1]
        travel = np.stack([c * x - s * y, s * x + c * y], axis=-1)
    shares = np.linspace(0.0, 1.0, legs + 1)[:, None, None]
    ways = tips[:, None] + shares * travel[:, None]
    if draws.wander is None:
        return ways
    bend = setup.uncertainty.probe_wander.hi / WANDERS_WITHIN
    leg = np.linalg.norm(travel, axis=2).max(axis=1) / legs
    # so that the direction strays by no more than the bend, however the travel lies to the axes
    most = (bend * leg / ((1.0 + np.abs(turn)) * (1.0 + bend)))[:, None]
    off = draws.wander[:, k, 0]
    moves = (travel != 0.0).any(axis=2)[..., None]
    ways[:, 0] += np.where(moves, off[:, None], 0.0)
    for j in range(1, legs + 1):
        off = off + np.clip(draws.wander[:, k, j] - off, -most, most)
        ways[:, j] += np.where(moves, off[:, None], 0.0)
    return ways
