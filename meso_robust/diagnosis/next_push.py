"""What to record next: the push that would tell apart what these recordings do not, or show again what they do.

To tell two answers apart many pushes are simulated under both models, and the largest difference wins. Every push starts at
rest from a pose that the part had in the recordings, waits, meets an edge, goes on, draws back and
waits again. A difference counts in standard deviations of the noise of all frames together, less what
another start would explain.
"""

from __future__ import annotations

import itertools
from dataclasses import asdict, dataclass, replace

import numpy as np

from meso_robust.diagnosis.candidates import Candidate
from meso_robust.diagnosis.diagnose import Diagnosis
from meso_robust.diagnosis.tangent import tangent
from meso_robust.diagnosis.trials import tried, typical_speed
from meso_robust.identification.forward import predicted
from meso_robust.identification.models import Model
from meso_robust.identification.prepared import Prepared
from meso_robust.simulator import Outcome
from meso_robust.types import Floats

UM = 1e6
ALIKE = 3.0
"""σ of all frames together, below which no push is said to tell two answers apart."""
_EDGES = 6  # at most, the longest ones
_PLACES = (-0.6, 0.0, 0.6)
_SLANTS = tuple(np.radians([-15.0, 0.0, 15.0]).tolist())
_SPEEDS = (1.0 / 3.0, 1.0, 3.0)  # of the recordings' typical one
_POSES = 3
_WAIT = 1.0  # s, before and after
_RATE = 30.0  # frames a second
_GAP, _TRAVEL, _BACK = 0.03, 0.35, 0.07  # lengths over that of the part
_FINALISTS = 12  # pushes of which the part of the start is worked out


def next_experiment(found: Diagnosis) -> dict[str, object]:
    """Section ``next_experiment`` of the document."""
    answers = found.answers
    if len(answers) > 1:
        return _telling(found, answers[0], answers[1])
    if found.each_push is not None:
        least, most = found.each_push.least, found.each_push.most
        what = f"clean tip and edge, and repeat one push ten times; until it is alike plan with friction = [{least:.2g}, {most:.2g}]"
        return {"why": "friction differs from push to push", "push": {"what": what}}
    odd = found.grade.remainder.odd
    if found.verdict == "unknown" and odd:
        what = f"record the push of {odd} once more, and diagnose the set without that file"
        return {"why": "one recording is unlike all others", "push": {"what": what}}
    if found.verdict == "unknown":
        worst = next((t for t in found.detected.detection.tests if t.recording >= 0), None)
        file = found.baseline.prepared.files[worst.recording] if worst else "the worst push"
        what = f"repeat {file} at another speed, at another place, and with the part turned by 180°"
        return {"why": "to see which invariance the unknown effect breaks", "push": {"what": what}}
    if answers:
        return _confirming(found, answers[0])
    unseen = sorted(
        (one for one in found.detected.visible if not one.seen), key=lambda one: one.sigma
    )
    if unseen:
        effect = unseen[0].effect
        return {
            "why": f"these recordings could not show {effect}",
            "push": {"what": tried(effect).shown_by},
        }
    return {"why": "nothing is open", "push": {"what": ""}}


def _confirming(found: Diagnosis, answer: Candidate) -> dict[str, object]:
    """The pushes that show best what explains most, on which its size should come out the same."""
    effect = max(answer.effects, key=lambda name: found.grade.shares.get(name, 0.0))
    what = tried(effect).shown_by
    if found.verdict == "named":
        return {
            "why": f"to confirm {effect} before a plan is made with it",
            "push": {"what": f"{what}, to confirm {effect}; then plan with --model model.toml"},
        }
    return {
        "why": f"to confirm {effect}, which may not be all",
        "push": {"what": f"{what}, to confirm {effect}"},
    }


def _telling(found: Diagnosis, first: Candidate, second: Candidate) -> dict[str, object]:
    """The push on which the two best answers differ most, if they do on any."""
    names = [" + ".join(one.effects) for one in (first, second)]
    best = best_push(
        found.baseline.prepared,
        (
            (first.refit.model, first.refit.fits.values[0]),
            (second.refit.model, second.refit.fits.values[0]),
        ),
        found.baseline.noise.sigma,
        found.baseline.noise.correlation,
    )
    if best is not None and best.sigma >= ALIKE:
        why = f"to tell {names[0]} from {names[1]}, which would differ by {best.sigma:.2g} σ on this push"
        return {"why": why, "push": _push(best)}
    effect = next((e for e in first.effects if e not in second.effects), first.effects[0])
    if best is None:
        why = f"to tell {names[0]} from {names[1]}; no push could be simulated under both"
    else:
        why = (
            f"no push on this stage tells {names[0]} from {names[1]}: of those simulated none makes "
            f"a difference of more than {max(best.sigma, 0.01):.2g} σ"
        )
    return {"why": why, "push": {"what": tried(effect).shown_by}}


def _push(one: Rival) -> dict[str, object]:
    x, y, theta = UM * one.start[0], UM * one.start[1], np.degrees(one.start[2])
    return {
        "edge": one.edge,
        "place": one.place,
        "slant_deg": round(float(np.degrees(one.slant)), 6),
        "speed_um_s": round(UM * one.speed, 3),
        "travel_um": round(UM * one.travel, 3),
        "what": (
            f"push edge {one.edge} with the part at x = {x:.0f} µm, y = {y:.0f} µm, θ = {theta:.0f}°; "
            "leave the camera running for a second before, and after drawing the tip back"
        ),
    }


@dataclass(frozen=True, slots=True, kw_only=True)
class PushPlan:
    """A push that two models may differ on.

    Attributes
    ----------
    edge, place, slant
        Pushed edge, place along it from −1 to 1, and angle of the travel against the edge's inward
        normal, rad, counter-clockwise.
    speed, travel
        m/s, and m from the first contact on.
    start
        x, y in m and θ in rad of the part.
    """

    edge: int
    place: float
    slant: float
    speed: float
    travel: float
    start: tuple[float, float, float]


@dataclass(frozen=True, slots=True, kw_only=True)
class Rival(PushPlan):
    """A push, and by how much two models differ on it.

    Attributes
    ----------
    sigma
        The difference in σ of all frames together.
    """

    sigma: float


Two = tuple[tuple[Model, Floats], tuple[Model, Floats]]
"""Two models with their values (n,)."""


def best_push(prepared: Prepared, two: Two, sigma: Floats, correlation: float) -> Rival | None:
    """The push on which two models differ most; None if none can be simulated under both.

    Parameters
    ----------
    prepared
        Recordings: part, tip, poses and speeds are theirs.
    two
        The models.
    sigma, correlation
        (3,) of the noise, m and rad, and φ.
    """
    pushes = rivals(prepared)
    size = np.concatenate(
        [
            np.sqrt(np.sum(_difference(prepared, list(group), two, sigma) ** 2, axis=(1, 2)))
            for _, group in itertools.groupby(pushes, key=lambda one: one.start)
        ]
    )
    able = [k for k in np.argsort(-size, kind="stable").tolist() if np.isfinite(size[k])]
    final = [pushes[k] for k in able[:_FINALISTS]]
    if not final:
        return None
    left = _beyond_start(prepared, final, two, sigma, correlation)
    best = int(np.argmax(left))
    return Rival(**asdict(final[best]), sigma=float(left[best])) if left[best] >= 0.0 else None


def rivals(prepared: Prepared) -> list[PushPlan]:
    """All pushes to choose from, those of one start next to each other."""
    sides = np.roll(prepared.outline, -1, axis=0) - prepared.outline
    longest = np.argsort(-np.hypot(*sides.T), kind="stable")[:_EDGES]
    speed, travel = typical_speed(prepared), _TRAVEL * prepared.length
    return [
        PushPlan(
            edge=edge, place=place, slant=slant, speed=speed * times, travel=travel, start=start
        )
        for start, edge, place, slant, times in itertools.product(
            _spread(prepared), sorted(longest.tolist()), _PLACES, _SLANTS, _SPEEDS
        )
    ]


def arranged(prepared: Prepared, pushes: list[PushPlan]) -> Prepared:
    """The pushes as recordings for the simulator, with nothing seen."""
    ways = [_way(prepared, one) for one in pushes]
    times = np.stack([clock for clock, _ in ways])
    end = times[:, -1]
    frames = int(np.ceil(_RATE * end.max()))
    starts = np.array([one.start for one in pushes])
    return replace(
        prepared,
        files=tuple(f"push {k}" for k in range(len(pushes))),
        shapes=prepared.shapes[:1],
        waypoints=np.stack([way for _, way in ways])[:, :, None],
        times=times,
        instants=end[:, None] * np.linspace(0.0, 1.0, frames),
        seen=np.full((len(pushes), frames, 3), np.nan),
        starts=starts,
        correction=np.zeros((len(pushes), frames, 3)),
        lean=np.tile(np.eye(2), (len(pushes), 1, 1, 1)),
        notes=(),
    )


def _way(prepared: Prepared, one: PushPlan) -> tuple[Floats, Floats]:
    """(6,) s and (6, 2) m of the tip: wait, approach and push, draw back, wait."""
    corners = prepared.outline
    first, last = corners[one.edge], corners[(one.edge + 1) % len(corners)]
    along = (last - first) / np.hypot(*(last - first))
    outward = np.array([along[1], -along[0]])
    touch = 0.5 * (first + last) + 0.5 * one.place * (last - first)
    touch = touch + prepared.shapes[0].radius * outward
    ahead = _turned(one.slant) @ -outward
    gap, back = _GAP * prepared.length, _BACK * prepared.length
    stops = np.array([-gap, -gap, one.travel, one.travel - back, one.travel - back])
    spans = np.abs(np.diff(stops)) / one.speed
    spans[[0, -1]] = _WAIT
    own = touch + stops[:, None] * ahead
    return np.append(0.0, np.cumsum(spans)), np.array(one.start[:2]) + own @ _turned(one.start[2]).T


def _turned(angle: float) -> Floats:
    cos, sin = np.cos(angle), np.sin(angle)
    return np.array([[cos, -sin], [sin, cos]])


def _spread(prepared: Prepared) -> list[tuple[float, float, float]]:
    """A few recorded starts, as different as there are: the first, then always the farthest."""
    x, y, theta = prepared.starts.T
    scaled = np.stack([x / prepared.length, y / prepared.length, np.cos(theta), np.sin(theta)], 1)
    taken = [0]
    while len(taken) < min(_POSES, len(scaled)):
        away = np.linalg.norm(scaled[:, None] - scaled[taken], axis=2).min(axis=1)
        if not np.any(away > 0.0):
            break
        taken.append(int(np.argmax(away)))
    return [(float(x[k]), float(y[k]), float(theta[k])) for k in taken]


def _poses(setting: Prepared, one: tuple[Model, Floats], starts: Floats | None = None) -> Floats:
    """(K, R, T, 3) of starts (K, R, 3); infinite where a run fails."""
    starts = setting.starts[None] if starts is None else starts
    model, values = one
    try:
        found = predicted(setting, model, np.repeat(values[None], len(starts), 0), starts=starts)
    except ValueError:  # values or a start that the simulator refuses
        return np.full((len(starts), *setting.seen.shape), np.inf)
    ended = found.outcomes == Outcome.COMPLETED
    return np.where(ended[..., None, None], found.poses, np.inf)


def _difference(prepared: Prepared, pushes: list[PushPlan], two: Two, sigma: Floats) -> Floats:
    """(R, T, 3) of the two models in σ; NaN where a run of either fails."""
    setting = arranged(prepared, pushes)
    first, second = (_poses(setting, one)[0] for one in two)
    failed = ~(np.isfinite(first) & np.isfinite(second))
    return (
        np.where(failed, np.nan, np.where(failed, 0.0, first) - np.where(failed, 0.0, second))
        / sigma
    )


def _beyond_start(
    prepared: Prepared, pushes: list[PushPlan], two: Two, sigma: Floats, correlation: float
) -> Floats:
    """(R,) the differences in white noise, less what another start would explain; −1 of failed runs."""
    setting = arranged(prepared, pushes)
    apart = _difference(prepared, pushes, two, sigma)
    moved = setting.starts + np.diag(sigma)[:, None]  # (3, R, 3)
    runs = _poses(setting, two[0], np.concatenate([setting.starts[None], moved]))
    able = np.all(np.isfinite(runs), axis=(0, 2, 3)) & np.all(np.isfinite(apart), axis=(1, 2))
    runs, apart = np.where(np.isfinite(runs), runs, 0.0), np.where(np.isfinite(apart), apart, 0.0)
    slopes = (runs[1:] - runs[0]) / sigma
    table = np.moveaxis(np.concatenate([np.zeros_like(slopes[:1]), slopes]), 0, -1)
    seen = np.ones(setting.seen.shape, dtype=bool)
    at = tangent(table.reshape(len(pushes), -1, 4), 1, seen, correlation)
    left = at.cleaned(at.rows(apart))
    return np.where(able, np.linalg.norm(left, axis=1), -1.0)
