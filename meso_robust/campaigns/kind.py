"""What a kind of campaign is: how its work is cut into chunks, done, added up and reported.

To add a kind, write a folder with a ``kind.py`` that makes a :class:`Kind` and a ``section.py`` with its
keys, which imports no compiled code; and add its line to ``kinds.py``.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import BaseModel, ConfigDict, Field

Values = Mapping[str, Any]
"""Anything that JSON can hold; numbers finite."""

MOST_FAILURES = 3
"""Failures of a chunk that are kept; all are counted."""


class Section(BaseModel):
    """The keys of a ``[[part]]`` that all kinds have; a kind adds its own.

    A kind's section has a ``kind: Literal["its-name"]`` of its own.
    """

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True)

    name: Annotated[str, Field(min_length=1, max_length=80)]
    """What the part is called in the report; each name once."""


class PlanSection(Section):
    """The keys of a part that is about a plan."""

    task: str | None = None
    """Task file, relative to the campaign file; the paper's task if absent."""
    plan: str | None = None
    """Plan for it (``plan.json``); planned again if absent."""
    factor: Annotated[float, Field(gt=0, le=10)] = 1.0
    """All uncertainties are scaled about their middles by this."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Part:
    """One part of a campaign with everything that its chunks need: no file is read after this."""

    name: str
    kind: str
    seed: int
    """Of the part; differs from that of all other parts of the campaign."""
    confidence: float
    """Of the reported intervals, 0 to 1."""
    asked: Values
    """The section as stated, defaults filled in."""
    given: Values
    """What was read from the files that the section names."""

    def rng(self, chunk: int) -> np.random.Generator:
        """Source of the random numbers of a chunk; the same for the same chunk, wherever it runs."""
        return np.random.default_rng([self.seed, chunk])


@dataclass(frozen=True, slots=True, kw_only=True)
class Failure:
    """Something that a campaign was looking for: a run, an example, a certificate that breaks a rule."""

    what: str
    """Name of what is broken, the same for all failures of this sort."""
    detail: str
    """This one in words: a line or a short paragraph, plain text."""
    files: Mapping[str, str]
    """Contents of files, by name, that let anybody see it again; may be empty."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Result:
    """The outcome of a chunk; the same chunk always gives the same result, to the last bit."""

    runs: int
    """Executions, examples, certificates, cases: what the rate is counted in."""
    failed: int
    """Of these, how many broke something."""
    failures: tuple[Failure, ...]
    """The first ``MOST_FAILURES`` of them, minimised if the kind does that within a chunk."""
    values: Values
    """What else the kind adds up."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Done:
    """A chunk that has been done."""

    text: str
    """Its result, canonical."""
    seconds: float
    worker: str
    code: str
    """Of the package that did it."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Table:
    """Rows of text for the report."""

    title: str
    head: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    note: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class Bars:
    """Horizontal bars for the report, largest first or in their own order."""

    title: str
    unit: str
    labels: tuple[str, ...]
    values: tuple[float, ...]
    limit: float | None = None
    """A line that no bar should pass."""
    note: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class Coverage:
    """How evenly everything uncertain was covered: a strip of shades for each."""

    title: str
    labels: tuple[str, ...]
    counts: tuple[tuple[int, ...], ...]
    """For each label the runs in each of the equal bins of its range."""
    note: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class Paths:
    """The hardest runs, drawn: outlines of the part along its way, tips, and the goal."""

    title: str
    part_um: tuple[tuple[float, float], ...]
    """Corners of the part, its own axes."""
    goal: tuple[float, float, float]
    """Middle of the goal: um, um, deg."""
    tolerance: tuple[float, float]
    """Of the goal: um, deg."""
    runs: tuple[tuple[str, tuple[tuple[float, float, float], ...]], ...]
    """Label of each run, and poses along it: um, um, deg."""
    note: str = ""


View = Table | Bars | Coverage | Paths


Verdict = Literal["held", "broken", "open", "measured"]
"""``held``: looked for a failure and found none; ``broken``: found one; ``open``: what was done does
not answer what was asked; ``measured``: a rate, no claim was at stake."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Told:
    """A part's totals as reported."""

    verdict: Verdict
    answer: str
    """A sentence or two."""
    figures: tuple[tuple[str, str], ...]
    """A few numbers to lead with, each with what it is: ``("broken claims", "0 of 1,000,000")``."""
    views: tuple[View, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class Kind:
    """A kind of campaign, as a set of pure functions."""

    name: str
    """As in ``kind = "..."``."""
    unit: str
    """What its runs are: ``executions``, ``examples``, ``certificates`` ..."""
    given: Callable[[Any, Path], Values]
    """Reads what a section names, relative to the campaign's folder. Raises InputError."""
    count: Callable[[Part], int]
    """Number of chunks."""
    prepare: Callable[[Part], Any]
    """What all chunks share; once in every process."""
    execute: Callable[[Any, Part, int], Result]
    """Does a chunk: what was prepared, the part, the chunk's index."""
    total: Callable[[Part, Iterable[Result]], Values]
    """Adds up results, which come in the order of their chunks; some may be missing."""
    tell: Callable[[Part, Values], Told]
    """The totals in words, tables and pictures."""
    keep: Callable[[Path, Values], None] | None = None
    """Saves in a folder what of the totals is worth trying again in later campaigns."""
    replay: Callable[[Part, Path], Result] | None = None
    """Tries again what was saved there. It depends on the folder, so it is reported beside the totals."""
