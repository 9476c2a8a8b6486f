"""Runs of a plan in the foreign plant: the laboratory's loop and sampler, another physics."""

from __future__ import annotations

from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from meso_robust.kernels import threads
from meso_robust.laboratory.draws import Draws
from meso_robust.laboratory.engines import NOT_RECORDED, Pushed
from meso_robust.laboratory.running import Bench, Order, PlanRun, Which, by_rules, carry_out
from meso_robust.plant.kernel import COARSE, DONE, Grain, push_all
from meso_robust.plant.laws import Laws
from meso_robust.primitives.move import MoveRule
from meso_robust.primitives.setup import Setup
from meso_robust.simulator import Outcome
from meso_robust.types import Floats
from meso_robust.units import UM

SCALE = np.array([UM, UM, 1.0])
CROSS = np.array([[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]])
"""Nodes of the film: exact for a drag that is linear in speed, and no wider one way than the other."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ForeignBench(Bench):
    """The task's laboratory with the foreign plant in place of the simulator."""

    grain: Grain = COARSE

    def push(
        self, k: int, order: Order, runs: Which, poses: Floats, ways: Floats, record: int
    ) -> Pushed:
        """Pushes by the foreign plant; walls are not there."""
        count, probes = len(poses), ways.shape[2]
        which = np.arange(len(self.draws.start))[runs]
        outlines = self.outlines[which] if len(self.outlines) > 1 else self.outlines
        radii = self.radii(order)
        radii = radii[which] if len(radii) > 1 else radii
        friction = self.friction(k, order)[which]
        nodes, lays = film_of(self.setup, self.draws)
        after, endings = poses / SCALE, np.zeros(count, dtype=np.int64)
        arrays = (
            np.ascontiguousarray(np.broadcast_to(outlines, (count, *outlines.shape[1:])) / UM),
            (nodes[which], lays[which], Laws()),
            np.ascontiguousarray(ways / UM),
            np.ascontiguousarray(np.broadcast_to(radii, (count, probes)) / UM),
            np.ascontiguousarray(np.broadcast_to(friction, (count, ways.shape[1] - 1, probes))),
        )
        cuts = np.linspace(0, count, 8 * threads() + 1).astype(int)
        with ThreadPoolExecutor(threads()) as pool:
            out, pieces = (after, endings), pairwise(cuts.tolist())
            list(pool.map(lambda span: push_all(*arrays, self.grain, out, span), pieces))
        outcomes = np.where(endings == DONE, Outcome.COMPLETED, Outcome.JAM).astype(np.int8)
        return Pushed(
            poses=after * SCALE,
            outcomes=outcomes,
            path=np.zeros((count, 0, 3)),
            modes=np.zeros((count, 0, probes), dtype=np.int8),
            phases=np.full(count, NOT_RECORDED),
        )


def film_of(setup: Setup, draws: Draws) -> tuple[Floats, Floats]:
    """(N, 4, 3) nodes of the films, um, and (N, 4) their lays; see ``plant.kernel.film``."""
    count, u = len(draws.start), setup.uncertainty
    nodes = np.sqrt(0.5 * draws.film_ratio)[:, None, None] / UM * CROSS
    if draws.drag_centre is not None:
        nodes = nodes + _cut(draws.drag_centre, u.drag_centre.hi)[:, None] / UM
    nodes = np.concatenate([nodes, np.ones((count, 4, 1))], axis=2)
    lays = np.zeros((count, 4))
    if draws.lay is not None:
        whole, stage = _cut(draws.lay[:, :2], u.drag_anisotropy.hi), draws.lay[:, 2:]
        lays[:, :2], lays[:, 2:] = (1.0 - stage) * whole, stage * whole
    return nodes, lays


def _cut(vectors: Floats, longest: float) -> Floats:
    """(N, 2) vectors, those that are too long cut to the length."""
    length = np.hypot(vectors[:, 0], vectors[:, 1])
    return vectors * np.where(length > longest, longest / np.maximum(length, longest), 1.0)[:, None]


def run_foreign(
    rules: Sequence[MoveRule], setup: Setup, draws: Draws, grain: Grain = COARSE
) -> PlanRun:
    """Run a plan once for every row of the draws; see ``laboratory.running.run``."""
    bench = ForeignBench.of(setup, draws, grain=grain)
    return carry_out(by_rules(rules, setup, draws), bench, draws.start)
