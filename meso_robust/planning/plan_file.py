"""The form of ``plan.json``: its policy, and its moves for the nominal run.

Nothing here imports compiled code, so that a bad file is refused at once.
"""

from __future__ import annotations

import hashlib
import json
from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field, FiniteFloat

from meso_robust.primitives.action import Action
from meso_robust.reading import Deg, PaperStep, Um
from meso_robust.task import Heading

Commanded = Annotated[float, Field(json_schema_extra={"minimum": -1e6, "maximum": 1e6})]
"""um; ``reading`` keeps the limits, with an advice about the unit."""
Pair = tuple[Commanded, Commanded]
HexPair = tuple[str, str]
"""Two doubles as ``float.hex`` writes them: exactly."""


class Document(BaseModel):
    """What a program writes: every key is known, no value changes."""

    model_config = ConfigDict(extra="forbid", frozen=True, populate_by_name=True)


class AimDocument(Document):
    """A commanded coordinate: ``offset_um`` from the sensed part or from the world's origin."""

    relative_to: Literal["sensed part", "world"]
    """What the offset is added to: the coordinate sensed before the move, or the world's zero."""
    offset_um: Commanded
    """The offset, um, along the axis that the key names."""


class RuleDocument(Document):
    """A move as a function of the pose sensed before it."""

    step: PaperStep
    """Step of the paper's algorithm, 1 to 4, that the move belongs to."""
    primitive: str
    """The primitive: y_translation, rotation or x_translation."""
    action: Action
    """Which certified motion the move is."""
    side: Annotated[int, Field(json_schema_extra={"minimum": -1, "maximum": 1})]
    """Of a tilt or a rotation: 1 turns the part counter-clockwise in these axes, -1 clockwise; else 0."""
    dual_x: AimDocument
    """x of the middle of the two active tips' centres at the start; the push goes along -x of the axes of `heading`."""
    dual_y: AimDocument
    """y of that middle."""
    dual_end_x: AimDocument
    """x of that middle at the end of the travel."""
    single_x: AimDocument | None = None
    """x of the passive tip's centre; null if the move has none."""
    single_y: AimDocument | None = None
    """y of the passive tip's centre; null if the move has none."""
    heading: Heading = "-x"
    """Direction of the push; the offsets are along and across it, in axes turned with it."""
    mirrored: bool = False
    """Whether the y axis of these axes is mirrored."""


class ProbeDocument(Document):
    """A probe of a move; an active one travels and is lifted out of the plane afterwards.

    Places are those of the tip's centre; a certificate holds for tips that are points there.
    """

    name: str
    """The tip: of the dual-tip probe dtp_top is the one on the right and dtp_bottom the one on the left,
    seen along the push, stp is the single one. So dtp_top has the larger y of the two in a push along
    -x, the smaller y along +x, the smaller x along -y and the larger x along +y."""
    start_um: Pair
    """[x, y] of the tip's centre before the move, free of contact, um, world frame."""
    passive: bool = False
    """Whether the tip rests while the others travel."""


class BoxDocument(Document):
    """A box of poses."""

    x_um: tuple[Um, Um]
    """[low, high] of the reference point's x, um."""
    y_um: tuple[Um, Um]
    """[low, high] of the reference point's y, um."""
    theta_deg: tuple[Deg, Deg]
    """[low, high] of the orientation, deg."""


class ExactBox(Document):
    """A box of poses, exactly."""

    x_m: HexPair
    """[low, high] of the reference point's x, m."""
    y_m: HexPair
    """[low, high] of the reference point's y, m."""
    theta_rad: HexPair
    """[low, high] of the orientation, rad."""


class MoveDocument(Document):
    """A move as the hardware carries it out."""

    step: PaperStep
    """Step of the paper's algorithm, 1 to 4, that the move belongs to."""
    primitive: str
    """The primitive: y_translation, rotation or x_translation."""
    probes: tuple[ProbeDocument, ...]
    """Every tip in the plane."""
    travel_um: Pair
    """[x, y] by which the centre of every active tip travels, um, world frame."""
    speed_um_s: Annotated[FiniteFloat, Field(ge=0, le=1e6)]
    """Speed of the travel, um/s."""
    expect: BoxDocument | None
    """Certified box of the part's pose after the move, rounded outward; null if not certified."""


class PlanDocument(Document):
    """A quasi-open-loop plan."""

    schema_: Annotated[Literal["meso-robust/plan/1"], Field(alias="schema")] = "meso-robust/plan/1"
    """Name and version of the format."""
    task: str
    """Name of the task."""
    task_hash: str
    """SHA-256 of the task's values, independent of the layout of its file."""
    policy: tuple[RuleDocument, ...]
    """The plan itself: before each move sense the pose, then command the probes as stated."""
    moves: tuple[MoveDocument, ...]
    """The same moves for the nominal run, in which every error is zero."""

    @property
    def hash(self) -> str:
        """SHA-256 of the plan's values, independent of the layout of its file."""
        text = json.dumps(self.model_dump(mode="json", by_alias=True), sort_keys=True)
        return hashlib.sha256(text.encode()).hexdigest()
