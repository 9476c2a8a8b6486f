"""``meso-robust simulate``: runs a plan in the simulator and shows what happens."""

from __future__ import annotations

from typing import Annotated

import typer

from meso_robust.api.simulate import Simulated, camera_of, simulate as call
from meso_robust.cli.verb import Run, verb

RESULTS = ("simulation.json", "trajectories.csv", "animation.html")
"""Files that are written beside the recordings."""


@verb(call, camera_of, out="meso-robust-simulate", document="simulation.json")
def simulate(
    run: Run,
    recordings: Annotated[
        int,
        typer.Option(
            min=0,
            max=10_000,
            help="Write this many runs as a recording set, as a camera sees them.",
        ),
    ] = 0,
) -> Simulated:
    """Run a plan in the simulator; write the runs, their trajectories and an animation."""
    camera = run.of(camera_of)
    simulated = run.saved(RESULTS)
    if recordings:
        with run.say.doing("writing the recordings"):
            folder, seed = run.out / "recordings", run.given["seed"]
            simulated.record(folder, recordings, camera_of(**camera), seed)
    return simulated
