"""What the user states: part, start, goal, probe and uncertainty, checked and frozen."""

from __future__ import annotations

import hashlib
import json
import math
import re
from collections.abc import Callable, Mapping, Sequence
from fractions import Fraction
from os import PathLike
from pathlib import Path
from typing import Annotated, Any, ClassVar, Literal, Self

from pydantic import (
    BaseModel,
    ConfigDict,
    Discriminator,
    Field,
    FiniteFloat,
    Tag,
    model_validator,
)

from meso_robust.corners import Corner, fault, hull, straight_edges
from meso_robust.errors import InputError
from meso_robust.reading import LARGEST_STATED, shown, text_of, toml_values
from meso_robust.tasks import PAPER
from meso_robust.toml_files import checked

# Limits far beyond the mesoscale: they catch a slip of the unit before it becomes a long search.
Length = Annotated[FiniteFloat, Field(ge=1, le=1e5)]
Coordinate = Annotated[FiniteFloat, Field(ge=-1e6, le=1e6)]
Error = Annotated[FiniteFloat, Field(ge=0, le=1e4)]
Friction = Annotated[FiniteFloat, Field(ge=0, le=3)]
Radius = Annotated[FiniteFloat, Field(ge=0, le=1e4)]
SmallAngle = Annotated[FiniteFloat, Field(gt=-30, lt=30)]
Range = tuple[FiniteFloat, FiniteFloat]
Heading = Literal["-x", "-y", "+x", "+y"]


POINT_TIPS = "meso-robust/task/1"
ROUND_TIPS = "meso-robust/task/2"
SCHEMA_2_KEYS = frozenset(
    {
        "size_tolerance_um",
        "squareness_deg",
        "corner_radius_um",
        "tip_spacing_tolerance_um",
        "tip_radius_um",
        "passive_tip_radius_um",
        "max_force_un",
        "friction_common",
        "travel_direction_deg",
        "travel_scale_percent",
        "drag_centre_um",
        "drag_centre_moves",
        "drag_anisotropy_percent",
        "probe_wander_um",
    }
)
"""Keys of sections that a task of schema 1 does not have."""


class _Section(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True, strict=True, title=None)


def _ordered(key: str, ends: Range) -> None:
    if not ends[0] <= ends[1]:
        raise ValueError(f"{key} = {list(ends)}: the lower end must not exceed the upper one")


def _exact(value: float) -> Fraction:
    """The decimal number that a user wrote."""
    return Fraction(repr(value))


def _span(ends: Range) -> str:
    low, high = ends
    return f"{low:g} um" if low == high else f"{low:g} to {high:g} um"


class _Made(_Section):
    """How far a part may be from its outline as stated."""

    size_tolerance_um: Error | None = None
    """Schema 2. Largest error of a length or width: every edge lies within half of it of its place as
    stated, um. Left out: exact."""
    squareness_deg: Annotated[FiniteFloat, Field(ge=0, lt=10)] | None = None
    """Schema 2. Largest error of the direction of each edge, deg. Left out: exact."""
    corner_radius_um: Error | None = None
    """Schema 2. Largest rounding of the corners, um; tips must keep off them. Left out: sharp."""

    def _check_edges(self, corners: Sequence[Corner]) -> None:
        """Refuse tolerances that do not leave the part its edges."""
        size, skew = self.size_tolerance_um or 0.0, self.squareness_deg or 0.0
        rounding = self.corner_radius_um or 0.0
        for key, value, left, rule in (
            (
                "size_tolerance_um",
                size,
                straight_edges(corners, size / 2, 0.0, 0.0),
                "must be smaller than the part, and leave it every edge",
            ),
            (
                "squareness_deg",
                skew,
                straight_edges(corners, size / 2, math.radians(skew), 0.0),
                "must not turn the part inside out",
            ),
            (
                "corner_radius_um",
                rounding,
                straight_edges(corners, size / 2, math.radians(skew), rounding),
                "must leave a straight piece of every edge",
            ),
        ):
            if min(left) <= 0.0:
                raise ValueError(
                    f"{key} = {value}: {rule}; the edge after corner {left.index(min(left))} could "
                    "vanish; give a smaller value"
                )


class Part(_Made):
    """A rectangle, reference point at its centre."""

    length_um: Length
    """Side along the part's x axis at theta = 0, um."""
    width_um: Length
    """Side across it, um."""

    @model_validator(mode="after")
    def _is_a_part(self) -> Self:
        if not self.length_um >= self.width_um:
            raise ValueError(
                f"width_um = {self.width_um} exceeds length_um = {self.length_um}: give the long "
                "side as length_um"
            )
        x, y = _exact(self.length_um) / 2, _exact(self.width_um) / 2
        self._check_edges(((-x, -y), (x, -y), (x, y), (-x, y)))
        return self


class PolygonPart(_Made):
    """A simple polygon, convex or not."""

    polygon_um: Annotated[
        tuple[tuple[Coordinate, Coordinate], ...], Field(min_length=3, max_length=64)
    ]
    """Corners [x, y] at theta = 0, um, counter-clockwise. The origin is the reference point of all
    poses; it must be the centre of drag (of an even film: the centroid), where a force of the film
    does not turn the part."""

    @model_validator(mode="after")
    def _is_an_outline(self) -> Self:
        wrong = fault(self.corners_um)
        if wrong is not None:
            raise ValueError(f"polygon_um: {wrong}")
        self._check_edges(self.corners_um)
        return self

    @property
    def corners_um(self) -> tuple[Corner, ...]:
        """The corners, um, exactly as stated."""
        return tuple((_exact(x), _exact(y)) for x, y in self.polygon_um)

    @property
    def hull(self) -> tuple[int, ...]:
        """Which corners are those of the convex hull, counter-clockwise."""
        return hull(self.corners_um)

    def are_parallel(self, one: int, other: int) -> bool:
        """Whether the edges after two corners have exactly one direction, or opposite ones."""
        corners, count = self.corners_um, len(self.polygon_um)
        (a, b), (c, d) = (
            tuple(q - p for p, q in zip(corners[k], corners[(k + 1) % count], strict=True))
            for k in (one, other)
        )
        return a * d == b * c


def _shape(values: object) -> str:
    """Which of the two outlines a section gives."""
    polygon = isinstance(values, PolygonPart) or (
        isinstance(values, dict) and "polygon_um" in values
    )
    return "polygon" if polygon else "rectangle"


Outline = Annotated[
    Annotated[Part, Tag("rectangle")] | Annotated[PolygonPart, Tag("polygon")],
    Discriminator(_shape),
]


class Pose(_Section):
    """Position of the part's reference point in um and orientation in deg, world frame."""

    x_um: Coordinate
    """x of the part's reference point, um, world frame."""
    y_um: Coordinate
    """y of the part's reference point, um, world frame."""
    theta_deg: Annotated[FiniteFloat, Field(ge=-360, le=360)]
    """Orientation, deg, counter-clockwise; 0: the part's axes lie along the world's."""


class Goal(Pose):
    """A box around a pose."""

    position_tolerance_um: Annotated[FiniteFloat, Field(gt=0, le=1e5)]
    """Half side in x and in y, um."""
    orientation_tolerance_deg: Annotated[FiniteFloat, Field(gt=0, lt=90)]
    """Half width in theta, deg."""


class Probe(_Section):
    """The active dual-tip probe, or several identical ones."""

    tip_spacing_um: Length
    """Distance of the centres of the tips across the push, um."""
    tip_spacing_tolerance_um: Error | None = None
    """Schema 2. Largest error of it, um. Left out: exact."""
    tip_radius_um: tuple[Radius, Radius] | None = None
    """Schema 2, required there. Range of the radius of the tips of the active probe, each with its own
    value, um."""
    passive_tip_radius_um: tuple[Radius, Radius] | None = None
    """Schema 2. Range of the radius of the passive tip, um. Left out: as tip_radius_um."""
    max_force_un: Annotated[FiniteFloat, Field(gt=0, le=1e9)] | None = None
    """Schema 2. Largest force that a contact may have, uN; proved if given. Needs film.drag_un_s_per_um."""
    speed_um_s: Annotated[FiniteFloat, Field(gt=0, le=1e6)]
    """Speed of every move, um/s; on a viscous film the path does not depend on it."""
    headings: Annotated[tuple[Heading, ...], Field(min_length=1)] | None = None
    """Directions in which the active probe can push, one dual-tip probe each; the moves of a plan may
    have different ones. Absent: any, and a plan keeps to one where it can. The passive tip can stand anywhere."""

    @model_validator(mode="after")
    def _each_heading_once(self) -> Self:
        if self.headings is not None and len(set(self.headings)) < len(self.headings):
            raise ValueError(f"headings = {list(self.headings)}: give each direction once")
        return self

    @model_validator(mode="after")
    def _radii_are_ordered(self) -> Self:
        for key in ("tip_radius_um", "passive_tip_radius_um"):
            radius = getattr(self, key)
            if radius is not None:
                _ordered(key, radius)
                self._check_apart(key, radius)
        return self

    def _check_apart(self, key: str, radius: Range) -> None:
        """Refuse tips that could overlap; a passive tip that large would not fit between, either."""
        slack = self.tip_spacing_tolerance_um or 0.0
        if not 2 * _exact(radius[1]) < _exact(self.tip_spacing_um) - _exact(slack):
            less = f" less tip_spacing_tolerance_um = {slack}" if slack else ""
            raise ValueError(
                f"{key} = {list(radius)}: must be less than half of tip_spacing_um = "
                f"{self.tip_spacing_um}{less}, or tips overlap; give the radius, not the diameter, or "
                "tips further apart"
            )


class Uncertainty(_Section):
    """Bounds of everything that is not known exactly.

    The errors of a probe are constant during a move and may differ from move to move; the others are
    constant during a run.
    """

    sensed_position_um: Error
    """Largest error of a sensed x or y, um."""
    sensed_orientation_deg: Annotated[FiniteFloat, Field(ge=0, lt=45)]
    """Largest error of a sensed orientation, deg."""
    probe_position_um: Error
    """Largest error of a probe's x or y, um, rounding of its command included; constant during a move;
    the two tips of the dual-tip probe share it."""
    friction: tuple[Friction, Friction]
    """Range of the friction coefficient between tip and part."""
    film_ratio_um2: Annotated[FiniteFloat, Field(gt=0, le=1e12)]
    """Ratio of the film's rotational to its translational drag, um^2."""
    film_ratio_percent: Annotated[FiniteFloat, Field(ge=0, lt=100)]
    """Largest relative error of it, percent."""
    tip_misalignment_deg: tuple[
        Annotated[FiniteFloat, Field(gt=-30, lt=30)], Annotated[FiniteFloat, Field(gt=-30, lt=30)]
    ]
    """Range of the angle by which the line through both tips is turned counter-clockwise from square
    to the push; positive: the tip on the right, seen along the push, is ahead, whatever the heading."""
    friction_common: bool | None = None
    """Schema 2. Whether both tips have the same friction coefficient at every instant. Left out: each
    has its own."""
    travel_direction_deg: tuple[SmallAngle, SmallAngle] | None = None
    """Schema 2. Range of the angle by which the true travel of a probe is turned counter-clockwise from
    the commanded one; constant during a move. Left out: exact."""
    travel_scale_percent: Annotated[FiniteFloat, Field(ge=0, lt=50)] | None = None
    """Schema 2. Largest relative error of the length of a travel, percent; constant during a move. Left
    out: exact."""
    drag_centre_um: Error | None = None
    """Schema 2. Largest distance of the centre of drag from the reference point, in any direction, um.
    Left out: they are one."""
    drag_centre_moves: bool | None = None
    """Schema 2. Whether the centre of drag may be anywhere within drag_centre_um at every instant, as it is
    over an uneven stage or where the drag depends on the motion. Left out: it is fixed in the part."""
    drag_anisotropy_percent: Annotated[FiniteFloat, Field(ge=0, lt=100)] | None = None
    """Schema 2. Largest difference of the film's drag along two axes, in percent of their mean, the axes
    in any direction, fixed in the part or in the stage. Left out: the film is even."""
    probe_wander_um: Error | None = None
    """Schema 2. How far a moving probe may stray from its straight path in x and in y, um; it does so by
    no more than this in 100 um of travel. Left out: the path is straight."""

    @model_validator(mode="after")
    def _ranges_are_ordered(self) -> Self:
        _ordered("friction", self.friction)
        _ordered("tip_misalignment_deg", self.tip_misalignment_deg)
        if self.travel_direction_deg is not None:
            _ordered("travel_direction_deg", self.travel_direction_deg)
        return self


class Film(_Section):
    """Schema 2. The film under the part, where forces are asked for."""

    drag_un_s_per_um: Annotated[FiniteFloat, Field(gt=0, le=1e9)]
    """Largest translational drag of the film (e_x), uN per um/s."""


class Plan(_Section):
    """What the user demands of the plan."""

    least_y_translations: Annotated[int, Field(ge=0, le=6)]
    """Y-translations before the rotation, even if the start lies in the band of Step 1 already."""


class Slot(_Section):
    """The hole of the peg-in-the-hole task (Fig. 1): two side walls and an end, at rest."""

    mouth_x_um: Coordinate
    """x of the middle of the mouth, um, world frame."""
    mouth_y_um: Coordinate
    """Middle of the mouth, um."""
    opens: Literal["+x", "+y", "-x", "-y"]
    """Direction in which the slot is open."""
    width_um: Length
    """Distance of the side walls, um."""
    depth_um: Length
    """From the mouth to the end, um."""
    wall_um: Length
    """Thickness of the walls, um."""
    friction: Friction
    """Friction coefficient between wall and part."""

    @property
    def outline_um(self) -> tuple[tuple[Fraction, Fraction], ...]:
        """Corners of the solid around the slot, counter-clockwise, um, exactly as stated."""
        half, wall, deep = _exact(self.width_um) / 2, _exact(self.wall_um), _exact(self.depth_um)
        zero, out, back = Fraction(0), half + wall, deep + wall
        own = [(zero, half), (zero, out), (-back, out), (-back, -out), (zero, -out), (zero, -half)]
        return tuple(self._placed(x, y) for x, y in [*own, (-deep, -half), (-deep, half)])

    @property
    def blocks_um(self) -> tuple[tuple[Fraction, Fraction, Fraction, Fraction], ...]:
        """The same solid as rectangles (x from, x to, y from, y to), um."""
        c = self.outline_um
        sides = ((c[0], c[2]), (c[5], c[3]), (c[6], c[2]))  # overlapping at the end's corners
        return tuple(
            (min(a[0], b[0]), max(a[0], b[0]), min(a[1], b[1]), max(a[1], b[1])) for a, b in sides
        )

    def _placed(self, x: Fraction, y: Fraction) -> tuple[Fraction, Fraction]:
        """A point from axes in which the slot opens to +x."""
        turned = {"+x": (x, y), "+y": (-y, x), "-x": (-x, -y), "-y": (y, -x)}[self.opens]
        return _exact(self.mouth_x_um) + turned[0], _exact(self.mouth_y_um) + turned[1]


def _which_keys(schema: dict[str, Any]) -> None:
    """The rules between keys, for the published JSON Schema: :meth:`Task._keys_of_its_schema`."""
    sections: dict[str, type[BaseModel]] = {
        "part": _Made,
        "probe": Probe,
        "uncertainty": Uncertainty,
    }
    newer = {
        name: {
            "properties": dict.fromkeys(sorted(SCHEMA_2_KEYS & model.model_fields.keys()), False)
        }
        for name, model in sections.items()
    }
    schema["if"] = {"properties": {"schema": {"const": POINT_TIPS}}}
    schema["then"] = {"properties": {**newer, "film": False}}
    schema["else"] = {"properties": {"probe": {"required": ["tip_radius_um"]}}}
    with_force = {"properties": {"probe": {"required": ["max_force_un"]}}}
    schema["dependentSchemas"] = {"probe": {"if": with_force, "then": {"required": ["film"]}}}


class Task(_Section):
    """One assembly task."""

    model_config = ConfigDict(json_schema_extra=_which_keys)

    schema_: Annotated[Literal["meso-robust/task/1", "meso-robust/task/2"], Field(alias="schema")]
    """Name and version of the format. 1: point tips, an exact part and one friction coefficient."""
    name: str
    """What the task is called in answers and reports."""
    part: Outline
    """A rectangle (length_um and width_um) or a polygon (polygon_um)."""
    start: Pose
    """The pose as sensed before the first move."""
    goal: Goal
    """The box of poses in which the part must end."""
    probe: Probe
    """The probes that push."""
    uncertainty: Uncertainty
    """Bounds of all errors, sensing, probes, friction and film."""
    plan: Plan
    """What is demanded of the plan."""
    slot: Slot | None = None
    """The slot that the part is inserted into; none if left out."""
    film: Film | None = None
    """The film's drag; needed where forces are asked for."""

    @model_validator(mode="after")
    def _keys_of_its_schema(self) -> Self:
        if self.schema_ == POINT_TIPS:
            newer = self.schema_2_values
            if newer:
                raise ValueError(
                    f"{newer[0]}: belongs to schema = {ROUND_TIPS!r}, and the file has schema = "
                    f"{POINT_TIPS!r}; give that schema, with probe.tip_radius_um, or leave the key out"
                )
        elif self.probe.tip_radius_um is None:
            raise ValueError(
                f"probe.tip_radius_um is missing: schema = {ROUND_TIPS!r} must have it; give the range "
                "[low, high] of the radius of the tips, um"
            )
        if self.probe.max_force_un is not None and self.film is None:
            raise ValueError(
                f"probe.max_force_un = {self.probe.max_force_un}: must come with film.drag_un_s_per_um, "
                "which a force is in proportion to; give the film's drag, or leave out the force"
            )
        if self.uncertainty.drag_centre_moves and not self.uncertainty.drag_centre_um:
            raise ValueError(
                "uncertainty.drag_centre_moves = true: must come with uncertainty.drag_centre_um above 0, how far "
                "the centre may be off; give it, or leave out that it moves"
            )
        return self

    @property
    def schema_2_values(self) -> tuple[str, ...]:
        """Key and value of what schema 1 does not have."""
        sections = {"part": self.part, "probe": self.probe, "uncertainty": self.uncertainty}
        given = [
            (f"{name}.{key}", value)
            for name, section in sections.items()
            for key, value in section
            if key in SCHEMA_2_KEYS
        ]
        if self.film is not None:
            given += [(f"film.{key}", value) for key, value in self.film]
        return tuple(
            f"{key} = {list(value) if isinstance(value, tuple) else value}"
            for key, value in given
            if value is not None
        )

    card: ClassVar[Callable[[Task], str] | None] = None
    """Shows a task in a notebook; put here by the calls, since what draws lies above."""

    @property
    def hash(self) -> str:
        """SHA-256 of the task's values, independent of layout and comments."""
        text = json.dumps(self.to_dict(), sort_keys=True)
        return hashlib.sha256(text.encode()).hexdigest()

    @property
    def tips(self) -> str:
        """How a proof takes the tips; every line that tells a verdict on the task says so."""
        radius, passive = self.probe.tip_radius_um, self.probe.passive_tip_radius_um
        if radius is None:
            return "point tips"
        also = "" if passive in (None, radius) else f", the passive one's {_span(passive)}"
        return f"round tips, radius {_span(radius)}{also}"

    def rectangle(self, use: str) -> Part:
        """The part as a rectangle, for a ``use`` that is made for rectangles.

        Raises
        ------
        InputError
            The part is a polygon.
        """
        if isinstance(self.part, Part):
            return self.part
        raise InputError(
            f"task {self.name!r}: key part.polygon_um: {use}: for rectangles only; give a task "
            "whose part has length_um and width_um, or do without"
        )

    @classmethod
    def load(cls, path: str | PathLike[str]) -> Task:
        """Read and check a task file (TOML); :func:`load_task` says what is raised.

        Examples
        --------
        >>> Task.load("nowhere.toml")
        Traceback (most recent call last):
        meso_robust.errors.InputError: nowhere.toml: cannot be read (No such file or directory); ...
        """
        if not isinstance(path, str | PathLike):
            raise InputError(f"path = {shown(path)}: must be a text or a path of a task file")
        return load_task(Path(path))

    @classmethod
    def paper(cls) -> Task:
        """The task of Section IX-E of the paper.

        Examples
        --------
        >>> task = Task.paper()
        >>> task.goal.theta_deg, task.uncertainty.friction
        (180.0, (0.3, 0.36))
        >>> print(task)
        paper, Section IX-E: part at (2060.4 um, -9.2 um, 90.0 deg), to within 76.0 um and 5.0 deg
        of (0.0 um, 0.0 um, 180.0 deg)
        """
        return load_task(PAPER)

    @classmethod
    def from_dict(cls, values: Mapping[str, Any], source: str = "task") -> Task:
        """Check values as a task file has them, tables as nested mappings.

        Parameters
        ----------
        values
            As ``Task.to_dict`` gives them, or TOML.
        source
            Names them in messages.

        Raises
        ------
        InputError
            A value breaks a rule.

        Examples
        --------
        >>> values = Task.paper().to_dict()
        >>> values["uncertainty"]["sensed_position_um"] = 2.0
        >>> Task.from_dict(values).uncertainty.sensed_position_um
        2.0
        >>> values["uncertainty"]["friction"] = [0.4, 0.3]
        >>> Task.from_dict(values)
        Traceback (most recent call last):
        meso_robust.errors.InputError: task: key uncertainty: friction = [0.4, 0.3]: the lower end ...
        """
        return parse_task(values, source)

    def to_dict(self) -> dict[str, Any]:
        """The values as a task file has them, to be changed and given to :meth:`from_dict`."""
        return self.model_dump(mode="json", by_alias=True, exclude_none=True)

    def _repr_html_(self) -> str | None:
        return None if Task.card is None else Task.card(self)

    def __str__(self) -> str:
        start, goal = self.start, self.goal
        return (
            f"{self.name}: part at ({start.x_um} um, {start.y_um} um, {start.theta_deg} deg), to "
            f"within {goal.position_tolerance_um} um and {goal.orientation_tolerance_deg} deg of "
            f"({goal.x_um} um, {goal.y_um} um, {goal.theta_deg} deg)"
        )


def load_task(path: Path) -> Task:
    """Read and check a task file.

    Parameters
    ----------
    path
        A TOML file.

    Returns
    -------
    Task
        Every value within its limits.

    Raises
    ------
    InputError
        The file cannot be read, is not TOML, or a value breaks a rule; the message names file, key,
        value and rule.
    """
    text = task_text(path)
    return parse_task(toml_values(text, str(path)), str(path))


def task_text(path: Path) -> str:
    """The text of a task file.

    Parameters
    ----------
    path
        A TOML file.

    Returns
    -------
    str
        As its author wrote it.

    Raises
    ------
    InputError
        The file cannot be read, is too large, or is not in UTF-8.
    """
    return text_of(path, "give a task file", "a TOML file", LARGEST_STATED)


def with_spacing(text: str, spacing_um: float) -> str:
    """The text of a task file with another ``tip_spacing_um``, all else as its author wrote it.

    Parameters
    ----------
    text
        Of a task file.
    spacing_um
        Distance of the tips, um.

    Returns
    -------
    str
        The text with the one line changed.

    Raises
    ------
    InputError
        The text has no such line of its own.
    """
    found, count = re.subn(
        r"(?m)^(\s*tip_spacing_um\s*=\s*)[-+0-9._eE]+", rf"\g<1>{spacing_um}", text
    )
    if count != 1:
        raise InputError("tip_spacing_um must stand on a line of its own in [probe], once")
    return found


def parse_task(values: Mapping[str, Any], source: str) -> Task:
    """Check the values of a task; ``source`` names them in messages.

    Parameters
    ----------
    values
        As a task file has them, tables as nested mappings.
    source
        Names them in messages.

    Returns
    -------
    Task
        Every value within its limits.

    Raises
    ------
    InputError
        A value breaks a rule.
    """
    keys = "`meso-robust schema task`"
    return checked(Task, values, source, whole="task", keys=keys, index=".{}")
