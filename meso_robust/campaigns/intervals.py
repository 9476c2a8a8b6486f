"""How sure a share of successes is."""

from __future__ import annotations

from scipy.stats import beta


def share_interval(hits: int, runs: int, confidence: float = 0.95) -> tuple[float, float]:
    """Exact (Clopper–Pearson) two-sided interval of a probability, from ``hits`` of ``runs``.

    Raises
    ------
    ValueError
        If there is no run, or more hits than runs.
    """
    if not 0 <= hits <= runs or runs == 0:
        raise ValueError(f"hits = {hits}, runs = {runs}: need 0 <= hits <= runs and a run")
    tail = 0.5 * (1.0 - confidence)
    low = float(beta.ppf(tail, hits, runs - hits + 1)) if hits else 0.0
    high = float(beta.ppf(1.0 - tail, hits + 1, runs - hits)) if hits < runs else 1.0
    return low, high
