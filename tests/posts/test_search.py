"""Draws that are bred towards a goal reach what is known to be the largest value."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from meso_robust.laboratory.draws import Draws, draw
from meso_robust.primitives.setup import setup_of
from meso_robust.types import Floats
from reports.posts.__main__ import LEGS, Width, at_tips, page, varying
from reports.posts.search import bred, largest
from tests.paper import paper_task

SETUP = setup_of(paper_task())


def fresh_of(seed: int) -> Callable[[int], Draws]:
    rng = np.random.default_rng(seed)
    return lambda count: draw(SETUP, 5, count, rng)


def spread_of_errors(draws: Draws) -> Floats:
    """Largest where twenty numbers are at their ends; one corner in a million is there."""
    sensed, probe = draws.sensing[:, 1:, :2], draws.dual
    return np.asarray(
        1e6 * (sensed.sum(axis=(1, 2)) - probe.sum(axis=(1, 2))) + draws.friction - draws.film_ratio
    )


def test_the_corner_with_the_largest_value_is_found() -> None:
    u = SETUP.uncertainty
    truth = 1e6 * (8 * u.sensed_position.hi - 10 * u.probe_position.lo)
    truth += u.friction.hi - u.film_ratio.lo
    fresh = fresh_of(0)
    single = spread_of_errors(fresh(1000)).max()
    found = largest(fresh, spread_of_errors, 200, 30, seed=0)
    assert single < truth - 10.0
    assert abs(found - truth) < 1e-6


def test_a_largest_value_inside_the_box_is_found() -> None:
    def near(draws: Draws) -> Floats:
        return -np.abs(draws.friction - 0.31) - 1e6 * np.abs(draws.film_ratio - 0.38e-6)

    assert largest(fresh_of(1), near, 200, 30, seed=0) > -1e-3


def test_a_run_that_does_not_count_has_no_children() -> None:
    def low(draws: Draws) -> Floats:
        return np.where(draws.friction > 0.33, -np.inf, draws.friction)

    assert 0.329 < largest(fresh_of(2), low, 200, 15, seed=0) <= 0.33


def test_a_child_has_its_numbers_from_its_parents_and_a_fresh_row() -> None:
    parents, fresh = draw(SETUP, 5, 5, np.random.default_rng(0)), fresh_of(3)(400)
    child = bred(parents, fresh, np.random.default_rng(0))
    from_parents = np.isin(child.friction, parents.friction)
    assert (from_parents | (child.friction == fresh.friction)).all()
    assert 0.8 < from_parents.mean() < 0.97


def test_the_page_tells_the_largest_ratio_of_each_action() -> None:
    rows = [
        Width(task="a", move=1, action="tilt", certified=(3.0, 2.0, 1.0), found=(2.0, 2.0, 1.0)),
        Width(task="b", move=1, action="tilt", certified=(1.0, 2.0, 1.0), found=(1.0, 1.0, 1.0)),
    ]
    assert "| tilt | 2 | 1.25, 1.50 | 1.50, 2.00 | 1.00, 1.00 |" in page(rows)


def test_friction_varies_on_the_way_as_the_promise_allows() -> None:
    """At every stretch another one, but the same at all tips where the task says so."""
    drawn = varying(draw(SETUP, 4, 60, np.random.default_rng(0)), SETUP, np.random.default_rng(1))
    friction, u = at_tips(drawn).tip_friction, SETUP.uncertainty
    assert SETUP.friction_common
    assert friction is not None
    assert drawn.legs == LEGS
    assert (np.ptp(friction, axis=3) == 0.0).all()
    assert (np.ptp(friction, axis=2) > 0.0).mean() > 0.9
    assert u.friction.lo <= friction.min() < friction.max() <= u.friction.hi
