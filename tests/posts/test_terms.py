"""How far barriers lie beyond slides by their terms, of a grip that is made up."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from meso_robust.bounds import Interval
from meso_robust.motion.two_sided import Grip, Start, enclose_slide, rate_at
from reports.posts.terms import Slides, by_terms

UM = 1e-6
ZERO = Interval.point(0.0)
SIDE = Interval.point(-900.0 * UM), Interval.point(900.0 * UM)
GRIP = Grip(
    room=Interval(70.0 * UM, 100.0 * UM),
    depth=Interval.point(400.0 * UM),
    depth_far=Interval.point(400.0 * UM),
    ends=SIDE,
    ends_far=SIDE,
    rho=Interval(3.6e-7, 3.9e-7),
    mu=Interval(0.3, 0.36),
    common=False,
)
START = Start(
    h=Interval(600.0 * UM, 600.0 * UM + 1e-9),
    labels={},
    value=500.0 * UM,
    rate=0.0,
    spread={"room": 0.06},
    rest=Interval(-10.0 * UM, 10.0 * UM),
)
SLIDES = Slides(grip=GRIP, start=START, apart=Interval(870.0 * UM, 900.0 * UM), h_end=-300.0 * UM)


def test_a_known_grip_in_the_middle_of_all_slides_at_the_rate_of_the_tube() -> None:
    known = replace(GRIP, rho=Interval.point(3.75e-7), mu=Interval.point(0.33))
    slides = replace(SLIDES, grip=known)
    at = slides.at(np.zeros((1, len(slides.constants))))
    for h, q in ((500.0, 450.0), (100.0, 300.0), (-200.0, 350.0)):
        for side in (-1, 1):
            (rate,) = slides.fastest(h * UM, np.array([q * UM]), at, side)
            assert abs(rate - rate_at(known, h * UM, q * UM)) < 1e-9


def test_slides_stay_in_the_proved_tube_and_reach_far_in_it() -> None:
    drawn = SLIDES.drawn(40)
    low, high = (SLIDES.followed(SLIDES.at(drawn), side)[-1] for side in (-1, 1))
    cell = enclose_slide(GRIP, START, SLIDES.h_end).cells[0]
    off = drawn[:, 0] * 0.5 * GRIP.room.width * cell.spread[-1, 0]
    lower, upper = (cell.centre[-1] + end[-1] + off for end in (cell.lower, cell.upper))
    assert (lower < low).all()
    assert (high < upper).all()
    assert (high - low).max() > 0.4 * (upper - lower).max()


def test_terms_of_second_order_leave_less() -> None:
    (_, *linear), (_, *second) = by_terms(SLIDES, 40)
    assert sum(second) < 0.5 * sum(linear)
    assert all(-1e-9 < off < 5.0 * UM for off in (*linear, *second))
