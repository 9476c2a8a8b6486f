"""Pictures of a diagnosis: held-out errors, motion before and after, residuals, spans, nulls."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import PathPatch, Rectangle
from matplotlib.path import Path

from meso_robust import units
from meso_robust.diagnosis.document import (
    BudgetSection,
    DiagnosisDocument,
    HeldOutRecording,
    WhereSection,
)
from meso_robust.diagnosis.evidence import Evidence
from meso_robust.reporting.canvas import AXIS_NAME, GRID, INK, MUTED, corners, fit_equal, outline
from meso_robust.reporting.theme import BAND, BLUE, PAPER, SHADES, STAGES, VERMILION, WAY
from meso_robust.types import Floats

BASELINE, EXTENDED, TIP_WAY = VERMILION, BLUE, WAY
LEVELS = (1.25, 1.75, 2.5, 4.0, 7.0, 12.0)
"""Residuals, over the noise, at which the colour of a map changes."""
_SQUARE = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [0.0, 0.0]])
_SQUARE_CODES = (Path.MOVETO, Path.LINETO, Path.LINETO, Path.LINETO, Path.CLOSEPOLY)
_BINS = 60  # of time in a map; the page says so
_MOST_POINTS = 300  # of a line; the eye sees no more on its width
_HAIRS = 12  # arrows of a recording
_LONGEST_HAIR = 0.12  # of the extent of the picture
_FAR = 4.0  # times the largest null, beyond which a linear axis would flatten the nulls


_DRAWN = 0.01  # share of the error, that a part of the bar has a place of its own from
_LABELLED = 0.07  # likewise words of its own
_SHORT = {"x": "x", "y": "y", "theta": "θ"}
_PHASE = {
    "approach": "approach",
    "one_point": "one tip",
    "two_point": "two tips",
    "retract": "retract",
    "rest": "rest",
}


def residuals(evidence: Evidence, predicted: Floats) -> Floats:
    """(R, T, 3) recorded less predicted, over the noise.

    Parameters
    ----------
    evidence, predicted
        The recordings, and (R, T, 3) what a model makes of them, m and rad.
    """
    return _left(evidence, predicted) / evidence.sigma


def _left(evidence: Evidence, predicted: Floats) -> Floats:
    left = evidence.seen - predicted
    left[..., 2] = (left[..., 2] + np.pi) % (2.0 * np.pi) - np.pi
    return left


def size(left: Floats) -> Floats:
    """(R,) root mean square of residuals (R, T, 3); zero where nothing was seen."""
    seen = np.sum(np.isfinite(left), axis=(1, 2))
    return np.asarray(np.sqrt(np.nansum(left**2, axis=(1, 2)) / np.maximum(seen, 1)))


def held_out_figure(
    rows: Sequence[HeldOutRecording], noise: tuple[float, float | None], extended: bool
) -> Figure:
    """A bar before and a bar after for every held-out recording, and the noise.

    Parameters
    ----------
    rows, noise
        Recordings from top to bottom; what noise alone would leave, σ, and of it the repeatability.
    extended
        Whether there is an after.
    """
    tall = 0.9 + 0.36 * len(rows)
    figure = Figure(figsize=(11.6, tall))
    axes = figure.add_axes((0.2, 0.5 / tall, 0.77, 1.0 - 0.8 / tall))
    at = np.arange(len(rows))
    before = [one.baseline_sigma for one in rows]
    look: dict[str, Any] = {
        "hatch": "////",
        "edgecolor": PAPER,
        "lw": 0.0,
    }  # told apart without their colours
    axes.barh(at - 0.19 * extended, before, 0.36, color=BASELINE, label="plain model", **look)
    if extended:
        after = [one.extended_sigma for one in rows]
        axes.barh(at + 0.19, after, 0.36, color=EXTENDED, label="extended model")
    whole, repeatability = noise
    axes.axvline(
        whole, color=INK, lw=1.2, ls="--", label="noise: repeatability and systematic error"
    )
    if repeatability is not None:
        axes.axvline(repeatability, color=INK, lw=1.2, ls=":", label="repeatability")
    star = {"extrapolation": " *", "held_out": ""}
    axes.set_yticks(at, [one.recording + star[one.split] for one in rows])
    axes.set_ylim(len(rows) - 0.4, -0.6)
    axes.grid(axis="y", visible=False)
    axes.set_xlabel("root mean square error over the noise σ", labelpad=2)
    _legend(axes)
    return figure


def overlay_figure(evidence: Evidence, row: int) -> Figure:
    """One recording beside both models: way in the plane, residuals over time."""
    figure = Figure(figsize=(11.6, 3.6))
    _plane(figure.add_axes((0.057, 0.13, 0.36, 0.84)), evidence, row)
    models = _models(evidence)
    for k, name in enumerate(("x in µm", "y in µm", "θ in deg")):
        axes = figure.add_axes((0.5, 0.13 + 0.29 * (2 - k), 0.49, 0.25))
        unit = units.DEG if k == 2 else units.UM
        wide = 2.0 * evidence.sigma[k] / unit
        axes.axhspan(-wide, wide, color=BAND, lw=0)
        for colour, predicted, mark in models:
            left = _left(evidence, predicted)[row, :, k] / unit
            here = _thinned(np.flatnonzero(np.isfinite(left)))
            points = np.array([evidence.instants[row, here], left[here]]).T
            _draw(axes, points, mark, colour, 0.9)
        axes.autoscale_view()
        axes.set_ylabel("Δ" + name, labelpad=2)
        if k < 2:
            axes.set_xticklabels([])
    axes.set_xlabel("time in s", labelpad=2)
    return figure


def _models(evidence: Evidence) -> list[tuple[str, Floats, str]]:
    """Colour, prediction and mark of each model."""
    plain = [(BASELINE, evidence.baseline, ".")]
    return plain if evidence.extended is None else [*plain, (EXTENDED, evidence.extended, "-")]


def _draw(axes: Axes, points: Floats, mark: str, colour: str, wide: float) -> None:
    """A line, or dots as one shape: a mark of its own for each takes most of the page."""
    if mark != ".":
        axes.plot(*points.T, mark, color=colour, lw=wide)
        return
    _pieces(axes, np.repeat(points, 2, axis=0), colour, 2.4)


def _pieces(axes: Axes, ends: Floats, colour: str, wide: float) -> None:
    """Pieces of line between each two of (2N, 2) points; one of no length is a dot."""
    codes = np.tile(np.array([Path.MOVETO, Path.LINETO], dtype=np.uint8), len(ends) // 2)
    shape = Path(ends, codes)
    axes.add_patch(PathPatch(shape, fill=False, edgecolor=colour, lw=wide, capstyle="round"))


def _thinned(here: npt.NDArray[np.int64]) -> npt.NDArray[np.int64]:
    """At most `_MOST_POINTS` of some indices, evenly."""
    if len(here) <= _MOST_POINTS:
        return here
    return here[np.linspace(0, len(here) - 1, _MOST_POINTS).astype(int)]


def _plane(axes: Axes, evidence: Evidence, row: int) -> None:
    seen, body = evidence.seen[row], evidence.outline
    whole = np.flatnonzero(np.all(np.isfinite(seen), axis=1))
    points = _tip_ways(axes, evidence, row)
    if len(whole):
        first, last = whole[0], whole[-1]
        here = _thinned(whole)
        outline(axes, seen[first], body, "", fill=False, edgecolor=TIP_WAY, lw=0.8)
        outline(axes, seen[last], body, "", fill=False, edgecolor=INK, lw=1.4)
        _draw(axes, seen[here, :2] / units.UM, ".", INK, 0.0)
        for colour, predicted, mark in _models(evidence):
            style = "--" if mark == "." else "-"
            outline(axes, predicted[row, last], body, "", fill=False, edgecolor=colour, ls=style)
            axes.plot(*(predicted[row, here, :2].T / units.UM), style, color=colour, lw=1.2)
        points += [corners(seen[k], body) for k in (first, last)]
    if points:
        fit_equal(axes, np.concatenate(points), 0.05)
    axes.set_xlabel(AXIS_NAME["x"], labelpad=2)
    axes.set_ylabel(AXIS_NAME["y"], labelpad=2)


def _tip_ways(axes: Axes, evidence: Evidence, row: int) -> list[Floats]:
    """Draw the ways of the tips; the (N, 2) points of each, µm."""
    ways = []
    for way in np.moveaxis(evidence.tips[row], 1, 0):
        here = _thinned(np.flatnonzero(np.all(np.isfinite(way), axis=1)))
        if len(here):
            ways.append(way[here] / units.UM)
            axes.plot(*ways[-1].T, "-", color=TIP_WAY, lw=1.4)
            axes.plot(*ways[-1][-1], "o", color=TIP_WAY, ms=4)
    return ways


def vectors_figure(evidence: Evidence) -> tuple[Figure, float]:
    """Residuals of the place where they occurred, before and after, and by how much they are enlarged."""
    models = _models(evidence)
    known = np.all(np.isfinite(evidence.seen + sum(p for _, p, _ in models)), axis=2)
    starts = _means(evidence.seen, known)
    hairs = [_means(_left(evidence, p), known) for _, p, _ in models]
    extent = float(np.max(np.ptp(starts, axis=0), initial=1.0)) if len(starts) else 1.0
    longest = float(np.max([np.hypot(*hair.T).max(initial=0.0) for hair in hairs]))
    scale = _round(_LONGEST_HAIR * extent / longest) if longest else 1.0
    figure = Figure(figsize=(11.6, 4.6))
    for k, ((colour, _, _), hair) in enumerate(zip(models, hairs, strict=True)):
        axes = figure.add_axes((0.06 + 0.5 * k, 0.1, 0.43 if len(models) > 1 else 0.93, 0.82))
        tips = starts + scale * hair
        _pieces(axes, np.stack([starts, tips], axis=1).reshape(-1, 2), colour, 1.0)
        _draw(axes, starts, ".", INK, 0.0)
        if len(starts):
            fit_equal(axes, np.concatenate([starts, starts + scale * hairs[0]]), 0.04)
        name = ("plain model", "extended model")[k]
        axes.set_title(name, fontsize=9, loc="left", pad=4, color=INK)
        axes.set_xlabel(AXIS_NAME["x"] + " on the stage", labelpad=2)
        axes.set_ylabel(AXIS_NAME["y"], labelpad=2)
    return figure, scale


def _round(value: float) -> float:
    """The next of 1, 2, 5, 10 … below."""
    power = 10.0 ** np.floor(np.log10(value))
    return float(power * max(step for step in (1.0, 2.0, 5.0) if step * power <= value * 1.0001))


def _means(values: Floats, known: npt.NDArray[np.bool_]) -> Floats:
    """(N, 2) means, µm, of places (R, T, 3) over pieces of what is known (R, T) of each recording."""
    pieces = [
        row[part, :2].mean(axis=0)
        for row, here in zip(values, known, strict=True)
        for part in np.array_split(np.flatnonzero(here), _HAIRS)
        if len(part)
    ]
    return np.array(pieces).reshape(-1, 2) / units.UM


def map_figure(evidence: Evidence, rows: Sequence[int]) -> Figure:
    """Residuals by recording and time, before and after, in steps of `SHADES`.

    Parameters
    ----------
    evidence, rows
        What was recorded, and the recordings from top to bottom.
    """
    tall = 0.85 + 0.2 * len(rows)
    figure = Figure(figsize=(11.6, tall))
    models = _models(evidence)
    start, end = _span(evidence, rows)
    for k, (_, predicted, _) in enumerate(models):
        wide = 0.42 if len(models) > 1 else 0.86
        axes = figure.add_axes((0.13 + 0.44 * k, 0.48 / tall, wide, 1.0 - 0.8 / tall))
        grid = _binned(evidence, predicted, rows)
        for level, shade in enumerate(SHADES):
            chosen = np.isfinite(grid) & (np.digitize(grid, LEVELS) == level)
            axes.add_patch(_cells(chosen, start, (end - start) / _BINS, shade))
        axes.set_xlim(start, end)
        axes.set_ylim(len(rows), 0)
        axes.grid(visible=False)
        axes.set_title(("plain model", "extended model")[k], fontsize=9, loc="left", pad=4)
        axes.set_xlabel("time in s", labelpad=2)
        names = [evidence.files[row] for row in rows] if k == 0 else [""] * len(rows)
        axes.set_yticks(np.arange(len(rows)) + 0.5, names, fontsize=8)
        axes.tick_params(axis="y", length=0)
    return figure


def _span(evidence: Evidence, rows: Sequence[int]) -> tuple[float, float]:
    """First and last instant of some recordings, s."""
    times = evidence.instants[list(rows)]
    start = float(np.nanmin(times))
    return start, max(float(np.nanmax(times)), start + 1e-3)


def _binned(evidence: Evidence, predicted: Floats, rows: Sequence[int]) -> Floats:
    """(len(rows), bins) root mean square over the noise; NaN where nothing was seen."""
    left = residuals(evidence, predicted)
    made = np.full((len(rows), _BINS), np.nan)
    start, end = _span(evidence, rows)
    share = np.nan_to_num((evidence.instants - start) / (end - start))
    for k, row in enumerate(rows):
        seen = np.isfinite(left[row])
        which = np.minimum((_BINS * share[row]).astype(int), _BINS - 1)
        count = np.bincount(which, seen.sum(axis=1), _BINS)
        square = np.bincount(which, np.nansum(left[row] ** 2, axis=1), _BINS)
        np.divide(square, count, out=made[k], where=count > 0)
    return np.asarray(np.sqrt(made))


def _cells(chosen: npt.NDArray[np.bool_], start: float, wide: float, shade: str) -> PathPatch:
    """All cells of one shade as one shape, neighbours as one box: few bytes."""
    edges = np.diff(np.pad(chosen, ((0, 0), (1, 1))).astype(int), axis=1)
    runs = zip(np.argwhere(edges > 0), np.argwhere(edges < 0), strict=True)
    boxes = [
        _SQUARE * [wide * (last - first), 0.92] + [start + wide * first, row + 0.04]
        for (row, first), (_, last) in runs
    ]
    vertices = np.concatenate([np.zeros((0, 2)), *boxes])
    codes = np.tile(np.array(_SQUARE_CODES, dtype=np.uint8), len(boxes))
    return PathPatch(Path(vertices, codes), facecolor=shade, edgecolor=shade, lw=0.2)


def strip_figure(where: Sequence[WhereSection], evidence: Evidence, rows: Sequence[int]) -> Figure:
    """Spans in which the plain model fails, on the time line of their recordings.

    Parameters
    ----------
    where, evidence, rows
        The spans, the recordings, and which of them are drawn, from top to bottom.
    """
    tall = 0.6 + 0.3 * len(rows)
    figure = Figure(figsize=(11.6, tall))
    axes = figure.add_axes((0.13, 0.46 / tall, 0.85, 1.0 - 0.54 / tall))
    place = {evidence.files[row]: k for k, row in enumerate(rows)}
    for k, row in enumerate(rows):
        start, end = _span(evidence, [row])
        axes.add_patch(Rectangle((start, k + 0.1), end - start, 0.8, color=BAND, lw=0))
    for span in where:
        if span.recording in place:
            lane = place[span.recording] + 0.12 + 0.26 * ("x", "y", "theta").index(span.component)
            wide = max(span.end_s - span.start_s, 0.0)
            colour = STAGES[span.channel]
            axes.add_patch(Rectangle((span.start_s, lane), wide, 0.24, facecolor=colour, lw=0))
    axes.set_xlim(*_span(evidence, rows))
    axes.set_ylim(len(rows), 0)
    axes.grid(axis="y", visible=False)
    axes.set_yticks(np.arange(len(rows)) + 0.5, [evidence.files[row] for row in rows], fontsize=8)
    axes.tick_params(axis="y", length=0)
    axes.set_xlabel("time in s", labelpad=2)
    return figure


def budget_figure(budget: Sequence[BudgetSection]) -> Figure:
    """The explainable error as one stacked bar: by effect and its stage, phase and component.

    Parameters
    ----------
    budget
        Its parts, which add up to one. Parts too small for a place of their own, and those below zero,
        are summed up by effect.
    """
    figure = Figure(figsize=(11.6, 1.5))
    axes = figure.add_axes((0.02, 0.36, 0.96, 0.4))
    end = 0.0
    for effect in dict.fromkeys(part.effect for part in budget):
        parts = [part for part in budget if part.effect == effect]
        large = sorted((p for p in parts if p.share >= _DRAWN), key=lambda part: -part.share)
        rest = sum(part.share for part in parts) - sum(part.share for part in large)
        colour = STAGES.get(parts[0].stage or "", MUTED)
        whole = [(part.share, f"{_SHORT[part.component]} {_PHASE[part.phase]}") for part in large]
        if rest > 0.0:
            whole.append((rest, ""))
        begin = end
        for share, words in whole:
            axes.barh(
                0.0,
                share,
                0.8,
                end,
                color=colour,
                edgecolor=PAPER,
                lw=0.8,
                hatch=None if effect else "////",
            )
            if share > _LABELLED:
                axes.text(end + 0.5 * share, 0.0, words, ha="center", va="center", fontsize=7.5)
            end += share
        if end - begin > _DRAWN:
            axes.text(begin, 0.5, effect or "unexplained", fontsize=8, va="bottom")
    axes.set_xlim(0.0, max(end, 1.0))
    axes.set_ylim(-0.5, 0.9)
    axes.set_yticks([])
    axes.grid(axis="y", visible=False)
    axes.set_xlabel("share of the explainable error", labelpad=2)
    return figure


def null_figure(evidence: Evidence, document: DiagnosisDocument) -> Figure:
    """Largest local test of sets without a mismatch, and of these recordings."""
    figure = Figure(figsize=(11.6, 2.7))
    axes = figure.add_axes((0.057, 0.17, 0.93, 0.73))
    nulls = evidence.null_statistics
    values = np.append(nulls, evidence.statistic)
    far = values.min() > 0.0 and evidence.statistic > _FAR * nulls.max()
    bins = min(max(len(nulls) // 6, 4), 30)
    axes.hist(nulls, bins, color=TIP_WAY, edgecolor=GRID, lw=0.5, label="without a mismatch")
    limit = float(np.quantile(nulls, 1.0 - document.mismatch.threshold))
    axes.axvline(limit, color=MUTED, lw=1.0, ls=":", label="threshold")
    axes.axvline(evidence.statistic, color=BASELINE, lw=2.0, label="these recordings")
    if far:
        axes.set_xscale("log")
        ticks = [k * 10.0**power for power in range(-3, 9) for k in (1, 2, 5)]
        low, high = axes.get_xlim()
        inside = [tick for tick in ticks if low <= tick <= high]
        axes.set_xticks(inside, [f"{tick:g}" for tick in inside])
        axes.set_xticks([], minor=True)
    axes.set_xlabel("largest of all local tests, σ" + (" (logarithmic)" if far else ""), labelpad=2)
    axes.set_ylabel("simulated sets", labelpad=2)
    _legend(axes)
    return figure


def _legend(axes: Axes) -> None:
    """A line of names above the axes, where it hides nothing."""
    axes.legend(
        loc="lower right",
        bbox_to_anchor=(1.0, 1.0),
        ncols=len(axes.get_legend_handles_labels()[1]),  # there is room for one line alone
        fontsize=8,
        frameon=False,
        borderpad=0.2,
    )
