"""What the answers are worth: classes, rates with intervals, and every miss by its number."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from statistics import median
from typing import Any

from meso_robust.campaigns.intervals import share_interval
from meso_robust.simulator.catalogue import family_of
from reports.blind3 import beyond, fresh
from reports.blind3.cases import COMMITMENT, HERE, Case, listed
from reports.blind3.laws import FAMILIES, OUTSIDE

Values = Mapping[str, Any]
KNOWN = {**FAMILIES, **beyond.LEARNT}
"""Families that a case may conceal and the catalogue has."""
PLAIN = 4.0
"""Measured size over the just detectable one from which on a family is to be named."""
TRUE_OF_ALL = frozenset({"anisotropic_drag", "probe_compliance"})
"""Names of small wrongs that are in every set, so that telling them is not wrong: a slight lay of
the stage, and the give of the contact, which acts as that of a tip."""
SURE = frozenset({"named", "partial"})
OPENED = HERE / "opened.json"
"""Cases that were used to mend the diagnoser; they are scored apart."""
BLOCKS: Sequence[tuple[int, int, str]] = (
    (0, 72, "the diagnoser as it stood when the trial was begun"),
    (
        72,
        120,
        "corners of the tip's log between samples, friction lent to a fold, an image about its middle",
    ),
    (
        120,
        152,
        "second forms of nine more laws, and the sets that hold out of fold are asked in turn",
    ),
    (
        152,
        184,
        "a scale has a place, effects that explain alike do not stand in for one another, a share holds of other draws",
    ),
    (
        184,
        216,
        "intervals widen evenly as recordings disagree, a set must predict recordings that it was not chosen by",
    ),
    (
        216,
        376,
        "what sways at rest is no noise, second effects are tried beside more first ones",
    ),
    (
        376,
        400,
        "strong lays are searched from half way, what pulls alike is one physics, intervals leave room for the unseen",
    ),
)
"""First case, the one after the last, and what answered them: a mended diagnoser is judged by sets that
were promised after it was mended."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Scored:
    """A case, what is true of it, and what was answered."""

    case: Case
    label: Values
    answer: Values

    @property
    def size(self) -> float:
        """Smallest measured size of what is concealed, over the just detectable one."""
        return min(self.label["measured"], default=0.0)

    @property
    def names(self) -> frozenset[str]:
        """Effects that were told with confidence."""
        if self.answer["verdict"] not in SURE:
            return frozenset()
        return frozenset(self.answer["effects"])

    def has(self, family: str) -> bool:
        """Whether a family was told, by its name or one that no motion tells from it."""
        return bool(self.names & accepted(family))

    @property
    def right(self) -> bool:
        """Named or partial, with everything concealed."""
        return bool(self.names) and all(self.has(name) for name in self.case.families)

    @property
    def right_physics(self) -> bool:
        """As `right`, but another law of the same physics will do, as the catalogue has it."""
        told = {family_of(name) for name in self.names}
        there = ({family_of(one) for one in accepted(name)} for name in self.case.families)
        return bool(told) and all(told & one for one in there)

    @property
    def wrong(self) -> bool:
        """Named outright, with an effect that is not there."""
        there = TRUE_OF_ALL.union(*map(accepted, self.case.families))
        return self.answer["verdict"] == "named" and not self.names <= there

    @property
    def alarm(self) -> bool:
        """Anything but consistent."""
        return self.answer["verdict"] != "consistent"

    @property
    def small_only(self) -> bool:
        """What was told is one of the small wrongs that are there."""
        return bool(self.names) and self.names <= TRUE_OF_ALL

    @property
    def outside_as_wanted(self) -> bool:
        """Unknown or partial, put at the stage where it is."""
        laws = {**OUTSIDE, **beyond.OUTSIDE, **fresh.OUTSIDE}
        stages = {laws[name].stage for name in self.case.families}
        return self.answer["verdict"] in ("unknown", "partial") and self.answer["stage"] in stages

    @property
    def covered(self) -> list[bool]:
        """Whether the intervals of what was told rightly hold the truth."""
        found = []
        for key, value in self.label["truth"].items():
            name, parameter = key.split(".")
            told = self.answer.get("effects", {}).get(name)
            if name in self.names and told is not None:
                _, low, high = told["parameters"][parameter]
                found.append(low <= value <= high)
        return found

    @property
    def share_error(self) -> float | None:
        """Told share less the concealed part of all that is wrong, if rightly told."""
        if not self.right or not self.answer.get("explained"):
            return None
        concealed = sum(size**2 for size in self.label["measured"])
        ideal = concealed / (concealed + self.label["small"] ** 2)
        return float(self.answer["explained"]["share"] - ideal)

    @property
    def wanted(self) -> bool:
        """The answer that a case of its kind should get."""
        if self.case.kind == "null":
            return not self.alarm
        if self.case.kind == "outside":
            return self.outside_as_wanted
        return self.right and not self.wrong


def accepted(family: str) -> frozenset[str]:
    """Names of the catalogue that are right for a family."""
    known = KNOWN.get(family)
    if known is None:  # outside when it was drawn, and learnt since
        return frozenset(name for name, law in beyond.LEARNT.items() if law is OUTSIDE.get(family))
    return frozenset({family, *known.alike})


def scored_cases(answers: Iterable[Values]) -> list[Scored]:
    """Answers with the labels of the commitment."""
    labels = json.loads(COMMITMENT.read_text(encoding="utf-8"))["sets"]
    cases = {case.id: case for case in listed()}
    return [
        Scored(case=cases[one["id"]], label=labels[f"{one['id']:03d}"], answer=one)
        for one in sorted(answers, key=lambda one: int(one["id"]))
    ]


def rate(hits: Sequence[bool]) -> str:
    """Count, share and 95 % interval."""
    if not hits:
        return "0 of 0"
    low, high = share_interval(sum(hits), len(hits))
    share = 100 * sum(hits) / len(hits)
    return f"{sum(hits)} of {len(hits)}, {share:.0f} % [{100 * low:.0f}, {100 * high:.0f}]"


def _rows(scored: Sequence[Scored]) -> list[tuple[str, str, str]]:
    def of(kind: str, least: float = 0.0) -> list[Scored]:
        return [one for one in scored if one.case.kind == kind and one.size >= least]

    plain, pairs, outside = of("single", PLAIN), of("pair", PLAIN), of("outside", PLAIN)
    errors = [e for one in scored if (e := one.share_error) is not None]
    return [
        ("right family, named or partial, ≥ 4×", "≥ 85 %", rate([o.right for o in plain])),
        (
            "the same, or another law of the same physics (`simulator.catalogue.FAMILIES`)",
            "",
            rate([o.right_physics for o in plain]),
        ),
        ("right family, < 4×", "", rate([o.right for o in of("single") if o.size < PLAIN])),
        ("wrong and confident, all cases", "≤ 2 %", rate([o.wrong for o in scored])),
        ("nulls consistent", "≥ 95 %", rate([not o.alarm for o in of("null")])),
        (
            "nulls consistent, or one of their small wrongs told",
            "",
            rate([not o.alarm or o.small_only for o in of("null")]),
        ),
        (
            "outside the catalogue, ≥ 4×: unknown or partial at the right stage",
            "≥ 80 %",
            rate([o.outside_as_wanted for o in outside]),
        ),
        ("pairs, both ≥ 4×: both told", "≥ 75 %", rate([o.right for o in pairs])),
        (
            "the same, or other laws of the same physics",
            "",
            rate([o.right_physics for o in pairs]),
        ),
        (
            "pairs, both ≥ 4×: at least one told",
            "",
            rate([any(o.has(name) for name in o.case.families) for o in pairs]),
        ),
        (
            "90 % intervals that hold the truth",
            "85 … 95 %",
            rate([hit for one in scored for hit in one.covered]),
        ),
        (
            "out-of-fold share within 10 points of the concealed part",
            "",
            rate([abs(error) <= 0.1 for error in errors]),
        ),
        ("no answer (a crash or a refusal)", "0", rate([_crashed(one) for one in scored])),
    ]


def _crashed(one: Scored) -> bool:
    return bool(one.answer["verdict"] == "none")


def _missed(one: Scored) -> str:
    told = ", ".join(one.answer.get("effects", {})) or "–"
    why = str(one.answer.get("error") or one.answer.get("why", "")).replace("|", "/")
    hidden = ", ".join(
        f"{name} {size:.1f}×"
        for name, size in zip(one.case.families, one.label["measured"], strict=True)
    )
    stage = one.answer.get("stage") or "–"
    share = (one.answer.get("explained") or {}).get("share")
    percent = "–" if share is None else f"{100 * share:.0f}"
    return (
        f"| {one.case.id} | {one.case.kind} | {hidden or '–'} | {one.answer['verdict']} | {told} "
        f"| {stage} | {percent} | {why} |\n"
    )


def page(scored: Sequence[Scored]) -> str:
    """All blocks that have answers, the latest first, in Markdown."""
    parts = []
    for first, end, what in reversed(BLOCKS):
        own = [one for one in scored if first <= one.case.id < end]
        if own:
            last = max(one.case.id for one in own)
            parts.append(f"Cases {first} to {last}: {what}.\n\n{results_text(own)}")
    return "\n".join(parts)


def results_text(scored: Sequence[Scored], opened: frozenset[int] | None = None) -> str:
    """The results of one block, in Markdown."""
    if opened is None:
        opened = frozenset(json.loads(OPENED.read_text("utf-8")) if OPENED.exists() else ())
    blind = [one for one in scored if one.case.id not in opened]
    text = f"# Results of {len(blind)} cases\n\n"
    text += "Shares with their 95 % intervals.\n\n| | to reach | reached |\n|---|---|---|\n"
    text += "".join("| " + " | ".join(row) + " |\n" for row in _rows(blind))
    if blind:
        seconds = [one.answer["seconds"] for one in blind]
        cpu = [one.answer["cpu_seconds"] for one in blind]
        text += (
            f"\nTime of a case on a busy machine: median {median(seconds):.0f} s of the wall, "
            f"{median(cpu):.0f} s of a processor; longest {max(seconds):.0f} s and {max(cpu):.0f} s.\n"
        )
    text += "\n## Misses\n\n"
    head = "| case | kind | concealed | verdict | told | stage | explains, % | why |\n"
    head += "|---:|---|---|---|---|---|---:|---|\n"
    misses = "".join(_missed(one) for one in blind if not one.wanted)
    text += head + misses if misses else "None.\n"
    opened &= {one.case.id for one in scored}
    if opened:
        text += "\n## Opened cases\n\nUsed to mend the diagnoser, and not counted above.\n\n" + head
        text += "".join(_missed(one) for one in scored if one.case.id in opened)
    return text
