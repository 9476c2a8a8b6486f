"""The work of a campaign: what is missing is handed out, what comes back is kept.

A chunk whose worker dies is done again; when several were under way it is unknown which of them killed
it, so each is tried by itself. A chunk that fails three times is given up and reported.
"""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Callable, Iterator
from concurrent.futures import FIRST_COMPLETED, Future, wait
from dataclasses import dataclass, field, replace
from datetime import UTC, datetime

from meso_robust.campaigns.chunk import do as do_chunk
from meso_robust.campaigns.document import Campaign
from meso_robust.campaigns.encoding import part_text, result_of
from meso_robust.campaigns.executor import Crew, CrewLostError
from meso_robust.campaigns.kind import Done
from meso_robust.campaigns.kinds import kind_of
from meso_robust.campaigns.provenance import code, machine
from meso_robust.campaigns.store import Session, Store, Trouble
from meso_robust.errors import InputError

ATTEMPTS = 3
PAUSE = 0.5  # s, for looking whether a chunk takes too long

Do = Callable[[str, int], Done]


@dataclass(frozen=True, slots=True)
class Ticket:
    """A chunk to be done."""

    part: str
    chunk: int
    attempt: int = 1
    alone: bool = False
    """Whether nothing else may be under way, so that it answers for a worker that dies."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Step:
    """A chunk that was finished: kept, or given up."""

    part: str
    chunk: int
    runs: int
    failed: int
    given_up: bool


@dataclass(slots=True, kw_only=True)
class _State:
    """What is left, under way and suspected."""

    left: Iterator[Ticket]
    again: deque[Ticket] = field(default_factory=deque)
    suspects: deque[Ticket] = field(default_factory=deque)
    under_way: dict[Future[Done], tuple[Ticket, float]] = field(default_factory=dict)

    def next(self, size: int) -> Ticket | None:
        """The next chunk that may start now, if any."""
        if any(ticket.alone for ticket, _ in self.under_way.values()):
            return None
        if self.suspects:
            return None if self.under_way else self.suspects.popleft()
        if len(self.under_way) >= size:
            return None
        return self.again.popleft() if self.again else next(self.left, None)


def missing(campaign: Campaign, store: Store) -> Iterator[Ticket]:
    """What is left to do.

    Parameters
    ----------
    campaign, store
        What is asked, and what is done already.

    Returns
    -------
    Iterator
        Chunks that the store does not have, part by part.
    """
    for part in campaign.parts:
        done = store.done(part.name)
        for chunk in range(kind_of(part.kind).count(part)):
            if chunk not in done:
                yield Ticket(part.name, chunk)


def carry_out(campaign: Campaign, store: Store, crew: Crew, do: Do = do_chunk) -> Iterator[Step]:
    """Do what is missing.

    Parameters
    ----------
    campaign, store
        What is asked, and what is done already.
    crew
        Executor that runs the chunks; closed at the end.
    do
        Does a chunk, given the part's text and the chunk's index.

    Returns
    -------
    Iterator
        A step for each chunk, when it is kept or given up.

    Raises
    ------
    InputError
        The store cannot be written, the cluster cannot be reached or runs other code.
    RuntimeError
        A chunk gave two different results.
    """
    work = _Work(campaign, store, crew, do)
    try:
        yield from work.steps()
    finally:
        crew.close()


class _Work:
    def __init__(self, campaign: Campaign, store: Store, crew: Crew, do: Do) -> None:
        self._texts = {part.name: part_text(part) for part in campaign.parts}
        self._limit = campaign.chunk_limit_s
        self._store, self._crew, self._do = store, crew, do
        self._state = _State(left=missing(campaign, store))
        self._begun, self._runs = time.monotonic(), 0
        began = Session(
            began=_now(), ended=None, crew=crew.name, machine=machine(), runs=0, seconds=0.0
        )
        self._session = store.begin(began)

    def steps(self) -> Iterator[Step]:
        """Hand out and take back until nothing is left."""
        while True:
            self._hand_out()
            if not self._state.under_way:
                break
            finished, _ = wait(self._state.under_way, PAUSE, FIRST_COMPLETED)
            for future in finished:
                # a worker that died may have taken others of the finished ones with it
                if future in self._state.under_way:
                    yield from self._taken(future)
            yield from self._too_long()
        self._store.progress(self._session, self._runs, self._seconds(), _now())

    def _seconds(self) -> float:
        return time.monotonic() - self._begun

    def _hand_out(self) -> None:
        size = self._crew.size
        while (ticket := self._state.next(size)) is not None:
            try:
                future = self._crew.submit(self._do, self._texts[ticket.part], ticket.chunk)
            except CrewLostError as error:
                self._state.again.appendleft(ticket)
                self._suspect(str(error))
                continue
            self._state.under_way[future] = (ticket, time.monotonic())

    def _taken(self, future: Future[Done]) -> Iterator[Step]:
        ticket, _ = self._state.under_way[future]
        error = None if future.cancelled() else future.exception()
        if future.cancelled() or (error is not None and self._crew.lost(error)):
            yield from self._lost(ticket, "its worker died or was lost")
            return
        del self._state.under_way[future]
        if error is not None:
            yield from self._failed(ticket, f"{type(error).__name__}: {error}")
            return
        yield from self._kept(ticket, future.result())

    def _kept(self, ticket: Ticket, done: Done) -> Iterator[Step]:
        if done.code != code():
            raise InputError(
                f"worker {done.worker} runs different code ({done.code[:12]}, here {code()[:12]}); install "
                "the same packages on all workers"
            )
        new = self._store.add(ticket.part, ticket.chunk, done.text, done.seconds, done.worker)
        found = result_of(done.text)
        self._runs += found.runs if new else 0
        self._store.progress(self._session, self._runs, self._seconds())
        yield Step(
            part=ticket.part,
            chunk=ticket.chunk,
            runs=found.runs,
            failed=found.failed,
            given_up=False,
        )

    def _lost(self, ticket: Ticket, what: str) -> Iterator[Step]:
        """The crew is gone: a chunk that was alone answers for it, several are suspected."""
        if ticket.alone or len(self._state.under_way) == 1:
            self._state.under_way.clear()
            yield from self._failed(replace(ticket, alone=True), what)
            self._crew.renew()
        else:
            self._suspect(what)

    def _suspect(self, what: str) -> None:
        """All that is under way has to be done again, one by one."""
        for ticket, _ in self._state.under_way.values():
            self._note(ticket, f"{what}; {len(self._state.under_way)} chunks were under way", False)
            self._state.suspects.append(replace(ticket, alone=True))
        self._state.under_way.clear()
        self._crew.renew()

    def _too_long(self) -> Iterator[Step]:
        now = time.monotonic()
        slow = [t for t, begun in self._state.under_way.values() if now - begun > self._limit]
        if not slow:
            return
        others = [t for t, _ in self._state.under_way.values() if t not in slow]
        self._state.under_way.clear()
        self._state.again.extend(others)
        self._crew.renew()
        for ticket in slow:
            yield from self._failed(ticket, f"took longer than chunk_limit_s = {self._limit:g}")

    def _failed(self, ticket: Ticket, what: str) -> Iterator[Step]:
        last = ticket.attempt >= ATTEMPTS
        self._note(ticket, what, last)
        if last:
            yield Step(part=ticket.part, chunk=ticket.chunk, runs=0, failed=0, given_up=True)
            return
        again = self._state.suspects if ticket.alone else self._state.again
        again.append(replace(ticket, attempt=ticket.attempt + 1))

    def _note(self, ticket: Ticket, what: str, given_up: bool) -> None:
        self._store.note(
            Trouble(
                at=_now(),
                part=ticket.part,
                chunk=ticket.chunk,
                attempt=ticket.attempt,
                what=what,
                given_up=given_up,
            )
        )


def _now() -> str:
    return datetime.now(UTC).isoformat(timespec="seconds")
