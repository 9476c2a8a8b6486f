"""The totals of a part of this kind, in words and tables."""

from __future__ import annotations

from decimal import ROUND_CEILING
from typing import Any

from meso_robust.campaigns.intervals import percent
from meso_robust.campaigns.kind import Part, Table, Told, Values
from meso_robust.campaigns.property.registry import PROPERTIES

NOTE = (
    "Examples are drawn independently from the distribution that a property's generator has (uniform over "
    "each range, or at one of its ends); the bound is on the probability that such an example breaks the "
    "property, not on anything a laboratory does. The first example of a chunk is always the simplest one "
    "and does not count for it, nor do examples that the property says nothing of. The search of a chunk "
    "ends at its first failing example."
)


def bound(examples: int, confidence: float) -> float:
    """One-sided upper bound of the probability of a failure, none seen in so many examples.

    Examples
    --------
    >>> round(bound(3000, 0.95), 5)
    0.001
    """
    return 1.0 if examples <= 0 else -float((1.0 - confidence) ** (1.0 / examples) - 1.0)


def spoken(count: Values) -> int:
    """Independent examples that the property says something of, at least."""
    silent = sum(count["silent"].values())
    return max(int(count["examples"]) - int(count["chunks"]) - silent, 0)


def tell(part: Part, totals: Values) -> Told:
    """Whether every property held, and how hard that was tried."""
    counts: dict[str, Any] = {
        name: count for name, count in totals["properties"].items() if count["chunks"]
    }
    examples = sum(count["examples"] for count in counts.values())
    if not examples:
        return Told(verdict="measured", answer="No chunk was done.", figures=(), views=())
    broken = [name for name, count in counts.items() if count["failed"]]
    mute = [name for name, count in counts.items() if not spoken(count)]
    held = len(counts) - len({*broken, *mute})
    answer = f"{held} of {len(counts)} properties held in {examples:,} examples."
    if broken:
        answer = f"Broken: {', '.join(broken)}; {answer}"
    if mute:
        answer += f" Nothing was said by the examples of {', '.join(mute)}: take more of them."
    if len(counts) < len(totals["properties"]):
        missing = [name for name in totals["properties"] if name not in counts]
        answer += f" No chunk was done of {', '.join(missing)}."
    return Told(
        verdict="broken" if broken else "open" if mute else "held",
        answer=answer,
        figures=(
            ("properties that held", f"{held} of {len(counts)}"),
            ("examples", f"{examples:,}"),
        ),
        views=(
            _counts(counts, part.confidence),
            _statements(counts),
            *_simplest(counts),
            *_silent(counts),
        ),
    )


def _counts(counts: dict[str, Any], confidence: float) -> Table:
    sure = f"{100.0 * confidence:g} %"
    return Table(
        title="Properties",
        head=("property", "examples", "failed", f"probability of a failing example ({sure})"),
        rows=tuple(
            (
                name,
                f"{count['examples']:,}",
                f"{count['failed']:,}",
                "it has one" if count["failed"] else _below(spoken(count), confidence),
            )
            for name, count in counts.items()
        ),
        note=NOTE,
    )


def _below(examples: int, confidence: float) -> str:
    return (
        f"below {percent(bound(examples, confidence), ROUND_CEILING)}"
        if examples
        else "nothing was said"
    )


def _statements(counts: dict[str, Any]) -> Table:
    return Table(
        title="What they state",
        head=("property", "statement", "agreement"),
        rows=tuple(
            (name, PROPERTIES[name].statement, PROPERTIES[name].agreement) for name in counts
        ),
    )


def _simplest(counts: dict[str, Any]) -> tuple[Table, ...]:
    rows = tuple((name, count["simplest"]) for name, count in counts.items() if count["failed"])
    title = "Simplest failing examples"
    return (Table(title=title, head=("property", "example"), rows=rows),) if rows else ()


def _silent(counts: dict[str, Any]) -> tuple[Table, ...]:
    rows = tuple(
        (name, why, f"{number:,}", f"{100.0 * number / count['examples']:.3g} %")
        for name, count in counts.items()
        for why, number in sorted(count["silent"].items())
    )
    head = ("property", "because", "examples", "of all")
    title = "Examples that a property says nothing of"
    return (Table(title=title, head=head, rows=rows),) if rows else ()
