"""Which cases the blind benchmark has, and in which order they are run.

A case says what is concealed, not yet by which random numbers: its seed follows from the
commitment (`sealing`), and so cannot have been known when the diagnoser was written.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Literal, TypeVar

import numpy as np

from meso_robust.campaigns.blind.labels import KINDS, SILENT, SIZES, Kind

Design = Literal["diagnostic", "lazy"]
Choice = TypeVar("Choice")

STAGES: dict[str, tuple[str, ...]] = {
    "support": (
        "dry_friction",
        "stribeck_friction",
        "shear_thinning",
        "anisotropic_drag",
        "part_anisotropic_drag",
        "drag_centre_offset",
        "drag_gradient",
        "drag_drift",
        "breakaway_friction",
        "uneven_support",
    ),
    "environment": ("body_force", "film_flow", "wall_capillarity", "unmodelled_wall"),
    "contact": ("tip_adhesion", "tip_attraction", "edge_dependent_friction"),
    "geometry": ("part_geometry", "tip_radius", "reference_offset"),
    "actuation": ("probe_compliance", "backlash", "probe_drift"),
    "observation": (
        "camera_latency",
        "camera_scale",
        "camera_rotation",
        "camera_drift",
        "lens_distortion",
    ),
}
"""The catalogue of effects by stage, as published with the format of ``diagnosis.json``."""

EFFECTS = tuple(itertools.chain.from_iterable(STAGES.values()))
STAGE = {name: stage for stage, names in STAGES.items() for name in names}

ENTANGLED = (
    ("backlash", "camera_latency"),
    ("drag_drift", "body_force"),
    ("dry_friction", "shear_thinning"),
    ("drag_centre_offset", "drag_gradient"),
    ("tip_adhesion", "tip_attraction"),
    ("body_force", "camera_drift"),
    ("tip_radius", "part_geometry"),
    ("drag_drift", "dry_friction"),
)
"""Pairs that hide each other, or of which one shows only through the other."""

PLAIN_SIZES = (4.0, 8.0, 16.0)


@dataclass(frozen=True, slots=True)
class Entry:
    """A case of the corpus, without its random numbers."""

    kind: Kind
    names: tuple[str, ...] = ()
    multiples: tuple[float, ...] = ()
    """Size of each effect over its just-detectable size."""
    design: Design = "diagnostic"


@dataclass(frozen=True, slots=True, kw_only=True)
class Corpus:
    """How many cases of every kind; with a master seed this settles the list of entries."""

    master_seed: int = 7
    nulls: int = 100
    effects: tuple[str, ...] = EFFECTS
    multiples: tuple[float, ...] = SIZES
    repeats: int = 1
    """Cases of every effect at every multiple."""
    pairs: int = 60
    outside: int = 40
    unidentifiable: int = 20


QUICK = Corpus(
    nulls=3,
    effects=("dry_friction", "body_force", "tip_adhesion", "part_geometry", "camera_latency"),
    multiples=(16.0,),
    pairs=1,
    outside=2,
    unidentifiable=1,
)
"""A dozen cases: says that everything runs, and next to nothing about rates."""


def entries(
    corpus: Corpus, outside: Sequence[str], unidentifiable: Sequence[tuple[str, ...]]
) -> list[Entry]:
    """All cases, in an order of which every beginning is a fair sample of all kinds.

    Parameters
    ----------
    corpus
        How many.
    outside
        What the generator can conceal that is not in the catalogue.
    unidentifiable
        Sets of effects that it can conceal in recordings that cannot show them.
    """
    streams = np.random.SeedSequence(corpus.master_seed).spawn(len(KINDS) + 1)
    rngs = [np.random.default_rng(stream) for stream in streams]
    groups = [
        [Entry("null")] * corpus.nulls,
        list(_effects(corpus, rngs[1])),
        list(_pairs(corpus, rngs[2])),
        list(_outside(corpus.outside, outside, rngs[3])),
        list(_unidentifiable(corpus.unidentifiable, unidentifiable, rngs[4])),
    ]
    return interleaved(groups, rngs[5])


def interleaved(groups: Sequence[Sequence[Entry]], rng: np.random.Generator) -> list[Entry]:
    """One list in which each group is spread evenly and keeps its own order."""
    placed = [
        ((k + shift) / len(group), entry)
        for group, shift in zip(groups, rng.random(len(groups)), strict=True)
        for k, entry in enumerate(group)
    ]
    return [entry for _, entry in sorted(placed, key=lambda pair: pair[0])]


def _effects(corpus: Corpus, rng: np.random.Generator) -> Iterator[Entry]:
    """Rounds of all effects; the multiples take turns, so that a round has all of them."""
    count = len(corpus.multiples)
    for _ in range(corpus.repeats):
        shifts = {name: k for k, name in enumerate(rng.permutation(corpus.effects))}
        for turn in rng.permutation(count):
            for name in rng.permutation(corpus.effects):
                multiple = corpus.multiples[(int(turn) + shifts[name]) % count]
                yield Entry("effect", (str(name),), (multiple,))


def _pairs(corpus: Corpus, rng: np.random.Generator) -> Iterator[Entry]:
    """Those that hide or need each other, then random ones, all effects equally often."""
    chosen = [pair for pair in ENTANGLED if set(pair) <= set(corpus.effects)]
    alone = [name for name in corpus.effects if name not in SILENT]
    left: list[str] = []
    while len(chosen) < corpus.pairs:
        if len(left) < 2:
            left += [str(name) for name in rng.permutation(alone) if name not in left]
        chosen.append((left.pop(0), left.pop(0)))
    for pair in chosen[: corpus.pairs]:
        yield Entry("pair", pair, tuple(float(m) for m in rng.choice(PLAIN_SIZES, 2)))


def _outside(count: int, names: Sequence[str], rng: np.random.Generator) -> Iterator[Entry]:
    for k, name in zip(range(count), _turns(names, rng), strict=False):
        yield Entry("outside", (name,), (PLAIN_SIZES[k % len(PLAIN_SIZES)],))


def _unidentifiable(
    count: int, sets: Sequence[tuple[str, ...]], rng: np.random.Generator
) -> Iterator[Entry]:
    for _, names in zip(range(count), _turns(sets, rng), strict=False):
        yield Entry("unidentifiable", names, (8.0,) * len(names), "lazy")


def _turns(choices: Sequence[Choice], rng: np.random.Generator) -> Iterator[Choice]:
    """Rounds of all choices, each in a random order."""
    while choices:
        yield from (choices[k] for k in rng.permutation(len(choices)))
