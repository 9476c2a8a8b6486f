"""``run``: a certified plan carried out in a laboratory, frame by frame and move by move."""

from __future__ import annotations

import hashlib
import json
import os
from dataclasses import dataclass, replace
from datetime import datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any

from meso_robust import __version__
from meso_robust.api.call import call
from meso_robust.api.drive import drive
from meso_robust.api.inputs import files_of, task_of
from meso_robust.api.options import Seed, StrPath, TaskGiven
from meso_robust.api.progress import SILENT, Progress
from meso_robust.api.result import Result
from meso_robust.errors import InputError

if TYPE_CHECKING:
    from meso_robust.live.conductor import Decide
    from meso_robust.live.journal import Header, Turn
    from meso_robust.live.lab_file import Lab
    from meso_robust.live.page import View
    from meso_robust.live.run_document import RunDocument
    from meso_robust.recordings import RecordingSet
    from meso_robust.task import Task

VIRTUAL = "virtual"
COARSER = 4.0
"""Times the task's error of sensing within which a pose must be known for a designed push."""
JOURNAL, DRAFT = "journal.jsonl", "journal.jsonl.part"
"""The journal of a run, and while it grows."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Ran(Result):
    """A live run.

    Attributes
    ----------
    document
        The content of ``run.json``.
    header, turns
        Its journal.
    task
        What was carried out.
    names
        Files of the recordings, if an experiment names them.
    filmed
        Whether its frames were kept.
    """

    document: RunDocument
    header: Header
    turns: list[Turn]
    task: Task
    names: tuple[str, ...] = ()
    filmed: bool = False

    @property
    def positive(self) -> bool:
        """Whether the part is in the goal, or nothing was to be moved."""
        return self.document.outcome in ("done", "dry_run")

    @property
    def shown(self) -> dict[str, str]:
        """The journal and the frames."""
        from meso_robust.live.filming import VIDEO

        return {"journal": JOURNAL, **({"video": VIDEO} if self.filmed else {})}

    def __str__(self) -> str:
        from meso_robust.wording import counted

        one, carried = self.document, [move for move in self.document.moves if move.carried_out]
        lines = [
            f"{one.outcome.upper().replace('_', ' ')}: {one.why}",
            f"{counted(len(carried), 'move')} carried out in {one.duration_s:.1f} s",
        ]
        if one.last_pose is not None:
            x, y, theta = one.last_pose
            lines.append(f"part last seen at ({x:.1f}, {y:.1f}) um, {theta:.2f} deg")
        if one.latency.frames:
            lines.append(
                f"from a frame to its commands: {one.latency.median_ms:.1f} ms (median of "
                f"{counted(one.latency.frames, 'frame')}), {one.latency.p99_ms:.1f} ms (99 %)"
            )
        return "\n".join(lines)

    def recordings(self) -> RecordingSet | None:
        """The pushes as a recording set; None if nothing was pushed."""
        from meso_robust.laboratory.filming import recorded_part
        from meso_robust.live.recorder import recordings_of

        part = recorded_part(self.task.part)
        return recordings_of(self.header, self.turns, part, self.names)

    def files(self) -> dict[str, str]:
        """The texts of all result files by name: ``run.json``, recordings of the pushes, the camera."""
        from meso_robust.live.sight import calibration_of
        from meso_robust.recordings.writing import set_files
        from meso_robust.tracking.calibration_document import calibration_text

        made = self.recordings()
        pushes = {} if made is None else set_files(made)
        return {
            "run.json": self.text(),
            "calibration.toml": calibration_text(calibration_of(self.header.lab.camera)),
            **{f"recordings/{name}": text for name, text in pushes.items()},
        }


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Repeated(Result):
    """A journal that was decided again.

    Attributes
    ----------
    turns
        How many it has.
    journal
        Its file.
    """

    turns: int
    journal: Path

    @property
    def positive(self) -> bool:
        """Always: one that differs is refused."""
        return True

    @property
    def shown(self) -> dict[str, str]:
        """Nothing is written."""
        return {}

    def __str__(self) -> str:
        return (
            f"REPEATED: {self.turns:,} turns of {self.journal}, every decision and command the same"
        )

    def text(self) -> str:
        """The answer as JSON."""
        return json.dumps({"journal": str(self.journal), "turns": self.turns}) + "\n"

    def files(self) -> dict[str, str]:
        """None."""
        return {}


@call
def run(  # noqa: PLR0913  # what a user may choose
    task: TaskGiven,
    plan: StrPath,
    *,
    lab: StrPath = VIRTUAL,
    dry_run: bool = False,
    video: bool = True,
    seed: Seed = 0,
    folder: StrPath | None = None,
    attendance: Any = None,
    progress: Progress = SILENT,
) -> Ran:
    """Carry out a certified plan: see the part, ask the plan for a move, make it, see again.

    Parameters
    ----------
    task
        The task, or the name of its file.
    plan
        Plan (``plan.json``) or policy (``policy.json``) for it, or pushes (``experiment.json``).
    lab
        The laboratory (``lab.toml``), or ``virtual``: the built-in one.
    dry_run
        Move nothing: say what the first move would be.
    video
        Keep every frame, without loss, as a video that `track` reads.
    seed
        Seed of the virtual laboratory.
    folder
        For ``journal.jsonl`` and the video, which are written turn by turn; None: the journal is only
        kept, and there is no video.
    attendance
        ``meso_robust.live.session.Attendance``: who is asked before each move, and shown every turn;
        None: nobody.
    progress
        Shows what is being done.

    Returns
    -------
    Ran
        However it ended.

    Raises
    ------
    InputError
        A file or a value breaks a rule, or the laboratory is not one that the task is about.
    NotApplicableError
        The plan is not proved.
    """
    stated = task_of(task)
    given, beside, source = lab_given(stated, Path(plan), lab, seed)
    from meso_robust.live.preflight import check_lab, trust_of

    check_lab(stated, given, source)
    decide, names = _decider(stated, Path(plan), given, progress)
    trust = trust_of(stated)
    if names is not None:  # nothing is proved of a designed push: it only has to meet the part
        position, turn = COARSER * trust.position_um, COARSER * trust.orientation_deg
        trust = replace(trust, position_um=position, orientation_deg=turn)
    from meso_robust.live.journal import Header

    header = Header(
        task_hash=stated.hash,
        plan_hash=hashlib.sha256(Path(plan).read_bytes()).hexdigest(),
        lab=given,
        trust=trust,
        confirm=attendance is not None and attendance.ask is not None,
        dry=dry_run,
        version=__version__,
        started=datetime.now().astimezone().isoformat(timespec="seconds"),
    )
    from meso_robust.live.session import carried_through

    film = None
    if folder is not None and video:
        from meso_robust.live.filming import Film

        film = Film(Path(folder))
    with progress.following() as told:
        document, turns = carried_through(
            stated,
            header,
            decide,
            beside,
            None if folder is None else Path(folder) / DRAFT,
            attendance,
            told,
            film,
        )
    filmed = film is not None and film.finish()
    if folder is not None:
        os.replace(Path(folder) / DRAFT, Path(folder) / JOURNAL)
    return Ran(
        document=document,
        header=header,
        turns=turns,
        task=stated,
        names=() if names is None else tuple(names),
        filmed=filmed,
        inputs=files_of(task, plan, *([] if lab == VIRTUAL else [lab])),
    )


def _decider(
    task: Task, plan: Path, lab: Lab, progress: Progress
) -> tuple[Decide, list[str] | None]:
    """What answers sensed poses, and the files of the recordings that an experiment names meanwhile."""
    from meso_robust.live.designed import SCHEMA, Designed, read_experiment
    from meso_robust.planning.reading import read_text

    if f'"{SCHEMA}' not in read_text(plan):
        driver = drive(task, plan, progress=progress)
        driver.controller.settle()  # a frame that waits for an answer grows too old
        return driver.answer, None
    designed = Designed(read_experiment(plan), lab)
    return designed.answer, designed.files


def view_of(task: Task | StrPath, plan: StrPath, lab: StrPath, seed: int) -> View:
    """What the live page shows of a run, before it begins.

    Parameters
    ----------
    task, plan, lab
        Files of the run.
    seed
        Of a virtual laboratory.

    Returns
    -------
    View
        Outline, boxes and tips to draw.

    Raises
    ------
    InputError
        A file cannot be read, or a value breaks a rule.
    """
    stated = task_of(task)
    given, _, _ = lab_given(stated, Path(plan), lab, seed)
    from meso_robust.laboratory.making import outline
    from meso_robust.live.page import View
    from meso_robust.live.preflight import trust_of
    from meso_robust.primitives.setup import setup_of

    return View(given, trust_of(stated), outline(setup_of(stated)))


def lab_given(task: Task, plan: Path | None, lab: StrPath, seed: int) -> tuple[Lab, Path, str]:
    """A laboratory, the folder of its file, and what names it in messages.

    Raises
    ------
    InputError
        The file cannot be read, or a value breaks a rule.
    """
    from meso_robust.live.lab_file import VirtualSection
    from meso_robust.live.loading import load_lab

    if str(lab) == VIRTUAL:
        from meso_robust.live.virtual_bench import heading_of, lab_of

        return lab_of(task, heading_of(plan), VirtualSection(seed=seed)), Path(), "--lab virtual"
    path = Path(lab)
    return load_lab(path), path.parent, str(path)


@call
def replay(
    task: TaskGiven, plan: StrPath, journal: StrPath, *, progress: Progress = SILENT
) -> Repeated:
    """Run the loop again on the readings of a journal, and compare every decision and command.

    Parameters
    ----------
    task, plan
        As the run had them.
    journal
        Its ``journal.jsonl``.
    progress
        Shows what is being done.

    Returns
    -------
    Repeated
        All of them the same.

    Raises
    ------
    InputError
        The journal is of another task or plan, cannot be read, or a turn of it was not decided so.
    """
    stated = task_of(task)
    from meso_robust.live.journal import read_journal, replayed

    header, turns = read_journal(Path(journal))
    plan_hash = hashlib.sha256(Path(plan).read_bytes()).hexdigest()
    if (header.task_hash, header.plan_hash) != (stated.hash, plan_hash):
        raise InputError(f"{journal}: is of another task or plan; give those that the run had")
    decide, _ = _decider(stated, Path(plan), header.lab, progress)
    differs = replayed(header, turns, decide)
    if differs is not None:
        raise InputError(
            f"{journal}: line {differs + 1} was not decided so from its readings; the file was changed, "
            f"or another version of this package ({header.version}) wrote it"
        )
    return Repeated(turns=len(turns), journal=Path(journal))
