"""Fig. 14: robust and other motions, and how far trials of the same push differ."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from meso_robust import units
from meso_robust.conditions import values
from meso_robust.primitives.obligation import Step
from meso_robust.reproduction.item import Found, Item, Row, Setting, span
from meso_robust.reproduction.printed import PART
from meso_robust.reproduction.robust_trials import (
    SERIES,
    Spread,
    Trial,
    certified,
    holds,
    made,
    refuted,
    spread_of,
    why_not,
)
from meso_robust.types import Floats

NOMINAL = (
    Trial(action="straighten", spacing_um=580.0, middle_um=0.0, start_deg=87.0, travel_um=800.0),
    Trial(action="straighten", spacing_um=580.0, middle_um=-350.0, start_deg=93.0, travel_um=800.0),
    Trial(action="tilt", spacing_um=640.0, middle_um=620.0, start_deg=90.0, travel_um=800.0),
)
"""Tests 1 to 3 as drawn. Test 1 pushes on both sides of the centre; both tips of test 2 are below it,
and the lower one touches first; test 3 pushes 300 um above it."""
TRAVELS = (800.0, 1800.0)
"""um: about the 700 um of contact of Section VI, and the 1.8 mm of Table III."""
PRINTED = ((20.0, 15.0, 0.023), (15.0, 25.0, 0.1), None)
"""um, um, rad; largest differences between trials of tests 1 and 2."""
AXES = (("X", "um"), ("Y", "um"), ("θ", "rad"))
_SHOWN = np.array([units.UM, units.UM, 1.0])
_REASON = (
    "both tips push either side of the centre and stick",
    "eq. (9) gives the lower tip a pull: it leaves, and the upper one turns the part on",
    "one tip sticks and turns the part",
)


@dataclass(frozen=True, slots=True, kw_only=True)
class Tried:
    """A set-up, its conditions, and its spread."""

    trial: Trial
    step: Step
    spread: Spread


def variants(test: int, quick: bool) -> list[Trial]:
    """Set-ups of a test (0, 1, 2) over the inputs that are not printed, the drawn one first."""
    base = NOMINAL[test]
    spacings = (480.0, 640.0) if test == 0 else (base.spacing_um,)
    middles = ((0.0,), (-310.0, -400.0), (570.0, 670.0))[test]
    starts = ((85.0, 89.0), (91.0, 95.0), (90.0,))[test]
    grid = itertools.product(spacings, middles, starts, TRAVELS)
    others = [
        replace(base, spacing_um=spacing, middle_um=middle, start_deg=start, travel_um=travel)
        for spacing, middle, start, travel in grid
    ]
    return [base, *(others[::3] if quick else others)]


def pair_forces(trial: Trial) -> Floats:
    """(2,) normal forces of the upper and the lower tip by eq. (9), times d4/(e_x v cos β), um.

    β = 0; d2 of the formula is where the upper tip touches.
    """
    forces = values("two_point_sticking", "normal_forces")(
        beta=0.0,
        d1=0.5 * PART.width / units.UM,
        d2=trial.middle_um + 0.5 * trial.spacing_um,
        d4=trial.spacing_um,
    )
    return np.array([float(force) for force in forces])


def run(setting: Setting) -> Found:
    """Run trials of the three tests over the inputs that the paper leaves out."""
    from meso_robust.reproduction.robust_figures import tests_figure

    runs = 60 if setting.quick else 300
    cases = [(test, trial) for test in range(3) for trial in variants(test, setting.quick)]
    tried: list[list[Tried]] = [[], [], []]
    for k, (test, trial) in enumerate(cases):
        setting.told("trials of robust and other motions", k, len(cases))
        move = made(trial, runs, setting.seed)
        found = Tried(trial=trial, step=certified(trial), spread=spread_of(move, setting.seed))
        tried[test].append(found)
    moves = [made(trial, max(SERIES), setting.seed) for trial in NOMINAL]
    return Found(
        answer=_answer(tried),
        rows=tuple(itertools.chain(*(_rows(test, tried[test]) for test in range(3)))),
        missing=(
            "Tip spacing, place of the probe and start angle: 580 um, the pair's middle on the centre "
            "(test 1) or 350 um below it (test 2), one tip 300 um above it (test 3); 87°, 93°, 90°; the "
            "rows show ranges over 480 to 640 um, start angles 1° to 5° off the "
            "upright, upper tips of test 2 20 to 110 um below the centre, and the tip of test 3 250 to "
            "350 um above it.",
            "Which condition test 2 broke: both tips below the centre, the reading in which θ falls "
            "after the pair has touched.",
            "Length of the push: 700 um and 1.7 mm of contact.",
            f"Number of trials: {SERIES[0]} and {SERIES[-1]}; of many such series 5 to 95 %, in the answer the median.",
            "Scatter of the part's start between trials: no more than the sensing errors (5 um, 0.3°).",
            "Misalignment β of the tips, which the paper takes as known: 0. It turns the end of test 1 "
            "but not its spread.",
        ),
        figures=(tests_figure(NOMINAL, moves, setting.seed),),
        data={"tests": [[_data(each) for each in some] for some in tried], "runs": runs},
    )


def _answer(tried: Sequence[Sequence[Tried]]) -> str:
    robust = [each for each in tried[0] if holds(each.step)]
    grown = max((abs(each.spread.turn) for each in robust), default=float("nan"))
    first = _middle(robust)
    short, long = (_middle([e for e in tried[1] if e.trial.travel_um == t]) for t in TRAVELS)
    less = "Stands for θ" if first[1] < min(short[0], long[0]) else "Stands in part for θ"
    return (
        f"{less}: where the conditions hold (test 1) trials differ by {_rad(first)} and θ stays (to "
        f"{grown:.1g} rad) once both tips touch; where Lemma 2's condition is broken (test 2) by "
        f"{_rad(short)} over 0.7 mm of push and by {_rad(long)} over 1.7 mm. In X the paper's own "
        "numbers (20 against 15 um) do not favour the robust motion."
    )


def _middle(some: Sequence[Tried]) -> tuple[float, float]:
    """Range over set-ups of the median largest difference in θ as seen, rad."""
    return span(np.array([each.spread.seen[n][1, 2] for each in some for n in SERIES]))


def _rad(ends: tuple[float, float]) -> str:
    return f"{ends[0]:.3f} to {ends[1]:.3f} rad"


def _used(some: Sequence[Tried]) -> list[Tried]:
    """Set-ups that are what the paper says of the test: of tests 1 and 3, those that are certified."""
    kept = [each for each in some if holds(each.step)]
    return kept or list(some)


def _seen(some: Sequence[Tried]) -> Floats:
    """(S, 3, 3) quantiles of the largest differences as seen, over set-ups and numbers of trials."""
    spreads = [each.spread.seen[n] for each in _used(some) for n in SERIES]
    return np.array(spreads) / _SHOWN


def _rows(test: int, some: Sequence[Tried]) -> list[Row]:
    used, name, printed = _used(some), f"Test {test + 1}", PRINTED[test]
    seen, allowed = _seen(some), np.array([each.spread.largest for each in used]) / _SHOWN
    true = np.array([each.spread.true[n] for each in used for n in SERIES]) / _SHOWN
    rows = [
        Row(
            quantity=f"{name}: largest difference between trials in {axis}",
            unit=unit,
            printed=None if printed is None else printed[k],
            ours=span(seen[..., k]),
            why="5 to 95 % of series of 3 and 5 trials as the camera sees them; without its error "
            f"{_words(true[..., k])}, the "
            f"most that the stated errors allow {_words(allowed[:, k])}; a printed value beyond ours was a "
            "rarer series if the errors allow it, and needs larger errors if not",
        )
        for k, (axis, unit) in enumerate(AXES)
    ]
    return [*rows, *_conditions(test, some), *_after(test, used)]


def _conditions(test: int, some: Sequence[Tried]) -> list[Row]:
    proved = [each for each in some if holds(each.step)]
    broken = sorted({why_not(each.step) for each in some} - {""})
    rows = [
        Row(
            quantity=f"Test {test + 1}: set-ups whose conditions hold under all errors",
            printed=("satisfied", "not satisfied", "robust")[test],
            ours=f"{len(proved)} of {len(some)}",
            why=f"where not: {', or '.join(broken)}" if broken else "",
        )
    ]
    if test < 2:
        upper, lower = pair_forces(NOMINAL[test])
        rows.append(
            Row(
                quantity=f"Test {test + 1}: eq. (9), forces of upper and lower tip as drawn",
                unit="um, over e_x v/d4",
                printed="both positive" if test == 0 else "not both positive",
                ours=f"{upper:.0f}, {lower:.0f}",
                why=_REASON[test],
            )
        )
    return rows


def _after(test: int, used: Sequence[Tried]) -> list[Row]:
    turns = np.array([each.spread.turn for each in used])
    printed = ("almost constant", "decreasing", None)[test]
    rows = [
        Row(
            quantity=f"Test {test + 1}: turn in the last third of the push",
            unit="rad",
            printed=printed,
            ours=span(turns),
            why=_REASON[test],
        )
    ]
    if test < 2:
        pairs = 100.0 * np.array([each.spread.pair for each in used])
        rows.append(
            Row(
                quantity=f"Test {test + 1}: runs that end with both tips in contact",
                unit="%",
                printed=("maintained", "broken")[test],
                ours=span(pairs),
            )
        )
    return rows


def _words(numbers: Floats) -> str:
    return f"{numbers.min():.2g} to {numbers.max():.2g}"


def _data(each: Tried) -> dict[str, object]:
    trial, spread = each.trial, each.spread
    return {
        "spacing_um": trial.spacing_um,
        "middle_um": trial.middle_um,
        "start_deg": trial.start_deg,
        "travel_um": trial.travel_um,
        "certified": holds(each.step),
        "refuted": refuted(each.step),
        "seen_um_um_rad": {str(n): (spread.seen[n] / _SHOWN).tolist() for n in SERIES},
        "true_um_um_rad": {str(n): (spread.true[n] / _SHOWN).tolist() for n in SERIES},
        "allowed_um_um_rad": (spread.largest / _SHOWN).tolist(),
        "both_tips_at_end": spread.pair,
        "turn_of_last_third_rad": spread.turn,
    }


ITEM = Item(
    title="Robust and other motions",
    where="Fig. 14 and Section X-B",
    run=run,
)
