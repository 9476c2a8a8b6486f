"""The two plans of the paper's Section VII that the certified one is compared with."""

from __future__ import annotations

from collections.abc import Mapping

from meso_robust.reproduction import rrt
from meso_robust.reproduction.bench import Place, Plan
from meso_robust.reproduction.item import Setting
from meso_robust.reproduction.seven_steps import tuned


def plans(setting: Setting) -> Mapping[str, Plan]:
    """The plans of Section VII as strokes of the tip, for the default place of the slot.

    Parameters
    ----------
    setting
        Seed and size.

    Raises
    ------
    ValueError
        If the random search finds no plan.
    """
    return {
        "RRT": rrt.plan(Place(), setting.seed).plan,
        "scripted": tuned(Place(), setting)[0],
    }
