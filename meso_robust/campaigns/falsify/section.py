"""The keys of a part of the kind *falsify*, and how its work is cut into chunks."""

from __future__ import annotations

import json
from dataclasses import dataclass
from enum import Enum
from typing import Annotated, Literal, get_args

from pydantic import Field

from meso_robust.campaigns.kind import Part, PlanSection
from meso_robust.laboratory.claim_ids import OUTCOME, Claim

Draw = Literal["uniform", "corners", "mixed", "adversarial"]
SearchName = Literal["climb", "corner-walk", "face-walk", "cma-es", "splitting"]
Method = Literal[  # one list, so that a message about a wrong one names them all
    "uniform",
    "corners",
    "mixed",
    "adversarial",
    "climb",
    "corner-walk",
    "face-walk",
    "cma-es",
    "splitting",
    "threshold",
]

DRAWS: tuple[Draw, ...] = get_args(Draw)
METHODS: tuple[Method, ...] = get_args(Method)
EVENTS_CHUNK, STEPPER_CHUNK = 20_000, 1_000


class Wanted(Enum):
    """What a threshold is about: the uncertainty at which this is first broken, in words."""

    ANY_MOTION = "any claim about the motion"
    OUTCOME = "carried out and in the goal"

    def counts(self, claim: Claim) -> bool:
        """Whether a broken claim counts."""
        return self is Wanted.ANY_MOTION or claim in OUTCOME


class FalsifySection(PlanSection):
    """The keys of a part that tries to break what is claimed of a plan."""

    kind: Literal["falsify"]
    """The kind: a search for runs that break what a certificate claims."""
    engine: Literal["events", "stepper"] = "events"
    """Event-driven, or in steps."""
    methods: Annotated[tuple[Method, ...], Field(min_length=1)] = METHODS
    """Draws in bulk, searches, and ``threshold``."""
    executions: Annotated[int, Field(ge=1, le=10**12)] = 1_000_000
    """Number of draws in all."""
    chunk: Annotated[int, Field(ge=1, le=10**6)] | None = None
    """Draws of a chunk; 20,000 event-driven or 1,000 stepped ones if absent."""
    restarts: Annotated[int, Field(ge=1, le=10**6)] = 2
    """Searches by each method towards each target."""
    evaluations: Annotated[int, Field(ge=100, le=10**8)] = 10_000
    """Executions of a search."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Bulk:
    """A chunk of draws."""

    method: Draw
    runs: int


@dataclass(frozen=True, slots=True, kw_only=True)
class Search:
    """A chunk that is one search."""

    method: SearchName
    target: str
    restart: int


@dataclass(frozen=True, slots=True, kw_only=True)
class Bisection:
    """A chunk that is the search of one threshold."""

    wanted: Wanted


Work = Bulk | Search | Bisection


def section_of(part: Part) -> FalsifySection:
    """What a part asks for."""
    return FalsifySection.model_validate_json(json.dumps(dict(part.asked)))


def count(part: Part) -> int:
    """Number of chunks."""
    asked = section_of(part)
    return _bulks(asked) + len(_searches(asked, part)) + len(_bisections(asked))


def work_of(part: Part, chunk: int) -> Work:
    """What a chunk does: first come the draws, their methods in turn, then the searches."""
    asked = section_of(part)
    bulks = _bulks(asked)
    if chunk >= bulks:
        rest: list[Work] = [*_searches(asked, part), *_bisections(asked)]
        return rest[chunk - bulks]
    draws, size = _draws(asked), _size(asked)
    left = asked.executions - chunk * size
    return Bulk(method=draws[chunk % len(draws)], runs=min(size, left))


def _size(asked: FalsifySection) -> int:
    """Draws of a chunk; few enough that every method has its turn."""
    size = asked.chunk or (EVENTS_CHUNK if asked.engine == "events" else STEPPER_CHUNK)
    return min(size, -(-asked.executions // max(len(_draws(asked)), 1)))


def _draws(asked: FalsifySection) -> list[Draw]:
    return [name for name in DRAWS if name in asked.methods]


def _bulks(asked: FalsifySection) -> int:
    return -(-asked.executions // _size(asked)) if _draws(asked) else 0


def _searches(asked: FalsifySection, part: Part) -> list[Search]:
    names: tuple[SearchName, ...] = get_args(SearchName)
    return [
        Search(method=method, target=target, restart=restart)
        for restart in range(asked.restarts)
        for method in names
        if method in asked.methods
        for target in part.given["targets"]
    ]


def _bisections(asked: FalsifySection) -> list[Bisection]:
    return [Bisection(wanted=wanted) for wanted in Wanted] if "threshold" in asked.methods else []
