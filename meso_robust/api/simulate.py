"""``simulate``: a plan run in the simulator."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from meso_robust.api.call import call
from meso_robust.api.inputs import StrPath, at_least, task_of, within
from meso_robust.api.plan import Planned, plan_of
from meso_robust.api.progress import SILENT, Progress
from meso_robust.errors import InputError
from meso_robust.files import write_all
from meso_robust.laboratory.filming import Camera, film_plan
from meso_robust.laboratory.simulation import Simulated as Runs, player_of, simulated
from meso_robust.laboratory.simulation_answer import document, summary
from meso_robust.laboratory.simulation_document import SimulationDocument
from meso_robust.laboratory.trajectories import trajectories
from meso_robust.laboratory.witness import read_witness
from meso_robust.limits import LONGEST_LATENCY_MS, MOST_SAMPLES
from meso_robust.planning.document import PlanDocument
from meso_robust.primitives.setup import setup_of
from meso_robust.recordings import RecordingSet, write_set
from meso_robust.simulator import Effects
from meso_robust.simulator.observation import Sensor
from meso_robust.task import Task

FRAME_RATE_HZ = 30.0  # of the paper's camera, Section IV


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Simulated:
    """Runs of a plan, and what became of them.

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
    def all_in_goal(self) -> bool:
        """Whether every run that was made ended in the goal."""
        return self.document.all_in_goal

    def __str__(self) -> str:
        """The answer in a few lines, as the command line prints it."""
        return summary(self.document)

    def __repr__(self) -> str:
        sampled = self.document.sampled
        return f"<Simulated {self.document.task}: {sampled.in_goal} of {sampled.runs} in the goal>"

    def _repr_html_(self) -> str:
        from meso_robust.reporting.cards import simulated_card

        return simulated_card(self.runs, self.document, str(self))

    def files(self) -> dict[str, str]:
        """The texts of all result files by name."""
        from meso_robust.reporting.animation import animation

        return {
            "simulation.json": self.document.model_dump_json(by_alias=True, indent=2) + "\n",
            "trajectories.csv": trajectories(self.runs),
            "animation.html": animation(self.runs, self.document),
        }

    @call
    def save(self, folder: StrPath, *, progress: Progress = SILENT) -> None:
        """Write the result files into a folder, which is made if needed; all of them or none.

        Raises
        ------
        InputError
            They cannot be written.
        """
        with progress.doing("writing the results"):
            write_all(Path(folder), self.files())

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
        at_least(1, runs=runs)
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
        write_set(Path(folder), self.filmed(runs, camera, seed))


@call
def simulate(
    task: Task | StrPath,
    plan: PlanDocument | Planned | StrPath,
    *,
    samples: int = 200,
    seed: int = 0,
    adversarial: bool = False,
    witness: StrPath | None = None,
    progress: Progress = SILENT,
) -> Simulated:
    """Run a plan in the simulator, which shares nothing with the proof.

    Parameters
    ----------
    task, plan
        The task and a plan for it, or the names of their files.
    samples, seed
        Random runs within the task's uncertainties, and the seed of their draws.
    adversarial
        Also search the uncertainties for the worst run.
    witness
        Also replay this ``witness.json``, or the witness of a REFUTED certificate.
    progress
        Shows what is being done.

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
    within(1, MOST_SAMPLES, samples=samples)
    at_least(0, seed=seed)
    known = task_of(task)
    stated = plan_of(plan, known)
    player = player_of(stated, setup_of(known))
    found = simulated(
        known,
        stated,
        player,
        samples=samples,
        seed=seed,
        adversarial=adversarial,
        witness=None if witness is None else read_witness(Path(witness), known, stated, player),
        doing=progress.doing,
    )
    return Simulated(runs=found, document=document(found))


@call
def camera_of(
    noise_um: float = 1.2, noise_deg: float = 0.08, dropout: float = 0.0, latency_ms: float = 0.0
) -> Camera:
    """A camera of 30 frames a second.

    Parameters
    ----------
    noise_um, noise_deg
        Standard deviations of recorded positions and angles.
    dropout
        Share of frames that are lost.
    latency_ms
        Delay of the frames.

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
    if not 0.0 <= latency_ms <= LONGEST_LATENCY_MS:
        raise InputError(
            f"latency_ms = {latency_ms}: must be from 0 to {LONGEST_LATENCY_MS:.0f}; give such a delay"
        )
    try:
        return Camera(
            sensor=Sensor(
                position_sigma=1e-6 * noise_um,
                orientation_sigma=float(np.radians(noise_deg)),
                frame_rate=FRAME_RATE_HZ,
                dropout=dropout,
            ),
            effects=Effects({"camera_latency": {"time_ms": latency_ms}}),
        )
    except ValueError as error:
        raise InputError(f"--noise-um, --noise-deg, --dropout, --latency-ms: {error}") from error
