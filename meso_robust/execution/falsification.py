"""Trying to break what a certificate claims: bulk execution of a plan by either engine.

The work is cut into chunks, each a pure function of a seed. Totals of finished chunks are appended
to a file, one JSON object a line, so that a campaign can be ended at any time and goes on from there.
"""

from __future__ import annotations

import hashlib
import json
import time
from collections.abc import Iterable, Iterator
from concurrent.futures import Future, ProcessPoolExecutor, as_completed
from dataclasses import asdict, dataclass, field, replace
from multiprocessing import get_context
from pathlib import Path
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

from meso_robust.execution.ascent import shaken
from meso_robust.execution.claims import Claims, slips
from meso_robust.execution.engines import Engine
from meso_robust.execution.judging import Judged, judge
from meso_robust.execution.replay import Feedback, limits
from meso_robust.planning.document import PlanDocument

Floats = npt.NDArray[np.float64]
Kind = Literal["uniform", "corners", "mixed", "adversarial"]
Extremes = list[list[list[float]]]

KINDS: tuple[Kind, ...] = ("uniform", "corners", "mixed", "adversarial")
MOST_KEPT = 3  # rows kept of each chunk's broken claims


@dataclass(frozen=True, slots=True, kw_only=True)
class Chunk:
    """Some runs of a campaign; the same chunk always draws the same rows."""

    engine: Engine
    kind: Kind
    index: int
    runs: int
    seed: int = 0

    @property
    def key(self) -> tuple[str, str, int]:
        """What tells it from all other chunks of its campaign."""
        return self.engine, self.kind, self.index


@dataclass(frozen=True, slots=True, kw_only=True)
class Totals:
    """What came of a chunk, or of several added up; M moves."""

    runs: int = 0
    seconds: float = 0.0
    unfinished: int = 0
    """Runs that the engine could not finish."""
    repeated: int = 0
    """Runs of the stepper that were repeated at smaller steps."""
    broken: dict[str, int] = field(default_factory=dict)
    """Runs that break a claim, by its name; zero too."""
    after: Extremes = field(default_factory=list)
    """(M, 2, 3) least and largest pose after each move (m, m, rad)."""
    during: Extremes = field(default_factory=list)
    """(M, 2, 3) the same of all poses seen during each move."""
    slip: list[float] = field(default_factory=list)
    """(M,) largest slip of the first contact of each move, m (of a rotation none is excluded)."""
    rows: list[list[str]] = field(default_factory=list)
    """Some rows that break a claim, hexadecimal."""

    def plus(self, other: Totals) -> Totals:
        """Both together."""
        names = {**self.broken, **other.broken}
        return Totals(
            runs=self.runs + other.runs,
            seconds=self.seconds + other.seconds,
            unfinished=self.unfinished + other.unfinished,
            repeated=self.repeated + other.repeated,
            broken={n: self.broken.get(n, 0) + other.broken.get(n, 0) for n in names},
            after=_wider(self.after, other.after),
            during=_wider(self.during, other.during),
            slip=[max(pair) for pair in zip(self.slip, other.slip, strict=True)]
            if self.slip and other.slip
            else self.slip or other.slip,
            rows=[*self.rows, *other.rows],
        )


def _wider(one: Extremes, other: Extremes) -> Extremes:
    if not one or not other:
        return one or other
    a, b = np.array(one), np.array(other)
    both = np.stack([np.minimum(a[:, 0], b[:, 0]), np.maximum(a[:, 1], b[:, 1])], axis=1)
    return [[[float(v) for v in end] for end in move] for move in both]


def drawn(chunk: Chunk, low: Floats, high: Floats, seeds: Floats) -> Floats:
    """(N, D) rows of a chunk.

    ``mixed`` puts each coordinate at an end or within its range, with equal chances;
    ``adversarial`` starts from ``seeds`` (S, D) and draws some coordinates anew.
    """
    entropy = [chunk.seed, KINDS.index(chunk.kind), int(chunk.engine == "events"), chunk.index]
    rng = np.random.default_rng(entropy)
    if chunk.kind == "adversarial":
        return shaken(np.clip(seeds, low, high), low, high, chunk.runs, rng)
    share = rng.random((chunk.runs, len(low)))
    if chunk.kind != "uniform":
        at_end = chunk.kind == "corners" or rng.random(share.shape) < 0.5
        share = np.where(at_end, np.rint(share), share)
    return np.clip(low + share * (high - low), low, high)


def execute(player: Feedback, claims: Claims, chunk: Chunk, seeds: Floats) -> Totals:
    """Run a chunk and hold it against the claims."""
    begun = time.perf_counter()
    rows = drawn(chunk, *limits(player), seeds)
    judged = judge(replace(player, engine=chunk.engine), claims, rows)
    return replace(totals(judged, claims, rows), seconds=time.perf_counter() - begun)


def totals(judged: Judged, claims: Claims, rows: Floats) -> Totals:
    """Counts and extremes of runs; a run that ended early counts up to the move before."""
    runs = judged.runs
    after, during, slip = [], [], []
    for k, move in enumerate(runs.moves):
        done = runs.failed_in > k
        after.append(_ends(move.after[done]))
        during.append(_ends(move.path[done].reshape(-1, 3)))
        slip.append(float(slips(move, claims.half)[done].max(initial=0.0)))
    worst = np.flatnonzero(judged.any_broken)[:MOST_KEPT]
    return Totals(
        runs=len(rows),
        unfinished=int(judged.unfinished.sum()),
        repeated=judged.repeated,
        broken={name: int(flags.sum()) for name, flags in judged.broken.items()},
        after=after,
        during=during,
        slip=slip,
        rows=[[float(value).hex() for value in rows[i]] for i in worst],
    )


def _ends(poses: Floats) -> list[list[float]]:
    low, high = poses.min(axis=0, initial=np.inf), poses.max(axis=0, initial=-np.inf)
    return [[float(value) for value in low], [float(value) for value in high]]


def identity(plan: PlanDocument) -> str:
    """A hash of the task and of the policy, whatever else its file holds."""
    policy = [rule.model_dump(mode="json", exclude_defaults=True) for rule in plan.policy]
    text = json.dumps([plan.task_hash, policy], sort_keys=True)
    return hashlib.sha256(text.encode()).hexdigest()


def boxes_digest(claims: Claims) -> str:
    """A hash of all boxes and tubes: tells what the runs of a chunk were held against."""
    digest = hashlib.sha256()
    for box in (*claims.posts, *claims.tubes):
        digest.update(b"none" if box is None else np.ascontiguousarray(box).tobytes())
    return digest.hexdigest()


@dataclass(frozen=True, slots=True, kw_only=True)
class Ledger:
    """The file of a campaign: one JSON object a line, only ever appended to."""

    path: Path
    identity: str
    """Of the plan; lines of other plans are refused."""

    def lines(self, what: str) -> Iterator[dict[str, Any]]:
        """All whole lines about ``what``.

        Raises
        ------
        ValueError
            A line is about another plan.
        """
        if not self.path.exists():
            return
        for number, text in enumerate(self.path.read_text(encoding="utf-8").splitlines(), 1):
            try:
                line = json.loads(text)
            except ValueError:
                continue  # a line that was being written when the campaign was ended
            if line["plan"] != self.identity:
                raise ValueError(
                    f"{self.path}, line {number}: plan {line['plan'][:12]}; must be "
                    f"{self.identity[:12]}, the plan that is run; give another file for the totals"
                )
            if line["what"] == what:
                yield line

    def add(self, what: str, values: dict[str, Any]) -> None:
        """Append a line."""
        text = json.dumps({"what": what, "plan": self.identity, **values})
        # a line cut short must not swallow this one
        whole = not self.path.exists() or self.path.read_bytes()[-1:] in (b"", b"\n")
        with self.path.open("a", encoding="utf-8") as file:
            file.write(("" if whole else "\n") + text + "\n")

    def chunks(self) -> Iterator[tuple[Chunk, Totals, str]]:
        """Finished chunks, their totals, and the digest of the boxes they were held against."""
        for line in self.lines("chunk"):
            yield Chunk(**line["chunk"]), Totals(**line["totals"]), line["boxes"]


def missing(ledger: Ledger, wanted: Iterable[Chunk]) -> list[Chunk]:
    """Chunks that are not in the file yet."""
    done = {chunk.key for chunk, _, _ in ledger.chunks()}
    return [chunk for chunk in wanted if chunk.key not in done]


_Work = tuple[Feedback, Claims, Floats]


def run_chunks(
    ledger: Ledger, work: _Work, wanted: Iterable[Chunk], workers: int = 1
) -> Iterator[Chunk]:
    """Run all chunks that the file does not hold yet; yields each when its totals are written.

    Parameters
    ----------
    ledger
        The campaign's file.
    work
        Player, claims and rows (S, D) for adversarial draws.
    wanted
        The chunks.
    workers
        Processes; 1 runs everything in this one.
    """
    boxes = boxes_digest(work[1])

    def note(chunk: Chunk, found: Totals) -> Chunk:
        ledger.add("chunk", {"boxes": boxes, "chunk": asdict(chunk), "totals": asdict(found)})
        return chunk

    left = missing(ledger, wanted)
    if workers == 1:
        for chunk in left:
            yield note(chunk, execute(work[0], work[1], chunk, work[2]))
        return
    with ProcessPoolExecutor(workers, mp_context=get_context("spawn")) as pool:
        futures: dict[Future[Totals], Chunk] = {
            pool.submit(execute, work[0], work[1], chunk, work[2]): chunk for chunk in left
        }
        for future in as_completed(futures):
            yield note(futures[future], future.result())
