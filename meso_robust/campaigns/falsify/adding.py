"""Adding up what the chunks of a part found."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import asdict, dataclass, field
from typing import Any

from meso_robust.campaigns.falsify.executing import value_of
from meso_robust.campaigns.falsify.totals import Totals, added
from meso_robust.campaigns.kind import Part, Result, Values

MOST_HARD = 4  # hardest runs that are drawn

Told = float | str | None
"""A value as ``executing.finite`` writes it."""


@dataclass
class _Sum:
    draws: dict[str, Totals] = field(default_factory=dict)
    reached: dict[str, dict[str, Told]] = field(default_factory=dict)
    searches: dict[str, dict[str, int]] = field(default_factory=dict)
    broken: dict[str, int] = field(default_factory=dict)
    rare: dict[str, list[Values]] = field(default_factory=dict)
    best: dict[str, list[Any]] = field(default_factory=dict)
    thresholds: list[Values] = field(default_factory=list)
    hardest: list[Any] = field(default_factory=list)

    def add(self, one: Result) -> None:
        values = one.values
        if values["does"] == "threshold":
            self.thresholds.append(values)
        elif values["does"] == "draws":
            self._add_draws(values)
        else:
            self._add_search(values, one.failed)

    def _add_draws(self, values: Values) -> None:
        method = values["method"]
        self.draws[method] = self.draws.get(method, Totals()).plus(Totals(**values["totals"]))
        for target, value in values["reached"].items():
            self._raise(target, method, value)
        self._harder(values["hardest"])

    def _add_search(self, values: Values, failed: int) -> None:
        method, target = values["method"], values["target"]
        so_far = self.searches.get(method, {})
        found = {
            "searches": 1,
            "evaluations": values["evaluations"],
            "failed": failed,
            "unfinished": values["unfinished"],
        }
        self.searches[method] = added(so_far, found)
        self.broken = added(self.broken, values["broken"])
        higher = value_of(values["highest"]) > value_of(self.best.get(target, [None])[0])
        if higher or target not in self.best:
            self.best[target] = [values["highest"], method, values["row"]]
        self._raise(target, method, values["highest"])
        if values["rare"] is not None:
            self.rare.setdefault(target, []).append(values["rare"])
        self._harder(values["hardest"])

    def _raise(self, target: str, method: str, value: Told) -> None:
        by = self.reached.setdefault(target, {})
        if method not in by or value_of(value) > value_of(by[method]):
            by[method] = value

    def _harder(self, found: list[Any]) -> None:
        """The hardest of all, each once, the first of equals first."""
        new = [one for one in found if one not in self.hardest]
        self.hardest = sorted([*self.hardest, *new], key=lambda h: -h[0])[:MOST_HARD]


def total(_: Part, results: Iterable[Result]) -> Values:
    """Everything that results say together.

    Returns
    -------
    Values
        ``draws``: :class:`Totals` by method; ``reached``: highest value by target and method;
        ``searches``: how many, their executions and how many of their ends broke a claim, by
        method; ``broken``: ends of searches that broke a claim, by claim; ``rare``: what splitting
        found, by target; ``best``: highest value, its method and row, by target; ``thresholds``;
        ``hardest``: runs that ended farthest from the middle of the goal.
    """
    found = _Sum()
    for one in results:
        found.add(one)
    return asdict(found)
