"""How sure a share of successes is, and how that is reported."""

from __future__ import annotations

from decimal import ROUND_CEILING, ROUND_FLOOR, ROUND_HALF_EVEN, Decimal

from scipy.stats import beta


def share_interval(hits: int, runs: int, confidence: float = 0.95) -> tuple[float, float]:
    """Two-sided interval of a probability, exact: it never covers less than it says.

    Parameters
    ----------
    hits, runs
        Successes, of how many.
    confidence
        Probability that the interval covers the truth, at least.

    Returns
    -------
    tuple
        Lower and upper end.

    Raises
    ------
    ValueError
        If there is no run, or more hits than runs.

    Notes
    -----
    Clopper and Pearson 1934, doi:10.1093/biomet/26.4.404, by quantiles of the beta distribution.
    """
    if not 0 <= hits <= runs or runs == 0:
        raise ValueError(f"hits = {hits}, runs = {runs}: need 0 <= hits <= runs and a run")
    tail = 0.5 * (1.0 - confidence)
    low = float(beta.ppf(tail, hits, runs - hits + 1)) if hits else 0.0
    high = float(beta.ppf(1.0 - tail, hits + 1, runs - hits)) if hits < runs else 1.0
    return low, high


def percent(share: float, rounding: str = ROUND_HALF_EVEN) -> str:
    """A share in %, with so many digits that what is less than all, or more than none, shows.

    Examples
    --------
    >>> percent(0.5), percent(1.0 - 1e-7), percent(1.0)
    ('50 %', '99.99999 %', '100 %')
    """
    exact = 100 * Decimal(share)
    near = min(exact, 100 - exact)
    places = max(4, 1 - near.adjusted()) if near else 4
    return f"{exact.quantize(Decimal(1).scaleb(-places), rounding).normalize():f} %"


def ends_told(low: float, high: float) -> tuple[str, str]:
    """The ends of an interval in %, rounded outward."""
    return percent(low, ROUND_FLOOR), percent(high, ROUND_CEILING)
