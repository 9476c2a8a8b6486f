"""``meso-robust plan``: the main job, from a task to a certified and cross-checked plan."""

from __future__ import annotations

import time
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Annotated

import typer

from meso_robust.cli.console import NEGATIVE, Reporter, negative, refuse

if TYPE_CHECKING:
    from meso_robust.job import Planned
    from meso_robust.premises.promise import Promise
    from meso_robust.task import Task


@dataclass(frozen=True, slots=True, kw_only=True)
class _Asked:
    """What the user asked for."""

    task: Path | None
    model: Path | None
    out: Path
    samples: int
    seed: int
    widest: bool
    policy: bool
    maps: bool
    as_json: bool
    quiet: bool


def plan(  # noqa: PLR0913  # every option of the verb is an argument
    task: Annotated[
        Path | None, typer.Argument(help="Task file (TOML); the paper's task if left out.")
    ] = None,
    model: Annotated[
        Path | None,
        typer.Option(
            help="Fitted model (model.toml): plan for the task as it says the laboratory is, or say "
            "which premise of the proof it breaks; also writes that task and premises.json."
        ),
    ] = None,
    out: Annotated[Path, typer.Option(help="Folder for the results.")] = Path("meso-robust-plan"),
    samples: Annotated[
        int, typer.Option(min=1, max=1_000_000, help="Random runs in the simulator.")
    ] = 1000,
    seed: Annotated[int, typer.Option(min=0, help="Seed of the random runs.")] = 0,
    widest: Annotated[
        bool,
        typer.Option(
            "--widest",
            help="Search tip spacing, push offsets and travels for the widest margin (minutes); "
            "also writes the task with that spacing.",
        ),
    ] = False,
    policy: Annotated[
        bool,
        typer.Option(
            "--policy",
            help="Also certify a feedback policy: policy.json for `drive`, region.svg of its starts.",
        ),
    ] = False,
    maps: Annotated[
        bool,
        typer.Option(
            "--maps", help="Also draw where each primitive may push, from which start (SVG, JSON)."
        ),
    ] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print certificate.json only.")] = False,
    quiet: Annotated[bool, typer.Option("--quiet", help="Say nothing but the result.")] = False,
) -> None:
    """Find a plan, certify it, cross-check it in the simulator, and write a report."""
    from meso_robust.errors import InputError, NotApplicableError

    asked = _Asked(
        task=task,
        model=model,
        out=out,
        samples=samples,
        seed=seed,
        widest=widest,
        policy=policy,
        maps=maps,
        as_json=as_json,
        quiet=quiet,
    )
    try:
        _plan(asked, Reporter(quiet or as_json))
    except InputError as error:
        refuse(error)
    except NotApplicableError as error:
        negative(f"UNKNOWN: {error}")


def _plan(asked: _Asked, say: Reporter) -> None:
    from meso_robust.files import check_folder
    from meso_robust.task import load_task, with_spacing
    from meso_robust.tasks import PAPER

    file = asked.task or PAPER
    task = load_task(file)
    check_folder(asked.out)
    if asked.model is not None:
        _promise(task, asked.model, asked, say)
        return

    from meso_robust.job import make, make_best

    result = (make_best if asked.widest else make)(task, asked.samples, asked.seed, say.doing)
    more = {}
    if asked.widest:
        text = file.read_text(encoding="utf-8")
        more["task.toml"] = with_spacing(text, result.task.probe.tip_spacing_um)
    if asked.policy:
        more |= _policy(result.task, say)
    if asked.maps:
        from meso_robust.reporting.admissible import map_files

        more |= map_files(result.task, say.doing)
    write(result, asked.out, say, more)
    tell(result, asked.out, asked.as_json, asked.quiet)


def _promise(task: Task, file: Path, asked: _Asked, say: Reporter) -> None:
    """Plan for the task as a fitted model says it is."""
    from meso_robust.errors import InputError
    from meso_robust.identification.layout import toml_of
    from meso_robust.premises.answer import document, summary
    from meso_robust.premises.promise import promise, read

    if asked.widest or asked.policy or asked.maps:
        raise InputError(
            "--model: goes with none of --widest, --policy, --maps, which are about a task alone; "
            f"plan with the model first, then use {asked.out / 'task.toml'}"
        )
    made = promise(task, read(file, task), asked.samples, asked.seed, say.doing)
    answer = document(made)
    more = {
        "task.toml": toml_of(made.changed.task),
        "premises.json": answer.model_dump_json(by_alias=True, indent=2) + "\n",
    }
    write(made.planned, asked.out, say, more, made)
    tell(made.planned, asked.out, asked.as_json, asked.quiet, summary(made))


def _policy(task: Task, say: Reporter) -> dict[str, str]:
    """The certified feedback policy, its picture, and both in words."""
    from meso_robust.errors import NotApplicableError
    from meso_robust.policy.build import make_policy
    from meso_robust.policy.document import policy_document
    from meso_robust.policy.region import sensed_start, tube
    from meso_robust.reporting.policy import draw, summary

    before = time.perf_counter()
    policy = make_policy(task, say.doing)
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


def write(
    result: Planned,
    out: Path,
    say: Reporter,
    more: Mapping[str, str] = MappingProxyType({}),
    promise: Promise | None = None,
) -> None:
    """Write plan, certificate, report and ``more`` files (name to text), all or none."""
    from meso_robust.files import write_all
    from meso_robust.reporting.page import report

    with say.doing("writing the report"):
        page = report(result, promise)
    documents = {"plan.json": result.plan, "certificate.json": result.certificate}
    texts = {
        name: document.model_dump_json(by_alias=True, indent=2) + "\n"
        for name, document in documents.items()
    }
    write_all(out, {**texts, "report.html": page, **more})


def tell(
    result: Planned, out: Path, as_json: bool, quiet: bool, summary: str | None = None
) -> None:
    """Print the answer (or another ``summary`` of it); ends with exit status 1 unless PROVED."""
    if as_json:
        print(result.certificate.model_dump_json(by_alias=True, indent=2))
    elif not quiet:
        print(summary or result.summary)
        print(f"report: {out / 'report.html'}")
    if result.certificate.verdict != "PROVED":
        raise typer.Exit(NEGATIVE)
