"""``meso-robust check``: re-verifies a certificate by a route of its own."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from meso_robust.cli.console import NEGATIVE, Reporter, refuse

if TYPE_CHECKING:
    from meso_robust.checker.verdict import Answer


def check(
    certificate: Annotated[Path, typer.Argument(help="The certificate (certificate.json).")],
    task: Annotated[
        Path | None, typer.Argument(help="Its task (TOML); the paper's task if left out.")
    ] = None,
    thorough: Annotated[
        bool, typer.Option("--thorough", help="Also the margin of each uncertainty alone.")
    ] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print the answer as JSON only.")] = False,
    quiet: Annotated[bool, typer.Option("--quiet", help="Say nothing but the verdict.")] = False,
) -> None:
    """Verify a certificate without the planner, in exact and ball arithmetic."""
    from meso_robust.checker.reading import read_certificate
    from meso_robust.checker.verdict import check as verify
    from meso_robust.errors import InputError
    from meso_robust.task import load_task
    from meso_robust.tasks import PAPER

    try:
        known = load_task(task or PAPER)
        found, digest = read_certificate(certificate, known)
    except InputError as error:
        refuse(error)
    with Reporter(quiet or as_json).doing("verifying"):
        answer = verify(found, digest, known, thorough=thorough)
    if as_json:
        print(json.dumps(_document(answer), indent=2, ensure_ascii=False))
    else:
        print("\n".join(_lines(answer, quiet)))
    if not answer.positive:
        raise typer.Exit(NEGATIVE)


def _document(answer: Answer) -> dict[str, object]:
    refused = answer.refused
    return {
        "schema": "meso-robust/check/1",
        "verdict": answer.verdict,
        "claims": answer.claims,
        "rejected": None
        if refused is None
        else {"claim": refused.claim, "stated": refused.stated, "found": refused.found},
        "not_checked": list(answer.not_checked),
    }


def _lines(answer: Answer, quiet: bool) -> list[str]:
    refused = answer.refused
    if refused is not None:
        head = f"{answer.verdict}: {refused.claim}"
        return [head, f"stated: {refused.stated}", f"found: {refused.found}"]
    if quiet:
        return [answer.verdict]
    evidence = [f"not checked (evidence, not proof): {one}" for one in answer.not_checked]
    return [f"{answer.verdict}: {answer.claims}", *evidence]
