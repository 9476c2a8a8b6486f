"""Local tests and the p-value of the largest, by hand-made nulls."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
import pytest
from scipy.stats import norm

from meso_robust.diagnosis.detect import ALARM, Detector, Span, detector
from meso_robust.diagnosis.signatures import Signature
from meso_robust.diagnosis.tangent import Tangent, basis
from meso_robust.diagnosis.trials import Trial

Floats = npt.NDArray[np.float64]
R, T, B = 2, 10, 39
FILES = ("a.csv", "b.csv")
SPANS = (
    Span(recording=0, phase="rest", first=0, last=4, start=0.0, end=0.1),
    Span(recording=1, phase="contact", first=3, last=10, start=0.1, end=0.3),
)


def seen() -> npt.NDArray[np.bool_]:
    found = np.ones((R, T, 3), dtype=bool)
    found[1, 5, 0] = False
    return found


def nothing_taken(shared: Floats | None = None) -> Tangent:
    """About a fit that takes nothing of the data, but for some directions."""
    taken = np.zeros((R * T * 3, 0)) if shared is None else shared
    return Tangent(np.zeros((R, 3 * T, 3)), taken, seen(), 0.0)


def signature(name: str, *columns: Floats) -> Signature:
    trial = Trial(effect=name, sizes={f"k{k}": 1.0 for k in range(len(columns))})
    return Signature(trial=trial, columns=np.stack(columns).reshape(-1, R, 3 * T), one_sided=False)


def unit(*places: int) -> Floats:
    found = np.zeros(R * T * 3)
    found[list(places)] = 1.0
    return found / np.linalg.norm(found)


def noise(rng: np.random.Generator, count: int) -> Floats:
    return np.asarray(rng.standard_normal((count, R, 3 * T)) * seen().reshape(R, -1))


def p_value_by_hand(tests: Detector, rows: Floats, nulls: Floats) -> float:
    """Every null compared with all others, the recordings with all."""
    of_null, own = tests.statistics(tests.at.evidence(nulls)), tests.statistics(rows.reshape(1, -1))
    largest = []
    for b in range(len(nulls)):
        others = np.delete(of_null, b, axis=0)
        largest.append(np.max((of_null[b] - others.mean(axis=0)) / others.std(axis=0, ddof=1)))
    ours = np.max((own[0] - of_null.mean(axis=0)) / of_null.std(axis=0, ddof=1))
    return float((1 + sum(one >= ours for one in largest)) / (1 + len(nulls)))


def plain() -> Detector:
    one = signature("body_force", unit(3, 9, 15))
    two = signature("camera_drift", unit(30, 33), unit(31, 34))
    return detector(nothing_taken(), [one, two], SPANS, FILES)


def test_the_p_value_is_the_share_of_nulls_that_are_as_large() -> None:
    rng = np.random.default_rng(0)
    tests, nulls = plain(), noise(rng, B)
    for size in (0.0, 2.0, 3.0, 20.0):
        rows = noise(rng, 1)[0] + size * unit(3, 9, 15).reshape(R, -1)
        found = tests.detection(rows, nulls)
        assert found.p_value == pytest.approx(p_value_by_hand(tests, rows, nulls))
        assert found.detected == (found.p_value <= max(ALARM, 1.0 / (1 + B)))
    assert found.p_value == 1.0 / (1 + B)
    assert len(found.null_statistics) == B


def test_a_planted_signature_is_the_largest_test() -> None:
    rng = np.random.default_rng(1)
    found = plain().detection(noise(rng, 1)[0] + 9.0 * unit(31, 34).reshape(R, -1), noise(rng, 150))
    assert found.detected
    assert found.tests[0].name == "camera_drift"
    assert found.tests[0].kind == "signature"
    assert found.statistic == found.sigmas[0] == found.sigmas.max()
    assert np.all(np.diff(found.sigmas) <= 0.0)


def test_without_a_mismatch_p_values_are_even() -> None:
    rng = np.random.default_rng(2)
    tests, nulls = plain(), noise(rng, 120)
    p = np.array([tests.detection(noise(rng, 1)[0], nulls).p_value for _ in range(120)])
    for level in (0.1, 0.3, 0.5, 0.8):
        # 120 draws, and a threshold that is itself from 120 draws
        assert np.mean(p <= level) == pytest.approx(
            level, abs=4.0 * np.sqrt(2.0 * level * (1.0 - level) / 120)
        )


def test_tests_are_named_and_ordered_as_they_are_computed() -> None:
    tests = plain()
    kinds = [one.kind for one in tests.names]
    assert kinds == ["signature"] * 2 + ["phase"] * 6 + ["recording"] * 2
    rows = noise(np.random.default_rng(3), 1)
    values = tests.statistics(rows.reshape(1, -1))[0]
    frames = rows[0].reshape(R, T, 3)
    assert values[0] == pytest.approx(abs(float(unit(3, 9, 15) @ rows.ravel())))
    two = (unit(30, 33) @ rows.ravel()) ** 2 + (unit(31, 34) @ rows.ravel()) ** 2
    # χ² with two degrees of freedom exceeds s with probability exp(−s/2)
    assert values[1] == pytest.approx(norm.isf(0.5 * np.exp(-0.5 * two)))
    rest = frames[0, :4].sum(axis=0) / np.sqrt(4)
    contact = frames[1, 3:].sum(axis=0) / np.sqrt([6, 7, 7])
    np.testing.assert_allclose(values[2:8], np.abs([*rest, *contact]))
    np.testing.assert_allclose(values[8:] ** 3, np.sum(frames**2, axis=(1, 2)))
    phase = tests.names[3]
    assert (phase.name, phase.recording, phase.start, phase.end, phase.component) == (
        "a.csv rest y",
        0,
        0.0,
        0.1,
        "y",
    )


def test_enormous_mismatches_have_a_size_as_well() -> None:
    tests = plain()
    sizes = [10.0, 30.0, 50.0, 1e3, 1e6]
    found = [float(tests.statistics(size * unit(30, 31, 33, 34)[None])[0, 1]) for size in sizes]
    assert np.all(np.isfinite(found))
    assert np.all(np.diff(found) > 0.0)
    np.testing.assert_allclose(found, sizes, rtol=0.05)


def test_what_a_refit_takes_is_no_test() -> None:
    whole = unit(3, 9, 15)
    taken = basis(np.stack([whole, unit(40)], axis=1))
    half = signature("film_flow", unit(3, 9, 15) + unit(20), unit(40) + unit(3, 9, 15))
    tests = detector(nothing_taken(taken), [signature("body_force", whole), half], SPANS, FILES)
    assert [one.name for one in tests.names if one.kind == "signature"] == ["film_flow"]
    assert tests.blocks[0].shape == (1, R * T * 3)
    np.testing.assert_allclose(np.abs(tests.blocks[0][0]), unit(20), atol=1e-12)
