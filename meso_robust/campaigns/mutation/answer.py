"""What the checker says to a tampered certificate."""

from __future__ import annotations

import json
from dataclasses import dataclass

from meso_robust.campaigns.mutation.places import Document
from meso_robust.checker.prover import PLAIN, Prover
from meso_robust.checker.reading import parse_certificate
from meso_robust.checker.verdict import check
from meso_robust.errors import InputError
from meso_robust.task import Task

MALFORMED, REJECTED, VERIFIED = "malformed", "REJECTED", "VERIFIED"
ACCEPTED = (VERIFIED, "WITNESS CONFIRMED")
"""Answers by which the checker says that a claim is true: of a proof, and of a run that fails."""


@dataclass(frozen=True, slots=True)
class Reply:
    """An answer, and the objection if there is one."""

    word: str
    """``malformed``, or the checker's verdict."""
    why: str = ""


def answered(document: Document, task: Task, prover: Prover = PLAIN) -> Reply:
    """Read and check a certificate."""
    try:
        certificate, own = parse_certificate(json.dumps(document), "certificate", task)
    except InputError as error:
        return Reply(MALFORMED, str(error))
    found = check(certificate, own, task, prover=prover)
    return Reply(found.verdict, "" if found.refused is None else found.refused.name.key)
