"""The virtual laboratory that a task asks for: a camera that sees all of its way, and probes for its moves."""

from __future__ import annotations

import math
import re
from dataclasses import replace
from pathlib import Path

import numpy as np

from meso_robust.laboratory.draws import Draws, draw, some
from meso_robust.laboratory.making import true_outlines
from meso_robust.live.lab_file import (
    CameraSection,
    Lab,
    ManipulatorSection,
    TipSection,
    VirtualSection,
    WatchSection,
)
from meso_robust.live.virtual import Truth, VirtualLaboratory, faults_of
from meso_robust.planning.document import NAMES
from meso_robust.plant.world import World, world_of
from meso_robust.primitives.setup import Setup, setup_of
from meso_robust.recordings.rules import DEG, UM
from meso_robust.task import Task
from meso_robust.types import Floats

PIXEL = 5.26  # um, of the paper's camera
AROUND = 400.0  # um that are seen about the part's way
REACH = 6000.0  # um that manipulators can go from the middle of what is seen
LIFTED = 300.0  # um
MOVES = 64  # for which errors are drawn
KEPT = 0.9
"""Of the probe's stated error that is drawn: the rest is the loop's, which takes a place for reached a
little before it is."""
REPEATS = 0.2
"""um within which a virtual manipulator that is to be calibrated comes back to a place, as good ones do."""
UNPACED = 60_000.0
"""ms from a frame to its commands: unless it is paced, the laboratory's time stands still meanwhile."""
LAID = 0.6
"""Of the start's box in which the part is laid: a plan's certified starts are those of poses as they are
sensed, and the camera errs too."""
AWAY = (1e5, 1e5, 0.0)
"""Of the part while manipulators are calibrated: not on the slide."""
_TURNS = {"-x": 0.0, "+x": 180.0, "-y": 90.0, "+y": 270.0}
"""deg by which a heading's probe is turned from that of -x."""


def heading_of(plan: Path | None) -> str:
    """The direction in which a plan's dual-tip probe pushes first.

    Parameters
    ----------
    plan
        ``plan.json`` or ``policy.json``; None: -x.

    Returns
    -------
    str
        Such as ``-x``.
    """
    if plan is None:
        return "-x"
    found = re.search(r'"heading":\s*"([+-][xy])"', plan.read_text(encoding="utf-8"))
    return found[1] if found else "-x"


def lab_of(task: Task, heading: str = "-x", virtual: VirtualSection | None = None) -> Lab:
    """A virtual laboratory for a task, as its users know it.

    Parameters
    ----------
    task
        The task.
    heading
        In which its dual-tip probe pushes.
    virtual
        What it does besides; None: nothing.

    Returns
    -------
    Lab
        With the task's tips in place of the middles of their ranges.
    """
    radius = task.probe.tip_radius_um or (0.0, 0.0)
    passive = task.probe.passive_tip_radius_um or radius
    half, turn = 0.5 * task.probe.tip_spacing_um, _TURNS[heading]
    c, s = math.cos(turn * DEG), math.sin(turn * DEG)
    pair = tuple(
        TipSection(
            name=name,
            offset_um=(-s * side * half, c * side * half),
            direction_deg=turn + side * 25.0,
            radius_um=0.5 * sum(radius),
        )
        for name, side in zip(NAMES[:2], (1.0, -1.0), strict=True)
    )
    single = TipSection(
        name=NAMES[2],
        offset_um=(0.0, 0.0),
        direction_deg=turn + 180.0,
        radius_um=0.5 * sum(passive),
    )
    speed = task.probe.speed_um_s
    camera = _camera(task)
    middle = np.array(camera.centre_um)
    low, high = middle - REACH, middle + REACH

    def manipulator(name: str, tips: tuple[TipSection, ...]) -> ManipulatorSection:
        return ManipulatorSection(
            name=name,
            tips=tips,
            low_um=(float(low[0]), float(low[1])),
            high_um=(float(high[0]), float(high[1])),
            lifted_um=LIFTED,
            max_speed_um_s=max(10.0 * speed, 1000.0),
            place_speed_um_s=max(10.0 * speed, 1000.0),
            arrival_um=max((1.0 - KEPT) * task.uncertainty.probe_position_um, 0.01),
            tip_error_um=KEPT * task.uncertainty.probe_position_um,
        )

    return Lab(
        backend="virtual",
        camera=camera,
        watch=WatchSection(
            max_latency_ms=UNPACED if virtual is None or not virtual.paced else 1000.0
        ),
        manipulators=(manipulator("dual", pair), manipulator("single", (single,))),
        virtual=virtual or VirtualSection(),
    )


def _camera(task: Task) -> CameraSection:
    setup = setup_of(task)
    corners = np.array([[x.mid, y.mid] for x, y in setup.outline.corners]) / UM
    reach = float(np.hypot(*corners.T).max()) + AROUND
    ends = np.array([setup.start.mid[:2], setup.goal.mid[:2]]) / UM
    low, high = ends.min(axis=0) - reach, ends.max(axis=0) + reach
    # sizes that a sensor has
    width, height = (math.ceil(side / PIXEL / 16.0) * 16 for side in high - low)
    middle = 0.5 * (low + high)
    return CameraSection(
        width_px=width,
        height_px=height,
        pixel_size_um=PIXEL,
        centre_um=(float(middle[0]), float(middle[1])),
    )


def uncalibrated_lab(task: Task, seed: int) -> Lab:
    """A virtual laboratory whose file is a little wrong about its manipulators, as one by hand is.

    Parameters
    ----------
    task, seed
        The task, and what is drawn.

    Returns
    -------
    Lab
        `hidden` makes what is true of it.
    """
    lab = lab_of(task, "-x", VirtualSection(seed=seed, part=AWAY))
    return lab.model_copy(update={"virtual": lab.virtual.model_copy(update={"hidden": True})})


def hidden(of: ManipulatorSection, rng: np.random.Generator) -> ManipulatorSection:
    """A manipulator as it is where its file is a little wrong.

    Parameters
    ----------
    of
        As its file states it.
    rng
        Of what is drawn.

    Returns
    -------
    ManipulatorSection
        Turned by up to 0.3 deg, longer or shorter by up to 0.3 %, its axes not quite square, its tips up
        to 10 um elsewhere.
    """
    turn, skew = rng.uniform(-0.3, 0.3) * DEG, rng.uniform(-0.1, 0.1) * DEG
    scale = 1.0 + rng.uniform(-0.003, 0.003, 2)
    c, s = math.cos(turn), math.sin(turn)
    true = np.array([[c, -s], [s, c]]) @ np.array([[1.0, skew], [0.0, 1.0]]) @ np.diag(scale)
    axes = true @ np.array(of.axes)
    shift = rng.uniform(-10.0, 10.0, 2)
    middle = 0.5 * (np.array(of.low_um) + np.array(of.high_um))
    # the tips are where they are expected at the middle of the image, but for the shift
    shift = shift - (axes - np.array(of.axes)) @ middle
    tips = tuple(
        tip.model_copy(
            update={
                "offset_um": (
                    tip.offset_um[0] + float(shift[0]),
                    tip.offset_um[1] + float(shift[1]),
                )
            }
        )
        for tip in of.tips
    )
    rows = ((float(axes[0, 0]), float(axes[0, 1])), (float(axes[1, 0]), float(axes[1, 1])))
    return of.model_copy(update={"axes": rows, "tips": tips})


def laboratory_of(task: Task, lab: Lab, corner: bool = False) -> VirtualLaboratory:
    """A virtual laboratory, everything uncertain in it drawn from what the task allows.

    Parameters
    ----------
    task, lab
        The task, and the laboratory as its users know it.
    corner
        Whether to draw at corners of the box of everything uncertain, where a promise fails first.

    Returns
    -------
    VirtualLaboratory
        With the part on its film.
    """
    setup = setup_of(task)
    rng = np.random.default_rng([lab.virtual.seed, 0])
    two = draw(setup, MOVES, 2, rng)
    draws: Draws = some(two, np.array([1 if corner else 0]))
    part, stated = lab.virtual.part, task.uncertainty.probe_position_um
    middle = np.array(setup.start.mid)
    laid = (middle + LAID * (draws.start[0] - middle)) / np.array([UM, UM, 1.0])
    pose = laid if part is None else np.array([part[0], part[1], part[2] * DEG])

    def true(one: ManipulatorSection) -> ManipulatorSection:
        return hidden(one, rng) if lab.virtual.hidden else one

    friction = draws.tip_friction[0, 0, 0] if draws.tip_friction is not None else None
    mu = {
        tip.name: float(draws.friction[0] if friction is None else friction[_index(tip.name)])
        for one in lab.manipulators
        for tip in one.tips
    }
    truth = Truth(
        outline=true_outlines(setup, draws)[0] / UM,
        pose=pose,
        film_ratio=float(draws.film_ratio[0]) / UM**2,
        friction=mu,
        manipulators={one.name: true(_true(one, draws)) for one in lab.manipulators},
        placing={
            one.name: (REPEATS / stated if lab.virtual.hidden else KEPT) * _placing(one, draws)
            for one in lab.manipulators
        },
        turning={one.name: _turning(draws) for one in lab.manipulators},
        world=_world(draws, setup, world_of(lab.virtual.effects)),
        faults=faults_of(lab.virtual.faults),
    )
    return VirtualLaboratory(lab, truth)


def _index(name: str) -> int:
    return NAMES.index(name) if name in NAMES else 0


def _placing(of: ManipulatorSection, draws: Draws) -> Floats:
    passive = all(tip.name == NAMES[2] for tip in of.tips)
    return (draws.single if passive else draws.dual)[0] / UM


def _turning(draws: Draws) -> Floats:
    count = draws.dual.shape[1]
    angle = np.zeros(count) if draws.direction is None else draws.direction[0]
    longer = np.zeros(count) if draws.scale is None else draws.scale[0]
    return np.column_stack([angle, longer])


def _true(of: ManipulatorSection, draws: Draws) -> ManipulatorSection:
    """The manipulator with its tips as drawn: their radii, spacing and misalignment."""
    places = np.array([tip.offset_um for tip in of.tips])
    middle = places.mean(axis=0)
    beta = float(draws.misalignment[0])
    stretch = 0.0
    if len(places) == 2 and draws.spacing is not None:
        stretch = float(draws.spacing[0]) / UM / float(np.hypot(*(places[0] - places[1])))
    c, s = math.cos(beta), math.sin(beta)
    turned = (places - middle) @ np.array([[c, s], [-s, c]]) * (1.0 + stretch) + middle
    tips = tuple(
        tip.model_copy(
            update={
                "offset_um": (float(place[0]), float(place[1])),
                "radius_um": _radius(tip, draws),
            }
        )
        for tip, place in zip(of.tips, turned, strict=True)
    )
    return of.model_copy(update={"tips": tips})


def _radius(tip: TipSection, draws: Draws) -> float:
    return tip.radius_um if draws.radii is None else float(draws.radii[0, _index(tip.name)]) / UM


def _world(draws: Draws, setup: Setup, world: World) -> World:
    """The world with the unevenness of the film that the task allows."""
    centre, lay = np.array(world.centre), np.array(world.lay)
    if draws.drag_centre is not None:
        centre = centre + _cut(draws.drag_centre[0], setup.uncertainty.drag_centre.hi) / UM
    if draws.lay is not None:
        share = draws.lay[0, 2]
        whole = _cut(draws.lay[0, :2], setup.uncertainty.drag_anisotropy.hi)
        lay = lay + np.concatenate([(1.0 - share) * whole, share * whole])
    return replace(
        world,
        centre=(float(centre[0]), float(centre[1])),
        lay=(float(lay[0]), float(lay[1]), float(lay[2]), float(lay[3])),
    )


def _cut(vector: Floats, longest: float) -> Floats:
    """The vector (2,), cut to a length."""
    return vector * min(1.0, longest / max(float(np.hypot(*vector)), 1e-300))
