"""Equations of plain text as HTML."""

from __future__ import annotations

import html
import re

import pytest

from meso_robust.reporting.equations import typeset
from meso_robust.simulator.catalogue import CATALOGUE


@pytest.mark.parametrize(
    ("plain", "expected"),
    [
        ("F = e_x b", "<i>F</i> = <i>e</i><sub><i>x</i></sub> <i>b</i>"),
        ("θ_seen", "<i>θ</i><sub>seen</sub>"),
        ("|u|^(n−1) u", "|<i>u</i>|<sup><i>n</i>−1</sup> <i>u</i>"),
        ("exp(-2 k1)", "exp(−2 <i>k</i><sub>1</sub>)"),
        ("v₀ Tᵀ x²", "<i>v</i>₀ <i>T</i>ᵀ <i>x</i>²"),
        ("a' = 1 − a v, a₀ = 1 s", "<i>a</i>′ = 1 − <i>a</i> <i>v</i>, <i>a</i>₀ = 1 s"),
        ("a round post of the stage's", "a round post of the stage&#39;s"),
        ("drag at 75 µm/s", "drag at 75 µm/s"),
        ("x < <b> & y", "<i>x</i> &lt; &lt;<i>b</i>&gt; &amp; <i>y</i>"),
    ],
)
def test_symbols_are_italic_and_words_upright(plain: str, expected: str) -> None:
    assert str(typeset(plain)) == expected


def test_no_sign_of_the_catalogue_is_lost() -> None:
    for effect in CATALOGUE.values():
        shown = html.unescape(re.sub(r"<[^>]*>", "", typeset(effect.equation)))
        plain = re.sub(r"\^\(([^()]*)\)|_|\^", r"\1", effect.equation)
        assert shown.replace("′", "'") == plain.replace(" - ", " − ")
