"""At which stage of the chain arises what a model leaves: hidden inputs that vary alike in all windows.

An input of a stage is drawn anew in every window, from one normal distribution of mean nought. How wide that is, is what
makes the recordings likeliest (type II maximum likelihood, D. J. C. MacKay 1992, doi:10.1162/neco.1992.4.3.415). So a
stage must not only follow what is wrong where something is, but move nothing where nothing is.

Tips may be off by more than a straight line tells: one that is nearer than commanded pushes, one that is farther lets go.
So inputs of the tips, and of the image, which is off against them alike, are told about tips that are fitted window by
window. Where a model is far off, that which has more inputs explains more, whatever it is: so what may be wrong with an
image is asked one by one. How long windows are to be is not known: those of either length count alike.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TypeAlias

import numpy as np

from meso_robust.copies import shared
from meso_robust.diagnosis.document import Channel
from meso_robust.diagnosis.hidden_inputs import TIP_OFFSET
from meso_robust.diagnosis.noise import Noise
from meso_robust.diagnosis.windows import PIECES, Windows, windowed
from meso_robust.identification.models import Model
from meso_robust.identification.prepared import Prepared
from meso_robust.recordings import RecordingSet
from meso_robust.types import Floats, Ints

Groups: TypeAlias = tuple[tuple[str, ...], ...]

_CUTS = (PIECES, (8, 15))
_APART = 0.05  # of the part's size, by which tips may be off in a window
_TIPS: Groups = (("tips x", "tips y"), ("tips' drift x", "tips' drift y"))
_IMAGE: Groups = (
    ("camera_drift.x_um_s", "camera_drift.y_um_s"),
    ("camera_latency.time_ms",),
    ("camera_anisotropy.x_percent", "camera_anisotropy.y_percent"),
)
_INPUTS: Mapping[Channel, tuple[Groups, ...]] = {
    "support": ((("rho",), ("drag_centre_offset.x_um", "drag_centre_offset.y_um")),),
    "contact": ((("mu", "mu_t"),),),
    "actuation": (_TIPS,),
    "observation": tuple((of,) for of in _IMAGE),
    "environment": ((("body_force.x_um_s", "body_force.y_um_s"),),),
    "geometry": ((("tip_radius.excess_um",),),),
}
"""By stage, what may vary there, one or the other: groups of inputs, those of a group drawn from one distribution."""
_ABOUT_TIPS: Mapping[Channel, tuple[Groups, ...]] = {
    "actuation": (_TIPS,),
    "observation": tuple((_TIPS[0], of) for of in _IMAGE),
}
"""Of those that tips may hide, about tips as fitted; an image that is off as a whole is tips that are."""
_ROUNDS = 20  # of a search for the width


def stages(
    recordings: RecordingSet, prepared: Prepared, model: Model, values: Floats, noise: Noise
) -> dict[Channel, float]:
    """Evidence in nats for hidden inputs at each stage, beyond a model.

    Parameters
    ----------
    recordings, prepared
        The same recordings as read and as prepared.
    model, values
        The model and its fitted numbers (n,), SI.
    noise
        Of the camera.

    Returns
    -------
    dict[Channel, float]
        By stage, the mean of longer and of shorter windows; negative where its inputs are not worth their number.
    """
    aside = (0.0,) if prepared.tip_offset else (0.0, _APART * prepared.length)
    asked = [(pieces, apart) for pieces in _CUTS for apart in aside]

    def costs(one: tuple[tuple[int, int], float]) -> tuple[float, dict[Channel, float]]:
        pieces, apart = one
        told = windowed(
            recordings,
            model,
            values,
            noise.sigma,
            noise.correlation,
            prepared=prepared,
            pieces=pieces,
            apart=apart,
        )
        inputs = _ABOUT_TIPS if apart else _INPUTS
        plain = 0.5 * sum(float(of.data @ of.data) for of in told.found.each)
        return plain, {
            channel: min(_cost(told, groups) for groups in either)
            for channel, either in inputs.items()
        }

    found = dict(zip(asked, shared(costs, asked), strict=True))
    worth = dict.fromkeys(_INPUTS, 0.0)
    for pieces in _CUTS:
        # windows about tips as fitted are held against those about tips as commanded, too
        plain = found[pieces, 0.0][0]
        told = [found[pieces, apart][1] for apart in aside]
        for channel in worth:
            least = min(of[channel] for of in told if channel in of)
            worth[channel] += (plain - least) / len(_CUTS)
    return worth


def _cost(told: Windows, groups: Groups) -> float:
    """Negative logarithm of the likelihood in nats, but for a constant, of inputs of the best widths."""
    keys = [one.key for one in told.inputs.model.parameters]
    keys += [key for pair in _TIPS for key in pair]
    columns = [(keys.index(key), g) for g, of in enumerate(groups) for key in of if key in keys]
    index, group = np.array(columns, dtype=np.int64).reshape(-1, 2).T
    shift = _shift(told)
    normal, slope, square = [], [], 0.0
    for one, by in zip(told.found.each, shift, strict=True):
        own = one.columns[:, index]
        data = one.data + one.columns[:, -4:] @ by
        normal.append(own.T @ own)
        slope.append(own.T @ data)
        square += float(data @ data)
    freedom = sum(one.freedom for one in told.found.each)
    price = 0.5 * (group.max(initial=-1) + 1) * float(np.log(max(freedom, np.e)))
    return 0.5 * square - _gain(np.stack(normal), np.stack(slope), group) + price


def _shift(told: Windows) -> Floats:
    """(W, 4) offset and drift of the tips at which the windows were fitted, in their units."""
    begin, end = told.prepared.instants[:, [0]], told.prepared.instants[:, [-1]]
    first, last = told.offsets[:, :2] / TIP_OFFSET, told.offsets[:, 2:] / TIP_OFFSET
    drift = (last - first) / (end - begin)
    return np.hstack([first - begin * drift, drift])


def _gain(normal: Floats, slope: Floats, group: Ints) -> float:
    """Nats that inputs of the best widths gain, of normal equations (W, k, k) and (W, k)."""
    count = normal.shape[2]
    same = group[:, None] == group
    mean = same @ np.einsum("wkk->k", normal) / (len(normal) * same.sum(axis=1))
    scale = np.sqrt(np.maximum(mean, 1e-300))
    normal, slope = normal / np.outer(scale, scale), slope / scale
    width, best = np.full(count, 10.0), 0.0
    for _ in range(_ROUNDS):
        inner = np.eye(count) + width[:, None] * normal * width
        inverse = np.linalg.inv(inner)
        along = np.einsum("wij,wj->wi", inverse, width * slope)
        _, size = np.linalg.slogdet(inner)
        best = max(best, 0.5 * float(np.sum(width * slope * along) - np.sum(size)))
        told = np.sum(1.0 - np.einsum("wkk->wk", inverse), axis=0)
        squares = np.sum((width * along) ** 2, axis=0)
        width = np.sqrt((same @ squares) / np.maximum(same @ told, 1e-12))
    return best
