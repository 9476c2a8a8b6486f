"""A campaign of chunks that go wrong on demand, and the process that a test kills."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

from meso_robust.campaigns.document import Campaign
from meso_robust.campaigns.executor import Processes
from meso_robust.campaigns.kind import Part
from meso_robust.campaigns.provenance import code
from meso_robust.campaigns.store import NAME, Store
from meso_robust.campaigns.work import carry_out
from tests.campaigns.faults import SIZE, do


def campaign(
    chunks: int = 12, given: dict[str, Any] | None = None, limit: float = 60.0
) -> Campaign:
    """A campaign of one part; its kind only says how many chunks there are."""
    asked = {
        "name": "work",
        "kind": "monte-carlo",
        "executions": chunks * SIZE,
        "chunk": SIZE,
        "engine": "events",
    }
    part = Part(
        name="work", kind="monte-carlo", seed=7, confidence=0.95, asked=asked, given=given or {}
    )
    return Campaign(
        name="faulty", seed=7, confidence=0.95, chunk_limit_s=limit, parts=(part,), text=""
    )


def main() -> None:
    """Carry it out in the folder, of so many chunks, that the command line names; print each kept one."""
    folder, chunks = Path(sys.argv[1]), int(sys.argv[2])
    asked = campaign(chunks, {"seconds": 0.02})
    store = Store(folder / NAME, asked.values, code())
    for step in carry_out(asked, store, Processes(2), do):
        sys.stdout.write(f"{step.chunk}\n")
        sys.stdout.flush()
    store.close()
