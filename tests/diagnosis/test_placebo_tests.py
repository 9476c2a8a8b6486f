"""Decoys: what they are, and how often they reach a signature that is there, or is not."""

from __future__ import annotations

import numpy as np

from meso_robust.diagnosis.answer import document
from meso_robust.diagnosis.baseline import Baseline
from meso_robust.diagnosis.controls import decoy, decoys
from meso_robust.diagnosis.diagnose import Diagnosis
from meso_robust.diagnosis.tangent import Tangent


def tangent_of(count: int, frames: int, more: int = 0) -> Tangent:
    """Of a fit that takes nothing."""
    size = 3 * frames + more
    seen = np.ones((count, frames, 3), dtype=bool)
    return Tangent(np.zeros((count, size, 1)), np.zeros((count * size, 0)), seen, 0.0)


def test_a_decoy_is_on_another_recording_in_another_frame() -> None:
    at, rng = tangent_of(6, 4), np.random.default_rng(0)
    columns = rng.standard_normal((2, 6, 12))
    turned = set()
    for _ in range(20):
        found = decoy(at, columns, rng).reshape(2, 6, 4, 3)
        given = columns.reshape(2, 6, 4, 3)
        for r in range(6):
            same = np.isclose(np.abs(given[..., 2]), np.abs(found[:, r : r + 1, :, 2]))
            (source,) = np.flatnonzero(np.all(same, axis=(0, 2)))
            assert source != r
            own = given[:, source]
            # the map of x and y is one of the eight symmetries of a square, θ has its sense
            flat = np.linalg.lstsq(own[..., :2].reshape(-1, 2), found[:, r, :, :2].reshape(-1, 2))[
                0
            ]
            sense = np.linalg.det(flat)
            assert np.allclose(np.abs(flat), np.round(np.abs(flat)), atol=1e-9)
            assert np.isclose(abs(sense), 1.0)
            assert np.allclose(found[:, r, :, 2], sense * own[..., 2])
            turned.add(tuple(np.round(flat).astype(int).ravel().tolist()))
    assert len(turned) == 8


def test_nothing_is_put_where_nothing_was_seen_and_priors_go_along() -> None:
    at, rng = tangent_of(3, 4, more=4), np.random.default_rng(0)
    at.seen[1, 2:] = False
    columns = np.concatenate([rng.standard_normal((1, 3, 12)), np.arange(12.0).reshape(1, 3, 4)], 2)
    found = decoy(at, columns, rng)
    assert np.all(found[0, 1, 6:12] == 0.0)
    assert np.all(found[0, 1, :6] != 0.0)
    assert set(found[0, :, 12].tolist()) == {0.0, 4.0, 8.0}
    assert all(found[0, r, 12] != 4.0 * r for r in range(3))


def test_no_decoy_reaches_what_is_really_there(late: Diagnosis) -> None:
    assert late.checked.decoys is not None
    assert late.checked.decoys.count >= 20
    assert late.checked.decoys.share == 0.0
    found = document(late, "0")
    assert (found.decoys, found.decoy_share) == (late.checked.decoys.count, 0.0)


def test_of_noise_decoys_explain_as_much(pulled: Baseline) -> None:
    rng = np.random.default_rng(2)
    at, shape = pulled.tangent, pulled.rows.shape
    shares = []
    for seed in range(8):
        rows, columns = rng.standard_normal(shape), rng.standard_normal((2, *shape))
        found = decoys(at, rows, columns, seed)
        assert found is not None
        shares.append(found.share)
    assert 0.2 < np.mean(shares) < 0.8
    assert np.ptp(shares) > 0.2


def test_the_same_seed_has_the_same_decoys_and_one_recording_none() -> None:
    at, rng = tangent_of(5, 9), np.random.default_rng(3)
    rows, columns = rng.standard_normal((5, 27)), rng.standard_normal((1, 5, 27))
    assert decoys(at, rows, columns, 1) == decoys(at, rows, columns, 1)
    assert len({decoys(at, rows, columns, seed) for seed in range(6)}) > 1
    assert decoys(tangent_of(1, 9), rows[:1], columns[:, :1], 0) is None
