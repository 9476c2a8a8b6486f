"""``run.json``: how a live run ended, and how quick it was."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import BaseModel, ConfigDict, Field

from meso_robust.live.conductor import Phase
from meso_robust.live.exchange import Command, Outcome
from meso_robust.live.journal import Header, Turn

SCHEMA: Literal["meso-robust/run/1"] = "meso-robust/run/1"
Triple = tuple[float, float, float]


class _Section(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True, populate_by_name=True)


class LatencySection(_Section):
    """From a frame that came in to the commands that followed from it, of the frames of a run."""

    frames: int
    """How many there were."""
    median_ms: float
    """Half of them took no longer, ms."""
    p99_ms: float
    """99 % of them took no longer, ms."""
    longest_ms: float
    """ms; the first frame is searched through, the others only near the last place."""


class MadeMove(_Section):
    """A move."""

    sensed: Triple
    """x_um, y_um, theta_deg that it was decided from."""
    command: dict[str, Any]
    """As `drive` answered it."""
    carried_out: bool
    """Whether it came to its end, probes lifted."""


class RunDocument(_Section):
    """``run.json``."""

    schema_: Annotated[Literal["meso-robust/run/1"], Field(alias="schema")] = SCHEMA
    """Name and version of the format."""
    outcome: Outcome
    """done; refused (a pose that cannot be trusted, or from which nothing is proved); stopped (by the
    user); fault (of a device or the watchdog); dry_run."""
    why: str
    """In words."""
    moves: tuple[MadeMove, ...]
    """In their order."""
    last_pose: Triple | None
    """x_um, y_um, theta_deg of the last pose that could be trusted."""
    latency: LatencySection
    """How quick the loop was."""
    duration_s: float
    """On the laboratory's clock."""
    task_hash: str
    """SHA-256 of the task's values."""
    plan_hash: str
    """SHA-256 of the plan's file."""
    journal: str = "journal.jsonl"
    """The journal."""


def run_document(
    header: Header, turns: Sequence[Turn], ending: Command, latencies: Sequence[float]
) -> RunDocument:
    """What a run came to.

    Parameters
    ----------
    header, turns
        Of its journal.
    ending
        How it ended.
    latencies
        s, of each frame.

    Returns
    -------
    RunDocument
        Rounded for reading.
    """
    seen = [t.reading.seen.sight.pose for t in turns if t.reading.seen is not None]
    poses = [pose for pose in seen if pose is not None]
    moves = []
    for k, turn in enumerate(turns):
        if turn.move is not None and turn.sensed is not None:
            later = [one.phase for one in turns[k:]]
            made = Phase.RAISING.value in later and _came_back(later)
            moves.append(MadeMove(sensed=turn.sensed, command=turn.move, carried_out=made))
    times = [turn.reading.time for turn in turns]
    milliseconds = 1e3 * np.array(latencies if latencies else [0.0])
    return RunDocument(
        outcome=ending.outcome or "fault",
        why=ending.text,
        moves=tuple(moves),
        last_pose=_rounded(poses[-1]) if poses else None,
        latency=LatencySection(
            frames=len(latencies),
            median_ms=round(float(np.median(milliseconds)), 2),
            p99_ms=round(float(np.quantile(milliseconds, 0.99)), 2),
            longest_ms=round(float(milliseconds.max()), 2),
        ),
        duration_s=round(times[-1] - times[0], 3) if times else 0.0,
        task_hash=header.task_hash,
        plan_hash=header.plan_hash,
    )


def _came_back(phases: Sequence[str]) -> bool:
    """Whether what follows a move passes through raising to seeing."""
    raised = phases.index(Phase.RAISING.value)
    after = [phase for phase in phases[raised:] if phase != Phase.RAISING.value]
    return bool(after) and after[0] in (Phase.SEEING.value, Phase.ENDED.value)


def _rounded(pose: Triple) -> Triple:
    return round(pose[0], 3), round(pose[1], 3), round(pose[2], 4)
