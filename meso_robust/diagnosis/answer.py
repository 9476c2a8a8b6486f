"""A diagnosis as documents: ``diagnosis.json``, and ``model.toml`` of the best model."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

import numpy as np

from meso_robust import __version__
from meso_robust.diagnosis.candidates import Candidate, why_not
from meso_robust.diagnosis.controls import SAME
from meso_robust.diagnosis.detect import ALARM
from meso_robust.diagnosis.diagnose import Diagnosis, diagnose
from meso_robust.diagnosis.document import SCHEMA, DiagnosisDocument
from meso_robust.diagnosis.each_push import EachPush
from meso_robust.diagnosis.folds import RollOut
from meso_robust.diagnosis.grading import Grade
from meso_robust.diagnosis.judge import NAMED, PARTIAL, SURE, Explained
from meso_robust.diagnosis.left_out import LeftOut, fall_of_error, left_out
from meso_robust.diagnosis.next_push import next_experiment
from meso_robust.diagnosis.refit import Refit
from meso_robust.diagnosis.rejection import Ground, Rejection
from meso_robust.diagnosis.residual import ResidualLaw
from meso_robust.diagnosis.tangent import CONFIDENCE, Interval, intervals
from meso_robust.diagnosis.trials import Trial, tried
from meso_robust.diagnosis.validation import Errors
from meso_robust.identification.answer import sections
from meso_robust.identification.document import (
    MinimumSection,
    ModelDocument,
    NotIdentifiableSection,
    ParameterSection,
    RecordingSection,
)
from meso_robust.identification.verdict import verdict
from meso_robust.recordings import read_set
from meso_robust.recordings.usable import usable_set
from meso_robust.simulator import Outcome
from meso_robust.simulator.catalogue import CATALOGUE, parameter_of, stage_of
from meso_robust.simulator.stage import FORM
from meso_robust.toml_files import toml_of
from meso_robust.types import Floats
from meso_robust.wording import counted

UM, DEG = 1e6, 180.0 / np.pi
SPREAD = "friction_spread"
"""Effect that friction of its own in every push is told as."""
VISCOSITY = "film_viscosity"
"""The scale of the drag: no motion depends on it."""
FORM_NATS = 5.0
"""Lead of a form of a law from which on it is told, times what is left of the data over the noise: where
everything is a little wrong, a likelihood is overconfident."""
_BY_CHANCE = 0.01  # of a rank correlation as large, at most
_IN_ORDER = 0.8  # rank correlation from which on friction is told to change with use
_NAMED_FILES = 3  # that are told by name
_PAIRS = 24  # that are listed
_LISTED = 12  # tests and candidates that are listed


def document(found: Diagnosis, version: str, remarks: tuple[str, ...] = ()) -> DiagnosisDocument:
    """The document of a diagnosis.

    Parameters
    ----------
    found
        The diagnosis.
    version
        Of this package.
    remarks
        What else to keep in mind about the recordings.

    Returns
    -------
    DiagnosisDocument
        The content of ``diagnosis.json``, in µm and degrees.
    """
    best, noise, checked = found.best, found.baseline.noise, found.checked
    answers = found.answers
    unseen = [one for one in found.detected.visible if not one.seen]
    # by a mapping, because `schema` is the name of a method of pydantic's models
    return DiagnosisDocument.model_validate(
        {
            "schema": SCHEMA,
            "verdict": found.verdict,
            "why": _why(found),
            "baseline": {"model": found.baseline.model.name, "parameters": _baseline(found)},
            "noise": {
                "position_sigma_um": UM * float(noise.sigma[0]),
                "orientation_sigma_deg": DEG * float(noise.sigma[2]),
                "correlation": noise.correlation,
                "source": noise.source,
                "sway_um": UM * noise.sway.metres if noise.sway else None,
                "sway_hz": noise.sway.rate if noise.sway else None,
            },
            "training": found.baseline.prepared.files,
            "mismatch": _mismatch(found),
            "explained": asdict(found.grade.explained) if found.grade.explained else None,
            "remainder": _remainder(found),
            "residual": _residual(found),
            "budget": tuple(
                {**asdict(one), "stage": one.stage or None} for one in found.grade.cells
            ),
            "relevant_um": UM * found.grade.relevant,
            "explainable_um": UM * found.grade.size,
            "effects": _effects(found, best, answers) if best else _spread(found),
            "ambiguous_with": tuple(
                one.effects for one in (*found.grade.rivals, *found.grade.alike)
            ),
            "not_identifiable": (VISCOSITY, *(one.effect for one in unseen)),
            "not_identifiable_why": tuple(
                {
                    "effect": one.effect,
                    "detectability": one.sigma,
                    "alike": one.alike,
                    "push": tried(one.effect).shown_by,
                }
                for one in unseen
            ),
            "candidates": _candidates(found),
            **_located(found),
            "catch_all_sigma": found.accepted.catch_all if found.accepted else None,
            "decoys": checked.decoys.count if checked.decoys else 0,
            "decoy_share": checked.decoys.share if checked.decoys else None,
            "control": {**asdict(checked.control), "within_sigma": SAME}
            if checked.control
            else None,
            "held_out": _held_out(found),
            "next_experiment": next_experiment(found),
            "provenance": {
                "recordings_sha256": found.sha256,
                "seed": found.seed,
                "quick": found.quick,
                "meso_robust": version,
                "notes": (
                    *(f"{note.file}: {note.what}" for note in found.baseline.prepared.notes),
                    *_ended(found),
                    *remarks,
                ),
            },
        }
    )


def diagnosed(folder: Path, *, quick: bool = False, seed: int = 0) -> dict[str, Any]:
    """``diagnosis.json`` of the recording set in a folder, as a plain dictionary.

    Parameters
    ----------
    folder
        Of the recording set.
    quick, seed
        As in `diagnose`.

    Returns
    -------
    dict
        As JSON has it.

    Raises
    ------
    InputError
        If the recordings cannot be used.
    """
    read = usable_set(read_set(folder))
    found = diagnose(read.recordings, quick=quick, seed=seed)
    return document(found, __version__, read.warnings).model_dump(mode="json", by_alias=True)


def _ended(found: Diagnosis) -> tuple[str, ...]:
    """What to know of the errors: pushes that failed in the simulator, and nothing held out."""
    failed = tuple(
        f"{file}: its push ends in {outcome} with the {which} model"
        for which, worth in (("plain", found.plain), ("extended", found.extended))
        if worth is not None
        for one in (worth.training, worth.held_out)
        if one is not None
        for file, outcome in zip(one.prepared.files, one.outcomes, strict=True)
        if outcome != "completed"
    )
    if found.grade.bench.count == 1:
        return (*failed, "too few recordings to hold any out: errors are those of the fit")
    return failed


def _why(found: Diagnosis) -> str:
    detection, grade = found.detected.detection, found.grade
    few = (
        "; of one recording most physics does not show: record more pushes"
        if grade.bench.count == 1
        else ""
    )
    if found.accepted is None:
        return (
            f"nothing beyond the refitted model is supported: the largest of {len(detection.tests)} "
            f"tests is as large in {detection.p_value:.2g} of simulated sets without a mismatch{few}"
        )
    if found.verdict == "consistent":
        said = f"a mismatch is there, but its size in predictions is {UM * grade.size:.2g} um, "
        if grade.size < grade.relevant:
            return f"{said}below the {UM * grade.relevant:.2g} um that matter{few}"
        return f"{said}which the noise of these recordings leaves by chance{few}"
    if grade.bench.count == 1:
        return "there is one recording, which can only be predicted by a fit of itself: record more pushes"
    reach = f"; free hidden inputs would leave {np.sqrt(grade.floor):.3g} σ"
    sway = found.baseline.noise.sway
    if sway is not None:
        reach = (
            f"; at rest the part is seen to sway by {UM * sway.metres:.2g} um at {sway.rate:.2g} Hz, as if "
            "the camera or the stage shook"
        )
    if found.verdict == "unknown" or grade.chosen is None or grade.explained is None:
        return (_each_push(found.each_push) if found.each_push else _unexplained(grade)) + reach
    main = tuple(name for name in _by_share(grade) if name not in grade.beside)
    most = sum(grade.shares.get(name, 0.0) for name in main)
    disputed = any(set(main) < set(one.effects) for one in grade.alike)
    if found.verdict == "partial" and main and grade.beside and (most >= NAMED or disputed):
        return f"{_explains(grade, main, min(most, 1.0))}{_beside(grade, main)}{reach}"
    names, share = _by_share(grade), grade.explained.share
    if found.verdict == "ambiguous":
        others = _or((*grade.rivals, *grade.alike))
        return (
            f"{_explains(grade, names, share)}, and so does {others}; they cannot be distinguished"
        )
    said = _explains(grade, names, share)
    if found.verdict == "named":
        adequate = grade.chosen.adequate and not grade.chosen.rejected
        return said + (", and leaves nothing that the detector sees" if adequate else reach)
    return f"{said}: {_lacking(grade, grade.explained)}{reach}"


def _each_push(own: EachPush) -> str:
    """What is told where the friction differs from push to push."""
    trend = ""
    if abs(own.order) >= _IN_ORDER and own.order_p <= _BY_CHANCE:
        trend = f"; it {'rises' if own.order > 0.0 else 'falls'} in the order of the files, as if tips or edges changed with use"
    return (
        f"friction of its own in every push, told by the first half of the push, explains {100.0 * own.explained.share:.0f} % "
        f"of the explainable error of the second halves: {own.least:.2g} to {own.most:.2g} in the {own.pushes} pushes that "
        f"tell it; no recording predicts that of another one{trend}"
    )


def _explains(grade: Grade, names: Sequence[str], share: float) -> str:
    return f"{' + '.join(names)} explains {100.0 * share:.0f} % of {_error(grade)}"


def _error(grade: Grade) -> str:
    return f"the explainable error of {UM * grade.size:.2g} um, in recordings left out of the fit"


def _beside(grade: Grade, main: Sequence[str]) -> str:
    """What is told of the little that the main effects of a set leave."""
    others = {
        " + ".join(name for name in one.effects if name not in main)
        for one in grade.alike
        if set(main) < set(one.effects)
    }
    so_does = f", and so does {' or '.join(sorted(others))}" if others else ""
    least = sum(grade.shares.get(name, 0.0) for name in grade.beside)
    what = "small, which" if least < PARTIAL else "that"
    return f"; beside it is something {what} {' and '.join(grade.beside)} explains{so_does}"


def _unexplained(grade: Grade) -> str:
    """What is known of an error that no set of effects explains enough of."""
    if odd := grade.remainder.odd:
        return (
            f"nearly all of the error is in {odd}, and no effect of the catalogue makes it: look at the clock and the "
            "frames of that recording and at what lay in its way, or leave it out"
        )
    if grade.chosen is None or grade.explained is None:
        return f"no effect of the catalogue explains any of {_error(grade)}"
    names, share = " + ".join(_by_share(grade)), 100.0 * grade.explained.share
    if share <= 0.0:
        return (
            f"{names} fits best where it was fitted, and helps on no recordings left out of the fit"
        )
    return f"{names} explains {share:.0f} % of {_error(grade)}: too little for a name"


def _by_share(grade: Grade) -> tuple[str, ...]:
    """Effects of the chosen set, the one that explains most first."""
    effects = grade.chosen.effects if grade.chosen else ()
    return tuple(sorted(effects, key=lambda name: -grade.shares.get(name, 0.0)))


def _or(sets: tuple[Candidate, ...]) -> str:
    return " or ".join(" + ".join(one.effects) for one in sets)


def _lacking(grade: Grade, explained: Explained) -> str:
    """Why a set that explains a part is not named."""
    if grade.alike:
        return f"but so does {_or(grade.alike)}"
    if grade.unsure:
        return f"but the recordings do not agree on the size of {' and '.join(grade.unsure)}"
    if grade.beside:
        return f"but {' and '.join(grade.beside)} may be what another form of the rest leaves"
    if grade.extended and grade.extended.alone:
        told = " and ".join(f"of {effect} by {file}" for effect, file in grade.extended.alone)
        return f"but that is told {told} alone: repeat that push"
    if explained.share < NAMED:
        return "not all of it"
    if grade.spoilt:
        files, more = grade.spoilt[:_NAMED_FILES], len(grade.spoilt) - _NAMED_FILES
        others = f" and {counted(more, 'more recording')}" if more > 0 else ""
        return f"but with it {', '.join(files)}{others} would be predicted worse than without"
    if grade.elsewhere:
        return f"but what is left is in the {grade.remainder.stage}"
    if explained.low < SURE:
        return f"{100.0 * explained.low:.0f} % of it surely"
    return "not in every fold, or another set is likelier where both were fitted"


def _baseline(found: Diagnosis) -> dict[str, dict[str, object]]:
    """Numbers of the plain model; where χ² has several dips the curvature of one of them tells too little."""
    base = found.baseline
    known = intervals(base.model, base.fits.values[0], base.jacobian, base.tangent, base.rows)
    told = {one.key: one for one in base.found.profiles}
    wider = (
        replace(one, low=min(one.low, told[one.key].low), high=max(one.high, told[one.key].high))
        if one.key in told
        else one
        for one in known
    )
    return {one.key: _value(one) for one in wider}


def _value(one: Interval) -> dict[str, object]:
    return {**one.shown, "unit": one.parameter.unit}


def _mismatch(found: Diagnosis) -> dict[str, object]:
    detection = found.detected.detection
    return {
        "detected": detection.detected,
        "p_value": detection.p_value,
        "threshold": ALARM,
        "nulls": len(detection.null_statistics),
        "tests": tuple(
            {"name": test.name, "kind": test.kind, "sigma": float(sigma)}
            for test, sigma in zip(
                detection.tests[:_LISTED], detection.sigmas[:_LISTED], strict=True
            )
        ),
        "where": tuple(asdict(one) for one in found.located.places) if found.located else (),
    }


def _located(found: Diagnosis) -> dict[str, object]:
    """What the three ways of locating say."""
    where = found.located
    if where is None:
        return {}
    predicted = {(p.invariance, p.first, p.second): p.sigma for p in found.checked.pairs}
    return {
        "channels": tuple(
            {"channel": one.channel, "share": one.share, "sigma": one.sigma}
            for one in where.channels
        ),
        "covariates": tuple(asdict(one) for one in where.covariates),
        "invariances": tuple(
            {
                "invariance": one.invariance,
                "first": one.first,
                "second": one.second,
                "difference_um": UM * float(np.hypot(*one.difference[:2])),
                "difference_deg": DEG * abs(float(one.difference[2])),
                "sigma": one.sigma,
                "predicted_sigma": predicted.get((one.invariance, one.first, one.second)),
            }
            for one in where.pairs[:_PAIRS]
        ),
    }


def _remainder(found: Diagnosis) -> dict[str, object]:
    left = found.grade.remainder
    return {
        "um": UM * left.metres,
        "deg": DEG * left.radians,
        "sigma": left.sigma,
        "stage": left.stage,
        "component": left.component,
        "phase": left.phase,
        "grows_with": left.grows_with,
        "spread_between_pushes": left.spread,
    }


def _residual(found: Diagnosis) -> dict[str, object] | None:
    law, grade = found.residual, found.grade
    if law is None:
        return None
    fall, low, high = law.fall
    return {
        "added_to": grade.chosen.effects if grade.chosen else (),
        "bases": {
            key: {**_value(one), "meaning": one.parameter.meaning, "chosen": law.chosen[key]}
            for one in law.bases
            for key in (one.key.partition(".")[2],)
        },
        "before_um": UM * law.metres[0],
        "after_um": UM * law.metres[1],
        "before_deg": DEG * law.radians[0],
        "after_deg": DEG * law.radians[1],
        "fall": fall,
        "fall_low": low,
        "fall_high": high,
        "folds": grade.bench.count,
        "offered": law.offered,
    }


def _effects(
    found: Diagnosis, best: Candidate, answers: tuple[Candidate, ...]
) -> tuple[dict[str, object], ...]:
    known = {one.key: one for one in found.known}
    able = sum(one.probability for one in answers) or 1.0
    return tuple(
        {
            "name": trial.effect,
            "probability": _probability(trial.effect, best, answers, able),
            "parameters": {
                key: _value(known[f"{trial.effect}.{key}"])
                for key in trial.scales
                if f"{trial.effect}.{key}" in known
            }
            | {key: _fixed(trial.effect, key, value) for key, value in trial.held.items()},
            "stage": stage_of(trial.effect).name,
            "equation": CATALOGUE[trial.effect].equation,
            "share": found.grade.shares.get(trial.effect),
            "form": _form(trial, best.refit),
        }
        for trial in sorted(
            best.refit.trials, key=lambda one: -found.grade.shares.get(one.effect, 0.0)
        )
    )


def _spread(found: Diagnosis) -> tuple[dict[str, object], ...]:
    """Friction of its own in every push, where that is the answer."""
    own = found.each_push
    if own is None:
        return ()
    value, low, high = own.spread
    return (
        {
            "name": SPREAD,
            "probability": 1.0,
            "parameters": {"change": {"value": value, "low": low, "high": high, "unit": ""}},
            "stage": stage_of(SPREAD).name,
            "equation": "μ of one push = μ (1 + c)",
            "share": None,
            "each_push": True,
        },
    )


def _form(trial: Trial, refit: Refit) -> str:
    """What was held, and the form of the law: it is told only if the recordings tell it."""
    held = [f"{key} {value:g}" for key, value in trial.held.items() if key != FORM]
    forms = CATALOGUE[trial.effect].forms
    if forms:
        lead = refit.lead
        told = lead is not None and lead > FORM_NATS * max(1.0, refit.chi2 / len(refit.evidence))
        held.append(forms[int(trial.law)] if told else "form not told by these recordings")
    return ", ".join(held)


def _fixed(effect: str, key: str, value: float) -> dict[str, object]:
    unit = parameter_of("effects", effect, key).unit
    return {"value": value, "low": value, "high": value, "unit": unit}


def _probability(
    effect: str, best: Candidate, answers: tuple[Candidate, ...], able: float
) -> float:
    """Share of the answers that hold the effect; of a set that is not enough, nothing is claimed."""
    if best not in answers:
        return 0.0
    return float(min(1.0, sum(one.probability for one in answers if effect in one.effects) / able))


def _candidates(found: Diagnosis) -> tuple[dict[str, object], ...]:
    if found.naming is None:
        return ()
    return tuple(
        {
            "effects": one.effects,
            "gain": one.refit.gain,
            "chi2": one.refit.chi2,
            "probability": one.probability,
            "adequate": one.adequate,
            **_rejection(why_not(one, found.naming)),
        }
        for one in found.naming.candidates[:_LISTED]
    )


def _rejection(why: Rejection | None) -> dict[str, object]:
    """As words and as an id."""
    same = why is not None and why.ground is Ground.SAME_MOTION
    return {
        "rejected": why.words if why else "",
        "ground": why.ground if why else None,
        "instead": tuple(sorted(why.names)) if why is not None and same else (),
    }


def _held_out(found: Diagnosis) -> dict[str, Any]:
    """Errors of every recording, predicted from the pose at rest by fits to the others."""
    bench, plain = found.grade.bench, found.grade.plain
    rolled = (found.grade.extended or plain) if found.extended else plain
    unseen = bench.count > 1
    before, after = (left_out(bench, one) for one in (plain, rolled))
    low, high = fall_of_error(before, after, found.seed)
    section: dict[str, Any] = {
        "recordings": bench.prepared.files if unseen else (),
        "baseline_sigma": before.whole,
        "extended_sigma": after.whole,
        "noise_floor_sigma": found.baseline.noise.floor,
        "repeatability_sigma": found.baseline.noise.repeatability,
        "baseline_um": UM * before.whole_metres,
        "extended_um": UM * after.whole_metres,
        "improvement_low": low,
        "improvement_high": high,
        "black_box_sigma": found.checked.black_box,
        "each": _each(bench.prepared.files, before, after, "held_out") if unseen else (),
    }
    beyond = found.checked.extrapolation
    if beyond is None:
        return section
    return section | {
        "extrapolation": beyond.what,
        "extrapolation_recordings": beyond.files,
        "extrapolation_baseline_sigma": beyond.before.whole,
        "extrapolation_extended_sigma": beyond.after.whole,
        "each": (
            *section["each"],
            *_each(beyond.files, beyond.before, beyond.after, "extrapolation"),
        ),
    }


def _each(
    files: Sequence[str], before: LeftOut | Errors, after: LeftOut | Errors, which: str
) -> tuple[dict[str, object], ...]:
    return tuple(
        {
            "recording": file,
            "split": which,
            "baseline_sigma": float(before.sigma[k]),
            "extended_sigma": float(after.sigma[k]),
            "baseline_um": UM * float(before.metres[k]),
            "extended_um": UM * float(after.metres[k]),
        }
        for k, file in enumerate(files)
    )


def model_toml(found: Diagnosis, version: str) -> str:
    """Text of ``model.toml``: the extended model, or the plain one where nothing was added.

    Parameters
    ----------
    found
        The diagnosis.
    version
        Of this package.

    Returns
    -------
    str
        TOML, see `ModelDocument`.
    """
    return toml_of(_model_document(found, version))


def _model_document(found: Diagnosis, version: str) -> ModelDocument:
    plain, best = sections(found.split.training, found.baseline.found, version), found.best
    plain["diagnosis"] = found.verdict
    law, rolled = found.residual, found.grade.extended
    if law is not None and law.offered:
        return _by_folds(plain, found, law, law.intervals)
    if best is None or found.extended is None:
        made = ModelDocument.model_validate(plain)
        return made.model_copy(update={"verdict": verdict(made)})
    known = found.known
    if rolled is not None and rolled.weighed:
        return _by_folds(plain, found, rolled, known)
    shown = {one.key: one.shown["value"] for one in known}
    # the quality is of the plain fit and goes with it
    return ModelDocument.model_validate(
        plain
        | {
            "model": best.refit.model.name,
            "interval": "curvature and jackknife",
            "confidence": CONFIDENCE,
            "parameters": {one.key: _section(one) for one in known},
            "held": {**plain["held"], **_held(best)},
            "not_identifiable": _unknown(known),
            "quality": None,
            "minima": (_minimum(found.extended.training, float(best.refit.fits.chi2[0]), shown),),
            "recording": _recordings(found.extended.training),
        }
    )


def _held(best: Candidate) -> dict[str, float]:
    """Numbers of the effects that were not fitted."""
    return {
        f"{trial.effect}.{key}": value
        for trial in best.refit.trials
        for key, value in trial.held.items()
    }


def _by_folds(
    plain: dict[str, Any],
    found: Diagnosis,
    rolled: ResidualLaw | RollOut,
    known: tuple[Interval, ...],
) -> ModelDocument:
    """The model of some roll-outs; its errors are those out of fold."""
    bench = found.grade.bench
    seen = bench.prepared.seen
    rms = np.sqrt(np.nanmean((seen - rolled.poses) ** 2, axis=1)).tolist()
    x, y, theta = np.sqrt(np.nanmean((seen - rolled.poses) ** 2, axis=(0, 1))).tolist()
    away = np.nan_to_num((seen - rolled.poses) / found.baseline.settings.sigma)
    frames = bench.prepared.counts.max(axis=1)
    return ModelDocument.model_validate(
        plain
        | {
            "model": rolled.model.name,
            "interval": "jackknife",
            "confidence": CONFIDENCE,
            "parameters": {one.key: _section(one) for one in known},
            "held": {**plain["held"], **(_held(found.best) if found.best else {})},
            "not_identifiable": _unknown(known),
            "quality": None,
            "minima": (
                MinimumSection(
                    cost=float(np.sum(away**2)),
                    x_um=UM * x,
                    y_um=UM * y,
                    theta_deg=DEG * theta,
                    found=0,
                    parameters={one.key: one.shown["value"] for one in known},
                ),
            ),
            "recording": tuple(
                RecordingSection(
                    file=file,
                    frames=int(frames[k]),
                    x_um=UM * rms[k][0],
                    y_um=UM * rms[k][1],
                    theta_deg=DEG * rms[k][2],
                    outcome=Outcome(int(rolled.outcomes[k])).word,
                )
                for k, file in enumerate(bench.prepared.files)
            ),
        }
    )


def _section(one: Interval) -> ParameterSection:
    return ParameterSection(**one.shown, open_low=one.open_low, open_high=one.open_high)


def _unknown(known: tuple[Interval, ...]) -> tuple[NotIdentifiableSection, ...]:
    """Numbers without a bound, and the scale of the drag, which no motion shows."""
    listed = {
        one.key: "the recordings give no bound on one side"
        for one in known
        if one.open_low or one.open_high
    }
    listed[VISCOSITY] = "no motion depends on the scale of the drag"
    return tuple(NotIdentifiableSection(name=name, why=why) for name, why in listed.items())


def _minimum(errors: Errors, chi2: float, shown: dict[str, float]) -> MinimumSection:
    x, y, theta = np.sqrt(np.mean(_rms(errors) ** 2, axis=0)).tolist()
    return MinimumSection(
        cost=chi2,
        x_um=UM * x,
        y_um=UM * y,
        theta_deg=DEG * theta,
        found=0,  # the search began at a linear estimate, not at a random start
        parameters=shown,
    )


def _rms(errors: Errors) -> Floats:
    """(R, 3) root mean squares of seen less predicted, m and rad."""
    return np.sqrt(np.nanmean((errors.prepared.seen - errors.poses) ** 2, axis=1))


def _recordings(errors: Errors) -> tuple[RecordingSection, ...]:
    rms, frames = _rms(errors).tolist(), errors.prepared.counts.max(axis=1)
    return tuple(
        RecordingSection(
            file=file,
            frames=int(frames[k]),
            x_um=UM * rms[k][0],
            y_um=UM * rms[k][1],
            theta_deg=DEG * rms[k][2],
            outcome=errors.outcomes[k],
        )
        for k, file in enumerate(errors.prepared.files)
    )
