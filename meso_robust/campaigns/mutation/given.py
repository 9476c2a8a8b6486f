"""What a campaign of tampered certificates reads."""

from __future__ import annotations

import json
from pathlib import Path

from meso_robust import __version__
from meso_robust.campaigns.kind import Values
from meso_robust.campaigns.mutation.answer import VERIFIED, answered
from meso_robust.campaigns.mutation.places import Document, sealed
from meso_robust.campaigns.mutation.section import MutationSection
from meso_robust.campaigns.planned import given_plan
from meso_robust.checker.reading import read_certificate
from meso_robust.errors import InputError
from meso_robust.pipeline import SimulatorContradictsProofError, judge
from meso_robust.planning.compose import Found
from meso_robust.planning.document import PlanDocument
from meso_robust.planning.rules import rules_of
from meso_robust.task import Task, load_task
from meso_robust.tasks import PAPER

SAMPLES = 100
"""Runs in the simulator of a certificate that is generated: none is tampered with."""


def given_certificate(section: MutationSection, folder: Path) -> Values:
    """The task and a true certificate for it, as JSON values.

    Raises
    ------
    InputError
        A file cannot be read or breaks a rule, or there is no proof to tamper with.
    """
    task = load_task(PAPER if section.task is None else folder / section.task)
    if task.slot is not None:
        task.rectangle("a campaign of changed certificates with walls")
    if section.certificate is None:
        given = given_plan(section, folder)
        return {"task": given["task"], "certificate": _accepted(_made(given, task), task, "plan")}
    path = folder / section.certificate
    found, digest = read_certificate(path, task)
    document = {**found.model_dump(mode="json", by_alias=True), "digest": digest}
    if digest != found.digest:
        raise InputError(
            f"{path}: key digest = {found.digest!r}: must be {digest!r}, the digest of its values; give "
            "the certificate as originally written"
        )
    values = task.model_dump(mode="json", by_alias=True)
    return {"task": values, "certificate": _accepted(sealed(document), task, str(path))}


def _made(given: Values, task: Task) -> Document:
    """The certificate of a plan, without the names of machine and commit."""
    plan = PlanDocument.model_validate_json(json.dumps(given["plan"]), strict=True)
    rules = rules_of(plan)
    if not rules:
        raise InputError("the plan states no policy: give a plan that `meso-robust plan` made")
    try:
        made = judge(task, Found(rules=rules, scale=1.0), SAMPLES, 0).certificate
    except SimulatorContradictsProofError as error:
        raise InputError(f"task {task.name!r}: no certificate can be made: {error}") from error
    made = made.model_copy(update={"made_with": {"meso-robust": __version__}})
    document: Document = json.loads(made.model_dump_json(by_alias=True))
    return sealed(document)


def _accepted(document: Document, task: Task, source: str) -> Document:
    """The certificate, if it is one that the checker accepts as PROVED."""
    reply = answered(document, task)
    if document["verdict"] != "PROVED" or reply.word != VERIFIED:
        raise InputError(
            f"{source}: the certificate says {document['verdict']} and the checker {reply.word}"
            f"{reply.why and f' ({reply.why})'}; must be PROVED and {VERIFIED}: otherwise tampering with it "
            "would show nothing; give another task or plan"
        )
    return document
