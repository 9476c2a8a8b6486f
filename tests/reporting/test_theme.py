"""Colours: every picture follows the theme, and no two hues look alike to colour-blind readers."""

from __future__ import annotations

import itertools
import re

import numpy as np
import numpy.typing as npt
import pytest
from markupsafe import Markup

from meso_robust.reporting import theme
from meso_robust.reporting.pages import environment

Floats = npt.NDArray[np.float64]

SHEET = environment().get_template("style.css").render()
LIGHT, DARK = SHEET.split("@media", 1)
HUES = ("blue", "green", "orange", "purple", "vermilion", "ink")
# Viénot, Brettel and Mollon (1999), linear RGB as seen by protanopes and deuteranopes
BLIND = {
    "all": np.eye(3),
    "protan": np.array(
        [[0.11238, 0.88762, 0.0], [0.11238, 0.88762, 0.0], [0.00401, -0.00401, 1.0]]
    ),
    "deutan": np.array(
        [[0.29275, 0.70725, 0.0], [0.29275, 0.70725, 0.0], [-0.02234, 0.02234, 1.0]]
    ),
}
LEAST = 10.0  # CIE 76 distance; 2.3 is just noticeable


def stated(sheet: str) -> dict[str, str]:
    """The first value of every colour in a sheet."""
    return dict(reversed(re.findall(r"--(\w+): (#[0-9a-f]{6})", sheet)))


def linear(colour: str) -> Floats:
    value = np.array([int(colour[k : k + 2], 16) for k in (1, 3, 5)]) / 255.0
    return np.where(value <= 0.04045, value / 12.92, ((value + 0.055) / 1.055) ** 2.4)


def lab(rgb: Floats) -> Floats:
    """CIE L*a*b* under D65 of linear sRGB."""
    to_xyz = np.array(
        [[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]]
    )
    share = to_xyz @ np.clip(rgb, 0.0, 1.0) / (to_xyz @ np.ones(3))
    root = np.where(share > 0.008856, np.cbrt(share), 7.787 * share + 16.0 / 116.0)
    return np.array(
        [116.0 * root[1] - 16.0, 500.0 * (root[0] - root[1]), 200.0 * (root[1] - root[2])]
    )


@pytest.mark.parametrize("sheet", [LIGHT, DARK], ids=["light", "dark"])
@pytest.mark.parametrize("eye", BLIND)
def test_hues_are_told_apart_by_every_eye(sheet: str, eye: str) -> None:
    colours = stated(sheet)
    for one, other in itertools.combinations(HUES, 2):
        seen = [lab(BLIND[eye] @ linear(colours[name])) for name in (one, other)]
        assert np.linalg.norm(seen[0] - seen[1]) > LEAST, (one, other)


def test_the_sheet_and_the_pictures_have_the_same_colours() -> None:
    light, dark = stated(LIGHT), stated(DARK)
    for colour, name in theme.NAMES.items():
        assert light[name] == colour
    same = set(theme.STAGES) - {"contact"}  # of middle tone, seen on both grounds
    assert set(theme.NAMES.values()) - set(dark) == same


def test_a_picture_takes_the_names_and_keeps_the_rest() -> None:
    drawn = Markup('<path style="fill: #0067a5; stroke: #123456"/>')
    assert theme.themed(drawn) == '<path style="fill: var(--blue); stroke: #123456"/>'


def test_only_the_screen_is_dark() -> None:
    assert "@media screen and (prefers-color-scheme: dark)" in SHEET
    assert "@media (prefers-color-scheme" not in SHEET
