"""The film."""

import numpy as np
import pytest

from meso_robust.simulator.support import arm_scale, check_film_ratio


def test_arm_scale_squared_is_the_inverse_ratio() -> None:
    assert arm_scale(0.25e-6) == pytest.approx(2000.0)


@pytest.mark.parametrize("value", [0.0, -1e-7])
def test_film_without_resistance_is_refused(value: float) -> None:
    with pytest.raises(ValueError, match=r"film_ratio: run 1 has .* m²; .* must be positive; give"):
        check_film_ratio(np.array([1e-7, value]))
