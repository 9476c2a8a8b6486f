"""The pushes of ``experiment.json`` one after another, each aimed at the part as it lies.

The experiment states where the part is to be laid down for a push. Here nobody lays it down: the push is turned
and shifted with the part, which is the same push on a film that is even; and turned by half a turn where the
outline then looks alike, so that the part can be pushed back. None of them is certified.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import ValidationError

from meso_robust.errors import InputError
from meso_robust.identification.experiment_document import ExperimentDocument, TestDocument
from meso_robust.live.lab_file import Lab
from meso_robust.reading import text_of
from meso_robust.types import Floats

SCHEMA = "meso-robust/experiment/"
MOST = 0.75
"""Of the way from the middle of the image to its border that the part's centre may go: more than half of it
is then seen."""


def read_experiment(path: Path) -> ExperimentDocument:
    """Read ``experiment.json``.

    Parameters
    ----------
    path
        The file.

    Returns
    -------
    ExperimentDocument
        With at least one push.

    Raises
    ------
    InputError
        It cannot be read, or a value breaks its rule.
    """
    advice = "give what meso-robust identify --plan wrote"
    text = text_of(path, advice, "an experiment")
    try:
        document = ExperimentDocument.model_validate_json(text)
    except ValidationError as error:
        line = str(error).split("\n")[0]
        raise InputError(f"{path}: is no experiment ({line}); {advice}") from error
    if not document.moves:
        raise InputError(f"{path}: moves: are none; give an experiment with pushes")
    return document


class Designed:
    """Answers sensed poses with the pushes that are left, as a controller does with moves.

    Parameters
    ----------
    document, lab
        The pushes, and the laboratory, of which the first manipulator with one tip makes them.
    """

    def __init__(self, document: ExperimentDocument, lab: Lab) -> None:
        alone = [one.tips[0] for one in lab.manipulators if len(one.tips) == 1]
        if not alone:
            raise InputError(
                "--experiment: needs a manipulator with a single tip; the laboratory has none"
            )
        if abs(alone[0].radius_um - document.tip_radius_um) > 1.0:
            raise InputError(
                f"--experiment: tip_radius_um = {document.tip_radius_um:g}; the tip {alone[0].name} has "
                f"{alone[0].radius_um:g} um; design the pushes for this tip"
            )
        self._tip, self._camera = alone[0].name, lab.camera
        self._left = [(move, file) for move in document.moves for file in move.recordings]
        self._turns = (0.0, math.pi) if _alike_by_half(document) else (0.0,)
        self.files: list[str] = []
        """Of the recordings of the pushes that were decided, in their order."""

    def answer(self, x_um: float, y_um: float, theta_deg: float) -> Mapping[str, Any]:
        """The push that leaves the part nearest to the middle of the image, or that all are made."""
        if not self._left:
            return {"done": True, "within": {}}
        pose = np.array([x_um, y_um])
        middle = np.array(self._camera.centre_um)
        pixels = np.array([self._camera.width_px, self._camera.height_px])
        room = 0.5 * self._camera.pixel_size_um * pixels
        angle = math.radians(theta_deg)
        ways = [
            (k, *_aimed(move, pose, angle + turn))
            for k, (move, _) in enumerate(self._left)
            for turn in self._turns
        ]
        far = [float((np.abs(pose + travel - middle) / room).max()) for _, _, travel in ways]
        best = int(np.argmin(far))
        if far[best] > MOST:
            return {"refused": "every push that is left would take the part out of the image"}
        index, start, travel = ways[best]
        move, file = self._left.pop(index)
        self.files.append(file)
        return {
            "step": move.step,
            "primitive": move.primitive,
            "probes": [{"name": self._tip, "start_um": start.tolist(), "passive": False}],
            "travel_um": travel.tolist(),
            "speed_um_s": move.speed_um_s,
            "rest_s": move.rest_s,
            "back_um": move.back_um,
            "expect": None,
            "test": move.test,
        }


def _alike_by_half(document: ExperimentDocument) -> bool:
    """Whether the outline is the same after half a turn, as a rectangle's is."""
    return document.outline.length_um is not None


def _aimed(move: TestDocument, place: Floats, angle: float) -> tuple[Floats, Floats]:
    """Start and travel of the tip (2,), um, as the part lies."""
    turn = angle - math.radians(move.part.theta_deg)
    c, s = math.cos(turn), math.sin(turn)
    rotation = np.array([[c, -s], [s, c]])
    from_part = np.array(move.probes[0].start_um) - np.array([move.part.x_um, move.part.y_um])
    return place + rotation @ from_part, rotation @ np.array(move.travel_um)
