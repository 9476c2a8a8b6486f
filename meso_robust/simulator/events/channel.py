r"""A part between two tips that both slip, along the same edge or along parallel ones: a channel.

The two turn the part as a sticking tip and a slipping one do (see `curve`), so that its angle at any
instant is in closed form, and only the way ``y`` of the first tip along its edge is left to be
integrated. With ``g, h`` the wrenches of the tips the film asks for ``(g × h) · E v = 0``, linear in
the speed of the part along the edge.
"""

from meso_robust.simulator.events.balance import cross, dot, is_even, times
from meso_robust.simulator.events.contact import to_body
from meso_robust.simulator.events.curve import about_pivot, angle_of, guided_turn, start_guided
from meso_robust.simulator.events.fused import inlined, sealed
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
from meso_robust.simulator.events.tableau import ALL, INSIDE, NODES, RESULT, STAGES, WEIGHTS

_PARALLEL = 1e-14  # sine of the angle between edges: rounding of their normals


@sealed
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


@sealed
def start_channel(scene: Scene, work: Work, clock: float) -> None:
    """Write the angle's curve from the present pose on."""
    start_guided(scene, work, work.channel, (work.pair[0], work.pair[1]), clock)


@inlined
def _force(scene: Scene, work: Work, c: int) -> tuple[float, float, float]:
    """Direction of the force of a tip that slips, and its moment about the tip's centre."""
    i, edge = work.contact[c, FIRST], scene.edges[work.contact[c, SECOND]]
    r, mu = scene.tips[i, 4], scene.tips[i, 5] * (1.0 if work.mode[c] == SLIP_MINUS else -1.0)
    nx, ny = -edge[NX], -edge[NY]
    gx, gy = nx + mu * ny, ny - mu * nx
    return gx, gy, r * (nx * gy - ny * gx)


@sealed
def glide(scene: Scene, work: Work, step: float) -> None:
    """Step along the channel from the present pose; write the slopes and the trial pose."""
    _stages(scene, work, step, 0, STAGES)
    way = 0.0
    for k in range(STAGES):
        way += RESULT[k] * work.slide[k]
    _write_pose(scene, work, step, step * way)


@sealed
def prepare_inside(scene: Scene, work: Work, step: float) -> None:
    """Write the way inside the step that was made last, as a polynomial of order 7.

    With ``u`` the part of the step it is ``u (w₀ + (1 − u)(w₁ + u (w₂ + (1 − u)(w₃ + …``
    """
    slide, inside = work.slide, work.inside
    _stages(scene, work, step, STAGES, ALL)
    way = 0.0
    for k in range(STAGES):
        way += RESULT[k] * slide[k]
    inside[0], inside[1] = step * way, step * (slide[0] - way)
    inside[2] = step * (2.0 * way - slide[STAGES] - slide[0])
    for m in range(INSIDE.shape[0]):
        inside[3 + m] = 0.0
        for k in range(ALL):
            inside[3 + m] += step * INSIDE[m, k] * slide[k]


@sealed
def glide_inside(scene: Scene, work: Work, step: float, time: float) -> None:
    """Write the trial pose at an instant of the step, which `prepare_inside` was told of."""
    part = time / step
    way = 0.0
    for m in range(work.inside.shape[0] - 1, -1, -1):
        way = (way + work.inside[m]) * (part if m % 2 == 0 else 1.0 - part)
    _write_pose(scene, work, time, way)


@inlined
def _write_pose(scene: Scene, work: Work, time: float, way: float) -> None:
    """Write the trial pose at an instant from the way of the first tip along its edge until then."""
    curve, edge = work.channel, scene.edges[work.contact[work.pair[0], SECOND]]
    turn = guided_turn(curve, time)[0]
    pivot = (curve[6] - way * edge[NY], curve[7] + way * edge[NX])
    x, y, _, _ = about_pivot(curve, time, turn, pivot)
    work.trial[0], work.trial[1], work.trial[2] = x, y, curve[3] + angle_of(turn)


@inlined
def _stages(scene: Scene, work: Work, step: float, start: int, end: int) -> None:
    """Write the slopes of the stages of a step from one on up to another."""
    slide, curve = work.slide, work.channel
    edge = scene.edges[work.contact[work.pair[0], SECOND]]
    nx, ny = edge[NX], edge[NY]
    gx, gy, g = _force(scene, work, work.pair[0])
    hx, hy, h = _force(scene, work, work.pair[1])
    px, py = curve[6], curve[7]
    # by how much the moments of the two change with the way, and what the film makes of it
    by_one, by_other = -(nx * gx + ny * gy), -(nx * hx + ny * hy)
    tilt = times(work.drag, (gy * by_other - hy * by_one, hx * by_one - gx * by_other, 0.0))
    below = tilt[1] * nx - tilt[0] * ny
    for s in range(start, end):
        turn, between, omega = guided_turn(curve, NODES[s] * step)
        place = about_pivot(curve, 0.0, turn, (px, py))
        bx, by = to_body(between[0], between[1], place)
        ux, uy = to_body(curve[4], curve[5], place)
        one, other = px * gy - py * gx + g, (px + bx) * hy - (py + by) * hx + h
        film = times(work.drag, cross((gx, gy, one), (hx, hy, other)))
        # twist of a part on whose edge the first tip stuck, over what the film lets of it
        stuck = (ux + omega * py, uy - omega * px, omega)
        first = dot(tilt, stuck) + omega * (film[0] * nx + film[1] * ny)
        second = omega * (tilt[0] * nx + tilt[1] * ny)
        rest, all_but = dot(film, stuck), film[1] * nx - film[0] * ny
        # the way comes last, as each stage has to wait for it: all else is done meanwhile
        way = 0.0
        for k in range(s):
            way += WEIGHTS[s, k] * slide[k]
        way *= step
        slide[s] = (rest + way * (first + way * second)) / (all_but + way * below)
