"""``check``: a certificate verified again, by independent formulas."""

from __future__ import annotations

import json
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Protocol, TypeAlias, Union

from meso_robust.api.call import call
from meso_robust.api.inputs import files_of, task_of
from meso_robust.api.options import Option, TaskGiven
from meso_robust.api.progress import SILENT, Progress
from meso_robust.api.result import Result

if TYPE_CHECKING:  # nothing of what is checked is imported: a check shares no code with it
    from meso_robust.certificates.document import CertificateDocument
    from meso_robust.checker.document import Certificate
    from meso_robust.checker.verdict import Answer, Word
    from meso_robust.task import Task


class Certified(Protocol):
    """What holds a certificate, as what :func:`meso_robust.plan` returns does."""

    @property
    def certificate(self) -> CertificateDocument:
        """The content of ``certificate.json``."""


CertificateGiven: TypeAlias = Annotated[
    Union["CertificateDocument", "Certified", str, PathLike[str]],
    Option(words="The certificate (certificate.json)."),
]


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
        """VERIFIED, REJECTED, NOTHING CLAIMED, or of a witness CONFIRMED or UNDECIDED."""
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


@call
def check(
    certificate: CertificateGiven,
    task: TaskGiven,
    *,
    thorough: bool = False,
    progress: Progress = SILENT,
) -> Checked:
    """Verify a certificate without the planner, in exact and ball arithmetic.

    Parameters
    ----------
    certificate
        The certificate, what holds it, or the name of its file (``certificate.json``).
    task
        The task it is about, or the name of its file.
    thorough
        Also the margin of each uncertainty alone.
    progress
        Shows what is being done.

    Returns
    -------
    Checked
        Whatever the verdict: a certificate that was tampered with gives a result too.

    Raises
    ------
    InputError
        A file cannot be read, is not a certificate, or is one for another task.

    Examples
    --------
    Of the plan of :func:`meso_robust.plan`'s example:

    >>> checked = mr.check(planned.certificate, task)
    >>> checked, checked.verified
    (<Checked VERIFIED: paper, Section IX-E>, True)

    A changed value is detected:

    >>> changed = planned.certificate.model_copy(update={"verdict": "UNKNOWN"})
    >>> print(mr.check(changed, task))
    REJECTED (point tips): digest: the SHA-256 of all other values
    stated: ...
    found: ...
    """
    from meso_robust.api.aside import aside

    with aside() as asked:
        from meso_robust.checker.verdict import check as verified

        known = task_of(task)
        found, digest = _read(certificate, known)
        with progress.doing("verifying"):
            elsewhere = asked(found, known, alone=thorough)
            answer = verified(found, digest, known, thorough=thorough, elsewhere=elsewhere)
    return Checked(answer=answer, certificate=found, task=known, inputs=files_of(certificate, task))


def _read(certificate: CertificateGiven, task: Task) -> tuple[Certificate, str]:
    from meso_robust.checker.reading import accepted_certificate, read_certificate

    if isinstance(certificate, str | PathLike):
        return read_certificate(Path(certificate), task)
    document: Any = getattr(certificate, "certificate", certificate)  # of a plan, that which it has
    return accepted_certificate(
        document.model_dump(mode="json", by_alias=True, warnings=False), "certificate", task
    )
