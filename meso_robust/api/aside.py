"""The margin verified by a process of its own, while this one verifies the moves.

Both take about equally long and share nothing, so that on two cores a check takes little more than half of
the time. The process is begun first of all: it imports what it needs while this one reads the files. What it
says is believed only if it is that the margin is verified; otherwise it is verified here, and said here what
is wrong with it.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Protocol

from meso_robust.lifetime import short
from meso_robust.provenance import cores

if TYPE_CHECKING:  # nothing that takes long to import before the process is begun
    from meso_robust.checker.document import Certificate
    from meso_robust.task import Task

SAYS = b"the margin is verified"


class Asked(Protocol):
    """Asks for a margin, once."""

    def __call__(self, certificate: Certificate, task: Task, *, alone: bool) -> Callable[[], bool]:
        """Begin to verify it.

        Parameters
        ----------
        certificate, task, alone
            As of :func:`meso_robust.checker.margin.check_factor`.

        Returns
        -------
        Callable[[], bool]
            Waits for the process and says whether it has verified the margin.
        """


@contextmanager
def aside() -> Iterator[Asked]:
    """Begin another process that can verify a margin, if there is a core for it.

    Yields
    ------
    Asked
        What tells it which one.
    """
    process = _begun() if cores() > 1 else None
    if process is None:
        yield lambda certificate, task, *, alone: lambda: False
        return

    def asked(certificate: Certificate, task: Task, *, alone: bool) -> Callable[[], bool]:
        told = [one.model_dump(mode="json", by_alias=True) for one in (certificate, task)]
        # in a thread: it is read when all is imported there
        answer = pool.submit(process.communicate, json.dumps([*told, alone]).encode())
        return lambda: answer.result()[0] == SAYS

    with process, ThreadPoolExecutor(1) as pool:
        try:
            yield asked
        finally:
            process.kill()


def _begun() -> subprocess.Popen[bytes] | None:
    # the same code as here, whatever lies in the present folder
    path = [str(Path(__file__).parents[2]), *filter(None, [os.environ.get("PYTHONPATH")])]
    try:
        return subprocess.Popen(
            [sys.executable, "-P", "-m", __name__],
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL,
            env={**os.environ, "PYTHONPATH": os.pathsep.join(path)},
        )  # fmt: skip
    except OSError:
        return None


def _verify() -> None:
    short()
    from flint import ctx

    from meso_robust.checker.document import Certificate
    from meso_robust.checker.margin import check_factor
    from meso_robust.checker.verdict import BITS
    from meso_robust.task import Task

    certificate, task, alone = json.load(sys.stdin)
    with ctx.workprec(BITS):
        check_factor(
            Certificate.model_validate_json(json.dumps(certificate)),
            Task.model_validate_json(json.dumps(task)),
            alone=alone,
        )
    sys.stdout.buffer.write(SAYS)


if __name__ == "__main__":
    _verify()
