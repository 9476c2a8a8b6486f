"""``campaign``: properties, Monte Carlo and falsification, from one core to a cluster."""

from __future__ import annotations

import json
import os
import shutil
import tempfile
from collections.abc import Iterator
from contextlib import closing, contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal, TypeAlias

from meso_robust.api.call import call
from meso_robust.api.inputs import path_of
from meso_robust.api.options import Folder, Option, Seed, StrPath, Workers
from meso_robust.api.progress import SILENT, Progress
from meso_robust.api.result import Result
from meso_robust.errors import InputError
from meso_robust.files import check_folder

if TYPE_CHECKING:
    from meso_robust.campaigns.answer import Answer
    from meso_robust.campaigns.document import Campaign
    from meso_robust.campaigns.executor import Crew
    from meso_robust.campaigns.kind import Result as Replayed, Verdict
    from meso_robust.campaigns.store import Store

Examples: TypeAlias = Annotated[
    StrPath,
    Option(
        words="Folder where failing examples are kept, and tried again by every campaign that is "
        "given it; the results' own by default."
    ),
]
NEGATIVE = ("broken", "incomplete", "open")


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Campaigned(Result):
    """The outcome of a campaign.

    Attributes
    ----------
    answer
        Totals, verdicts and failures, part by part.
    document
        The content of ``campaign.json``.
    left
        Indices of the chunks that were not done, by the name of their part.
    """

    answer: Answer
    document: dict[str, Any]
    left: dict[str, list[int]]

    @property
    def verdict(self) -> Verdict | Literal["incomplete"]:
        """The first that holds of: broken, incomplete, open, held, measured."""
        return self.answer.verdict

    @property
    def positive(self) -> bool:
        """Whether all was done, and nothing was broken or left open."""
        return self.verdict not in NEGATIVE

    @property
    def brief(self) -> str:
        """The verdict."""
        return f"{self.verdict}: {self.answer.campaign.name}"

    def __str__(self) -> str:
        from meso_robust.campaigns.answer import summary

        return summary(self.answer)

    def __repr__(self) -> str:
        return f"<Campaigned {self.verdict}: {self.answer.campaign.name}>"

    def _repr_html_(self) -> str:
        from meso_robust.reporting.cards import campaigned_card

        return campaigned_card(self.answer, str(self))

    def text(self) -> str:
        """The text of ``campaign.json``."""
        return json.dumps(self.document, indent=1, ensure_ascii=False, allow_nan=False) + "\n"

    def files(self) -> dict[str, str]:
        """The texts of ``campaign.json``, ``report.html``, and those of each failure in its folder."""
        from meso_robust.reporting.campaign import campaign_report

        failures = {
            f"{one.folder}/{name}": text
            for part in self.answer.parts
            for one in part.shown
            if one.folder
            for name, text in one.failure.files.items()
        }
        page = campaign_report(self.answer, self.left)
        return {**failures, "campaign.json": self.text(), "report.html": page}


@call
def campaign(  # every option of the verb is an argument
    campaign: StrPath,
    folder: Folder | None = None,
    *,
    examples: Examples | None = None,
    workers: Workers | None = None,
    scheduler: str | None = None,
    resume: bool = False,
    seed: Seed | None = None,
    progress: Progress = SILENT,
) -> Campaigned:
    """Run a campaign in small seeded chunks, in processes of its own.

    In a script the call must stand below ``if __name__ == "__main__":``, as for every process pool.

    Parameters
    ----------
    campaign
        Campaign file (TOML).
    folder
        For the store, from which an interrupted campaign resumes; a temporary one if left out.
    examples
        Folder where failing examples are kept, and tried again by every campaign that is given it.
    workers
        Processes; one for each core by default.
    scheduler
        Dask scheduler to use instead of local processes, such as ``tcp://host:8786``.
    resume
        Resume from the results already in the folder.
    seed
        Overrides the seed in the file.
    progress
        Shows what is being done.

    Returns
    -------
    Campaigned
        Whatever the verdict.

    Raises
    ------
    InputError
        A file or a value breaks a rule, or the folder holds a campaign already.

    Examples
    --------
    Many runs of the plan of :func:`meso_robust.plan`'s example:

    >>> import tempfile
    >>> from pathlib import Path
    >>> text = '''
    ... schema = "meso-robust/campaign/1"
    ... name = "the paper's plan"
    ... [[part]]
    ... name = "success rate"
    ... kind = "monte-carlo"
    ... plan = "plan.json"
    ... executions = 100
    ... '''
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     _ = (Path(folder) / "campaign.toml").write_text(text)
    ...     planned.save(folder)
    ...     done = mr.campaign(Path(folder) / "campaign.toml", workers=1)
    >>> print(done)
    MEASURED: the paper's plan
    success rate (monte-carlo): 100 of 100 executions, drawn uniformly...
    """
    if workers is not None and scheduler is not None:
        raise InputError(
            "--workers, --scheduler: mutually exclusive; give one of them, as a cluster has its own workers"
        )
    from meso_robust.campaigns.answer import answered, document
    from meso_robust.campaigns.document import read_campaign

    kept = path_of(examples)
    with progress.doing("reading the campaign and its files"):
        stated = read_campaign(Path(campaign), seed)
    if folder is not None:
        check_folder(Path(folder), ("campaign.json", "report.html"), (Path(campaign),))
    with _stored(path_of(folder), resume, stated) as store:
        with progress.doing("retrying kept examples"):
            replayed = _replayed(stated, kept)
        _work(stated, store, progress, workers, scheduler)
        with progress.doing("adding up"):
            answer = answered(stated, store, replayed)
            left = _left(stated, store)
    if kept is not None:
        _keep(kept, answer)
    return Campaigned(answer=answer, document=document(answer), left=left)


@contextmanager
def _stored(folder: Path | None, resume: bool, stated: Campaign) -> Iterator[Store]:
    """The store of a campaign, open."""
    passing = folder is None
    where = Path(tempfile.mkdtemp(prefix="meso-robust-")) if folder is None else folder
    try:
        with closing(_opened(where, resume, stated)) as store:
            yield store
    finally:
        if passing:
            shutil.rmtree(where, ignore_errors=True)


def _opened(folder: Path, resume: bool, stated: Campaign) -> Store:
    from meso_robust.campaigns.provenance import code
    from meso_robust.campaigns.store import NAME, Store

    check_folder(folder)
    path = folder / NAME
    if path.exists() and not resume:
        raise InputError(
            f"--out {folder}: already holds a campaign; continue it with --resume, or give "
            "another folder"
        )
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(
            f"--out {folder}: cannot be created ({error.strerror}); give a writable folder"
        ) from error
    return Store(path, stated.values, code())


def _replayed(stated: Campaign, examples: Path | None) -> dict[str, Replayed]:
    """What comes of trying again what earlier campaigns kept in the folder."""
    from meso_robust.campaigns.kinds import kind_of

    found = {}
    for part in stated.parts:
        replay = kind_of(part.kind).replay
        if replay is not None and examples is not None and examples.exists():
            found[part.name] = replay(part, examples)
    return found


def _keep(examples: Path, answer: Answer) -> None:
    """Save what later campaigns in this folder should try again."""
    from meso_robust.campaigns.kinds import kind_of

    for one in answer.parts:
        keep = kind_of(one.part.kind).keep
        try:
            if keep is not None and one.failed:
                keep(examples, one.totals)
        except OSError as error:
            raise InputError(
                f"--examples {examples}: cannot be written ({error}); free some space, then "
                "run the same command with --resume"
            ) from error


def _work(
    stated: Campaign, store: Store, progress: Progress, workers: int | None, scheduler: str | None
) -> None:
    """Do what is missing, and show how it goes."""
    from meso_robust.campaigns.kinds import kind_of
    from meso_robust.campaigns.work import carry_out, missing

    left = sum(1 for _ in missing(stated, store))
    if left == 0:
        return
    planned = {part.name: kind_of(part.kind).count(part) for part in stated.parts}
    units = {part.name: kind_of(part.kind).unit for part in stated.parts}
    done = {name: len(store.done(name)) for name in planned}
    with progress.rating() as rated:
        for name, count in planned.items():
            if done[name] < count:  # the first step is long in coming: kernels are compiled
                rated(name, (done[name], count), None)
        for step in carry_out(stated, store, _crew(workers, scheduler)):
            done[step.part] += 1
            rated(
                step.part,
                (done[step.part], planned[step.part]),
                (step.runs, step.failed, units[step.part]),
            )


def _crew(workers: int | None, scheduler: str | None) -> Crew:
    if scheduler is not None:
        from meso_robust.campaigns.cluster import Cluster

        return Cluster(scheduler)
    from meso_robust.campaigns.executor import Processes

    return Processes(workers or os.cpu_count() or 1)


def _left(stated: Campaign, store: Store) -> dict[str, list[int]]:
    """Chunks that were not done, by the name of their part."""
    from meso_robust.campaigns.work import missing

    found: dict[str, list[int]] = {}
    for ticket in missing(stated, store):
        found.setdefault(ticket.part, []).append(ticket.chunk)
    return found
