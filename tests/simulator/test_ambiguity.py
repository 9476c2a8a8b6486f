"""Jams, solutions and second motions against all contact modes by plain linear algebra."""

import numpy as np
import numpy.typing as npt
import pytest

from meso_robust.simulator import Outcome, Push, simulate
from tests.simulator.entries import advance, closes, is_ambiguous
from tests.simulator.oracle import motions
from tests.simulator.problems import (
    HALF_SHORT,
    MU,
    RHO,
    UM,
    WIDTH,
    fill,
    one_point,
    random_rows,
    rectangle,
    two_sided,
    workspace_of,
)

F = npt.NDArray[np.float64]

CLEAR = 1e-6  # of violation: less is too close to tell


def squeezed(rows: F, rng: np.random.Generator) -> F:
    """Rows with all gaps closing, and the second contact facing the first, short of arms."""
    rows[:, 0] = -rng.uniform(0.1, 1, len(rows))
    if len(rows) > 1:
        rows[1, 2:4], rows[1, 5:7] = -rows[0, 2:4], -rows[0, 5:7]
        rows[:, [4, 7]] *= 0.5
    return rows


@pytest.mark.parametrize(("contacts", "count"), [(1, 100), (2, 300), (3, 200), (4, 60)])
def test_jam_if_and_only_if_no_mode_gives_a_motion(contacts: int, count: int) -> None:
    rng = np.random.default_rng(contacts)
    tally = {"motion": 0, "jam": 0, "close": 0}
    work = workspace_of(np.zeros((contacts, 8)), 0.0)
    for i, rows in enumerate(random_rows(count, contacts, rng)):
        case = squeezed(rows, rng) if i % 2 else rows
        friction = rng.uniform(0, 1.2, contacts)
        found, least = motions(case, friction)
        fill(work, case, friction)
        closing = closes(work.contacts, work.marks, work.step, contacts)
        outcome = advance(work, contacts) if closing else int(Outcome.COMPLETED)
        if not found and least < CLEAR:
            tally["close"] += 1
            continue
        tally["motion" if found else "jam"] += 1
        assert outcome == (Outcome.COMPLETED if found else Outcome.JAM), (i, least)
        if found:
            off = [np.max(np.abs(work.step[:3] - motion)) for motion in found]
            assert min(off) < 1e-6 * max(1.0, float(np.max(np.abs(work.step[:3]))))
    assert tally["close"] <= count // 100
    assert tally["motion"] > count // 2
    assert tally["jam"] > 10 or contacts == 1


@pytest.mark.parametrize(("contacts", "count"), [(1, 200), (2, 500), (3, 400)])
def test_second_motion_is_found_if_and_only_if_there_is_one(contacts: int, count: int) -> None:
    rng = np.random.default_rng(50 + contacts)
    work = workspace_of(np.zeros((contacts, 8)), 0.0)
    seen = {False: 0, True: 0}
    for rows in random_rows(count, contacts, rng):
        friction = rng.uniform(0, 2.5, contacts)
        found, _ = motions(rows, friction)
        fill(work, rows, friction)
        closing = closes(work.contacts, work.marks, work.step, contacts)
        if closing and advance(work, contacts) != Outcome.COMPLETED:
            continue
        apart = max((float(np.max(np.abs(a - b))) for a in found for b in found), default=0.0)
        if not found or 0.0 < apart < 1e-4:
            continue
        before = work.contacts.copy(), work.step.copy()
        assert is_ambiguous(work, contacts) == (len(found) > 1)
        seen[len(found) > 1] += 1
        np.testing.assert_array_equal(work.contacts, before[0])
        np.testing.assert_array_equal(work.step, before[1])
    assert seen[False] > count // 3
    assert seen[True] > (5 if contacts > 1 else -1)


def grasp() -> Push:
    """Two tips that face each other square across the part, one of them moving along its face."""
    tips = np.array([[[-HALF_SHORT, 0.0], [HALF_SHORT, 0.0]]])
    return Push.straight(
        vertices=rectangle(),
        poses=np.array([[0.0, 0.0, np.pi / 2]]),
        tips=tips,
        travel=np.array([[[0.0, 0.0], [0.0, -20 * UM]]]),
        friction=np.array([MU]),
        film_ratio=RHO,
        step=1 * UM,
    )


def test_held_part_may_be_turned_or_let_slip() -> None:
    """The distance of the tips does not change, so that the squeeze is whatever one likes.

    With enough of it both stick and the part turns about the tip at rest; with none it stays.
    """
    push = grasp()
    assert simulate(push).outcomes[0] == Outcome.COMPLETED
    result = simulate(push, unique=True, record=20)
    assert result.outcomes[0] == Outcome.NON_UNIQUE
    np.testing.assert_array_equal(result.poses, push.poses)
    np.testing.assert_array_equal(result.path[0], np.tile(push.poses[0], (21, 1)))


def test_ordinary_pushes_have_one_motion() -> None:
    limit = WIDTH * np.sqrt(1 + MU**2)  # nearer than this the tips jam the part
    for push in (
        one_point(350 * UM, 300 * UM, 2 * UM),
        two_sided([1000 * UM, limit + 20 * UM], 300 * UM, 2 * UM),
    ):
        plain, checked = simulate(push), simulate(push, unique=True)
        np.testing.assert_array_equal(checked.outcomes, Outcome.COMPLETED)
        np.testing.assert_array_equal(plain.poses, checked.poses)
