"""The kind *mutation*: tampering with a certificate, chunk by chunk."""

from __future__ import annotations

import json
import math
import random
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from meso_robust.campaigns.kind import MOST_FAILURES, Failure, Kind, Part, Result, Values
from meso_robust.campaigns.mutation.answer import ACCEPTED, REJECTED, answered
from meso_robust.campaigns.mutation.changes import change
from meso_robust.campaigns.mutation.excuses import excuse
from meso_robust.campaigns.mutation.forged_tasks import true_of
from meso_robust.campaigns.mutation.forgeries import forge
from meso_robust.campaigns.mutation.given import given_certificate
from meso_robust.campaigns.mutation.memory import Remembered
from meso_robust.campaigns.mutation.original import Original
from meso_robust.campaigns.mutation.places import Document, differences, sealed
from meso_robust.campaigns.mutation.section import FORGED
from meso_robust.campaigns.mutation.summary import UNTRUE, tell
from meso_robust.checker.prover import PLAIN, Prover
from meso_robust.task import Task, parse_task
from meso_robust.toml_files import toml_text

TOLD = 6
"""Most differences reported for a certificate."""


@dataclass(frozen=True, slots=True, eq=False)
class Prepared:
    """What all chunks share."""

    original: Original
    known: Remembered
    """What the checker found out about the original."""


@dataclass(frozen=True, slots=True)
class Mutant:
    """A tampered certificate; its digest fits, unless that was what was changed."""

    names: tuple[str, ...]
    """Of the changes."""
    document: Document
    task: Task | None = None
    """That it is about; None: the original's."""


@dataclass(frozen=True, slots=True)
class Trial:
    """What the checker made of a tampered certificate."""

    mutant: Mutant
    word: str
    """Of its answer."""
    reason: str | None
    """Accepted: why it is true all the same; else the objection."""

    @property
    def missed(self) -> bool:
        """Accepted, though it claims something untrue."""
        return self.word in ACCEPTED and self.reason is None


def prepare(part: Part) -> Prepared:
    """Read the original and check it once."""
    task = parse_task(dict(part.given["task"]), f"part {part.name!r}")
    # in the order of its keys, whichever way it came here: places are drawn by their order
    document = json.loads(json.dumps(part.given["certificate"], sort_keys=True))
    known = Remembered()
    answered(document, task, known.prover)
    return Prepared(Original(task, document), known)


def count(part: Part) -> int:
    """Number of chunks."""
    return math.ceil(part.asked["certificates"] / part.asked["chunk"])


def mutate(original: Original, changes: int, rng: random.Random, forged: float = FORGED) -> Mutant:
    """A certificate with some things changed.

    The first may be a forgery. What is changed besides is a number: of several changes of the form
    one is as good as always seen before anything is checked.
    """
    names, document, task = [], original.document, original.task
    if rng.random() < forged:
        forgery = forge(original, rng)
        names, document, task = [forgery.name], forgery.document, forgery.task
    while len(names) < changes:
        name, document = change(document, rng, numbers=bool(names))
        names.append(name)
    own = document["digest"] != original.document["digest"]
    return Mutant(tuple(names), document if own else sealed(document), task)


def judged(mutant: Mutant, original: Original, prover: Prover = PLAIN) -> Trial:
    """Have a certificate checked, and what is accepted judged."""
    task = mutant.task or original.task
    reply = answered(mutant.document, task, prover)
    if reply.word not in ACCEPTED:
        return Trial(mutant, reply.word, reply.why)
    true = original if task == original.task else true_of(original, task)
    return Trial(mutant, reply.word, None if true is None else excuse(true, mutant.document))


def execute(prepared: Prepared, part: Part, chunk: int) -> Result:
    """Tamper, check, and judge what is accepted."""
    rng = random.Random(f"{part.seed}:{chunk}")
    size, asked = int(part.asked["chunk"]), int(part.asked["certificates"])
    forged = float(part.asked["forged"])
    original, prover = prepared.original, prepared.known.copy().prover
    trials = [
        judged(mutate(original, int(part.asked["changes"]), rng, forged), original, prover)
        for _ in range(min(size, asked - chunk * size))
    ]
    missed = [one for one in trials if one.missed]
    return Result(
        runs=len(trials),
        failed=len(missed),
        failures=tuple(_failure(one.mutant, original) for one in missed[:MOST_FAILURES]),
        values=counted(trials),
    )


def counted(trials: Sequence[Trial]) -> Values:
    """How often what was answered, and to which change."""
    accepted = [one for one in trials if one.word in ACCEPTED]
    rejected = [one for one in trials if one.word == REJECTED]
    names = sorted({name for one in trials for name in one.mutant.names})
    return {
        "answers": _times(one.word for one in trials),
        "excuses": _times(one.reason for one in accepted if one.reason is not None),
        "objections": _times(one.reason for one in rejected if one.reason is not None),
        "changes": {
            name: _times(one.word for one in trials if name in one.mutant.names) for name in names
        },
    }


def _times(words: Iterable[str]) -> dict[str, int]:
    return dict(sorted(Counter(words).items()))


def _failure(mutant: Mutant, original: Original) -> Failure:
    changes = list(differences(original.document, mutant.document))
    told = "; ".join(one.told() for one in changes[:TOLD])
    more = f"; and {len(changes) - TOLD} more" if len(changes) > TOLD else ""
    task = (mutant.task or original.task).to_dict()
    return Failure(
        what=UNTRUE,
        detail=f"{' and '.join(mutant.names)}: {told}{more}",
        files={
            "certificate.json": json.dumps(mutant.document, indent=1) + "\n",
            "task.toml": toml_text(task),
        },
    )


def total(part: Part, results: Iterable[Result]) -> Values:
    """Counts of all chunks."""
    sums: Values = {"runs": 0, "missed": 0, **counted(())}
    for one in results:
        sums = added(sums, {"runs": one.runs, "missed": one.failed, **one.values})
    return sums


def added(one: Values, other: Values) -> Values:
    """Sum of two tables of counts, key by key."""
    return {
        key: added(one.get(key, {}), other.get(key, {}))
        if isinstance(one.get(key, other.get(key)), Mapping)
        else one.get(key, 0) + other.get(key, 0)
        for key in sorted({*one, *other})
    }


MUTATION = Kind(
    name="mutation",
    unit="certificates",
    given=given_certificate,
    count=count,
    prepare=prepare,
    execute=execute,
    total=total,
    tell=tell,
)
"""Tampered certificates."""
