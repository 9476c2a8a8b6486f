"""``meso-robust simulate``: runs a plan in the simulator and shows what happens."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from meso_robust.cli.console import NEGATIVE, Reporter, refuse

if TYPE_CHECKING:
    from meso_robust.execution.filming import Camera
    from meso_robust.execution.simulation import Simulated

FRAME_RATE_HZ = 30.0  # of the paper's camera, Section IV


@dataclass(frozen=True, slots=True, kw_only=True)
class _Asked:
    """What the user asked for."""

    task: Path
    plan: Path
    out: Path
    samples: int
    seed: int
    adversarial: bool
    witness: Path | None
    recordings: int
    noise_um: float
    noise_deg: float
    dropout: float
    latency_ms: float
    as_json: bool
    quiet: bool


def simulate(  # noqa: PLR0913  # every option of the verb is an argument
    task: Annotated[Path, typer.Argument(help="Task file (TOML).")],
    plan: Annotated[Path, typer.Argument(help="Plan for this task (plan.json).")],
    out: Annotated[Path, typer.Option(help="Folder for the results.")] = Path(
        "meso-robust-simulate"
    ),
    samples: Annotated[int, typer.Option(min=1, max=1_000_000, help="Random runs.")] = 200,
    adversarial: Annotated[
        bool, typer.Option("--adversarial", help="Search the uncertainties for the worst run.")
    ] = False,
    witness: Annotated[
        Path | None,
        typer.Option(help="Replay this witness.json, or the one of a REFUTED certificate."),
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
    latency_ms: Annotated[float, typer.Option(min=0, max=1000, help="Delay of the camera.")] = 0.0,
    seed: Annotated[int, typer.Option(min=0, help="Seed of the random runs.")] = 0,
    as_json: Annotated[bool, typer.Option("--json", help="Print simulation.json only.")] = False,
    quiet: Annotated[bool, typer.Option("--quiet", help="Say nothing but the result.")] = False,
) -> None:
    """Run a plan in the simulator; write the runs, their trajectories and an animation."""
    from meso_robust.errors import InputError

    asked = _Asked(
        task=task,
        plan=plan,
        out=out,
        samples=samples,
        seed=seed,
        adversarial=adversarial,
        witness=witness,
        recordings=recordings,
        noise_um=noise_um,
        noise_deg=noise_deg,
        dropout=dropout,
        latency_ms=latency_ms,
        as_json=as_json,
        quiet=quiet,
    )
    try:
        _simulate(asked, Reporter(quiet or as_json))
    except InputError as error:
        refuse(error)


def _simulate(asked: _Asked, say: Reporter) -> None:
    from meso_robust.files import check_folder, write_all
    from meso_robust.planning.reading import read_plan
    from meso_robust.primitives.setup import setup_of
    from meso_robust.task import load_task

    task = load_task(asked.task)
    plan = read_plan(asked.plan, task)
    check_folder(asked.out)

    from meso_robust.execution.simulation import player_of, simulated
    from meso_robust.execution.simulation_answer import document, summary
    from meso_robust.execution.trajectories import trajectories
    from meso_robust.execution.witness import read_witness
    from meso_robust.reporting.animation import animation

    camera = _camera(asked)
    player = player_of(plan, setup_of(task))
    found = simulated(
        task,
        plan,
        player,
        samples=asked.samples,
        seed=asked.seed,
        adversarial=asked.adversarial,
        witness=None if asked.witness is None else read_witness(asked.witness, task, plan, player),
        doing=say.doing,
    )
    with say.doing("writing the results"):
        answer = document(found)
        text = answer.model_dump_json(by_alias=True, indent=2) + "\n"
        write_all(
            asked.out,
            {
                "simulation.json": text,
                "trajectories.csv": trajectories(found),
                "animation.html": animation(found, answer),
            },
        )
    if asked.recordings:
        with say.doing("writing the recordings"):
            _record(asked, found, camera)
    if asked.as_json:
        print(text, end="")
    elif not asked.quiet:
        print(summary(answer))
        print(f"animation: {asked.out / 'animation.html'}")
    if not answer.all_in_goal:
        raise typer.Exit(NEGATIVE)


def _camera(asked: _Asked) -> Camera:
    """The camera that was asked for."""
    import numpy as np

    from meso_robust.errors import InputError
    from meso_robust.execution.filming import Camera
    from meso_robust.simulator import Effects
    from meso_robust.simulator.observation import Sensor

    try:
        return Camera(
            sensor=Sensor(
                position_sigma=1e-6 * asked.noise_um,
                orientation_sigma=float(np.radians(asked.noise_deg)),
                frame_rate=FRAME_RATE_HZ,
                dropout=asked.dropout,
            ),
            effects=Effects({"camera_latency": {"time_ms": asked.latency_ms}}),
        )
    except ValueError as error:
        raise InputError(f"--noise-um, --noise-deg, --dropout, --latency-ms: {error}") from error


def _record(asked: _Asked, found: Simulated, camera: Camera) -> None:
    """Write some of the runs as a camera would record them."""
    import numpy as np

    from meso_robust.execution.filming import film_plan
    from meso_robust.recordings import write_set

    rng = np.random.default_rng(asked.seed)
    write_set(asked.out / "recordings", film_plan(found, camera, rng, asked.recordings))
