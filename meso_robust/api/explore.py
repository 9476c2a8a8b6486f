"""``run --experiment``: designed pushes made, then identified, diagnosed, and the task planned again."""

from __future__ import annotations

import os
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from meso_robust.api.diagnose import Diagnosed, diagnose
from meso_robust.api.identify import Identified, identify
from meso_robust.api.inputs import task_of
from meso_robust.api.options import StrPath
from meso_robust.api.plan import Planned, plan
from meso_robust.api.progress import SILENT, Progress
from meso_robust.api.result import Result
from meso_robust.api.run import Ran
from meso_robust.errors import InputError, NotApplicableError
from meso_robust.identification.document import parse_model
from meso_robust.live.setting_right import SetRight, set_right
from meso_robust.toml_files import toml_of

SET_RIGHT: Mapping[str, str] = {
    "camera_rotation": "put rotation_deg of the camera in lab.toml right by it",
    "camera_scale": "put pixel_size_um of the camera in lab.toml right by it",
    "lens_distortion": "put k1 of the camera in lab.toml right by it",
    "camera_latency": "put the clock right by which frames are stamped",
    "tip_radius": "put radius_um of the tip in lab.toml right by it",
}
"""What a laboratory can do about an effect that it need not put up with."""


RIGHTED = "lab.toml"
"""Name among the results of the laboratory's file with its camera put right."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Explored(Result):
    """What an experiment came to.

    Attributes
    ----------
    ran
        The pushes.
    identified, diagnosed, planned
        What followed; None from where it could not go on.
    set_right
        The laboratory that the plan is for, if it is proved with the camera put right only; None if it is
        for the laboratory as it was.
    why
        Why it could not; empty if it ended with a plan.
    """

    ran: Ran
    identified: Identified | None = None
    diagnosed: Diagnosed | None = None
    planned: Planned | None = None
    set_right: SetRight | None = None
    why: str = ""

    @property
    def positive(self) -> bool:
        """Whether the task is proved with what was measured."""
        return self.planned is not None and self.planned.positive

    @property
    def advice(self) -> str:
        """What the laboratory can do where nothing is proved, in one sentence; empty if the task is."""
        from meso_robust.reporting.diagnosis_words import effect_words
        from meso_robust.transfer.answer import settled_by

        if self.positive:
            return ""
        said = None if self.diagnosed is None else self.diagnosed.document
        told = [] if said is None else [one for one in said.effects if one.name in SET_RIGHT]
        if told:
            each = [f"{effect_words(one)}: {SET_RIGHT[one.name]}, run again" for one in told]
            return "; ".join(each)
        if said is not None and said.verdict not in ("consistent", "named"):
            push = said.next_experiment.push.what or said.next_experiment.why
            return f"the pushes do not single out what is amiss; next: {push}"
        if self.planned is None or self.planned.promise is None:
            return self.why
        return "; ".join(settled_by(self.planned.promise))

    @property
    def shown(self) -> dict[str, str]:
        """The reports."""
        parts = {
            "identification": self.identified, "diagnosis": self.diagnosed, "plan": self.planned,
        }  # fmt: skip
        return {name: f"{name}/report.html" for name, one in parts.items() if one is not None}

    def __str__(self) -> str:
        parts = (self.ran, self.identified, self.diagnosed, self.planned)
        said = [str(one) for one in parts if one is not None]
        if self.set_right is not None:
            said.append(
                f"proved of the laboratory put right by this: {self.set_right.words}; use {RIGHTED} of the "
                "results. What is left of the camera's error is in the plan's bounds"
            )
        ended = [f"ended there: {self.why}"] if self.why else []
        advice = [f"to go on: {self.advice}"] if self.advice and self.advice != self.why else []
        return "\n".join([*said, *ended, *advice])

    def text(self) -> str:
        """The text of ``run.json``."""
        return self.ran.text()

    def files(self) -> dict[str, str]:
        """The texts of all result files by name, those of each step in a folder of its own."""
        found = dict(self.ran.files())
        parts: dict[str, Result | None] = {
            "identification": self.identified, "diagnosis": self.diagnosed, "plan": self.planned,
        }  # fmt: skip
        for folder, one in parts.items():
            if one is not None:
                found |= {f"{folder}/{name}": text for name, text in one.files().items()}
        if self.set_right is not None:
            found[RIGHTED] = toml_of(self.set_right.lab)
            found["plan/model.toml"] = toml_of(self.set_right.model)
        return found


def explored(
    task: Any, ran: Ran, folder: StrPath, seed: int, progress: Progress = SILENT
) -> Explored:
    """Identify, diagnose and plan again from the recordings of a run.

    Parameters
    ----------
    task
        The task that was stated.
    ran
        The pushes.
    folder
        Where the model is put meanwhile, under a temporary name.
    seed, progress
        As of the calls that are made.

    Returns
    -------
    Explored
        However far it came.
    """
    made = ran.recordings()
    if made is None or ran.document.outcome != "done":
        return Explored(ran=ran, why="not all pushes were made")
    identified = diagnosed = right = None
    try:
        identified = identify(made, starts=4, seed=seed, progress=progress)
        diagnosed = diagnose(made, quick=True, seed=seed, progress=progress)
        planned = _planned(task, diagnosed.model_toml, folder, seed, progress)
        if not planned.positive:
            right = set_right(
                ran.header.lab, parse_model(tomllib.loads(diagnosed.model_toml), "the diagnosis")
            )
        if right is not None:
            again = _planned(task, toml_of(right.model), folder, seed, progress)
            planned, right = (again, right) if again.positive else (planned, None)
    except (InputError, NotApplicableError) as error:
        return Explored(ran=ran, identified=identified, diagnosed=diagnosed, why=str(error))
    return Explored(
        ran=ran, identified=identified, diagnosed=diagnosed, planned=planned, set_right=right
    )


def _planned(task: Any, model: str, folder: StrPath, seed: int, progress: Progress) -> Planned:
    """A plan with a model, of which this is the text of its file."""
    path = Path(folder) / ".model.toml"
    path.write_text(model, encoding="utf-8")
    try:
        return plan(task_of(task), model=path, seed=seed, progress=progress)
    finally:
        os.unlink(path)
