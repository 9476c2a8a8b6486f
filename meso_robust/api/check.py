"""``check``: a certificate verified again, by independent formulas."""

from __future__ import annotations

from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, TypeAlias, Union

from meso_robust.api.call import call
from meso_robust.api.checked import Checked, accepted, checked
from meso_robust.api.inputs import files_of, task_of
from meso_robust.api.options import Option, TaskGiven
from meso_robust.api.progress import SILENT, Progress

if TYPE_CHECKING:  # nothing of what is checked is imported: a check shares no code with it
    from meso_robust.api.plan import Planned
    from meso_robust.certificates.document import CertificateDocument
    from meso_robust.checker.document import Certificate
    from meso_robust.task import Task

CertificateGiven: TypeAlias = Annotated[
    Union["CertificateDocument", "Planned", str, PathLike[str]],
    Option(words="The certificate (certificate.json)."),
]


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
    known = task_of(task)
    return checked(
        lambda: _read(certificate, known),
        known,
        thorough=thorough,
        progress=progress,
        inputs=files_of(certificate, task),
    )


def _read(certificate: CertificateGiven, task: Task) -> tuple[Certificate, str]:
    if isinstance(certificate, str | PathLike):
        from meso_robust.checker.reading import read_certificate

        return read_certificate(Path(certificate), task)
    # of a plan, that which it has
    return accepted(getattr(certificate, "certificate", certificate), task)
