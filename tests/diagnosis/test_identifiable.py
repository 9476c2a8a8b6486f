"""What recordings could show, and which effects look alike in them."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
import pytest

from meso_robust.diagnosis.diagnose import Diagnosis
from meso_robust.diagnosis.signatures import SEEN, Signature, Visibility, visibilities
from meso_robust.diagnosis.tangent import Tangent
from meso_robust.diagnosis.trials import Trial

Floats = npt.NDArray[np.float64]
R, T = 2, 6


def at(shared: Floats) -> Tangent:
    seen = np.ones((R, T, 3), dtype=bool)
    return Tangent(np.zeros((R, 3 * T, 3)), shared, seen, 0.0)


def signature(effect: str, *columns: Floats) -> Signature:
    trial = Trial(effect=effect, sizes={f"k{k}": 1.0 for k in range(len(columns))})
    return Signature(trial=trial, columns=np.stack(columns).reshape(-1, R, 3 * T), one_sided=False)


def along(*places: int) -> Floats:
    found = np.zeros(R * T * 3)
    found[list(places)] = 1.0
    return found


def by_name(found: tuple[Visibility, ...]) -> dict[str, Visibility]:
    return {one.effect: one for one in found}


def test_an_effect_is_as_visible_as_what_the_fit_leaves_of_it() -> None:
    taken = along(0)[:, None]
    found = by_name(
        visibilities(
            at(taken),
            [
                signature("body_force", 30.0 * along(0) + 4.0 * along(1) + 3.0 * along(2)),
                signature("camera_drift", 4.9 * along(5)),
                signature("camera_drift", 2.0 * along(6), 6.0 * along(7)),  # its better form
                signature("drag_drift", 99.0 * along(0)),
                signature("backlash", 4.9 * along(8)),
            ],
        )
    )
    assert SEEN == 5.0
    sizes = {name: one.sigma for name, one in found.items()}
    assert sizes == pytest.approx(
        {"body_force": 5.0, "camera_drift": 6.0, "drag_drift": 0.0, "backlash": 4.9}
    )
    assert [name for name, one in found.items() if one.seen] == ["body_force", "camera_drift"]


def test_effects_are_alike_if_one_holds_all_directions_of_the_other() -> None:
    one, two = along(1, 2), along(3)
    found = by_name(
        visibilities(
            at(np.zeros((R * T * 3, 0))),
            [
                signature("body_force", 7.0 * one),
                signature("film_flow", -9.0 * one + 0.3 * along(9)),
                signature("wall_capillarity", one + two, one - two),
                signature("tip_radius", 5.0 * two + 5.0 * along(11)),
            ],
        )
    )
    alike = {name: set(one.alike) for name, one in found.items()}
    assert alike["body_force"] == {"film_flow", "wall_capillarity"}
    assert alike["film_flow"] == {"body_force", "wall_capillarity"}
    assert alike["wall_capillarity"] == set()  # it can do more than each of them
    assert alike["tip_radius"] == set()  # at 45° to the nearest one


def test_a_force_and_a_flow_look_alike_and_drift_of_the_drag_does_not_show(
    null: Diagnosis,
) -> None:
    found = by_name(null.detected.visible)
    assert "film_flow" in found["body_force"].alike
    assert "body_force" in found["film_flow"].alike
    assert not found["drag_drift"].seen  # motion does not depend on the scale of the drag
    assert found["camera_latency"].seen
    assert found["drag_centre_offset"].seen
