"""What goes into the conductor and comes out of it, as plain values that a journal keeps."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any, Literal

from meso_robust.live.sight import Sight

Word = Literal["", "stop", "yes", "no"]
Outcome = Literal["done", "refused", "stopped", "fault", "dry_run"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Seen:
    """A new frame."""

    number: int
    time: float
    """Of its exposure, s."""
    digest: int
    """Of its pixels: two frames of a camera that works are never the same."""
    sight: Sight


@dataclass(frozen=True, slots=True, kw_only=True)
class Place:
    """Where a manipulator says that it is; um, its own axes."""

    x_um: float
    y_um: float
    height_um: float
    busy: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class Reading:
    """Everything that is read in one turn of the loop."""

    time: float
    """s, on the laboratory's clock."""
    seen: Seen | None
    """The new frame, if there is one."""
    places: Mapping[str, Place]
    """By manipulator."""
    stage_um: tuple[float, float] | None = None
    word: Word = ""
    """What the user said."""
    fault: str = ""
    """What a device or the tracker did instead of answering."""
    latency_s: float = 0.0
    """From the last frame to the commands that followed from it."""

    def document(self) -> dict[str, Any]:
        """As the journal keeps it."""
        return asdict(self)


def reading_of(values: Mapping[str, Any]) -> Reading:
    """The reading that a journal keeps.

    Parameters
    ----------
    values
        Of `Reading.document`, as JSON has them.

    Returns
    -------
    Reading
        The very same.
    """
    seen = values["seen"]
    given = dict(values)
    given["places"] = {name: Place(**place) for name, place in values["places"].items()}
    if seen is not None:
        given["seen"] = Seen(**{**seen, "sight": _sight(seen["sight"])})
    stage = values["stage_um"]
    given["stage_um"] = None if stage is None else (stage[0], stage[1])
    return Reading(**given)


def _sight(values: Mapping[str, Any]) -> Sight:
    lists = {name: values[name] for name in ("pose", "sigma", "covariance")}
    tuples = {name: None if value is None else tuple(value) for name, value in lists.items()}
    return Sight(**{**values, **tuples})


@dataclass(frozen=True, slots=True, kw_only=True)
class Command:
    """What is to be done now."""

    do: Literal["go", "lift", "halt", "ask", "end"]
    name: str = ""
    """The manipulator."""
    x_um: float = 0.0
    y_um: float = 0.0
    """Its target, own axes."""
    speed_um_s: float = 0.0
    height_um: float = 0.0
    text: str = ""
    """The question, or why it ends."""
    outcome: Outcome | Literal[""] = ""

    def document(self) -> dict[str, Any]:
        """As the journal keeps it, without what is not said."""
        return {key: value for key, value in asdict(self).items() if value not in ("", 0.0)}


HALT = Command(do="halt")
