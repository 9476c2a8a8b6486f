"""``drive``: the laboratory's side of a plan or policy, a sensed pose in, a move out."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from meso_robust.api.call import call
from meso_robust.api.inputs import task_of
from meso_robust.api.options import StrPath, TaskGiven
from meso_robust.api.progress import SILENT, Progress

if TYPE_CHECKING:
    from meso_robust.policy.controller import Controller, Reply
    from meso_robust.task import Task


AT_MOST_S = 60.0
"""Of the wait for starts beyond those that the task states, on a machine that is busy: what is answered should not depend on that."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Driver:
    """Answers sensed poses one after another, for one part after another.

    ``done`` and ``refused`` end a part: the next pose is taken as the first of the next one.

    Attributes
    ----------
    controller
        Keeps track of what was answered so far.
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
        from meso_robust.policy.pose import PoseError, parse

        try:
            return _told(self.controller.answer(parse(line)), self.task)
        except PoseError as error:
            return {"error": str(error)}


@call
def drive(task: TaskGiven, plan: StrPath, *, progress: Progress = SILENT) -> Driver:
    """Prove a plan before anything is moved, and prepare to answer sensed poses.

    Parameters
    ----------
    task
        The task, or the name of its file.
    plan
        Plan (``plan.json``) or policy (``policy.json``) for it.
    progress
        Shows what is being done.

    Returns
    -------
    Driver
        Answers sensed poses.

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
    _check_form(Path(plan), known)

    from meso_robust.policy.controller import controller_of, rehearsed

    with progress.doing("proving the plan before anything is moved"):
        driver = Driver(controller=controller_of(Path(plan), known), task=known)
        for reply in rehearsed(driver.controller):  # imports and compiles what an answer needs
            _told(reply, known)
    with progress.doing("looking for further starts that the plan is proved from"):
        # a pose that is among those found later is refused until then, not waited for
        driver.controller.settle(AT_MOST_S)
    return driver


def _check_form(plan: Path, task: Task) -> None:
    """Refuse a bad file before the imports that take seconds."""
    from meso_robust.planning.reading import read_plan, read_text
    from meso_robust.policy.policy_file import read_document

    (read_document if '"meso-robust/policy/' in read_text(plan) else read_plan)(plan, task)


def _told(reply: Reply, task: Task) -> dict[str, Any]:
    from meso_robust.planning.document import box_document
    from meso_robust.policy.controller import Done, Refused, commanded

    if isinstance(reply, Refused):
        return {"refused": reply.why}
    if isinstance(reply, Done):
        return {"done": True, "within": box_document(reply.within).model_dump()}
    return commanded(reply, task).model_dump(mode="json")
