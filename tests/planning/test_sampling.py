"""The sampling of Lemma 1."""

from __future__ import annotations

import itertools

from meso_robust.planning.sampling import best_robust, levels


def test_dispersion_is_halved_until_the_control_uncertainty() -> None:
    sampled = list(levels(-400.0, 400.0, 5.0))
    everything = sorted(x for level in sampled for x in level)
    gaps = {b - a for a, b in itertools.pairwise(everything)}

    assert sampled[0] == [0.0]
    assert sampled[1] == [-200.0, 200.0]
    # 800/2^7 = 6.25 is the last dispersion that is not below 5
    assert gaps == {6.25}
    assert len(everything) == 127


def test_no_sample_is_tried_twice() -> None:
    everything = [x for level in levels(0.0, 1.0, 0.01) for x in level]

    assert len(everything) == len(set(everything))


def test_best_sample_of_the_first_robust_level_and_its_neighbours() -> None:
    tried: list[float] = []

    def attempt(x: float) -> tuple[float, float] | None:
        tried.append(x)
        return (x, x) if 0.6 < x < 0.9 else None

    assert best_robust(0.0, 1.0, 1e-3, attempt) == 0.875
    assert tried == [0.5, 0.25, 0.75, 0.625, 0.875, 0.8125, 0.9375]
    assert best_robust(0.0, 1.0, 1e-3, attempt, refined=0) == 0.75


def test_nothing_robust_is_none_and_ends() -> None:
    assert best_robust(0.0, 1.0, 0.1, lambda x: None) is None


def test_many_samples_of_a_level_are_sifted_at_once_and_few_are_not() -> None:
    tried: list[float] = []
    sifted: list[int] = []

    def attempt(x: float) -> tuple[float, float] | None:
        tried.append(x)
        return (x, x) if 0.69 < x < 0.7 else None

    def sift(samples: list[float]) -> list[float]:
        sifted.append(len(samples))
        return [x for x in samples if 0.6 < x < 0.8]

    assert best_robust(0.0, 1.0, 1e-3, attempt, sift=sift) == best_robust(0.0, 1.0, 1e-3, attempt)
    assert sifted[:3] == [8, 16, 32]
    assert [x for x in tried[:20] if not 0.6 < x < 0.8] == [0.5, 0.25, 0.125, 0.375, 0.875]
