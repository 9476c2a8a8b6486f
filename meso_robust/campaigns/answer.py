"""What a campaign found out: totals, verdicts, failures, and the document that tells them."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass, replace
from typing import Any, Literal

from meso_robust.campaigns.document import Campaign
from meso_robust.campaigns.encoding import canonical, digest, slug
from meso_robust.campaigns.kind import Failure, Part, Result, Told, Values, Verdict
from meso_robust.campaigns.kinds import kind_of
from meso_robust.campaigns.provenance import code, versions
from meso_robust.campaigns.store import Session, Store, Trouble

OF_A_SORT = 3  # failures of the same sort that are written out, of each part
WRITTEN = 20  # failures that are written out, of each part

REPLAYED = -1  # instead of a chunk's index


@dataclass(frozen=True, slots=True, kw_only=True)
class Shown:
    """A failure that is written out."""

    chunk: int
    """``REPLAYED`` if it had been kept before."""
    failure: Failure
    folder: str
    """Where its files are, relative to the report; empty if it has none."""


@dataclass(frozen=True, slots=True, kw_only=True)
class PartAnswer:
    """The outcome of a part."""

    part: Part
    unit: str
    planned: int
    """Chunks."""
    done: int
    runs: int
    failed: int
    seconds: float
    """Of work, summed over the workers."""
    totals: Values
    told: Told
    shown: tuple[Shown, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class Answer:
    """The outcome of a campaign."""

    campaign: Campaign
    parts: tuple[PartAnswer, ...]
    troubles: tuple[Trouble, ...]
    sessions: tuple[Session, ...]

    @property
    def verdict(self) -> Verdict | Literal["incomplete"]:
        """The first that holds of: broken, incomplete (chunks are missing), open, held, measured."""
        verdicts = {one.told.verdict for one in self.parts}
        if "broken" in verdicts:
            return "broken"
        if any(one.done < one.planned for one in self.parts):
            return "incomplete"
        if "open" in verdicts:
            return "open"
        return "held" if "held" in verdicts else "measured"

    @property
    def totals_digest(self) -> str:
        """SHA-256 of all totals: the same for the same campaign, whoever did it and how often it ended."""
        return digest(canonical({one.part.name: one.totals for one in self.parts}))


def answered(
    campaign: Campaign, store: Store, replayed: Mapping[str, Result] | None = None
) -> Answer:
    """Add up what a store holds.

    Parameters
    ----------
    campaign, store
        What was asked, and what was done.
    replayed
        By the name of a part, what came of trying again what earlier campaigns had kept.

    Returns
    -------
    Answer
        Totals, verdicts and the failures that are written out, part by part.

    Raises
    ------
    InputError
        The store is damaged.
    """
    return Answer(
        campaign=campaign,
        parts=tuple(_part(part, store, (replayed or {}).get(part.name)) for part in campaign.parts),
        troubles=store.troubles(),
        sessions=store.sessions(),
    )


def _part(part: Part, store: Store, replayed: Result | None) -> PartAnswer:
    kind = kind_of(part.kind)
    tally = _Tally(part.name)
    totals = kind.total(part, tally.of(store))
    told = kind.tell(part, totals)
    if replayed is not None and replayed.runs:
        told = _with_replayed(told, replayed)
        tally.keep_all(REPLAYED, replayed)
    return PartAnswer(
        part=part,
        unit=kind.unit,
        planned=kind.count(part),
        done=tally.done,
        runs=tally.runs,
        failed=tally.failed,
        seconds=store.seconds(part.name),
        totals=totals,
        told=told,
        shown=tuple(tally.shown),
    )


def _with_replayed(told: Told, replayed: Result) -> Told:
    """Results of a part and of the examples kept from earlier campaigns."""
    again = f"Of {replayed.runs:,} examples kept before {replayed.failed:,} fail again."
    return replace(
        told,
        verdict="broken" if replayed.failed else told.verdict,
        answer=f"{told.answer} {again}",
    )


class _Tally:
    """Counts what every kind has while its results pass by, in the order of their chunks."""

    def __init__(self, part: str) -> None:
        self.part = part
        self.done = self.runs = self.failed = 0
        self.shown: list[Shown] = []
        self._sorts: Counter[str] = Counter()

    def of(self, store: Store) -> Iterator[Result]:
        """All results of the part, counted on the way."""
        for chunk, result in store.results(self.part):
            self.done, self.runs = self.done + 1, self.runs + result.runs
            self.failed += result.failed
            self.keep_all(chunk, result)
            yield result

    def keep_all(self, chunk: int, result: Result) -> None:
        """Keep the failures of a result that are to be written out."""
        for failure in result.failures:
            self._keep(chunk, failure)

    def _keep(self, chunk: int, failure: Failure) -> None:
        self._sorts[failure.what] += 1
        if self._sorts[failure.what] <= OF_A_SORT and len(self.shown) < WRITTEN:
            where = "kept" if chunk == REPLAYED else f"{chunk}"
            folder = f"failures/{slug(self.part)}-{where}-{len(self.shown) + 1}"
            self.shown.append(
                Shown(chunk=chunk, failure=failure, folder=folder if failure.files else "")
            )


def document(answer: Answer) -> dict[str, Any]:
    """What is written to ``campaign.json``.

    Parameters
    ----------
    answer
        What a campaign found out.

    Returns
    -------
    dict
        JSON values; numbers finite.
    """
    campaign = answer.campaign
    return {
        "schema": "meso-robust/campaign-result/1",
        "name": campaign.name,
        "verdict": answer.verdict,
        "hash": campaign.hash,
        "seed": campaign.seed,
        "confidence": campaign.confidence,
        "totals_digest": answer.totals_digest,
        "parts": [_part_document(one) for one in answer.parts],
        "troubles": [asdict(one) for one in answer.troubles],
        "sessions": [asdict(one) for one in answer.sessions],
        "made_with": {"code": code(), **versions()},
    }


def _part_document(one: PartAnswer) -> dict[str, Any]:
    return {
        "name": one.part.name,
        "kind": one.part.kind,
        "asked": dict(one.part.asked),
        "verdict": one.told.verdict,
        "answer": one.told.answer,
        "unit": one.unit,
        "runs": one.runs,
        "failed": one.failed,
        "chunks": {"planned": one.planned, "done": one.done},
        "work_s": one.seconds,
        "figures": dict(one.told.figures),
        "totals": one.totals,
        "failures": [
            {
                "chunk": shown.chunk,
                "what": shown.failure.what,
                "detail": shown.failure.detail,
                "folder": shown.folder,
                "files": sorted(shown.failure.files),
            }
            for shown in one.shown
        ],
    }


def summary(answer: Answer) -> str:
    """The answer as the command line prints it.

    Parameters
    ----------
    answer
        What a campaign found out.

    Returns
    -------
    str
        The verdict, then a line or two a part, and where failures were written.
    """
    lines = [f"{answer.verdict.upper()}: {answer.campaign.name}"]
    for one in answer.parts:
        lines.append(f"{one.part.name} ({one.part.kind}): {one.told.answer}")
        if one.done < one.planned:
            lines.append(f"  {one.planned - one.done} of {one.planned} chunks could not be done")
        lines += [f"  {one_.failure.what}: {one_.folder}" for one_ in one.shown if one_.folder]
    return "\n".join(lines)
