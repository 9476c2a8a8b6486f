"""``trajectories.csv``: where the part and the probe tips were, run by run."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterator

import numpy as np

from meso_robust import units
from meso_robust.laboratory.endings import ending
from meso_robust.laboratory.replay import Player
from meso_robust.laboratory.running import PlanRun
from meso_robust.laboratory.simulation import RECORD, Simulated
from meso_robust.types import Floats

EVERY = 4  # of the recorded instants, which lie close enough for the animation's contact modes


def trajectories(found: Simulated) -> str:
    """Where the part and the probe tips were, run by run.

    Parameters
    ----------
    found
        All that was simulated.

    Returns
    -------
    str
        The text of ``trajectories.csv``. One line a recorded instant: run, move (from 1), part of the
        move (0 to 1), pose of the part in um and deg, x and y of every probe tip in um. A cell is empty
        where a probe has no part in the move. A run that ended early has the lines up to its end.
    """
    names = probe_names(found.player)
    buffer = io.StringIO()
    writer = csv.writer(buffer, lineterminator="\n")
    writer.writerow(
        ["run", "move", "part_of_move", "part_x_um", "part_y_um", "part_theta_deg"]
        + [f"{name}_{axis}_um" for name in names for axis in ("x", "y")]
    )
    for name, case in found.cases:
        writer.writerows(_lines(found.player, case.runs, 0, name, names))
    for row in range(len(found.rows)):
        writer.writerows(_lines(found.player, found.sampled, row, f"sample {row}", names))
    return buffer.getvalue()


def probe_names(player: Player) -> tuple[str, ...]:
    """Names of all probes of a plan.

    Parameters
    ----------
    player
        The plan.

    Returns
    -------
    tuple
        Each once, in the order in which they come.
    """
    return tuple(dict.fromkeys(name for names in player.probes for name in names))


def _lines(
    player: Player, runs: PlanRun, row: int, name: str, names: tuple[str, ...]
) -> Iterator[list[str]]:
    end = ending(player, runs, row)
    last = len(runs.moves) - 1 if end.move is None else end.move
    for k in range(last + 1):
        shares = np.linspace(0.0, 1.0, RECORD // EVERY + 1)
        stop = end.share if k == end.move else 1.0
        shares = np.append(shares[shares < stop], stop)
        table = _table(runs, k, row, shares)
        where = {probe: 3 + 2 * at for at, probe in enumerate(player.probes[k])}
        for share, values in zip(shares, table, strict=True):
            cells = [f"{value:.4f}" for value in values[:3]]
            for probe in names:
                at = where.get(probe)
                cells += ["", ""] if at is None else [f"{v:.4f}" for v in values[at : at + 2]]
            yield [name, str(k + 1), f"{share:.6g}", *cells]


def _table(runs: PlanRun, move: int, row: int, shares: Floats) -> Floats:
    """(S, 3 + 2P) pose and tips at parts of a move, um and deg."""
    one = runs.moves[move]
    known = np.linspace(0.0, 1.0, one.path.shape[1])
    pose = [np.interp(shares, known, one.path[row, :, axis]) for axis in range(3)]
    tips = one.tips_at(row, shares)
    scale = np.array([units.UM, units.UM, units.DEG])
    return np.hstack([np.stack(pose, axis=1) / scale, tips.reshape(len(shares), -1) / units.UM])
