"""A whole run: devices, eye, conductor, journal, and what is told of it meanwhile."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from meso_robust.laboratory.making import outline
from meso_robust.live.backends import devices_of
from meso_robust.live.conductor import Conductor, Decide, Phase
from meso_robust.live.filming import Film
from meso_robust.live.journal import Header, Journal, Turn
from meso_robust.live.loop import Glimpse, Show, Words, run_loop, stopped_by_signals
from meso_robust.live.run_document import RunDocument, run_document
from meso_robust.live.sight import Eye
from meso_robust.primitives.setup import setup_of
from meso_robust.task import Task
from meso_robust.types import Floats

Told = Callable[[str, int, int], None]
Ask = Callable[[str, Words], object]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Attendance:
    """Who attends a run."""

    words: Words = field(default_factory=Words)
    """What they say."""
    ask: Ask | None = None
    """Called with a move in words and with what takes the answer; None: nothing is asked."""
    show: Show | None = None
    """Called after every turn."""


def eye_of(task: Task, header: Header) -> Eye:
    """What looks for a task's part.

    Parameters
    ----------
    task, header
        The task, and the run.

    Returns
    -------
    Eye
        That expects it anywhere, turned as at the task's start.
    """
    setup = setup_of(task)
    guess: Floats = np.array([math.nan, math.nan, setup.start.theta.mid])
    return Eye(outline(setup), header.lab, guess, header.trust)


def carried_through(
    task: Task,
    header: Header,
    decide: Decide,
    folder: Path,
    journal: Path | None = None,
    attendance: Attendance | None = None,
    told: Told = lambda *_: None,
    film: Film | None = None,
) -> tuple[RunDocument, list[Turn]]:
    """Carry a run through, from lifted probes to lifted probes.

    Parameters
    ----------
    task, header
        What is carried out, and where.
    decide
        Answers sensed poses.
    folder
        Of the laboratory's file.
    journal
        Where the journal is written; what a killed run left there is kept beside it.
    attendance
        Who is asked and shown; None: nobody.
    told
        Called with what is being done, the moves that are made, and one more.
    film
        Keeps the frames; None: they are not kept.

    Returns
    -------
    tuple
        What it came to, and the turns of its journal.
    """
    there = Attendance() if attendance is None else attendance
    conductor = Conductor(header.lab, decide, header.trust, confirm=header.confirm, dry=header.dry)
    latencies: list[float] = []

    def after(glimpse: Glimpse) -> None:
        if glimpse.frame is not None:
            latencies.append(glimpse.latency)
        for command in glimpse.commands:
            if command.do == "ask" and there.ask is not None:
                there.ask(command.text, there.words)
        if conductor.phase is not Phase.ENDED:
            seeks = conductor.phase is Phase.SEEING
            what = (
                "looking at the part" if seeks else f"move {conductor.made + 1}: {conductor.phase}"
            )
            told(what, conductor.made, conductor.made + 1)
        if there.show is not None:
            there.show(glimpse)

    if journal is not None and journal.exists():
        journal.replace(journal.with_suffix(".killed"))
    kept = Journal(journal, header)
    try:
        with devices_of(header.lab, task, folder) as devices, stopped_by_signals(there.words):
            eye = eye_of(task, header)
            ending = run_loop(devices, header.lab, eye, conductor, kept, there.words, after, film)
    finally:
        kept.close()
        if film is not None:
            film.close()
    return run_document(header, kept.turns, ending, latencies), kept.turns
