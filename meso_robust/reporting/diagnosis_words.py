"""A diagnosis in words: the answer in one sentence, and in a few lines for a terminal."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Literal

from meso_robust.diagnosis.document import (
    SWAY_SHARE,
    DiagnosisDocument,
    EffectSection,
    HeldOutSection,
    ValueSection,
    Verdict,
    WhereSection,
)
from meso_robust.reporting.pages import Colour
from meso_robust.reporting.words import number, signed, significant
from meso_robust.simulator.catalogue import CATALOGUE
from meso_robust.simulator.stage import FORM
from meso_robust.wording import counted, down, down_to, up, up_to

MOST_SPANS = 3
"""Spans that the lines for a terminal name."""


@dataclass(frozen=True, slots=True)
class Look:
    """How a verdict is shown."""

    colour: Colour
    """Class of the page's head."""
    meaning: str


LOOKS: dict[Verdict, Look] = {
    "consistent": Look(
        "PROVED", "Nothing beyond the refitted plain model is supported by these recordings."
    ),
    "named": Look("NEUTRAL", "What the plain model leaves out was found, named and modelled."),
    "partial": Look(
        "UNKNOWN",
        "Part of what the plain model leaves out was found; the rest is sized and located.",
    ),
    "ambiguous": Look(
        "UNKNOWN", "Something is left out, and these recordings leave several explanations open."
    ),
    "unknown": Look(
        "REFUTED", "Something is left out, and nothing in the catalogue of effects explains it."
    ),
}
PHASES = {
    "approach": "approach",
    "one_point": "one tip",
    "two_point": "two tips",
    "retract": "retract",
    "rest": "rest",
}
COMPONENTS = {"x": "x", "y": "y", "theta": "θ"}
_MATTER_OF = {
    "support": "what the part slides on",
    "contact": "what tip and part do where they touch",
    "actuation": "where the probes really are",
    "observation": "what the camera sees or the tracker makes of it",
    "environment": "something that pulls or pushes besides the probes",
    "geometry": "the shapes of part and tips",
}
_NO_FILM = " (if that is no film, ask with --model three_point)"
_IN_WORDS = (FORM, "turned")
"""Numbers that say how an effect acts: where they were held, words say more."""
_UNITS = {"_um2": " µm²", "_um_s": " µm/s", "_um": " µm", "_deg": "°", "_ms": " ms", "_s": " s"}


_STILL = "keep the camera, the stage and the table still, and record again"


def answer(document: DiagnosisDocument) -> str:
    """What a laboratory can act on in one sentence: what is wrong, how sure, what is left, what next."""
    what = _STILL if _shakes(document) else document.next_experiment.push.what
    advice = f"; next: {what}" if what and document.verdict != "consistent" else ""
    return f"{_finding(document)}; {left_words(document)}{advice}"


def _finding(document: DiagnosisDocument) -> str:
    """What is wrong, how large, and how sure."""
    if document.verdict == "consistent":
        return parameters_words(document.baseline.parameters)
    if document.verdict == "ambiguous":
        return f"{' or '.join(sets(document))}{explained_words(document)}"
    if document.verdict in ("named", "partial"):
        same = "".join(
            f" (or, by the same motion, {set_words(one)})" for one in same_motions(document)
        )
        return f"{effects_words(document)}{same}{explained_words(document)}"
    unexplained = "no effect of the catalogue explains it"
    if _shakes(document):
        return f"{unexplained}; {_shaking(document)}"
    if matter := _matter(document):
        unexplained += f"; it is most likely a matter of {matter}"
    spans = document.mismatch.where
    return f"{unexplained}; largest in {_place(spans[0])}" if spans else unexplained


def _shakes(document: DiagnosisDocument) -> bool:
    """Whether what is left is, for the most part, what a part at rest is seen to go to and fro."""
    left, sway = document.remainder, document.noise.sway_um
    return (
        left is not None
        and sway is not None
        and left.stage == "observation"
        and sway**2 >= SWAY_SHARE * left.um**2
    )


def _shaking(document: DiagnosisDocument) -> str:
    """``the image sways by 10 µm at 2.6 Hz, with a part at rest``."""
    of = document.noise
    return (
        f"the image sways by {significant(of.sway_um or 0.0, 2)} µm at {significant(of.sway_hz or 0.0, 2)} Hz, "
        "with a part at rest"
    )


def explained_words(document: DiagnosisDocument) -> str:
    """`` explains 97 % [94, 99] of an error of 12.1 µm``; nothing where that was not asked."""
    of, whole = document.explained, document.explainable_um
    if of is None or whole is None:
        return ""
    low, high = (signed(to(100.0 * end, 0)) for to, end in ((down, of.low), (up, of.high)))
    return (
        f" explains {number(100.0 * of.share, 0)} % [{low}, {high}] of an error of "
        f"{significant(whole, 3)} µm"
    )


def left_words(document: DiagnosisDocument) -> str:
    """What is left of roll-outs beyond the noise, and where; else the held-out error."""
    left = document.remainder
    if left is None:
        return held_out_words(document)
    size = f"{significant(left.um, 2)} µm and {significant(left.deg, 2)}°"
    if document.verdict == "consistent" and document.relevant_um is not None:
        return f"predictions are off by {size}; {significant(document.relevant_um, 2)} µm matter"
    where = ""
    if left.component and left.phase:
        where = f", most of it {COMPONENTS[left.component]} with {PHASES[left.phase]}"
    if document.of_each_push:
        return f"{size} are left of a push whose friction is unknown{where}"
    return f"{size} are left unexplained{where}"


def stage_words(document: DiagnosisDocument) -> str:
    """Why windows by themselves may point to another stage than the effects; nothing if they do not."""
    named = {effect.stage for effect in document.effects}
    first = next((one.channel for one in document.channels), None)
    if first is None or not named or first in named or document.verdict == "unknown":
        return ""
    return (
        f"Windows by themselves point to {first}: within one window, a constant there changes the motion "
        f"in the same way. Over all recordings, {' and '.join(sorted(named))} explains more."
    )


def effects_words(document: DiagnosisDocument) -> str:
    """Every effect of the extended model with its parameters."""
    return "; ".join(effect_words(effect) for effect in document.effects)


def standing_words(document: DiagnosisDocument, effect: EffectSection) -> str:
    """How sure an effect is; of a set that is not enough, nothing is claimed."""
    if document.verdict == "unknown":
        return "not enough alone"
    likely, held = f"probability {probability(effect.probability)}", document.held_out
    if document.extends and held.recordings and held.improvement_low <= 0.0:
        return f"{likely} where it was fitted, left open by what was held out"
    return likely


def effect_words(effect: EffectSection) -> str:
    """``dry_friction (support): ratio 0.21 [0.18, 0.24]``.

    Parameters
    ----------
    effect
        Of a diagnosis.

    Returns
    -------
    str
        Name, stage and values with their intervals and units.
    """
    told = {
        key: one
        for key, one in effect.parameters.items()
        if key not in _IN_WORDS or one.low != one.high
    }
    parts = (parameters_words(told), *_form_words(effect))
    return f"{effect.name} ({effect.stage}): {', '.join(filter(None, parts))}"


def _form_words(effect: EffectSection) -> tuple[str, str]:
    """The form of the effect's law: nothing of the usual one, or where the recordings do not tell it."""
    number, share = (effect.parameters.get(key) for key in _IN_WORDS)
    form = CATALOGUE[effect.name].forms[int(number.value)] if number and number.value else ""
    turns = share is not None and share.low == share.high != 0.0
    shear = f"{100.0 * share.value:.0f} % of its shear taken for a turn" if share and turns else ""
    return form if form in effect.form else "", shear


def parameters_words(parameters: dict[str, ValueSection]) -> str:
    """Values with their intervals and units."""
    return ", ".join(f"{key} {value_words(key, one)}" for key, one in parameters.items())


def value_words(key: str, one: ValueSection) -> str:
    """``0.21 [0.18, 0.24] unit``; what was not fitted has no interval."""
    value, unit = plain(one.value), unit_words(key, one)
    if one.low == one.high:
        return f"{value}{unit} (fixed)"
    return f"{value} [{plain(one.low, 'down')}, {plain(one.high, 'up')}]{unit}"


def unit_words(key: str, one: ValueSection) -> str:
    """The unit that is stated, else the one that the key ends in, else nothing."""
    if one.unit:
        return f" {one.unit}"
    return next((unit for end, unit in _UNITS.items() if key.endswith(end)), "")


def plain(value: float, to: Literal["nearest", "down", "up"] = "nearest") -> str:
    """Three digits, or all before the point; an exponent where that would be too long.

    The ends of an interval are rounded ``down`` and ``up``.
    """
    whole = 1e3 <= abs(value) < 1e7
    if to == "nearest":
        return number(value, 0) if whole else significant(value, 3)
    fixed, digits = (down, down_to) if to == "down" else (up, up_to)
    return signed(fixed(value, 0) if whole else digits(value, 3))


def probability(value: float) -> str:
    """Two digits, and never a zero or a one that is none."""
    if value == 0.0 or value >= 0.001:
        return significant(value, 2) if value < 0.995 or value == 1.0 else "> 0.99"
    return "< 0.001"


def held_out_words(document: DiagnosisDocument) -> str:
    """``held-out error 4.1 → 1.05 σ``."""
    held = document.held_out
    if not held.recordings:
        return "no recording was held out"
    before, after = (significant(v, 3) for v in (held.baseline_sigma, held.extended_sigma))
    return f"held-out error {f'{before} → {after}' if document.extends else before} σ"


def sets(document: DiagnosisDocument) -> list[str]:
    """The sets of effects that remain possible, the best one first."""
    best = tuple(effect.name for effect in document.effects)
    return [set_words(names) for names in (best, *document.ambiguous_with) if names]


def set_words(names: Iterable[str]) -> str:
    """``body_force + backlash``; the plain model has none."""
    return " + ".join(names) or "plain model"


def _place(span: WhereSection, stage: str = "") -> str:
    time = f"{span.start_s:.2f}–{span.end_s:.2f} s"
    what = f"{stage}{COMPONENTS[span.component]}, {significant(span.sigma, 3)} σ"
    grows = f", grows with {span.grows_with}" if span.grows_with else ""
    return f"{span.recording} at {time} ({PHASES[span.phase]}): {what}{grows}"


def summary(document: DiagnosisDocument) -> str:
    """The answer in a few lines: verdict, effects, where, held-out errors.

    Parameters
    ----------
    document
        The diagnosis.

    Returns
    -------
    str
        Lines for a terminal.
    """
    return "\n".join(
        [
            f"{document.verdict.upper()}: {document.why}",
            *_effect_lines(document),
            *_where_lines(document),
            *_held_out_lines(document),
            *_next_lines(document),
        ]
    )


def _effect_lines(document: DiagnosisDocument) -> list[str]:
    lines = [
        f"  {effect_words(effect)}, {standing_words(document, effect)}"
        for effect in document.effects
    ]
    if document.verdict == "unknown" and (matter := _matter(document)):
        lines.append(f"  most likely a matter of {matter}")
    lines += [f"  or, by the same motion: {set_words(names)}" for names in same_motions(document)]
    return lines + [f"  or: {set_words(names)}" for names in document.ambiguous_with]


def same_motions(document: DiagnosisDocument) -> list[tuple[str, ...]]:
    """Sets as large as the one that is given that make the same motion, and that no recording tells apart."""
    given = tuple(sorted(effect.name for effect in document.effects))
    return [
        one.effects
        for one in document.candidates
        if document.extends
        and one.instead == given
        and len(one.effects) == len(given)
        and one.effects not in document.ambiguous_with
    ]


def _matter(document: DiagnosisDocument) -> str:
    """What is left unexplained may be wrong with, if that is known."""
    left = document.remainder
    if left is None or left.stage is None:
        return ""
    dry = left.stage == "support" and document.baseline.model == "viscous"
    return _MATTER_OF[left.stage] + (_NO_FILM if dry else "")


def _where_lines(document: DiagnosisDocument) -> list[str]:
    spans = document.mismatch.where
    # what a window by itself looks like is worth telling where nothing else says of which stage it is
    lines = [
        f"  where: {_place(span, '' if document.effects else f'{span.channel}, ')}"
        for span in spans[:MOST_SPANS]
    ]
    more = len(spans) - MOST_SPANS
    return [*lines, f"  and {counted(more, 'more span')}"] if more > 0 else lines


def noise_words(held: HeldOutSection) -> str:
    """The noise that held-out errors are measured by, in σ, and what of it is no systematic error."""
    whole = f"noise {significant(held.noise_floor_sigma, 3)} σ"
    if held.repeatability_sigma is None:
        return whole
    return f"{whole}, of it repeatability {significant(held.repeatability_sigma, 3)} σ"


def _held_out_lines(document: DiagnosisDocument) -> list[str]:
    held = document.held_out
    lines = [f"  {held_out_words(document)} ({noise_words(held)})"]
    if document.extends and held.recordings:
        low, high = down(100.0 * held.improvement_low, 0), up(100.0 * held.improvement_high, 0)
        lines[0] += (
            f", {held.baseline_um:.2f} → {held.extended_um:.2f} µm, falls by {signed(low)}–{signed(high)} %"
        )
    before, after = held.extrapolation_baseline_sigma, held.extrapolation_extended_sigma
    if before is not None and after is not None:
        errors = f"{significant(before, 3)} → {significant(after, 3)} σ"
        lines.append(f"  extrapolation ({held.extrapolation}): {errors}")
    return lines


def _next_lines(document: DiagnosisDocument) -> list[str]:
    why, what = document.next_experiment.why, document.next_experiment.push.what
    return [f"  next: {what or why}"] if what or why else []
