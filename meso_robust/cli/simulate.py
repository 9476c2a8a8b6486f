"""``meso-robust simulate``: runs a plan in the simulator and shows what happens."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from meso_robust.cli.console import NEGATIVE, Reporter, refuse
from meso_robust.limits import LONGEST_LATENCY_MS, MOST_SAMPLES

if TYPE_CHECKING:
    from meso_robust.api.simulate import Simulated

RESULTS = ("simulation.json", "trajectories.csv", "animation.html")
"""Files that are written beside the recordings."""


def simulate(  # noqa: PLR0913  # every option of the verb is an argument
    task: Annotated[Path, typer.Argument(help="Task file (TOML).")],
    plan: Annotated[Path, typer.Argument(help="Plan for this task (plan.json).")],
    out: Annotated[Path, typer.Option(help="Folder for the results.")] = Path(
        "meso-robust-simulate"
    ),
    samples: Annotated[int, typer.Option(min=1, max=MOST_SAMPLES, help="Random runs.")] = 200,
    adversarial: Annotated[
        bool, typer.Option("--adversarial", help="Search the uncertainties for the worst run.")
    ] = False,
    witness: Annotated[
        Path | None,
        typer.Option(help="Replay this witness.json, or the witness in a REFUTED certificate."),
    ] = None,
    recordings: Annotated[
        int,
        typer.Option(
            min=0,
            max=10_000,
            help="Write this many runs as a recording set, as a camera sees them.",
        ),
    ] = 0,
    noise_um: Annotated[float, typer.Option(min=0, help="Noise of recorded positions.")] = 1.2,
    noise_deg: Annotated[float, typer.Option(min=0, help="Noise of recorded angles.")] = 0.08,
    dropout: Annotated[float, typer.Option(min=0, max=0.99, help="Share of lost frames.")] = 0.0,
    latency_ms: Annotated[
        float, typer.Option(min=0, max=LONGEST_LATENCY_MS, help="Delay of the camera.")
    ] = 0.0,
    seed: Annotated[int, typer.Option(min=0, help="Seed of the random runs.")] = 0,
    as_json: Annotated[bool, typer.Option("--json", help="Print simulation.json only.")] = False,
    quiet: Annotated[bool, typer.Option("--quiet", help="Print only the result.")] = False,
) -> None:
    """Run a plan in the simulator; write the runs, their trajectories and an animation."""
    from meso_robust.errors import InputError

    camera = {
        "noise_um": noise_um,
        "noise_deg": noise_deg,
        "dropout": dropout,
        "latency_ms": latency_ms,
    }
    runs = {"samples": samples, "seed": seed, "adversarial": adversarial, "witness": witness}
    try:
        found = _found((task, plan, out), runs, recordings, camera, Reporter(quiet or as_json))
    except InputError as error:
        refuse(error)
    if as_json:
        print(found.document.model_dump_json(by_alias=True, indent=2))
    elif not quiet:
        print(found)
        print(f"animation: {out / 'animation.html'}")
    if not found.all_in_goal:
        raise typer.Exit(NEGATIVE)


def _found(
    paths: tuple[Path, Path, Path],
    runs: dict[str, Any],
    recorded: int,
    camera: dict[str, float],
    say: Reporter,
) -> Simulated:
    """The runs, written into the last of ``paths``, some of them as ``recorded`` too."""
    from meso_robust.files import check_folder
    from meso_robust.laboratory.witness_form import check_form
    from meso_robust.planning.reading import read_plan
    from meso_robust.task import load_task

    task_file, plan_file, out = paths
    task = load_task(task_file)
    plan = read_plan(plan_file, task)
    if runs["witness"] is not None:
        check_form(runs["witness"])
    check_folder(out, RESULTS, (task_file, plan_file, runs["witness"]))

    from meso_robust.api.simulate import camera_of, simulate as simulated

    seen_by = camera_of(**camera)
    found = simulated(task, plan, progress=say, **runs)
    found.save(out, progress=say)
    if recorded:
        with say.doing("writing the recordings"):
            found.record(out / "recordings", recorded, seen_by, runs["seed"])
    return found
