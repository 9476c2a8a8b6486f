"""How well the tracker does on frames of a renderer that has nothing in common with the package.

``python -m reports.tracking.foreign --seed 29 --out reports/tracking/foreign.md``

That takes two films of each shape a condition; ``--full`` takes twelve. The page is written anew after every condition.

A film is drawn from signed distances in 3 x 3 points a pixel and averaged over each pixel. The rim is a
circular arc, the meniscus a power of the distance, texture is a sum of waves, the blur is that of a disc,
noise is uniform. Only numpy draws; neither :mod:`meso_robust.microscope` nor the tracker is asked.
"""

from __future__ import annotations

import argparse
import math
import time
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt

from meso_robust.tracking.pose import PartTracker, Sighting
from meso_robust.tracking.probe_search import needle_at
from meso_robust.tracking.probes import ProbeTracker

Floats = npt.NDArray[np.float64]
Bytes = npt.NDArray[np.uint8]

WIDTH, HEIGHT, FINE = 320, 240, 3
SHAPES: Mapping[str, Floats] = {
    "rectangle": np.array([[-90.0, -48.0], [90.0, -48.0], [90.0, 48.0], [-90.0, 48.0]]),
    "triangle": np.array([[-75.0, -55.0], [95.0, -20.0], [-20.0, 75.0]]),
    "pentagon": np.array(
        [[-80.0, -40.0], [10.0, -70.0], [85.0, -15.0], [50.0, 60.0], [-60.0, 55.0]]
    ),
}
RADIUS = 2.5
"""px, of a needle's round tip."""
FRAMES = 14
QUICK, FULL = 2, 12
"""Films of each shape a condition."""
NORMAL_90 = 1.645


@dataclass(frozen=True, slots=True, kw_only=True)
class Look:
    """Grey values and lengths in px that make one film look different from another."""

    face: float = 150.0
    film: float = 70.0
    rim: float = 40.0  # how much brighter the rim is at the edge
    lamp: float = 0.0  # how much more so towards the lamp, and less on the other side
    chamfer: float = 2.5
    halo: float = 15.0
    texture: float = 4.0
    disc: float = 1.6  # radius of the blur
    noise: float = 3.0  # largest


LOOKS: Mapping[str, Look] = {
    "bright rim": Look(),
    "dark rim": Look(rim=-50.0),
    "oblique light": Look(rim=-20.0, lamp=35.0),
    "rough face": Look(texture=10.0),
    "noisy": Look(noise=14.0),
    "out of focus": Look(disc=2.6),
    "lit from below": Look(face=40.0, film=190.0, rim=-10.0, texture=2.0),
}


def inside_of(corners: Floats, x: Floats, y: Floats) -> tuple[Floats, Floats, Floats]:
    """Depth inside a convex polygon (negative outside) and the outward normal of the nearest side."""
    depth, nx, ny = np.full(x.shape, np.inf), np.zeros(x.shape), np.zeros(x.shape)
    for a, b in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        ex, ey = (b - a) / math.dist(a, b)
        here = (x - a[0]) * -ey + (y - a[1]) * ex  # corners run with the interior on this side
        nearest = here < depth
        depth = np.where(nearest, here, depth)
        nx, ny = np.where(nearest, ey, nx), np.where(nearest, -ex, ny)
    return depth, nx, ny


def share(depth: Floats) -> Floats:
    """Of the place around a point that lies inside a border, ``depth`` px from it."""
    return np.clip(0.5 + FINE * depth, 0.0, 1.0)


class Waves:
    """A surface: cosines of random direction, length and phase, of unit variance."""

    def __init__(self, rng: np.random.Generator, count: int = 24) -> None:
        way, length = rng.uniform(0.0, math.pi, count), np.exp(rng.uniform(0.9, 3.6, count))
        self._k = 2.0 * math.pi * np.stack([np.cos(way), np.sin(way)]) / length
        self._phase = rng.uniform(0.0, 2.0 * math.pi, count)

    def at(self, u: Floats, v: Floats, turn: float) -> Floats:
        """(V, U) height at columns u (U,) and rows v (V,) of a grid that is turned on the surface.

        The cosine of a sum that is linear in column and row comes apart into products of the two.
        """
        c, s = math.cos(turn), math.sin(turn)
        right = (c * self._k[0] - s * self._k[1]) * u[:, None] + self._phase
        down = (s * self._k[0] + c * self._k[1]) * v[:, None]
        total = np.cos(down) @ np.cos(right).T - np.sin(down) @ np.sin(right).T
        return np.asarray(total * math.sqrt(2.0 / len(self._phase)))


class Camera:
    """Draws the frames of one film."""

    def __init__(self, look: Look, corners: Floats, rng: np.random.Generator) -> None:
        self.look, self.corners, self.rng = look, corners, rng
        self.face, self.film = Waves(rng), Waves(rng)
        self.light = rng.uniform(-math.pi, math.pi)
        self.tilt = rng.uniform(-0.1, 0.1, 2)
        reach = np.arange(-(FINE // 2), FINE // 2 + 1) / FINE
        self.rows = (np.arange(HEIGHT)[:, None] + reach).ravel()
        self.columns = (np.arange(WIDTH)[:, None] + reach).ravel()
        self.v, self.u = np.meshgrid(self.rows, self.columns, indexing="ij")
        self.ground = look.film + 0.5 * look.texture * self.film.at(self.columns, self.rows, 0.0)
        y, x = np.ogrid[: self.u.shape[0], : self.u.shape[1]]
        y, x = (np.minimum(k, n - k) for k, n in ((y, y.size), (x, x.size)))
        disc = np.clip(FINE * look.disc + 0.5 - np.hypot(x, y), 0.0, 1.0)
        self.transfer = np.fft.rfft2(disc / disc.sum())

    def frame(self, pose: Floats, needle: Floats | None) -> Bytes:
        """(HEIGHT, WIDTH) grey values; ``needle`` (3,) is its tip's centre and the shaft's direction."""
        look, (c, s) = self.look, (math.cos(pose[2]), math.sin(pose[2]))
        du, dv = self.u - pose[0], self.v - pose[1]
        x, y = c * du + s * dv, c * dv - s * du
        depth, nx, ny = inside_of(self.corners, x, y)
        towards = nx * math.cos(self.light - pose[2]) + ny * math.sin(self.light - pose[2])
        slope = 1.0 - np.sqrt(np.clip(1.0 - (1.0 - depth / look.chamfer).clip(0.0) ** 2, 0.0, 1.0))
        grain = self.face.at(self.columns - pose[0], self.rows - pose[1], pose[2])
        metal = look.face + look.texture * grain
        metal += (look.rim + look.lamp * towards) * slope
        film = self.ground - look.halo / (1.0 + np.maximum(-depth, 0.0)) ** 3
        scene = film + share(depth) * (metal - film)
        if needle is not None:
            a, b = math.cos(needle[2]), math.sin(needle[2])
            along = a * (self.u - needle[0]) + b * (self.v - needle[1])
            across = np.abs(a * (self.v - needle[1]) - b * (self.u - needle[0]))
            flank = RADIUS + 0.08 * along
            out = np.where(along > 0.0, across - flank, np.hypot(along, across) - RADIUS)
            scene += share(-out) * (25.0 + 20.0 * share(0.3 * flank - across) - scene)
        light = 1.0 + self.tilt[0] * (self.u / WIDTH - 0.5) + self.tilt[1] * (self.v / HEIGHT - 0.5)
        seen = np.fft.irfft2(np.fft.rfft2(scene * light) * self.transfer, scene.shape)
        grey = seen.reshape(HEIGHT, FINE, WIDTH, FINE).mean(axis=(1, 3))
        grey += self.rng.uniform(-look.noise, look.noise, grey.shape)
        return np.clip(np.round(grey), 0, 255).astype(np.uint8)


def poses(rng: np.random.Generator) -> Floats:
    """(FRAMES, 3) px and rad: at rest, then moved and turned."""
    middle = rng.uniform(-8.0, 8.0, 2) + np.array([WIDTH / 2, HEIGHT / 2])
    start = [*middle, rng.uniform(-math.pi, math.pi)]
    way = [*rng.uniform(-0.8, 0.8, 2), rng.uniform(-0.01, 0.01)]
    return np.array(start) + np.maximum(np.arange(FRAMES) - 4, 0)[:, None] * np.array(way)


def filmed(
    look: Look, corners: Floats, rng: np.random.Generator
) -> Iterator[tuple[Floats, Sighting, float]]:
    """Truth, what the tracker says, and processor time, frame by frame."""
    camera, tracker = Camera(look, corners, rng), PartTracker(corners)
    for k, pose in enumerate(poses(rng)):
        image = camera.frame(pose, None)
        begin = time.process_time()
        guess = np.array([np.nan, np.nan, pose[2]])
        seen = tracker.first(image, guess) if k == 0 else tracker.next(image)
        yield pose, seen, time.process_time() - begin


def needled(look: Look, rng: np.random.Generator) -> tuple[Floats, Floats]:
    """Errors (FRAMES, 2) in px, along and across, of a tip that comes near to a part at rest; standard deviations."""
    corners = SHAPES["rectangle"]
    camera, way = Camera(look, corners, rng), rng.uniform(-2.2, -0.9)
    axis = np.array([math.cos(way), math.sin(way)])
    pose = np.array(
        [WIDTH / 2.0 + rng.uniform(-1, 1), HEIGHT / 2.0 + 30.0 + rng.uniform(-1, 1), 0.0]
    )
    end = pose[:2] + np.array([rng.uniform(-30.0, 30.0), -48.0 - RADIUS - 1.0])
    tips = end + (FRAMES - 1 - np.arange(FRAMES))[:, None] * 1.3 * axis
    start = tips[0] + rng.uniform(-1.0, 1.0, 2)
    image = camera.frame(pose, np.array([*tips[0], way]))
    needle = needle_at(image, start, RADIUS)
    probe, outline, found = ProbeTracker("probe", needle), corners + pose[:2], []
    for k, tip in enumerate(tips):
        image = image if k == 0 else camera.frame(pose, np.array([*tip, way]))
        found.append(probe.first(image, outline) if k == 0 else probe.next(image, outline))
        probe.remember(image, found[-1], outline)
    said = probe.places(found)
    axes = np.array([axis, [-axis[1], axis[0]]])
    sigma = np.sqrt(np.einsum("ki,tij,kj->tk", axes, said.covariances, axes))
    return (said.tips - tips) @ axes.T, sigma


HEAD = """# Accuracy on frames of another renderer

Films of {frames} frames of {width} x {height} px, drawn by `foreign.py`, which shares neither code nor formula with
the package's microscope or tracker; no compression. A rectangle, a triangle and a pentagon, {films} films each a
condition, seed {seed}. Nothing was fitted to these frames; how much the width of a rim
and the brightness of a meniscus may vary was chosen among a few values with films of seed 1 in view, and so was what
else is fitted, with films of seeds 1, 2 and 23: how flat the blur is, and a needle's grain. The constants of the
covariance were set with films of seed 41 and, less closely, of seed 29 in view. "Coverage": share of the 90 % intervals that hold the truth.
"Beyond 4 sigma": frames with a found state whose pose is farther from the truth than that. An error is much alike
through a film.

| condition | frames | no pose | RMS u, px | RMS v, px | RMS angle, deg | coverage u / v / angle, % | beyond 4 sigma |
|---|---|---|---|---|---|---|---|
"""
TIPS_HEAD = """
A needle that comes to a pixel from a part at rest, {films} films each.

| tip | frames | no place | RMS along, px | RMS across, px | coverage along / across, % | beyond 4 sigma |
|---|---|---|---|---|---|---|
"""


def row(name: str, error: Floats, sigma: Floats) -> str:
    """One line of a table; errors and standard deviations (n, k), px or, the third, rad; NaN where not found."""
    seen = np.isfinite(error).all(axis=1)
    found, spread = error[seen], sigma[seen]
    begin = f"| {name} | {len(error)} | {len(error) - len(found)} |"
    if not len(found):
        return begin + " – |" * (error.shape[1] + 2)
    rms = np.sqrt(np.mean(found**2, axis=0))
    sizes = [f"{rms[0]:.3f}", f"{rms[1]:.3f}", *(f"{math.degrees(r):.4f}" for r in rms[2:])]
    cover = " / ".join(f"{100 * c:.0f}" for c in (np.abs(found) < NORMAL_90 * spread).mean(axis=0))
    beyond = int((np.abs(found) > 4.0 * spread).any(axis=1).sum())
    return f"{begin} {' | '.join(sizes)} | {cover} | {beyond} |"


def pose_row(name: str, place: int, films: int, seed: int) -> str:
    """Of one condition, over all shapes."""
    errors, sigmas = [], []
    for number, corners in enumerate(SHAPES.values()):
        for film in range(films):
            rng = np.random.default_rng([seed, place, number, film])
            for truth, one, _ in filmed(LOOKS[name], corners, rng):
                error = one.pose - truth
                error[2] = (error[2] + math.pi) % (2.0 * math.pi) - math.pi
                errors.append(error)
                sigmas.append(np.sqrt(np.diag(one.covariance)))
    return row(name, np.array(errors), np.array(sigmas))


def tip_row(name: str, place: int, films: int, seed: int) -> str:
    """Of the tips in one condition."""
    seen = [
        needled(LOOKS[name], np.random.default_rng([seed, place, film])) for film in range(films)
    ]
    return row(name, *(np.concatenate(part) for part in zip(*seen, strict=True)))


def main() -> None:
    """Draw, track and write the tables, anew after each condition."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--full", action="store_true", help=f"{FULL} films each, not {QUICK}")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--out", type=Path, required=True)
    given = parser.parse_args()
    films = FULL if given.full else QUICK
    text = HEAD.format(frames=FRAMES, width=WIDTH, height=HEIGHT, films=films, seed=given.seed)
    for head, one in (("", pose_row), (TIPS_HEAD.format(films=films), tip_row)):
        text += head
        for place, name in enumerate(LOOKS):
            line = one(name, place, films, given.seed)
            text += line + "\n"
            given.out.write_text(text, encoding="utf-8")
            print(line, flush=True)


if __name__ == "__main__":
    main()
