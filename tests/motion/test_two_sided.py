"""The tube of the two-sided rotation against motions found by force balance alone."""

from __future__ import annotations

import itertools
import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from meso_robust.bounds import Interval
from meso_robust.conditions import values
from meso_robust.motion.two_sided import (
    FIELDS,
    Grip,
    Part as Known,
    SlideTube,
    Start,
    TubeStatus,
    cut,
    enclose_slide,
    rate_at,
)
from tests.motion.two_contacts import Floats, Part, State, gripped, push, solutions

UM = 1e-6
STEP = 4 * UM
TOLERANCE = 0.03 * UM  # of the midpoint rule, over the whole turn
END = -420 * UM


def um(low: float, high: float) -> Interval:
    return Interval(low * UM, high * UM)


def about(middle: float, reach: float) -> Interval:
    return Interval(middle - reach, middle + reach)


POINTS = Grip(
    room=um(59, 79),
    depth=um(418.4, 418.6),
    depth_far=um(418.4, 418.6),
    ends=(um(-808, -808), um(808, 808)),
    ends_far=(um(-808, -808), um(808, 808)),
    rho=Interval(0.358e-6, 0.396e-6),
    mu=Interval(0.30, 0.36),
)
REAL = replace(
    POINTS,
    room=um(170, 180),
    ends=(um(-950, -950), um(950, 950)),
    ends_far=(um(-950, -950), um(950, 950)),
    common=False,
    radius=um(2.5, 12.5),
    radius_far=um(2.5, 12.5),
    kappa=about(0.0, 0.003),
    drag_a=um(-20, 20),
    drag_n=um(-20, 20),
    stretch=about(0.0, 0.025),
    shear=about(0.0, 0.025),
)
GRIPS = {"points": POINTS, "real": REAL}


def start_of(grip: Grip, reach: float = 5 * UM) -> Start:
    """Slides around 250 um at h = 800 um that hardly depend on the constants."""
    h = um(795, 805)
    rate = rate_at(grip, h.mid, 250 * UM)
    spread = {"label": 1.0}
    rest = Interval(-reach, reach)
    return Start(
        h=h, labels={"label": um(-10, 10)}, value=250 * UM, rate=rate, spread=spread, rest=rest
    )


def parted(grip: Grip, cells: int) -> list[Known]:
    """A grip in parts of its room, of which nothing else is known."""
    return [(replace(grip, room=room), start_of(grip).labels) for room in cut(grip, cells)]


def samples(grip: Grip, count: int, seed: int = 11) -> tuple[Part, Floats, Floats]:
    """Parts within a grip, room and label; at the ends of all ranges, then anywhere."""
    rng = np.random.default_rng(seed)

    def draw(side: Interval) -> Floats:
        ends = rng.choice([side.lo, side.hi], count // 2)
        return np.concatenate([ends, rng.uniform(side.lo, side.hi, count - count // 2)])

    names = (
        "depth",
        "depth_far",
        "radius",
        "radius_far",
        "kappa",
        "drag_a",
        "drag_n",
        "rho",
        "stretch",
        "shear",
    )
    constants = {name: draw(getattr(grip, name)) for name in names}
    mu = draw(grip.mu)
    part = Part(**constants, mu=mu, mu_far=mu if grip.common else draw(grip.mu))
    return part, draw(grip.room), draw(um(-10, 10))


def named(part: Part) -> dict[str, Floats]:
    """By the names of the formulas."""
    back = {own: name for name, own in FIELDS.items()}
    return {back.get(name, name): value for name, value in vars(part).items()}


def separation(part: Part, room: Floats) -> Floats:
    return room + part.depth + part.depth_far + part.radius + part.radius_far


def started(part: Part, room: Floats, label: Floats, start: Start, seed: int = 5) -> State:
    rng = np.random.default_rng(seed)
    h = rng.uniform(start.h.lo, start.h.hi, room.size)
    rest = rng.uniform(start.rest.lo, start.rest.hi, room.size)
    q = start.value + start.rate * (start.h.hi - h) + label + rest
    return gripped(part, h, separation(part, room), q)


def beyond(tube: SlideTube, part: Part, room: Floats, label: Floats, state: State) -> float:
    """How far the slides are outside the tube at worst; negative: inside."""
    h, q, worst = state.h, state.slide(part), -np.inf
    for cell in tube.cells:
        side = cell.parameters["room"]
        own = (room >= side.lo) & (room <= side.hi)
        at = {"room": room, "label": label, **named(part)}
        middle = {name: range_.mid for name, range_ in cell.parameters.items()}

        def of_h(knots: Floats, h: Floats = h, cell: object = cell) -> Floats:
            return np.interp(-h, -cell.h, knots)  # type: ignore[attr-defined]

        first = np.clip(np.searchsorted(-cell.h, -h, side="right") - 1, 0, cell.bend.size - 1)
        sag = -0.5 * cell.bend[first] * (cell.h[first] - h) * (h - cell.h[first + 1])
        s = q - of_h(cell.centre) - sag
        for k, name in enumerate(cell.parameters):
            s = s - of_h(cell.spread[:, k]) * (at[name] - middle[name])
        off = np.maximum(s - of_h(cell.upper), of_h(cell.lower) - s)
        worst = max(worst, float(off[own].max(initial=-np.inf)))
    return worst


def followed(
    tube: SlideTube, grip: Grip, start: Start, count: int = 60, part_of: Part | None = None
) -> float:
    """How far any of many motions leaves the tube."""
    part, room, label = samples(grip, count)
    state = started(part_of or part, room, label, start)
    rng, worst = np.random.default_rng(3), -np.inf
    while float(state.h.min()) - STEP > END:
        worst = max(worst, beyond(tube, part, room, label, state))
        state = push(state, part_of or part, STEP, rng)
    return worst


def test_no_motion_leaves_the_tube_of_a_centre_of_drag_that_moves() -> None:
    """It jumps from end to end of its range at every step; a tube that knows of none is left."""
    reach = um(-20, 20)
    grip, start = replace(POINTS, centre_a=reach, centre_n=reach), start_of(POINTS)
    tubes = [enclose_slide(one, start, END, parts=parted(one, 2)) for one in (grip, POINTS)]
    part, room, label = samples(grip, 60)
    state, rng, worst = started(part, room, label, start), np.random.default_rng(3), []
    sides = np.sign(rng.uniform(-1.0, 1.0, (2, part.rho.size)))
    while float(state.h.min()) - STEP > END:
        worst.append([beyond(tube, part, room, label, state) for tube in tubes])
        # half of them keep to one corner for long: that takes the part farthest
        turned = rng.uniform(size=(2, part.rho.size)) < 0.02
        sides = np.where(turned, -sides, sides)
        moved = replace(part, drag_a=reach.hi * sides[0], drag_n=reach.hi * sides[1])
        state = push(state, moved, STEP, rng)

    known, unknown = np.max(worst, axis=0)
    assert tubes[0].status is TubeStatus.COMPLETE
    assert known < TOLERANCE
    assert unknown > TOLERANCE


@pytest.mark.parametrize("coarse", [1.0, 6.0])
@pytest.mark.parametrize("name", GRIPS)
def test_no_motion_leaves_the_tube(name: str, coarse: float) -> None:
    grip = GRIPS[name]
    start = start_of(grip)
    tube = enclose_slide(grip, start, END, parts=parted(grip, 2), coarse=coarse)
    assert tube.status is TubeStatus.COMPLETE or (coarse > 1.0 and name == "real")
    assert followed(tube, grip, start) < TOLERANCE


def known_well(room: Interval) -> Grip:
    """A grip with constants so sharp that its tube is hardly wider than a motion is bent."""
    return replace(
        POINTS, room=room, rho=Interval(0.3769e-6, 0.37691e-6), mu=Interval(0.33, 0.33001),
        depth=um(418.5, 418.51), depth_far=um(418.5, 418.51), radius=um(7, 7.01), radius_far=um(12, 12.01),
        kappa=about(0.01, 1e-7), drag_a=um(20, 20.01), drag_n=um(20, 20.01),
        stretch=about(0.01, 1e-7), shear=about(0.03, 1e-7),
    )  # fmt: skip


def test_a_long_step_is_bent_as_the_motion_is() -> None:
    grip = known_well(um(80, 80.01))
    start = start_of(grip, 0.01 * UM)
    tube = enclose_slide(grip, start, END, coarse=8.0)
    (cell,) = tube.cells
    assert tube.status is TubeStatus.COMPLETE
    assert followed(tube, grip, start, 8) < TOLERANCE
    bulge = np.abs(cell.bend) * np.diff(cell.h) ** 2 / 8
    assert bulge.max() > 3 * TOLERANCE  # without it motions would be outside
    # a line between two knots holds the bulge too
    for k in range(cell.bend.size):
        line, sag = cell.line(k, k + 1), -np.sign(cell.bend[k]) * bulge[k]
        assert line.rest.lo <= min(cell.lower[k : k + 2]) + min(sag, 0.0)
        assert line.rest.hi >= max(cell.upper[k : k + 2]) + max(sag, 0.0)


@pytest.mark.parametrize("cells", [1, 3])
def test_the_tube_of_point_tips_is_not_much_wider_than_the_motions(cells: int) -> None:
    tube = enclose_slide(POINTS, start_of(POINTS), END, parts=parted(POINTS, cells))
    lines = tube.lines(Interval(END, END + 20 * UM))
    assert all(line.rest.width < (70 if cells == 1 else 30) * UM for line in lines)
    part, room, label = samples(POINTS, 400)
    state, rng = started(part, room, label, start_of(POINTS)), np.random.default_rng(1)
    while float(state.h.min()) - STEP > END + 10 * UM:
        state = push(state, part, STEP, rng)
    for cell, line in zip(tube.cells, lines, strict=True):
        q = line.value + line.rate * (line.first - state.h)
        for name, side in cell.parameters.items():
            at = {"room": room, "label": label, **named(part)}[name]
            slope = line.spread[name] + line.drift[name] * (line.first - state.h)
            q = q + slope * (at - side.mid)
        of_cell = cell.parameters["room"]
        off = (state.slide(part) - q)[(room >= of_cell.lo) & (room <= of_cell.hi)]
        assert off.min() > line.rest.lo - TOLERANCE
        assert off.max() < line.rest.hi + TOLERANCE
        assert line.rest.width < 4.0 * np.ptp(off) + 10 * UM


def test_a_cell_is_told_apart_by_what_is_known_within_it() -> None:
    """Labels that are known better within a cell, about other middles: the same motions are in its tube."""
    part, room, _ = samples(POINTS, 400)
    middle, lean = POINTS.room.mid, 0.4

    def within(own: Interval) -> Known:
        off = own - Interval.point(middle)
        return replace(POINTS, room=own), {"label": Interval.point(lean) * off + um(-2, 2)}

    label = lean * (room - middle) + np.random.default_rng(3).uniform(-2 * UM, 2 * UM, room.size)
    start = start_of(POINTS)
    plain = enclose_slide(POINTS, start, END, parts=parted(POINTS, 3))
    tube = enclose_slide(POINTS, start, END, parts=[within(own) for own in cut(POINTS, 3)])
    assert tube.status is TubeStatus.COMPLETE
    state, rng = started(part, room, label, start), np.random.default_rng(2)
    while float(state.h.min()) - STEP > END:
        state = push(state, part, STEP, rng)
        assert beyond(tube, part, room, label, state) < TOLERANCE
    ends = [cell.upper[-1] - cell.lower[-1] for cell in tube.cells]
    wider = [cell.upper[-1] - cell.lower[-1] for cell in plain.cells]
    assert all(own < other for own, other in zip(ends, wider, strict=True))


def test_a_tube_with_stops_holds_to_the_last_one_at_which_a_travel_may_end() -> None:
    """Too far: each cell ends where a tip may pass the end of its edge, by other bounds for each length."""
    start = start_of(POINTS)
    stops = [k * 50 * UM for k in range(8, -16, -1)]
    tube = enclose_slide(POINTS, start, stops[-1], parts=parted(POINTS, 2), stops=stops)
    assert set(stops) <= set(tube.h.tolist())
    for own, cell in zip(parted(POINTS, 2), tube.cells, strict=True):
        reached = cell.h[cell.checked]
        held = [stop for stop in stops if stop >= reached]
        assert 10 < len(held) < len(stops)
        alone = [
            enclose_slide(POINTS, start, h, parts=[own]) for h in (held[-2], stops[len(held) + 1])
        ]
        assert [one.status for one in alone] == [TubeStatus.COMPLETE, TubeStatus.OFF_EDGE]


@pytest.mark.parametrize("name", ["kappa", "radius_far", "drag_a", "drag_n", "shear"])
def test_a_wrong_sign_is_seen(name: str) -> None:
    """Known constants give a tube so narrow that a motion with one of them reversed leaves it."""
    sharp = known_well(um(80, 80.01))
    start = start_of(sharp, 0.1 * UM)
    tube = enclose_slide(sharp, start, END)
    assert tube.status is TubeStatus.COMPLETE
    assert followed(tube, sharp, start, 8) < TOLERANCE
    part, _, _ = samples(sharp, 8)
    wrong = replace(part, **{name: -getattr(part, name)})
    assert followed(tube, sharp, start, 8, wrong) > 0.3 * UM


def test_margins_hold_in_every_motion() -> None:
    tube = enclose_slide(REAL, start_of(REAL), END)
    part, room, label = samples(REAL, 40)
    state, rng = started(part, room, label, start_of(REAL)), np.random.default_rng(2)
    least = np.inf
    while float(state.h.min()) - STEP > END:
        found, valid = solutions(state, part)
        least = min(least, found[:, :, 5][valid].min())
        assert least > tube.force_margin * (1 - 1e-6)
        assert found[:, :, [3, 5]][valid].max() < tube.largest_force * (1 + 1e-6)
        assert (950 * UM - np.abs(state.slide(part))).min() > tube.edge_margin - TOLERANCE
        state = push(state, part, 5 * STEP, rng)
    # from forces in which terms cancel it would be an eighth
    assert tube.force_margin > 0.25 * least


def test_rates_and_forces_are_those_of_the_balance() -> None:
    """Whatever the mode: at random states far from the shipped grip."""
    part, room, label = samples(replace(REAL, kappa=about(0.0, 0.1), shear=about(0.0, 0.1)), 400)
    state = gripped(part, np.linspace(-500, 800, 400) * UM, separation(part, room), 20.0 * label)
    found, valid = solutions(state, part)
    q = state.slide(part)
    at = {"h": state.h, "V": separation(part, room), "q": q, **named(part)}

    width = {name: at[name] for name in ("q", "d_D", "d_S", "r_D", "r_S", "kappa")}
    (at["W"],) = values("opposite_edges", "width")(**width)
    beside = {name: at[name] for name in ("q", "d_S", "r_S", "kappa")}
    (at["clear"],) = values("opposite_edges", "clear")(**beside, room=room)
    assert at["clear"] == pytest.approx(at["V"] - at["W"], rel=1e-9)
    (at["T"],) = values("opposite_edges", "apart")(h=at["h"], clear=at["clear"], W=at["W"])
    at["c"], at["s"] = np.cos(state.theta), np.sin(state.theta)
    held = {
        name: at[name]
        for name in ("c", "s", "T", "q", "d_D", "d_S", "r_D", "r_S", "kappa", "drag_a", "drag_n")
    } | {name: at[name] for name in ("rho", "stretch", "shear")}
    stick = {name: held[name] for name in ("c", "s", "T", "q", "d_D", "d_S", "r_D", "r_S", "kappa")}
    u_D, u_S = values("opposite_edges", "stick_rates")(**stick, bend=0.0)
    seen = set()
    modes = [mode for mode in itertools.product((0, -1, 1), repeat=2) if mode != (0, 0)]
    for k, (of_D, of_S) in enumerate(modes):
        here = valid[k]
        if not here.any():
            continue
        seen.add((of_D, of_S))
        twist = found[k]
        # q' from the velocity of the reference point and the turn of the far edge
        along = np.stack(
            [np.cos(state.theta + part.kappa), np.sin(state.theta + part.kappa)], axis=1
        )
        out = np.stack([along[:, 1], -along[:, 0]], axis=1)
        off = np.stack([state.x, state.y], axis=1) - state.passive
        rate = np.einsum("ij,ij->i", twist[:, :2], along)
        rate -= twist[:, 2] * np.einsum("ij,ij->i", off, out)
        if of_D == 0:
            expected = u_D
        elif of_S == 0:
            expected = u_S
        else:
            tau_D, tau_S = of_D * part.mu, of_S * part.mu_far
            expected = values("opposite_edges", "corner")(
                **held, bend=0.0, tau_D=tau_D, tau_S=tau_S, total=tau_D + tau_S
            )[0]
        assert np.abs(rate - expected)[here].max() < 1e-8
    assert len(seen) >= 4


THRESHOLDS = {  # um; coefficients and radii: by bisection in a simulation of its own
    (0.33, 0.33, 0.0): 881.40, (0.33, 0.33, 2.5): 886.14, (0.33, 0.33, 12.5): 905.14,
    (0.36, 0.36, 0.0): 889.59, (0.36, 0.36, 2.5): 894.29, (0.36, 0.36, 12.5): 913.11,
}  # fmt: skip


@pytest.mark.parametrize("case", [*THRESHOLDS, (0.33, 0.36, 12.5), (0.36, 0.33, 2.5)])
def test_jam_threshold_by_bisection(case: tuple[float, float, float]) -> None:
    """Where the contacts have just not passed each other a motion ceases to exist."""
    mu_D, mu_S, radius = case
    least, most = 860.0 * UM, 930.0 * UM
    depth, r = 418.5 * UM, radius * UM
    one, zero = np.ones(1), np.zeros(1)
    part = Part(
        depth=depth * one, depth_far=depth * one, radius=r * one, radius_far=r * one, kappa=zero, drag_a=zero, drag_n=zero,
        rho=0.3769e-6 * one, stretch=zero, shear=zero, mu=mu_D * one, mu_far=mu_S * one,
    )  # fmt: skip
    for _ in range(40):
        V = 0.5 * (least + most)
        if all(_moves(part, V, past) for past in (1e-3, 0.1, 1.0, 5.0)):
            most = V
        else:
            least = V
    m = min(mu_D, mu_S)
    (margin,) = values("opposite_edges", "no_jam")(V=most, width=2 * depth, radii=2 * r, mu=m)
    assert abs(float(margin)) < 0.05 * UM
    if case in THRESHOLDS:
        assert abs(most / UM - THRESHOLDS[case]) < 0.05


def _moves(part: Part, V: float, past_um: float) -> bool:
    """Whether a motion exists while the contacts are still ``past_um`` apart along the push."""
    R, w = float(part.radius[0] + part.radius_far[0]), float(part.depth[0] + part.depth_far[0])
    h = past_um * UM
    for _ in range(50):  # h - R sin(theta) = past
        T = math.sqrt(h * h + V * V - (w + R) ** 2)
        sine = (V * T + (w + R) * h) / (h * h + V * V)
        h = past_um * UM + R * sine
    state = gripped(part, np.array([h]), np.array([V]), np.array([-150 * UM]))
    return bool(solutions(state, part)[1].any())


def test_a_pair_within_the_friction_cones_is_not_complete() -> None:
    jam = replace(POINTS, room=um(20, 20.1), mu=Interval(0.33, 0.3301))
    tube = enclose_slide(jam, start_of(jam, 0.1 * UM), END)
    assert tube.status is not TubeStatus.COMPLETE
    assert tube.status.message


@pytest.mark.parametrize(
    ("change", "status"),
    [
        ({"ends": (um(-500, -500), um(500, 500))}, TubeStatus.OFF_EDGE),
        ({"mu": Interval(0.05, 0.9)}, None),
        ({"room": um(-20, 60)}, None),
        ({"rho": Interval(0.0, 1e-5)}, None),
    ],
    ids=["short edge", "friction", "room", "film"],
)
def test_what_breaks_the_grip_is_not_complete(
    change: dict[str, Any], status: TubeStatus | None
) -> None:
    grip = replace(POINTS, **change)
    tube = enclose_slide(grip, start_of(grip), END)
    assert tube.status is not TubeStatus.COMPLETE
    assert status in (None, tube.status)


def test_a_push_that_may_end_before_the_touch_is_refused() -> None:
    with pytest.raises(ValueError, match="make it longer"):
        enclose_slide(POINTS, start_of(POINTS), 801 * UM)
