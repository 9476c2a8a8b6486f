"""Six effects that the catalogue has learnt since, laws that it has not, and a list of cases of both.

Four of the six were outside before, by the names and with the laws of `laws.OUTSIDE`. Cases draw from `laws.FAMILIES` and
`LEARNT`, or from what is `OUTSIDE` here; all else of them is as in `cases`.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from unittest import mock

import numpy as np

from reports.blind3.cases import Case, Values, listed as listed_before, sealed as sealed_before
from reports.blind3.generate import LENGTH, WIDTH, Change, Floats, Instant, turn
from reports.blind3.laws import FAMILIES, OUTSIDE as OUTSIDE_BEFORE, Family, Rng


def bent_screw(size: float, rng: Rng) -> Change:
    """A lead screw along one axis whose error rises slowly and falls fast in every turn of it."""
    axis, pitch = int(rng.integers(2)), rng.uniform(120.0, 600.0)
    top, start = rng.choice([0.25, 0.35, 0.65, 0.75]), rng.uniform(0.0, pitch)

    def drive(_: Floats, way: Floats) -> Floats:
        true = way.copy()
        true[:, axis] += np.interp(
            way[:, axis] - start, [0.0, top * pitch], [-size, size], period=pitch
        )
        return true

    return Change(drive=drive)


def folded_angle(size: float, rng: Rng) -> Change:
    """A tracked angle whose error is a triangular wave, twice or four times in a turn of the part."""
    fold, start = int(rng.choice([2, 4])), rng.uniform(0.0, 2.0 * np.pi)

    def see(_: Floats, poses: Floats) -> Floats:
        seen = poses.copy()
        wave = np.arcsin(np.sin(fold * poses[:, 2] - start)) / (0.5 * np.pi)
        seen[:, 2] += np.radians(size) * wave
        return seen

    return Change(see=see)


LEARNT: Mapping[str, Family] = {
    "sticky_spot": OUTSIDE_BEFORE["sticky_patch"],
    "point_pull": OUTSIDE_BEFORE["central_pull"],
    "friction_drift": OUTSIDE_BEFORE["wearing_tip"],
    "pixel_locking": OUTSIDE_BEFORE["pixel_locking"],
    "leadscrew_error": Family("actuation", bent_screw, 1.0, 12.0, "a skewed triangle in the place along one axis"),
    "angle_error": Family("observation", folded_angle, 0.3, 3.0, "a triangle, twice or four times in a turn"),
}  # fmt: skip
"""By the name of the family in the catalogue, which had none of them when `laws` was written."""


def suction(size: float, rng: Rng) -> Change:
    """A part that is held where it rests, and once it has broken loose no more after a second or so."""
    fade = rng.uniform(0.3, 1.2)
    store = {"held": 1.0, "time": 0.0}

    def drag(now: Instant) -> Floats:
        step = now.time - store["time"]
        if step < 0.0:
            store["held"] = 1.0
        elif np.hypot(*now.slips.T).mean() > 2.0:
            store["held"] *= np.exp(-step / fade)
        store["time"] = now.time
        return np.full(len(now.own), 75.0 * size * store["held"])

    return Change(drag=drag)


def draught(size: float, rng: Rng) -> Change:
    """A pull along the stage that swings once in two to six seconds."""
    way, rate = turn(rng.uniform(0.0, 2.0 * np.pi))[0], 2.0 * np.pi / rng.uniform(2.0, 6.0)
    start = rng.uniform(0.0, 2.0 * np.pi)
    return Change(force=lambda now: size * way * np.sin(rate * now.time + start))


def hopping_tip(size: float, rng: Rng) -> Change:
    """A tip that hops: friction is lost for part of every cycle."""
    cycle, share = rng.uniform(0.5, 2.0), rng.uniform(0.25, 0.5)
    return Change(friction=lambda now: 1.0 - size * (now.time / cycle % 1.0 > 1.0 - share))


def skewed_part(size: float, rng: Rng) -> Change:
    """A parallelogram: two edges slide along themselves and apart, and turn the other two."""
    axis, shift = int(rng.integers(2)), size * rng.choice([-1.0, 1.0])

    def corners(stated: Floats) -> Floats:
        moved = stated.copy()
        moved[:, axis] += shift * stated[:, 1 - axis] / (0.5 * (WIDTH, LENGTH)[axis])
        return moved

    return Change(corners=corners)


def jumping_mount(size: float, rng: Rng) -> Change:
    """A tip that slips in its mount once a push, along a slot and against the way it goes."""
    slot = turn(rng.uniform(0.0, np.pi))[0]

    def drive(_: Floats, way: Floats) -> Floats:
        gone = np.maximum.accumulate(np.hypot(*(way - way[0]).T))
        where = 100.0 + np.abs(way[0]).sum() % 150.0  # elsewhere in every push
        back = -np.sign((way[-1] - way[0]) @ slot) * slot
        return np.asarray(way + np.outer(size * np.clip((gone - where) / 10.0, 0.0, 1.0), back))

    return Change(drive=drive)


def fast_clock(size: float, rng: Rng) -> Change:
    """A camera whose clock gains or loses some per cent on that of the stage."""
    rate = 1.0 + 0.01 * size * rng.choice([-1.0, 1.0])

    def see(times: Floats, poses: Floats) -> Floats:
        return np.column_stack([np.interp(rate * times, times, column) for column in poses.T])

    return Change(see=see)


OUTSIDE: Mapping[str, Family] = {
    "shake": OUTSIDE_BEFORE["shake"],
    "runout": OUTSIDE_BEFORE["runout"],
    "suction": Family("support", suction, 0.1, 2.0, "holds a part at rest, fades once it is loose"),
    "draught": Family("environment", draught, 0.3, 20.0, "a pull that swings"),
    "hopping_tip": Family("contact", hopping_tip, 0.1, 0.9, "friction is lost in part of every cycle"),
    "skewed_part": Family("geometry", skewed_part, 2.0, 40.0, "a parallelogram"),
    "jumping_mount": Family("actuation", jumping_mount, 1.0, 40.0, "the tip slips in its mount once"),
    "fast_clock": Family("observation", fast_clock, 0.5, 8.0, "the camera's clock runs at another rate"),
}  # fmt: skip
"""What the catalogue has not now either."""


def listed(count: int, seed: int) -> list[Case]:
    """Kinds, sizes and seeds of `cases.listed`, with laws of here: a third of the first ones are learnt."""
    rng = np.random.default_rng([seed, 1])
    first = _dealt([*FAMILIES, *LEARNT, *LEARNT], rng)
    outside = _dealt([*OUTSIDE], rng)
    known = {**FAMILIES, **LEARNT}
    cases = []
    for case in listed_before(count, seed):
        names = [next(outside if case.kind == "outside" else first) for _ in case.families[:1]]
        if case.kind == "pair":
            other = [name for name in known if known[name].stage != known[names[0]].stage]
            names.append(str(rng.choice(other)))
        cases.append(replace(case, families=tuple(names)))
    return cases


def _dealt(names: Sequence[str], rng: Rng) -> Iterator[str]:
    """All names in a drawn order, and again in another, without end."""
    while True:
        yield from (str(name) for name in rng.permutation(names))


def sealed(case: Case, folder: Path) -> Values:
    """Make the set of a case as `cases.sealed` does, which looks laws up in its module."""
    with mock.patch("reports.blind3.cases.OUTSIDE", {**LEARNT, **OUTSIDE}):
        return sealed_before(case, folder)
