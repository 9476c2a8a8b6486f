"""Dry contact under the film: its bounds against sums over the area, its promise against the simulator."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from meso_robust.bounds import Interval
from meso_robust.identification.document import ModelDocument
from meso_robust.primitives.names import ObligationId
from meso_robust.transfer import inflation, promise as module
from meso_robust.transfer.assumption_check import standings
from meso_robust.transfer.envelope import enough, needed, roomier
from meso_robust.transfer.inflation import Absorbed
from meso_robust.transfer.lines import LINES
from meso_robust.transfer.promise import Recertified, as_fast, recertified
from meso_robust.transfer.uneven_film import _mean, rubbed
from meso_robust.types import Floats
from tests.nightly import by_day
from tests.paper import paper_task
from tests.strategies import paper_chain
from tests.transfer.models import budget, model
from tests.transfer.runs import outside_boxes
from tests.transfer.test_thinning import area

BASE = {"rho_um2": (374_000.0, 379_000.0), "mu": (0.325, 0.335)}
SIZE = {"dry_friction.ratio": (0.0253, 0.0423)}
"""Four times what recordings can just show, and that to either side."""


def seen(places: Floats, more: Floats) -> tuple[float, float]:
    """Distance of the centre, and change of the ratio, with so much drag beyond the film's."""
    k = 1.0 + more
    centre = k @ places / k.sum()
    ratio = k @ ((places - centre) ** 2).sum(axis=1) / k.sum()
    return float(np.hypot(*centre)), abs(float(ratio) - 1.0)


@pytest.mark.parametrize(
    ("still", "growing", "slender"), by_day(1, [(0.05, 0.0, 1616 / 837), (0.03, 0.02, 1.3)])
)
def test_centre_and_ratio_are_within_their_bounds_wherever_the_dry_contact_is(
    still: float, growing: float, slender: float
) -> None:
    """All over the area, near the point about which the part turns alone, or where it draws the centre most."""
    far, change = rubbed(still, growing, slender)
    places, rng = area(slender, 150), np.random.default_rng(1)
    side = math.sqrt(3.0 / (1.0 + slender**2))
    about = [
        *(np.array([share * slender * side, 0.02]) for share in np.linspace(0.4, 1.1, 8)),
        *(np.array([0.01, share * side]) for share in np.linspace(0.0, 1.0, 4)),
        *rng.normal(size=(20, 2)) * [slender, 1.0],
        np.array([400.0, 300.0]),
    ]
    each = []
    for at in about:
        away, way = np.hypot(*(places - at).T), places @ at / np.hypot(*at)
        most = (still + growing * float(np.hypot(*at))) / away
        beyond = 0.0
        for _ in range(3):
            beyond = seen(places, most * (way > beyond))[0]
        each += [
            seen(places, most * where) for where in (1.0, away < 1.0, way > beyond, away > 0.7)
        ]
    worst = np.max(each, axis=0)

    assert 0.65 * far < worst[0] <= far
    assert 0.5 * change < worst[1] <= change


def test_the_mean_that_drags_between_bounds_can_have_is_bounded_closely() -> None:
    """Where it is largest each drag is at one of its ends: here all ways are gone through."""
    rng = np.random.default_rng(3)
    for _ in range(20):
        of = rng.normal(size=(1, 2, 4))
        low = rng.uniform(0.1, 1.0, (1, 2, 4))
        top = low + rng.uniform(0.0, 2.0, (1, 2, 4))
        ends = np.stack([low, top]).reshape(2, -1)
        drags = [[ends[pick, k] for k, pick in enumerate(way)] for way in np.ndindex(*(2,) * 8)]
        most = max(float(k @ of.ravel() / k.sum()) for k in map(np.array, drags))
        (found,) = _mean(low, top, of, np.zeros(1))
        (more,) = _mean(low, top, of, np.full(1, 0.3))
        assert most <= found + 1e-12
        assert most + 0.3 / top.sum() <= more
        if most > 0.2:
            assert found < 2.0 * most


def test_without_dry_contact_nothing_moves() -> None:
    assert rubbed(0.0, 0.0, 2.0) == (0.0, 0.0)


def bound(effect: str, ranges: dict[str, tuple[float, float]], **changes: float) -> Absorbed:
    absorb = LINES[effect].absorb
    assert absorb is not None
    found = absorb(ranges, budget(**changes))
    assert found is not None
    return found


def test_what_is_bounded_by_hand(monkeypatch: pytest.MonkeyPatch) -> None:
    """0.04 of the film's drag at 75 um/s are 3 um/s; at 1200 um/s, 0.99 of it against the edge, 1 / 396. A part
    that turns by 0.15 rad per mm, too, has 3 / 1200 / 0.15 mm, and the root of its ratio is 608.28 um."""
    monkeypatch.setattr(inflation, "rubbed", lambda still, growing, _: (still, growing))
    found = bound("dry_friction", {"ratio": (0.01, 0.04)}, speed_um_s=1200.0)

    assert found.drag_centre_um == pytest.approx(16.667 / 608.28 * math.sqrt(380e3), abs=0.02)
    assert found.ratio_share == pytest.approx(1.0 / 396.0)
    assert found.centre_moves
    assert "1200 µm/s or more" in found.condition
    wide = bound("dry_friction", {"ratio": (0.01, 0.04)}, speed_um_s=1200.0, reach_um=9100.0)
    assert wide.drag_centre_um == pytest.approx(
        9100.0 / 396.0 / 608.28 * math.sqrt(380e3), abs=0.02
    )
    # the centre of pressure a tenth of the half sides 935.5 and 484.5 um of such a film off: 1.6 times as much
    off = {"ratio": (0.02, 0.025), "x_um": (-93.55, 0.0), "y_um": (0.0, 48.45)}
    uneven = bound("uneven_support", off, speed_um_s=1200.0)
    assert uneven.drag_centre_um == pytest.approx(found.drag_centre_um, abs=0.02)


def test_no_bound_is_made_of_much_dry_contact_or_of_a_part_that_may_not_move() -> None:
    for changes in ({}, {"press": 0.0}, {"turn_per_um": 0.0}):
        found = bound("dry_friction", {"ratio": (0.0, 1.0 if not changes else 1e-3)}, **changes)
        assert found.drag_centre_um > 1e6 * math.sqrt(380e-9) * np.abs(area(1616 / 837)).max()
        assert found.ratio_share == 2.0


def test_how_slowly_the_plan_turns_the_part_by_the_law_of_its_orientation() -> None:
    """Between tips (h, V) apart the direction is atan2(V, h) + asin(W / hypot), the turn its change with h."""
    chain, task = paper_chain(), paper_task()
    need = needed(chain, task, 1616 / 837)
    (turned,) = (step for step in chain.steps if step.rule.action == "rotate")
    (both,) = (
        one.proof.box for one in turned.obligations if one.name.id is ObligationId.BOTH_TIPS_TOUCH
    )
    across, end = both["V"], both["h"].lo

    def angle(h: float, v: float) -> float:
        return math.atan2(v, h) + math.asin(837e-6 / math.hypot(h, v))

    rates = [
        (angle(h - 1e-9, v) - angle(h, v)) * 1e3
        for h in np.linspace(end, 800e-6, 40)
        for v in (across.lo, across.hi)
    ]
    assert 0.7 * min(rates) < need.turn_per_um <= min(rates)
    # a tilt, or what a straightening begins with, is that far off upright
    most = max(
        abs(theta - round(theta / (math.pi / 2)) * math.pi / 2)
        for step in chain.steps
        if step.rule.action != "rotate"
        for box in (step.pre, *(knot.box for knot in step.tube))
        for theta in (box.theta.lo, box.theta.hi)
    )
    assert need.press == pytest.approx(math.cos(most), abs=1e-9)
    assert enough(roomier(need), need)
    assert not enough(replace(need, press=1.01 * need.press), need)
    assert not enough(replace(need, turn_per_um=1.01 * need.turn_per_um), need)


def test_a_probe_that_falls_short_of_its_command_is_slower() -> None:
    """A travel 4 % shorter takes as long; a path that strays by 1 um in 100 um may be 1 % slower."""
    chain = paper_chain()
    u = chain.setup.uncertainty
    least = {
        name: needed(
            replace(chain, setup=replace(chain.setup, uncertainty=replace(u, **changes))),
            paper_task(),
            1.9,
        )
        for name, changes in {
            "as it is": {},
            "short": {"travel_scale": Interval(-0.04, 0.02)},
            "astray": {"probe_wander": Interval(-1e-6, 1e-6)},
        }.items()
    }
    plain = least["as it is"]
    assert least["short"].press == pytest.approx(0.96 * plain.press, rel=1e-9)
    assert least["short"].turn_per_um == pytest.approx(0.96 * plain.turn_per_um, rel=1e-6)
    assert least["astray"].press < 0.99 * plain.press


def test_a_cap_on_forces_is_not_kept_by_a_film_that_drags_more() -> None:
    for effect, size in {
        "dry_friction.ratio": (0.02, 0.04),
        "drag_drift.rate_percent_s": (0.0, 5.0),
    }.items():
        document = model({effect: size}, base=BASE)
        free, capped = (standings(document, budget(capped=one))[-1] for one in (False, True))
        assert (free.word, capped.word) == ("absorbed", "breaks a premise")
        assert "cap on contact forces" in capped.said


def test_uneven_support_is_absorbed_only_where_its_place_was_fitted() -> None:
    size = {"uneven_support.ratio": (0.01, 0.02), "uneven_support.x_um": (-20.0, 20.0)}
    place = {"uneven_support.y_um": (-20.0, 20.0)}
    words = [
        standings(model({**size, **more}, base=BASE, held=held), budget())[-1].word
        for more, held in ((place, {}), ({}, {}), ({}, {"uneven_support.y_um": 0.0}))
    ]
    assert words == ["absorbed", "not identified", "not identified"]


@cache
def fast() -> tuple[ModelDocument, Recertified]:
    document = model(SIZE, base=BASE)
    task = paper_task()
    return document, module._within(task, document, "", module._first_budget(task, document, 16.0))


def test_a_promise_with_dry_contact_is_of_fast_probes_and_a_centre_that_moves() -> None:
    _, found = fast()
    changes = {one.key: (one.before, one.after, one.because) for one in found.changed.changes}

    assert found.proved
    assert changes["probe.speed_um_s"] == ("75", "1200", "dry_friction")
    assert found.changed.task.uncertainty.drag_centre_moves is True
    (said,) = [one.absorbed for one in found.standings if one.name == "dry_friction"]
    assert said is not None
    assert "from its first touch to its stop" in said.condition
    run = as_fast(paper_task(), found.changed.task)
    assert run.probe.speed_um_s == 1200.0
    assert run.uncertainty == paper_task().uncertainty


def test_too_much_dry_contact_breaks_the_premise_and_leaves_the_speed_as_it_is() -> None:
    found = recertified(paper_task(), model({"dry_friction.ratio": (2.0, 3.0)}, base=BASE))
    (standing,) = [one for one in found.standings if one.name == "dry_friction"]

    assert standing.word == "breaks a premise"
    assert "16 times as fast" in standing.said
    assert found.changed.task.probe.speed_um_s == 75.0
    assert found.changed.task.uncertainty.drag_centre_um is None


def test_dry_contact_on_a_film_that_is_uneven_besides_is_not_bounded() -> None:
    both = {**SIZE, "shear_thinning.exponent_drop": (0.01, 0.02)}
    words = {one.name: one.word for one in standings(model(both), budget(slender=0.0))}

    assert words["dry_friction"] == words["shear_thinning"] == "breaks a premise"


def test_runs_with_dry_contact_stay_in_the_boxes_and_slow_ones_leave_those_of_a_film_without() -> (
    None
):
    document, found = fast()
    even = recertified(paper_task(), model(base=BASE))
    outside = [outside_boxes(one, document) for one in (found, even)]

    assert outside[0] == 0.0
    assert outside[1] > 2e-7
