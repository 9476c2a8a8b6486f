"""Property campaign of the simulator: random moves, physical laws checked by plain NumPy.

``python -m reports.simulator.campaign --runs 100000 --out reports/simulator/campaign.md``

Each run has a seed, from which it is drawn and can be drawn again. Laws, each with the measure that
is tabulated:

penetration
    Depth of probes and fixture in the part at the end of every step, over what the linear step may
    leave: a turn φ with slip and travel d leaves about φ (d + φ R), R the radius of the part; a part
    or tip that goes round a corner within a step, a further share `CORNER` of the step.
balance
    Sum of the wrenches of the probes less that of the film, over the largest; without a fixture.
energy
    Dissipation in the film in excess of the work of the tips, over the work; a gap that is taken
    back, by at most the penetration before, does work.
cone
    Distance of a probe's force from the sum of the friction cones of all features that are within
    reach of it, over the force.
"""

from __future__ import annotations

import argparse
import os
from collections import Counter
from collections.abc import Iterable
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import numpy.typing as npt
from scipy.optimize import nnls

from meso_robust.simulator import (
    Flat,
    Outcome,
    Push,
    PushResult,
    simulate,
)
from meso_robust.simulator.tips import Tip
from reports.simulator.jam import jam_is_real
from tests.simulator.draws import draw, tip_corners
from tests.simulator.oracle import placed, signed_distance, turned

F = npt.NDArray[np.float64]

SLACK = 1e-9  # of a step: rounding
CORNER = 0.25
"""Share of a step that a corner may be cut by: its half-plane is chosen at the start of the step."""


@dataclass
class Report:
    """Outcome and measures of one run."""

    seed: int
    outcome: int = 0
    kind: str = ""
    measures: dict[str, float] = field(default_factory=dict)
    jam: str = ""


def at_steps(push: Push) -> PushResult:
    """The push with a record at the end of every step."""
    return simulate(push, record=push.steps, workers=1)


def depths(push: Push, result: PushResult) -> F:
    """(R,) deepest overlap of any probe or solid with the part at each instant."""
    path, deepest = result.path[0], np.zeros(result.path.shape[1])
    for p, shape in enumerate(push.shapes):
        body = _in_body(path, result.tips[0, :, p])
        if isinstance(shape, Flat):
            deepest = np.maximum(
                deepest, _overlap(push.vertices, path, shape.corners, result.tips[0, :, p])
            )
        else:
            deepest = np.maximum(deepest, shape.radius - signed_distance(push.vertices, body))
    for solid in push.fixture.outlines:
        deepest = np.maximum(
            deepest, _overlap(push.vertices, path, solid, np.zeros_like(path[:, :2]))
        )
    return deepest


def _in_body(path: F, points: F) -> F:
    to = points - path[:, :2]
    cos, sin = np.cos(path[:, 2]), np.sin(path[:, 2])
    return np.column_stack([cos * to[:, 0] + sin * to[:, 1], cos * to[:, 1] - sin * to[:, 0]])


def _in_world(path: F, point: F) -> F:
    cos, sin = np.cos(path[:, 2]), np.sin(path[:, 2])
    return path[:, :2] + np.column_stack(
        [cos * point[0] - sin * point[1], sin * point[0] + cos * point[1]]
    )


def _overlap(vertices: F, path: F, solid: F, origin: F) -> F:
    """Depth of corners of either in the other; a tip corner between corners shows as well."""
    deepest = np.zeros(len(path))
    for corner in vertices:
        points = _in_world(path, corner) - origin
        deepest = np.maximum(deepest, -signed_distance(solid, points))
    for corner in solid:
        deepest = np.maximum(deepest, -signed_distance(vertices, _in_body(path, corner + origin)))
    return deepest


def allowed(push: Push, result: PushResult) -> F:
    """(R,) depth that linear steps may leave, plus `CORNER` of a step."""
    path = result.path[0]
    turn = np.append(0.0, np.abs(np.diff(path[:, 2])))
    turn[1:] = np.maximum(turn[1:], turn[:-1])
    way = np.append(0.0, np.hypot(*np.diff(path[:, :2], axis=0).T))
    size = float(np.hypot(*push.vertices.T).max())
    return np.asarray(turn * (push.step + way + turn * size) + (CORNER + SLACK) * push.step)


def measure(push: Push, result: PushResult, report: Report) -> None:
    """Write how far each law is from being broken."""
    path, force = result.path[0], result.forces[0]
    steps = np.flatnonzero(np.any(np.diff(result.tips[0], axis=0) != 0, axis=(1, 2)))
    last = steps[-1] + 1 if len(steps) else 0
    deep = depths(push, result)[: last + 1]
    report.measures["penetration"] = float(np.max(deep / allowed(push, result)[: last + 1]))
    report.measures["depth_steps"] = float(np.max(deep)) / push.step
    if len(steps) == 0:
        return
    dt = float(np.diff(push.times[0])[0]) / push.steps
    rho = push.support.tables().film[0, 5]
    move = np.diff(path, axis=0)[:last]
    f = force[1 : last + 1]
    tip_way = np.diff(result.tips[0], axis=0)[:last]
    drag = move * [1, 1, rho] / dt
    size = float(np.hypot(*push.vertices.T).max())
    if not push.fixture.outlines:
        rest = f.sum(axis=1) - drag[:, :2]
        scale = np.abs(f).sum(axis=(1, 2)).max() + 1e-30
        report.measures["balance"] = float(np.max(np.hypot(*rest.T)) / scale)
    work = np.sum(f * tip_way, axis=(1, 2))
    lost = np.sum(drag * move, axis=1)
    regained = np.abs(f).sum(axis=(1, 2)) * deep[:last] * 1.5
    flow = np.abs(f).sum(axis=(1, 2)) * push.step
    if not push.fixture.outlines:
        report.measures["energy"] = float(
            np.max(
                (lost - work - regained) / np.maximum(flow, 1e-6 * flow.max() + 1e-30),
                initial=-np.inf,
            )
        )
    report.measures["cone"] = max(
        _outside_cone(push, result, p, k, size)
        for k in {int(i) for i in np.linspace(0, last - 1, 12)}
        for p in range(len(push.shapes))
    )


def _outside_cone(push: Push, result: PushResult, p: int, k: int, size: float) -> float:
    """Share of the force of probe p in step k that no sum of cones of near features gives."""
    force = result.forces[0, k + 1, p]
    if np.hypot(*force) < 1e-12:
        return 0.0
    # A part that is squeezed out moves farther in a step than the tips.
    moved = np.abs(result.path[0, k + 1] - result.path[0, k]) @ [1.0, 1.0, size]
    shape, tip = push.shapes[p], result.tips[0, k, p]
    normals = near_normals(push, result.path[0, k], shape, tip, size, moved)
    if len(normals) == 0:
        return 1.0
    # Contacts are turned into the world at an angle ahead by half the turn of the last step.
    ahead = 0.5 * (result.path[0, k, 2] - result.path[0, k - 1, 2]) if k else 0.0
    normals = normals @ turned(ahead).T
    side = np.column_stack([-normals[:, 1], normals[:, 0]])
    mu = push.friction[0, p]
    edges = np.vstack([normals + mu * side, normals - mu * side]).T
    return float(nnls(edges, force / np.hypot(*force))[1])


def near_normals(push: Push, pose: F, shape: Tip, where: F, size: float, moved: float) -> F:
    """Directions in which a tip may push: normals of near edges, and from corner to corner."""
    world, corners = placed(push.vertices, pose), tip_corners(shape, where)
    reach = 3 * push.step + shape.radius + moved
    found: list[F] = []
    for own, other, sign in ((world, corners, -1.0), (corners, world, 1.0)):
        if len(own) < 3:
            continue
        for a, b in zip(own, np.roll(own, -1, axis=0), strict=True):
            u = (b - a) / np.hypot(*(b - a))
            share = np.clip((other - a) @ u, 0, np.hypot(*(b - a)))
            if np.min(np.hypot(*(other - a - share[:, None] * u).T)) <= reach:
                found.append(sign * np.array([u[1], -u[0]]))
    for c in corners:
        for v in world:
            d = float(np.hypot(*(v - c)))
            if 0.0 < d <= reach:
                found.append((v - c) / d)
    return np.array(found).reshape(-1, 2)


def check(seed: int) -> Report | None:
    """Draw, push and check one run."""
    push = draw(seed)
    if push is None:
        return None
    result = at_steps(push)
    names = "+".join(sorted(type(shape).__name__ for shape in push.shapes))
    report = Report(seed, int(result.outcomes[0]), names)
    measure(push, result, report)
    if report.outcome == Outcome.JAM:
        report.jam = jam_is_real(push, result)
    return report


def campaign(seeds: Iterable[int]) -> list[Report]:
    """All runs of some seeds."""
    return [report for seed in seeds if (report := check(seed)) is not None]


def table(reports: list[Report]) -> str:
    """Outcomes, and the worst of each law with its seed, in Markdown."""
    counts = Counter(report.outcome for report in reports)
    lines = [f"{len(reports)} runs", "", "| outcome | runs |", "| :-- | --: |"]
    lines += [f"| {Outcome(k).name} | {counts[k]} |" for k in sorted(counts)]
    jams = Counter(report.jam for report in reports if report.jam)
    lines += [f"| jam: {key} | {value} |" for key, value in sorted(jams.items())]
    false = [report.seed for report in reports if report.jam == "FALSE"]
    lines += ["", f"Seeds of jams that are none: {false or 'none'}", ""]
    lines += ["| law | worst | seed |", "| :-- | --: | --: |"]
    for name in ("penetration", "depth_steps", "balance", "energy", "cone"):
        have = [report for report in reports if name in report.measures]
        if have:
            worst = max(have, key=lambda report: report.measures[name])
            lines.append(f"| {name} | {worst.measures[name]:.3g} | {worst.seed} |")
    return "\n".join(lines) + "\n"


def main() -> None:
    """Run the campaign on all cores and write its table."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--runs", type=int, default=2000)
    parser.add_argument("--first", type=int, default=0, help="first seed")
    parser.add_argument("--out", type=Path)
    args = parser.parse_args()
    seeds = range(args.first, args.first + args.runs)
    cores = os.cpu_count() or 1
    with ProcessPoolExecutor(cores) as pool:
        parts = list(pool.map(campaign, [seeds[i::cores] for i in range(cores)]))
    text = "# Property campaign of the simulator\n\n" + table([r for part in parts for r in part])
    if args.out is None:
        os.write(1, text.encode())
    else:
        args.out.parent.mkdir(parents=True, exist_ok=True)
        args.out.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
