"""Drawings of recovered and known support points: derived results, no recorded data."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
import numpy.typing as npt
from matplotlib.axes import Axes
from matplotlib.figure import Figure

F = npt.NDArray[np.float64]

_MM = 1e3


def draw_supports(
    path: Path, title: str, outline: F, known: F | None, motion: F, spread: F, forces: F
) -> None:
    """Draw three points of each kind in the part's outline, everything in m.

    Parameters
    ----------
    path, title
        Of the SVG file.
    outline, known
        (V, 2) corners, and (3, 2) points that the part stood on, if they are known.
    motion, spread
        (3, 2) points by motion alone, and (draws, 3, 2) refits to pushes drawn with replacement.
    forces
        (3, 2) points by the forces.
    """
    with mpl.rc_context({"svg.hashsalt": path.stem, "svg.fonttype": "none", "font.size": 9.0}):
        figure = Figure(figsize=(4.2, 4.2), layout="constrained")
        axes: Axes = figure.add_subplot()
        closed = np.vstack([outline, outline[:1]]) * _MM
        axes.plot(*closed.T, color="#52606d", linewidth=1.0)
        _scatter(axes, spread.reshape(-1, 2), "motion, pushes redrawn", color="#9fb3c8", s=6)
        _scatter(axes, motion, "by motion alone", color="#0b6bcb", s=46, marker="x")
        _scatter(axes, forces, "by forces", edgecolor="#b44d12", s=40, marker="^", facecolor="none")
        if known is not None:
            _scatter(axes, known, "known", edgecolor="black", s=60, facecolor="none")
        axes.plot(0.0, 0.0, "+", color="black", label="centre of mass")
        axes.set(title=title, xlabel="x, mm", ylabel="y, mm", aspect="equal")
        axes.legend(loc="upper right", fontsize=8)
        figure.savefig(path, metadata={"Date": None})


def _scatter(axes: Axes, points: F, label: str, **style: Any) -> None:
    axes.scatter(points[:, 0] * _MM, points[:, 1] * _MM, label=label, **style)
