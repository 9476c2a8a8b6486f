"""The virtual laboratory: devices like any other, behind them the plant and the synthetic microscope.

It knows the task only to lay down a part that the task allows: its plant shares no formula with the
simulator that planned, its camera renders images that the tracker must read.
"""

from __future__ import annotations

import bisect
import math
import threading
import time
from collections import deque
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from functools import lru_cache

import numpy as np

from meso_robust.errors import InputError
from meso_robust.live.devices import Devices, Frame, Status
from meso_robust.live.lab_file import CameraSection, Lab, ManipulatorSection
from meso_robust.live.placing import tip_places
from meso_robust.microscope import Optics, Probe, Scene, reflected, render
from meso_robust.plant.kernel import COARSE, Grain
from meso_robust.plant.part import LyingPart, outline_of
from meso_robust.plant.world import World
from meso_robust.types import Floats, Image

UM = 1e-6
READOUT = 0.012
"""s from the exposure of a frame until it is delivered."""
CHUNK = 1.0 / 60.0  # s in which tips are taken to go straight
LIFT_SPEED = 1000.0  # um/s
IN_PLANE = 20.0  # um of height below which a tip touches what is there
LEAST_DRAWN = 2.0  # um; radius of a tip that is taken as a point, as it is drawn
DRAWN_STEP = 0.5
"""um to which a tip's radius is drawn, a tenth of a usual pixel: drawings are kept from run to run."""
_PLAIN = World()
Seen = tuple[Floats, Mapping[str, Floats]]
HISTORY = 600  # instants that a late camera can look back


@dataclass(frozen=True, slots=True, kw_only=True)
class Faults:
    """What goes wrong, and when; s of the laboratory's clock, um. Infinite: never."""

    lost_from_s: float = math.inf
    lost_until_s: float = math.inf
    """Between both no frame is delivered."""
    frozen_from_s: float = math.inf
    """From then on the camera delivers one image again and again."""
    short_um: float = 0.0
    """By which a manipulator stops short of every target of a push."""
    absent: float = 0.0
    """1: no part is there."""
    lift_fails_from_s: float = math.inf
    kicked_at_s: float = math.inf
    """The part is moved by 40 um then."""
    stage_moves_at_s: float = math.inf
    stalls_from_s: float = math.inf
    """From then on manipulators say that they move, and do not."""


def faults_of(values: Mapping[str, float]) -> Faults:
    """Faults by name.

    Parameters
    ----------
    values
        As a laboratory's file states them.

    Returns
    -------
    Faults
        The others never happen.

    Raises
    ------
    InputError
        A name is unknown.
    """
    names = [one.name for one in fields(Faults)]
    for name in values:
        if name not in names:
            raise InputError(f"virtual.faults.{name}: must be one of {', '.join(names)}")
    return Faults(**values)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Truth:
    """What is true in one run of the laboratory, and what nobody in it is told; um, rad."""

    outline: Floats
    """(V, 2) stated corners."""
    pose: Floats
    """(3,) of the part at the start."""
    film_ratio: float
    """um²"""
    friction: Mapping[str, float]
    """Of each tip."""
    manipulators: Mapping[str, ManipulatorSection]
    """As they truly are."""
    placing: Mapping[str, Floats] = field(default_factory=dict)
    """(K, 2) error of each lowering of a manipulator, by name; the last is repeated."""
    turning: Mapping[str, Floats] = field(default_factory=dict)
    """(K, 2) angle and relative length by which a push of a manipulator differs from what is commanded."""
    world: World = _PLAIN
    faults: Faults = Faults()
    grain: Grain = COARSE


class VirtualManipulator:
    """Two axes and a lift; see `meso_robust.live.devices.Manipulator`."""

    def __init__(self, laboratory: VirtualLaboratory, true: ManipulatorSection) -> None:
        self._laboratory, self._true = laboratory, true
        low, high = np.array(true.low_um), np.array(true.high_um)
        self._from = self._to = 0.5 * (low + high)
        self._began, self._speed = 0.0, 1.0
        self._height_from = self._height_to = true.lifted_um
        self._lift_began = 0.0
        self._lowered: Floats | None = None
        self._lowerings = 0
        self._lost = self._from.copy()

    def status(self) -> Status:
        """Where it says that it is."""
        with self._laboratory.lock:
            now = self._laboratory.catch_up()
            x, y = self._at(now) * UM
            height = self._height(now)
            moving = self._share(now) < 1.0 or height != self._height_to
        return Status(x=float(x), y=float(y), height=height * UM, busy=moving)

    def go(self, x: float, y: float, speed: float) -> None:
        """Begin a straight motion."""
        with self._laboratory.lock:
            now = self._laboratory.catch_up()
            start, end = self._at(now), np.array([x, y]) / UM
            short, length = self._laboratory.truth.faults.short_um, float(np.hypot(*(end - start)))
            if short > 0.0 and self._lowered is not None and length > short:
                end = start + (1.0 - short / length) * (end - start)
            self._from, self._to, self._began, self._speed = start, end, now, speed / UM

    def lift(self, height: float) -> None:
        """Begin to lift or lower."""
        with self._laboratory.lock:
            now = self._laboratory.catch_up()
            if now < self._laboratory.truth.faults.lift_fails_from_s:
                self._height_from, self._lift_began = self._height(now), now
                self._height_to = height / UM

    def stop(self) -> None:
        """Stop."""
        with self._laboratory.lock:
            now = self._laboratory.catch_up()
            self._from = self._to = self._at(now)
            self._height_from = self._height_to = self._height(now)

    def _share(self, now: float) -> float:
        length = float(np.hypot(*(self._to - self._from)))
        if length == 0.0:
            return 1.0
        if now >= self._laboratory.truth.faults.stalls_from_s:
            now = min(now, max(self._began, self._laboratory.truth.faults.stalls_from_s))
        return min(max(now - self._began, 0.0) * self._speed / length, 1.0)

    def _at(self, now: float) -> Floats:
        """(2,) own axes, um; exactly the target once there."""
        share = self._share(now)
        return self._to.copy() if share == 1.0 else self._from + share * (self._to - self._from)

    def _height(self, now: float) -> float:
        way = self._height_to - self._height_from
        gone = LIFT_SPEED * max(now - self._lift_began, 0.0)
        return self._height_to if gone >= abs(way) else self._height_from + math.copysign(gone, way)

    def tips(self, now: float) -> dict[str, Floats]:
        """Where its tips truly are, um, world; none that are above the plane."""
        own = self._at(now)
        half = 0.5 * self._laboratory.truth.world.backlash
        self._lost = np.clip(self._lost, own - half, own + half)
        if self._height(now) - self._true.lowered_um > IN_PLANE:
            self._lowered = None
            return {}
        if self._lowered is None:
            self._lowered, self._lowerings = own.copy(), self._lowerings + 1
        truth, name = self._laboratory.truth, self._true.name
        turn, longer = _nth(truth.turning.get(name), self._lowerings)
        c, s = (1.0 + longer) * math.cos(turn), (1.0 + longer) * math.sin(turn)
        moved = np.array(self._true.axes) @ (self._lost - self._lowered)
        shift = np.array([c * moved[0] - s * moved[1], s * moved[0] + c * moved[1]]) - moved
        shift = shift + _nth(truth.placing.get(name), self._lowerings)
        shift = shift + now * np.array(truth.world.drift)
        places = tip_places(self._true, (float(self._lost[0]), float(self._lost[1])))
        return {tip: place + shift for tip, place in places.items()}


def _nth(values: Floats | None, count: int) -> Floats:
    if values is None or not len(values):
        return np.zeros(2)
    return values[min(max(count - 1, 0), len(values) - 1)]


class VirtualLaboratory:
    """A part under a camera among manipulators, and the time in which all of it moves.

    Parameters
    ----------
    lab
        As its users know it.
    truth
        As it is.
    """

    def __init__(self, lab: Lab, truth: Truth) -> None:
        self.truth, self._lab = truth, lab
        self.lock = threading.RLock()  # a core asks for frames in a thread of its own
        self._part = LyingPart(
            truth.outline, truth.film_ratio, truth.world, truth.pose, truth.grain
        )
        self.manipulators = {
            name: VirtualManipulator(self, true) for name, true in truth.manipulators.items()
        }
        self._radii = {
            tip.name: tip.radius_um + truth.world.tip_excess
            for one in truth.manipulators.values()
            for tip in one.tips
        }
        self._time, self._number = 0.0, 0
        self._began = time.monotonic()
        self._tips: dict[str, Floats] = {}
        self._past: deque[tuple[float, Floats, dict[str, Floats]]] = deque(maxlen=HISTORY)
        self._noise = np.random.default_rng([lab.virtual.seed, 1])
        self._scene, self._names = _scene(lab, truth)
        self._frozen: Image | None = None
        self._kicked = False
        self.landed = False
        """Whether a tip ever came down on the part: then the plant says nothing."""
        self.path: list[tuple[float, Floats]] = [(0.0, self._part.pose)]
        """Instants, s, and (3,) true poses then, um and rad."""

    @property
    def pose(self) -> Floats:
        """(3,) of the part now, um and rad."""
        return self._part.pose

    def pose_at(self, instant: float) -> Floats:
        """(3,) of the part at an instant that has passed, or just before it; um and rad."""
        after = bisect.bisect_right(self.path, instant, key=lambda known: known[0])
        return self.path[max(after - 1, 0)][1]

    @property
    def stuck(self) -> bool:
        """Whether the part could not give way to a tip."""
        return self._part.stuck

    def devices(self) -> Devices:
        """What the loop is given."""
        return Devices(camera=self, manipulators=self.manipulators, stage=self, clock=self)

    def now(self) -> float:
        """S of the laboratory's clock."""
        return self.catch_up()

    def place(self) -> tuple[float, float]:
        """Of the stage, m."""
        moved = self.catch_up() >= self.truth.faults.stage_moves_at_s
        return (25e-6 if moved else 0.0, 0.0)

    def stop(self) -> None:
        """Stop the stage."""

    def catch_up(self) -> float:
        """Let the part follow up to now."""
        if self._lab.virtual.paced:
            self._advance(time.monotonic() - self._began)
        return self._time

    def wait(self, duration: float) -> None:
        """Let a time pass."""
        if self._lab.virtual.paced:
            time.sleep(max(duration, 0.0))
            self.catch_up()
        else:
            self._advance(self._time + duration)

    def _advance(self, until: float) -> None:
        with self.lock:
            self._advanced(until)

    def _advanced(self, until: float) -> None:
        while self._time < until:
            step = min(CHUNK, until - self._time)
            if step < 1e-9:  # what rounding leaves
                self._time = until
                break
            now = self._time + step
            tips = {
                name: place
                for one in self.manipulators.values()
                for name, place in one.tips(now).items()
            }
            before = {name: self._tips.get(name, place) for name, place in tips.items()}
            new = {name: place for name, place in tips.items() if name not in self._tips}
            self.landed = self.landed or self._lands(new)
            mu = self.truth.friction
            self._part.pushed(
                {
                    name: (before[name], place, self._radii[name], mu[name])
                    for name, place in tips.items()
                },
                step,
            )
            if now >= self.truth.faults.kicked_at_s and not self._kicked:
                self._kicked = True
                self._part.move_by(np.array([40.0, 0.0, 0.0]))
            self._tips, self._time = tips, now
            self._past.append((now, self._part.pose, tips))
            self.path.append((now, self._part.pose))

    def _lands(self, tips: Mapping[str, Floats]) -> bool:
        return any(
            self._part.gap(place) < self._radii[name] - self.truth.grain.deepest
            for name, place in tips.items()
        )

    def frame(self, patience: float) -> Frame | None:
        """The next frame that is delivered; None if there is none in time."""
        rate, faults = self._lab.virtual.frame_rate_hz, self.truth.faults
        now = self.catch_up()
        self._number = max(self._number + 1, math.floor((now - READOUT) * rate))
        exposed = self._number / rate
        late = exposed + READOUT - now
        if late > patience:
            self._number -= 1
            self.wait(patience)
            return None
        self.wait(max(exposed - now, 0.0))
        image = self._image(exposed)
        self.wait(max(exposed + READOUT - self._time, 0.0))
        if faults.lost_from_s <= exposed < faults.lost_until_s:
            return None
        if exposed >= faults.frozen_from_s:
            self._frozen = image if self._frozen is None else self._frozen
            image = self._frozen
        return Frame(number=self._number, time=exposed, image=image)

    def _image(self, exposed: float) -> Image:
        world, at = self.truth.world, exposed - self.truth.world.latency
        pose, tips = then(self._past, at) if self._past else (self._part.pose, {})
        c, s = math.cos(pose[2]), math.sin(pose[2])
        ox, oy = world.offset
        drift = exposed * np.array(world.seen_drift)
        shown = pose.copy()
        shown[:2] += np.array([c * ox - s * oy, s * ox + c * oy]) + drift
        if self.truth.faults.absent:
            shown[:] = math.nan
        places = np.full((len(self._names), 2), math.nan)
        for k, name in enumerate(self._names):
            if name in tips:
                places[k] = (tips[name] + drift) * UM
        seen = shown * np.array([UM, UM, 1.0])
        return render(self._scene, seen, places, self._noise, exposed)


def then(past: Sequence[tuple[float, Floats, Mapping[str, Floats]]], at: float) -> Seen:
    """Pose of the part and places of the tips in the plane at an instant, even between two that are known.

    Parameters
    ----------
    past
        Instants in s, poses (3,) and places (2,) by name, in their order; one or more.
    at
        s; before the first: the first pose, and no tip.
    """
    after = bisect.bisect_right(past, at, key=lambda known: known[0])
    if after == 0:
        return past[0][1], {}
    begun, pose, tips = past[after - 1]
    if after == len(past):
        return pose, tips
    ended, later, others = past[after]
    share = (at - begun) / (ended - begun)
    moved = {name: tip + share * (others.get(name, tip) - tip) for name, tip in tips.items()}
    return pose + share * (later - pose), moved


def _scene(lab: Lab, truth: Truth) -> tuple[Scene, tuple[str, ...]]:
    """What is drawn, and the names of the tips in the order of its probes."""
    tips = [tip for one in truth.manipulators.values() for tip in one.tips]
    outline = outline_of(truth.outline, truth.world)
    corners = tuple((float(x), float(y)) for x, y in outline)
    probes = tuple((tip.radius_um + truth.world.tip_excess, tip.direction_deg) for tip in tips)
    camera = _seen_through(lab.camera, truth.world)
    return _drawn(corners, probes, camera), tuple(tip.name for tip in tips)


@lru_cache(maxsize=3)
def _drawn(
    corners: tuple[tuple[float, float], ...],
    probes: tuple[tuple[float, float], ...],
    camera: CameraSection,
) -> Scene:
    """A scene, which is made once for all runs that look alike."""
    optics = Optics(
        pixel_size=camera.pixel_size_um * UM,
        width=camera.width_px,
        height=camera.height_px,
        centre=(camera.centre_um[0] * UM, camera.centre_um[1] * UM),
        rotation=math.radians(camera.rotation_deg),
        k1=camera.k1,
    )
    needles = tuple(
        Probe(tip_radius=_radius_drawn(radius) * UM, direction=math.radians(angle))
        for radius, angle in probes
    )
    scene = reflected(outline=np.array(corners) * UM, probes=needles, optics=optics)
    return replace(scene, exposure=replace(scene.exposure, jpeg_quality=None))


def _radius_drawn(radius: float) -> float:
    return max(DRAWN_STEP * round(radius / DRAWN_STEP), LEAST_DRAWN)


def _seen_through(camera: CameraSection, world: World) -> CameraSection:
    """The camera as it is: turned and scaled about the world's origin, and bent."""
    c, s = math.cos(world.rotation), math.sin(world.rotation)
    x, y = (value / (1.0 + world.scale) for value in camera.centre_um)
    half = 0.5 * math.hypot(camera.width_px, camera.height_px) * camera.pixel_size_um
    changes = {
        "pixel_size_um": camera.pixel_size_um / (1.0 + world.scale),
        "rotation_deg": camera.rotation_deg - math.degrees(world.rotation),
        "centre_um": (c * x + s * y, c * y - s * x),
        "k1": camera.k1 + world.k1 * half**2,
    }
    return camera.model_copy(update=changes)
