"""The benchmark of the diagnosis in words, tables and bars."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from fractions import Fraction
from typing import Any

from meso_robust.campaigns.blind.judging import EQUIVALENT
from meso_robust.campaigns.blind.labels import KINDS, PLAIN, TITLES
from meso_robust.campaigns.blind.scoring import NEAR_FLOOR
from meso_robust.campaigns.intervals import share_interval
from meso_robust.campaigns.kind import Bars, Part, Table, Told, Values, View
from meso_robust.wording import down, up

Share = Mapping[str, Any]
NOTHING = "–"
BROKEN = "The labels cannot be trusted, and nothing is scored: "
STATES = {
    "committed": "Labels: committed to before the diagnosis, and every one opened matches.",
    "stated": "Labels: as stated; there is no commitment that was made before the diagnosis.",
    "withheld": "Nothing is scored: the labels are not there yet.",
}


def tell(part: Part, values: Values) -> Told:
    """The totals as they are reported; intervals are exact."""
    done, labels = sum(values["verdicts"].values()), values["labels"]
    lost = int(values["verdicts"].get("none", 0))
    begun = f"{done} of {values['planned']} sets were diagnosed, {lost} without an answer. "
    if "scores" not in values:
        broken = labels["state"] == "broken"
        return Told(
            verdict="broken" if broken else "measured",
            answer=begun + (BROKEN + labels["why"] if broken else STATES[labels["state"]]),
            figures=(("answered", f"{done - lost} of {values['planned']}"),),
            views=(_verdicts(values["verdicts"]),),
        )
    scores = values["scores"]
    return Told(
        verdict="measured",
        answer=begun + STATES[labels["state"]],
        figures=tuple((what, _rate(part, share)) for what, share in _leading(scores)),
        views=tuple(_views(part, values)),
    )


def _leading(scores: Values) -> Iterator[tuple[str, Share]]:
    yield "false alarms where nothing is concealed", scores["nulls"]["alarms"]
    yield f"right name, one effect of ≥ {PLAIN:g}×", scores["naming"]["plain"]["right"]
    yield "wrong and confident, of all cases", scores["wrong_and_confident"]["all"]
    yield "outside the catalogue: unknown", scores["outside"]["unknown"]
    yield f"right stage, one effect of ≥ {PLAIN:g}×", scores["stage"]["plain"]
    yield "cannot be decided: says so", scores["unidentifiable"]["says_so"]


def _views(part: Part, values: Values) -> Iterator[View]:
    scores = values["scores"]
    yield _kinds(part, scores)
    yield _sizes(part, scores)
    yield _named_rightly(scores)
    yield _table(
        part,
        "Two effects, effects outside the catalogue, recordings that cannot tell",
        _hard(scores),
    )
    yield _confusion(scores)
    yield _wrong(values["ledger"])
    yield _table(part, "Right stage", scores["stage"].items())
    yield _table(
        part, "Truth inside the interval, sets named rightly", scores["parameters"].items()
    )
    yield _held_out(part, scores)


def _rate(part: Part, share: Share) -> str:
    """A share with its interval."""
    hits, count = int(share["hits"]), int(share["count"])
    if count == 0:
        return NOTHING
    low, high = share_interval(hits, count, part.confidence)
    told = f"{hits}/{count}; {down(100 * low, 0)} … {up(100 * high, 0)} %"
    return f"{down(100 * Fraction(hits, count), 1)} % ({told})"


def _number(value: float | None) -> str:
    return NOTHING if value is None else f"{value:.2f}"


def _table(part: Part, title: str, shares: Any) -> Table:
    rows = tuple((what, _rate(part, share)) for what, share in shares)
    return Table(title=title, head=("", "share"), rows=rows)


def _verdicts(verdicts: Mapping[str, int]) -> Table:
    rows = tuple((name, str(count)) for name, count in verdicts.items())
    return Table(title="Answers", head=("verdict", "sets"), rows=rows)


def _kinds(part: Part, scores: Values) -> Table:
    planned, run = scores["cases"]["planned"], scores["cases"]["run"]
    rows = tuple(
        (
            TITLES[kind],
            str(planned.get(kind, 0)),
            str(run[kind]),
            _rate(part, scores["wrong_and_confident"][kind]),
        )
        for kind in KINDS
    )
    return Table(
        title="What was concealed",
        head=("concealed", "sets", "diagnosed", "wrong and confident"),
        rows=rows,
        note="Wrong and confident: one set of effects is named, with an effect that is not there.",
    )


def _sizes(part: Part, scores: Values) -> Table:
    sizes = [(_times(row["multiple"]), row) for row in scores["naming"]["by_multiple"]]
    rows = [*sizes, (f"≥ {PLAIN:g}×", scores["naming"]["plain"])]
    keys = ("detected", "right", "in_set", "wrong")
    return Table(
        title="One effect, by size",
        head=(
            "size",
            "detected",
            "named rightly",
            "in the set",
            "wrong and confident",
            "mean sets",
        ),
        rows=tuple(
            (size, *(_rate(part, row[key]) for key in keys), _number(row["mean_sets"]))
            for size, row in rows
        ),
        note="Sizes are multiples of the just-detectable one. In the set: named, or among the sets "
        "that an ambiguous answer lists.",
    )


def _times(size: float) -> str:
    return f"{size:g}×" if size else "< 1×"


def _named_rightly(scores: Values) -> Bars:
    """Of each effect, the share of sets of all sizes that was named rightly."""
    power = scores["power"]
    shares = {
        name: sum(one["right"] for one in points) / sum(one["count"] for one in points)
        for name, points in power.items()
    }
    ranked = sorted(shares, key=lambda name: (-shares[name], name))
    alike = ", ".join(f"{one} from {other}" for one, other in EQUIVALENT.items())
    return Bars(
        title="Named rightly, by effect, all sizes",
        unit="share",
        labels=tuple(ranked),
        values=tuple(shares[name] for name in ranked),
        note=f"No motion tells {alike}: naming one counts as naming the other.",
    )


def _hard(scores: Values) -> Iterator[tuple[str, Share]]:
    yield "nothing concealed: an effect named", scores["nulls"]["named"]
    for key, what in (
        ("detected", "detected"),
        ("both", "both named, nothing else"),
        ("one", "one named, nothing else"),
        ("in_set", "among the sets answered"),
    ):
        yield f"two effects: {what}", scores["pairs"][key]
    for key, what in (
        ("detected", "detected"),
        ("unknown", "unknown"),
        ("unknown_if_detected", "unknown, of those detected"),
    ):
        yield f"outside the catalogue: {what}", scores["outside"][key]
    yield "cannot be decided: says so", scores["unidentifiable"]["says_so"]


def _confusion(scores: Values) -> Table:
    return Table(
        title="Answers by what was concealed",
        head=("concealed", "answers"),
        rows=tuple(
            (truth, ", ".join(f"{answer} {count}" for answer, count in _ranked(answers)))
            for truth, answers in sorted(scores["confusion"].items())
        ),
    )


def _ranked(counts: Mapping[str, int]) -> list[tuple[str, int]]:
    return sorted(counts.items(), key=lambda one: (-one[1], one[0]))


def _wrong(ledger: Any) -> Table:
    return Table(
        title="Wrong and confident",
        head=("set", "concealed", "size", "answer"),
        rows=tuple(
            (row["set"], row["concealed"] or "nothing", _times(row["multiple"]), row["answer"])
            for row in ledger
            if row["wrong"]
        ),
    )


def _held_out(part: Part, scores: Values) -> Table:
    return Table(
        title="Error on recordings held out, over the noise floor, after naming",
        head=(
            "sets",
            "median",
            "90 % quantile",
            f"≤ {NEAR_FLOOR:g}",
            "share of the excess removed, median",
        ),
        rows=tuple(
            (
                group,
                *(_number(held["over_floor"].get(key)) for key in ("median", "q90")),
                _rate(part, held["near_floor"]),
                _number(held["removed"].get("median")),
            )
            for group, held in scores["held_out"].items()
        ),
    )
