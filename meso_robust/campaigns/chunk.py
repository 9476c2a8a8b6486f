"""Doing a chunk, in whatever process: everything comes with the call, the answer is text."""

from __future__ import annotations

import os
import socket
import threading
import time
from functools import lru_cache
from typing import Any

from meso_robust.campaigns.encoding import part_of, result_text
from meso_robust.campaigns.kind import Done, Kind, Part
from meso_robust.campaigns.kinds import kind_of
from meso_robust.campaigns.provenance import code
from meso_robust.kernels import one_thread

_ONE_AT_A_TIME = threading.Lock()  # a worker of a cluster may have several threads


@lru_cache(maxsize=2)
def _ready(text: str) -> tuple[Kind, Part, Any]:
    part = part_of(text)
    kind = kind_of(part.kind)
    return kind, part, kind.prepare(part)


def do(text: str, chunk: int) -> Done:
    """Do a chunk.

    Parameters
    ----------
    text
        The part, from ``encoding.part_text``.
    chunk
        Its index.
    """
    with _ONE_AT_A_TIME, one_thread():
        kind, part, prepared = _ready(text)
        begun = time.perf_counter()
        found = result_text(kind.execute(prepared, part, chunk))
        return Done(
            text=found,
            seconds=time.perf_counter() - begun,
            worker=f"{socket.gethostname()}:{os.getpid()}",
            code=code(),
        )
