"""How campaigns scale: ``python -m reports.benchmarks.campaigns [--out reports/benchmarks/campaigns.md]``.

The same part of a campaign (the paper's plan, drawn uniformly, every run held against every claim of
its certificate) is done by one process, by two, and by the workers of a Dask cluster on this machine,
one of which is killed on the way. Rates are those between the first and the last result; what starting
costs is told apart.
"""

from __future__ import annotations

import argparse
import json
import os
import signal
import sys
import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from meso_robust.campaigns.answer import answered
from meso_robust.campaigns.cluster import Cluster
from meso_robust.campaigns.document import Campaign, read_campaign
from meso_robust.campaigns.encoding import part_text, result_text
from meso_robust.campaigns.executor import Crew, Processes
from meso_robust.campaigns.falsify.section import EVENTS_CHUNK
from meso_robust.campaigns.provenance import code, machine
from meso_robust.campaigns.store import NAME, Store
from meso_robust.campaigns.work import carry_out
from tests.campaigns.local_cluster import running

ROOT = Path(__file__).parents[2]
PLAN = ROOT / "reports" / "paper_task" / "plan.json"
GOAL = 10**10
"""Executions that the page extrapolates to."""
WORKERS = 3
"""Of the Dask cluster."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Measured:
    """One way of doing the campaign."""

    name: str
    workers: int
    wall: float
    """s, from the call to the last result."""
    start: float
    """s, to the first result."""
    rate: float
    """Executions/s between the first and the last result."""
    digest: str
    """Of the totals."""
    store: int
    """Bytes of the store."""
    chunks: int


def campaign(folder: Path, executions: int, engine: str) -> Campaign:
    """A part that is nothing but draws held against the claims."""
    path = folder / "campaign.toml"
    path.write_text(
        'schema = "meso-robust/campaign/1"\nname = "scale"\n[[part]]\nname = "draws"\n'
        f'kind = "falsify"\nplan = {json.dumps(str(PLAN))}\nengine = "{engine}"\n'
        f'methods = ["uniform"]\nexecutions = {executions}\n',
        encoding="utf-8",
    )
    return read_campaign(path)


def measured(
    asked: Campaign,
    folder: Path,
    crew: tuple[str, int, Crew],
    on_the_way: Callable[[int], None] = lambda _: None,
) -> Measured:
    """Do the campaign by a crew; ``on_the_way`` is called with the number of results so far."""
    name, workers, hands = crew
    folder.mkdir()
    store = Store(folder / NAME, asked.values, code())
    begun = time.perf_counter()
    times, runs = [], []
    for k, step in enumerate(carry_out(asked, store, hands)):
        times.append(time.perf_counter())
        runs.append(step.runs)
        on_the_way(k + 1)
    found = answered(asked, store)
    store.close()
    return Measured(
        name=name,
        workers=workers,
        wall=times[-1] - begun,
        start=times[0] - begun,
        rate=sum(runs[1:]) / (times[-1] - times[0]),
        digest=found.totals_digest,
        store=(folder / NAME).stat().st_size,
        chunks=len(times),
    )


def on_a_cluster(asked: Campaign, folder: Path) -> Measured:
    """By Dask workers, the second of which is killed when a third of the work is done."""
    with running(WORKERS) as (address, processes):
        crew = Cluster(address)
        while crew.size < WORKERS:
            time.sleep(0.1)

        def kill(done: int) -> None:
            if done == 10:
                os.killpg(processes[2].pid, signal.SIGKILL)

        name = f"Dask, {WORKERS} workers, one killed after ten chunks"
        return measured(asked, folder, (name, WORKERS, crew), kill)


def store_rate(folder: Path, asked: Campaign) -> float:
    """Rows a second that the store takes, each on the disk before the next."""
    from meso_robust.campaigns.kind import Result

    folder.mkdir()
    store = Store(folder / NAME, asked.values, code())
    text = result_text(Result(runs=1, failed=0, failures=(), values={"filler": "x" * 6000}))
    begun, count = time.perf_counter(), 2000
    for chunk in range(count):
        store.add("draws", chunk, text, 1.0, "here")
    store.close()
    return count / (time.perf_counter() - begun)


def page(
    events: tuple[Measured, ...],
    stepper: tuple[Measured, ...],
    rows: float,
    size: int,
    argument: int,
) -> str:
    """Markdown; rows/s that the store takes, executions of a chunk, bytes of a chunk's argument."""
    one, two = events[0], events[1]
    per_chunk = one.store / one.chunks
    chunks = GOAL / size
    lines = [
        "# How campaigns scale",
        "",
        "`python -m reports.benchmarks.campaigns --out reports/benchmarks/campaigns.md`, "
        f"{machine()}. Draws over the whole uncertainty box of the paper's plan (four moves), every "
        "execution held against every claim of its certificate. Rates between the first and the last "
        "result; starting a process, loading kernels and certifying the plan in it comes before.",
        "",
        *_table("Event-driven engine", events),
        "",
        *_table("LCP stepper", stepper),
        "",
        f"All totals are the same to the last bit: {_same(events)} and {_same(stepper)}.",
        "",
        f"## {GOAL:.0e} executions".replace("e+", " × 10^").replace("1 × 10^10", "10¹⁰"),
        "",
        f"At {two.rate:,.0f} executions/s on two cores, event-driven, 10¹⁰ take "
        f"**{GOAL / two.rate / 86400:.1f} days on this machine**, or {GOAL / one.rate / 3600:,.0f} core "
        f"hours: {GOAL / one.rate / 3600 / 256:.1f} h on 256 cores, {60 * GOAL / one.rate / 3600 / 4096:.0f} "
        f"min on 4,096. By the stepper it is {GOAL / stepper[0].rate / 3600:,.0f} core hours.",
        "",
        "What would break first, in this order:",
        "",
        f"1. **The number of rows.** Chunks of {size:,} make {chunks:,.0f} rows of {per_chunk / 1000:.1f} kB: "
        f"{chunks * per_chunk / 1e9:.1f} GB, which SQLite holds, but each `--resume` checks every page "
        "and adding up reads every row. Larger chunks (`chunk = 200_000`) make it a tenth.",
        f"2. **The one process that hands out and keeps.** It keeps {rows:,.0f} rows/s on this disk, and "
        f"a core makes {one.rate / size:.2f} chunks/s: it is busy from about {rows / (one.rate / size):,.0f} "
        "cores on at this chunk size. Dask's own limit, some 1,000 tasks/s, comes at about "
        f"{1000 / (one.rate / size):,.0f}.",
        f"3. **The argument of a chunk**, task and plan with every call, {argument / 1000:.1f} kB: "
        f"{argument / 1000:.1f} MB/s at 1,000 chunks/s, little for a network.",
        "4. **Doubles.** Counts are exact integers, extremes are not added up: nothing there grows with "
        "the number of executions.",
        "",
        "What 10¹⁰ executions without a failure would say: with 95 % confidence the failure "
        "probability under these draws is below 3.0 × 10⁻¹⁰. The certificate says that it is zero.",
    ]
    return "\n".join(lines) + "\n"


def _same(found: tuple[Measured, ...]) -> str:
    digests = {one.digest for one in found}
    if len(digests) > 1:
        return f"**NO: {sorted(digests)}**"
    return f"`{digests.pop()[:16]}` in {len(found)} ways of doing it"


def _table(title: str, found: tuple[Measured, ...]) -> list[str]:
    first = found[0]
    rows = [
        f"| {one.name} | {one.rate:,.0f} | {_efficiency(one, first)} | {one.start:.1f} | {one.wall:.1f} |"
        for one in found
    ]
    head = f"| {title} | executions/s | of one process's, per worker | first result, s | all, s |"
    return [head, "|---|--:|--:|--:|--:|", *rows]


def _efficiency(one: Measured, first: Measured) -> str:
    """Rate per worker; of more workers than cores, per core."""
    hands = min(one.workers, os.cpu_count() or 1)
    return f"{100 * one.rate / first.rate / hands:.0f} %"


def main() -> None:
    """Measure and write the page."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=Path)
    parser.add_argument("--events", type=int, default=1_000_000, help="executions")
    parser.add_argument("--stepper", type=int, default=60_000, help="executions")
    given = parser.parse_args()
    found = []
    with tempfile.TemporaryDirectory() as name:
        for engine, executions in (("events", given.events), ("stepper", given.stepper)):
            folder = Path(name) / engine
            folder.mkdir()
            asked = campaign(folder, executions, engine)
            crews = [(f"{n} process{'es' if n > 1 else ''}", n) for n in (1, 2)]
            ways = [
                measured(asked, folder / f"{n}", (title, n, Processes(n))) for title, n in crews
            ]
            found.append((*ways, on_a_cluster(asked, folder / "dask")))
        rows = store_rate(Path(name) / "rows", asked)
    argument = len(part_text(asked.parts[0]).encode())
    text = page(found[0], found[1], rows, EVENTS_CHUNK, argument)
    if given.out is None:
        sys.stdout.write(text)
    else:
        given.out.parent.mkdir(parents=True, exist_ok=True)
        given.out.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
