"""How good the answers of a blind benchmark are: pure functions of judged cases."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from meso_robust.campaigns.blind.judging import Judged
from meso_robust.campaigns.blind.labels import KINDS, PLAIN
from meso_robust.campaigns.intervals import share_interval

CONFIDENCE = 0.95
BINS = 10
"""Of equal width, for the calibration of stated probabilities."""
NEAR_FLOOR = 1.2
"""Held-out error over the noise floor that counts as explained."""

Test = Callable[[Judged], bool]
Scores = dict[str, Any]


@dataclass(frozen=True, slots=True)
class Share:
    """So many of so many, with the exact (Clopper–Pearson) 95 % interval of the rate."""

    hits: int
    count: int

    @property
    def rate(self) -> float | None:
        """Share of hits; None of nothing."""
        return self.hits / self.count if self.count else None

    @property
    def low(self) -> float:
        """Lower end."""
        return share_interval(self.hits, self.count, CONFIDENCE)[0] if self.count else 0.0

    @property
    def high(self) -> float:
        """Upper end."""
        return share_interval(self.hits, self.count, CONFIDENCE)[1] if self.count else 1.0

    def told(self) -> Scores:
        """As stored in ``results.json``."""
        ends = {"low": round(self.low, 4), "high": round(self.high, 4)}
        return {"hits": self.hits, "count": self.count, "rate": self.rate, **ends}


def share(cases: Sequence[Judged], test: Test) -> Share:
    """How many cases pass."""
    return Share(sum(map(test, cases)), len(cases))


def of_kind(cases: Iterable[Judged], *kinds: str) -> list[Judged]:
    """Cases of these kinds, without effects that no motion can show."""
    return [case for case in cases if case.kind in kinds and not case.silent]


def scores(cases: Sequence[Judged], planned: Mapping[str, int]) -> Scores:
    """Everything that is reported, ready for JSON.

    Parameters
    ----------
    cases
        All that were run.
    planned
        Cases of the corpus by kind.
    """
    effects = of_kind(cases, "effect")
    plain = [case for case in effects if case.multiple >= PLAIN]
    return {
        "cases": {
            "planned": dict(planned),
            "run": {kind: sum(case.kind == kind for case in cases) for kind in KINDS},
            "unanswered": share(cases, lambda c: c.verdict == "none").told(),
        },
        "nulls": nulls(of_kind(cases, "null")),
        "naming": {"by_multiple": by_multiple(effects), "plain": naming(plain)},
        "confusion": confusion(cases),
        "wrong_and_confident": {
            "all": share(cases, _wrong).told(),
            **{kind: share([c for c in cases if c.kind == kind], _wrong).told() for kind in KINDS},
        },
        "pairs": pairs(of_kind(cases, "pair")),
        "outside": outside(of_kind(cases, "outside")),
        "unidentifiable": unidentifiable(
            [c for c in cases if c.kind == "unidentifiable" or (c.silent and c.kind == "effect")]
        ),
        "stage": stage(cases),
        "parameters": parameters(cases),
        "held_out": held_out(cases),
        "calibration": calibration([claim for case in cases for claim in case.claims]),
        "power": power(effects),
        "seconds": quantiles([c.seconds for c in cases if c.seconds is not None]),
    }


def _wrong(case: Judged) -> bool:
    return case.confident_and_wrong


def nulls(cases: Sequence[Judged]) -> Scores:
    """Alarms where nothing is concealed."""
    return {
        "alarms": share(cases, lambda c: c.detected).told(),
        "named": share(cases, lambda c: c.named).told(),
    }


def naming(cases: Sequence[Judged]) -> Scores:
    """Single effects: seen, named exactly, or among the sets answered."""
    answered = [case for case in cases if case.answers]
    return {
        "detected": share(cases, lambda c: c.detected).told(),
        "right": share(cases, lambda c: c.right).told(),
        "best_right": share(cases, lambda c: c.best == c.truth).told(),
        "in_set": share(cases, lambda c: c.in_set).told(),
        "in_set_if_answered": share(answered, lambda c: c.in_set).told(),
        "mean_sets": float(np.mean([len(c.answers) for c in answered])) if answered else None,
        "wrong": share(cases, _wrong).told(),
    }


def by_multiple(cases: Sequence[Judged]) -> list[Scores]:
    """`naming` for each size over the just-detectable one."""
    sizes = sorted({case.multiple for case in cases})
    return [{"multiple": m, **naming([c for c in cases if c.multiple == m])} for m in sizes]


def answer_of(case: Judged) -> str:
    """A column of the confusion matrix."""
    if case.named:
        return "+".join(sorted(case.best))
    if case.verdict == "consistent" and case.truth & case.not_identifiable:
        return "not identifiable"
    return "no answer" if case.verdict == "none" else case.verdict


def truth_of(case: Judged) -> str:
    """A row of the confusion matrix."""
    return case.names[0] if case.kind == "effect" else case.kind


def confusion(cases: Iterable[Judged]) -> dict[str, dict[str, int]]:
    """Answers by what was concealed; effects by name, all other cases by kind."""
    rows: dict[str, Counter[str]] = {}
    for case in cases:
        rows.setdefault(truth_of(case), Counter())[answer_of(case)] += 1
    return {truth: dict(answers.most_common()) for truth, answers in sorted(rows.items())}


def pairs(cases: Sequence[Judged]) -> Scores:
    """Two effects at once: both named, one of the two and no other, or in the sets answered."""
    return {
        "detected": share(cases, lambda c: c.detected).told(),
        "both": share(cases, lambda c: c.right).told(),
        "one": share(cases, lambda c: c.named and c.best < c.truth).told(),
        "in_set": share(cases, lambda c: c.in_set).told(),
        "wrong": share(cases, _wrong).told(),
    }


def outside(cases: Sequence[Judged]) -> Scores:
    """Effects that the catalogue does not have."""
    seen = [case for case in cases if case.detected]
    return {
        "detected": share(cases, lambda c: c.detected).told(),
        "unknown": share(cases, lambda c: c.verdict == "unknown").told(),
        "unknown_if_detected": share(seen, lambda c: c.verdict == "unknown").told(),
        "wrong": share(cases, _wrong).told(),
        "by_name": {
            name: dict(Counter(answer_of(c) for c in cases if c.names == (name,)))
            for name in sorted({case.names[0] for case in cases})
        },
    }


def unidentifiable(cases: Sequence[Judged]) -> Scores:
    """Recordings that cannot show what is concealed, and whether that is admitted."""
    return {
        "says_so": share(cases, lambda c: c.says_so).told(),
        "wrong": share(cases, _wrong).told(),
        "by_name": {
            name: dict(Counter(answer_of(c) for c in cases if "+".join(c.names) == name))
            for name in sorted({"+".join(case.names) for case in cases})
        },
    }


def stage(cases: Iterable[Judged]) -> Scores:
    """Whether a mismatch that was reported was put at the right stage."""
    placed = [case for case in of_kind(cases, "effect", "pair", "outside") if case.stage]
    plain = [case for case in placed if case.kind == "effect" and case.multiple >= PLAIN]
    groups: dict[str, list[Judged]] = {"plain": plain}
    groups |= {kind: of_kind(placed, kind) for kind in KINDS[1:4]}
    return {name: share(group, lambda c: c.stage_right).told() for name, group in groups.items()}


def parameters(cases: Iterable[Judged]) -> Scores:
    """Whether 90 % intervals hold the truth, where the set was named rightly."""
    found = [pair for case in cases for pair in case.covered]
    keys = sorted({key for key, _ in found})
    groups = {key: [inside for name, inside in found if name == key] for key in keys}
    groups = {"all": [inside for _, inside in found], **groups}
    return {key: Share(sum(flags), len(flags)).told() for key, flags in groups.items()}


def held_out(cases: Iterable[Judged]) -> Scores:
    """Error on recordings that no fit has seen, after naming."""
    named = [case for case in cases if case.floor_ratio is not None]
    found: dict[str, list[Judged]] = {
        "named": named,
        "right": [case for case in named if case.right],
    }
    return {
        name: {
            "over_floor": quantiles([c.floor_ratio for c in group if c.floor_ratio is not None]),
            "near_floor": share(group, lambda c: (c.floor_ratio or 0.0) <= NEAR_FLOOR).told(),
            "removed": quantiles([c.removed for c in group if c.removed is not None]),
        }
        for name, group in found.items()
    }


def calibration(claims: Sequence[tuple[float, bool]]) -> Scores:
    """Stated probabilities against how often they were right: Brier score, ECE, reliability."""
    if not claims:
        return {"claims": 0, "brier": None, "ece": None, "bins": []}
    stated, true = np.array([c[0] for c in claims]), np.array([float(c[1]) for c in claims])
    at = np.minimum((stated * BINS).astype(int), BINS - 1)
    bins = [
        {
            "from": k / BINS,
            "count": int((at == k).sum()),
            "stated": float(stated[at == k].mean()),
            "right": float(true[at == k].mean()),
        }
        for k in range(BINS)
        if (at == k).any()
    ]
    ece = sum(b["count"] * abs(b["stated"] - b["right"]) for b in bins) / len(claims)
    brier = float(np.mean((stated - true) ** 2))
    return {"claims": len(claims), "brier": brier, "ece": ece, "bins": bins}


def power(cases: Sequence[Judged]) -> dict[str, list[Scores]]:
    """Detected and rightly named of each effect at each size."""
    found: dict[str, list[Scores]] = {}
    for name, size in sorted({(case.names[0], case.multiple) for case in cases}):
        own = [case for case in cases if (case.names[0], case.multiple) == (name, size)]
        counts = {"count": len(own), "detected": sum(c.detected for c in own)}
        point = {"multiple": size, **counts, "right": sum(c.right for c in own)}
        found.setdefault(name, []).append(point)
    return found


def quantiles(values: Sequence[float]) -> Scores:
    """Count, median, 90 % quantile and largest."""
    if not values:
        return {"count": 0}
    median, high = np.quantile(values, [0.5, 0.9])
    found = {"median": float(median), "q90": float(high), "largest": float(max(values))}
    return {"count": len(values), **found}
