"""Trials of one push with the paper's uncertainties: a set-up, its conditions, and its spread."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache

import numpy as np

from meso_robust import units
from meso_robust.bounds import Interval, Verdict
from meso_robust.certificates.words import words
from meso_robust.laboratory.draws import draw
from meso_robust.laboratory.running import MoveRun, run as run_rules
from meso_robust.primitives.move import Action, MoveRule, Point, from_part
from meso_robust.primitives.obligation import Step
from meso_robust.primitives.setup import PoseBox, Setup, setup_of
from meso_robust.primitives.straighten import certify_straighten
from meso_robust.primitives.tilt import certify_tilt
from meso_robust.task import load_task
from meso_robust.tasks import PAPER
from meso_robust.types import Floats

AHEAD_UM = 520.0
"""From the part's centre to the tips at the start, along the push."""
RECORD = 120
"""Intervals of a recorded push."""
CAMERA = np.array([5e-6, 5e-6, np.deg2rad(0.3)])
"""m, m, rad; largest errors of a seen pose, Section IX-A."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Trial:
    """What the paper leaves out of a test of Fig. 14; um and deg.

    Attributes
    ----------
    action
        straighten: the pair pushes (t²); tilt: its lower tip alone, the other one passing by.
    spacing_um
        Distance of the two tips.
    middle_um
        Of the pair, from the sensed centre of the part, across the push.
    start_deg
        Sensed angle of the part at the start.
    travel_um
        Of the probe, about 100 um of it free of contact.
    """

    action: Action
    spacing_um: float
    middle_um: float
    start_deg: float
    travel_um: float

    @property
    def rule(self) -> MoveRule:
        """The push as a move of a plan."""
        return MoveRule(
            step=4,
            primitive="x_translation",
            action=self.action,
            side=1 if self.action == "tilt" else 0,
            dual=Point(x=from_part(AHEAD_UM), y=from_part(self.middle_um)),
            dual_end=from_part(AHEAD_UM - self.travel_um),
        )

    @property
    def setup(self) -> Setup:
        """The paper's part, film and errors, the part sensed at the origin at the start angle.

        Friction and errors have their printed ranges; the film and the alignment of the tips, which
        the paper takes as known, have none.
        """
        whole = _paper()
        known = replace(
            whole.uncertainty,
            film_ratio=Interval.point(whole.uncertainty.film_ratio.mid),
            misalignment=Interval.point(0.0),
        )
        origin = Interval.point(0.0) - known.sensed_position
        turn = units.radians(self.start_deg) - known.sensed_orientation
        return replace(
            whole,
            stated_spacing=units.metres(self.spacing_um),
            uncertainty=known,
            start=PoseBox(x=origin, y=origin, theta=turn),
        )


SERIES = (3, 5)
"""Trials in a series: the paper says at least three; Fig. 4 shows five."""
QUANTILES = (0.05, 0.5, 0.95)
"""Of the largest differences over many series."""


@cache
def _paper() -> Setup:
    return setup_of(load_task(PAPER))


def certified(trial: Trial) -> Step:
    """The conditions of the robust motion, each proved or not for all errors at once."""
    setup = trial.setup
    if trial.action == "tilt":
        return certify_tilt(trial.rule, setup.start, setup)
    return certify_straighten(trial.rule, setup.start, setup)


def holds(step: Step) -> bool:
    """Whether every condition is proved."""
    return step.verdict is Verdict.PROVED


def refuted(step: Step) -> list[str]:
    """Conditions that some errors break."""
    return [words(each.name) for each in step.obligations if each.proof.verdict is Verdict.REFUTED]


def why_not(step: Step) -> str:
    """Why a motion is not certified; empty if it is."""
    if step.post is None and not refuted(step):
        return "it turns too far to be enclosed"
    return "; ".join(refuted(step))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Spread:
    """Largest differences between trials, in x, y and θ, at any instant; m, m and rad.

    Attributes
    ----------
    seen, true
        By number of trials, (3, 3) quantiles over many such series in rows, `QUANTILES`: of poses
        with the camera's errors, and of the poses themselves.
    largest
        (3,) between any two of all runs, those at the corners of the errors included, and seen with
        opposite errors of the camera: what the stated errors allow.
    pair
        Share of the runs in which both tips push at the end.
    turn
        Mean turn during the last third of the push, rad.
    """

    seen: dict[int, Floats]
    true: dict[int, Floats]
    largest: Floats
    pair: float
    turn: float


def made(trial: Trial, runs: int, seed: int) -> MoveRun:
    """Run the push: the first half of 2 `runs` at random, the second at the corners of the errors."""
    draws = draw(trial.setup, 1, 2 * runs, np.random.default_rng(seed))
    return run_rules([trial.rule], trial.setup, draws, record=RECORD).moves[0]


def seen(paths: Floats, seed: int) -> Floats:
    """Ways (N, T, 3) with the camera's error of each frame."""
    rng = np.random.default_rng((seed, 1))
    return np.asarray(paths + CAMERA * rng.uniform(-1.0, 1.0, paths.shape))


def differences(paths: Floats, trials: int) -> Floats:
    """(S, 3) largest difference at any instant within each of S series of N ways (N, T, 3)."""
    whole = paths[: len(paths) // trials * trials]
    series = whole.reshape(-1, trials, *whole.shape[1:])
    return np.asarray(np.ptp(series, axis=1).max(axis=1))


def spread_of(move: MoveRun, seed: int) -> Spread:
    """Summary of the runs that `made` returns."""
    some = len(move.path) // 2
    paths, shown = move.path[:some], seen(move.path[:some], seed)
    both = np.all(move.modes[:, -1] != 0, axis=1)
    last = move.path[:, -1, 2] - move.path[:, 2 * RECORD // 3, 2]
    return Spread(
        seen={n: np.quantile(differences(shown, n), QUANTILES, axis=0) for n in SERIES},
        true={n: np.quantile(differences(paths, n), QUANTILES, axis=0) for n in SERIES},
        largest=np.ptp(move.path, axis=0).max(axis=0) + 2.0 * CAMERA,
        pair=float(both.mean()),
        turn=float(last.mean()),
    )
