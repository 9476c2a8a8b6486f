"""Maps of where a primitive may push, drawn, and all of them written for a task."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure
from matplotlib.patches import Patch, Rectangle

from meso_robust import units
from meso_robust.bounds import HALF_PI, Interval
from meso_robust.certificates.chain import Chain, certify
from meso_robust.errors import NotApplicableError
from meso_robust.feasible_regions.document import document
from meso_robust.feasible_regions.maps import PRIMITIVES, Map, Primitive, map_of, moves_of
from meso_robust.feasible_regions.paving import Axis, Paving, Region
from meso_robust.planning.compose import compose
from meso_robust.primitives.setup import setup_of
from meso_robust.reporting.canvas import INK
from meso_robust.reporting.svg import style, to_svg
from meso_robust.reporting.theme import FRAME
from meso_robust.stages import Doing
from meso_robust.task import Task
from meso_robust.types import Floats

# Okabe and Ito's blue and vermilion: told apart by all kinds of colour vision, and in grey by tone.
LOOK = {
    Region.CERTIFIED: ("#0072b2", "works for all uncertainties (proved)"),
    Region.UNDECIDED: ("#e9ecef", "not decided"),
    Region.IMPOSSIBLE: ("#e69f6b", "some uncertainty breaks it (proved)"),
}
PLAN = "#ffffff"
TITLES: dict[Primitive, str] = {
    "tilt": "Tilt: where may one tip push, from which start?",
    "straighten": "t² push: where may the pair push, from which start?",
    "y_translation": "Y-translation: where may the two pushes go?",
    "rotation": "Two-sided rotation: how far apart, and how far?",
}
SIZE = (6.4, 5.2)  # inches


def map_files(task: Task, say: Doing, *, count: int = 128) -> dict[str, str]:
    """Text of ``admissible.json`` and of a drawing for every map that the plan for ``task`` has.

    The maps are of the primitives alone: a slot's walls are not looked at.

    Parameters
    ----------
    task
        The task.
    say
        Shows what is being done while a stage runs.
    count
        The finest cells are 1/count of either side.

    Returns
    -------
    dict[str, str]
        Texts by name of file.

    Raises
    ------
    NotApplicableError
        There is no plan for the task, or none of its moves has a map.
    """
    with say("searching for a plan"):
        chain = _chain(task)
    maps = []
    for primitive in PRIMITIVES:
        try:
            moves, number = moves_of(chain.steps, chain.setup, primitive)
        except NotApplicableError:
            continue
        with say(f"mapping where the {primitive.replace('_', ' ')} works"):
            maps.append(map_of(primitive, moves, number, count))
    if not maps:
        raise NotApplicableError(f"no move of the plan for {task.name} has a map")
    drawn = {f"{found.primitive}.svg": _svg(found) for found in maps}
    return {"admissible.json": document(task, maps), **drawn}


def _chain(task: Task) -> Chain:
    task.rectangle("maps of where a primitive may push (--maps)")
    return certify(compose(task).rules, setup_of(task))


def _svg(found: Map) -> str:
    with style():
        figure = map_figure(found)
        label = f"{TITLES[found.primitive]} (move {found.step} of the plan)"
        return str(to_svg(figure, found.primitive, label)) + "\n"


def map_figure(found: Map) -> Figure:
    """One map, um and deg, with the plan's own choice."""
    figure = Figure(figsize=SIZE)
    axes = figure.add_axes((0.115, 0.225, 0.86, 0.705))
    axes.set_title(TITLES[found.primitive], loc="left", fontsize=11, color=INK)
    paving = found.paving
    for region, (colour, _) in LOOK.items():
        axes.add_collection(_cells(paving, region, colour))
    _plan(axes, found)
    axes.set_xlim(*shown(paving.across, np.array([paving.across.low, paving.across.high])))
    axes.set_ylim(*shown(paving.up, np.array([paving.up.low, paving.up.high])))
    axes.set_xlabel(f"{paving.across.name}, {_unit(paving.across)}", labelpad=3)
    axes.set_ylabel(f"{paving.up.name}, {_unit(paving.up)}", labelpad=3)
    axes.grid(visible=False)
    handles = [Patch(fc=colour, ec=FRAME, lw=0.5, label=text) for colour, text in LOOK.values()]
    handles.append(
        Patch(fc=PLAN, ec=INK, lw=1.2, label=f"the plan's own choice, move {found.step}")
    )
    figure.legend(
        handles=handles, loc="lower left", ncols=2, frameon=False, bbox_to_anchor=(0.1, 0)
    )
    return figure


def _unit(axis: Axis) -> str:
    return "µm" if axis.unit == "um" else "deg (90: upright)"


def shown(axis: Axis, values: Floats) -> Floats:
    """Metres to um, radians to deg."""
    return np.asarray(values) / (units.UM if axis.unit == "um" else HALF_PI.lo / 90.0)


def _cells(paving: Paving, region: Region, colour: str) -> PolyCollection:
    """All cells of a region, joined upwards."""
    x = shown(paving.across, paving.across.edges(paving.count))
    y = shown(paving.up, paving.up.edges(paving.count))
    bars = []
    for i, column in enumerate(paving.raster() == region):
        ends = np.flatnonzero(np.diff(column.astype(np.int8), prepend=0, append=0))
        for low, high in ends.reshape(-1, 2):
            a, b = x[i], x[i + 1]
            bars.append([(a, y[low]), (b, y[low]), (b, y[high]), (a, y[high])])
    return PolyCollection(bars, facecolors=colour, edgecolors=colour, linewidths=0.7)


def _plan(axes: Axes, found: Map) -> None:
    """What the plan does: a bar over the range, with a dot in its middle so that it is seen."""
    x, y = _range(found.paving.across, found.plan[0]), _range(found.paving.up, found.plan[1])
    axes.add_patch(
        Rectangle((x[0], y[0]), x[1] - x[0], y[1] - y[0], fc=PLAN, ec=INK, lw=1.2, zorder=5)
    )
    axes.plot(
        0.5 * sum(x),
        0.5 * sum(y),
        marker="o",
        ms=6,
        mfc=PLAN,
        mec=INK,
        mew=1.4,
        ls="none",
        zorder=6,
    )


def _range(axis: Axis, side: Interval) -> tuple[float, float]:
    low, high = shown(axis, np.array([side.lo, side.hi]))
    return float(low), float(high)
