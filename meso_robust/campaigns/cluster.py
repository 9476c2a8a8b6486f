"""A Dask cluster as the crew of a campaign (extra ``cluster``)."""

from __future__ import annotations

import gc
import time
from collections.abc import Callable
from concurrent.futures import CancelledError, Future
from contextlib import suppress
from functools import partial
from typing import Any

from meso_robust.campaigns.executor import CrewLostError, Found
from meso_robust.errors import InputError

CONNECT = 20.0  # s for one attempt to reach the scheduler
PATIENCE = 60.0  # s for which a lost scheduler, or a first worker, is waited for
PAUSE = 0.2  # s between two looks


class Cluster:
    """The workers of a Dask scheduler; each should have one thread."""

    def __init__(self, address: str) -> None:
        """Reach a scheduler.

        Parameters
        ----------
        address
            Such as ``tcp://192.168.0.5:8786``.

        Raises
        ------
        InputError
            Dask is not installed, or nothing answers at the address.
        """
        try:
            import distributed
        except ImportError as error:
            raise InputError(
                "--scheduler: needs Dask; install it: pip install 'meso-robust[cluster]'"
            ) from error
        self._dask = distributed
        self._address = address
        self._client: Any = None
        self._connect(CONNECT)

    def _connect(self, patience: float) -> None:
        until = time.monotonic() + patience
        while True:
            # A client that failed closes itself when it is collected; were that while another starts,
            # both would wait for one lock of Dask's for ever.
            gc.collect()
            try:
                self._client = self._dask.Client(
                    self._address, timeout=CONNECT, set_as_default=False, name="meso-robust"
                )
                self._pool = self._client.get_executor(pure=False, retries=0)
            except (OSError, ValueError, ImportError, AssertionError) as error:
                # an assertion: Dask's own thread did not start within ten seconds, as on a busy machine
                passing = isinstance(error, OSError | AssertionError)
                if time.monotonic() > until or not passing:
                    raise InputError(
                        f"--scheduler {self._address}: cannot be reached ({error}); give the address "
                        "that `dask scheduler` prints; finished work is kept; continue with --resume"
                    ) from error
                time.sleep(1.0)
            else:
                return

    @property
    def name(self) -> str:
        """As the report describes it."""
        return f"Dask at {self._address}"

    @property
    def size(self) -> int:
        """One chunk for every worker that is there now; waits a while for the first.

        Raises
        ------
        InputError
            None comes.
        """
        until = time.monotonic() + PATIENCE
        while not (workers := len(self._client.scheduler_info(n_workers=-1)["workers"])):
            if time.monotonic() > until:
                raise InputError(
                    f"--scheduler {self._address}: has no workers; start some (`dask worker "
                    f"{self._address} --nthreads 1`); finished work is kept; continue with --resume"
                )
            time.sleep(PAUSE)
        return workers

    def submit(self, do: Callable[[str, int], Found], part: str, chunk: int) -> Future[Found]:
        """Have a chunk done."""
        try:
            return self._pool.submit(do, part, chunk)
        except (OSError, RuntimeError) as error:
            raise CrewLostError(str(error)) from error

    def lost(self, error: BaseException) -> bool:
        """Whether the connection was lost. Workers that die are Dask's own business."""
        return isinstance(error, CancelledError) or self._client.status != "running"

    def renew(self) -> None:
        """Reconnect; the scheduler forgets what was under way."""
        self.close()
        self._connect(PATIENCE)

    def close(self) -> None:
        """Forget what is under way and let go of the scheduler."""
        client, self._client = self._client, None
        if client is not None:
            # of a scheduler that is gone already; the client is closed whatever the pool says, or its thread goes on
            for end in (partial(self._pool.shutdown, wait=False), partial(client.close, CONNECT)):
                with suppress(self._dask.client.ClosedClientError, OSError):
                    end()
