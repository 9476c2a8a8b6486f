"""The margin verified by a process of its own, while this one verifies the moves.

Both take about equally long and share nothing, so that on two cores a check takes little more than half of
the time. What the process says is believed only if it is that the margin is verified; otherwise it is verified
here, and said here what is wrong with it.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryFile

from flint import ctx

from meso_robust.checker.document import Certificate
from meso_robust.checker.margin import check_factor
from meso_robust.checker.verdict import BITS
from meso_robust.provenance import cores
from meso_robust.task import Task

SAYS = b"the margin is verified"


@contextmanager
def aside(certificate: Certificate, task: Task, *, alone: bool) -> Iterator[Callable[[], bool]]:
    """Verify the margin in another process, if there is a core for it.

    Parameters
    ----------
    certificate, task, alone
        As of :func:`meso_robust.checker.margin.check_factor`.

    Yields
    ------
    Callable[[], bool]
        Waits for the process and says whether it has verified the margin.
    """
    process = _begun(certificate, task, alone) if cores() > 1 else None
    if process is None:
        yield lambda: False
        return
    with process:
        try:
            yield lambda: process.communicate()[0] == SAYS
        finally:
            process.kill()


def _begun(certificate: Certificate, task: Task, alone: bool) -> subprocess.Popen[bytes] | None:
    # the same code as here, whatever lies in the present folder
    path = [str(Path(__file__).parents[2]), *filter(None, [os.environ.get("PYTHONPATH")])]
    told = [one.model_dump(mode="json", by_alias=True) for one in (certificate, task)]
    with TemporaryFile("w+", encoding="utf-8") as given:
        json.dump([*told, alone], given)
        given.seek(0)
        try:
            return subprocess.Popen(
                [sys.executable, "-P", "-m", __name__],
                stdin=given, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL,
                env={**os.environ, "PYTHONPATH": os.pathsep.join(path)},
            )  # fmt: skip
        except OSError:
            return None


def _verify() -> None:
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
