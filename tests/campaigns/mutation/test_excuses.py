"""What is excused is true and what is untrue has no excuse, judged on changes made by hand."""

from __future__ import annotations

import copy
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from meso_robust.campaigns.mutation.along_runs import (
    Travelled,
    edge_margin,
    part_distance,
    tip_distance,
    travel_to_spare,
)
from meso_robust.campaigns.mutation.excuses import excuse
from meso_robust.campaigns.mutation.forging import ends_of, put_post
from meso_robust.campaigns.mutation.original import Original
from meso_robust.campaigns.mutation.places import Document
from meso_robust.campaigns.mutation.sampled import least
from meso_robust.laboratory.draws import nominal
from meso_robust.laboratory.engines import NOT_RECORDED
from meso_robust.laboratory.running import MoveRun
from meso_robust.primitives.setup import setup_of
from tests.conftest import paper_task
from tests.slot import point_slot

Change = Callable[[Document], None]


def inequality(document: Document, about: str) -> Any:
    """The first one with this inequality."""
    every = (one for step in document["steps"] for one in step["obligations"])
    return next(one for one in every if one["inequality"] == about)


def shifted(about: str, key: str, by: float, end: int = 0) -> Change:
    """A bound or an end of a box, moved by a share of the bound's or the box's size."""

    def change(document: Document) -> None:
        one = inequality(document, about)
        if key == "lower_bound":
            value = float.fromhex(one[key])
            one[key] = (value + by * abs(value)).hex()
        else:
            low, high = (float.fromhex(text) for text in one["over"][key])
            moved = (low, high)[end] + by * (high - low)
            one["over"][key][end] = moved.hex()

    return change


def box(move: int, axis: int, end: int, by: float) -> Change:
    def change(document: Document) -> None:
        ends = ends_of(document["steps"][move]["post_exact"])
        ends[axis][end] += by
        put_post(document, move, ends)

    return change


def put(*where: Any, value: Any) -> Change:
    def change(document: Document) -> None:
        found: Any = document
        for key in where[:-1]:
            found = found[key]
        found[where[-1]] = value

    return change


def at_refused_factor(document: Document) -> None:
    """The planner tried this factor and proved nothing; runs show no harm in it."""
    document["margin"]["factor"] = document["margin"]["refused_at"]


def aimed(by_um: float) -> Change:
    def change(document: Document) -> None:
        document["policy"][0]["dual_y"]["offset_um"] += by_um

    return change


FRICTION = "one_point_sticking.friction_margin"
"""Over variables of the move; that of no jam is over those of the formula."""
JAM = "opposite_edges.no_jam"
TUBE = "two_sided_rotation.ends_of_edges"


@pytest.mark.parametrize(
    ("change", "because"),
    [
        (lambda document: None, "nothing changed"),
        (put("simulation", "samples", value=7), "named as not checked"),
        (put("reading", "claim", value="every part, everywhere"), "named as not checked"),
        (shifted(FRICTION, "lower_bound", -0.1), "a weaker bound"),
        (shifted(FRICTION, "mu_lower_now", 0.1), "the same inequality over a narrower box"),
        (
            shifted(FRICTION, "mu_lower_now", 0.01, end=1),
            "an inequality that the planner proves too",
        ),
        (shifted(JAM, "mu", 0.02, end=1), "true at 20000 points"),
        (shifted(TUBE, "lower_bound", 0.1), "true along 500 runs"),
        (put("margin", "factor", value=1.0), "a smaller margin"),
        (at_refused_factor, "a factor at which 500 runs keep every claim"),
        (aimed(0.01), "another policy, which the planner certifies too"),
        (box(3, 0, 0, -1e-6), "a box as its exact ends read; a box that holds 500 runs"),
        (box(1, 2, 1, 1e-15), "the same to 14 digits"),
    ],
)
def test_what_is_true_is_excused(original: Original, change: Change, because: str) -> None:
    mutant = copy.deepcopy(original.document)
    change(mutant)
    assert excuse(original, mutant) == because


@pytest.mark.parametrize(
    "change",
    [
        put("claim", "id", value="every_part_everywhere"),
        put("claim", "premises", 3, value="quasi_static"),
        put("claim", "uncertainties", "friction", 0, value=(0.29).hex()),
        put("steps", 1, "property", "id", value="turns_part"),
        put("steps", 1, "obligations", 0, "about", "tip", value="passive"),
        put("steps", 1, "primitive", value="rotation"),
        put("task", value="another"),
        shifted(FRICTION, "lower_bound", 2.0),
        shifted(FRICTION, "mu_lower_now", -40.0),
        shifted(JAM, "mu", 40.0, end=1),
        shifted(TUBE, "lower_bound", 10.0),
        shifted("travel_to_spare", "lower_bound", 10.0),
        put("margin", "factor", value=2.5),
        put("goal_exact", "x_m", 0, value=(-1.0).hex()),
        aimed(200.0),
        box(3, 0, 0, 4e-6),
        box(1, 2, 1, -1e-3),
        lambda document: document["steps"][0]["obligations"].pop(),
        lambda document: document["policy"].pop(),
    ],
)
def test_what_is_untrue_has_no_excuse(original: Original, change: Change) -> None:
    mutant = copy.deepcopy(original.document)
    change(mutant)
    assert excuse(original, mutant) is None


def test_one_excuse_does_not_cover_another_change(original: Original) -> None:
    mutant = copy.deepcopy(original.document)
    for change in (shifted(FRICTION, "lower_bound", -0.1), put("task", value="another")):
        change(mutant)
    assert excuse(original, mutant) is None


def test_a_raised_bound_over_a_narrower_box_is_judged_together(original: Original) -> None:
    """At the box's middle alone the inequality has more to spare than over all of it."""
    mutant = copy.deepcopy(original.document)
    one = inequality(mutant, JAM)
    for ends in one["over"].values():
        middle = 0.5 * (float.fromhex(ends[0]) + float.fromhex(ends[1]))
        ends[0] = ends[1] = middle.hex()
    spare = least(one)
    assert spare is not None
    assert spare > float.fromhex(one["lower_bound"])
    one["lower_bound"] = (0.99 * spare).hex()
    assert excuse(original, mutant) == "true at 20000 points"
    one["lower_bound"] = (1.01 * spare).hex()
    assert excuse(original, mutant) is None


def test_the_least_value_is_found_at_a_corner() -> None:
    over = {"half": [(3.0).hex(), (4.0).hex()], "d2": [(-2.0).hex(), (1.0).hex()]}
    assert least({"inequality": "within_edge", "over": over}) == 1.0


# -------------------------------------------------------------------------------- along runs


def moved(path: Any, tips: Any, travel: Any, modes: Any) -> MoveRun:
    """A move of one run."""
    poses = np.array([path], dtype=np.float64)
    return MoveRun(
        before=poses[:, 0],
        sensed=poses[:, 0],
        ways=np.array([[tips, np.add(tips, travel)]], dtype=np.float64),
        radii=np.zeros((1, len(tips))),
        outlines=np.zeros((1, 4, 2)),
        path=poses,
        modes=np.array([modes], dtype=np.int8),
        phases=np.array([NOT_RECORDED]),
        after=poses[:, -1],
    )


def test_tips_on_a_part_that_lies_flat() -> None:
    """Half the long side is 808 um; the lower tip comes to 300 um, the passive one stays at -500."""
    setup = setup_of(paper_task())
    move = moved(
        path=[[0, 0, 0]] * 3,
        tips=[[0, 0], [900e-6, 418e-6], [-500e-6, -418e-6]],
        travel=[[0, 0], [-600e-6, 0], [0, 0]],
        modes=[[0, 0, 1], [0, 1, 1], [0, 1, 1]],
    )
    run = Travelled(move, nominal(setup, 1), setup)
    # at the middle of the travel the lower tip is at 600 um
    assert edge_margin(run) == pytest.approx(208e-6, abs=1e-12)


def test_what_is_left_of_a_travel() -> None:
    setup = setup_of(paper_task())
    move = moved(
        path=[[0, 0, 0]] * 5,
        tips=[[0, 0], [0, 0]],
        travel=[[-100e-6, 0]] * 2,
        modes=[[0, 0], [0, 1], [0, 1], [2, 1], [1, 1]],
    )
    # between the third and the fourth of five instants
    assert travel_to_spare(Travelled(move, nominal(setup, 1), setup)) == pytest.approx(50e-6)
    never = moved([[0, 0, 0]] * 5, [[0, 0], [0, 0]], [[-100e-6, 0]] * 2, [[0, 1]] * 5)
    assert travel_to_spare(Travelled(never, nominal(setup, 1), setup)) == 0.0


def test_distances_from_the_walls_of_a_slot() -> None:
    """A slot 1000 um wide along x, its mouth at the origin, 2500 um deep; a part of 1616 x 837 um."""
    task = point_slot(
        mouth_x_um=0.0, mouth_y_um=0.0, opens="+x", width_um=1000.0, depth_um=2500.0, wall_um=300.0
    )
    setup = setup_of(task)
    move = moved(
        path=[[-1e-3, 0, 0], [-1.1e-3, 20e-6, 0]],
        tips=[[-100e-6, 100e-6], [-100e-6, -450e-6]],
        travel=[[-200e-6, 0], [-200e-6, 0]],
        modes=[[0, 0], [0, 0]],
    )
    run = Travelled(move, nominal(setup, 1), setup)
    # the part's upper side comes to 20 + 418.5 um, the wall begins at 500
    assert part_distance(run) == pytest.approx(61.5e-6, abs=1e-12)
    # the lower tip stays 50 um from the lower wall
    assert tip_distance(run) == pytest.approx(50e-6, abs=1e-12)


@pytest.mark.parametrize(("theta", "gap_um"), [(0.0, 1000.0 - 418.5), (np.pi / 2, 1000.0 - 808.0)])
def test_the_distance_of_a_part_that_stands_or_lies(theta: float, gap_um: float) -> None:
    task = point_slot(
        mouth_x_um=0.0, mouth_y_um=0.0, opens="+x", width_um=2000.0, depth_um=4000.0, wall_um=300.0
    )
    setup = setup_of(task)
    pose = [-1.2e-3, 30e-6, theta]
    move = moved([pose] * 2, [[0, 0], [0, 0]], [[0, 0], [0, 0]], [[0, 0]] * 2)
    run = Travelled(move, nominal(setup, 1), setup)
    assert part_distance(run) == pytest.approx((gap_um - 30.0) * 1e-6, abs=1e-12)


def test_a_witness_must_be_a_run_that_can_be(original: Original) -> None:
    moves, start = len(original.document["policy"]), original.setup.start
    middle = [side.mid.hex() for side in (start.x, start.y, start.theta)]
    u, zero = original.setup.uncertainty, (0.0).hex()
    witness = {
        "outcome": "jam", "move": 1, "start": middle, "friction": u.friction.mid.hex(),
        "film_ratio_m2": u.film_ratio.mid.hex(), "misalignment_rad": zero,
        "sensing": [[zero] * 3] * moves, "dual_probe": [[zero] * 2] * moves,
        "single_probe": [[zero] * 2] * moves,
    }  # fmt: skip
    told = {**original.document, "verdict": "REFUTED", "witness": witness}
    assert excuse(original, told) is None  # the run ends in the goal
    policy = copy.deepcopy(original.document["policy"])
    policy[0]["dual_x"]["offset_um"] -= 60.0  # the probe starts inside the part
    assert "fails by both engines" in str(excuse(original, {**told, "policy": policy}))
    told["witness"] = {**witness, "friction": (u.friction.hi + 0.01).hex()}
    assert excuse(original, told) is None
