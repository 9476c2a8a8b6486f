"""How a fitted model stands to the premises: every parameter and every effect, over its interval."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Literal

from meso_robust.certificates.premise import Premise, premise_of
from meso_robust.certificates.words import PREMISES
from meso_robust.identification.document import (
    ModelDocument,
    ParameterSection,
    ProbeSection,
    QualitySection,
)
from meso_robust.planning.remedy import Remedy
from meso_robust.primitives.names import Named, about
from meso_robust.simulator.catalogue import CATALOGUE
from meso_robust.simulator.stage import FORM
from meso_robust.task import Task
from meso_robust.transfer.inflation import Absorbed, Budget, Ends, Ranges
from meso_robust.transfer.lines import BASE, BASES, GROUND_WORDS, LINES, Ground, Line
from meso_robust.wording import down_to, up_to

Word = Literal["absorbed", "off", "breaks a premise", "not identified"]
BREAKS: Word = "breaks a premise"
RATIO, FRICTION = "rho_um2", "mu"
"""Parameters of the base model that become ranges of the task."""
ROUND_TIPS = "round tips"
"""What the radius that the recordings state is called."""
OFF: Ends = (0.0, 0.0)
_SETTLED = (None, "consistent", "named")

_OF_PARAMETER = {
    RATIO: Line(
        premise=Premise.ERRORS_BOUNDED,
        claim="eq-5-ratio",
        derivation="derivations/one_point_sticking.py",
        why="the certificate needs bounds of ρ",
    ),
    FRICTION: Line(
        premise=Premise.ERRORS_BOUNDED,
        claim="sticking-arc",
        derivation="derivations/one_point_sticking.py",
        why="the certificate needs bounds of μ",
    ),
}


@dataclass(frozen=True, slots=True, kw_only=True)
class Standing:
    """A parameter of the base, the base itself, or an effect, and the promise."""

    name: str
    word: Word
    premise: Premise | Ground | None = None
    claim: str = ""
    derivation: str = ""
    said: str = ""
    """How it is absorbed, or why it is not."""
    absorbed: Absorbed | None = None
    settled_by: Named | None = None
    """What would settle it, if the laboratory being without it is not all."""

    @property
    def premise_words(self) -> str:
        """The premise as a sentence; empty if none is concerned."""
        if self.premise is None:
            return ""
        return (
            GROUND_WORDS[self.premise]
            if isinstance(self.premise, Ground)
            else PREMISES[self.premise]
        )

    @property
    def survives(self) -> bool:
        """Whether the promise can be made in spite of it."""
        return self.word in ("absorbed", "off")


def standings(document: ModelDocument, budget: Budget) -> tuple[Standing, ...]:
    """Everything that the model says, in the order of its file."""
    base, *effects = document.model.split("+")
    return (
        *([] if document.diagnosis in _SETTLED else [_open(document.diagnosis)]),
        *([_rejected(document.quality)] if document.quality and document.quality.rejected else []),
        *([] if base == BASE else [_of_base(base)]),
        *([_round(document.probe)] if document.probe and document.probe.tip_radius_um else []),
        *(_of_parameter(document, key) for key in (RATIO, FRICTION) if base == BASE),
        *(_of_effect(document, effect, budget) for effect in effects),
    )


def lent(document: ModelDocument, task: Task) -> tuple[ModelDocument, str]:
    """The model with the ends of µ that its recordings leave open taken from the task, and which these are.

    A push that never slips bounds µ from below alone, and a single one that slips bounds it only as far as
    nothing else was wrong with it. The task states a range of its own: where the recordings do not
    contradict it, that is the premise that it was before them.

    Parameters
    ----------
    document
        A fitted model.
    task
        As the user stated it.

    Returns
    -------
    ModelDocument
        As it was, if µ is open on no side, or is beyond what the task states.
    str
        What µ is then, in words; empty if the model is as it was.
    """
    of = document.parameters.get(FRICTION)
    if of is None or not (of.open_low or of.open_high) or document.interval == "last simplex":
        return document, ""
    stated = task.uncertainty.friction
    low = stated[0] if of.open_low else of.low
    high = stated[1] if of.open_high else of.high
    unlike = of.open_low and of.open_high and not low <= of.value <= high
    if low > high or unlike:
        return document, ""
    ends = {"low": low, "high": high, "open_low": False, "open_high": False}
    section = of.model_copy(update={**ends, "value": min(max(of.value, low), high)})
    made = document.model_copy(
        update={
            "parameters": {**document.parameters, FRICTION: section},
            "not_identifiable": tuple(
                one for one in document.not_identifiable if one.name != FRICTION
            ),
        }
    )
    if of.open_low and of.open_high:
        lent_words = "as the task states it: the recordings agree with it, and do not bound it"
    else:
        side = "lower" if of.open_low else "upper"
        lent_words = f"the {side} end as the task states it: the recordings do not bound it"
    return made, f"a range of the task: {down_to(low, 6)} … {up_to(high, 6)}, {lent_words}"


def _open(verdict: str | None) -> Standing:
    """A diagnosis that has not ended with one model: nothing is promised on its ground."""
    said = {
        "unknown": "something is missing in the model that no effect explains: diagnosis.json says "
        "where",
        "partial": "the model explains a part of what was missing only: diagnosis.json says how much is "
        "left",
        "ambiguous": "several models explain the recordings equally well: diagnosis.json lists them",
    }
    return Standing(
        name="diagnosis",
        word=BREAKS,
        premise=Ground.ONE_MODEL,
        said=said[verdict or "unknown"],
        settled_by=about(Remedy.NEXT_PUSH),
    )


def _rejected(quality: QualitySection) -> Standing:
    """A model that its own recordings reject: its intervals hold for no laboratory."""
    return Standing(
        name="fit",
        word=BREAKS,
        premise=Ground.ONE_MODEL,
        said=f"the recordings reject the model: χ² = {quality.chi2:,.0f} on {quality.freedom:,} degrees "
        "of freedom",
        settled_by=about(Remedy.DIAGNOSE),
    )


def _round(probe: ProbeSection) -> Standing:
    """Tips that are not points: what the recordings were made with is what the proof is about."""
    radius = probe.tip_radius_um
    said = f"the recordings state tips of {radius:g} um radius"
    return _standing(
        ROUND_TIPS, "absorbed", LINES["tip_radius"], said, Absorbed(said=said, radius_um=(0.0, 0.0))
    )


def unknown(document: ModelDocument, key: str) -> str:
    """Why a parameter has no interval; empty if it has one."""
    if key in document.held:
        return f"{key} was held at {document.held[key]:g}, not fitted: the recordings say nothing of it"
    of = next((one.why for one in document.not_identifiable if one.name == key), "")
    if of:
        return f"{key} is not identifiable: {of}"
    section = document.parameters[key]
    if section.open_low or section.open_high:
        side = " and ".join(
            word
            for word, is_open in (("lower", section.open_low), ("upper", section.open_high))
            if is_open
        )
        return f"the recordings give {key} no {side} bound"
    if document.interval == "last simplex":
        return (
            f"{key} has the ends of the last simplex only, which bound nothing: fit the likelihood "
            "(`meso-robust identify`)"
        )
    return ""


def ends(section: ParameterSection) -> Ends:
    """The interval of a parameter, in the unit of its name."""
    return section.low, section.high


def _of_base(base: str) -> Standing:
    return _broken(base, BASES.get(base))


def _of_parameter(document: ModelDocument, key: str) -> Standing:
    why, line = unknown(document, key), _OF_PARAMETER[key]
    if why:
        return _standing(key, "not identified", line, why)
    low, high = ends(document.parameters[key])
    return _standing(
        key, "absorbed", line, f"a range of the task: {down_to(low, 6)} … {up_to(high, 6)}"
    )


def _of_effect(document: ModelDocument, effect: str, budget: Budget) -> Standing:
    line = LINES.get(effect)
    placed = () if line is None else line.placed
    ranges, why = _ranges(document, effect), _unbounded(document, effect, placed)
    sizes = [one.key for one in CATALOGUE[effect].parameters if one.size]
    if not why and all(ranges[key] == OFF for key in sizes):
        return Standing(name=effect, word="off", said="no size but zero is left")
    if line is None or line.absorb is None:
        return _broken(effect, line, _size(effect, ranges))
    if (
        ranges.get(FORM, OFF) != OFF and not line.any_form
    ):  # the bounds are derived of the first form of a law
        return _broken(effect, line, ", by another form of the law: " + _form(effect, ranges))
    if line.rectangle and not budget.rectangle:
        return _broken(effect, line, ", and it is bounded for a rectangle only")
    if line.even and not budget.slender:
        return _broken(effect, line, ", and the film is not even but for it")
    found = line.absorb(ranges, budget)
    if found is None:
        return _broken(effect, line, ", and of this size nothing bounds it")
    if budget.capped and found.more_drag:
        return _broken(
            effect, line, ", and the cap on contact forces is by the drag of the film alone"
        )
    if why and found != line.absorb(_anything(effect), budget):
        return _standing(effect, "not identified", line, why)
    return _standing(effect, "absorbed", line, f"{line.why}: {found.said}", found)


def _unbounded(document: ModelDocument, effect: str, placed: Sequence[str]) -> str:
    """Why a parameter has no interval: one that was fitted, a size that was held, or a place that was not fitted."""
    keys = {f"{effect}.{one.key}": one.size for one in CATALOGUE[effect].parameters}
    held = [key for key, size in keys.items() if size and document.held.get(key, 0.0) != 0.0]
    held += [f"{effect}.{one}" for one in placed if f"{effect}.{one}" in document.held]
    fitted = [key for key in keys if key in document.parameters]
    nowhere = [one for one in placed if f"{effect}.{one}" not in {*document.held, *fitted}]
    if nowhere:
        return f"{effect}.{nowhere[0]} was not fitted"
    return next((why for key in [*held, *fitted] if (why := unknown(document, key))), "")


def _anything(effect: str) -> Ranges:
    """Intervals that no bound survives: an effect that is absorbed over them needs none."""
    return {one.key: (-1e30, 1e30) for one in CATALOGUE[effect].parameters}


def _ranges(document: ModelDocument, effect: str) -> Ranges:
    found: dict[str, Ends] = {}
    for one in CATALOGUE[effect].parameters:
        key = f"{effect}.{one.key}"
        fitted, held = document.parameters.get(key), document.held.get(key, one.shown(one.default))
        found[one.key] = (held, held) if fitted is None else ends(fitted)
    return found


def _size(effect: str, ranges: Ranges) -> str:
    """How large the model says that an effect is, in words."""
    sizes = [one for one in CATALOGUE[effect].parameters if one.size]
    told = (
        f"{one.key} {down_to(ranges[one.key][0], 3)} … {up_to(ranges[one.key][1], 3)} {one.unit}".rstrip()
        for one in sizes
    )
    return f" ({', '.join(told)})"


def _form(effect: str, ranges: Ranges) -> str:
    """The form of its law in words."""
    return CATALOGUE[effect].forms[int(ranges[FORM][0])]


def _broken(name: str, line: Line | None, size: str = "") -> Standing:
    if line is None:
        return Standing(
            name=name, word=BREAKS, premise=Ground.A_LINE, said=GROUND_WORDS[Ground.A_LINE]
        )
    return _standing(name, BREAKS, line, line.why + size)


def _standing(
    name: str,
    word: Word,
    line: Line,
    said: str,
    absorbed: Absorbed | None = None,
    settled_by: Named | None = None,
) -> Standing:
    return Standing(
        name=name,
        word=word,
        premise=line.premise,
        claim=line.claim,
        derivation=line.derivation,
        said=said,
        absorbed=absorbed,
        settled_by=settled_by,
    )


def in_place(known: Standing, task: Task, *, held: bool) -> Standing:
    """A standing by the premises that a task's certificate has.

    Parameters
    ----------
    known
        By the premises of point tips and exact parts.
    task
        The task as the model says it is.
    held
        Whether a passive tip holds the part in some move: then no probe may drift.
    """
    if isinstance(known.premise, Premise):
        known = replace(known, premise=premise_of(task, known.premise))
    if held and known.absorbed is not None and known.absorbed.drift_um_s:
        return replace(known, word=BREAKS, absorbed=None, said=LINES[known.name].why)
    return known


def remedy(broken: Standing) -> Named:
    """What would settle something that the promise does not survive."""
    if broken.settled_by is not None:
        return broken.settled_by
    if broken.word != BREAKS:
        return about(Remedy.BOUND_EFFECT)
    return about(Remedy.WITHOUT_EFFECT, effect=broken.name, claim=broken.claim)


def by_name(found: tuple[Standing, ...]) -> Mapping[str, Standing]:
    """Standings by the name of parameter or effect."""
    return {one.name: one for one in found}
