"""Designed pushes, aimed at the part as it lies."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from meso_robust.errors import InputError
from meso_robust.identification.experiment import Bench, standard_tests
from meso_robust.identification.experiment_document import experiment_files
from meso_robust.live.designed import Designed, read_experiment
from meso_robust.live.virtual_bench import lab_of
from meso_robust.recordings import Rectangle
from meso_robust.task import load_task
from meso_robust.tasks import MICROSCOPE


@pytest.fixture
def experiment(tmp_path: Path) -> Path:
    part = Rectangle(length=1616e-6, width=837e-6)
    files = experiment_files(standard_tests(part, Bench(length=100e-6, trials=1)))
    path = tmp_path / "experiment.json"
    path.write_text(files["experiment.json"], encoding="utf-8")
    return path


def test_a_push_meets_the_part_alike_wherever_it_lies(experiment: Path) -> None:
    """Tip and travel in the part's own axes are those of the file, however the part is turned."""
    document = read_experiment(experiment)
    lab = lab_of(load_task(MICROSCOPE))
    designed = Designed(document, lab)
    planned = {}
    for move in document.moves:
        a = np.radians(move.part.theta_deg)
        back = np.array([[np.cos(a), np.sin(a)], [-np.sin(a), np.cos(a)]])
        from_part = np.array(move.probes[0].start_um) - [move.part.x_um, move.part.y_um]
        planned[move.test] = (back @ from_part, back @ np.array(move.travel_um))
    for k in range(8):
        x, y, theta = 1000.0 + 10.0 * k, 20.0 * k, 35.0 * k
        answer = designed.answer(x, y, theta)
        a = np.radians(theta)
        back = np.array([[np.cos(a), np.sin(a)], [-np.sin(a), np.cos(a)]])
        start, travel = planned[answer["test"]]
        found = back @ (np.array(answer["probes"][0]["start_um"]) - [x, y])
        # a rectangle looks alike after half a turn
        way = 1.0 if found @ start > 0.0 else -1.0
        assert found == pytest.approx(way * start)
        assert back @ np.array(answer["travel_um"]) == pytest.approx(way * travel)
        assert answer["probes"][0]["name"] == "stp"
    assert designed.answer(0.0, 0.0, 0.0) == {"done": True, "within": {}}
    assert sorted(designed.files) == sorted(f for m in document.moves for f in m.recordings)


def test_a_push_out_of_the_image_is_not_made(experiment: Path) -> None:
    designed = Designed(read_experiment(experiment), lab_of(load_task(MICROSCOPE)))
    assert "out of the image" in designed.answer(9000.0, 0.0, 0.0)["refused"]


def test_what_does_not_fit_the_laboratory_is_refused(experiment: Path, tmp_path: Path) -> None:
    lab = lab_of(load_task(MICROSCOPE))
    document = read_experiment(experiment)
    with pytest.raises(InputError, match="needs a manipulator with a single tip"):
        Designed(document, lab.model_copy(update={"manipulators": lab.manipulators[:1]}))
    with pytest.raises(InputError, match="tip_radius_um = 50"):
        Designed(document.model_copy(update={"tip_radius_um": 50.0}), lab)
    values = json.loads(experiment.read_text(encoding="utf-8"))
    empty = tmp_path / "empty.json"
    empty.write_text(json.dumps({**values, "moves": []}), encoding="utf-8")
    with pytest.raises(InputError, match="moves: are none"):
        read_experiment(empty)
    with pytest.raises(InputError, match="nowhere"):
        read_experiment(tmp_path / "nowhere.json")
