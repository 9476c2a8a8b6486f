"""A film that thins: its bounds against sums over the area, its promise against the simulator."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import pytest

from meso_robust.identification.document import ModelDocument
from meso_robust.task import parse_task
from meso_robust.transfer.assumption_check import standings
from meso_robust.transfer.lines import LINES
from meso_robust.transfer.promise import Recertified, recertified
from meso_robust.transfer.uneven_film import thinned
from meso_robust.types import Floats
from tests.paper import paper_task
from tests.transfer.models import budget, model
from tests.transfer.runs import outside_boxes

BASE = {"rho_um2": (374_000.0, 379_000.0), "mu": (0.325, 0.335)}
SIZE = {"shear_thinning.exponent_drop": (0.0494, 0.0825)}
BUDGET = budget(radius_um=2500.0, seconds=120.0)


def area(slender: float, count: int = 300) -> Floats:
    """Places of a rectangle with the ratio 1."""
    x, y = np.meshgrid(*((np.arange(count) + 0.5) / count - 0.5,) * 2)
    places = np.stack([x.ravel() * slender, y.ravel()], axis=1)
    return places * np.sqrt(12.0 / (slender**2 + 1.0))


def seen(places: Floats, about: Floats, drop: float) -> tuple[float, float]:
    """Distance of the centre, and change of the ratio, while the part turns about a point."""
    k = np.hypot(*(places - about).T) ** -drop
    centre = k @ places / k.sum()
    return float(np.hypot(*centre)), abs(
        float(k @ ((places - centre) ** 2).sum(axis=1) / k.sum()) - 1
    )


@pytest.mark.parametrize(
    ("drop", "slender", "tight"),
    [((0.0494, 0.0825), 1616 / 837, 0.85), ((-0.04, 0.03), 1.0, 0.6), ((-0.09, -0.08), 3.0, 0.8)],
)
def test_centre_and_ratio_are_within_their_bounds_wherever_the_part_turns_about(
    drop: tuple[float, float], slender: float, tight: float
) -> None:
    far, change = thinned(drop, slender)
    places, rng = area(slender), np.random.default_rng(1)
    side = np.sqrt(3.0 / (1.0 + slender**2))
    # the ends of the area are where the centre moves farthest, its middle where the ratio changes most
    about = [
        *(np.array([share * slender * side, 0.02]) for share in np.linspace(0.5, 1.2, 8)),
        *(np.array([0.0, share * side]) for share in np.linspace(0.01, 1.1, 4)),
        *rng.normal(size=(30, 2)) * [slender, 1.0],
        np.array([40.0, 30.0]),
    ]
    each = np.array([seen(places, at, one) for at in about for one in drop])

    assert tight * far < each[:, 0].max() <= far
    assert (tight - 0.1) * change < each[:, 1].max() <= change


def test_an_exponent_too_large_for_the_bound_leaves_all_that_drags() -> None:
    absorb = LINES["shear_thinning"].absorb
    assert absorb is not None
    found = absorb({"exponent_drop": (-0.9, 0.1)}, BUDGET)
    assert found is not None

    assert found.drag_centre_um > 1e6 * np.sqrt(380e-9) * np.abs(area(1616 / 837)).max()
    assert found.ratio_share == 2.0


@cache
def made(*more: tuple[str, tuple[float, float]]) -> tuple[ModelDocument, Recertified]:
    document = model({**SIZE, **dict(more)}, base=BASE)
    return document, recertified(paper_task(), document)


def test_a_promise_with_thinning_is_of_a_centre_that_moves() -> None:
    """The centre moves by up to 30.4 um and the ratio by 2.9 %, by a sum over the area."""
    u = made()[1].changed.task.uncertainty

    assert made()[1].proved
    assert u.drag_centre_moves is True
    (said,) = [one.absorbed for one in made()[1].standings if one.name == "shear_thinning"]
    assert said is not None
    assert "the part's proportions" in said.condition
    assert u.drag_centre_um is not None
    assert 30.4 < u.drag_centre_um < 36.0
    assert 0.66 + 2.9 < u.film_ratio_percent < 0.66 + 3.6


def test_on_a_film_that_is_uneven_besides_nothing_is_promised() -> None:
    """The bound is of a film that is even but for the thinning."""
    other: Any = ("drag_drift.rate_percent_s", (0.5, 1.0))
    task = paper_task()
    stated = parse_task(
        {
            **(values := task.model_dump(mode="json", by_alias=True, exclude_none=True)),
            "schema": "meso-robust/task/2",
            "probe": {**values["probe"], "tip_radius_um": [0.0, 0.0]},
            "uncertainty": {**values["uncertainty"], "drag_centre_um": 2.0},
        },
        "a task",
    )
    for found in (made(other)[1], recertified(stated, made()[0])):
        (standing,) = [one for one in found.standings if one.name == "shear_thinning"]
        assert not standing.survives
        assert "not even but for it" in standing.said
    assert standings(made()[0], BUDGET)[-1].survives


def test_runs_with_thinning_stay_in_the_boxes_and_leave_those_of_a_film_without() -> None:
    document, found = made()
    even = recertified(paper_task(), model(base=BASE))
    outside = [outside_boxes(one, document) for one in (found, even)]

    assert outside[0] == 0.0
    assert outside[1] > 2e-7
