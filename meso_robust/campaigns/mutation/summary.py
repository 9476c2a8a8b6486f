"""A campaign of tampered certificates in words and tables."""

from __future__ import annotations

from collections.abc import Mapping

from meso_robust.campaigns.intervals import ends_told, share_interval
from meso_robust.campaigns.kind import Bars, Part, Table, Told, Values
from meso_robust.campaigns.mutation.answer import ACCEPTED, MALFORMED, REJECTED

UNTRUE = "accepted, though it claims something untrue"
LISTED = 40
"""Objections that are listed."""
WORDS = (MALFORMED, REJECTED, "NOTHING CLAIMED", "MARGIN UNDECIDED", "WITNESS UNDECIDED", *ACCEPTED)


def tell(part: Part, values: Values) -> Told:
    """The totals as they are reported."""
    runs, missed = int(values["runs"]), int(values["missed"])
    if not runs:
        return Told(verdict="measured", answer="No chunk was done.", figures=(), views=())
    rejected = runs - sum(int(values["answers"].get(word, 0)) for word in ACCEPTED)
    return Told(
        verdict="broken" if missed else "held",
        answer=(
            f"Of {runs:,} tampered certificates the checker did not accept {rejected:,}; of the "
            f"others {missed:,} claim something untrue."
        ),
        figures=(
            (UNTRUE, f"{missed:,} of {runs:,}"),
            (f"share of them, {100 * part.confidence:g} % interval", _share(part, missed, runs)),
            ("things changed at once", str(part.asked["changes"])),
        ),
        views=(
            _counts("answer", "The checker's answers", values["answers"]),
            _by_change(values["changes"]),
            _counts("why it is true", "Accepted: why they are true", values["excuses"]),
            _objections(values["objections"]),
        ),
    )


def _share(part: Part, missed: int, runs: int) -> str:
    return " … ".join(ends_told(*share_interval(missed, runs, part.confidence)))


def _ranked(counts: Mapping[str, int]) -> list[tuple[str, int]]:
    return sorted(counts.items(), key=lambda one: (-one[1], one[0]))


def _counts(what: str, title: str, counts: Mapping[str, int]) -> Table:
    rows = tuple((name, f"{number:,}") for name, number in _ranked(counts))
    return Table(title=title, head=(what, "certificates"), rows=rows)


def _by_change(changes: Mapping[str, Mapping[str, int]]) -> Table:
    return Table(
        title="Answers by what was changed",
        head=("changed", *WORDS),
        rows=tuple(
            (name, *(f"{answers.get(word, 0):,}" for word in WORDS))
            for name, answers in sorted(changes.items())
        ),
        note="With several changes at once a certificate stands in several rows.",
    )


def _objections(counts: Mapping[str, int]) -> Bars:
    listed = _ranked(counts)[:LISTED]
    left = len(counts) - len(listed)
    return Bars(
        title="What the rejected were rejected for",
        unit="certificates",
        labels=tuple(name for name, _ in listed),
        values=tuple(float(number) for _, number in listed),
        note=f"{left} rarer objections are not shown." if left else "",
    )
