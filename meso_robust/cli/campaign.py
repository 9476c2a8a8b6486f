"""``meso-robust campaign``: properties, Monte Carlo and falsification, from one core to a cluster."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from meso_robust.cli.console import INTERRUPTED, NEGATIVE, Reporter, refuse

if TYPE_CHECKING:
    from meso_robust.campaigns.answer import Answer
    from meso_robust.campaigns.crew import Crew
    from meso_robust.campaigns.document import Campaign
    from meso_robust.campaigns.kind import Result
    from meso_robust.campaigns.store import Store

EXAMPLES = "examples"
"""Folder of failing examples below that of the results, unless another one is given."""


@dataclass(frozen=True, slots=True, kw_only=True)
class _Asked:
    """What the user asked for."""

    campaign: Path
    out: Path
    examples: Path
    workers: int | None
    scheduler: str | None
    resume: bool
    seed: int | None
    as_json: bool
    quiet: bool


def campaign(  # noqa: PLR0913  # every option of the verb is an argument
    campaign: Annotated[Path, typer.Argument(help="Campaign file (TOML).")],
    out: Annotated[Path, typer.Option(help="Folder for the store and the report.")] = Path(
        "meso-robust-campaign"
    ),
    examples: Annotated[
        Path | None,
        typer.Option(
            help="Folder where failing examples are kept, and tried again by every campaign that is "
            "given it; the results' own by default."
        ),
    ] = None,
    workers: Annotated[
        int | None, typer.Option(min=1, max=1024, help="Processes; one for each core by default.")
    ] = None,
    scheduler: Annotated[
        str | None, typer.Option(help="Dask scheduler to use instead, such as tcp://host:8786.")
    ] = None,
    resume: Annotated[
        bool, typer.Option("--resume", help="Go on with what the folder's store holds.")
    ] = False,
    seed: Annotated[
        int | None, typer.Option(min=0, help="Instead of the seed in the file.")
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print campaign.json only.")] = False,
    quiet: Annotated[bool, typer.Option("--quiet", help="Say nothing but the result.")] = False,
) -> None:
    """Run a campaign in small seeded chunks; write its store, campaign.json and report.html."""
    from meso_robust.errors import InputError

    asked = _Asked(
        campaign=campaign,
        out=out,
        examples=examples or out / EXAMPLES,
        workers=workers,
        scheduler=scheduler,
        resume=resume,
        seed=seed,
        as_json=as_json,
        quiet=quiet,
    )
    try:
        _campaign(asked, Reporter(quiet or as_json))
    except InputError as error:
        refuse(error)
    except KeyboardInterrupt:
        print(
            "meso-robust: interrupted; what is done is kept, --resume goes on with it",
            file=sys.stderr,
        )
        raise typer.Exit(INTERRUPTED) from None


def _campaign(asked: _Asked, say: Reporter) -> None:
    from meso_robust.campaigns.answer import answered, document, summary
    from meso_robust.campaigns.document import read_campaign
    from meso_robust.errors import InputError

    if asked.workers is not None and asked.scheduler is not None:
        raise InputError("--workers, --scheduler: give one of them; a cluster has its own workers")
    with say.doing("reading the campaign and what it names"):
        stated = read_campaign(asked.campaign, asked.seed)
    store = _store(asked, stated)
    try:
        with say.doing("trying kept examples again"):
            replayed = _replayed(asked, stated)
        _work(asked, stated, store, say)
        with say.doing("adding up"):
            answer = answered(stated, store, replayed)
            left = _left(stated, store)
    finally:
        store.close()
    text = _write(asked, answer, document(answer), left)
    if asked.as_json:
        print(text, end="")
    elif not asked.quiet:
        print(summary(answer))
        print(f"report: {asked.out / 'report.html'}")
    if answer.verdict in ("broken", "incomplete", "open"):
        raise typer.Exit(NEGATIVE)


def _store(asked: _Asked, stated: Campaign) -> Store:
    from meso_robust.campaigns.provenance import code
    from meso_robust.campaigns.store import NAME, Store
    from meso_robust.errors import InputError
    from meso_robust.files import check_folder

    check_folder(asked.out)
    path = asked.out / NAME
    if path.exists() and not asked.resume:
        raise InputError(
            f"--out {asked.out}: holds a campaign already; go on with it by --resume, or give "
            "another folder"
        )
    try:
        asked.out.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(
            f"--out {asked.out}: cannot be made ({error.strerror}); give a folder that can"
        ) from error
    return Store(path, stated.values, code())


def _replayed(asked: _Asked, stated: Campaign) -> dict[str, Result]:
    """What comes of trying again what earlier campaigns kept in the folder."""
    from meso_robust.campaigns.kinds import kind_of

    found = {}
    for part in stated.parts:
        replay = kind_of(part.kind).replay
        if replay is not None and asked.examples.exists():
            found[part.name] = replay(part, asked.examples)
    return found


def _keep(asked: _Asked, answer: Answer) -> None:
    """Save what later campaigns in this folder should try again."""
    from meso_robust.campaigns.kinds import kind_of
    from meso_robust.errors import InputError

    for one in answer.parts:
        keep = kind_of(one.part.kind).keep
        try:
            if keep is not None and one.failed:
                keep(asked.examples, one.totals)
        except OSError as error:
            raise InputError(
                f"--examples {asked.examples}: cannot be written ({error}); free some space, and "
                "give the same command with --resume"
            ) from error


def _work(asked: _Asked, stated: Campaign, store: Store, say: Reporter) -> None:
    """Do what is missing, and show how it goes."""
    from meso_robust.campaigns.kinds import kind_of
    from meso_robust.campaigns.work import carry_out, missing

    left = sum(1 for _ in missing(stated, store))
    if left == 0:
        return
    planned = {part.name: kind_of(part.kind).count(part) for part in stated.parts}
    units = {part.name: kind_of(part.kind).unit for part in stated.parts}
    done = {name: len(store.done(name)) for name in planned}
    with say.rating() as rated:
        for step in carry_out(stated, store, _crew(asked)):
            done[step.part] += 1
            rated(
                step.part,
                (done[step.part], planned[step.part]),
                (step.runs, step.failed, units[step.part]),
            )


def _crew(asked: _Asked) -> Crew:
    if asked.scheduler is not None:
        from meso_robust.campaigns.cluster import Cluster

        return Cluster(asked.scheduler)
    from meso_robust.campaigns.crew import Processes

    return Processes(asked.workers or os.cpu_count() or 1)


def _left(stated: Campaign, store: Store) -> dict[str, list[int]]:
    """Chunks that were not done, by the name of their part."""
    from meso_robust.campaigns.work import missing

    found: dict[str, list[int]] = {}
    for ticket in missing(stated, store):
        found.setdefault(ticket.part, []).append(ticket.chunk)
    return found


def _write(
    asked: _Asked, answer: Answer, found: dict[str, object], left: dict[str, list[int]]
) -> str:
    """Write failures, ``campaign.json`` and ``report.html``; the text of the document."""
    import json

    from meso_robust.files import write_all
    from meso_robust.reporting.campaign import campaign_report

    _keep(asked, answer)
    for folder, files in _failures(answer):
        write_all(asked.out / folder, files)
    text = json.dumps(found, indent=1, ensure_ascii=False, allow_nan=False) + "\n"
    write_all(asked.out, {"campaign.json": text, "report.html": campaign_report(answer, left)})
    return text


def _failures(answer: Answer) -> Iterator[tuple[str, dict[str, str]]]:
    for one in answer.parts:
        for shown in one.shown:
            if shown.folder:
                yield shown.folder, dict(shown.failure.files)
