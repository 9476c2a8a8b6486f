r"""A part between two tips that both slip, along the same edge or along parallel ones: a channel.

The two turn the part as a sticking tip and a slipping one do (see `curve`), so that its angle at any
instant is in closed form, and only the way ``y`` of the first tip along its edge is left to be
integrated. With ``g, h`` the wrenches of the tips the film asks for ``(g × h) · E v = 0``, linear in
the speed of the part along the edge.
"""

import numpy as np

from meso_robust.kernels import inlined, sealed as inner
from meso_robust.simulator.events.balance import cross, dot, is_even, times
from meso_robust.simulator.events.contact import to_body
from meso_robust.simulator.events.curve import about_pivot, guided_turn, start_guided
from meso_robust.simulator.events.outline import NX, NY
from meso_robust.simulator.events.scene import (
    CLOSED,
    EDGE,
    FIRST,
    HELD,
    KIND,
    SECOND,
    SEPARATE,
    SLIP_MINUS,
    STICK,
    TOUCHING,
    Scene,
    Work,
)
from meso_robust.simulator.events.tableau import NODES, RESULT, STAGES, WEIGHTS

_PARALLEL = 1e-14  # sine of the angle between edges: rounding of their normals


@inner
def in_channel(scene: Scene, work: Work) -> bool:
    """Whether two tips slip along parallel edges; writes the numbers of their contacts."""
    if work.count[CLOSED] != 2 or work.count[HELD] != 2 or not is_even(work):
        return False
    found = 0
    for c in range(work.count[TOUCHING]):
        if work.mode[c] != SEPARATE:
            if work.mode[c] == STICK or work.contact[c, KIND] != EDGE:
                return False
            work.pair[found] = c
            found += 1
    one = scene.edges[work.contact[work.pair[0], SECOND]]
    other = scene.edges[work.contact[work.pair[1], SECOND]]
    return bool(abs(one[NX] * other[NY] - one[NY] * other[NX]) <= _PARALLEL)


@inner
def start_channel(scene: Scene, work: Work, clock: float) -> None:
    """Write the angle's curve from the present pose on."""
    start_guided(scene, work, work.channel, (work.pair[0], work.pair[1]), clock)


@inlined
def _wrench(
    scene: Scene, work: Work, c: int, at: tuple[float, float]
) -> tuple[float, float, float]:
    """Wrench of a tip that slips, whose centre is given in the body frame."""
    i, edge = work.contact[c, FIRST], scene.edges[work.contact[c, SECOND]]
    r, mu = scene.tips[i, 4], scene.tips[i, 5] * (1.0 if work.mode[c] == SLIP_MINUS else -1.0)
    nx, ny = -edge[NX], -edge[NY]
    gx, gy = nx + mu * ny, ny - mu * nx
    px, py = at[0] + r * nx, at[1] + r * ny
    return gx, gy, px * gy - py * gx


@inlined
def _slip(scene: Scene, work: Work, time: float, way: float) -> float:
    """Speed of the first tip along its edge, at a way along it from where it was at the start."""
    curve = work.channel
    edge = scene.edges[work.contact[work.pair[0], SECOND]]
    nx, ny = edge[NX], edge[NY]
    turn, between, omega = guided_turn(curve, time)
    cx, cy = curve[6] - way * ny, curve[7] + way * nx
    place = about_pivot(curve, time, turn, (cx, cy))
    bx, by = to_body(between[0], between[1], place)
    g = _wrench(scene, work, work.pair[0], (cx, cy))
    h = _wrench(scene, work, work.pair[1], (cx + bx, cy + by))
    film = times(work.drag, cross(g, h))
    ux, uy = to_body(curve[4], curve[5], place)
    # velocity of the part where the tip is, as if the tip stuck, and what that leaves to the film
    vx, vy = ux + omega * cy, uy - omega * cx
    return dot(film, (vx, vy, omega)) / (film[1] * nx - film[0] * ny)


@inner
def glide(scene: Scene, work: Work, step: float) -> None:
    """Step along the channel from the present pose; write the slopes and the trial pose."""
    slide, curve = work.slide, work.channel
    way = 0.0
    for s in range(STAGES):
        way = 0.0
        for k in range(s):
            way += WEIGHTS[s, k] * slide[k]
        slide[s] = _slip(scene, work, NODES[s] * step, step * way)
    way = 0.0
    for k in range(STAGES):
        way += RESULT[k] * slide[k]
    way *= step
    edge = scene.edges[work.contact[work.pair[0], SECOND]]
    turn = guided_turn(curve, step)[0]
    pivot = (curve[6] - way * edge[NY], curve[7] + way * edge[NX])
    x, y, _, _ = about_pivot(curve, step, turn, pivot)
    work.trial[0], work.trial[1], work.trial[2] = x, y, curve[3] + np.arctan2(turn[0], turn[1])
