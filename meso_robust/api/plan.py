"""``plan`` and ``certify``: from a task, with or without a plan, to a judged plan."""

from __future__ import annotations

import time
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, TypeAlias, Union

from meso_robust.api.call import call
from meso_robust.api.inputs import files_of, task_of
from meso_robust.api.options import Option, Samples, SearchSeconds, Seed, StrPath, TaskGiven
from meso_robust.api.progress import SILENT, Progress
from meso_robust.api.result import Result, text_of
from meso_robust.errors import InputError, NotApplicableError

if TYPE_CHECKING:
    from meso_robust.api.checked import Checked
    from meso_robust.bounds import VerdictWord
    from meso_robust.certificates.document import CertificateDocument
    from meso_robust.certificates.margin import Margin
    from meso_robust.pipeline import Planned as Judged
    from meso_robust.planning.document import PlanDocument
    from meso_robust.task import Task
    from meso_robust.transfer.promise import Promise

PlanGiven: TypeAlias = Annotated[
    Union["PlanDocument", "Planned", str, PathLike[str]],
    Option(words="Plan for this task (plan.json)."),
]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Planned(Result):
    """A plan and what is known about it.

    Attributes
    ----------
    result
        Everything that was found out, down to the single simulated run.
    promise
        What a fitted model made of the task; None if there was none.
    more
        Texts of further files by name: those that were requested, and those about a fitted model.
    checked
        What :func:`check` says of the certificate; None if it was not asked.
    """

    result: Judged
    promise: Promise | None = None
    checked: Checked | None = None
    more: Mapping[str, str] = field(default_factory=dict)

    @property
    def verdict(self) -> VerdictWord:
        """PROVED, REFUTED (a simulated run fails) or UNKNOWN (the certificate says what is open)."""
        return self.certificate.verdict

    @property
    def positive(self) -> bool:
        """Whether the plan is proved to work and, if that was asked, the proof verified."""
        return self.proved and (self.checked is None or self.checked.verified)

    @property
    def proved(self) -> bool:
        """Whether the plan is proved to work."""
        return self.verdict == "PROVED"

    @property
    def task(self) -> Task:
        """What was planned for: with a model or the widest margin not quite the task as given."""
        return self.result.task

    @property
    def brief(self) -> str:
        """The verdict, and the checker's if it was asked."""
        return self.verdict if self.checked is None else f"{self.verdict}, {self.checked.brief}"

    @property
    def plan(self) -> PlanDocument:
        """The content of ``plan.json``."""
        return self.result.plan

    @property
    def certificate(self) -> CertificateDocument:
        """The content of ``certificate.json``."""
        return self.result.certificate

    document = certificate

    @property
    def margin(self) -> Margin:
        """How much more uncertainty the plan would tolerate, and which one binds first."""
        return self.result.margin

    @property
    def notes(self) -> tuple[str, ...]:
        """What is unusual about the task, such as a film that is not even; not part of the verdict."""
        from meso_robust.planning.possible import remarks

        return remarks(self.task, () if self.promise is None else self.promise.changed.keys)

    remarks = notes

    def __str__(self) -> str:
        from meso_robust.transfer import answer

        found = self.result.summary if self.promise is None else answer.summary(self.promise)
        if self.checked is None:
            return found
        from meso_robust.reporting.answer import verified_words

        return f"{found}\n{verified_words(self.checked.answer, self.verdict)}"

    def __repr__(self) -> str:
        from meso_robust.wording import counted

        return (
            f"<Planned {self.verdict}: {self.task.name}, {counted(len(self.plan.moves), 'move')}>"
        )

    def _repr_html_(self) -> str:
        from meso_robust.reporting.cards import planned_card

        checker = None if self.checked is None else self.checked.answer
        return planned_card(self.result, self.promise, checker, str(self))

    def files(self) -> dict[str, str]:
        """The texts of all result files by name, such as ``plan.json``."""
        from meso_robust.reporting.plan import report

        return {
            "plan.json": text_of(self.plan),
            "certificate.json": self.text(),
            "report.html": report(
                self.result, self.promise, None if self.checked is None else self.checked.answer
            ),
            **self.more,
            **({} if self.checked is None else self.checked.files()),
        }


@call
def plan(  # noqa: PLR0913  # every option of the verb is an argument
    task: TaskGiven,
    *,
    model: StrPath | None = None,
    samples: Samples = 1000,
    seed: Seed = 0,
    search_s: SearchSeconds = 90.0,
    widest: bool = False,
    policy: bool = False,
    maps: bool = False,
    check: bool = False,
    progress: Progress = SILENT,
) -> Planned:
    """Find a plan, certify it, search its margin and cross-check it in the simulator.

    Parameters
    ----------
    task
        The task, or the name of its file.
    model
        Fitted model (``model.toml``): plan the task with its parameters, or report which premise of
        the proof it violates; also writes the resulting task and ``premises.json``.
    samples
        Random runs in the simulator.
    seed
        Seed of the random runs.
    search_s
        Computing time after which the search for a plan gives up, s, about, to say in a third of that what
        would settle the task. The search for the widest margin and one with a model are not limited.
    widest
        Search tip spacing, push offsets and travels for the widest margin (minutes); also writes the
        task with that spacing.
    policy
        Also certify a feedback policy: ``policy.json`` for ``drive``, ``region.svg`` of its starts.
    maps
        Also draw where each primitive may push, and from which starts (SVG, JSON).
    check
        Also verify the certificate as ``check`` does (seconds; with round tips up to minutes): ``check.json``.
    progress
        Shows what is being done.

    Returns
    -------
    Planned
        Whatever the verdict.

    Raises
    ------
    InputError
        A file or a value breaks a rule.
    NotApplicableError
        No primitive can handle the task, so there is no plan to judge: the command line reports
        this as UNKNOWN. The message says which primitive and why.
    SimulatorContradictsProofError
        The simulator and the proof disagree: a fault of this package.

    Examples
    --------
    >>> import meso_robust as mr
    >>> planned = mr.plan(mr.Task.paper(), samples=20)
    >>> planned
    <Planned PROVED: paper, Section IX-E, 4 moves>
    >>> print(planned)
    PROVED (point tips): paper, Section IX-E, 4 moves
    simulated: 20 of 20 runs end in the goal
    margin: still proved with all uncertainties x ...
    >>> planned.margin.binding
    'friction'
    >>> [move.primitive for move in planned.plan.moves]
    ['y_translation', 'y_translation', 'rotation', 'x_translation']
    """
    if model is not None and (widest or policy or maps):
        raise InputError(
            "--model: cannot be combined with --widest, --policy or --maps, which need only a task; "
            "plan with the model first, then with the task it returns (task.toml)"
        )
    stated = task_of(task)
    for asked, use in ((policy, "--policy"), (maps, "--maps")):
        if asked:
            stated.rectangle(use)
    if model is not None:
        made = _promised(stated, Path(model), samples, seed, progress, files_of(task, model))
        return with_check(made, progress) if check else made

    from meso_robust import pipeline
    from meso_robust.planning.possible import refuse_impossible

    refuse_impossible(stated)
    if widest:
        result = pipeline.make_best(stated, samples, seed, progress.doing)
    else:
        result = pipeline.make(stated, samples, seed, progress.doing, search_s)
    more = _widest(task, result) if widest else {}
    if policy:
        more |= _policy(result.task, progress)
    if maps:
        from meso_robust.reporting.admissible import map_files

        more |= map_files(result.task, progress.doing)
    found = Planned(result=result, more=more, inputs=files_of(task))
    return with_check(found, progress) if check else found


@call
def certify(
    task: TaskGiven,
    plan: PlanGiven,
    *,
    samples: Samples = 1000,
    seed: Seed = 0,
    progress: Progress = SILENT,
) -> Planned:
    """Certify a plan that someone else made, whether it states a policy or bare moves.

    Parameters
    ----------
    task
        The task, or the name of its file.
    plan
        The plan, or the name of its file (``plan.json``).
    samples
        Random runs in the simulator.
    seed
        Seed of the random runs.
    progress
        Shows what is being done.

    Returns
    -------
    Planned
        Whatever the verdict.

    Raises
    ------
    InputError
        A file or a value breaks a rule, or the plan was made for another task.
    NotApplicableError
        No primitive describes one of the moves.
    SimulatorContradictsProofError
        The simulator and the proof disagree: a fault of this package.

    Examples
    --------
    The plan of :func:`plan`'s example with a last push that stops 300 um too early is refuted:

    >>> good = planned.plan
    >>> last = good.policy[-1]
    >>> early = last.dual_end_x.model_copy(update={"offset_um": last.dual_end_x.offset_um + 300.0})
    >>> bad = good.model_copy(
    ...     update={"policy": (*good.policy[:-1], last.model_copy(update={"dual_end_x": early}))}
    ... )
    >>> print(mr.certify(task, bad, samples=20))
    REFUTED (point tips): paper, Section IX-E, 4 moves
    simulated: 0 of 20 runs end in the goal; 20 end outside it, x by up to 229.21 µm
    not proved in step 4 (straighten): every final pose lies in the goal
    what would settle it: change the move that is not proved, or let `meso-robust plan` find a plan
    """
    known = task_of(task)
    stated = plan_of(plan, known)

    from meso_robust import pipeline
    from meso_robust.planning.compose import Found
    from meso_robust.planning.inference import inferred
    from meso_robust.planning.possible import refuse_impossible
    from meso_robust.planning.remedy import Remedy
    from meso_robust.planning.rules import rules_of
    from meso_robust.primitives.setup import setup_of

    refuse_impossible(known)
    rules = rules_of(stated) or inferred(stated, known, setup_of(known))
    found = Found(rules=rules, scale=1.0, remedy=Remedy.CHANGE_MOVE)
    result = pipeline.judge(known, found, samples, seed, progress.doing)
    return Planned(result=result, inputs=files_of(task, plan))


def plan_of(plan: PlanGiven, task: Task) -> PlanDocument:
    """A plan for a task, read if it is named, and checked like a file in any case.

    Raises
    ------
    InputError
        It cannot be read, a value breaks a rule, or it was made for another task.
    """
    from meso_robust.planning.plan_file import PlanDocument
    from meso_robust.planning.reading import accepted_plan, read_plan

    if isinstance(plan, str | PathLike):
        return read_plan(Path(plan), task)
    document = plan.plan if isinstance(plan, Planned) else plan
    if not isinstance(document, PlanDocument):
        raise InputError(
            f"plan = {document!r:.60}: must be a Planned, its plan, or the name of a plan.json; "
            "give what mr.plan returns"
        )
    return accepted_plan(document, "plan", task)


def _promised(
    task: Task,
    model: Path,
    samples: int,
    seed: int,
    progress: Progress,
    inputs: tuple[Path, ...],
) -> Planned:
    """The plan for the task as a fitted model says it is, with that task and its premises."""
    from meso_robust.toml_files import read_toml, toml_of

    read_toml(model, "give a model.toml")  # before the imports that take seconds

    from meso_robust.planning.possible import refuse_impossible
    from meso_robust.transfer import answer
    from meso_robust.transfer.promise import promise, read

    fitted = read(model, task)
    refuse_impossible(task)
    made = promise(task, fitted, samples, seed, progress.doing)
    more = {
        "task.toml": toml_of(made.changed.task),
        "premises.json": text_of(answer.document(made)),
    }
    return Planned(result=made.planned, promise=made, more=more, inputs=inputs)


def with_check(made: Planned, progress: Progress = SILENT) -> Planned:
    """A plan with what the checker says of its certificate.

    Parameters
    ----------
    made
        The plan.
    progress
        Shows what is being done.

    Returns
    -------
    Planned
        The same, ``checked``, with ``check.json`` among its files.
    """
    from meso_robust.api.checked import accepted, checked

    task = made.task
    found = checked(lambda: accepted(made.certificate, task), task, progress=progress)
    return replace(made, checked=found)


def _widest(task: TaskGiven, result: Judged) -> dict[str, str]:
    """The task with the spacing that was found, otherwise as its author wrote it."""
    from meso_robust.task import task_text, with_spacing
    from meso_robust.toml_files import toml_of

    text = task_text(Path(task)) if isinstance(task, str | PathLike) else toml_of(task)
    return {"task.toml": with_spacing(text, result.task.probe.tip_spacing_um)}


def _policy(task: Task, progress: Progress) -> dict[str, str]:
    """The certified feedback policy, its picture, and both in words."""
    from meso_robust.policy.build import make_policy
    from meso_robust.policy.document import policy_document
    from meso_robust.policy.region import sensed_start, tube
    from meso_robust.reporting.policy import draw, summary

    before = time.perf_counter()
    policy = make_policy(task, progress.doing)
    seconds = time.perf_counter() - before
    try:
        slices = tube(policy, sensed_start(task))
    except ValueError as error:
        raise NotApplicableError(
            "the policy is not certified from the task's start; leave out --policy"
        ) from error
    return {
        "policy.json": policy_document(policy).model_dump_json(by_alias=True) + "\n",
        "region.svg": draw(policy, slices),
        "policy.md": summary(policy, slices, seconds),
    }
