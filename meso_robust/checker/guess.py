"""Where barriers are looked for, in plain floating point: no proof rests on this file."""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping

Corners = list[tuple[float, float, float]]
"""V, rho, mu"""


def corners_of(ends: Mapping[str, tuple[float, float]]) -> Corners:
    """All corners of the box of V, rho and mu."""
    return list(itertools.product(ends["V"], ends["rho"], ends["mu"]))


def fastest(h: float, sigma: float, d1: float, corners: Corners, side: int) -> float:
    """The largest (side = 1) or smallest (-1) slide rate at some corners."""
    rates = (_rate(h, sigma, d1, *corner) for corner in corners)
    return max(rates) if side > 0 else min(rates)


def _rate(h: float, sigma: float, d1: float, V: float, rho: float, mu: float) -> float:
    """The slide rate: of the rates at which tips slip and those at which one sticks, the middle."""
    w = 2.0 * d1
    T = math.sqrt(h * h + V * V - w * w)
    c, s = (T * h - w * V) / (h * h + V * V), (w * h + T * V) / (h * h + V * V)
    p_S = -0.5 * T - sigma

    def slide(k_D: float, k_S: float) -> float:
        m_D, m_S = p_S + T + d1 * k_D, p_S + d1 * k_S
        share = s / T / (m_D - m_S)
        return share * (k_D * (rho + p_S * m_S) + k_S * (rho + p_S * m_D)) + 0.5 * c

    sticks = -0.5 * h / T
    near = slide(mu, -mu) if sticks > 0.0 else slide(-mu, mu)
    ends = sorted((sticks, -sticks))
    if slide(-mu, -mu) > ends[1]:
        return slide(-mu, -mu)
    if slide(mu, mu) < ends[0]:
        return slide(mu, mu)
    return min(max(near, ends[0]), ends[1])


def curve(
    first: float, last: float, sigma: float, d1: float, corners: Corners, side: int, rising: bool
) -> tuple[float, float, float]:
    """Slope at the start, slope at the end and rise of a curve that is as fast as any motion."""

    def rate(h: float, at: float) -> float:
        found = fastest(h, at, d1, corners, side)
        return side * max(side * found, 0.0) if rising else found

    length = first - last
    middle = 0.5 * (first + last)
    one = rate(first, sigma)
    two = rate(middle, sigma + 0.5 * length * one)
    three = rate(middle, sigma + 0.5 * length * two)
    four = rate(last, sigma + length * three)
    rise = length * (one + 2.0 * two + 2.0 * three + four) / 6.0
    return one, rate(last, sigma + rise), rise
