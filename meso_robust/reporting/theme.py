"""Colours of the pictures by the names that the style sheet has for them.

A picture is drawn in the colours of the light theme. In a page each becomes ``var(--name)``, so that
it follows the reader's theme; ``style.css`` gives both values of every name. The hues are those of
Okabe and Ito, darkened until text in them can be read.
"""

from __future__ import annotations

import re

from markupsafe import Markup

INK, MUTED, GRID, FRAME, PAPER = "#1f2933", "#55616e", "#e4e7eb", "#9aa5b1", "#ffffff"
WAY, GHOST, LAST, BAND, WALL = "#7c8896", "#cbd2d9", "#323f4b", "#eceff3", "#c9ced6"
BLUE, BLUE_FILL = "#0067a5", "#d9e7f6"
GREEN, GREEN_FILL = "#00795a", "#dff3ec"
ORANGE, ORANGE_FILL = "#b87a00", "#fbf1dc"
PURPLE, PURPLE_FILL = "#a3306f", "#f6dcea"
VERMILION, FORCE = "#b84a00", "#7a1fa2"
SHADES = ("#f1f4f7", "#d8e5f1", "#b3cfe7", "#7eafd6", "#4787bc", "#1e5e98", "#0a3460")
"""From little to much, for maps."""
STAGES = {
    "support": "#44aa99",
    "contact": "#882255",
    "actuation": "#ddcc77",
    "observation": "#88ccee",
    "environment": "#999933",
    "geometry": "#cc6677",
}
"""Stages of the simulator's chain, from Tol's muted palette."""
NAMES = {
    **{INK: "ink", MUTED: "muted", GRID: "grid", FRAME: "frame", PAPER: "paper"},
    **{WAY: "way", GHOST: "ghost", LAST: "last", BAND: "band", WALL: "wall"},
    **{BLUE: "blue", BLUE_FILL: "bluefill", GREEN: "green", GREEN_FILL: "greenfill"},
    **{ORANGE: "orange", ORANGE_FILL: "orangefill", PURPLE: "purple", PURPLE_FILL: "purplefill"},
    **{VERMILION: "vermilion", FORCE: "force"},
    **{shade: f"s{level}" for level, shade in enumerate(SHADES)},
    **{colour: stage for stage, colour in STAGES.items()},
}
_COLOURS = re.compile("|".join(NAMES))


def themed(svg: Markup) -> Markup:
    """The same picture, its colours by the names of the style sheet."""
    return Markup(_COLOURS.sub(lambda found: f"var(--{NAMES[found.group()]})", svg))
