"""Pictures of Tables III and IV: what gives the printed gain, and the turn over the push."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from matplotlib.figure import Figure as Drawing

from meso_robust.bounds import HALF_PI
from meso_robust.conditions import values
from meso_robust.reporting.canvas import CERTIFIED, GOAL, INK, MUTED
from meso_robust.reporting.pages import Figure
from meso_robust.reporting.theme import BLUE, ORANGE, PURPLE
from meso_robust.reproduction.drawing import drawn
from meso_robust.reproduction.primitive_runs import YTranslations, turned_deg
from meso_robust.types import Floats

LEVELS_UM = (2.0, 5.0, 11.0, 20.0)  # net rises with a line each
PRINTED_UM = 11.0  # the rise of Table III
COLOURS = (PURPLE, ORANGE, BLUE)


def figures(
    free: YTranslations, paths: Mapping[float, Floats], righted_deg: float
) -> tuple[Figure, ...]:
    """Both figures; `paths` and `righted_deg` as in `Rotations`."""
    return (
        drawn(
            lambda: _gain(free),
            "tables-gain",
            "Table III: tilt and arm of the Y-translation. Lines: equal net rise by "
            "l_AB (1 - cos phi), the printed 11 um bold. Dots: simulated Y-translations of which "
            "every contact sticks, over the inputs that the paper does not print.",
        ),
        drawn(
            lambda: _turn(paths, righted_deg),
            "tables-turn",
            "Table IV: turn of the part over the push, by separation of the tips. Dashed: the closed "
            "form while both tips touch. Lines: nominal simulation, ending in a jam (cross) or where "
            "a tip runs off its edge. Square: the printed simulation; bar: its trials. "
            "Above the green line a t² push rights what is left.",
        ),
    )


def arm_um(tilt_deg: Floats, gain_um: float) -> Floats:
    """l_AB with which a tilt gains so much, um: the closed form is linear in it."""
    right = HALF_PI.mid
    (share,) = values("y_translation", "gain")(
        theta_0=right,
        theta_1=right + np.radians(tilt_deg),
        theta_2=right,
        d1=0.0,
        d2=1.0,
        d2_back=0.0,
    )
    return np.asarray(gain_um / share)


def _gain(free: YTranslations) -> Drawing:
    canvas = Drawing(figsize=(6.4, 4.4), layout="constrained")
    axes = canvas.subplots()
    tilt = np.linspace(1.0, 22.0, 200)
    for level in LEVELS_UM:
        bold = level == PRINTED_UM
        axes.plot(tilt, arm_um(tilt, level), color=INK if bold else MUTED, lw=2.0 if bold else 0.8)
        at = float(np.degrees(np.arccos(1.0 - level / 640.0)))
        axes.annotate(f"{level:g} µm", (at + 0.2, 640.0), fontsize=8.5, color=INK, va="bottom")
    axes.plot(free.tilt_deg, free.arm_um, ls="none", marker="o", ms=2.6, color=CERTIFIED, alpha=0.6)
    axes.set_xlim(1.0, 22.0)
    axes.set_ylim(0.0, 900.0)
    axes.set_xlabel("tilt φ in deg")
    axes.set_ylabel("arm l_AB in µm")
    return canvas


def _turn(paths: Mapping[float, Floats], righted_deg: float) -> Drawing:
    canvas = Drawing(figsize=(7.2, 4.6), layout="constrained")
    axes = canvas.subplots()
    push = np.linspace(0.0, 2450.0, 400)
    for colour, (separation, path) in zip((*COLOURS, CERTIFIED), paths.items(), strict=False):
        axes.plot(push, turned_deg(push, separation), color=colour, lw=0.9, ls=(0, (4, 3)))
        stop = stops_at(path)
        label = f"{separation:g} µm"
        axes.plot(path[: stop + 1, 0], path[: stop + 1, 1], color=colour, lw=1.8, label=label)
        if path[stop, 1] < 80.0:
            axes.plot(*path[stop], marker="x", ms=9, mew=2.2, color=colour)
    axes.plot(1100.0, 90.0, marker="s", ms=6, color=INK)
    axes.plot([1100.0, 1100.0], [88.0, 90.0], color=INK, lw=3.0)
    axes.axhline(90.0 - righted_deg, color=GOAL, lw=1.2)
    axes.set_xlim(0.0, 2450.0)
    axes.set_ylim(0.0, 93.0)
    axes.set_xlabel("push in µm, from where the tips are one part's width apart")
    axes.set_ylabel("turn in deg")
    axes.legend(title="separation", loc="lower right", frameon=False)
    return canvas


def stops_at(path: Floats) -> int:
    """Row of a path (push, turn) after which the part does not turn any more."""
    turning = np.flatnonzero(np.abs(np.diff(path[:, 1])) > 1e-9)
    return int(turning[-1]) + 1 if turning.size else 0
