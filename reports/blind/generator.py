"""From a case of the corpus to a recording set with the effect concealed, and its label.

Three independent random streams follow from a case's seed: what is concealed, the experiment with
its nuisance, and the noise of the sensor.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

from reports.blind.camera import Sensor, coloured, drawn_sensor
from reports.blind.change import Change, Effect
from reports.blind.detectable import Nuisance, just_detectable, nuisance
from reports.blind.effects import EFFECTS, POST
from reports.blind.laws import Laws
from reports.blind.outside import OUTSIDE
from reports.blind.posts import laid
from reports.blind.pushes import AIM, DESIGNS, FRAME_RATE, commanded
from reports.blind.world import LENGTH, TIP_RADIUS, WIDTH, Push, World, filmed, rho

Floats = npt.NDArray[np.float64]

SILENT = frozenset({"drag_drift"})
"""Effects that leave no trace alone: their multiples are of the guess."""

UNIDENTIFIABLE: dict[tuple[str, ...], tuple[str, ...]] = {
    ("drag_drift",): ("none",),
    ("body_force",): ("film_flow", "wall_capillarity", "camera_drift"),
    ("film_flow",): ("body_force", "wall_capillarity", "camera_drift"),
    ("wall_capillarity",): ("body_force", "film_flow"),
    ("backlash",): ("camera_latency", "tip_radius"),
    ("camera_latency",): ("backlash", "tip_radius"),
    ("drag_centre_offset",): ("drag_gradient", "uneven_support"),
    ("drag_gradient",): ("drag_centre_offset", "uneven_support"),
    ("anisotropic_drag",): ("part_anisotropic_drag",),
    ("part_anisotropic_drag",): ("anisotropic_drag",),
    ("tip_radius",): ("part_geometry", "backlash", "camera_latency"),
    ("part_geometry",): ("tip_radius", "backlash", "camera_latency"),
}
"""What a lazy experiment cannot tell, and from what; all but the first are loud all the same."""


@dataclass(frozen=True, slots=True)
class Case:
    """What to conceal, how large, in which experiment, with which random numbers."""

    kind: Literal["null", "effect", "pair", "outside", "unidentifiable"] = "null"
    names: tuple[str, ...] = ()
    multiples: tuple[float, ...] = ()
    """Size of each effect over its just-detectable size."""
    seed: int = 0
    design: Literal["diagnostic", "lazy"] = "diagnostic"


@dataclass(frozen=True, slots=True, eq=False)
class Recorded:
    """One recording as written: times (T,), seen poses (T, 3), commands (T, 2); um, rad, s."""

    times: Floats
    poses: Floats
    """NaN where the part was not seen."""
    commands: Floats


@dataclass(frozen=True, slots=True, eq=False)
class Made:
    """A recording set, the truth about it, and its seen poses without noise or losses."""

    recordings: tuple[Recorded, ...]
    sensor: Sensor
    label: dict[str, Any]
    clean: tuple[Floats, ...]
    """(T, 3) at every frame of every recording."""
    world: World
    pushes: tuple[Push, ...]


def make(case: Case, recordings: int = 16) -> Made:
    """The recording set of a case.

    Raises
    ------
    KeyError
        An effect that neither the catalogue nor the world outside it has.
    """
    secret, physics, noise = (
        np.random.default_rng(s) for s in np.random.SeedSequence(case.seed).spawn(3)
    )
    effects = [(EFFECTS | OUTSIDE)[name] for name in case.names]
    hidden = [Hidden(effect, int(secret.integers(2**31))) for effect in effects]
    world, sensor = _nominal(physics), drawn_sensor(noise)
    pushes = _pushes(case, hidden, world, physics, recordings)
    if hidden:
        truth, clean, changed = _concealed(case, hidden, world, pushes, sensor)
    else:
        truth, clean, changed = {}, [filmed(world, push) for push in pushes], world
    label = {
        "kind": case.kind,
        "design": case.design,
        "names": list(case.names),
        "stages": [effect.stage for effect in effects],
        "rivals": list(UNIDENTIFIABLE.get(case.names, ())) if case.kind == "unidentifiable" else [],
        "mu": world.laws.mu,
        "rho_um2": rho(world.laws),
        "footprint": world.laws.footprint,
        "position_sigma_um": sensor.position_sigma,
        "orientation_sigma_deg": sensor.orientation_sigma_deg,
        "correlation": sensor.correlation,
        **NOTHING,
        **truth,
    }
    made = tuple(_sensed(s, push, sensor, noise) for s, push in zip(clean, pushes, strict=True))
    return Made(made, sensor, label, tuple(clean), changed, tuple(pushes))


NOTHING: dict[str, Any] = {
    "parameters": [],
    "just_detectable": [],
    "sizes": [],
    "multiples": [],
    "signature_sigma": 0.0,
    "felt": [],
}
"""What a label says of the effects of a null."""


@dataclass(frozen=True, slots=True)
class Hidden:
    """An effect and the seed of all that its size leaves open."""

    effect: Effect
    seed: int

    def change(self, size: float) -> Change:
        """What it changes at a size."""
        return self.effect.change(size, self.seed)

    def unit(self, known: Nuisance, world: World, pushes: Sequence[Push]) -> float:
        """Its just-detectable size in these recordings; that of `SILENT` ones is a convention."""
        if self.effect.name in SILENT:
            return self.effect.guess

        def norm(size: float) -> float:
            changed = self.change(size).of(world)
            return known.size_of([filmed(changed, push) for push in pushes])

        return just_detectable(norm, self.effect.guess, self.effect.most)


def _concealed(
    case: Case, hidden: Sequence[Hidden], world: World, pushes: Sequence[Push], sensor: Sensor
) -> tuple[dict[str, Any], list[Floats], World]:
    """What the label says of the effects, the seen poses without noise, the changed world."""
    known = nuisance(world, pushes, sensor)
    units = [each.unit(known, world, pushes) for each in hidden]
    sizes = [
        min(unit * multiple, each.effect.most)
        for unit, multiple, each in zip(units, case.multiples, hidden, strict=True)
    ]
    changes = [each.change(size) for each, size in zip(hidden, sizes, strict=True)]
    for change in changes:
        world = change.of(world)
    clean = [filmed(world, push) for push in pushes]
    truth = {
        "parameters": [dict(change.parameters) for change in changes],
        "just_detectable": units,
        "sizes": sizes,
        "multiples": [size / unit for size, unit in zip(sizes, units, strict=True)],
        "signature_sigma": known.size_of(clean),
        "felt": _felt(known.base, clean, pushes, sensor),
    }
    return truth, clean, world


def write(made: Made, folder: Path) -> None:
    """Write the set as a folder with ``set.toml`` and one CSV file a recording."""
    folder.mkdir(parents=True, exist_ok=True)
    names = [f"push_{k:02d}.csv" for k in range(len(made.recordings))]
    for name, recorded in zip(names, made.recordings, strict=True):
        (folder / name).write_text(_table(recorded), encoding="utf-8")
    (folder / "set.toml").write_text(_description(made.sensor, names), encoding="utf-8")


def _nominal(rng: np.random.Generator) -> World:
    """A linear film and a rigid tip, with what varies from set to set."""
    square = rng.uniform(200e3, 420e3)
    footprint = float(np.sqrt(square / rho(Laws())))
    return World(Laws(mu=float(rng.uniform(0.15, 0.45)), footprint=footprint))


def _pushes(
    case: Case,
    hidden: Sequence[Hidden],
    world: World,
    rng: np.random.Generator,
    count: int,
) -> list[Push]:
    """The commands of all recordings, aimed with what was sensed."""
    plans = DESIGNS[case.design](rng, count)
    for each in hidden:
        if each.effect.name == "unmodelled_wall":
            laws = each.change(0.0).laws
            place = np.array([laws["post_x"], laws["post_y"]])
            plans = laid(plans, world, place, POST, rng)
    return [commanded(plan, rng.normal(size=3) * AIM) for plan in plans]


def _sensed(seen: Floats, push: Push, sensor: Sensor, rng: np.random.Generator) -> Recorded:
    """Noise, lost frames and frames without the part."""
    poses = seen + coloured(rng, len(seen), sensor)
    poses[rng.random(len(seen)) < sensor.blank] = np.nan
    kept = rng.random(len(seen)) >= sensor.dropped
    kept[0] = True
    return Recorded(push.frames[kept], poses[kept], push.commands()[kept])


def _felt(
    base: Sequence[Floats], clean: Sequence[Floats], pushes: Sequence[Push], sensor: Sensor
) -> list[dict[str, Any]]:
    """Where the effects move the seen part by more than the noise, and how much over all."""
    felt = []
    for k, (without, seen, push) in enumerate(zip(base, clean, pushes, strict=True)):
        off = np.abs(seen - without) / sensor.sigmas
        loud = push.frames[np.max(off, axis=1) > 1.0]
        felt.append(
            {
                "recording": f"push_{k:02d}.csv",
                "rms_sigma": [float(v) for v in np.sqrt(np.mean(off**2, axis=0))],
                "span_s": [float(loud[0]), float(loud[-1])] if len(loud) else None,
            }
        )
    return felt


def _description(sensor: Sensor, names: Sequence[str]) -> str:
    stated = (
        f"position_sigma_um = {sensor.position_sigma:.3f}\n"
        f"orientation_sigma_deg = {sensor.orientation_sigma_deg:.4f}\n"
    )
    return (
        'schema = "meso-robust/recordings/1"\n'
        f"[part]\nlength_um = {LENGTH}\nwidth_um = {WIDTH}\n"
        f'[probe]\ntip_radius_um = {TIP_RADIUS}\nposition_source = "controller"\n'
        f"[sensor]\n{stated if sensor.stated else ''}frame_rate_hz = {FRAME_RATE}\n"
    ) + "".join(f'[[recording]]\nfile = "{name}"\nprobes = ["probe1"]\n' for name in names)


def _table(recorded: Recorded) -> str:
    lines = ["time_s,part_x_um,part_y_um,part_theta_deg,probe1_x_um,probe1_y_um"]
    turns = (np.degrees(recorded.poses[:, 2]) + 180.0) % 360.0 - 180.0
    rows = zip(recorded.times, recorded.poses, turns, recorded.commands, strict=True)
    for time, pose, turn, tip in rows:
        seen = ",," if np.isnan(turn) else f"{pose[0]:.4f},{pose[1]:.4f},{turn:.5f}"
        lines.append(f"{time:.6f},{seen},{tip[0]:.4f},{tip[1]:.4f}")
    return "\n".join(lines) + "\n"
