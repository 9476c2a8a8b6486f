"""What is drawn is what was certified and simulated, in um and deg."""

from __future__ import annotations

import re
from xml.etree import ElementTree

import numpy as np
import pytest

from meso_robust.pipeline import Planned
from meso_robust.primitives.setup import PoseBox
from meso_robust.reporting.plan_figures import GHOSTS, ghost_rows, move_figure, overview_figure
from meso_robust.reporting.scene import Axes, Boxes, Dots, Line, Picture, Words
from meso_robust.reporting.tube_figures import (
    PATHS,
    final_figure,
    has_tube,
    spread_figure,
    thinned_paths,
    tube_figure,
)
from meso_robust.types import Floats

MOVES = range(4)
TURN = 2  # index of the rotation
DEG = np.pi / 180
NUMBER = re.compile(r"-?[\d.]+")


def rectangles(axes: Axes, name: str) -> list[Floats]:
    """(4,) left, right, low, high of every rectangle of that name."""
    found = [one.ends for one in axes.shapes if isinstance(one, Boxes) and one.name == name]
    return [ends for boxes in found for ends in boxes]


def face(box: PoseBox) -> Floats:
    """(4,) x and y ends of a box, um."""
    return np.array([box.x.lo, box.x.hi, box.y.lo, box.y.hi]) * 1e6


def lines(picture: Picture, name: str) -> list[Floats]:
    """(N, 2) points of every line of that name."""
    return [
        one.points for one in picture.axes[0].shapes if isinstance(one, Line) and one.name == name
    ]


def dots(axes: Axes, name: str) -> Floats:
    """(N, 2) all dots of that name."""
    found = [one.points for one in axes.shapes if isinstance(one, Dots) and one.name == name]
    return np.concatenate([np.empty((0, 2)), *found])


def tips(picture: Picture, name: str) -> Floats:
    return dots(picture.axes[0], name)


def points(axes: Axes) -> Floats:
    return dots(axes, "runs")


@pytest.mark.parametrize("index", MOVES)
def test_the_part_is_drawn_where_it_is_before_and_after(proved: Planned, index: int) -> None:
    move, picture = proved.check.nominal.moves[index], move_figure(proved, index)
    for label, pose in (("before", move.before[0]), ("after", move.after[0])):
        (shape,) = lines(picture, label)
        np.testing.assert_allclose(shape.mean(axis=0), pose[:2] * 1e6, atol=1e-6)
        long_side = shape[1] - shape[0]
        assert np.hypot(*long_side) == pytest.approx(proved.task.rectangle("this test").length_um)
        assert np.hypot(*(shape[2] - shape[1])) == pytest.approx(
            proved.task.rectangle("this test").width_um
        )
        assert np.arctan2(long_side[1], long_side[0]) == pytest.approx(pose[2], abs=1e-9)


@pytest.mark.parametrize("index", MOVES)
def test_ghosts_lie_on_the_way_and_leave_out_the_ends(proved: Planned, index: int) -> None:
    path = proved.check.nominal.moves[index].path[0]
    ghosts = lines(move_figure(proved, index), "ghost")
    rows = ghost_rows(len(path))
    assert len(ghosts) == GHOSTS == len(set(rows))
    assert 0 not in rows
    assert len(path) - 1 not in rows
    centres = np.array([ghost.mean(axis=0) for ghost in ghosts])
    np.testing.assert_allclose(centres, path[list(rows), :2] * 1e6, atol=1e-6)


@pytest.mark.parametrize("index", MOVES)
def test_a_move_shows_its_certified_box_and_its_tips(proved: Planned, index: int) -> None:
    picture = move_figure(proved, index)
    post = proved.chain.steps[index].post
    assert post is not None
    (box,) = rectangles(picture.axes[0], "certified box")
    np.testing.assert_allclose(box, face(post), rtol=1e-12)
    assert not rectangles(picture.axes[0], "unproved box")
    starts = np.array([probe.start_um for probe in proved.plan.moves[index].probes])
    np.testing.assert_allclose(tips(picture, "active tip"), starts[:2], atol=1e-4)
    passive = tips(picture, "passive tip")
    assert len(passive) == (1 if index == TURN else 0)
    np.testing.assert_allclose(passive.reshape(-1, 2), starts[2:].reshape(-1, 2), atol=1e-4)


@pytest.mark.parametrize("index", MOVES)
def test_everything_of_a_move_is_inside_its_panel(proved: Planned, index: int) -> None:
    picture = move_figure(proved, index)
    axes, travel = picture.axes[0], proved.plan.moves[index].travel_um
    active = tips(picture, "active tip")
    shapes = [*lines(picture, "before"), *lines(picture, "ghost"), *lines(picture, "after")]
    drawn = np.concatenate([*shapes, active, active + np.array(travel)])
    area = axes.area
    (left, right), (low, high) = area.x, area.y
    assert left < drawn[:, 0].min()
    assert drawn[:, 0].max() < right
    assert low < drawn[:, 1].min()
    assert drawn[:, 1].max() < high
    assert (right - left) / area.wide == pytest.approx((high - low) / area.tall)


def test_only_the_last_move_shows_the_goal(proved: Planned) -> None:
    shown = [rectangles(move_figure(proved, index).axes[0], "goal box") for index in MOVES]
    assert [len(found) for found in shown] == [0, 0, 0, 1]
    np.testing.assert_allclose(shown[-1][0], [-76, 76, -76, 76], rtol=1e-9)


def test_the_overview_goes_from_start_to_goal(proved: Planned) -> None:
    picture = overview_figure(proved)
    (way,) = lines(picture, "centre")
    np.testing.assert_allclose(way[0], [2060.4, -9.2], atol=1e-6)
    assert np.abs(way[-1]).max() < 76
    numbers = [one.text for one in picture.axes[0].shapes if isinstance(one, Words)]
    assert numbers == ["0", "1", "2", "3", "4"]
    (goal,) = lines(picture, "goal outline")
    np.testing.assert_allclose(goal.mean(axis=0), [0, 0], atol=1e-6)


@pytest.mark.parametrize("index", MOVES)
def test_the_spread_shows_every_run_and_the_certified_box(proved: Planned, index: int) -> None:
    axes, strip = spread_figure(proved, index).axes
    post, after = proved.chain.steps[index].post, proved.check.sampled.moves[index].after
    assert post is not None
    np.testing.assert_allclose(points(axes), after[:, :2] * 1e6)
    np.testing.assert_allclose(points(strip)[:, 0], after[:, 2] / DEG)
    (box,) = rectangles(axes, "certified box")
    np.testing.assert_allclose(box, face(post), rtol=1e-12)
    (band,) = rectangles(strip, "certified box")
    np.testing.assert_allclose(band[:2], np.array([post.theta.lo, post.theta.hi]) / DEG)


def test_every_move_has_a_tube(proved: Planned) -> None:
    assert all(has_tube(proved, index) for index in MOVES)


@pytest.mark.parametrize("up", ["y", "theta"])
def test_the_tube_is_drawn_slice_by_slice_with_paths_over_it(proved: Planned, up: str) -> None:
    picture = tube_figure(proved, TURN, "y" if up == "y" else "theta")
    axes = picture.axes[0]
    knots = proved.chain.steps[TURN].tube
    wanted = [
        [
            knot.box.x.lo * 1e6,
            knot.box.x.hi * 1e6,
            *(
                [knot.box.y.lo * 1e6, knot.box.y.hi * 1e6]
                if up == "y"
                else [knot.box.theta.lo / DEG, knot.box.theta.hi / DEG]
            ),
        ]
        for knot in knots
    ]
    np.testing.assert_allclose(rectangles(axes, "tube slice"), wanted)
    assert len(rectangles(axes, "box")) == 2
    paths = proved.check.sampled.moves[TURN].path
    drawn = lines(picture, "path")
    assert len(paths) == 40
    assert len(drawn) == PATHS == 24
    column, unit = (1, 1e-6) if up == "y" else (2, DEG)
    # the eighth of 24 evenly chosen ones of 40: 7 * 39/23 = 11.9
    np.testing.assert_allclose(drawn[7][:, 0], paths[11, :, 0] * 1e6)
    np.testing.assert_allclose(drawn[7][:, 1], paths[11, :, column] / unit)


def test_many_paths_are_thinned_evenly() -> None:
    many = np.arange(300.0)[:, None, None] * np.ones((1, 5, 3))
    kept = thinned_paths(many)[:, 0, 0]
    assert len(kept) == PATHS
    assert kept[0] == 0
    assert kept[-1] == 299
    assert np.diff(kept).min() >= 4


def test_the_end_shows_runs_in_the_certified_box_in_the_goal(proved: Planned) -> None:
    axes, strip = final_figure(proved).axes
    end = proved.chain.end
    assert end is not None
    (goal,), (box,) = rectangles(axes, "goal box"), rectangles(axes, "certified box")
    np.testing.assert_allclose(goal, face(proved.setup.goal), rtol=1e-12)
    np.testing.assert_allclose(box, face(end), rtol=1e-12)
    np.testing.assert_allclose(points(axes), proved.check.sampled.final[:, :2] * 1e6)
    np.testing.assert_allclose(rectangles(strip, "goal box")[0][:2], [175, 185], rtol=1e-9)


def test_without_a_proof_no_box_is_drawn_as_certified(refuted: Planned) -> None:
    pictures = [
        *(move_figure(refuted, index) for index in MOVES),
        *(spread_figure(refuted, index) for index in MOVES),
        final_figure(refuted),
    ]
    certified = [
        found for f in pictures for a in f.axes for found in rectangles(a, "certified box")
    ]
    reached = [step for step in refuted.chain.steps if step.post is not None]
    assert not certified
    dashed = [rectangles(f.axes[0], "unproved box") for f in pictures[:4]]
    assert sum(map(len, dashed)) == len(reached)


def test_runs_that_end_early_are_left_out_of_later_moves(refuted: Planned) -> None:
    failed_in = refuted.check.sampled.failed_in
    assert (failed_in < 4).any()
    for index in MOVES:
        drawn = points(spread_figure(refuted, index).axes[0])
        assert len(drawn) == int((failed_in > index).sum())
    ends = points(final_figure(refuted).axes[0])
    assert len(ends) == refuted.certificate.simulation.completed


def test_a_shape_lies_in_the_drawing_where_its_values_are_on_the_axes(proved: Planned) -> None:
    picture = final_figure(proved)
    area = picture.axes[0].area
    root = ElementTree.fromstring(picture.svg("trial", "Final poses"))
    frame = next(one for one in root.iter() if one.get("stroke-width") == "0.7")
    left, top, wide, tall = (float(frame.attrib[k]) for k in ("x", "y", "width", "height"))
    goal = next(one for one in root.iter() if one.get("stroke") == "#00795a")
    x0, y0, x1, y1, _ = map(float, NUMBER.findall(goal.attrib["d"]))
    scale = wide / (area.x[1] - area.x[0])
    assert x1 - x0 == pytest.approx(152.0 * scale, abs=0.02)
    assert y1 - y0 == pytest.approx(152.0 * scale, abs=0.02)
    assert (0.5 * (x0 + x1) - left) / wide == pytest.approx(-area.x[0] / np.ptp(area.x), abs=1e-4)
    assert (0.5 * (y0 + y1) - top) / tall == pytest.approx(area.y[1] / np.ptp(area.y), abs=1e-4)
    plane = [one for one in root.iter() if one.tag.endswith("circle")]
    assert len(plane) == 2 * len(proved.check.in_goal)  # in the plane and in the strip
    first = proved.check.sampled.final[0, :2] * 1e6
    assert (float(plane[0].attrib["cx"]) - left) / scale + area.x[0] == pytest.approx(
        first[0], abs=0.01 / scale
    )
    assert area.y[1] - (float(plane[0].attrib["cy"]) - top) / scale == pytest.approx(
        first[1], abs=0.01 / scale
    )


def test_what_lies_outside_the_axes_is_cut_off_by_an_id_of_the_pictures_own(
    proved: Planned,
) -> None:
    picture = final_figure(proved)
    for name in ("one", "other"):
        text = picture.svg(name, "")
        assert re.findall(r'id="([^"]+)"', text) == [f"{name}-0", f"{name}-1"]
        assert re.findall(r"url\(#([^)]+)\)", text) == [f"{name}-0", f"{name}-1"]
