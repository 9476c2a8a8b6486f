"""The register in the order it is read: chapters of entries, their findings, the stored queries."""

from __future__ import annotations

import json
import re
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from derivations._claim import Claim, Verdict
from derivations._derivation import Derivation
from derivations._statement import DerivationError, Finding
from derivations.report.witnesses import Certificate, certificate

KEY = re.compile(r"[a-z0-9]+(-[a-z0-9]+)*")
MARKS = {
    Verdict.CONFIRMED: "✓",
    Verdict.CONFIRMED_WITH_ADDED_HYPOTHESIS: "✓+",
    Verdict.EMPTY: "∅",
    Verdict.SHARPENED: "▲",
    Verdict.REFUTED: "✗",
    Verdict.INCONSISTENT: "≠",
    Verdict.NEW: "★",
}
"""One mark a verdict, for readers who do not tell the colours apart."""
ABOUT = {
    "consistent": "whether the printed statements can be true together",
    "of_print": "the printed statement",
    "with_added": "the printed statement with the added hypotheses",
    "compatible": "whether the added hypotheses can hold together",
    "sharper": "what is stronger than the print",
    "checks": "the derived statement",
}
"""Group of findings in a claim -> what its findings are about."""
ANSWERS = {
    "z3: no counterexample exists": "unsat",
    "z3: a counterexample exists": "sat",
    "z3: no values satisfy all of them": "unsat",
    "z3: possible": "sat",
}
"""How a query was decided -> what any other solver must answer to it."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Found:
    """A finding where it stands in its entry."""

    finding: Finding
    about: str
    """Which group of ``ABOUT`` it belongs to."""
    route: str
    """``identity``, ``z3``, ``certificate`` or ``witness``."""
    proof: str = ""
    """File of its query below the folder of the register; empty if there is none."""
    answer: str = ""
    """What a solver must answer to that query."""

    @property
    def how(self) -> str:
        """How it was decided, without the name of the route."""
        return self.finding.how.removeprefix(self.route).lstrip(":, ")

    @property
    def certificate(self) -> Certificate | None:
        """The certificate, if that is how."""
        return certificate(self.how)


@dataclass(frozen=True, slots=True, kw_only=True)
class Entry:
    """A claim with its findings, ready to show."""

    claim: Claim
    found: tuple[Found, ...]

    @property
    def hypotheses(self) -> tuple[str, ...]:
        """What the derived statement needs, the added ones last if they stand nowhere else."""
        claim = self.claim
        return (*claim.hypotheses, *(text for text in claim.added if text not in claim.hypotheses))

    @property
    def groups(self) -> tuple[tuple[str, tuple[Found, ...]], ...]:
        """The findings by what they are about."""
        return tuple(
            (about, members)
            for name, about in ABOUT.items()
            if (members := tuple(found for found in self.found if found.about == name))
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class Chapter:
    """What one derivation file contributes."""

    name: str
    summary: str
    entries: tuple[Entry, ...]

    @property
    def title(self) -> str:
        """The summary as a heading."""
        return self.summary.removesuffix(".")

    @property
    def source(self) -> str:
        """The derivation file, from the root of the project."""
        return f"derivations/{self.name}.py"


def chapters(derivations: tuple[Derivation, ...]) -> tuple[Chapter, ...]:
    """The register in the order of the derivations; those without claims are left out.

    Raises
    ------
    DerivationError
        If a key is malformed or used twice, or the answer to a query is not known.
    """
    counts = Counter(claim.key for derivation in derivations for claim in derivation.claims)
    for key, count in counts.items():
        if not KEY.fullmatch(key):
            raise DerivationError(f"{key!r}: a key is made of a-z, 0-9 and single hyphens")
        if count > 1:
            raise DerivationError(f"{key}: {count} claims have this key")
    return tuple(
        Chapter(
            name=derivation.name,
            summary=derivation.summary,
            entries=tuple(
                Entry(claim=claim, found=tuple(_found(claim))) for claim in derivation.claims
            ),
        )
        for derivation in derivations
        if derivation.claims
    )


def every_entry(register: tuple[Chapter, ...]) -> list[Entry]:
    """All entries in order."""
    return [entry for chapter in register for entry in chapter.entries]


def tally(register: tuple[Chapter, ...]) -> dict[Verdict, int]:
    """How many entries each verdict has, verdicts without any included."""
    counts = Counter(entry.claim.verdict for entry in every_entry(register))
    return {verdict: counts[verdict] for verdict in Verdict}


def proof_files(register: tuple[Chapter, ...]) -> dict[str, str]:
    """Every stored query by its file."""
    return {
        found.proof: found.finding.query
        for entry in every_entry(register)
        for found in entry.found
        if found.proof
    }


def as_json(register: tuple[Chapter, ...]) -> str:
    """The register for programs."""
    content = {
        "counts": {verdict.words: count for verdict, count in tally(register).items()},
        "claims": [
            _entry_json(entry, chapter) for chapter in register for entry in chapter.entries
        ],
    }
    return json.dumps(content, indent=2, ensure_ascii=False) + "\n"


def _entry_json(entry: Entry, chapter: Chapter) -> dict[str, Any]:
    claim = entry.claim
    return {
        "key": claim.key,
        "title": claim.title,
        "place": claim.place,
        "verdict": claim.verdict.words,
        "printed": claim.printed,
        "derived": claim.derived,
        "hypotheses": list(claim.hypotheses),
        "added": list(claim.added),
        "steps": list(claim.steps),
        "findings": [_found_json(found) for found in entry.found],
        "derivation": chapter.source,
    }


def _found_json(found: Found) -> dict[str, Any]:
    return {
        "about": ABOUT[found.about],
        "what": found.finding.what,
        "holds": found.finding.holds,
        "route": found.route,
        "how": found.finding.how,
        "formal": found.finding.formal,
        "witness": dict(found.finding.witness),
        "proof": found.proof or None,
        "answer": found.answer or None,
    }


def _found(claim: Claim) -> Iterator[Found]:
    """The findings of a claim in its own order, numbered from 1 for their files."""
    of_groups = [(about, finding) for about in ABOUT for finding in getattr(claim, about)]
    for number, (about, finding) in enumerate(of_groups, start=1):
        yield Found(
            finding=finding,
            about=about,
            route=_route(finding),
            proof=f"proofs/{claim.key}-{number}.smt2" if finding.query else "",
            answer=_answer(claim, finding),
        )


def _route(finding: Finding) -> str:
    for route in ("identity", "z3", "certificate"):
        if finding.how.startswith(route):
            return route
    return "witness"


def _answer(claim: Claim, finding: Finding) -> str:
    if not finding.query:
        return ""
    if finding.how not in ANSWERS:
        raise DerivationError(f"{claim.key}: no known answer to a query: {finding.how}")
    return ANSWERS[finding.how]
