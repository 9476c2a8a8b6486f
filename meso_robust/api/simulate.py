"""``simulate``: a plan run in the simulator."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from meso_robust.api.call import call
from meso_robust.api.inputs import files_of, path_of, task_of
from meso_robust.api.options import (
    Dropout,
    Latency,
    Noise,
    Samples,
    Seed,
    StrPath,
    TaskGiven,
)
from meso_robust.api.plan import PlanGiven, plan_of
from meso_robust.api.progress import SILENT, Progress
from meso_robust.api.result import Result
from meso_robust.errors import InputError

if TYPE_CHECKING:
    from meso_robust.laboratory.filming import Camera
    from meso_robust.laboratory.simulation import Simulated as Runs
    from meso_robust.laboratory.simulation_document import SimulationDocument
    from meso_robust.recordings import RecordingSet

FRAME_RATE_HZ = 30.0  # of the paper's camera, Section IV


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Simulated(Result):
    """Runs of a plan, and how they ended.

    Attributes
    ----------
    runs
        Every run, with its whole motion.
    document
        The content of ``simulation.json``.
    """

    runs: Runs
    document: SimulationDocument

    @property
    def positive(self) -> bool:
        """Whether every run that was made ended in the goal."""
        return self.document.all_in_goal

    all_in_goal = positive

    @property
    def shown(self) -> dict[str, str]:
        """The animation of the runs."""
        return {"animation": "animation.html"}

    @property
    def brief(self) -> str:
        """How many of the sampled runs end in the goal."""
        sampled = self.document.sampled
        return f"{sampled.in_goal} of {sampled.runs} runs end in the goal"

    def __str__(self) -> str:
        from meso_robust.laboratory.simulation_answer import summary

        return summary(self.document)

    def __repr__(self) -> str:
        sampled = self.document.sampled
        return f"<Simulated {self.document.task}: {sampled.in_goal} of {sampled.runs} in the goal>"

    def _repr_html_(self) -> str:
        from meso_robust.reporting.cards import simulated_card

        return simulated_card(self.runs, self.document, str(self))

    def files(self) -> dict[str, str]:
        """The texts of all result files by name."""
        from meso_robust.laboratory.trajectories import trajectories
        from meso_robust.reporting.animation import animation

        return {
            "simulation.json": self.text(),
            "trajectories.csv": trajectories(self.runs),
            "animation.html": animation(self.runs, self.document),
        }

    def filmed(self, runs: int, camera: Camera | None = None, seed: int = 0) -> RecordingSet:
        """The nominal and the first sampled runs as a camera would record them.

        Parameters
        ----------
        runs
            How many; each gives one recording a move.
        camera
            See :func:`camera_of`; its defaults if left out.
        seed
            Of noise and lost frames.
        """
        import numpy as np

        from meso_robust.laboratory.filming import film_plan

        if runs < 1:
            raise InputError(f"runs = {runs}: must be at least 1; give a larger number")
        rng = np.random.default_rng(seed)
        return film_plan(self.runs, camera or camera_of(), rng, runs)

    def record(
        self, folder: StrPath, runs: int, camera: Camera | None = None, seed: int = 0
    ) -> None:
        """Write :meth:`filmed` runs as a recording set.

        Raises
        ------
        InputError
            It cannot be written.
        """
        from meso_robust.recordings import write_set

        write_set(Path(folder), self.filmed(runs, camera, seed))


@call
def simulate(
    task: TaskGiven,
    plan: PlanGiven,
    *,
    samples: Samples = 200,
    seed: Seed = 0,
    adversarial: bool = False,
    witness: StrPath | None = None,
    progress: Progress = SILENT,
) -> Simulated:
    """Run a plan in the simulator, which shares nothing with the proof.

    Parameters
    ----------
    task, plan
        The task and a plan for it, or the names of their files.
    samples
        Random runs.
    seed
        Seed of the random runs.
    adversarial
        Search the uncertainties for the worst run.
    witness
        Replay this ``witness.json``, or the witness in a REFUTED certificate.
    progress
        Shows what is being done.

    Returns
    -------
    Simulated
        Whatever became of the runs.

    Raises
    ------
    InputError
        A file or a value breaks a rule, or the plan was made for another task.

    Examples
    --------
    The plan of :func:`meso_robust.plan`'s example:

    >>> simulated = mr.simulate(task, planned, samples=50)
    >>> print(simulated)
    paper, Section IX-E: 4 moves, feedback
    nominal: in the goal, ... tolerances off the goal's middle
    samples: 50 of 50 completed, 50 in the goal; worst ... tolerances off the goal's middle
    >>> filmed = simulated.filmed(1)  # as a camera would see the nominal run
    >>> [one.file for one in filmed.recordings][0]
    'run_00_move_1.csv'
    """
    known = task_of(task)
    stated = plan_of(plan, known)
    if witness is not None:
        from meso_robust.laboratory.witness_form import check_form

        check_form(Path(witness))  # before the imports that take seconds

    from meso_robust.laboratory.simulation import player_of, simulated
    from meso_robust.laboratory.simulation_answer import document
    from meso_robust.laboratory.witness import read_witness
    from meso_robust.primitives.setup import setup_of

    player = player_of(stated, setup_of(known))
    path = path_of(witness)
    found = simulated(
        known,
        stated,
        player,
        samples=samples,
        seed=seed,
        adversarial=adversarial,
        witness=None if path is None else read_witness(path, known, stated, player),
        doing=progress.doing,
    )
    return Simulated(runs=found, document=document(found), inputs=files_of(task, plan, witness))


@call
def camera_of(
    noise_um: Noise = 1.2,
    noise_deg: Noise = 0.08,
    dropout: Dropout = 0.0,
    latency_ms: Latency = 0.0,
) -> Camera:
    """A camera of 30 frames a second.

    Parameters
    ----------
    noise_um
        Noise of recorded positions.
    noise_deg
        Noise of recorded angles.
    dropout
        Share of lost frames.
    latency_ms
        Delay of the camera.

    Returns
    -------
    Camera
        For :meth:`Simulated.filmed`.

    Raises
    ------
    InputError
        A value is out of its range.

    Examples
    --------
    >>> import meso_robust as mr
    >>> mr.camera_of(noise_um=0.5, dropout=0.1).sensor.dropout
    0.1
    """
    from meso_robust.laboratory.filming import Camera
    from meso_robust.simulator import Effects
    from meso_robust.simulator.observation import Sensor

    return Camera(
        sensor=Sensor(
            position_sigma=1e-6 * noise_um,
            orientation_sigma=math.radians(noise_deg),
            frame_rate=FRAME_RATE_HZ,
            dropout=dropout,
        ),
        effects=Effects({"camera_latency": {"time_ms": latency_ms}}),
    )
