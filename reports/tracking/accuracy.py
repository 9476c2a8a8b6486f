"""How well the part tracker does on rendered video whose truth is known.

``python -m reports.tracking.accuracy --films 60 --film 14 --seed 5077 --jobs 2 --out reports/tracking/accuracy.md``
"""

from __future__ import annotations

import argparse
import math
import time
from collections.abc import Callable, Iterator, Mapping
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import numpy.typing as npt

from meso_robust.microscope import (
    Exposure,
    Fixture,
    Metal,
    Oil,
    Optics,
    Part,
    Probe,
    Scene,
    project,
    render,
)
from meso_robust.tracking.edges import placed
from meso_robust.tracking.learned import Tip
from meso_robust.tracking.memory import LEARNING
from meso_robust.tracking.pose import PartTracker, Sighting
from meso_robust.tracking.probe_search import needle_at
from meso_robust.tracking.probes import ProbeTracker
from reports.tracking.least import least_alike, least_along

Floats = npt.NDArray[np.float64]
Bytes = npt.NDArray[np.uint8]

PIXEL = 5.26e-6
LENGTH, WIDTH = 1616e-6, 837e-6
OUTLINE = 0.5 * np.array([[-LENGTH, -WIDTH], [LENGTH, -WIDTH], [LENGTH, WIDTH], [-LENGTH, WIDTH]])
BODY = OUTLINE / PIXEL * [1.0, -1.0]
REST = 4
"""Frames at rest before the part is pushed."""
TIP_FRAMES = 20
"""Of a film of a probe that comes to the part and pushes it."""
CLEAR = 8.0
"""px between tip and part, from which on a frame shows the needle before nothing but film."""
NORMAL_90 = 1.6448536269514722
LEAST_COVERED, MOST_COVERED = 0.85, 0.95
"""Share of 90 % intervals that should contain the truth."""
Random = np.random.Generator


def _metal(rng: Random, **changes: float) -> Metal:
    values: dict[str, Any] = {
        "bevel": rng.uniform(10e-6, 20e-6),
        "bevel_brightness": rng.uniform(0.4, 1.2),
        "bevel_relief": rng.uniform(0.0, 0.3),
        "texture": rng.uniform(0.02, 0.06),
    } | changes
    return Metal(seed=int(rng.integers(1 << 30)), **values)


def _scene(
    rng: Random,
    *,
    exposure: Mapping[str, float] | None = None,
    metal: Mapping[str, float] | None = None,
    probes: tuple[Probe, ...] = (),
    fixture: Fixture | None = None,
) -> Scene:
    light: dict[str, Any] = {
        "jpeg_quality": int(rng.integers(80, 96)),
        "vignetting": rng.uniform(0.0, 0.2),
        "lamp_azimuth": rng.uniform(-math.pi, math.pi),
    } | dict(exposure or {})
    return Scene(
        part=Part(outline=OUTLINE, metal=_metal(rng, **(metal or {}))),
        probes=probes,
        fixture=fixture,
        oil=Oil(seed=int(rng.integers(1 << 30)), halo=rng.uniform(0.1, 0.25)),
        optics=Optics(blur=rng.uniform(0.6, 1.2)),
        exposure=Exposure(**light),
    )


def _slot(rng: Random) -> Fixture:
    """A wall to the right of the field of view, up to 20 um from where the part may come."""
    x = rng.uniform(1.25e-3, 1.35e-3)
    return Fixture(rings=(np.array([[x, -2e-3], [3e-3, -2e-3], [3e-3, 2e-3], [x, 2e-3]]),))


def _probe(rng: Random) -> tuple[Probe, ...]:
    return (Probe(direction=rng.uniform(0.5, 2.6)),)


def _through(rng: Random) -> Scene:
    """Lit through the slide: dark metal, bright background, hardly a rim."""
    scene = _scene(
        rng,
        metal={"brightness": 0.07, "texture": 0.08, "bevel": 8e-6, "bevel_brightness": 1.6},
    )
    return replace(scene, oil=Oil(brightness=0.8, halo=0.3, seed=int(rng.integers(1 << 30))))


CONDITIONS: Mapping[str, Callable[[Random], Scene]] = {
    "as usual": _scene,
    "noisy": lambda rng: _scene(rng, exposure={"shot_noise": 0.12, "read_noise": 3.0}),
    "strong compression": lambda rng: _scene(rng, exposure={"jpeg_quality": 55}),
    "vignetting and gradient": lambda rng: _scene(rng, exposure={"vignetting": 0.4}),
    "light drifts and flickers": lambda rng: _scene(
        rng, exposure={"drift": -0.05, "flicker": 0.03, "step": 0.15, "step_time": 1.5}
    ),
    "focus drifts": lambda rng: _scene(rng, exposure={"focus_rate": 0.4}),
    "strongly oblique light": lambda rng: _scene(rng, metal={"bevel_relief": 0.4}),
    "light from above": lambda rng: _scene(rng, metal={"bevel_relief": 0.0}),
    "pushed by a probe": lambda rng: _scene(rng, probes=_probe(rng)),
    "fixture beside": lambda rng: _scene(rng, fixture=_slot(rng)),
    "lit through the slide": _through,
}


@dataclass(frozen=True, slots=True, eq=False)
class Frame:
    """Truth (3,) in px and rad, what the tracker says, its time, and whether the face was learned."""

    truth: Floats
    sighting: Sighting
    seconds: float
    learned: bool


@dataclass(frozen=True, slots=True, eq=False)
class Result:
    """Errors (n, 3) in px and rad, standard deviations, the film of each, and how many frames had no pose."""

    name: str
    error: Floats
    sigma: Floats
    film: npt.NDArray[np.int_]
    lost: int
    seconds: Floats

    @property
    def coverage(self) -> Floats:
        """(2, 2) share of the 90 % intervals that contain the truth, and its standard error: of u and v, and angle.

        A part lies at any angle, so u and v are alike; all errors of a film count as one draw.
        """
        held = np.abs(self.error) < NORMAL_90 * self.sigma
        held = np.column_stack((held[:, :2].mean(axis=1), held[:, 2]))
        films = [held[self.film == k].mean(axis=0) for k in np.unique(self.film)]
        return np.array([held.mean(axis=0), np.std(films, axis=0, ddof=1) / math.sqrt(len(films))])

    @property
    def outside(self) -> list[str]:
        """What is not covered as it should be, by more than two standard errors.

        Where nearly all is held, films hardly scatter: the error is at least that of a share at the limit.
        """
        films = len(np.unique(self.film))
        found = []
        for what, share, chance in zip(("u and v", "angle"), *self.coverage, strict=True):
            limit = min(max(share, LEAST_COVERED), MOST_COVERED)
            error = max(chance, math.sqrt(limit * (1.0 - limit) / films))
            if abs(share - limit) > 2.0 * error:
                found.append(f"{self.name}: {what}")
        return found

    @property
    def ratio(self) -> Floats:
        """(3,) RMS of errors over their standard deviations."""
        return np.asarray(np.sqrt(np.mean((self.error / self.sigma) ** 2, axis=0)))

    @property
    def rms(self) -> Floats:
        """(3,)"""
        return np.asarray(np.sqrt((self.error**2).mean(axis=0)))

    @property
    def worst(self) -> Floats:
        """(3,)"""
        return np.asarray(np.abs(self.error).max(axis=0))


def motion(rng: Random, count: int) -> Floats:
    """(count, 3) poses in m and rad: at rest, then pushed along an arc, at any orientation."""
    start = np.array([*rng.uniform(-2.5e-4, 2.5e-4, 2), rng.uniform(-math.pi, math.pi)])
    turn = rng.uniform(-0.018, 0.018)
    speed = rng.uniform(0.6e-6, 15e-6)
    heading = math.atan2(-start[1], -start[0]) + rng.uniform(-0.7, 0.7)
    step = np.maximum(np.arange(count) - REST, 0)[:, None]
    way = np.array([speed * math.cos(heading), speed * math.sin(heading), turn])
    return np.asarray(start + step * way)


def hidden(scene: Scene, tip: Floats, shape: tuple[int, int]) -> Bytes:
    """What the probe's flanks hide, drawn here from its geometry, some px wider."""
    probe, mask = scene.probes[0], np.zeros(shape, np.uint8)
    way = np.array([math.cos(probe.direction), math.sin(probe.direction)])
    across = np.array([-way[1], way[0]])
    s = np.linspace(-1.2 * probe.tip_radius, 3e-3, 40)[:, None]
    half = np.minimum(probe.tip_radius + np.tan(probe.half_angle) * np.maximum(s, 0.0), 125e-6)
    half = half + probe.defocus * np.maximum(s, 0.0) + 3.0 * PIXEL
    ring = np.concatenate((tip + s * way + half * across, (tip + s * way - half * across)[::-1]))
    corners = np.round(project(scene.optics, ring)).astype(np.int32)
    return np.asarray(cv2.fillPoly(mask, [corners], 255), dtype=np.uint8)


def tip_at(pose: Floats, scene: Scene, along: float) -> Floats:
    """(2,) centre of a tip in contact with the long side that the shaft comes from."""
    probe = scene.probes[0]
    c, s = math.cos(pose[2]), math.sin(pose[2])
    side = math.copysign(1.0, -s * math.cos(probe.direction) + c * math.sin(probe.direction))
    local = np.array([along, side * (0.5 * WIDTH + probe.tip_radius)])
    return np.asarray(pose[:2] + np.array([[c, -s], [s, c]]) @ local)


def filmed(make: Callable[[Random], Scene], rng: Random, count: int) -> Iterator[Frame]:
    """Render ``count`` frames of one scene and track them."""
    scene, poses = make(rng), motion(rng, count)
    along = rng.uniform(-0.3, 0.3) * LENGTH
    tracker = PartTracker(BODY)
    for k, pose in enumerate(poses):
        tips, mask = np.zeros((0, 2)), None
        if scene.probes:
            tips = tip_at(pose, scene, along)[None]
            mask = hidden(scene, tips[0], (480, 640))
        image = render(scene, pose, tips, rng, time=k / 30.0)
        truth = np.append(project(scene.optics, pose[:2]), scene.optics.rotation - pose[2])
        begin = time.process_time()
        if k == 0:
            sighting = tracker.first(image, np.array([np.nan, np.nan, truth[2]]), mask)
        else:
            sighting = tracker.next(image, mask)
        yield Frame(truth, sighting, time.process_time() - begin, k > LEARNING)


def measured(name: str, rng: Random, films: int, count: int) -> Result:
    """Errors over ``films`` films of a condition with ``count`` frames each."""
    frames = [(k, f) for k in range(films) for f in filmed(CONDITIONS[name], rng, count)]
    seen = [(k, f) for k, f in frames if f.sighting.found]
    error = np.array([f.sighting.pose - f.truth for _, f in seen]).reshape(-1, 3)
    sigma = np.array([np.sqrt(np.diag(f.sighting.covariance)) for _, f in seen]).reshape(-1, 3)
    return Result(
        name,
        error,
        sigma,
        np.array([k for k, _ in seen]),
        len(frames) - len(seen),
        np.array([f.seconds for _, f in frames if f.learned]),
    )


def together(results: list[Result]) -> Result:
    """All conditions in one."""
    return Result(
        "all",
        np.concatenate([r.error for r in results]),
        np.concatenate([r.sigma for r in results]),
        np.concatenate([1000 * k + r.film for k, r in enumerate(results)]),
        sum(r.lost for r in results),
        np.concatenate([r.seconds for r in results]),
    )


def pushing(rng: Random) -> tuple[Scene, Floats, Floats]:
    """A scene, poses and tips (TIP_FRAMES, 2) m: a probe comes, meets the long side and goes on."""
    pose = np.array([*rng.uniform(-1.5e-4, 1.5e-4, 2), rng.uniform(-math.pi, math.pi)])
    outward = rng.choice([-1.0, 1.0]) * np.array([-math.sin(pose[2]), math.cos(pose[2])])
    direction = math.atan2(outward[1], outward[0]) + rng.uniform(-0.8, 0.8)
    probe = Probe(
        direction=direction,
        half_angle=rng.uniform(0.07, 0.11),
        defocus=rng.uniform(0.02, 0.04),
        brightness=rng.uniform(0.05, 0.18),
        highlight=rng.uniform(0.15, 0.45),
    )
    scene = _scene(rng, probes=(probe,))
    touching = tip_at(pose, scene, rng.uniform(-0.3, 0.3) * LENGTH)
    gap = rng.uniform(30e-6, 120e-6) - rng.uniform(3e-6, 8e-6) * np.arange(TIP_FRAMES)
    shaft = np.array([math.cos(direction), math.sin(direction)]) / math.cos(
        direction - math.atan2(outward[1], outward[0])
    )
    pushed = np.minimum(gap, 0.0)[:, None] * outward
    tips = touching + np.maximum(gap, 0.0)[:, None] * shaft + pushed
    return scene, np.column_stack((pose[:2] + pushed, np.full(TIP_FRAMES, pose[2]))), tips


def apart(outline: Floats, tip: Floats) -> float:
    """Distance in px of a tip (2,) from an outline (V, 2), negative inside."""
    place = (float(tip[0]), float(tip[1]))
    return -cv2.pointPolygonTest(outline.astype(np.float32), place, True)


def tip_errors(rng: Random) -> tuple[Floats, Floats, Floats]:
    """Errors (n, 2) px along and across a tip in one film, the standard deviations stated, and the least (3,).

    These are along the needle: of one frame, its look being known, and of what is alike in the film, it being not,
    if the tip were clear of the part in all frames, and by the frames alone in which it is.
    """
    scene, poses, tips = pushing(rng)
    truth = project(scene.optics, tips)
    part = PartTracker(BODY)
    probe: ProbeTracker | None = None
    outline: Floats | None = None
    found: list[Tip] = []
    clear = 0
    for k, pose in enumerate(poses):
        image = render(scene, pose, tips[k][None], rng, time=k / 30.0)
        if probe is None:
            start = truth[0] + rng.uniform(-1.5, 1.5, 2)
            probe = ProbeTracker(
                "probe", needle_at(image, start, scene.probes[0].tip_radius / PIXEL)
            )
            guess = np.array([np.nan, np.nan, scene.optics.rotation - pose[2]])
            seen = part.first(image, guess, probe.mask(image.shape))
            outline = placed(BODY, seen.pose)
            found.append(probe.first(image, outline))
        else:
            found.append(probe.next(image, outline))
            outline = placed(BODY, part.next(image, probe.mask(image.shape)).pose)
        probe.remember(image, found[-1], outline)
        clear += apart(outline, truth[k]) >= CLEAR
    assert probe is not None
    said = probe.places(found)
    way = (
        project(
            scene.optics,
            tips[0]
            + 1e-4
            * np.array([math.cos(scene.probes[0].direction), math.sin(scene.probes[0].direction)]),
        )
        - truth[0]
    )
    axes = np.array([way, [-way[1], way[0]]]) / np.hypot(*way)
    error = (said.tips - truth) @ axes.T
    sigma = np.sqrt(np.einsum("ki,tij,kj->tk", axes, said.covariances, axes))
    alike = [least_alike(scene, tips[0], count) for count in (TIP_FRAMES, max(clear, 1))]
    return error, sigma, np.array([least_along(scene, tips[0]), *alike])


def row(r: Result) -> str:
    """One line of the table."""
    degrees = math.degrees
    cover = " / ".join(f"{100 * c:.0f} ± {100 * e:.0f}" for c, e in r.coverage.T)
    ratio = " / ".join(f"{k:.2f}" for k in r.ratio)
    return (
        f"| {r.name} | {len(r.error) + r.lost} | {r.lost} | {r.rms[0]:.3f} | {r.rms[1]:.3f} | "
        f"{degrees(r.rms[2]):.4f} | {r.worst[:2].max():.2f} | {degrees(r.worst[2]):.3f} | {cover} | "
        f"{ratio} | {1e3 * np.median(r.seconds):.2f} |"
    )


HEAD = """# Accuracy of the part tracker

Rendered video of a 1616 x 837 um part at 5.26 um/px, 640 x 480, noise, blur, texture, meniscus,
compression and the direction of the light drawn at random for every film; the part rests, then
moves and turns. Errors against the rendered pose. "Coverage": share of the 90 % intervals of u and v, which are alike
as the part lies at any angle, and of the angle that contain the truth; it should be 85 to 95 %. An error is much alike
through a film, so each film is one draw: the standard error is from the scatter of the {films} films' own shares; "outside" below
takes at least that of a share at the limit, as films hardly scatter where all of them are held.
"Error / sigma": RMS of errors over their stated standard deviations, of u, v and angle; 1 is right, and few films that
are far off weigh much.
"ms": processor time of the tracker a frame, median, one core, once the face is learned. The part is in sight
in every frame, so "no pose" should be 0.

| condition | frames | no pose | RMS u, px | RMS v, px | RMS angle, deg | worst, px | worst, deg | coverage u and v / angle, % | error / sigma | ms |
|---|---|---|---|---|---|---|---|---|---|---|
"""
TIPS_HEAD = """
A probe with a tip of 12.5 um radius comes to the part and pushes it, {films} films of {frames} frames, its taper,
brightness and defocus drawn at random too; errors along and across its axis. "Alike in a film": RMS of the
films' mean errors. "Least possible along": RMS over the films of the Cramer-Rao bound of one frame, below which no
unbiased estimate gets: the noise alone, without compression, of a needle before film whose look and shape are known
exactly; only the film's brightness and its slopes about the tip are not. "Least possible alike": the same of the mean
of {frames} frames if the needle's taper, defocus, direction and blur are not known, nor how bright it is across and
the film about it is as a function of the distance, and the tip were clear of the part in all of them. "By clear
frames": by those frames of the film alone in which it is, by {clear:.0f} px; the others tell less than one of these.

| tip | frames | no place | RMS along, px | least possible along, px | RMS across, px | along, alike in a film, px | least possible alike, px | by clear frames, px | coverage along / across, % | error / sigma |
|---|---|---|---|---|---|---|---|---|---|---|
"""


def tip_row(films: list[tuple[Floats, Floats, Floats]]) -> str:
    """One line of the table of tips, from errors and standard deviations (n, 2) px of each film, and the least along."""
    kept = [
        (e[seen], s[seen])
        for e, s, _ in films
        for seen in [np.isfinite(e).all(axis=1)]
        if seen.any()
    ]
    least, common, clear = np.sqrt(np.mean([bound**2 for _, _, bound in films], axis=0))
    error = np.concatenate([e for e, _ in kept])
    pull = error / np.concatenate([s for _, s in kept])
    along, across = np.sqrt((error**2).mean(axis=0))
    alike = math.sqrt(np.mean([e[:, 0].mean() ** 2 for e, _ in kept]))
    frames = sum(len(e) for e, *_ in films)
    cover = " / ".join(f"{100 * c:.0f}" for c in (np.abs(pull) < NORMAL_90).mean(axis=0))
    ratio = " / ".join(f"{k:.2f}" for k in np.sqrt((pull**2).mean(axis=0)))
    return (
        f"| pushing | {frames} | {frames - len(error)} | {along:.3f} | {least:.3f} | "
        f"{across:.3f} | {alike:.3f} | {common:.3f} | {clear:.3f} | "
        f"{cover} | {ratio} |"
    )


def page(results: list[Result], tips: list[tuple[Floats, Floats, Floats]]) -> str:
    """The tables in Markdown, of conditions and of films of tips, as many of either kind."""
    lines = [row(r) for r in (*results, together(results))]
    outside = [what for r in results for what in r.outside]
    told = "; ".join(outside) if outside else "none"
    parts = [
        HEAD.format(films=len(tips)),
        "\n".join(lines),
        f"\n\nOutside of 85 to 95 % by more than two standard errors: {told}.\n",
        TIPS_HEAD.format(films=len(tips), frames=TIP_FRAMES, clear=CLEAR),
        tip_row(tips),
    ]
    return "".join(parts) + "\n"


def _condition(name: str, seed: np.random.SeedSequence, films: int, count: int) -> Result:
    cv2.setNumThreads(1)
    return measured(name, np.random.default_rng(seed), films, count)


def _tips(seed: np.random.SeedSequence) -> tuple[Floats, Floats, Floats]:
    cv2.setNumThreads(1)
    return tip_errors(np.random.default_rng(seed))


def main() -> None:
    """Run the campaign and write the tables."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--films", type=int, default=60, help="films a condition")
    parser.add_argument("--film", type=int, default=16, help="frames a film")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--jobs", type=int, default=1, help="processes")
    parser.add_argument("--out", type=Path, required=True)
    given = parser.parse_args()
    *seeds, last = np.random.SeedSequence(given.seed).spawn(len(CONDITIONS) + 1)
    with ProcessPoolExecutor(given.jobs) as pool:
        running = [
            pool.submit(_condition, name, seed, given.films, given.film)
            for name, seed in zip(CONDITIONS, seeds, strict=True)
        ]
        tips = list(pool.map(_tips, last.spawn(given.films)))
        results = [one.result() for one in running]
    given.out.parent.mkdir(parents=True, exist_ok=True)
    given.out.write_text(page(results, tips), encoding="utf-8")


if __name__ == "__main__":
    main()
