"""What an error of all frames alike leaves open, against fits to recordings that are displaced by it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import numpy.typing as npt
import pytest

from meso_robust.diagnosis.baseline import Baseline
from meso_robust.diagnosis.common_error import roomier, widened
from meso_robust.diagnosis.diagnose import Diagnosis
from meso_robust.diagnosis.refit import Refit, intervals_of, refitted
from meso_robust.diagnosis.signatures import Signature, signatures
from meso_robust.diagnosis.tangent import intervals
from meso_robust.diagnosis.trials import Trial
from meso_robust.simulator.catalogue import CATALOGUE
from tests.diagnosis.conftest import coloured
from tests.identification.sets import UM

Floats = npt.NDArray[np.float64]
SCALE = Trial(effect="camera_scale", sizes={"percent": 0.3})
OFFSET = Trial(effect="reference_offset", sizes={"x_um": 3.0, "y_um": 3.0})
STAYS = np.array([0.4 * UM, 0.4 * UM, np.radians(0.05)])
BETWEEN = 1.6448536269514722  # standard deviations that hold nine tenths on both sides


@pytest.fixture(scope="module")
def seen(null: Diagnosis) -> tuple[Baseline, Signature, Refit]:
    """Recordings without an effect, of which a part of σ stays, and a fit of the image's scale."""
    plain = coloured(null.baseline, 0.0)
    plain = replace(plain, noise=replace(plain.noise, stays=STAYS))
    (one,) = signatures(plain, [SCALE])
    return plain, one, refitted(plain, (one,))


def displaced(plain: Baseline, one: Signature, by: Floats) -> float:
    """Scale of the image fitted to poses that are seen off by (R, T, 3)."""
    moved = np.where(plain.seen, plain.prepared.seen + by, np.nan)
    at = replace(plain, prepared=replace(plain.prepared, seen=moved))
    return float(refitted(at, (one,)).fits.values[0, -1])


def test_an_interval_is_wider_by_what_displaced_recordings_would_tell(
    seen: tuple[Baseline, Signature, Refit],
) -> None:
    plain, one, refit = seen
    theta = np.nan_to_num(plain.prepared.seen[..., 2])
    cos, sin, none = np.cos(theta), np.sin(theta), np.zeros_like(theta)
    errors = [
        STAYS[0] * np.stack([cos, sin, none], axis=-1),
        STAYS[0] * np.stack([-sin, cos, none], axis=-1),
        STAYS[0] * np.stack([none + 1.0, none, none], axis=-1),
        STAYS[0] * np.stack([none, none + 1.0, none], axis=-1),
        STAYS[2] * np.stack([none, none, none + 1.0], axis=-1),
    ]
    undisturbed = displaced(plain, one, np.zeros_like(plain.prepared.seen))
    moved = [displaced(plain, one, by) - undisturbed for by in errors]
    known = intervals_of(plain, refit)
    (old,), (new,) = (
        [i for i in of if i.key == "camera_scale.percent"]
        for of in (known, widened(plain, refit, known))
    )
    half = BETWEEN * float(np.linalg.norm(moved))
    assert half > 0.3 * (old.high - old.value)  # it matters
    assert new.high - new.value == pytest.approx(np.hypot(old.high - old.value, half), rel=0.05)
    assert new.value - new.low == pytest.approx(np.hypot(old.value - old.low, half), rel=0.05)
    assert new.value == old.value


def test_an_effect_that_takes_up_the_error_is_not_wider_for_it(
    seen: tuple[Baseline, Signature, Refit],
) -> None:
    plain, _, _ = seen
    (one,) = signatures(plain, [OFFSET])
    refit = refitted(plain, (one,))
    known = intervals_of(plain, refit)
    alone = replace(plain, noise=replace(plain.noise, stays=STAYS * [0.0, 0.0, 1.0]))
    wider = {i.key: i for i in widened(plain, refit, known)}
    turned = {i.key: i for i in widened(alone, refit, known)}
    for key in ("reference_offset.x_um", "reference_offset.y_um"):
        # a shift of the image is told apart from it where the part turns: hardly anything is added
        assert wider[key].high - turned[key].high < STAYS[0]


def test_without_an_error_that_stays_intervals_are_as_they_were(
    seen: tuple[Baseline, Signature, Refit],
) -> None:
    plain, _, refit = seen
    known = intervals_of(plain, refit)
    quiet = replace(plain, noise=replace(plain.noise, stays=np.zeros(3)))
    assert widened(quiet, refit, known) is known


def test_there_is_room_for_an_error_that_no_detector_sees(
    seen: tuple[Baseline, Signature, Refit],
) -> None:
    """Of five standard deviations in as many directions as the catalogue has effects, one is the number's."""
    plain, _, refit = seen
    known = intervals_of(plain, refit)
    jacobian, values = refit.fitted.jacobian[0], refit.fits.values[0]
    curved = intervals(refit.model, values, jacobian, refit.tangent)
    (old,), (alone,), (new,) = (
        [i for i in of if i.key == "camera_scale.percent"]
        for of in (known, curved, roomier(refit, known))
    )
    room = 5.0 / np.sqrt(len(CATALOGUE)) * (alone.high - alone.value)
    assert new.high - new.value == pytest.approx(np.hypot(old.high - old.value, room))
    assert new.value - new.low == pytest.approx(np.hypot(old.value - old.low, room))
    assert new.value == old.value


def test_an_interval_is_of_plain_numbers_whatever_its_range_is_of(
    seen: tuple[Baseline, Signature, Refit],
) -> None:
    """That of a place in the image is computed; a file of the model refuses numbers of NumPy."""
    plain, _, refit = seen
    known = tuple(
        replace(
            one,
            parameter=replace(
                one.parameter, low=np.float64(one.parameter.low), high=np.float64(9.0)
            ),
        )
        for one in intervals_of(plain, refit)
    )
    for one in roomier(refit, known):
        types = [type(of) for of in (one.low, one.high, one.open_low, one.open_high)]
        assert types == [float, float, bool, bool]
