"""Planned pushes: the paper's tests, polygons, files and the page."""

from __future__ import annotations

import json
import re
import tomllib
from dataclasses import replace

import numpy as np
import pytest

from meso_robust.errors import InputError
from meso_robust.identification.candidates import Candidates, candidates
from meso_robust.identification.experiment import (
    Bench,
    Experiment,
    PlannedPush,
    blocked,
    check_field,
    edge_push,
    standard_tests,
)
from meso_robust.identification.experiment_document import ExperimentDocument, experiment_files
from meso_robust.identification.rollout import rollout, start_of
from meso_robust.planning.document import MoveDocument
from meso_robust.recordings import Polygon
from meso_robust.recordings.document import parse_document
from meso_robust.recordings.rules import DEG, UM
from meso_robust.reporting.experiment import experiment_page
from tests.identification.table_one import BENCH, FILM, PART, TESTS, VISCOUS

TRIANGLE = Polygon(corners=UM * np.array([[-500.0, -300.0], [700.0, -300.0], [-200.0, 600.0]]))
ELL = Polygon(
    corners=UM
    * np.array([[-400, -400], [400, -400], [400, -100], [0, -100], [0, 400], [-400, 400]])
)

# Fig. 3, worked out by hand for a 1616 x 837 um part whose centre is at (350, 0) um: the tip's centre
# is the half side, the radius of 12.5 and the gap of 50 to the right of it.
BY_HAND = {
    "A": (90.0, 831.0, 783.0),
    "B": (90.0, 831.0, 404.0),
    "C": (90.0, 831.0, 0.0),
    "D": (90.0, 831.0, -404.0),
    "E": (90.0, 831.0, -783.0),
    "F": (180.0, 1220.5, 393.5),
    "G": (180.0, 1220.5, 0.0),
    "H": (180.0, 1220.5, -393.5),
}


def test_the_eight_tests_of_the_paper() -> None:
    found = {
        push.name: (push.start[2] / DEG, push.tip[0] / UM, push.tip[1] / UM)
        for push in TESTS.pushes
    }
    assert list(found) == list("ABCDEFGH")
    for name, values in BY_HAND.items():
        assert found[name] == pytest.approx(values, abs=1e-6)
    assert {push.travel for push in TESTS.pushes} == {(-(BENCH.gap + BENCH.length), 0.0)}
    moved = {push.name for push in TESTS.pushes if push.moved_from_corner > 0.0}
    assert moved == set("AEFH")
    assert all(
        push.moved_from_corner == pytest.approx(25e-6)
        for push in TESTS.pushes
        if push.name in moved
    )
    assert BENCH.trials >= 3
    assert not TESTS.left_out


@pytest.mark.parametrize("angle", [0.0, 25.0, -40.0])
def test_the_tip_starts_free_and_first_touches_the_planned_place(angle: float) -> None:
    push = edge_push(PART, BENCH, name="p", edge=1, place=120e-6, angle=angle * DEG)
    moves = [replace(push, travel=(-(BENCH.gap + d), 0.0)) for d in (-0.5e-6, 0.5e-6)]
    short, longer = rollout(FILM, moves, start_of(moves), VISCOUS).poses - start_of(moves)
    assert np.all(short == 0.0)
    assert np.abs(longer).max() > 0.1e-6
    # where it touches, in the part's own frame: right side, 120 um above its middle
    contact = np.array(push.tip) - [BENCH.gap, 0.0] - push.start[:2]
    contact -= BENCH.tip_radius * np.array([np.cos(angle * DEG), np.sin(angle * DEG)])
    c, s = np.cos(push.start[2]), np.sin(push.start[2])
    own = np.array([[c, s], [-s, c]]) @ contact
    assert own == pytest.approx([808e-6, 120e-6], abs=1e-12)


def test_every_edge_of_a_polygon_is_pushed_by_the_same_rule() -> None:
    found = standard_tests(TRIANGLE, BENCH)
    # sides of 1200, 1273 and 949 um; the mean is 1141 um
    names = [
        f"edge{e}_{x}" for e, letters in ((0, "ABCDE"), (1, "ABCDE"), (2, "FGH")) for x in letters
    ]
    assert [push.name for push in found.pushes] == names
    corners = TRIANGLE.corners
    for push in found.pushes:
        c, s = np.cos(push.start[2]), np.sin(push.start[2])
        side = corners[(push.edge + 1) % 3] - corners[push.edge]
        turned = np.array([[c, -s], [s, c]]) @ side
        assert turned == pytest.approx([0.0, np.hypot(*side)], abs=1e-12)  # faces +x


def test_a_push_behind_another_edge_is_left_out_by_name() -> None:
    wide = replace(BENCH, tip_radius=60e-6, gap=400e-6)
    found = standard_tests(ELL, wide)
    names = {push.name for push in found.pushes}
    left = dict(found.left_out)
    assert not names & set(left)
    assert "in the way" in left["edge3_H"]  # deep in the corner of the L
    assert "edge3_F" in names
    _, others = candidates(ELL, wide, Candidates(places=3, angles=(0.0,)))
    assert "in the way" in dict(others)["edge3_-225um_+0deg_700um"]
    thin = standard_tests(ELL, replace(BENCH, tip_radius=1e-6))
    assert not any("in the way" in why for _, why in thin.left_out)


def test_no_push_is_nearer_to_a_corner_than_the_margin() -> None:
    found = standard_tests(PART, replace(BENCH, corner_margin=450e-6))
    assert [push.name for push in found.pushes] == list("ACEG")
    assert {push.name: push.place for push in found.pushes}["A"] == pytest.approx(358e-6)
    assert {name for name, _ in found.left_out} == {"B", "D", "F", "H"}


def test_a_push_that_may_leave_the_field_is_refused() -> None:
    with pytest.raises(InputError, match=r"field: 2000 x 1500 um; push A may need 2620 x 1820 um"):
        standard_tests(PART, Bench(field=(2000e-6, 1500e-6)))
    check_field(PART, BENCH, TESTS.pushes[0])


@pytest.mark.parametrize(
    ("values", "word"),
    [
        ({"gap": 0.0}, "gap"),
        ({"length": -1.0}, "length"),
        ({"speed": np.inf}, "speed"),
        ({"tip_radius": np.nan}, "tip_radius"),
        ({"trials": 0}, "trials"),
        ({"rates": ()}, "rates"),
        ({"rates": (1.0, 0.0)}, "rates"),
        ({"rest": -1.0}, "rest"),
        ({"back": np.nan}, "back"),
        ({"field": (0.0, 1.0)}, "field"),
    ],
)
def test_a_wrong_bench_is_refused(values: dict[str, float], word: str) -> None:
    with pytest.raises(InputError, match=word):
        Bench(**values)  # type: ignore[arg-type]


@pytest.mark.parametrize(("edge", "place", "angle"), [(4, 0.0, 0.0), (0, 1e-3, 0.0), (0, 0.0, 1.6)])
def test_a_wrong_push_is_refused(edge: int, place: float, angle: float) -> None:
    with pytest.raises(InputError, match=r"edge|place|angle"):
        edge_push(PART, BENCH, name="p", edge=edge, place=place, angle=angle)


def test_a_convex_part_never_blocks_its_own_edges() -> None:
    pushes: list[PlannedPush] = [
        edge_push(PART, BENCH, name="p", edge=e, place=300e-6, angle=a)
        for e in range(4)
        for a in (-0.5, 0.5)
    ]
    assert not any(blocked(PART, BENCH, push) for push in pushes)


def test_the_files_are_moves_like_those_of_a_plan_and_a_valid_set() -> None:
    files = experiment_files(TESTS)
    values = json.loads(files["experiment.json"])
    assert ExperimentDocument.model_validate(values).moves[0].test == "A"
    assert set(MoveDocument.model_fields) <= set(values["moves"][0])
    assert values["moves"][7]["travel_um"] == [-750.0, 0.0]
    assert values["moves"][0]["moved_um"] == 25.0
    assert values["outline"] == {"length_um": 1616.0, "width_um": 837.0}
    document = parse_document(tomllib.loads(files["set.toml"]), "set.toml")
    recorded = [recording.file for recording in document.recording]
    assert recorded == [name for move in values["moves"] for name in move["recordings"]]
    assert len(set(recorded)) == 24
    polygon = parse_document(
        tomllib.loads(experiment_files(standard_tests(TRIANGLE, BENCH))["set.toml"]), "set.toml"
    )
    assert polygon.part.polygon_um == ((-500.0, -300.0), (700.0, -300.0), (-200.0, 600.0))


def test_speeds_take_turns_and_the_camera_runs_on() -> None:
    bench = replace(BENCH, rates=(0.5, 2.0), rest=0.8, back=40e-6)
    moves = json.loads(experiment_files(standard_tests(PART, bench))["experiment.json"])["moves"]
    assert [move["speed_um_s"] for move in moves] == 4 * [37.5, 150.0]
    assert {(move["rest_s"], move["back_um"]) for move in moves} == {(0.8, 40.0)}
    page = experiment_page(standard_tests(PART, bench))
    assert page.count(">37.5<") == page.count(">150.0<") == 4
    assert "let the camera run for 0.8 s" in page


def test_the_page_shows_every_push_and_needs_nothing_else() -> None:
    page = experiment_page(replace_left_out(TESTS))
    for name, (theta, x, y) in BY_HAND.items():
        row = re.search(rf"<td><code>{name}</code>.*?</tr>", page, re.DOTALL)
        assert row is not None
        text = row.group().replace("−", "-")
        assert f"{theta:.1f}°" in text
        assert f"{x:.1f}, {y:.1f}" in text
    assert page.count("moved inwards by 25.0") == 4
    assert "<svg" in page
    assert not re.search(r'(src|href)="(?!#)', page)
    assert "&lt;b&gt;why" in page
    assert page == experiment_page(replace_left_out(TESTS))


def replace_left_out(experiment: Experiment) -> Experiment:
    return replace(experiment, left_out=(("X", "<b>why"),))
