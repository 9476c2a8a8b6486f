"""What each effect would change in these recordings, beyond what a refit could take."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from meso_robust.diagnosis.baseline import Baseline
from meso_robust.diagnosis.tangent import Tangent
from meso_robust.diagnosis.trials import Trial, shown
from meso_robust.identification.forward import predicted
from meso_robust.identification.models import Model, Parameter, with_effects
from meso_robust.identification.prepared import Prepared
from meso_robust.simulator.catalogue import values_in_si
from meso_robust.types import Floats

_FLAT = 1e-6  # σ: a change this small is rounding
SEEN = 5.0
"""σ by which an effect of relevant size must change the recordings to count as visible."""
_AT_ONCE = 8  # signatures that are projected at once: no more than a cache holds
_ALIKE = 0.99  # cosine beyond which two signatures are one
# typical changes: a hundred times the drag of the film at the speed of the pushes; beyond it, a dry
# support is as good as alone, and no motion tells how much
_STRONGEST = 1000.0
# of a lay: nine times the drag along it of that across; against the slip, a still stronger one lets no step be solved
_STRONGEST_LAY = 0.8
_RATIOS = ("dry_friction", "stribeck_friction", "breakaway_friction", "uneven_support")
_INSIDE = ("drag_centre_offset", "reference_offset", "registration_shift")
"""Effects whose place cannot be outside the part."""
_IN_THE_IMAGE = ("camera_scale", "camera_rotation", "lens_distortion")
"""Effects about the middle of an image, which lies within what the image shows."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Signature:
    """A trial, and what it changes.

    Attributes
    ----------
    trial
        What is tried.
    columns
        (k, R, M) white changes of the predictions, one for each size of the trial; of a trial without
        sizes the one of the whole effect.
    one_sided
        Whether the sizes cannot be negative.
    """

    trial: Trial
    columns: Floats
    one_sided: bool

    def left(self, at: Tangent) -> Floats:
        """(k, R M) of the changes that a refit could not take."""
        return at.evidence(self.columns)


def lefts(at: Tangent, signatures: Sequence[Signature]) -> Iterator[Floats]:
    """(k, R M) of each signature in turn what a refit could not take: `Signature.left`, some at once.

    Parameters
    ----------
    at
        What the fit can take.
    signatures
        Any number.
    """
    for first in range(0, len(signatures), _AT_ONCE):
        some = signatures[first : first + _AT_ONCE]
        whole = at.evidence(np.concatenate([one.columns for one in some]))
        yield from np.split(whole, np.cumsum([len(one.columns) for one in some])[:-1])


def extended(model: Model, trials: tuple[Trial, ...], prepared: Prepared) -> Model:
    """The model with the numbers of some trials, none of which may leave what a thing can be."""
    made = with_effects(
        model,
        {trial.effect: trial.scales for trial in trials},
        fixed={trial.effect: trial.held for trial in trials if trial.held},
        tip_radius=prepared.tip_radius,
    )
    base = len(model.parameters)
    added = tuple(_physical(one, prepared) for one in made.parameters[base:])
    return replace(made, parameters=(*made.parameters[:base], *added))


def _physical(parameter: Parameter, prepared: Prepared) -> Parameter:
    """The parameter in the range that it can have with the part and the motion of some recordings."""
    length = prepared.length
    effect, key = parameter.key.split(".")
    low, high = parameter.likely or (-np.inf, np.inf)
    if effect == "camera_latency":
        low = 0.0  # a camera cannot see ahead
    elif key == "time_s":
        # what settles within the shortest recording is an offset rather than a drift
        low = 0.5 * float(np.min(prepared.times[:, -1] - prepared.times[:, 0]))
    elif effect in _IN_THE_IMAGE and key.startswith("about_"):
        low, high = shown(prepared)[:, "xy".index(key[6])]
    elif effect in _INSIDE:
        low, high = -length, length
    elif key == "fraction":
        low, high = -_STRONGEST_LAY, _STRONGEST_LAY
    elif effect in _RATIOS and key == "ratio":
        high = _STRONGEST * parameter.scale
    return replace(parameter, low=max(parameter.low, low), high=min(parameter.high, high))


def start_of(trial: Trial, sizes: Floats) -> Floats:
    """(p,) values in SI of the numbers of a trial, with sizes (k,) in units of their changes."""
    shown = dict(zip(trial.sizes, np.multiply(list(trial.sizes.values()), sizes), strict=True))
    shown |= {key: trial.shape[key] for key in trial.free}
    values = values_in_si({trial.effect: shown})[trial.effect]
    return np.array([values[key] for key in trial.scales])


def within(model: Model, values: Floats) -> Floats:
    """Values (K, n) moved into the ranges of the model."""
    low = [parameter.low for parameter in model.parameters]
    high = [parameter.high for parameter in model.parameters]
    return np.clip(values, low, high)


def signatures(baseline: Baseline, trials: list[Trial]) -> list[Signature]:
    """Signatures of trials about a fit; those with which a push fails are left out."""
    plain = _poses(baseline, baseline.model, baseline.fits.values)[0][0]
    found = []
    for effect in dict.fromkeys(trial.effect for trial in trials):
        own = [trial for trial in trials if trial.effect == effect]
        found += _of_effect(baseline, own, plain)
    return found


def _of_effect(baseline: Baseline, trials: list[Trial], plain: Floats) -> list[Signature]:
    """Signatures of the trials of one effect, in one batch for each set of held and of fitted numbers."""
    rows, poses, ended = [], [], []
    groups: dict[tuple[frozenset[tuple[str, float]], frozenset[str]], list[Trial]] = {}
    for trial in trials:
        group = frozenset(trial.held.items()), frozenset(trial.scales)
        groups.setdefault(group, []).append(trial)
    for alike in groups.values():
        model = extended(baseline.model, (alike[0],), baseline.prepared)
        values, owners = [], []
        for trial in alike:
            for sizes in np.eye(len(trial.sizes)) if trial.sizes else np.zeros((1, 0)):
                values.append(np.append(baseline.fits.values[0], start_of(trial, sizes)))
                owners.append(trial)
        found, completed = _poses(baseline, model, within(model, np.array(values)))
        rows += owners
        poses += list(found)
        ended += list(completed)
    return [
        one
        for trial in trials
        if (one := _signature(baseline, trial, plain, rows, poses, ended)) is not None
    ]


def _signature(
    baseline: Baseline,
    trial: Trial,
    plain: Floats,
    rows: list[Trial],
    poses: list[Floats],
    ended: list[bool],
) -> Signature | None:
    own = [k for k, row in enumerate(rows) if row is trial]
    if not all(ended[k] for k in own):
        return None
    changes = (np.stack([poses[k] for k in own]) - plain) / baseline.settings.sigma
    if trial.sizes and not np.any(np.abs(changes) > _FLAT):
        changes = np.zeros_like(changes)
    model = extended(baseline.model, (trial,), baseline.prepared)
    low = {
        one.key.split(".")[1]: one.low for one in model.parameters[len(baseline.model.parameters) :]
    }
    return Signature(
        trial=trial,
        columns=baseline.tangent.rows(np.where(baseline.seen, changes, 0.0)),
        one_sided=not trial.sizes or all(low[key] >= 0.0 for key in trial.sizes),
    )


def _poses(baseline: Baseline, model: Model, values: Floats) -> tuple[Floats, list[bool]]:
    """Poses (K, R, T, 3) with the starts of the fit, and whether all runs ended well."""
    try:
        found = predicted(
            baseline.prepared,
            model,
            values,
            starts=baseline.fits.starts[0],
            offsets=baseline.fits.offsets[0],
        )
    except ValueError:  # the effect does not go with these starts, such as a post within a part
        return np.zeros((len(values), *baseline.seen.shape)), [False] * len(values)
    return found.poses, found.completed.tolist()


def estimate(evidence: Floats, left: Floats, one_sided: bool) -> tuple[Floats, float]:
    """Sizes (k,) of an effect by least squares, and what they take of the sum of squares.

    Parameters
    ----------
    evidence
        (R M,) of the recordings.
    left
        (k, R M) of the signature.
    one_sided
        Whether sizes cannot be negative.
    """
    gram = left @ left.T
    slope = left @ evidence
    sizes = np.linalg.lstsq(gram, slope, rcond=1e-9)[0]
    if one_sided:
        sizes = np.maximum(sizes, 0.0)
    return np.asarray(sizes), float(2.0 * sizes @ slope - sizes @ gram @ sizes)


@dataclass(frozen=True, slots=True, kw_only=True)
class Visibility:
    """How well an effect shows.

    Attributes
    ----------
    effect
        Name.
    sigma
        By how much the best of its forms changes the recordings at a relevant size, beyond what a
        refit could take.
    alike
        Effects whose signature is the same.
    """

    effect: str
    sigma: float
    alike: tuple[str, ...]

    @property
    def seen(self) -> bool:
        """Whether the recordings could show it."""
        return self.sigma >= SEEN


def visibilities(at: Tangent, signatures: list[Signature]) -> tuple[Visibility, ...]:
    """Visibility of every effect in the recordings of a fit."""
    left = {id(one): of for one, of in zip(signatures, lefts(at, signatures), strict=True)}
    best: dict[str, Signature] = {}
    for one in signatures:
        name = one.trial.effect
        if one.trial.law:  # what another form adds is neither the effect's size nor its likeness
            continue
        if name not in best or _size(left[id(one)]) > _size(left[id(best[name])]):
            best[name] = one
    spaces = {name: _space(left[id(one)]) for name, one in best.items()}
    return tuple(
        Visibility(
            effect=name,
            sigma=_size(left[id(one)]),
            alike=tuple(
                other
                for other, space in spaces.items()
                if other != name and _contains(space, spaces[name])
            ),
        )
        for name, one in best.items()
    )


def _size(left: Floats) -> float:
    """Length of the longest change."""
    return float(np.linalg.norm(left, axis=1).max(initial=0.0))


def _space(left: Floats) -> Floats:
    """(RM, k) orthonormal."""
    if not np.any(left):
        return np.zeros((left.shape[1], 0))
    ways, sizes, _ = np.linalg.svd(left.T, full_matrices=False)
    return np.asarray(ways[:, sizes > 1e-3 * sizes[0]])


def _contains(whole: Floats, part: Floats) -> bool:
    """Whether one space holds all directions of another, nearly."""
    if not part.shape[1] or whole.shape[1] < part.shape[1]:
        return False
    return bool(np.linalg.svd(whole.T @ part, compute_uv=False).min() > _ALIKE)
