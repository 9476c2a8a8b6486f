"""What recordings cannot show, and why, in words."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from meso_robust.errors import InputError
from meso_robust.identification.forward import predicted
from meso_robust.identification.models.model import Model
from meso_robust.identification.prepared import Prepared
from meso_robust.identification.problem import Fits
from meso_robust.identification.profiles import Profile
from meso_robust.types import Floats
from meso_robust.wording import counted

ROUNDING = 1e-10
"""Change of a predicted pose (m, θ times the characteristic length) that is taken for rounding."""
_WIDE = 0.3  # standard deviation of a combination, in coordinates, that counts as unknown
_PER_PUSH = 2  # numbers that a push shows
_FRICTION = ("mu", "mu_t")
_STICK = 1  # contact mode; those above it slip
_MOVED = 5.0  # standard deviations by which a part that was pushed has moved


@dataclass(frozen=True, slots=True, kw_only=True)
class NotIdentifiable:
    """A parameter, or a combination, that the recordings do not determine."""

    name: str
    why: str


def least_pushes(model: Model) -> int:
    """Fewest pushes that the parameters are searched in.

    Along the push the part goes where the tip goes, whatever the parameters; a push shows two numbers:
    by how much the part turns, and by how much it goes sideways.
    """
    return -(-int(model.fitted.sum()) // _PER_PUSH)


def check_enough(prepared: Prepared, model: Model) -> None:
    """Refuse a set that cannot determine the model, before any search.

    Raises
    ------
    InputError
        If too few recordings show a part that moves; the message says how many pushes are missing,
        and which.
    """
    moving = moved(prepared)
    missing = least_pushes(model) - int(moving.sum())
    if missing > 0:
        still = f", {int((~moving).sum())} in which nothing moves," if np.any(~moving) else ""
        raise InputError(
            f"{counted(len(prepared.files), 'recording')}{still} for {int(model.fitted.sum())} parameters of "
            f"model {model.name}; must be at least {least_pushes(model)} pushes, as each shows two "
            f"numbers (rotation and sideways motion); record {missing} more, at other places along the long "
            "and the short sides, off the middle so that the part turns"
        )


def moved(prepared: Prepared) -> np.ndarray[tuple[int], np.dtype[np.bool_]]:
    """(R,) whether the part was seen to move by more than noise explains."""
    sigma = prepared.sigmas
    noise = np.array([sigma.position or 0.0, sigma.position or 0.0, sigma.orientation or 0.0])
    least = np.maximum(_MOVED * noise, prepared.length * np.array([1e-4, 1e-4, 1e-4]))
    least[2] = max(_MOVED * noise[2], 1e-4)
    seen = prepared.seen
    far = np.nanmax(np.abs(seen - seen[:, :1]), axis=1)
    return np.asarray(np.any(far > least, axis=1))


def found_unseen(prepared: Prepared, model: Model, values: Floats) -> list[NotIdentifiable]:
    """Parameters that no motion can show; each is shown by the simulator at both ends of its range.

    A parameter that does change the motion, against what the model says, is not listed.
    """
    listed = []
    for column in np.flatnonzero(~model.fitted):
        parameter = model.parameters[column]
        ends = np.repeat(values[None], 2, axis=0)
        ends[:, column] = parameter.low, parameter.high
        poses = predicted(prepared, model, ends).poses
        scale = np.array([1.0, 1.0, prepared.length])
        change = float(np.abs((poses[1] - poses[0]) * scale).max())
        if change <= ROUNDING:
            why = (
                f"{parameter.unseen}; simulated with {parameter.low:g} and {parameter.high:g}, all "
                f"{counted(len(prepared.files), 'recording')} agree within {1e6 * change:.1g} µm"
            )
            listed.append(NotIdentifiable(name=parameter.key, why=why))
    return listed


def found_scale() -> NotIdentifiable:
    """The scale of all forces: it is no parameter of any model, and this says why."""
    return NotIdentifiable(
        name="force_scale",
        why="the motion depends on ratios of forces only (for a film on ρ = e_θ / e_x, not on e_x): "
        "on a support that resists k times as much the part moves in the same way; a force sensor at a tip would show it",
    )


def found_open(
    prepared: Prepared, model: Model, fits: Fits, profiles: tuple[Profile, ...]
) -> list[NotIdentifiable]:
    """Parameters without a bound on one side or both, about the one fit in `fits`."""
    listed = []
    for profile in profiles:
        if not (profile.open_low or profile.open_high):
            continue
        parameter = model.parameters[model.keys.index(profile.key)]
        unit = f" {parameter.unit}" if parameter.unit else ""
        low, high = parameter.shown(profile.low), parameter.shown(profile.high)
        known = {
            (True, True): "no bound at all",
            (True, False): f"only an upper bound, {high:.4g}{unit}",
            (False, True): f"only a lower bound, {low:.4g}{unit}",
        }[profile.open_low, profile.open_high]
        why = f"{known}: the likelihood stays level to the end of the range"
        if profile.open_high and profile.key in _FRICTION:
            why += _sticks(prepared, model, fits, profile)
        listed.append(NotIdentifiable(name=profile.key, why=why))
    return listed


def _sticks(prepared: Prepared, model: Model, fits: Fits, profile: Profile) -> str:
    """Whether friction has no upper bound because tips that stick cannot stick more."""
    values = fits.values.copy()
    values[0, model.keys.index(profile.key)] = profile.high
    if not model.valid(values)[0]:
        return ""
    modes = predicted(prepared, model, values, starts=fits.starts, offsets=fits.offsets).modes
    if np.any(modes > _STICK):
        return ""
    return (
        f"; simulated with {profile.high:.3g} no tip slips in any recording, and more friction cannot "
        "stick more: push at a slant or nearer to an end of a side, so that the tip slips"
    )


def found_combined(model: Model, information: Floats) -> list[NotIdentifiable]:
    """Directions of the parameters along which the likelihood hardly changes.

    Parameters
    ----------
    model
        The model, n parameters.
    information
        (n, n) about its coordinates, divided by the inflation.
    """
    columns = np.flatnonzero(model.fitted)
    values, vectors = np.linalg.eigh(information[np.ix_(columns, columns)])
    listed = []
    for value, vector in zip(values, vectors.T, strict=True):
        width = 1.0 / np.sqrt(max(value, 1e-12))
        share = np.abs(vector) / np.abs(vector).max()
        named = [model.keys[columns[k]] for k in np.argsort(-share) if share[k] > 0.25]
        if width < _WIDE or len(named) < 2:
            continue
        signs = [
            f"{'+' if vector[k] > 0 else '−'} {share[k]:.2g} {model.keys[columns[k]]}"
            for k in np.argsort(-share)
            if share[k] > 0.25
        ]
        why = (
            f"only combinations of {', '.join(named)} are determined; they may change together "
            f"(in units of their scales: {' '.join(signs)}) and the motion stays within the noise"
        )
        listed.append(NotIdentifiable(name=" & ".join(sorted(named)), why=why))
    return listed
