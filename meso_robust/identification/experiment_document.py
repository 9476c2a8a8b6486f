"""``experiment.json``: planned pushes for the hardware, and the ``set.toml`` for their recordings."""

from __future__ import annotations

import json
import tomllib
from collections.abc import Mapping
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import BaseModel, ConfigDict, Field

from meso_robust.identification.design import Design, Interval
from meso_robust.identification.experiment import Experiment, Part, PlannedPush
from meso_robust.identification.models import Model, Parameter
from meso_robust.recordings import Rectangle
from meso_robust.recordings.document import SCHEMA, SET_FILE, parse_document
from meso_robust.recordings.rules import DEG, UM

Pair = tuple[float, float]

EXPERIMENT_FILE = "experiment.json"
PROBE = "probe1"
FRAME_RATE = 30.0
"""Of the paper's camera, Hz (Section IV)."""


class _Model(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True, populate_by_name=True)


class OutlineDocument(_Model):
    """The part, as in a ``set.toml``."""

    length_um: float | None = None
    """Side along the part's x axis at theta = 0, the long one, um; null of a polygon."""
    width_um: float | None = None
    """Side across it, um; null of a polygon."""
    polygon_um: tuple[Pair, ...] | None = None
    """Corners [x, y] about the reference point, counter-clockwise, um; null of a rectangle."""


class PoseDocument(_Model):
    """Where the part is to be laid down."""

    x_um: float
    """x of the reference point, um, world frame."""
    y_um: float
    """y of the reference point, um, world frame."""
    theta_deg: float
    """Orientation, deg."""


class TipDocument(_Model):
    """The probe at the start of a move, free of contact."""

    name: str
    """The probe, as in the columns of the recording."""
    start_um: Pair
    """[x, y] of the tip's centre before the move, um, world frame."""
    passive: bool = False
    """Never: the only tip travels."""


class TestDocument(_Model):
    """A move as in ``plan.json``, with what an experiment needs in addition."""

    step: int
    """Number of the push, from 1."""
    primitive: Literal["identification_push"] = "identification_push"
    """The move is a push to identify by."""
    probes: tuple[TipDocument, ...]
    """The one tip that pushes."""
    travel_um: Pair
    """[x, y] by which the tip travels, um, world frame."""
    speed_um_s: float
    """Speed of the travel, um/s."""
    rest_s: float = 0.0
    """Time for which the camera runs with the tip at rest: before the push, after it, and once more after the
    tip was drawn back, s."""
    back_um: float = 0.0
    """By how much the tip is drawn back after the push, before it is lifted, um."""
    expect: None = None
    """Never certified: the model is what is to be found."""
    test: str
    """Name of the push: A to H of the paper, or that of a design."""
    part: PoseDocument
    """Pose in which the part is to be laid down."""
    edge: int
    """The pushed edge: that after this corner of the outline."""
    asked_um: float
    """Place on the edge from its middle, counter-clockwise, as the rule asks."""
    place_um: float
    """The same as used: a place at a corner is moved inwards."""
    moved_um: float
    """By how much it is moved."""
    recordings: tuple[str, ...]
    """One a trial."""


class LeftOutDocument(_Model):
    """A push of the rule that cannot be made."""

    test: str
    """Name of the push."""
    why: str
    """The reason, in words."""


class ExpectedDocument(_Model):
    """What a designed experiment is expected to tell of a parameter, in the unit of its key; 90 %."""

    parameter: str
    """Name of the parameter."""
    value: float
    """Taken for the truth."""
    before: Pair | None
    """Ends without the pushes; null if only the parameter's range is known."""
    after: Pair | None
    """Ends with them; null if they cannot tell."""


class ExperimentDocument(_Model):
    """Pushes that identify a part."""

    schema_: Annotated[Literal["meso-robust/experiment/1"], Field(alias="schema")] = (
        "meso-robust/experiment/1"
    )
    """Name and version of the format."""
    outline: OutlineDocument
    """The part."""
    tip_radius_um: float
    """Radius of the tip, um; 0: a point."""
    corner_margin_um: float
    """Least distance of a pushed place from a corner, um."""
    field_um: Pair
    """[width, height] of the field of view about the world's origin, um."""
    trials: int
    """Times that each push is made."""
    moves: tuple[TestDocument, ...]
    """The pushes."""
    left_out: tuple[LeftOutDocument, ...]
    """Pushes that cannot be made."""
    expected: tuple[ExpectedDocument, ...] = ()
    """Of a design, if the model is right; empty for the standard tests."""


def experiment_document(
    experiment: Experiment, found: Design | None = None, model: Model | None = None
) -> ExperimentDocument:
    """Write out an experiment; lengths in um to a tenth of a nanometre.

    Parameters
    ----------
    experiment
        The pushes.
    found, model
        The design that they come from and its model, if they do.
    """
    bench = experiment.bench
    return ExperimentDocument(
        outline=_outline(experiment.part),
        tip_radius_um=_um(bench.tip_radius),
        corner_margin_um=_um(bench.corner_margin),
        field_um=_pair(bench.field),
        trials=bench.trials,
        moves=tuple(
            _move(experiment, step + 1, push) for step, push in enumerate(experiment.pushes)
        ),
        left_out=tuple(LeftOutDocument(test=name, why=why) for name, why in experiment.left_out),
        expected=_expected(found, model) if found and model else (),
    )


def experiment_files(
    experiment: Experiment, found: Design | None = None, model: Model | None = None
) -> Mapping[str, str]:
    """Texts of ``experiment.json`` and of a ``set.toml`` to which recordings are to be added.

    Arguments are those of `experiment_document`.

    Parameters
    ----------
    experiment, found, model
        As in `experiment_document`.

    Returns
    -------
    Mapping
        Texts by the name of their file.

    Raises
    ------
    InputError
        If the part or the tip is beyond the limits of a recording set.
    """
    document = experiment_document(experiment, found, model)
    values = document.model_dump(by_alias=True)
    values["outline"] = document.outline.model_dump(exclude_none=True)
    text = json.dumps(values, indent=2, ensure_ascii=False)
    return {EXPERIMENT_FILE: text + "\n", SET_FILE: _set(document)}


def _set(document: ExperimentDocument) -> str:
    """A ``set.toml`` that is complete but for the recordings themselves."""
    lines = [f'schema = "{SCHEMA}"', "[part]"]
    outline = document.outline.model_dump(exclude_none=True)
    lines += [f"{key} = {json.dumps(value)}" for key, value in outline.items()]
    lines += ["[probe]", f"tip_radius_um = {document.tip_radius_um}"]
    lines += ['position_source = "controller"', "[sensor]", f"frame_rate_hz = {FRAME_RATE}"]
    for move in document.moves:
        for name in move.recordings:
            lines += ["[[recording]]", f'file = "{name}"', f'probes = ["{PROBE}"]']
    text = "\n".join(lines) + "\n"
    parse_document(tomllib.loads(text), SET_FILE)
    return text


def _expected(found: Design, model: Model) -> tuple[ExpectedDocument, ...]:
    return tuple(
        ExpectedDocument(
            parameter=parameter.key,
            value=parameter.shown(before.value),
            before=_ends(before, parameter),
            after=_ends(after, parameter),
        )
        for before, after, parameter in zip(
            found.before, found.after, model.parameters, strict=True
        )
    )


def _ends(interval: Interval, parameter: Parameter) -> Pair | None:
    if not interval.informed:
        return None
    return parameter.shown(interval.low), parameter.shown(interval.high)


def _move(experiment: Experiment, step: int, push: PlannedPush) -> TestDocument:
    (x, y, theta), bench = push.start, experiment.bench
    trials = range(1, experiment.bench.trials + 1)
    return TestDocument(
        step=step,
        probes=(TipDocument(name=PROBE, start_um=_pair(push.tip)),),
        travel_um=_pair(push.travel),
        speed_um_s=_um(bench.speed_of(step - 1)),
        rest_s=bench.rest,
        back_um=_um(bench.back),
        test=push.name,
        part=PoseDocument(x_um=_um(x), y_um=_um(y), theta_deg=round(theta / DEG, 6) + 0.0),
        edge=push.edge,
        asked_um=_um(push.asked),
        place_um=_um(push.place),
        moved_um=_um(push.moved_from_corner),
        recordings=tuple(f"{push.name}_{trial}.csv" for trial in trials),
    )


def _outline(part: Part) -> OutlineDocument:
    if isinstance(part, Rectangle):
        return OutlineDocument(length_um=_um(part.length), width_um=_um(part.width))
    corners: Any = part.corners.tolist()
    return OutlineDocument(polygon_um=tuple(_pair(corner) for corner in corners))


def _pair(values: Pair) -> Pair:
    return _um(values[0]), _um(values[1])


def _um(value: float) -> float:
    return float(np.round(value / UM, 4)) + 0.0
