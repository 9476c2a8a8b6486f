"""A camera's transform put right by what a diagnosis measured of it, and what is left of the error then.

An image that is turned by φ or scaled by 1 + s about a place m is put right by the best values φ₀, s₀, m₀:
of a place x, seen at y, the laboratory makes

    x̂ = R(−φ₀) (y − m₀) + m₀,            x̂ − x = (R(φ − φ₀) − I) (x − m) + (R(−φ₀) − I) (m − m₀);
    x̂ = (y + s₀ m₀) / (1 + s₀),          x̂ − x = ((s − s₀) (x − m) − s₀ (m − m₀)) / (1 + s₀).

So what is left is a turn or a scale about the same place, by what its interval leaves beside the best
value, and a shift of |φ₀| |m − m₀| or |s₀| |m − m₀| / (1 + s₀) at most. All of it goes into the model that
a plan is made with.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

from meso_robust.identification.document import ModelDocument, ParameterSection
from meso_robust.live.lab_file import CameraSection, Lab

CORRECTED: Mapping[str, str] = {"camera_rotation": "angle_deg", "camera_scale": "percent"}
"""Effects that the camera's section of ``lab.toml`` can put right, and their sizes."""
_IN_THE_IMAGE = (
    "camera_anisotropy",
    "camera_drift",
    "camera_latency",
    "lens_distortion",
    "registration_shift",
)
"""Effects that are seen in between: the equations above are of one effect of the image alone, but for a delay."""
_OUTWARD = 1.0 + 1e-9  # beyond the rounding of what follows
_SHIFT = "registration_shift"


@dataclass(frozen=True, slots=True, kw_only=True)
class SetRight:
    """A laboratory put right.

    Attributes
    ----------
    lab
        With the camera's transform as measured.
    model
        Of the recordings, with what is left of the camera's error in place of the error.
    words
        What was changed in ``lab.toml``.
    """

    lab: Lab
    model: ModelDocument
    words: str


def set_right(lab: Lab, model: ModelDocument) -> SetRight | None:
    """Put a camera right by a fitted model.

    Parameters
    ----------
    lab
        That the recordings were made with.
    model
        Of a diagnosis; in the units of its file.

    Returns
    -------
    SetRight | None
        None where the model has no such error of the camera, several at once, one without an interval, or
        the laboratory a stage that the image moves with.
    """
    effects = model.model.split("+")[1:]
    told = [one for one in effects if one in CORRECTED]
    disturbed = any(one in effects for one in _IN_THE_IMAGE if one != "camera_latency")
    if len(told) != 1 or disturbed or lab.stage_label or model.diagnosis != "named":
        return None
    effect = told[0]
    size = model.parameters.get(f"{effect}.{CORRECTED[effect]}")
    place = [model.parameters.get(f"{effect}.about_{axis}_um") for axis in "xy"]
    held = any(key.startswith(f"{effect}.") for key in model.held)
    fitted = [one for one in (size, *place) if one is not None]
    if size is None or held or any(one.open_low or one.open_high for one in fitted):
        return None
    middle = tuple(0.0 if one is None else one.value for one in place)
    far = math.hypot(*(0.0 if one is None else _reach(one) for one in place))
    if effect == "camera_rotation":
        camera = _turned(lab.camera, size.value, middle)
        left, shift = _beside(size, 1.0), math.radians(abs(size.value)) * far
    else:
        share = 0.01 * size.value
        camera = _scaled(lab.camera, share, middle)
        left, shift = _beside(size, 1.0 + share), abs(share) * far / (1.0 + share)
    parameters = {**model.parameters, f"{effect}.{CORRECTED[effect]}": left}
    names = model.model
    if shift > 0.0:
        names = f"{names}+{_SHIFT}"
        parameters |= {f"{_SHIFT}.{axis}_um": _around(shift * _OUTWARD) for axis in "xy"}
    changed = ", ".join(
        f"{key} {_told(getattr(lab.camera, key))} → {_told(getattr(camera, key))}"
        for key in ("pixel_size_um", "centre_um", "rotation_deg")
        if getattr(lab.camera, key) != getattr(camera, key)
    )
    return SetRight(
        # axes and offsets were read with the laboratory: it needs no file beside it any more
        lab=lab.model_copy(update={"camera": camera, "calibration": ""}),
        model=model.model_copy(update={"model": names, "parameters": parameters}),
        words=changed,
    )


def _turned(camera: CameraSection, angle: float, about: tuple[float, ...]) -> CameraSection:
    """The camera without a turn of its image by an angle in deg about a place in um."""
    c, s = math.cos(math.radians(angle)), math.sin(math.radians(angle))
    x, y = (a - b for a, b in zip(camera.centre_um, about, strict=True))
    return camera.model_copy(
        update={
            "rotation_deg": camera.rotation_deg - angle,
            "centre_um": (about[0] + c * x + s * y, about[1] + c * y - s * x),
        }
    )


def _scaled(camera: CameraSection, share: float, about: tuple[float, ...]) -> CameraSection:
    """The camera without a scale of its image by 1 + share about a place in um."""
    centre = tuple(
        (a + share * b) / (1.0 + share) for a, b in zip(camera.centre_um, about, strict=True)
    )
    return camera.model_copy(
        update={"pixel_size_um": camera.pixel_size_um / (1.0 + share), "centre_um": centre}
    )


def _beside(size: ParameterSection, over: float) -> ParameterSection:
    """What an interval leaves beside its best value, as a share of a whole."""
    low, high = ((end - size.value) * _OUTWARD / over for end in (size.low, size.high))
    return size.model_copy(update={"value": 0.0, "low": low, "high": high})


def _reach(place: ParameterSection) -> float:
    return max(place.high - place.value, place.value - place.low)


def _around(far: float) -> ParameterSection:
    return ParameterSection(value=0.0, low=-far, high=far, open_low=False, open_high=False)


def _told(value: float | tuple[float, ...]) -> str:
    if isinstance(value, tuple):
        return f"[{', '.join(_told(one) for one in value)}]"
    return f"{value:.6g}"
