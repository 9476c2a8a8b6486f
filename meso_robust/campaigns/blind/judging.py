"""One case of a blind benchmark: what was concealed against what was answered."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from meso_robust.campaigns.blind.labels import SILENT, SIZES, STAGE

Values = Mapping[str, Any]
Names = frozenset[str]

EQUIVALENT: Mapping[str, str] = {"film_flow": "body_force"}
"""Effects that no motion tells from another, declared before any case is scored.

A film that flows at v_f drags with E v_f; a force e_x v_f does the same on every part at every
instant, since the drag is linear and the film's translational drag is the same in all directions.
"""

SPANS: Mapping[tuple[str, str], float] = {
    ("anisotropic_drag", "direction_deg"): 180.0,
    ("part_anisotropic_drag", "direction_deg"): 180.0,
    ("wall_capillarity", "direction_deg"): 360.0,
}
"""Parameters that are angles: values this far apart are the same."""

ROUNDED = 1.0 + 1e-6

TURNED = frozenset({"anisotropic_drag", "part_anisotropic_drag"})
"""Effects whose fraction may change its sign if their direction turns by 90 deg."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Judged:
    """A case whose label has been opened, against what was answered."""

    index: int
    kind: str
    names: tuple[str, ...]
    """What was concealed."""
    multiple: float
    """See `size_of`; 0 if nothing was concealed."""
    truth: Names
    """The same as `names`, equivalent effects under one name."""
    stages: Names
    """Stages of what was concealed."""
    verdict: str
    """That of the document, or ``none`` if there was no answer."""
    best: Names
    """What the document says is there; empty unless named or ambiguous."""
    answers: tuple[Names, ...]
    """`best` and the sets it is said to be ambiguous with, each once."""
    not_identifiable: Names
    stage: str
    """Where the mismatch was put; empty if nowhere."""
    claims: tuple[tuple[float, bool], ...]
    """Probability of every effect said to be there, and whether it is."""
    covered: tuple[tuple[str, bool], ...]
    """Parameters of a set named rightly, and whether their intervals hold the truth."""
    floor_ratio: float | None
    """Held-out error over the noise floor; None unless named."""
    removed: float | None
    """Share of the held-out error above the noise floor that the named effects removed."""
    seconds: float | None
    """How long the answer took, if that was measured."""

    @property
    def silent(self) -> bool:
        """Whatever is concealed, no motion can show it."""
        return bool(self.truth) and self.truth <= SILENT

    @property
    def detected(self) -> bool:
        """Something beyond the plain model was reported."""
        return self.verdict in {"named", "ambiguous", "unknown"}

    @property
    def named(self) -> bool:
        """One set of effects was answered, but for effects that no motion tells apart."""
        return len(self.answers) == 1

    @property
    def right(self) -> bool:
        """Named, and exactly."""
        return self.named and self.best == self.truth

    @property
    def in_set(self) -> bool:
        """The truth is among the sets that were answered."""
        return self.truth in self.answers

    @property
    def confident_and_wrong(self) -> bool:
        """Named with an effect that is not there."""
        return self.named and not self.best <= self.truth

    @property
    def says_so(self) -> bool:
        """Admitted that these recordings cannot tell: several sets, or listed as not seen."""
        if self.verdict == "ambiguous":
            return self.in_set
        return self.verdict != "named" and bool(self.truth & self.not_identifiable)

    @property
    def as_wanted(self) -> bool:
        """The answer that a case of its kind should get."""
        wanted = {
            "null": self.verdict == "consistent",
            "outside": self.verdict == "unknown",
            "unidentifiable": self.says_so,
        }
        return wanted.get(self.kind, self.says_so if self.silent else self.right)

    @property
    def stage_right(self) -> bool:
        """The mismatch was put at a stage where something was concealed."""
        return self.stage in self.stages


def canonical(names: Iterable[str]) -> Names:
    """A set of effects, each under the name that stands for its equivalents."""
    return frozenset(EQUIVALENT.get(name, name) for name in names)


def judged(index: int, label: Values, result: Values) -> Judged:
    """One case.

    Parameters
    ----------
    index
        Of the case.
    label
        As sealed: kind, names, and in ``truth`` what the generator tells.
    result
        ``document``: the diagnosis, or at least what is judged of it; none if there is no answer.
        ``seconds``: how long it took, if known.
    """
    document = result.get("document", {})
    verdict = document.get("verdict", "none")
    positive = verdict in {"named", "ambiguous"}
    effects = document.get("effects", []) if positive else []
    best = canonical(effect["name"] for effect in effects)
    others = document.get("ambiguous_with", []) if positive else []
    truth = canonical(label["names"])
    answers = tuple(dict.fromkeys((best, *map(canonical, others)))) if positive else ()
    named = len(answers) == 1
    return Judged(
        index=index,
        kind=label["kind"],
        names=tuple(label["names"]),
        multiple=size_of(label),
        truth=truth,
        stages=stages_of(label),
        verdict=verdict,
        best=best,
        answers=answers,
        not_identifiable=canonical(document.get("not_identifiable", [])),
        stage=_stage(document, effects),
        claims=tuple(
            (effect["probability"], canonical([effect["name"]]) <= truth) for effect in effects
        ),
        covered=tuple(coverage(label, effects)) if named and best == truth else (),
        **_held_out(document if named else {}),
        seconds=result.get("seconds"),
    )


def stages_of(label: Values) -> Names:
    """Stages of what is concealed; of what is not in the catalogue, as the generator tells."""
    told = zip(label["names"], label["truth"]["stages"], strict=True)
    return frozenset(STAGE.get(name, stage) for name, stage in told)


def size_of(label: Values) -> float:
    """The smallest effect over its just-detectable size, rounded down to a size of the corpus.

    An effect that has a largest size that makes sense may be smaller than was asked for.
    """
    smallest = min(label["truth"]["multiples"], default=0.0)
    return max((size for size in SIZES if size <= ROUNDED * smallest), default=0.0)


def _stage(document: Values, effects: Sequence[Values]) -> str:
    """That of the likeliest effect, else that of the largest span."""
    if effects:
        likeliest = max(effects, key=lambda effect: float(effect["probability"]))
        return STAGE.get(likeliest["name"], "")
    spans = document["mismatch"]["where"] if document.get("verdict") == "unknown" else []
    return str(spans[0]["channel"]) if spans else ""


def _held_out(document: Values) -> dict[str, float | None]:
    held = document.get("held_out")
    if not held or not held["recordings"]:
        return {"floor_ratio": None, "removed": None}
    floor, before, after = (
        float(held[f"{name}_sigma"]) for name in ("noise_floor", "baseline", "extended")
    )
    return {
        "floor_ratio": after / floor,
        "removed": (before - after) / (before - floor) if before > floor else None,
    }


def coverage(label: Values, effects: Iterable[Values]) -> Iterator[tuple[str, bool]]:
    """Which intervals hold the truth, of the parameters that label and document share."""
    truths = dict(zip(label["names"], label["truth"]["parameters"], strict=True))
    for effect in effects:
        truth = truths.get(effect["name"])
        if truth is None:
            continue
        told = effect["parameters"]
        for key, value in aligned(effect["name"], truth, told).items():
            if key in told:
                inside = told[key]["low"] <= value <= told[key]["high"]
                yield f"{effect['name']}.{key}", bool(inside)


def aligned(name: str, truth: Mapping[str, float], told: Mapping[str, Values]) -> dict[str, float]:
    """The same truth in the numbers nearest to those reported: angles wrap around."""
    values = dict(truth)
    both = {"fraction", "direction_deg"} <= values.keys() & told.keys()
    if name in TURNED and both and values["fraction"] * told["fraction"]["value"] < 0:
        values |= {"fraction": -values["fraction"], "direction_deg": values["direction_deg"] + 90}
    for (effect, key), span in SPANS.items():
        if effect == name and key in told and key in values:
            turns = round((told[key]["value"] - values[key]) / span)
            values[key] += span * turns
    return values
