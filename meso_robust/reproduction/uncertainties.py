"""What each uncertainty alone does to each planner: one at a time, at its size and at multiples."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from meso_robust.reproduction import printed
from meso_robust.reproduction.baselines import POSE, PROBE, Errors
from meso_robust.reproduction.bench import Plan
from meso_robust.reproduction.certified import (
    UNCERTAINTIES,
    certified_plan,
    certified_successes,
    how_runs_fail,
    scaled as scaled_setup,
    trials,
)
from meso_robust.reproduction.comparison import hits, several
from meso_robust.reproduction.item import Found, Item, Row, Setting, success

RUNS = {True: 40, False: 500}
SCALES = {True: (1.0, 4.0), False: (1.0, 2.0, 4.0, 8.0)}
"""Multiples of each uncertainty."""
WHY_LESS = (
    "Its moves are made for the stated sizes: probes start a few times their error from the part, and two "
    "of them hold it between them, apart by what the stated friction needs; larger errors put a probe down "
    "on the part, or close the grasp. The scripted plan has one tip, put down once and 0.3 mm off the part, "
    "no grasp that could close, and a slot and channel whose walls guide the part; the certified one "
    "touches no wall. What it has instead is a proof up to the stated sizes and the margin beyond."
)
"""Why a plan that is certified at the stated sizes can bear less beyond them."""
_MU = float(np.mean(printed.FRICTION))
_SURE = Errors(friction=(_MU, _MU), film_ratio=(printed.FILM_RATIO, printed.FILM_RATIO))


@dataclass(frozen=True, slots=True)
class One:
    """An uncertainty alone: of the open-loop plans at a scale, and its names for the certified one."""

    unit: str
    errors: Errors
    names: tuple[str, ...]


ONES: Mapping[str, One] = {
    "sensed position": One("5 µm", replace(_SURE, position=POSE.position), ("sensed_position",)),
    "sensed orientation": One(
        "0.3°", replace(_SURE, orientation=POSE.orientation), ("sensed_orientation",)
    ),
    "probe position": One("5 µm", replace(_SURE, tip=PROBE.tip), ("probe_position",)),
    "friction": One("0.03 about 0.33", replace(_SURE, friction=printed.FRICTION), ("friction",)),
    "film ratio": One(
        "5 %",
        replace(_SURE, film_ratio=(0.95 * printed.FILM_RATIO, 1.05 * printed.FILM_RATIO)),
        ("film_ratio",),
    ),
}
"""Each uncertainty at its stated size, all else at its middle, on the film."""


def scaled(errors: Errors, factor: float) -> Errors:
    """Every range about its middle, times a factor."""
    low, high = errors.film_ratio or (printed.FILM_RATIO, printed.FILM_RATIO)
    return replace(
        errors,
        position=(factor * errors.position[0], factor * errors.position[1]),
        orientation=factor * errors.orientation,
        tip=(factor * errors.tip[0], factor * errors.tip[1]),
        friction=_about(*errors.friction, factor),
        film_ratio=_about(low, high, factor),
    )


def _about(low: float, high: float, factor: float) -> tuple[float, float]:
    middle, half = 0.5 * (low + high), 0.5 * factor * (high - low)
    return middle - half, middle + half


def run(setting: Setting) -> Found:
    """Success of each plan under each uncertainty alone."""
    runs, scales = RUNS[setting.quick], SCALES[setting.quick]
    setting.told("planning", 0, 1)
    made = several(setting)
    shares: dict[str, dict[str, list[float]]] = {}
    for done, (what, one) in enumerate(ONES.items()):
        setting.told("one uncertainty at a time", done, len(ONES))
        shares[what] = {
            name: [_share(some, scaled(one.errors, k), runs, setting.seed) for k in scales]
            for name, some in made.items()
        }
        shares[what]["certified"] = [
            100.0 * float(np.mean(_certified(one, factor, runs, setting.seed))) for factor in scales
        ]
    from meso_robust.reproduction.plans_figures import one_at_a_time, side_by_side

    fails = {what: _failing(one, scales[-1], runs, setting.seed) for what, one in ONES.items()}
    return Found(
        answer=_answer(shares, scales),
        rows=tuple(
            _row(what, name, own, scales, runs, fails[what] if name == "certified" else "")
            for what, of in shares.items()
            for name, own in of.items()
        ),
        missing=(
            "which uncertainty made the paper's RRT plans fail: it names the support model "
            "and the peg's start",
        ),
        figures=(
            one_at_a_time(
                shares,
                scales,
                f"Share of {runs} runs that end in the goal, one uncertainty at a time, at "
                "multiples of its stated size; on the film.",
            ),
            side_by_side(shares, scales[-1], f"{_compared(shares, scales[-1])} {WHY_LESS}"),
        ),
        data={
            "success_percent": shares,
            "scales": list(scales),
            "runs": runs,
            "certified_fails_at_the_largest": fails,
        },
    )


def _share(some: Sequence[Plan], errors: Errors, runs: int, seed: int) -> float:
    """Success in % of runs that plans share evenly."""
    return 100.0 * hits(some, errors, runs, seed) / runs


def _certified(one: One, factor: float, runs: int, seed: int) -> np.ndarray:
    """Runs of the certified plan with one uncertainty only."""
    alone = dict.fromkeys(UNCERTAINTIES, 0.0) | dict.fromkeys(one.names, factor)
    return certified_successes(runs, seed, alone)


def _failing(one: One, factor: float, runs: int, seed: int) -> str:
    """In which move and how runs of the certified plan fail."""
    plan = certified_plan()
    alone = dict.fromkeys(UNCERTAINTIES, 0.0) | dict.fromkeys(one.names, factor)
    return how_runs_fail(
        trials(plan.rules, scaled_setup(plan.setup, alone), runs, seed), plan.setup
    )


def _compared(shares: Mapping[str, Mapping[str, list[float]]], scale: float) -> str:
    """Where the certified plan bears less than the scripted one."""
    less = [
        f"{what} ({of['certified'][-1]:.0f} against {of['scripted'][-1]:.0f} %)"
        for what, of in shares.items()
        if of["certified"][-1] < of["scripted"][-1]
    ]
    named = ", ".join(less) if less else "none of them"
    return f"At {scale:g} times the stated size the certified plan bears less than the scripted one: {named}."


def _row(
    what: str, name: str, own: list[float], scales: tuple[float, ...], runs: int, fails: str
) -> Row:
    at = ", ".join(f"{value:.1f} % at {scale:g}x" for value, scale in zip(own, scales, strict=True))
    return Row(
        quantity=f"{name} plan, {what} ± {ONES[what].unit} alone",
        unit="%",
        ours=success(round(0.01 * own[0] * runs), runs),
        why=f"exact 95 % interval of {runs} runs at the stated size; {at}"
        + (f". At {scales[-1]:g}x: {fails}" if fails else ""),
    )


def _answer(shares: Mapping[str, Mapping[str, list[float]]], scales: tuple[float, ...]) -> str:
    said = []
    for name in next(iter(shares.values())):
        last = {what: of[name][-1] for what, of in shares.items()}
        worst = min(last, key=lambda what: last[what])
        said.append(
            f"the {name} plan suffers most from the {worst} ({last[worst]:.0f} % succeed)"
            if last[worst] < 100.0
            else f"none makes a run of the {name} plan fail"
        )
    return f"At {scales[-1]:g} times its stated size, {'; '.join(said)}. {_compared(shares, scales[-1])}"


ITEM = Item(
    title="One uncertainty at a time",
    where="Sections V to IX: what each uncertainty does to each planner",
    run=run,
)
