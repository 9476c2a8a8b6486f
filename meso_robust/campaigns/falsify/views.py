"""What a part found, as tables and pictures."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from meso_robust import units
from meso_robust.campaigns.coverage import coverage
from meso_robust.campaigns.falsify.executing import value_of
from meso_robust.campaigns.falsify.ready import Ready
from meso_robust.campaigns.falsify.section import METHODS
from meso_robust.campaigns.falsify.targets import COORDINATES, HALF_WIDTHS
from meso_robust.campaigns.falsify.totals import STICKS, Totals
from meso_robust.campaigns.hardest import paths, row_of
from meso_robust.campaigns.kind import Bars, Coverage, Paths, Table, Values, View
from meso_robust.laboratory.judging import INSTANTS
from meso_robust.types import Floats
from meso_robust.wording import down, up, up_to

SCALES = (1.0 / units.UM, 1.0 / units.UM, 1.0 / units.DEG)
MOST_BARS = 16
SAME = 1e-9  # relative difference of values that count as equal


def views(ready: Ready, totals: Values, drawn: Totals) -> tuple[View, ...]:
    """Everything to look at, the answer first.

    Parameters
    ----------
    ready
        Plan and claims.
    totals
        From ``adding.total``.
    drawn
        All draws of them, added up.
    """
    found: list[View | None] = [
        _claims(totals, drawn),
        _targets(ready, totals),
        _nearest(ready, totals),
        _paths(ready, totals),
        _draws(totals),
        _extremes(ready, drawn),
        _rare(ready, totals),
        _thresholds(totals),
        _coverage(ready, drawn),
    ]
    return tuple(one for one in found if one is not None)


def _claims(totals: Values, drawn: Totals) -> Table:
    ends = sum(int(one["searches"]) for one in totals["searches"].values())
    names = {**drawn.broken, **totals["broken"]}
    rows = (
        (
            name,
            f"{drawn.broken.get(name, 0):,} of {drawn.runs:,}",
            f"{totals['broken'].get(name, 0):,} of {ends:,}",
        )
        for name in names
    )
    return Table(
        title="Claims",
        head=("Claim", "Broken in draws", "Broken where a search ended"),
        rows=tuple(rows),
        note=f"Tubes are looked at {INSTANTS + 1} instants of every move.",
    )


def _targets(ready: Ready, totals: Values) -> Table:
    """The highest by each method, the highest of all first named."""
    methods = [m for m in METHODS if any(m in by for by in totals["reached"].values())]
    rows = []
    for target in ready.targets:
        by = totals["reached"].get(target.name, {})
        if by:
            cells = (_cell(by.get(method, "-")) for method in methods)
            rows.append((target.name, target.unit, f"{target.limit:g}", _first(by), *cells))
    return Table(
        title="Highest that each method found",
        head=("Target", "Unit", "Limit", "Highest by", *methods),
        rows=tuple(rows),
        note="Boxes, tubes and goal: 1 is the certified end (a box tighter than 1 nm or 1e-9 rad "
        "counts as that wide); a tube begins with the box before, which runs fill to its ends. `start`: how far a tip starts inside the part. `sticks`: friction "
        "that the first contact needs, minus mu. `grasp`: mu minus the friction at which the grasp "
        "locks. A value above a limit is not yet a broken claim: every end of a search is run by "
        "itself and held against all claims.",
    )


def _first(by: Mapping[str, float | str | None]) -> str:
    """The simplest method that found the highest, but for rounding."""
    top = max(value_of(value) for value in by.values())
    near = top - SAME * max(1.0, abs(top)) if np.isfinite(top) else top
    return next(m for m in METHODS if m in by and value_of(by[m]) >= near)


def _cell(value: float | str | None) -> str:
    return (
        f"{value:.6f}" if isinstance(value, float) else "says nothing" if value is None else value
    )


def highest(ready: Ready, totals: Values) -> dict[str, float]:
    """For each side of a box the highest share of its half width by any method, highest first.

    Runs that could not be carried out score infinity; whether that breaks a claim is judged apart.
    """
    found: dict[str, float] = {}
    for target in ready.targets:
        by = totals["reached"].get(target.name, {})
        if by and target.unit == HALF_WIDTHS and not target.record:
            finite = [v for value in by.values() if np.isfinite(v := value_of(value))]
            found |= {target.name: max(finite)} if finite else {}
    return dict(sorted(found.items(), key=lambda one: -one[1]))


def _nearest(ready: Ready, totals: Values) -> Bars | None:
    found = highest(ready, totals)
    hardest = list(found.items())[:MOST_BARS]
    if not hardest:
        return None
    return Bars(
        title="Nearest to leaving what is certified",
        unit=HALF_WIDTHS,
        labels=tuple(name for name, _ in hardest),
        values=tuple(value for _, value in hardest),
        limit=1.0,
        note=f"The highest {len(hardest)} of {len(found)} sides of boxes and of the goal.",
    )


def _paths(ready: Ready, totals: Values) -> Paths | None:
    hard: Sequence[Any] = totals["hardest"]
    if not hard:
        return None
    rows = np.array([row_of(row) for _, row in hard])
    runs = ready.player.run(rows, record=INSTANTS)
    labels = [f"{away:.4f} of the goal's tolerance" for away, _ in hard]
    return paths("Runs that ended farthest from the middle of the goal", ready.player, runs, labels)


def _draws(totals: Values) -> Table | None:
    rows = []
    for method, values in totals["draws"].items():
        one = Totals(**values)
        counts = (one.runs, one.failed, one.unfinished, one.repeated)
        rows.append((method, *(f"{n:,}" for n in counts)))
    for method, one in totals["searches"].items():
        cells = (
            f"{one['evaluations']:,}",
            f"{one['failed']:,} of {one['searches']:,} ends",
            "",
            "",
        )
        rows.append((method, *cells))
    if not rows:
        return None
    return Table(
        title="Executions",
        head=("Method", "Executions", "Break a claim", "Not finished", "Repeated at smaller steps"),
        rows=tuple(rows),
        note="A stepped run that seems to break a claim is repeated at half the step, and so on.",
    )


def _extremes(ready: Ready, drawn: Totals) -> Table | None:
    rows = []
    for k, (box, after) in enumerate(zip(ready.claims.posts, drawn.after, strict=False)):
        if box is None or after is None:
            continue
        for axis, name in enumerate(COORDINATES):
            reached = np.array(after)[:, axis] * SCALES[axis]
            certified = box[:, axis] * SCALES[axis]
            unit = "deg" if name == "theta" else "um"
            rows.append((f"{k + 1}", f"{name} ({unit})", _range(reached), _range(certified)))
    if not rows:
        return None
    slips = ", ".join(
        f"move {k + 1}: {up_to(slip, 2)} m"
        for k, (rule, slip) in enumerate(zip(ready.claims.rules, drawn.slip, strict=True))
        if rule.action in STICKS
    )
    return Table(
        title="Extremes of all draws",
        head=("After move", "Coordinate", "Reached", "Certified"),
        rows=tuple(rows),
        note=f"Largest drift of a contact that is claimed to stick: {slips}." if slips else "",
    )


def _range(ends: Floats) -> str:
    return f"{down(ends[0], 4)} … {up(ends[1], 4)}"


def pooled(found: Sequence[Mapping[str, Any]], key: str = "probability") -> tuple[float, float]:
    """Mean of independent estimates of a probability, and its coefficient of variation."""
    each = np.array([float(one[key]) for one in found])
    errors = each * np.array([float(one["variation"]) for one in found])
    mean = float(each.mean())
    return mean, float(np.sqrt(np.sum(errors**2)) / len(each) / mean) if mean else 0.0


def _rare(ready: Ready, totals: Values) -> Table | None:
    rows = []
    for target in ready.targets:
        found = totals["rare"].get(target.name, [])
        if not found:
            continue
        share, variation = pooled(found)
        deepest = max(found, key=lambda one: value_of(one["level"]))
        rows.append(
            (
                target.name,
                f"{share:.2e} (± {100.0 * variation:.0f} %)" if share else "not met",
                f"{len(found)}",
                _cell(deepest["level"]),
                f"{deepest['level_probability']:.1e}",
            )
        )
    if not rows:
        return None
    return Table(
        title="How likely a uniform draw is above the limit, by splitting",
        head=("Target", "Probability", "Estimates", "Deepest level", "At least that: probability"),
        rows=tuple(rows),
        note="Subset simulation (Au and Beck 2001). The coefficient of variation in brackets is its "
        "upper bound within each estimate. An estimate, not a bound: a part of the box that no "
        "population entered is not counted.",
    )


def _thresholds(totals: Values) -> Table | None:
    rows = tuple(
        (
            one["wanted"],
            down(one["certified"], 4),
            down(one["holds"], 4),
            "-" if one["breaks"] is None else up(one["breaks"], 4),
            "; ".join(one["claims"]),
        )
        for one in totals["thresholds"]
    )
    if not rows:
        return None
    return Table(
        title="Uncertainty at which an adversary first succeeds",
        head=(
            "What is broken",
            "Certified up to factor",
            "Nothing found at factor",
            "Found at factor",
            "Claim",
        ),
        rows=rows,
        note="All uncertainties are scaled about their middles; the factor is bisected, with an "
        "attack on every target (event-driven engine) at each trial.",
    )


def _coverage(ready: Ready, drawn: Totals) -> Coverage | None:
    if not drawn.runs:
        return None
    return coverage([column.name for column in ready.player.columns], drawn.covered)


def corners_met(ready: Ready, drawn: Totals) -> str:
    """Share of the corners of start, friction, film and misalignment that draws met."""
    return f"{drawn.corners.bit_count()} of {2**ready.player.leading}"
