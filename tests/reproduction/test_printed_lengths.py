"""The joint search of what Table II leaves out: what is tried, and that a fit is one when replayed."""

import numpy as np
import pytest

from meso_robust.reproduction import printed, printed_lengths
from meso_robust.reproduction.bench import START, Blend, Place, nominal
from meso_robust.reproduction.item import Setting
from meso_robust.reproduction.printed_lengths import Tried, supports, tried


def test_stretched_points_keep_their_loads_and_stay_in_their_frame() -> None:
    plain = Blend(np.array([0.0])).tables().points[0]
    drawn = Blend(np.array([0.0]), np.array([[0.5, -0.25]])).tables().points[0]
    assert drawn[:, 0] == pytest.approx(0.5 * plain[:, 0])
    assert drawn[:, 1] == pytest.approx(-0.25 * plain[:, 1])
    assert drawn[:, 2] == pytest.approx(plain[:, 2])
    # the weight still balances about the centre
    assert drawn[:, 2] @ drawn[:, :2] == pytest.approx([0.0, 0.0], abs=1e-9)


def test_films_points_and_both_senses_are_tried_alike() -> None:
    runs = supports(40, np.random.default_rng(1))
    assert runs.film_ratio is not None
    assert int(np.isfinite(runs.film_ratio).sum()) >= 20
    turned = np.rad2deg(runs.poses[:, 2])
    assert sorted(set(turned.round(6))) == [89.0, 91.0]
    assert runs.stretch is not None
    assert (np.abs(runs.stretch) <= 1.0).all()


def test_a_run_of_the_search_is_the_printed_plan_on_the_paper_s_film() -> None:
    place = Place()
    runs = nominal("film", 2)
    one = tried(place, runs)
    # the film of the paper turns a free peg by about 55 deg in the item scripted
    assert np.rad2deg(one.turned) == pytest.approx([one.turned[0] / np.pi * 180.0] * 2)
    assert 40.0 < np.rad2deg(one.turned[0]) < 60.0
    assert not one.inside.any()


def test_the_search_in_small_says_how_many_fit_and_replays_the_best() -> None:
    found = printed_lengths.run(Setting(quick=True))
    data = found.data
    assert data["tried"] == 2 * 3 * 24
    fit = data["fit"]
    assert isinstance(fit, dict)
    assert fit["film_ratio_um2"] is not None
    place = Place(
        mouth=fit["mouth_um"] * 1e-6, axis=fit["axis_um"] * 1e-6, friction=fit["wall_friction"]
    )
    runs = nominal("film", 1)
    poses = np.array([[*START[:2], np.deg2rad(fit["start_deg"])]])
    again = tried(
        place,
        type(runs)(
            poses=poses,
            tips=runs.tips,
            friction=np.array([fit["tip_friction"]]),
            share=runs.share,
            film_ratio=np.array([fit["film_ratio_um2"] * 1e-12]),
        ),
    )
    assert again.inside.all()
    assert fit["film_ratio_um2"] * 1e-12 < printed.FILM_RATIO
    assert str(data["in_slot"]) in found.answer


def test_where_nothing_fits_the_answer_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    runs = supports(8, np.random.default_rng(0))
    none = Tried(
        place=Place(),
        runs=runs,
        left=np.linspace(1e-3, 2e-3, 8),
        turned=np.full(8, np.deg2rad(57.0)),
        inside=np.zeros(8, dtype=bool),
    )
    monkeypatch.setattr(printed_lengths, "searched", lambda _: [none])
    found = printed_lengths.run(Setting(quick=True))
    assert found.answer.startswith("None fits: of 8 joint choices")
    assert "at most 57 deg" in found.answer
    assert found.data["fit"] is None
