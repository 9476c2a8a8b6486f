"""What ``simulate`` answers: the document it writes and the lines it prints."""

from __future__ import annotations

import platform
from collections import Counter
from importlib.metadata import version

from meso_robust import units
from meso_robust.laboratory.endings import ending, words
from meso_robust.laboratory.replay import Player, miss
from meso_robust.laboratory.running import STEP, PlanRun
from meso_robust.laboratory.simulation import Case, Simulated, in_goal
from meso_robust.laboratory.simulation_document import (
    AdversaryDocument,
    CaseDocument,
    EndingDocument,
    FinalPose,
    RunDocument,
    SampledDocument,
    SimulationDocument,
    UncertainDocument,
)
from meso_robust.planning.document import goal_document
from meso_robust.types import Floats
from meso_robust.wording import counted, up

PACKAGES = ("meso-robust", "numba", "numpy")  # those that bear on the digits of a run


def document(found: Simulated) -> SimulationDocument:
    """What is written to ``simulation.json``.

    Parameters
    ----------
    found
        All that was simulated.

    Returns
    -------
    SimulationDocument
        How every run ended, um and deg.
    """
    player = found.player
    names = tuple(f"sample {row}" for row in range(len(found.rows)))
    runs = _runs(player, found.sampled, names)
    alone = {name: _case(player, name, case) for name, case in found.cases}
    adversary = None
    if found.worst is not None:
        adversary = AdversaryDocument(evaluations=found.evaluations, worst=alone["worst"])
    return SimulationDocument(
        task=found.task.name,
        task_hash=found.task.hash,
        plan_hash=found.plan.hash,
        kind="feedback" if found.plan.policy else "open_loop",
        moves=player.primitives,
        goal=goal_document(player.setup.goal),
        seed=found.seed,
        step_um=units.to_um(STEP),
        all_in_goal=all(run.in_goal for run in (*runs, *(case.run for case in alone.values()))),
        nominal=alone["nominal"].run,
        sampled=_sampled(runs),
        adversary=adversary,
        witness=alone.get("witness"),
        samples=runs,
        made_with={
            **{name: version(name) for name in PACKAGES},
            "python": platform.python_version(),
            "machine": platform.machine(),
        },
    )


def summary(answer: SimulationDocument) -> str:
    """The answer as the command line prints it.

    Parameters
    ----------
    answer
        What is written to ``simulation.json``.

    Returns
    -------
    str
        A few lines.
    """
    sampled = answer.sampled
    worst = "" if sampled.largest_miss is None else f"; worst {_away(sampled.largest_miss)}"
    lines = [
        f"{answer.task}: {counted(len(answer.moves), 'move')}, {answer.kind.replace('_', ' ')}",
        f"nominal: {_words(answer.nominal)}",
        f"samples: {sampled.completed} of {sampled.runs} completed, "
        f"{sampled.in_goal} in the goal{worst}",
    ]
    for failure in sampled.failures:
        where = "" if failure.move is None else f"move {failure.move}: "
        lines.append(f"  {failure.count} x {where}{failure.what}")
    if answer.adversary is not None:
        lines.append(
            f"worst found in {counted(answer.adversary.evaluations, 'run')} (a search, no proof): "
            f"{_words(answer.adversary.worst.run)}"
        )
    if answer.witness is not None:
        lines.append(f"witness: {_words(answer.witness.run)}")
    return "\n".join(lines)


def _away(value: float) -> str:
    return f"{up(value, 3)} tolerances off the goal's middle"


def _words(run: RunDocument) -> str:
    if run.miss is None:
        return f"move {run.move}: {words(run.outcome, run.touching)}"
    return f"{'in the goal' if run.in_goal else 'misses the goal'}, {_away(run.miss)}"


def _case(player: Player, name: str, case: Case) -> CaseDocument:
    return CaseDocument(
        run=_runs(player, case.runs, (name,))[0],
        draws=tuple(
            UncertainDocument(
                name=column.name,
                value=float(value).hex(),
                low=column.low.hex(),
                high=column.high.hex(),
            )
            for column, value in zip(player.columns, case.row[0], strict=True)
        ),
    )


def _runs(player: Player, runs: PlanRun, names: tuple[str, ...]) -> tuple[RunDocument, ...]:
    """Every run under its name."""
    away, hit = miss(runs, player.setup), in_goal(runs, player.setup)
    found = []
    for row, name in enumerate(names):
        end = ending(player, runs, row)
        found.append(
            RunDocument(
                run=name,
                outcome=end.outcome,
                move=None if end.move is None else end.move + 1,
                touching=end.touching,
                final=_pose(runs.final[row]),
                miss=None if end.move is not None else float(up(float(away[row]), 6)),
                in_goal=bool(hit[row]),
            )
        )
    return tuple(found)


def _pose(pose: Floats) -> FinalPose:
    x, y, theta = (float(value) for value in pose)
    return FinalPose(
        x_um=round(units.to_um(x), 4),
        y_um=round(units.to_um(y), 4),
        theta_deg=round(units.to_deg(theta), 5),
    )


def _sampled(runs: tuple[RunDocument, ...]) -> SampledDocument:
    misses = [run.miss for run in runs if run.miss is not None]
    failures = Counter(
        (run.move, words(run.outcome, run.touching) if run.miss is None else "misses the goal")
        for run in runs
        if not run.in_goal
    )
    return SampledDocument(
        runs=len(runs),
        completed=len(misses),
        in_goal=sum(run.in_goal for run in runs),
        largest_miss=max(misses, default=None),
        failures=tuple(
            EndingDocument(move=move, what=what, count=count)
            for (move, what), count in failures.most_common()
        ),
    )
