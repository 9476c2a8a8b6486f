"""Numbers in words."""

from __future__ import annotations

import pytest

from meso_robust.planning.document import AimDocument
from meso_robust.planning.plan_file import ExactBox
from meso_robust.reporting import words


@pytest.mark.parametrize(
    ("low", "high", "said"),
    [
        (1909.788, 1957.297, "1909.7 … 1957.3"),
        (-57.047, -29.004, "−57.1 … −29.0"),
        (2055.4 + 1e-12, 2065.4 - 1e-12, "2055.4 … 2065.4"),
        (-0.01, 0.01, "−0.1 … 0.1"),
    ],
)
def test_ranges_are_rounded_outward(low: float, high: float, said: str) -> None:
    assert words.outward(low, high, 1) == said


def test_a_box_is_shown_in_um_and_deg() -> None:
    half, right = (0.5e-3).hex(), (1.5707963267948966).hex()
    box = ExactBox(x_m=(half, half), y_m=((-1e-6).hex(), (2e-6).hex()), theta_rad=(right, right))
    assert words.box_words(box) == ("500.0 … 500.0", "−1.0 … 2.0", "90.00 … 90.00")


@pytest.mark.parametrize(
    ("value", "said"), [(1.203125, "1.20"), (1.4375, "1.43"), (1.299999, "1.29"), (8.0, "≥ 8")]
)
def test_a_margin_is_never_rounded_up(value: float, said: str) -> None:
    assert words.factor(value) == said


@pytest.mark.parametrize(
    ("value", "said"),
    [(0.0, "0"), (2.1e-05, "0.000021"), (0.0625, "0.063"), (28.42, "29"), (0.04, "0.040")],
)
def test_small_numbers_have_two_digits_and_no_exponent(value: float, said: str) -> None:
    assert words.small(value) == said


def test_commands_say_what_they_are_measured_from() -> None:
    part = AimDocument(relative_to="sensed part", offset_um=455.2)
    behind = AimDocument(relative_to="sensed part", offset_um=-438.0)
    world = AimDocument(relative_to="world", offset_um=-270.8)
    assert words.command("x", part) == "sensed x + 455.2 µm"
    assert words.command("x", behind) == "sensed x − 438.0 µm"
    assert words.command("y", world) == "−270.8 µm"
    assert words.command("y", None) == "—"


def test_sides_are_decoded_into_their_units() -> None:
    hexed = {
        "theta": ((0.0).hex(), (1.5707963267948966).hex()),
        "d1": ((418.5e-6).hex(), (418.5e-6).hex()),
        "rho": ((3.769e-7).hex(), (3.769e-7).hex()),
        "mu": ((0.3).hex(), (0.36).hex()),
        "h": (float("-inf").hex(), (1e-3).hex()),
        "other": ((2.5).hex(), (2.5).hex()),
    }
    shown = {side.name: side.value for side in words.sides(hexed)}
    assert shown == {
        "theta": "0 … 90 deg",
        "d1": "418.5 µm",
        "rho": "376900 µm²",
        "mu": "0.3 … 0.36",
        "h": "−∞ … 1000 µm",
        "other": "2.5 SI",
    }
