"""Certificates with one value changed: each is rejected, or still claims only what is true.

    python -m tests.checker.mutations --count 4000 --seed 0

The digest is refreshed after each change, so that it is the checker's physics that must object. A
certificate that is accepted must fall under one of the rules of :func:`excuse`, each judged without
the checker.
"""

from __future__ import annotations

import argparse
import copy
import json
import math
import random
import sys
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from meso_robust.admissibility import values
from meso_robust.bounds import Verdict
from meso_robust.certificates.chain import certify
from meso_robust.certificates.document import CertificateDocument
from meso_robust.checker.reading import digest, parse_certificate
from meso_robust.checker.verdict import check
from meso_robust.errors import InputError
from meso_robust.job import make
from meso_robust.planning.document import PlanDocument
from meso_robust.planning.reading import rules_of
from meso_robust.primitives.setup import setup_of
from meso_robust.task import Task, load_task
from meso_robust.tasks import PAPER
from tests.checker.memo import remembered

ROOT = Path(__file__).resolve().parents[2]
REPORT = ROOT / "reports" / "checker" / "mutations.md"
Floats = npt.NDArray[np.float64]
Path_ = tuple[str | int, ...]
Document = dict[str, Any]

UNCHECKED = ("simulation", "made_with")
EVIDENCE = {"boxes", "refused_at", "limit", "each_alone", "binds_first"}
"""Keys that the checker names as not checked."""


@dataclass(frozen=True, slots=True)
class Mutation:
    """One change."""

    where: Path_
    kind: str
    old: Any
    new: Any
    document: Document


def leaves(value: Any, where: Path_ = ()) -> Iterator[tuple[Path_, Any]]:
    """Every value of a document that holds no others, and every list and mapping."""
    yield where, value
    items = (
        value.items()
        if isinstance(value, dict)
        else enumerate(value)
        if isinstance(value, list)
        else ()
    )
    for key, item in items:
        yield from leaves(item, (*where, key))


def at(document: Document, where: Path_) -> Any:
    """The value at a place."""
    for key in where:
        document = document[key]  # type: ignore[index]
    return document


def is_double(value: Any) -> bool:
    """Whether a text is a hexadecimal double."""
    return isinstance(value, str) and ("0x" in value) and ("p" in value)


def changed(value: Any, rng: random.Random, texts: list[str]) -> tuple[str, Any]:
    """The value after a change of some kind."""
    if isinstance(value, bool):
        return "flipped", not value
    if isinstance(value, int | float):
        kind, new = _number(float(value), rng)
        return kind, round(new) if isinstance(value, int) and rng.random() < 0.8 else new
    if is_double(value):
        kind, new = _number(float.fromhex(value), rng)
        return kind, new.hex()
    if isinstance(value, str):
        return _text(value, rng, texts)
    if value is None:
        return "null filled", rng.choice([0.0, "x", [], {}])
    return _container(value, rng)


def _number(value: float, rng: random.Random) -> tuple[str, float]:
    towards = rng.choice([-1, 1])
    kinds = {
        "sign": -value,
        "neighbour": math.nextafter(value, towards * math.inf),
        "scaled": value * (1.0 + towards * 10.0 ** rng.uniform(-9, 0)),
        "added": value + towards * 10.0 ** rng.uniform(-9, 1),
        "digit": value + towards * 2.0 ** (math.frexp(value)[1] - rng.randint(1, 50)),
        "zero": 0.0,
    }
    kind = rng.choice(sorted(kinds))
    return kind, kinds[kind]


def _text(value: str, rng: random.Random, texts: list[str]) -> tuple[str, str]:
    if value and rng.random() < 0.5:
        place = rng.randrange(len(value))
        return "character", value[:place] + rng.choice("abc019-+ x") + value[place + 1 :]
    return "other text", rng.choice(texts)


def _container(value: Any, rng: random.Random) -> tuple[str, Any]:
    new = copy.deepcopy(value)
    if isinstance(new, list) and new:
        kind = rng.choice(["dropped", "doubled", "swapped"])
        place = rng.randrange(len(new))
        if kind == "dropped":
            del new[place]
        elif kind == "doubled":
            new.insert(place, copy.deepcopy(new[place]))
        else:
            other = rng.randrange(len(new))
            new[place], new[other] = new[other], new[place]
        return f"item {kind}", new
    if isinstance(new, dict) and new:
        key = rng.choice(sorted(new))
        if rng.random() < 0.5:
            del new[key]
            return "key dropped", new
        other = rng.choice(sorted(new))
        new[key], new[other] = new[other], new[key]
        return "values swapped", new
    return "null", None


def mutate(document: Document, rng: random.Random) -> Mutation | None:
    """A document with one change and its digest refreshed; None if nothing changed."""
    places = list(leaves(document))
    # a place by its kind first: the many ends of boxes must not drown the rest
    groups: dict[str, list[tuple[Path_, Any]]] = {}
    for where, value in places[1:]:
        name = ".".join(key for key in where if isinstance(key, str))
        groups.setdefault(name, []).append((where, value))
    where, old = rng.choice(groups[rng.choice(sorted(groups))])
    texts = [value for _, value in places if isinstance(value, str)]
    kind, new = changed(old, rng, texts)
    if new == old and type(new) in (type(old), float):
        return None
    mutant = copy.deepcopy(document)
    at(mutant, where[:-1])[where[-1]] = new
    if where != ("digest",):
        mutant["digest"] = digest(mutant)
    return Mutation(where, kind, old, new, mutant)


def answer(mutant: Document, task: Task) -> tuple[str, str]:
    """What the checker says to it: malformed, REJECTED or VERIFIED; and why."""
    try:
        certificate, own = parse_certificate(json.dumps(mutant), "mutant", task)
    except InputError as error:
        return "malformed", str(error)
    found = check(certificate, own, task)
    why = "" if found.refused is None else found.refused.claim
    return found.verdict, why


def excuse(mutation: Mutation, task: Task, finals: Floats) -> str | None:
    """Why an accepted certificate still claims only what is true; None if there is no excuse.

    Parameters
    ----------
    mutation, task
        What was changed, and the task.
    finals
        (N, 3) final poses of simulated runs, m and rad.
    """
    where, key = mutation.where, mutation.where[-1]
    if where[0] in UNCHECKED or EVIDENCE & set(where):
        return "named as not checked"
    if isinstance(mutation.old, list | dict):
        return _same_numbers(mutation)
    if key == "lower_bound":
        return _bound_holds(mutation)
    if "over" in where:
        return _narrower_or_true(mutation)
    if where[0] == "policy" and key == "offset_um":
        return _certified_too(mutation, task)
    if where[:2] == ("margin", "factor"):
        smaller = 1.0 <= mutation.new <= mutation.document["margin"]["refused_at"]
        return "a factor below the refused one" if smaller else None
    if "_exact" in str(where):
        return _box_holds(mutation, finals)
    return None


def _certified_too(mutation: Mutation, task: Task) -> str | None:
    """Another policy: the claim about it must be one that the planner proves as well."""
    policy = CertificateDocument.model_validate(mutation.document).policy
    plan = PlanDocument(task=task.name, task_hash=task.hash, policy=policy, moves=())
    proved = certify(rules_of(plan), setup_of(task)).verdict is Verdict.PROVED
    return "another policy, which the planner certifies too" if proved else None


def _same_numbers(mutation: Mutation) -> str | None:
    """A change of a list that only exchanged equal numbers."""
    return "equal values" if mutation.new == mutation.old else None


def _obligation(mutation: Mutation) -> Document:
    place = mutation.where.index("obligations") + 2
    found: Document = at(mutation.document, mutation.where[:place])
    return found


def _bound_holds(mutation: Mutation) -> str | None:
    if float.fromhex(mutation.new) <= float.fromhex(mutation.old):
        return "a weaker bound"
    return _sampled(_obligation(mutation))


def _narrower_or_true(mutation: Mutation) -> str | None:
    old, new = float.fromhex(mutation.old), float.fromhex(mutation.new)
    lower_end = mutation.where[-1] == 0
    if new > old if lower_end else new < old:
        return "the same inequality over a narrower box"
    return _sampled(_obligation(mutation))


def _sampled(one: Document) -> str | None:
    """The stated bound, at the corners and at random points of the stated box.

    By the planner's formula, which is not the checker's.
    """
    bound = float.fromhex(one["lower_bound"])
    text = one["inequality"]
    over = {name: [float.fromhex(end) for end in ends] for name, ends in one["over"].items()}
    rng = np.random.default_rng(0)
    points = {name: low + (high - low) * rng.random(20000) for name, (low, high) in over.items()}
    corners = np.array(np.meshgrid(*over.values())).reshape(len(over), -1)
    points = {name: np.concatenate([points[name], corners[k]]) for k, name in enumerate(over)}
    rows = _values(text, points)
    if rows is None:
        return "over the tube" if "over the tube" in text else None
    least = rows.max(axis=0).min() if "at least one" in text else rows.min()
    return "true at 20000 points" if least >= bound - 1e-12 * abs(bound) - 1e-18 else None


def _values(text: str, points: dict[str, Floats]) -> Floats | None:
    plain = {
        "travel > 0": lambda p: [p["travel"]],
        "half - |d2| > 0": lambda p: [p["half"] - np.abs(p["d2"])],
        "h at the touch > h at the end": lambda p: [p["h_start"] - p["h_end"]],
        "sin(theta) > 0 at the end": lambda p: [np.sin(p["theta"])],
        "travel in contact > longest travel of the turn": lambda p: [p["travel"]],
    }
    if text in plain:
        return np.array(plain[text](points))
    if "(" not in text:
        return None
    module, name = text.split("(")[0].split(".")
    return np.array(values(module, name)(**points))


def _box_holds(mutation: Mutation, finals: Floats) -> str | None:
    """A box that tells the same to 14 digits, or one that still holds all simulated final poses."""
    old, new = float.fromhex(mutation.old), float.fromhex(mutation.new)
    if abs(new - old) <= 1e-14:
        return "the same to 14 digits"
    last = len(mutation.document["steps"]) - 1
    if mutation.where[:3] != ("steps", last, "post_exact"):
        return None
    column = ("x_m", "y_m", "theta_rad").index(str(mutation.where[3]))
    poses = finals[:, column]
    inside = new <= poses.min() if mutation.where[4] == 0 else new >= poses.max()
    return "a box of the same reading that holds all runs" if inside else None


@dataclass(frozen=True, slots=True)
class Campaign:
    """What came out."""

    answers: Counter[str]
    excuses: Counter[str]
    objections: Counter[str]
    missed: tuple[Mutation, ...]


def campaign(document: Document, task: Task, finals: Floats, count: int, seed: int) -> Campaign:
    """Check ``count`` changed certificates."""
    rng = random.Random(seed)
    found = Campaign(Counter(), Counter(), Counter(), ())
    missed: list[Mutation] = []
    with remembered():
        while sum(found.answers.values()) < count:
            mutation = mutate(document, rng)
            if mutation is None:
                continue
            word, why = answer(mutation.document, task)
            found.answers[word] += 1
            if word == "VERIFIED":
                reason = excuse(mutation, task, finals)
                if reason is None:
                    missed.append(mutation)
                found.excuses[reason or "MISSED"] += 1
            elif word == "REJECTED":
                found.objections[why] += 1
    return Campaign(found.answers, found.excuses, found.objections, tuple(missed))


def report(found: Campaign, seed: int) -> str:
    """The campaign as a page."""
    count = sum(found.answers.values())

    def table(title: str, of: Counter[str]) -> list[str]:
        rows = [f"| {name} | {number} |" for name, number in of.most_common()]
        return ["", f"| {title} | certificates |", "|---|---|", *rows]

    lines = [
        "# Changed certificates",
        "",
        f"`python -m tests.checker.mutations --count {count} --seed {seed}`: the certificate of the "
        f"paper's task with one value changed and its digest refreshed, {count} times. Accepted "
        f"although it claims something untrue: **{len(found.missed)}**.",
        *table("answer", found.answers),
        *table("why an accepted one is true", found.excuses),
        *table("what a rejected one was rejected for (the 40 most frequent)", Counter(dict(found.objections.most_common(40)))),
    ]  # fmt: skip
    return "\n".join(lines) + "\n"


def main() -> int:
    """Run the campaign and write its report."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=4000)
    parser.add_argument("--seed", type=int, default=0)
    arguments = parser.parse_args()
    task = load_task(PAPER)
    planned = make(task, 1000, 0)
    document = json.loads(planned.certificate.model_dump_json(by_alias=True))
    finals = planned.check.sampled.final
    found = campaign(document, task, finals, arguments.count, arguments.seed)
    REPORT.parent.mkdir(parents=True, exist_ok=True)
    REPORT.write_text(report(found, arguments.seed), encoding="utf-8")
    for mutation in found.missed:
        change = f"{mutation.where} {mutation.kind}: {mutation.old} -> {mutation.new}"
        sys.stdout.write(change + "\n")
    sys.stdout.write(f"{len(found.missed)} missed of {arguments.count}; {REPORT}\n")
    return 1 if found.missed else 0


if __name__ == "__main__":
    raise SystemExit(main())
