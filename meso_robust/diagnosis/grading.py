"""How much of what could be explained a set of effects explains, where it was not fitted.

Every real recording is a little wrong everywhere, and with thousands of frames any law is refuted.
What counts is the share of the *explainable* error (`judge`). A set of effects is named for four fifths of
it, and partly for a fifth; an error too small to matter is consistent, and its size is told.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from meso_robust.diagnosis.baseline import Baseline
from meso_robust.diagnosis.budget import Cell, budget, phases, shapley
from meso_robust.diagnosis.candidates import Candidate, Naming, exchanged
from meso_robust.diagnosis.choice import in_open_forms, pools, slight
from meso_robust.diagnosis.document import SWAY_SHARE, Channel, Verdict
from meso_robust.diagnosis.folds import Bench, RollOut, rolled_out
from meso_robust.diagnosis.further import with_more, with_one_more
from meso_robust.diagnosis.hidden_inputs import CHANNELS
from meso_robust.diagnosis.judge import (
    NAMED,
    SURE,
    Explained,
    Judge,
    Names,
    judge_of,
    with_predictions,
)
from meso_robust.diagnosis.localisation import Located
from meso_robust.diagnosis.rivals import EQUAL_NATS, one_physics, only_law
from meso_robust.diagnosis.sizes import clear
from meso_robust.diagnosis.stages import stages
from meso_robust.diagnosis.tangent import Interval
from meso_robust.identification.prepared import some_of
from meso_robust.recordings import RecordingSet
from meso_robust.simulator.catalogue import stage_of
from meso_robust.types import Floats

RELEVANT = 1e-7
"""m: size of an error that matters, where no noise is known to compare it with."""
RELEVANT_SHARE = 0.2
"""Of the noise, likewise."""
_ALL_BUT_FORM = 0.9  # share, below which more is left than the form of a law makes
_SEVERAL, _IN_ONE = 4, 0.8  # recordings, and the share that one of them has of what is left
_LOOKED = 8  # recordings in which it is looked for where the rest is, those that have most of it


@dataclass(frozen=True, slots=True, kw_only=True)
class Remainder:
    """What is left to explain in roll-outs, beyond the floor.

    Attributes
    ----------
    metres, radians, sigma
        Root mean squares of place and turn, and of all over the noise of the camera.
    stage, component, phase, grows_with
        Where most of it is.
    spread
        Standard deviation over mean of what is left of one recording: about nought if all pushes are
        wrong alike, more if the rest varies between them.
    odd
        File of the one recording that has nearly all of it, of several; empty where none has.
    """

    metres: float
    radians: float
    sigma: float
    stage: Channel | None
    component: str | None
    phase: str | None
    grows_with: str
    spread: float
    odd: str = ""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Grade:
    """Verdict on the competition, and what it rests on.

    Attributes
    ----------
    verdict
        As in `diagnosis.json`.
    bench
        All recordings, and their folds.
    plain, extended
        Roll-outs of the plain model, and of the chosen set; None where no set was chosen.
    chosen
        Candidate of that set.
    rivals
        Sets that explain as much.
    alike
        Likewise, but only with other laws of the same physics, with more effects than the chosen one, or with others in
        place of what was found in what the rest leaves: what it is stays known, so that it is partial.
    explained
        None where nothing is to be explained.
    shares
        Of the explainable error, by effect; their sum is that of ``explained``.
    cells
        The whole of it.
    remainder
        What is left.
    size, relevant
        Of the explainable error of the plain model, and from which on it matters, m.
    floor
        Mean square that free hidden inputs leave, over the noise.
    unsure
        Effects of the set whose size the recordings do not agree on: what else would be named is partial.
    beside
        Effects that explain little of the whole beside the others, or were found in what these leave: likewise, as the
        form of a law that is not quite the true one leaves something that an effect may look like. So do those that
        other sets do without that explain as much.
    spoilt
        Files of recordings that the set predicts worse than the plain model: likewise.
    elsewhere
        Whether much is left, at a stage that none of the set's effects belongs to: likewise.
    """

    verdict: Verdict
    bench: Bench
    plain: RollOut
    extended: RollOut | None
    chosen: Candidate | None
    rivals: tuple[Candidate, ...]
    explained: Explained | None
    shares: Mapping[str, float]
    cells: tuple[Cell, ...]
    remainder: Remainder
    size: float
    relevant: float
    floor: float
    unsure: Names = ()
    beside: Names = ()
    alike: tuple[Candidate, ...] = ()
    spoilt: tuple[str, ...] = ()
    elsewhere: bool = False


def graded(
    recordings: RecordingSet,
    bench: Bench,
    naming: Naming | None,
    where: Located | None,
    reach: float | None,
    *,
    quick: bool,
    seed: int,
    relevant: float | None,
) -> Grade:
    """Judge the sets of a competition by what they explain of recordings left out of the fit.

    Parameters
    ----------
    recordings, bench
        All recordings.
    naming
        Outcome of the competition; None where no mismatch was detected.
    where
        Where the mismatch is; None likewise.
    reach
        σ that free hidden inputs leave; None where that is not known.
    quick
        Fewer sets are judged.
    seed
        Of the intervals.
    relevant
        m: errors below do not matter; None for a fifth of the noise, or what an error of the tracker that
        stays from frame to frame makes, if that is more.
    """
    baseline = bench.baseline
    plain = rolled_out(bench, baseline.model, baseline.fits.values[0])
    # inputs that are constant in a window follow no sway: what they leave of it is no floor
    if mostly_sway(bench, float(np.sum(plain.squares) - bench.seen.sum())):
        reach = None
    matters = _relevant(baseline) if relevant is None else relevant
    predicted: dict[Names, RollOut] = {(): plain}
    chosen: Candidate | None = None
    rivals: tuple[Candidate, ...] = ()
    everywhere = True
    turned: dict[Names, Candidate] = {}
    for asked, pool in pools(naming, quick):
        pool = with_predictions(
            bench, predicted, tuple(turned.get(one.effects, one) for one in pool)
        )
        judge = judge_of(bench, predicted, reach)
        size = judge.size_left(())
        missing = asked is not None and judge.is_left((), matters)
        # of a single recording none can be left out: what its own fit explains proves nothing
        if asked and pool and missing and bench.count > 1:
            known = exchanged(asked, turned)
            found, other = in_open_forms(known, pool, judge, reach, seed)
            chosen, rivals, everywhere = found
            turned |= other
            judge = judge_of(bench, predicted, reach)
        if chosen is not None or not missing or bench.count == 1:
            break
    rivals, alike, beside = _left_open(judge, chosen, rivals, seed)
    settled = not (rivals or beside)
    if naming is not None and chosen is not None and settled:
        chosen, beside, alike, judge = _with_what_is_beside(
            judge, naming, chosen, alike, reach, matters, seed
        )
    explained = judge.explained(chosen.effects, seed) if chosen else None
    effects = chosen.effects if chosen else ()
    by_effect, tables = shapley(judge, chosen, phases(recordings, bench))
    # of a set that explains too little for a name the stage is as open as any
    named = effects if explained and explained.tells else ()
    stage = _stage_left(judge, recordings, named, by_effect, where, matters)
    cells = budget(tables, effects, stage) if missing else ()
    # a law that is not the true one may make most of a motion, and leave the rest at another stage
    elsewhere = bool(stage and explained and explained.share < _ALL_BUT_FORM) and not any(
        stage_of(name).name == stage for name in effects
    )
    alone = predicted[effects].alone
    settled = not (beside or alike or elsewhere or alone or judge.spoilt(effects))
    return Grade(
        verdict=_verdict(missing, explained, rivals, everywhere and settled),
        bench=bench,
        plain=plain,
        extended=predicted[effects] if effects else None,
        chosen=chosen,
        rivals=rivals,
        explained=explained,
        shares=by_effect,
        cells=cells,
        remainder=_remainder(judge, effects, cells, stage, where),
        size=size,
        relevant=matters,
        floor=float(judge.floor.sum() / bench.seen.sum()),
        beside=beside,
        alike=alike,
        spoilt=judge.spoilt(effects),
        elsewhere=elsewhere,
    )


Sets = tuple[Candidate, ...]


def _left_open(
    judge: Judge, chosen: Candidate | None, rivals: Sets, seed: int
) -> tuple[Sets, Sets, Names]:
    """Of sets that explain as much: those of other physics, those that leave a part or a law open, and what part.

    What all of them hold is told where it explains a part by itself, and the rest is what is open.
    """
    if chosen is None:
        return rivals, (), ()
    alike = tuple(one for one in rivals if only_law(judge, chosen, one, seed))
    apart = tuple(one for one in rivals if one not in alike)
    beside = _in_dispute(judge, chosen, rivals, seed) if apart else ()
    return ((), rivals, beside) if beside else (apart, alike, ())


def _with_what_is_beside(
    judge: Judge,
    naming: Naming,
    chosen: Candidate,
    alike: Sets,
    reach: float | None,
    matters: float,
    seed: int,
) -> tuple[Candidate, Names, Sets, Judge]:
    """The set with further members, those of them that are told apart, and the sets that explain as much."""
    laws = tuple(one for one in alike if one_physics(chosen, one))
    longer = tuple(one for one in alike if one not in laws)
    same: Sets = ()
    if laws:
        # which law it is does not tell what is beside it, and sets that have it were asked
        found = with_one_more(judge, (chosen, *laws), longer, matters)
        if found is None:
            return chosen, (), alike, judge
        beside = slight(judge, found)
    elif _all_longer(longer, chosen):
        beside = slight(judge, chosen)
        found, more, same, judge = with_more(judge, naming, chosen, reach, matters, seed)
        beside += more
        if found is chosen:
            return chosen, beside, alike, judge
    else:
        return chosen, (), alike, judge
    kept = (one for one in alike if not _outdone(judge, found, one, seed))
    return found, beside, (*same, *kept) or laws, judge


def _in_dispute(judge: Judge, chosen: Candidate, rivals: Sets, seed: int) -> Names:
    """Members of a set that not all of its rivals hold, where what they do hold tells a part by itself."""
    shared = tuple(name for name in chosen.effects if all(name in one.effects for one in rivals))
    if not shared:
        return ()
    judge.with_part(chosen, shared)
    if not judge.explained(shared, seed).tells:
        return ()
    return tuple(name for name in chosen.effects if name not in shared)


def _all_longer(alike: Sets, chosen: Candidate) -> bool:
    """Whether the chosen set may need one effect more, as each of those has that explain as much."""
    return all(len(one.effects) > len(chosen.effects) for one in alike)


def _outdone(judge: Judge, chosen: Candidate, other: Candidate, seed: int) -> bool:
    """Whether a set that explains as much as a part of the chosen one explains surely less than the whole, or is it."""
    same = other.effects == chosen.effects
    return same or judge.surely_worse(chosen.effects, other.effects, seed)


def sized(grade: Grade, known: Sequence[Interval]) -> Grade:
    """The grade, partial at most where the recordings do not agree on how large an effect of the set is.

    A law that is not the true one may predict well with numbers that every recording wants different; and
    of so many laws one always has an interval that just leaves nought out.

    Parameters
    ----------
    grade
        Of a set.
    known
        Intervals of its numbers.
    """
    if grade.verdict != "named" or grade.chosen is None:
        return grade
    of = {one.key: one for one in known}
    unsure = tuple(
        trial.effect
        for trial in grade.chosen.refit.trials
        if trial.sizes and not any(clear(of.get(f"{trial.effect}.{key}")) for key in trial.sizes)
    )
    return replace(grade, verdict="partial", unsure=unsure) if unsure else grade


def _verdict(
    matters: bool,
    explained: Explained | None,
    rivals: tuple[Candidate, ...],
    everywhere: bool = True,
) -> Verdict:
    if not matters:
        return "consistent"
    if explained is None or not explained.tells:
        return "unknown"
    if rivals:
        return "ambiguous"
    sure = explained.share >= NAMED and explained.low >= SURE
    return "named" if everywhere and sure else "partial"


def _relevant(baseline: Baseline) -> float:
    """m: a fifth of the noise, and no less than what an error that stays makes of a prediction.

    It begins at a pose seen with one such error, and is compared with poses that are seen with others.
    """
    noise = baseline.noise
    if not noise.known:
        return RELEVANT
    place, turn = float(np.hypot(*noise.stays[:2])), float(noise.stays[2])
    stays = float(np.sqrt(2.0)) * max(place, turn * baseline.prepared.length)
    return max(RELEVANT_SHARE * float(noise.sigma[0]) * noise.floor, stays)


def mostly_sway(bench: Bench, left: float) -> bool:
    """Whether most of a sum of squares beyond the noise is that of a sway."""
    swaying = bench.baseline.noise.swaying * float(bench.seen.sum())
    return swaying > max(SWAY_SHARE * left, 0.0)


def _stage_left(
    judge: Judge,
    recordings: RecordingSet,
    names: Names,
    shares: Mapping[str, float],
    where: Located | None,
    matters: float,
) -> Channel | None:
    """The stage whose hidden inputs explain what a set leaves, which may be one that an effect of it belongs to.

    A law of another form than the catalogue's leaves something at its own stage. Where inputs explain nothing more, that is
    the stage of the effect that explains most, or else the one that explains most of the plain model's error.

    That of the image where most of what is left is a sway that frames at rest show: no tip moves a part then,
    and no input that is constant in a window follows it.
    """
    if where is None:
        return None
    if mostly_sway(judge.bench, float((judge.sums(names) - judge.floor).sum())):
        return "observation"
    bench, of = judge.bench, judge.seen[names]
    found: dict[Channel, float] = {}
    if judge.is_left(names, matters):
        rows = np.sort(np.argsort(judge.floor - judge.sums(names))[:_LOOKED])
        some = replace(recordings, recordings=tuple(recordings.recordings[r] for r in rows))
        own = some_of(bench.prepared, rows)
        found = stages(some, own, of.model, of.values, bench.baseline.noise)
    largest = stage_of(max(names, key=lambda name: shares[name])).name if names else ""
    best = max(found.values(), default=0.0)
    if best > EQUAL_NATS:
        near = [one for one, worth in found.items() if worth >= best - EQUAL_NATS]
        # of those that explain as much the set's own
        return max(near, key=lambda one: (one == largest, found[one]))
    if largest:
        return next(channel for channel in CHANNELS if channel == largest)
    return where.channels[0].channel


def _remainder(
    judge: Judge,
    names: Names,
    cells: tuple[Cell, ...],
    stage: Channel | None,
    where: Located | None,
) -> Remainder:
    beyond = np.maximum(judge.sums(names) - judge.floor, 0.0)
    counts = judge.bench.seen.sum(axis=(1, 2))
    each = np.sqrt(beyond / counts)
    place, turn = judge.left(names)
    rest = [cell for cell in cells if not cell.effect]
    worst = max(rest, key=lambda cell: cell.share, default=None)
    component = worst.component if worst else None
    follows = where.covariates if where else ()
    return Remainder(
        metres=place,
        radians=turn,
        sigma=float(
            np.sqrt(max(float(np.sum(judge.sums(names) - judge.floor)), 0.0) / counts.sum())
        ),
        stage=stage if worst else None,
        component=component,
        phase=worst.phase if worst else None,
        grows_with=next((one.covariate for one in follows if one.component == component), ""),
        spread=float(each.std() / each.mean()) if np.any(each) else 0.0,
        odd=judge.bench.prepared.files[int(np.argmax(beyond))] if _in_one(beyond) else "",
    )


def _in_one(beyond: Floats) -> bool:
    """Whether one of several recordings has nearly all of what is left (R,): then it is the recording that is wrong."""
    return len(beyond) >= _SEVERAL and float(beyond.max()) > _IN_ONE * float(beyond.sum())
