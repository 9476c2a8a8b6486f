"""The blind benchmark's own physics against what can be worked out by hand."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import numpy.typing as npt
import pytest

from reports.blind.camera import Camera, Sensor, coloured
from reports.blind.laws import Laws
from reports.blind.pushes import Plan, commanded, turned
from reports.blind.world import LENGTH, STEP, TIP_RADIUS, WIDTH, World, filmed, footprint, rho, run

Floats = npt.NDArray[np.float64]

TENSION, DEFLECTION, PRESS, GAP, SLIP = 0, slice(1, 3), 4, 5, 6
"""Columns of a contact."""
FORTH = np.array([0.0, 1.0])
GAP_UM, SPEED, LENGTH_UM = 20.0, 75.0, 300.0
TOUCH_S = 0.4 + GAP_UM / SPEED
END_S = TOUCH_S + LENGTH_UM / SPEED


def plan(place: float = 0.0, slant: float = 0.0, **changes: float) -> Plan:
    """A push against the lower edge of a part at the origin."""
    made = Plan(0, place, slant, SPEED, LENGTH_UM, GAP_UM, (0.0, 0.0, 0.0))
    return replace(made, **changes)  # type: ignore[arg-type]


def pushed(
    laws: Laws, what: Plan | None = None, times: Floats | None = None, step: float = STEP
) -> tuple[Floats, Floats]:
    """Poses and contacts of a push, at the frames or at given times."""
    push = commanded(what or plan(), np.zeros(3))
    return run(World(laws), push, push.frames if times is None else times, step)


def steady(laws: Laws, what: Plan | None = None) -> tuple[Floats, Floats]:
    """Pose and contact in the middle of the push."""
    poses, contacts = pushed(laws, what, np.array([0.5 * (TOUCH_S + END_S)]))
    return poses[0], contacts[0]


@pytest.mark.parametrize("side", [0.85, 1.0, 1.23])
def test_quadrature_has_the_closed_form_of_a_rectangle(side: float) -> None:
    square = (LENGTH**2 + WIDTH**2) / 12.0 * side**2
    for laws in (Laws(footprint=side), Laws(footprint=side, dry=1.0)):
        assert rho(laws) == pytest.approx(square, rel=1e-12)


def test_uneven_pressure_has_its_centre_where_stated() -> None:
    nodes = footprint(Laws(uneven=1.0, uneven_x=80.0, uneven_y=-30.0, footprint=0.9))
    assert np.all(nodes[:, 2] > 0.0)
    weights = nodes[:, 2] / len(nodes)
    assert np.sum(weights) == pytest.approx(1.0)
    assert weights @ nodes[:, :2] == pytest.approx([80.0, -30.0])


def test_a_push_through_the_centre_translates() -> None:
    pose, contact = steady(Laws())
    assert pose[2] == pytest.approx(0.0, abs=1e-9)
    assert pose[:2] == pytest.approx([0.0, 0.5 * LENGTH_UM], abs=0.02)
    assert contact[PRESS] == pytest.approx(SPEED, rel=1e-6)


def test_a_frictionless_push_turns_by_the_lever() -> None:
    lever = 0.5 * 0.5 * LENGTH
    times = TOUCH_S + np.array([0.008, 0.012])
    poses, _ = pushed(Laws(mu=0.0), plan(place=0.5), times)
    rate = (poses[1, 2] - poses[0, 2]) / 0.004
    assert rate == pytest.approx(lever * SPEED / (rho(Laws()) + lever**2), rel=1e-3)


def test_a_sticking_push_carries_the_point_of_contact_along() -> None:
    what = plan(place=0.4, slant=0.2)
    poses, contacts = pushed(Laws(mu=5.0), what, np.array([TOUCH_S + 0.05, END_S - 0.05]))
    assert np.all(np.abs(contacts[:, TENSION]) < 4.0 * contacts[:, PRESS])
    push = commanded(what, np.zeros(3))
    way = turned(FORTH, 0.2) * SPEED * (END_S - TOUCH_S - 0.1)
    tip = push.way[0] + turned(FORTH, 0.2) * (GAP_UM + SPEED * 0.05)
    # The tip rolls on the edge, by its radius times the turn: the centre of the tip, seen from the
    # part, moves along the edge by that.
    start, end = (turned(t - p[:2], -p[2]) for t, p in zip((tip, tip + way), poses, strict=True))
    rolled = -TIP_RADIUS * (poses[1, 2] - poses[0, 2])
    assert abs(rolled) > 1.0
    assert end - start == pytest.approx([rolled, 0.0], abs=0.05)


def test_overlap_stays_small_and_friction_inside_its_cone() -> None:
    laws = Laws(mu=0.2)
    poses, contacts = pushed(laws, plan(place=-0.7, slant=0.35))
    assert np.min(contacts[:, GAP]) > -0.03
    limit = laws.mu * contacts[:, PRESS]
    assert np.all(np.abs(contacts[:, TENSION]) <= limit + 1e-9)
    slides = (contacts[:, PRESS] > 1.0) & (np.abs(contacts[:, SLIP]) > 1.0)
    assert np.sum(slides) > 50
    assert np.abs(contacts[slides, TENSION]) == pytest.approx(limit[slides], rel=1e-6)
    assert np.all(contacts[slides, TENSION] * contacts[slides, SLIP] < 0.0)
    assert np.max(np.abs(poses[:, 2])) > 0.05


def test_a_part_that_is_left_alone_stays_and_drifts_at_the_speed_of_the_load() -> None:
    before = np.array([0.35])
    assert np.all(pushed(Laws(), None, before)[0] == 0.0)
    drift = Laws(force_x=3.0, force_y=-2.0)
    pose = pushed(drift, None, before)[0][0]
    assert pose == pytest.approx([3.0 * 0.35, -2.0 * 0.35, 0.0], abs=3e-3)
    spun = pushed(Laws(moment=0.01 * rho(Laws())), None, before)[0][0]
    assert spun == pytest.approx([0.0, 0.0, 0.0035], abs=1e-5)


def test_tilt_and_flow_are_one() -> None:
    what = plan(place=0.3, slant=0.1)
    tilted, _ = pushed(Laws(force_x=2.0, force_y=1.0), what)
    carried, _ = pushed(Laws(flow_x=2.0, flow_y=1.0), what)
    assert tilted == pytest.approx(carried, abs=1e-6)


def test_growing_drag_leaves_no_trace() -> None:
    what = plan(place=0.3, slant=0.1)
    plain, grown = (pushed(Laws(growth=g), what)[0] for g in (0.0, 0.1))
    assert np.max(np.abs(plain - grown)) < 0.03


@pytest.mark.parametrize(
    ("laws", "press"),
    [
        (Laws(dry=30.0), 105.0),
        (Laws(stribeck=30.0, stribeck_speed=75.0), 75.0 + 30.0 / np.e),
        (Laws(thinning=0.3), 75.0),
        (Laws(quadratic=0.4), 105.0),
        (Laws(anisotropy=0.2, anisotropy_angle=0.5 * np.pi), 90.0),
        (Laws(part_anisotropy=0.2), 60.0),
        (Laws(adhesion=10.0), 85.0),
        (Laws(attraction=10.0), 85.0),
        (Laws(force_y=10.0), 65.0),
        (Laws(uneven=30.0), 105.0),
        (Laws(ageing=30.0, ageing_distance=10.0), 75.0 + 30.0 * np.log1p(10.0 / 75.0)),
        (Laws(growth=0.1), 75.0 * np.exp(0.1 * 0.5 * (TOUCH_S + END_S))),
        (Laws(patch=30.0, patch_radius=5e3), 105.0),
        (Laws(gradient_y=1e-4, uneven_x=0.0), None),
    ],
)
def test_the_tip_feels_the_law(laws: Laws, press: float | None) -> None:
    """Force that a push through the centre needs, in the units of the drag at 75 um/s."""
    pose, contact = steady(laws)
    if press is None:  # the mean of exp(g y) over the footprint, about where the part is
        half = 0.5e-4 * WIDTH
        press = SPEED * np.exp(1e-4 * pose[1]) * np.sinh(half) / half
    assert contact[PRESS] == pytest.approx(press, rel=2e-3)


def test_an_offset_centre_of_drag_turns_a_centred_push() -> None:
    centre = 40.0
    laws = Laws(mu=0.0, centre_x=centre)
    poses, _ = pushed(laws, None, TOUCH_S + np.array([0.008, 0.012]))
    rate = (poses[1, 2] - poses[0, 2]) / 0.004
    assert rate == pytest.approx(-SPEED * centre / (rho(Laws()) + centre**2), rel=2e-3)


def test_a_compliant_tip_lags_by_its_compliance_times_the_force() -> None:
    stiff, soft = (steady(Laws(compliance=c))[0] for c in (0.0, 0.02))
    assert stiff[1] - soft[1] == pytest.approx(0.02 * SPEED, abs=0.01)


def test_lost_motion_is_lost_once_each_way() -> None:
    width = 6.0
    plain, loose = (pushed(Laws(backlash=b))[0] for b in (0.0, width))
    assert plain[-1, 1] - loose[-1, 1] == pytest.approx(0.5 * width, abs=0.02)


def test_an_adhering_part_follows_when_it_can() -> None:
    """A meniscus stronger than the drag at the tip's speed takes the part all the way back."""
    left, taken = (pushed(Laws(adhesion=a, adhesion_range=3.0))[0][-1, 1] for a in (30.0, 120.0))
    assert left == pytest.approx(LENGTH_UM, abs=3.1)
    assert taken == pytest.approx(LENGTH_UM - 60.0, abs=0.1)


def test_a_post_stops_the_part() -> None:
    radius, reach = 50.0, 100.0
    laws = Laws(
        post_radius=radius, post_x=0.0, post_y=0.5 * WIDTH + radius + reach, compliance=0.02
    )
    before, _ = pushed(laws, None, np.array([TOUCH_S + 0.9 * reach / SPEED]))
    assert before[0, 1] == pytest.approx(0.9 * reach - 0.02 * SPEED, abs=0.05)
    after, _ = pushed(laws, None, np.array([END_S]))
    assert after[0, 1] == pytest.approx(reach, abs=1.0)


def test_memory_gives_back_what_it_stored() -> None:
    """A Maxwell film at rest for long has crept back: steady drag is as without memory."""
    _, plain = steady(Laws())
    _, remembering = steady(Laws(memory=0.5, memory_time=0.2))
    assert remembering[PRESS] == pytest.approx(plain[PRESS], rel=1e-3)


@pytest.mark.parametrize(
    "laws",
    [Laws(), Laws(stribeck=75.0, stribeck_speed=15.0), Laws(adhesion=60.0), Laws(memory=0.5)],
)
def test_half_the_step_changes_nothing_to_speak_of(laws: Laws) -> None:
    what = plan(place=0.6, slant=0.3)
    one, other = (pushed(laws, what, step=step)[0] for step in (STEP, 0.5 * STEP))
    assert np.max(np.abs(one - other)[:, :2]) < 0.05
    assert np.max(np.abs(one - other)[:, 2]) < 5e-5


def test_latency_shows_the_past() -> None:
    push = commanded(plan(), np.zeros(3))
    seen = filmed(World(camera=Camera(latency=0.1)), push)
    assert seen == pytest.approx(run(World(), push, push.frames - 0.1)[0])
    lag = filmed(World(), push) - seen
    moving = (push.frames > TOUCH_S + 0.2) & (push.frames < END_S)
    assert lag[moving, 1] == pytest.approx(0.1 * SPEED, abs=0.02)


def test_a_camera_maps_places_and_headings() -> None:
    poses, frames = np.array([[300.0, -400.0, 0.3]]), np.array([2.0])
    for camera, seen in (
        (Camera(), [300.0, -400.0, 0.3]),
        (Camera(scale=(0.01, 0.01)), [303.0, -404.0, 0.3]),
        (Camera(rotation=0.5 * np.pi), [400.0, 300.0, 0.3 + 0.5 * np.pi]),
        (Camera(drift=(1.0, -2.0)), [302.0, -404.0, 0.3]),
        (Camera(offset=(10.0, 0.0)), [300.0 + 10 * np.cos(0.3), -400.0 + 10 * np.sin(0.3), 0.3]),
    ):
        assert camera.see(poses, frames)[0] == pytest.approx(seen, abs=1e-6)
    far = Camera(radial=1e-9).see(poses, frames)[0]
    assert far[:2] == pytest.approx(poses[0, :2] * (1.0 + 1e-9 * 500.0**2), abs=1e-9)


def test_noise_is_what_the_sensor_says() -> None:
    sensor = Sensor(1.3, 0.08, 0.4, 0.0, 0.0, True)
    noise = coloured(np.random.default_rng(0), 40_000, sensor)
    assert np.std(noise, axis=0) == pytest.approx(sensor.sigmas, rel=0.03)
    for column in noise.T:
        assert np.mean(column[1:] * column[:-1]) / np.mean(column**2) == pytest.approx(
            0.4, abs=0.02
        )
    assert np.asarray(np.corrcoef(noise.T))[0, 1] == pytest.approx(0.0, abs=0.03)
