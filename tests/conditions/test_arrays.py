"""Formulas over arrays: shapes, types, and points where a formula is undefined."""

from __future__ import annotations

import math

import numpy as np
import pytest

from meso_robust.conditions import values


def test_arguments_broadcast_and_every_result_has_the_common_shape() -> None:
    motion = values("two_sided_rotation", "one_contact_motion")
    v_x, v_y = motion(theta=np.full((3, 1), math.pi / 2), d1=2.0, d2=[1.0, 0.0], rho=1.0, tau=0)
    assert v_x.shape == v_y.shape == (3, 2)
    np.testing.assert_allclose(v_x, [[-0.5, -1.0]] * 3, rtol=1e-15)
    np.testing.assert_allclose(v_y, 0.0, atol=1e-16)


def test_a_result_that_some_arguments_do_not_enter_has_the_common_shape_too() -> None:
    first, second = values("two_point_sticking", "normal_forces")(
        beta=0.0, d1=1, d2=3, d4=[5, 6, 7, 8]
    )
    np.testing.assert_array_equal(first, [2.0, 3.0, 4.0, 5.0])
    np.testing.assert_array_equal(second, [3.0, 3.0, 3.0, 3.0])
    second[0] = 0.0  # results can be written to
    assert second[1] == 3.0


def test_numbers_give_arrays_without_axes() -> None:
    (margin,) = values("two_sided_rotation", "no_jam")(V=3, d1=1, mu=0)
    assert margin.shape == ()
    assert margin == 5.0


def test_undefined_points_are_not_finite_and_raise_no_warning() -> None:
    (length,) = values("two_sided_rotation", "pair")(h=0.0, V=[1.0, 3.0], d1=1.0)
    assert np.isnan(length[0])
    assert length[1] == pytest.approx(math.sqrt(5.0))
    (ratio,) = values("one_point_sticking", "stick_ratio")(theta=0.0, d1=1.0, d2=0.0, rho=1.0)
    assert not np.isfinite(ratio)


@pytest.mark.parametrize("arguments", [{"V": 3, "d1": 1}, {"V": 3, "d1": 1, "mu": 0, "rho": 1}])
def test_arguments_are_those_of_the_formula(arguments: dict[str, float]) -> None:
    with pytest.raises(TypeError, match=r"no_jam.*(missing|unexpected)"):
        values("two_sided_rotation", "no_jam")(**arguments)


def test_a_formula_that_does_not_exist_is_refused() -> None:
    with pytest.raises(AttributeError, match="no_jamb"):
        values("two_sided_rotation", "no_jamb")
