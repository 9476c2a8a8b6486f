"""Laws that the catalogue has not and no list has used before, and a list of pairs and of these laws.

Pairs and single effects are drawn from `laws.FAMILIES` and `beyond.LEARNT`, what is outside from `OUTSIDE` here. All of it
is to be well visible: sizes are drawn from `LEAST` to `MOST` times just detectable, and a set whose measured ones are not
there is made again. Every law takes a size and a generator that its shape is drawn with, and returns the `Change`. Units
are um, s and rad; forces are over the film's drag and hence speeds, and a size of which no unit is told is over the plain
friction or drag.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any
from unittest import mock

import numpy as np

from reports.blind3.beyond import LEARNT, _dealt
from reports.blind3.cases import Case, Values, sealed as sealed_before
from reports.blind3.generate import (
    LENGTH,
    RADIUS,
    RATE,
    SUBSTEPS,
    WIDTH,
    Change,
    Floats,
    Instant,
    World,
    corners_of,
    turn,
)
from reports.blind3.laws import FAMILIES, Family, Rng

HALF = 0.5 * np.array([LENGTH, WIDTH])
KINDS = {"pair": 26, "outside": 26, "single": 6, "null": 6}
"""How many cases there are of each."""
LEAST, MOST, APART = 4.0, 100.0, 5.0
"""Sizes over the just detectable one, and how many times larger than the other one of a pair may be."""
TRIES = 12
"""Sets that are made of a case at most."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Shaped(Change):
    """A change of the outline that moves more than its corners."""

    outline: Callable[[Floats], Floats]
    """True outline (V', 2) for the one with rounded corners (V, 2), part's axes."""


def outline_of(world: World) -> Floats:
    """The outline of a world whose changes may be `Shaped`.

    Parameters
    ----------
    world
        What is true of a set.

    Returns
    -------
    Floats
        (V, 2) true outline in the part's frame, um.
    """
    outline = corners_of(world)
    for change in world.changes:
        outline = change.outline(outline) if isinstance(change, Shaped) else outline
    return outline


def ringing_arm(size: float, rng: Rng) -> Change:
    """An arm that swings on for a while whenever its speed changes; size: um for a change by 100 um/s."""
    rate, decay = 2.0 * np.pi * rng.uniform(0.8, 2.5), rng.uniform(0.7, 2.0)

    def drive(times: Floats, way: Floats) -> Floats:
        swing = np.exp(-decay * times) * np.sin(rate * times)
        speed = np.diff(way, axis=0, prepend=way[:1]) / np.diff(times[:2])
        knocks = np.diff(speed, axis=0, append=speed[-1:]) / 100.0
        late = [np.convolve(knock, swing)[: len(times)] for knock in knocks.T]
        return np.asarray(way - size * np.column_stack(late))

    return Change(drive=drive)


def stalling_drive(size: float, rng: Rng) -> Change:
    """A drive that stalls now and then for some time, and makes up for it at twice the pace; size: s."""
    cycle, start = rng.uniform(1.2, 2.5), rng.uniform(0.3, 1.2)

    def drive(times: Floats, way: Floats) -> Floats:
        phase = np.mod(times - start, cycle)
        late = np.where(times > start, np.maximum(size - np.abs(phase - size), 0.0), 0.0)
        return np.column_stack([np.interp(times - late, times, column) for column in way.T])

    return Change(drive=drive)


def late_part(size: float, rng: Rng) -> Change:
    """A piezoelectric drive of whose travel a part arrives seconds later; size: per cent."""
    fade = rng.uniform(0.5, 2.5)

    def drive(times: Floats, way: Floats) -> Floats:
        slow = way.copy()
        share = -np.expm1(-np.diff(times) / fade)
        for k in range(1, len(way)):
            slow[k] = slow[k - 1] + share[k - 1] * (way[k] - slow[k - 1])
        return np.asarray(way + 0.01 * size * (slow - way))

    return Change(drive=drive)


def tapered_part(size: float, rng: Rng) -> Change:
    """A trapezium: two edges lean against each other; size: um by which a corner is out of place."""
    axis, shift = int(rng.integers(2)), size * rng.choice([-1.0, 1.0])

    def corners(stated: Floats) -> Floats:
        moved = stated.copy()
        other = stated[:, 1 - axis] / HALF[1 - axis]
        moved[:, axis] += shift * np.sign(stated[:, axis]) * other
        return moved

    return Change(corners=corners)


def bent_part(size: float, rng: Rng) -> Change:
    """A part that is bent like a bow: both long edges are parabolas; size: um from middle to end."""
    sag = size * rng.choice([-1.0, 1.0])

    def outline(rounded: Floats) -> Floats:
        shares, ends = np.linspace(0.0, 1.0, 8, endpoint=False), np.roll(rounded, -1, axis=0)
        pieces = [
            a + shares[: 8 if np.hypot(*(b - a)) > 100.0 else 1, None] * (b - a)
            for a, b in zip(rounded, ends, strict=True)
        ]
        dense = np.concatenate(pieces)
        dense[:, 1] += sag * (1.0 / 3.0 - (dense[:, 0] / HALF[0]) ** 2)
        return np.asarray(dense)

    return Shaped(outline=outline)


def barbed_edge(size: float, rng: Rng) -> Change:
    """Edges that are rough for a tip which slides round the part one way, and smooth the other way."""
    sense = rng.choice([-1.0, 1.0])
    store: dict[str, Any] = {"at": np.zeros(2), "time": np.inf}

    def friction(now: Instant) -> float:
        step = now.time - store["time"]
        slid = (now.at - store["at"]) / step if step > 0.0 else np.zeros(2)
        store.update(at=now.at, time=now.time)
        axis = int(np.argmax(np.abs(now.at) - HALF))
        around = (1.0, -1.0)[axis] * np.sign(now.at[axis]) * slid[1 - axis]
        return float(1.0 + size * sense * np.tanh(around / 3.0))

    return Change(friction=friction)


def squeezed_fluid(size: float, rng: Rng) -> Change:
    """Fluid between tip and part that resists both a closing and an opening gap; size: um/s at 75 um/s."""
    reach = rng.uniform(10.0, 30.0)
    store = {"gap": np.nan, "rate": 0.0}

    def drive(_: Floats, way: Floats) -> Floats:
        store.update(gap=np.nan, rate=0.0)  # another push
        return way

    def attraction(gap: float) -> float:
        rate = 0.5 * (store["rate"] + np.nan_to_num(gap - store["gap"]) * RATE * SUBSTEPS)
        store.update(gap=gap, rate=rate)
        return float(size * rate / 75.0 * reach / (reach + gap))

    return Change(drive=drive, attraction=attraction)


def bow_wave(size: float, _: Rng) -> Change:
    """Fluid that piles up before the part: it drags more in front than behind, whichever way it goes."""

    def drag(now: Instant) -> Floats:
        ahead = now.speed[:2] / (np.hypot(*now.speed[:2]) + 1.0)
        lead = np.clip((now.places - now.pose[:2]) @ ahead / 600.0, -1.0, 1.0)
        return np.asarray(size * np.hypot(*now.slips.T) * (1.0 + lead))

    return Change(drag=drag)


def ridged_stage(size: float, rng: Rng) -> Change:
    """A stage with ridges, over which a place of the part drags more than between them."""
    way, pitch = turn(rng.uniform(0.0, 2.0 * np.pi))[0], rng.uniform(500.0, 1100.0)
    start = rng.uniform(0.0, 2.0 * np.pi)

    def drag(now: Instant) -> Floats:
        ridge = 1.0 + np.sin(2.0 * np.pi * now.places @ way / pitch + start)
        return np.asarray(size * np.hypot(*now.slips.T) * ridge)

    return Change(drag=drag)


def tether(size: float, rng: Rng) -> Change:
    """A hair that holds the part where a recording begins, slack at first; size: um/s for 100 um."""
    slack = rng.uniform(20.0, 100.0)
    store: dict[str, Any] = {"from": np.zeros(2), "time": np.inf}

    def force(now: Instant) -> Floats:
        if now.time < store["time"]:
            store["from"] = now.pose[:2].copy()
        store["time"] = now.time
        back = store["from"] - now.pose[:2]
        far = max(float(np.hypot(*back)), 1e-9)
        return np.asarray(size * max(far - slack, 0.0) / 100.0 * back / far)

    return Change(force=force)


def whirl(size: float, rng: Rng) -> Change:
    """Something that goes round a place of the stage and takes the part along; size: um/s at most."""
    middle, radius = rng.uniform(-500.0, 500.0, 2), rng.uniform(300.0, 800.0)
    spin = rng.choice([-1.0, 1.0])

    def force(now: Instant) -> Floats:
        x, y = (now.pose[:2] - middle) / radius
        return np.asarray(size * spin * 2.0 * np.array([-y, x]) / (1.0 + x * x + y * y))

    return Change(force=force)


def keystone(size: float, rng: Rng) -> Change:
    """A camera that looks askew, so that what is farther off looks smaller; size: per cent a mm."""
    slope = 1e-5 * size * turn(rng.uniform(0.0, 2.0 * np.pi))[0]

    def image(places: Floats) -> Floats:
        return np.asarray(places / (1.0 + places @ slope)[:, None])

    def see(_: Floats, poses: Floats) -> Floats:
        axis = np.column_stack([np.cos(poses[:, 2]), np.sin(poses[:, 2])])
        x, y = (image(poses[:, :2] + HALF[0] * axis) - image(poses[:, :2] - HALF[0] * axis)).T
        turned = np.arctan2(axis[:, 0] * y - axis[:, 1] * x, axis[:, 0] * x + axis[:, 1] * y)
        return np.column_stack([image(poses[:, :2]), poses[:, 2] + turned])

    return Change(see=see)


def tip_shadow(size: float, rng: Rng) -> Change:
    """A tracker that takes the shadow of a near tip for a bit of the part; size: um when it touches."""
    reach, ways = rng.uniform(15.0, 40.0), [np.zeros((0, 2))]

    def drive(_: Floats, way: Floats) -> Floats:
        ways[0] = way
        return way

    def see(_: Floats, poses: Floats) -> Floats:
        away, c, s = ways[0] - poses[:, :2], np.cos(poses[:, 2]), np.sin(poses[:, 2])
        at = np.column_stack([c * away[:, 0] + s * away[:, 1], c * away[:, 1] - s * away[:, 0]])
        gap = np.hypot(*np.maximum(np.abs(at) - HALF, 0.0).T) - RADIUS
        dark = size * np.exp(-np.maximum(gap, 0.0) / reach) / np.hypot(*away.T)
        return np.column_stack([poses[:, :2] + dark[:, None] * away, poses[:, 2]])

    return Change(drive=drive, see=see)


OUTSIDE: Mapping[str, Family] = {
    "ringing_arm": Family("actuation", ringing_arm, 1.0, 30.0, "swings on when the speed changes"),
    "stalling_drive": Family("actuation", stalling_drive, 0.05, 0.4, "stalls and makes up for it"),
    "late_part": Family("actuation", late_part, 2.0, 40.0, "a part of the travel comes seconds later"),
    "tapered_part": Family("geometry", tapered_part, 2.0, 40.0, "a trapezium"),
    "bent_part": Family("geometry", bent_part, 2.0, 60.0, "bent like a bow"),
    "barbed_edge": Family("contact", barbed_edge, 0.1, 0.95, "friction by the sense of the slide"),
    "squeezed_fluid": Family("contact", squeezed_fluid, 5.0, 60.0, "resists a gap that closes or opens"),
    "bow_wave": Family("support", bow_wave, 0.1, 4.0, "drags more in front"),
    "ridged_stage": Family("support", ridged_stage, 0.1, 4.0, "drag is periodic in the place"),
    "tether": Family("environment", tether, 0.3, 20.0, "a hair holds the part where it was"),
    "whirl": Family("environment", whirl, 0.3, 20.0, "a pull round a place of the stage"),
    "keystone": Family("observation", keystone, 0.5, 12.0, "the camera looks askew"),
    "tip_shadow": Family("observation", tip_shadow, 1.0, 30.0, "a near tip shifts what is seen"),
}  # fmt: skip
"""What the catalogue has not, nor any trial before."""


def listed(seed: int) -> list[Case]:
    """All cases, kinds in a drawn order.

    Parameters
    ----------
    seed
        Of kinds, laws and sizes.

    Returns
    -------
    list[Case]
        As many of each kind as `KINDS` says. Laws are dealt, so that each comes before one comes again; the
        second effect of a pair is drawn from those of other stages.
    """
    rng = np.random.default_rng([seed, 2])
    known = {**FAMILIES, **LEARNT}
    first, outside = _dealt([*known], rng), _dealt([*OUTSIDE], rng)
    order = rng.permutation([kind for kind, count in KINDS.items() for _ in range(count)])
    cases = []
    for k, kind in enumerate(map(str, order)):
        names = [] if kind == "null" else [next(outside if kind == "outside" else first)]
        sizes = [_size(LEAST, MOST, rng) for _ in names]
        if kind == "pair":
            other = [name for name in known if known[name].stage != known[names[0]].stage]
            names.append(str(rng.choice(other)))
            sizes.append(_size(max(LEAST, sizes[0] / APART), min(MOST, sizes[0] * APART), rng))
        cases.append(
            Case(
                id=k,
                kind=kind,
                families=tuple(names),
                multiples=tuple(sizes),
                seed=int(rng.integers(2**31)),
            )
        )
    return cases


def _size(low: float, high: float, rng: Rng) -> float:
    return round(float(np.exp(rng.uniform(np.log(low), np.log(high)))), 3)


def fits(measured: Sequence[float]) -> bool:
    """Whether what is concealed is as visible as it should be.

    Parameters
    ----------
    measured
        Sizes over the just detectable ones; none of a null.

    Returns
    -------
    bool
        All from `LEAST` to `MOST`, and none `APART` times larger than another.
    """
    low, high = min(measured, default=LEAST), max(measured, default=LEAST)
    return low >= LEAST and high <= min(MOST, APART * low)


@contextmanager
def laws_of_here() -> Iterator[None]:
    """Have `cases.sealed` find the laws of here, and the plant the outlines that are `Shaped`."""
    with (
        mock.patch("reports.blind3.cases.OUTSIDE", {**LEARNT, **OUTSIDE}),
        mock.patch("reports.blind3.generate.corners_of", outline_of),
    ):
        yield


def sealed(case: Case, folder: Path) -> Values:
    """Make the set of a case as `cases.sealed` does, until its sizes are as they should be.

    A set is made again with the size mended in proportion, and if that does not do, with the next seed: then pushes
    and laws are drawn anew.

    Parameters
    ----------
    case
        What the set is to conceal.
    folder
        Where the set is written.

    Returns
    -------
    Values
        What is true of the set, as of `cases.sealed`, and ``seed``, which it was made with.

    Raises
    ------
    RuntimeError
        No set of `TRIES` fits.
    """
    sizes = case.multiples
    for k in range(TRIES):
        again = replace(case, seed=case.seed + k // 2, multiples=sizes)
        with laws_of_here():
            label = sealed_before(again, folder)
        if fits(label["measured"]):
            return {**label, "seed": again.seed}
        mended = zip(sizes, case.multiples, label["measured"], strict=True)
        sizes = (
            tuple(size * aim / max(got, 0.1) for size, aim, got in mended)
            if k % 2 == 0
            else case.multiples
        )
    raise RuntimeError(f"case {case.id}: no set fits; let its list be drawn with another seed")
