"""The task of Fig. 1 and the eight manipulation tests of Fig. 3."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from meso_robust import units
from meso_robust.identification.experiment import PlannedPush
from meso_robust.reproduction.eight_tests import (
    BENCH,
    SUPPORTS,
    TESTS,
    planned,
    push_of,
    pushed,
)
from meso_robust.reproduction.item import Found, Item, Row, Setting, span
from meso_robust.reproduction.printed import PART, SHOWN, SLOT_WIDTH, film
from meso_robust.simulator import PushResult, exact, simulate
from meso_robust.simulator.fixture import SLOT_WIDTH as CHANNEL
from meso_robust.types import Floats

MIRRORED = (("A", "E"), ("B", "D"), ("F", "H"))
"""Tests that are each other's image in the x axis."""
STRAIGHT = ("C", "G")
"""Tests that push through the centre."""
MARGINS = (5e-6, 25e-6, 50e-6)
"""m from the corner: how near to it A, E, F and H may have been made."""


def moved(pushes: Mapping[str, PlannedPush], poses: Floats) -> Floats:
    """(8, 3) how far x, y and θ went in each test, m and rad."""
    return np.asarray(poses - np.array([pushes[name].start for name in TESTS]))


def unmirrored(turns: Floats) -> Floats:
    """(3, 3) by how much each mirrored pair (8, 3) fails to be an image, m and rad, not negative."""
    image = np.array([1.0, -1.0, -1.0])
    rows = [[TESTS.index(name) for name in pair] for pair in MIRRORED]
    return np.array([np.abs(turns[one] - image * turns[other]) for one, other in rows])


def sideways(turns: Floats) -> Floats:
    """(2, 2) |y| and |θ| of the straight tests, m and rad: zero for a pure translation."""
    return np.abs(turns[[TESTS.index(name) for name in STRAIGHT], 1:])


def run(setting: Setting) -> Found:
    """Simulate the tests on every support; draw them and the task."""
    from meso_robust.reproduction.manipulation_figures import task_figure, tests_figure

    pushes = planned()
    results = {name: pushed([pushes[test] for test in TESTS], name) for name in SUPPORTS}
    turns = {name: moved(pushes, result.poses) for name, result in results.items()}
    pair, straight = unmirrored(turns["film"]), sideways(turns["film"])
    return Found(
        answer=(
            "The set-up of Figs. 1 and 3 can be simulated as printed. On the film C and G translate without "
            f"turning (by at most {straight[:, 1].max() / units.DEG:.1g}°) and the pairs A/E, B/D and "
            f"F/H are mirror images (to {pair[:, :2].max() / units.UM:.1g} µm); on the points of "
            "Table I C and G still translate, but the pairs differ, as the points lie to one side."
        ),
        rows=(*_set_up(pushes, turns), *_symmetry(turns), *_outcomes(turns), *_doubts(turns)),
        missing=(
            "Start and end of the part in Fig. 1 (configurations A and B): those of the planned task "
            "of Section X-C.",
            "Where at the corner the tip meets in A, E, F and H: 25 um inwards; the rows show "
            f"{MARGINS[0] / units.UM:g} to {MARGINS[-1] / units.UM:g} um.",
            "Shape of the tip: round, of the printed width of 25 um; a row shows a flat one.",
            "Which of three speeds: 75 um/s; on the film and on dry points the path does not depend "
            "on it.",
            "Final poses of the tests: none is printed.",
        ),
        figures=(task_figure(), tests_figure(pushes, results)),
        data={
            "tests": list(TESTS),
            "moved_um_um_deg": {name: (turn / SHOWN).tolist() for name, turn in turns.items()},
            "outcomes": {name: result.outcomes.tolist() for name, result in results.items()},
        },
    )


def _set_up(pushes: Mapping[str, PlannedPush], turns: Mapping[str, Floats]) -> list[Row]:
    length, width = PART.length / units.UM, PART.width / units.UM
    travelled = -turns["film"][TESTS.index("C"), 0] / units.UM
    places = [
        Row(
            quantity=f"Test {name}: place from the middle of the {side} side",
            unit="um",
            printed=round(abs(pushes[name].asked) / units.UM, 3),
            ours=round(abs(pushes[name].place) / units.UM, 3),
            why="" if pushes[name].moved_from_corner == 0.0 else "at the corner a tip may miss",
        )
        for name, side in (("B", "long"), ("A", "long"), ("F", "short"))
    ]
    return [
        Row(
            quantity="Width of the slot",
            unit="um",
            printed=(round(SLOT_WIDTH / units.UM, 3), round(CHANNEL / units.UM, 3)),
            ours=round(SLOT_WIDTH / units.UM, 3),
            why=f"{width:g} + 137 um of Section VII; Section IV etches a channel of 976 um",
        ),
        Row(quantity="Part", unit="um", printed="1616 x 837", ours=f"{length:g} x {width:g}"),
        Row(
            quantity="Push after first contact, from how far C moves the part",
            unit="um",
            printed="about 700",
            ours=round(float(travelled), 3),
        ),
        *places,
        Row(
            quantity="Start angle, long and short side",
            unit="deg",
            printed="90, 180",
            ours=", ".join(f"{pushes[name].start[2] / units.DEG:g}" for name in STRAIGHT),
        ),
    ]


def _symmetry(turns: Mapping[str, Floats]) -> list[Row]:
    rows = []
    for name in SUPPORTS:
        pair, straight = unmirrored(turns[name]), sideways(turns[name])
        film = name == "film"
        rows += [
            Row(
                quantity=f"C and G, {name}: largest sideways motion and turn",
                unit="um, deg",
                printed="pure translation" if film else None,
                ours=_two(straight),
                why="" if film else "friction of the points acts through the centre in translation",
            ),
            Row(
                quantity=f"A/E, B/D, F/H, {name}: largest difference from mirror images",
                unit="um, deg",
                ours=f"{pair[:, :2].max() / units.UM:.3g}, {pair[:, 2].max() / units.DEG:.3g}",
                why="" if film else "the points do not lie symmetrically",
            ),
        ]
    return rows


def _two(straight: Floats) -> str:
    return f"{straight[:, 0].max() / units.UM:.3g}, {straight[:, 1].max() / units.DEG:.3g}"


def _outcomes(turns: Mapping[str, Floats]) -> list[Row]:
    """Where every test ends; the paper prints no end."""
    return [
        Row(
            quantity=f"Test {test}: motion in x, y and turn on " + ", ".join(SUPPORTS),
            unit="um, um, deg",
            ours="; ".join(_pose(turns[name][k]) for name in SUPPORTS),
            why="no end is printed",
        )
        for k, test in enumerate(TESTS)
    ]


def _pose(turn: Floats) -> str:
    x, y, theta = turn / SHOWN
    return f"{x:.0f}, {y + 0.0:.0f}, {theta + 0.0:.1f}".replace("-0,", "0,")


def _doubts(turns: Mapping[str, Floats]) -> list[Row]:
    """What the inputs that are missing change, and that two engines agree."""
    pushes = planned()
    tests = [pushes[name] for name in TESTS]
    same = exact(push_of(tests, "film", on=film(len(tests)))).poses
    off = np.abs(moved(pushes, same) - turns["film"])
    flat = np.abs(moved(pushes, _flat(tests).poses) - turns["film"]).max(axis=0) / SHOWN
    near = [planned(margin) for margin in MARGINS]
    ends = [moved(some, pushed([some[name] for name in TESTS], "film").poses) for some in near]
    return [
        *(
            Row(
                quantity=f"Test {test}, film: turn over places 5 to 50 um from the corner",
                unit="deg",
                ours=span(np.array([end[TESTS.index(test), 2] for end in ends]) / units.DEG),
                why="the place is printed as the corner itself",
            )
            for test in ("A", "F")
        ),
        Row(
            quantity="Film: largest change by a flat tip of 25 um",
            unit="um, um, deg",
            ours=", ".join(f"{value:.2g}" for value in flat),
            why="the paper draws the probe as a polygon with a side of 25 um; ours is round",
        ),
        Row(
            quantity="Film: largest difference of the two engines",
            unit="um",
            ours=float(off[:, :2].max() / units.UM),
            why=f"steps of the first, for {BENCH.length / units.UM:g} um",
        ),
    ]


def _flat(tests: list[PlannedPush]) -> PushResult:
    return simulate(push_of(tests, "film", flat=True))


ITEM = Item(
    title="The task and the eight manipulation tests",
    where="Fig. 1 and Section III; Fig. 3 and Section VI",
    run=run,
)
