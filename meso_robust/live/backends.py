"""The devices that a laboratory's file asks for."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from meso_robust.live.devices import Devices
from meso_robust.live.lab_file import Lab
from meso_robust.task import Task


@contextmanager
def devices_of(lab: Lab, task: Task, folder: Path) -> Iterator[Devices]:
    """The devices of a laboratory, released at the end.

    Parameters
    ----------
    lab
        The laboratory.
    task
        What a virtual one lays down.
    folder
        Where a configuration file that it names is.

    Yields
    ------
    Devices
        Ready.

    Raises
    ------
    InputError
        They cannot be reached.
    """
    if lab.backend == "virtual":
        from meso_robust.live.virtual_bench import laboratory_of

        yield laboratory_of(task, lab).devices()
    elif lab.backend == "pipe":
        from meso_robust.live.pipe import piped

        with piped(lab, folder) as devices:
            yield devices
    else:
        from meso_robust.live.micromanager import connected

        with connected(lab, folder) as devices:
            yield devices
