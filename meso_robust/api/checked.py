"""What is found out about a certificate, by ``check`` and by ``plan --check``."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from meso_robust.api.progress import SILENT, Progress
from meso_robust.api.result import Result

if TYPE_CHECKING:  # nothing of what is checked is imported: a check shares no code with it
    from meso_robust.checker.document import Certificate
    from meso_robust.checker.verdict import Answer, Word
    from meso_robust.task import Task


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Checked(Result):
    """The outcome of checking a certificate.

    Attributes
    ----------
    answer
        The verdict, what is claimed, what was rejected, and what cannot be checked.
    certificate, task
        What was checked, and the task it is about.
    """

    answer: Answer
    certificate: Certificate
    task: Task

    @property
    def verdict(self) -> Word:
        """VERIFIED, REJECTED, NOTHING CLAIMED, MARGIN UNDECIDED, or of a witness CONFIRMED or UNDECIDED."""
        return self.answer.verdict

    @property
    def positive(self) -> bool:
        """Whether the certificate proves that its plan reaches the goal."""
        return self.answer.positive

    verified = positive

    @property
    def brief(self) -> str:
        """The verdict; of a rejected certificate also the reason."""
        return self.verdict if self.answer.refused is None else str(self)

    @property
    def shown(self) -> dict[str, str]:
        """Nothing: the answer says all."""
        return {}

    @property
    def document(self) -> dict[str, Any]:
        """The answer as plain values."""
        refused = self.answer.refused
        return {
            "schema": "meso-robust/check/1",
            "verdict": self.verdict,
            "claims": self.answer.claims,
            "premises": dict(self.answer.premises),
            "rejected": None
            if refused is None
            else {
                "id": refused.name.id,
                "about": dict(refused.name.about),
                "at": refused.name.at,
                "claim": refused.claim,
                "stated": refused.stated,
                "found": refused.found,
            },
            "not_checked": list(self.answer.not_checked),
        }

    def text(self) -> str:
        """``document`` as JSON."""
        return json.dumps(self.document, indent=2, ensure_ascii=False) + "\n"

    def files(self) -> dict[str, str]:
        """The answer as the only file, ``check.json``."""
        return {"check.json": self.text()}

    def __str__(self) -> str:
        refused = self.answer.refused
        verdict = f"{self.verdict} ({self.task.tips})"
        if refused is not None:
            head = f"{verdict}: {refused.claim}"
            return "\n".join([head, f"stated: {refused.stated}", f"found: {refused.found}"])
        evidence = [f"not checked (evidence, not proof): {one}" for one in self.answer.not_checked]
        premises = (
            [f"taken for granted: {', '.join(self.answer.premises)}"] if self.verified else []
        )
        return "\n".join([f"{verdict}: {self.answer.claims}", *premises, *evidence])

    def __repr__(self) -> str:
        return f"<Checked {self.verdict}: {self.task.name}>"

    def _repr_html_(self) -> str:
        from meso_robust.reporting.cards import checked_card

        return checked_card(self.answer, self.certificate, self.task, str(self))


def checked(
    read: Callable[[], tuple[Certificate, str]],
    task: Task,
    *,
    thorough: bool = False,
    progress: Progress = SILENT,
    inputs: tuple[Path, ...] = (),
) -> Checked:
    """Verify a certificate.

    Parameters
    ----------
    read
        Reads the certificate and gives it with the hash of its values.
    task
        The task it is about.
    thorough, progress
        As for :func:`meso_robust.check`.
    inputs
        The files that were given.

    Returns
    -------
    Checked
        Whatever the verdict.
    """
    from meso_robust.api.aside import aside

    with aside() as asked:
        from meso_robust.checker.verdict import check as verified

        found, digest = read()
        with progress.doing("verifying"):
            elsewhere = asked(found, task, alone=thorough)
            answer = verified(found, digest, task, thorough=thorough, elsewhere=elsewhere)
    return Checked(answer=answer, certificate=found, task=task, inputs=inputs)


def accepted(document: Any, task: Task) -> tuple[Certificate, str]:
    """The certificate that a document holds, for :func:`checked`.

    Parameters
    ----------
    document
        A certificate as a value.
    task
        The task it is about.

    Returns
    -------
    tuple[Certificate, str]
        The certificate as the checker reads it, and the hash of its values.

    Raises
    ------
    InputError
        It is no certificate, or one for another task.
    """
    from meso_robust.checker.reading import accepted_certificate

    values = document.model_dump(mode="json", by_alias=True, warnings=False)
    return accepted_certificate(values, "certificate", task)
