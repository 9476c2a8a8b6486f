"""``drive``: the laboratory's side of a plan or policy, a sensed pose in, a move out."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from meso_robust.api.call import call
from meso_robust.api.inputs import StrPath, task_of
from meso_robust.planning.document import box_document
from meso_robust.policy.controller import (
    Controller,
    Done,
    Refused,
    Reply,
    commanded,
    controller_of,
    rehearsed,
)
from meso_robust.policy.pose import PoseError, parse
from meso_robust.task import Task


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Driver:
    """Answers sensed poses, one after the other, of one part after the other.

    ``done`` and ``refused`` end a part: the next pose is taken as the first of the next one.

    Attributes
    ----------
    controller
        Knows what was answered so far.
    task
        What the plan is for.
    """

    controller: Controller
    task: Task

    def answer(self, x_um: float, y_um: float, theta_deg: float) -> dict[str, Any]:
        """What to do from a pose that is sensed now; see :meth:`answer_line`."""
        values = {"x_um": float(x_um), "y_um": float(y_um), "theta_deg": float(theta_deg)}
        return self.answer_line(json.dumps(values))

    def answer_line(self, line: str) -> dict[str, Any]:
        """What to do from a pose as a line of JSON.

        Returns
        -------
        dict
            A move, ``{"done": True, "within": ...}``, ``{"refused": "..."}`` (nothing is proved from
            there) or ``{"error": "..."}`` (no pose; nothing is changed).
        """
        try:
            return _told(self.controller.answer(parse(line)), self.task)
        except PoseError as error:
            return {"error": str(error)}


@call
def drive(task: Task | StrPath, plan: StrPath) -> Driver:
    """Prove a plan before anything is moved, and make ready what answers sensed poses.

    Parameters
    ----------
    task
        The task, or the name of its file.
    plan
        A ``plan.json`` or a ``policy.json`` for it.

    Raises
    ------
    InputError
        A file or a value breaks a rule, or the plan was made for another task.
    NotApplicableError
        The plan is not proved.

    Examples
    --------
    The plan of :func:`meso_robust.plan`'s example:

    >>> import tempfile
    >>> from pathlib import Path
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     planned.save(folder)
    ...     driver = mr.drive(task, Path(folder) / "plan.json")
    >>> driver.answer(2060.4, -9.2, 90.0)["primitive"]
    'y_translation'
    >>> driver.answer(9000.0, 0.0, 90.0)
    {'refused': '...'}
    """
    known = task_of(task)
    driver = Driver(controller=controller_of(Path(plan), known), task=known)
    for reply in rehearsed(driver.controller):  # imports and compiles what an answer needs
        _told(reply, known)
    return driver


def _told(reply: Reply, task: Task) -> dict[str, Any]:
    if isinstance(reply, Refused):
        return {"refused": reply.why}
    if isinstance(reply, Done):
        return {"done": True, "within": box_document(reply.within).model_dump()}
    return commanded(reply, task).model_dump(mode="json")
