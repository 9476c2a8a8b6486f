"""``meso-robust identify``: fits a model to recordings, plans and designs the pushes for it."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from meso_robust.cli.console import NEGATIVE, Reporter, refuse

if TYPE_CHECKING:
    from meso_robust.identification.experiment import Bench
    from meso_robust.identification.identify import Identification
    from meso_robust.recordings import Polygon, RecordingSet, Rectangle


@dataclass(frozen=True, slots=True, kw_only=True)
class _Asked:
    """What the user asked for."""

    recordings: Path
    model: str
    starts: int
    objective: str
    seed: int
    confidence: float
    plan: bool
    design: int
    out: Path
    as_json: bool
    quiet: bool


def identify(  # noqa: PLR0913  # every option of the verb is an argument
    recordings: Annotated[
        Path, typer.Argument(help="Recording set (folder); with --plan also a task file.")
    ],
    model: Annotated[str, typer.Option(help="viscous, three_point …")] = "viscous",
    starts: Annotated[
        int, typer.Option(min=1, max=10_000, help="Random starts of the search.")
    ] = 20,
    objective: Annotated[
        str,
        typer.Option(help="likelihood, with intervals; printed: the paper's objective alone."),
    ] = "likelihood",
    confidence: Annotated[
        float, typer.Option(min=0.5, max=0.999, help="Probability of the intervals.")
    ] = 0.9,
    plan: Annotated[
        bool, typer.Option("--plan", help="Only write the paper's tests A-H for this part.")
    ] = False,
    design: Annotated[
        int, typer.Option(min=0, max=100, help="Also propose this many pushes that tell most.")
    ] = 0,
    seed: Annotated[int, typer.Option(min=0, help="Seed of the random starts.")] = 0,
    out: Annotated[Path, typer.Option(help="Folder for the results.")] = Path(
        "meso-robust-identify"
    ),
    as_json: Annotated[
        bool, typer.Option("--json", help="Print the result document only.")
    ] = False,
    quiet: Annotated[bool, typer.Option("--quiet", help="Say nothing but the result.")] = False,
) -> None:
    """Fit a model to recorded pushes: values, intervals, and what cannot be known from them."""
    from meso_robust.errors import InputError

    asked = _Asked(
        recordings=recordings,
        model=model,
        starts=starts,
        objective=objective,
        seed=seed,
        confidence=confidence,
        plan=plan,
        design=design,
        out=out,
        as_json=as_json,
        quiet=quiet,
    )
    try:
        (_plan if plan else _identify)(asked, Reporter(quiet or as_json))
    except InputError as error:
        refuse(error)


def _identify(asked: _Asked, say: Reporter) -> None:
    from meso_robust import __version__
    from meso_robust.errors import InputError
    from meso_robust.files import write_all
    from meso_robust.recordings import read_set

    if asked.objective not in ("likelihood", "printed"):
        raise InputError(
            f"--objective {asked.objective}: must be likelihood or printed; choose one"
        )
    if asked.design and asked.objective == "printed":
        raise InputError("--design: needs the information of a likelihood; leave --objective out")
    recordings = read_set(asked.recordings)
    _check_out(asked)

    from meso_robust.identification.usable import pathological_of, warnings_of

    with say.doing("checking the recordings"):
        warnings = warnings_of(recordings)

    from meso_robust.identification.answer import document, summary
    from meso_robust.identification.layout import toml_of
    from meso_robust.reporting.identification import identification_report

    found = _fitted(asked, recordings, say)
    with say.doing("looking for pathological starts"):
        remarks = (*warnings, *pathological_of(recordings, found.model, found.best))
    answer = document(recordings, found, __version__, remarks)
    text = answer.model_dump_json(by_alias=True, indent=2) + "\n"
    with say.doing("writing the results"):
        page = identification_report(answer, found, str(asked.recordings))
        files = {"model.toml": toml_of(answer), "identification.json": text, "report.html": page}
    if asked.design:
        with say.doing(f"designing {asked.design} pushes"):
            files |= _designed(recordings, found, asked.design)
    write_all(asked.out, files)
    if asked.as_json:
        print(text, end="")
    elif not asked.quiet:
        print(summary(answer))
        for line in remarks:
            print(f"  {line}")
        print(f"report: {asked.out / 'report.html'}")
    if not found.determined:
        raise typer.Exit(NEGATIVE)


def _fitted(asked: _Asked, recordings: RecordingSet, say: Reporter) -> Identification:
    """The fit, with a bar that counts the searches that have ended."""
    from meso_robust.identification.identify import identify as fitted

    with say.counting(f"fitting {asked.model} from {asked.starts} starts", asked.starts) as advance:
        ended = 0

        def told(_: str, done: int, total: int) -> None:
            nonlocal ended
            while total == asked.starts and ended < done:
                advance()
                ended += 1

        return fitted(
            recordings,
            model=asked.model,
            starts=asked.starts,
            objective="printed" if asked.objective == "printed" else "likelihood",
            seed=asked.seed,
            confidence=asked.confidence,
            told=told,
        )


def _designed(recordings: RecordingSet, found: Identification, count: int) -> dict[str, str]:
    """Files of the pushes that tell most beside the recordings there are."""
    from dataclasses import replace

    from meso_robust.identification.design import DETERMINANT, design
    from meso_robust.identification.experiment import Bench
    from meso_robust.identification.experiment_document import experiment_files
    from meso_robust.identification.rollout import Setting
    from meso_robust.reporting.experiment import experiment_page

    settings, fitted, quality = found.settings, found.fitted, found.quality
    if settings is None or fitted is None or quality is None:
        return {}
    bench = Bench(tip_radius=recordings.tip_radius)
    sensor = replace(
        recordings.sensor,
        position_sigma=settings.position,
        orientation_sigma=settings.orientation,
    )
    made = design(
        Setting(part=recordings.part, bench=bench, model=found.model),
        found.best,
        sensor,
        count,
        known=fitted.information[0] / quality.widening,
        criterion=DETERMINANT,
    )
    page = experiment_page(made.experiment, made, found.model)
    return {**experiment_files(made.experiment, made, found.model), "experiment.html": page}


def _plan(asked: _Asked, say: Reporter) -> None:
    from meso_robust.files import write_all

    part, bench = _bench(asked.recordings)
    _check_out(asked)

    from meso_robust.identification.experiment import standard_tests
    from meso_robust.identification.experiment_document import experiment_files
    from meso_robust.reporting.experiment import experiment_page

    with say.doing("planning the tests"):
        experiment = standard_tests(part, bench)
        files = experiment_files(experiment)
        write_all(asked.out, {**files, "experiment.html": experiment_page(experiment)})
    if asked.as_json:
        print(files["experiment.json"], end="")
    elif not asked.quiet:
        print(f"{len(experiment.pushes)} pushes, {bench.trials} times each")
        print(f"drawing: {asked.out / 'experiment.html'}")


def _bench(path: Path) -> tuple[Rectangle | Polygon, Bench]:
    """Part and bench of a recording set or of a task."""
    from meso_robust.execution.filming import recorded_part
    from meso_robust.identification.experiment import Bench
    from meso_robust.recordings import read_set
    from meso_robust.task import load_task

    if path.is_dir():
        recordings = read_set(path)
        return recordings.part, Bench(tip_radius=recordings.tip_radius)
    task = load_task(path)
    return recorded_part(task.part), Bench(speed=1e-6 * task.probe.speed_um_s)


def _check_out(asked: _Asked) -> None:
    """A folder that can be written to, and not the recordings': a plan has a set.toml of its own."""
    from meso_robust.errors import InputError
    from meso_robust.files import check_folder

    check_folder(asked.out)
    if asked.out.resolve() == asked.recordings.resolve():
        raise InputError(f"--out {asked.out}: is the folder of the recordings; give another folder")
