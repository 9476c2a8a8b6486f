"""Pictures of a fitted model: profiles, support points, and recordings beside what the model says."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Polygon
from scipy.stats import chi2

from meso_robust import units
from meso_robust.identification.identify import Identification
from meso_robust.identification.models.three_point import POINTS
from meso_robust.identification.profiles import Profile
from meso_robust.reporting.canvas import (
    AFTER,
    AXIS_NAME,
    BEFORE,
    CERTIFIED,
    CERTIFIED_FILL,
    GHOST,
    MISS,
    MUTED,
    OPEN,
    TIP,
    corners,
    fit_equal,
    outline,
)
from meso_robust.types import Floats

_COLUMNS = 4  # of panels
_COLOURS = (CERTIFIED, TIP, OPEN, MISS, MUTED, AFTER)
DRAWN_MINIMA = len(_COLOURS)
"""Most minima in one picture."""


def profile_figure(found: Identification) -> Figure:
    """Rise of χ² along every fitted parameter, the others following."""
    rows = -(-len(found.profiles) // _COLUMNS)
    figure = Figure(figsize=(11.6, 0.3 + 2.3 * rows))
    limit = float(chi2.ppf(found.confidence, 1))
    for k, profile in enumerate(found.profiles):
        axes = figure.add_subplot(rows, _COLUMNS, k + 1)
        _profile(axes, found, profile, limit)
    figure.subplots_adjust(
        left=0.05, right=0.99, top=1.0 - 0.12 / rows, bottom=0.22 / rows, wspace=0.3, hspace=0.55
    )
    return figure


def _profile(axes: Axes, found: Identification, profile: Profile, limit: float) -> None:
    parameter = found.model.parameters[found.model.keys.index(profile.key)]
    unit = parameter.to_si
    axes.axvspan(profile.low / unit, profile.high / unit, color=CERTIFIED_FILL, lw=0)
    axes.axhline(limit, color=MUTED, lw=0.8, ls="--")
    at, rise = profile.curve.T
    axes.plot(at / unit, rise, "o", color=CERTIFIED, ms=3)
    fine = np.linspace(at[0], at[-1], 101)
    # signed roots are nearly straight, as the rise is nearly a parabola
    root = np.interp(fine, at, np.sign(at - profile.value) * np.sqrt(rise))
    axes.plot(fine / unit, root**2, "-", color=CERTIFIED, lw=1)
    axes.axvline(profile.value / unit, color=AFTER, lw=0.9)
    axes.set_ylim(-0.05 * limit, 1.6 * limit)
    axes.set_title(profile.key, fontsize=9, loc="left", pad=3)
    axes.ticklabel_format(axis="x", useOffset=False)
    axes.locator_params(axis="x", nbins=3)


def support_figure(found: Identification) -> Figure:
    """Support points of the local minima in the part, as in the paper's Fig. 6."""
    figure = Figure(figsize=(7.4, 4.4))
    axes = figure.add_axes((0.1, 0.11, 0.88, 0.86))
    body = found.prepared.outline
    outline(axes, np.zeros(3), body, "part", fill=False, edgecolor=BEFORE, lw=1.0)
    for k, minimum in list(enumerate(found.minima[:DRAWN_MINIMA]))[::-1]:
        points = minimum.values[POINTS].reshape(3, 2) / units.UM
        axes.add_patch(Polygon(points, closed=True, fill=False, edgecolor=_COLOURS[k], lw=1.2))
        label = f"{k + 1}: F = {1e6 * minimum.objective:.3g} µm"
        axes.plot(*points.T, "o", color=_COLOURS[k], ms=6, label=label)
    axes.plot(0.0, 0.0, "+", color=AFTER, ms=9)
    fit_equal(axes, corners(np.zeros(3), body), 0.05)
    handles, labels = axes.get_legend_handles_labels()
    axes.legend(handles[::-1], labels[::-1], loc="best", fontsize=8, framealpha=0.9)
    axes.set_xlabel(AXIS_NAME["x"] + ", frame of the part", labelpad=2)
    axes.set_ylabel(AXIS_NAME["y"], labelpad=2)
    return figure


def recording_figure(found: Identification, row: int) -> Figure:
    """One recording: seen and fitted way in the plane, and residuals over time."""
    figure = Figure(figsize=(11.6, 3.6))
    seen, said = found.prepared.seen[row], found.prediction.poses[0, row]
    here = np.all(np.isfinite(seen), axis=1)
    _plane(figure.add_axes((0.057, 0.13, 0.36, 0.84)), found, row)
    times = found.prepared.instants[row]
    for k, (name, unit) in enumerate((("x", units.UM), ("y", units.UM), ("theta", units.DEG))):
        axes = figure.add_axes((0.49, 0.13 + 0.29 * (2 - k), 0.50, 0.25))
        left = (seen[:, k] - said[:, k]) / unit
        axes.axhline(0.0, color=MUTED, lw=0.8)
        axes.plot(times[here], left[here], ".", color=CERTIFIED, ms=2.2)
        letter = {"x": "x", "y": "y", "theta": "θ"}[name]
        axes.set_ylabel(f"Δ{letter}, {'µm' if k < 2 else 'deg'}", labelpad=2)
        if k < 2:
            axes.set_xticklabels([])
    axes.set_xlabel("time in s", labelpad=2)
    return figure


def _plane(axes: Axes, found: Identification, row: int) -> None:
    prepared = found.prepared
    seen, said = prepared.seen[row], found.prediction.poses[0, row]
    here = np.flatnonzero(np.all(np.isfinite(seen), axis=1))
    first, last = here[0], here[-1]
    body = prepared.outline
    outline(axes, seen[first], body, "", fill=False, edgecolor=GHOST, lw=1.0)
    outline(axes, seen[last], body, "", fill=False, edgecolor=BEFORE, lw=1.4)
    outline(axes, said[last], body, "", fill=False, edgecolor=CERTIFIED, lw=1.0, ls="--")
    axes.plot(*(seen[here, :2].T / units.UM), ".", color=BEFORE, ms=2.2)
    axes.plot(*(said[first : last + 1, :2].T / units.UM), "-", color=CERTIFIED, lw=1.0)
    near = np.all(np.abs(prepared.waypoints[row] + prepared.parked) > 1e-9, axis=(0, 2))
    ways: list[Floats] = [prepared.waypoints[row][:, p] for p in np.flatnonzero(near)]
    for way in ways:
        axes.plot(*(way.T / units.UM), "-", color=TIP, lw=1.2)
    points = [corners(seen[k], body) for k in (first, last)]
    fit_equal(axes, np.concatenate([*points, *(way / units.UM for way in ways)]), 0.05)
    axes.set_xlabel(AXIS_NAME["x"], labelpad=2)
    axes.set_ylabel(AXIS_NAME["y"], labelpad=2)
