"""Direct tests as JSON has them, and in words."""

from __future__ import annotations

import math
from typing import Any

from meso_robust.recordings.direct.finding import Estimate, Finding
from meso_robust.recordings.direct.run import DirectTests
from meso_robust.recordings.direct.trends import Trend
from meso_robust.recordings.rules import UM

_MS = 1e-3
_TRENDS = 5
_UNITS = (
    ("_um_s", " µm/s"),
    ("_per_mm", "/mm"),
    ("_um", " µm"),
    ("_deg", "°"),
    ("_ms", " ms"),
    ("percent", " %"),
    ("_hz", " Hz"),
)


def direct_document(tests: DirectTests) -> dict[str, Any]:
    """Plain values, in µm, deg, ms and s.

    Parameters
    ----------
    tests
        What was found.

    Returns
    -------
    dict
        As ``summary.json`` has it.
    """
    return {
        "findings": [_finding(one) for one in tests.findings],
        "gap_um": _rms(tests.gap),
        "hand_um": _rms(tests.hand),
        "balance_um": _rms(tests.balance),
        "rho_um2": _number(tests.balance.rho / UM**2) if tests.balance else None,
        "gap_trends": [_trend(one) for one in tests.gap_trends[:_TRENDS]],
        "balance_trends": [_trend(one) for one in tests.balance_trends[:_TRENDS]],
        "straight": None
        if tests.straight is None
        else {
            "pieces": tests.straight.pieces,
            "tip_sigma_um": _number(tests.straight.tip_sigma / UM),
            "along_um": _number(tests.straight.along / UM),
            "stamp_sigma_ms": _number(tests.straight.stamp_sigma / _MS),
            "even": tests.straight.even,
        },
        "clocks": [
            {
                "file": one.file,
                "stream": one.name,
                "period_ms": _number(one.period / _MS),
                "jitter_ms": _number(one.jitter / _MS),
                "lost": one.lost,
                "late": list(one.late),
                "rough_um": _number(one.rough / UM),
                "rough_regular_um": _number(one.rough_regular / UM),
            }
            for one in tests.clocks
        ],
    }


def words(tests: DirectTests) -> tuple[str, ...]:
    """A line for each finding.

    Parameters
    ----------
    tests
        What was found.

    Returns
    -------
    tuple of str
        Effect, sizes with 90 % intervals, what they remove, and how sure that is: it looks as if it were
        so, for another effect may move tip and face alike.
    """
    return tuple(f"as if {finding_words(one)}" for one in tests.findings)


def finding_words(one: Finding) -> str:
    """A finding in a line.

    Parameters
    ----------
    one
        What was found.

    Returns
    -------
    str
        Without a full stop.
    """
    sizes = ", ".join(
        f"{each.key.split('_')[0]} = {each.value:.3g}{_unit(each.key)} ({_between(each)})"
        for each in one.estimates
    )
    gain = "" if one.after >= one.before else f"; {_SEEN[one.test]} {_to(one)} µm"
    sure = "" if math.isnan(one.p_value) else f", p = {one.p_value:.2g}"
    alike = f"; hardly told from {', '.join(one.alike)}" if one.alike else ""
    return f"{one.effect}: {sizes}{gain}{sure}{alike}"


_SEEN = {
    "gap": "gap between tip and face",
    "hand": "wander in the hand's frame",
    "balance": "error of the lever arm",
    "clock": "deviation from even travel",
    "straight": "noise of the log",
    "rest": "scatter of frames at rest",
}


def _to(one: Finding) -> str:
    return f"{one.before / UM:.3g} → {one.after / UM:.3g}"


def _unit(key: str) -> str:
    return next((unit for end, unit in _UNITS if key.endswith(end)), "")


def _finding(one: Finding) -> dict[str, Any]:
    return {
        "test": one.test,
        "effect": one.effect,
        "parameters": {
            each.key: {
                "value": _number(each.value),
                "low": _number(each.low),
                "high": _number(each.high),
            }
            for each in one.estimates
        },
        "before_um": _number(one.before / UM),
        "after_um": _number(one.after / UM),
        "p_value": _number(one.p_value),
        "alike": list(one.alike),
    }


def _trend(one: Trend) -> dict[str, Any]:
    return {
        "covariate": one.covariate,
        "correlation": _number(one.correlation),
        "p_value": _number(one.p_value),
    }


def _rms(test: Any) -> dict[str, float | None] | None:
    if test is None:
        return None
    before, after = test.rms
    return {"before": _number(before / UM), "after": _number(after / UM)}


def _between(one: Estimate) -> str:
    if not math.isfinite(one.high):
        return "of one recording: without an interval"
    return f"{one.low:.3g} … {one.high:.3g}"


def _number(value: float) -> float | None:
    """To six digits; None where there is none."""
    return float(f"{value:.6g}") if math.isfinite(value) else None
