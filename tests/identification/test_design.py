"""Designed pushes: information, the search, what is excluded, and actual errors."""

from __future__ import annotations

import itertools
import json
from dataclasses import replace

import numpy as np
import numpy.typing as npt
import pytest
from scipy.stats import norm

from meso_robust.errors import InputError
from meso_robust.identification.candidates import Candidates, candidates, safe
from meso_robust.identification.design import DETERMINANT, Design, chosen, design, intervals
from meso_robust.identification.experiment_document import experiment_files
from meso_robust.identification.information import information, prior
from meso_robust.identification.rollout import rollout, start_of
from meso_robust.identification.sensitivity import StartBox
from meso_robust.recordings import SensorInfo
from meso_robust.recordings.rules import DEG
from meso_robust.reporting.experiment import experiment_page
from reports.identification.design_report import FINER, SENSOR, compare
from reports.identification.refit import RATE, _slopes, refit
from tests.identification.table_one import FILM, P1, POINTS, TESTS, VISCOUS

F = npt.NDArray[np.float64]
FEW = Candidates(places=5, angles=(-30 * DEG, 0.0, 30 * DEG))


@pytest.fixture(scope="module")
def found() -> Design:
    return design(FILM, VISCOUS, SENSOR, 8, choice=FEW)


def test_information_is_that_of_a_dense_fit_of_parameters_and_starts() -> None:
    for setting, values in ((FILM, VISCOUS), (POINTS, P1)):
        pushes = TESTS.pushes[:2]
        told = information(setting, pushes, values, SENSOR)
        assert told.completed.all()
        frames = 1 + round(750e-6 / setting.bench.speed * RATE)
        here = setting.model.coordinates(values[None])[0]
        slopes = _slopes(setting, pushes, frames, here, start_of(pushes))
        fitted = np.flatnonzero(setting.model.fitted)
        m = len(fitted)
        whole = slopes.T @ slopes
        across = whole[:m, m:]
        dense = whole[:m, :m] - across @ np.linalg.solve(whole[m:, m:], across.T)
        own = told.matrices.sum(axis=0)
        assert own[fitted[:, None], fitted] == pytest.approx(
            dense, rel=0.05, abs=0.02 * dense.max()
        )
        assert np.all(own[~setting.model.fitted] == 0.0)


def test_the_search_finds_the_best_of_all_sets() -> None:
    rng = np.random.default_rng(3)
    for column in (None, 1):
        hits = 0
        for _ in range(20):
            rows = rng.standard_normal((7, 3, 2))
            matrices = rows @ rows.transpose(0, 2, 1)
            base = 0.01 * np.eye(3)
            own = worth(matrices, base, chosen(matrices, base, 4, 2, column), column)
            every = itertools.combinations_with_replacement(range(7), 4)
            best = max(
                worth(matrices, base, rows, column)
                for rows in every
                if max(map(rows.count, rows)) <= 2
            )
            assert own <= best + 1e-9
            assert own > best - 0.1
            hits += own > best - 1e-9
        assert hits >= 17


def worth(matrices: F, base: F, rows: tuple[int, ...], column: int | None) -> float:
    whole = base + sum(matrices[row] for row in rows)
    if column is None:
        return float(np.log(np.linalg.det(whole)))
    return float(-np.log(np.linalg.inv(whole)[column, column]))


def test_repeats_are_limited() -> None:
    matrices = np.stack([np.eye(2), 100.0 * np.eye(2)])
    assert chosen(matrices, np.eye(2), 3, 2, None) == (0, 1, 1)


def test_pathological_pushes_are_excluded_by_name(found: Design) -> None:
    left = dict(found.experiment.left_out)
    assert "turns either way" in left["edge0_+0um_+0deg_700um"]
    assert "turns either way" in left["edge1_+0um_+0deg_700um"]
    assert "the tip loses the part" in left["edge0_-783um_-30deg_700um"]
    assert not {push.name for push in found.experiment.pushes} & set(left)
    kept, others = safe(FILM, TESTS.pushes, VISCOUS, StartBox())
    assert [push.name for push in kept] == list("ABDEFH")
    assert [name for name, _ in others] == list("CG")
    narrow = replace(FILM, bench=replace(FILM.bench, field=(2.4e-3, 1.7e-3)))
    pushes, left_out = candidates(narrow.part, narrow.bench, FEW)
    assert not pushes
    assert set(dict(left_out).values()) == {"may leave the field of view"}


def test_the_intervals_shrink_and_a_named_parameter_more(found: Design) -> None:
    named = design(FILM, VISCOUS, SENSOR, 8, choice=FEW, criterion="rho_um2")
    base = prior(FILM.model)
    standard = base + information(FILM, TESTS.pushes, VISCOUS, SENSOR).matrices.sum(axis=0)
    of_standard = intervals(FILM.model, VISCOUS, standard)
    lengths = [
        [one.high - one.low for one in ends]
        for ends in (found.before, of_standard, found.after, named.after)
    ]
    assert lengths[3][0] < lengths[2][0] < lengths[1][0] < lengths[0][0]
    assert lengths[2][1] < 0.3 * lengths[1][1]
    assert all(one.low < one.value < one.high for one in found.after)
    deviation = float(np.sqrt(np.linalg.inv(found.matrix)[1, 1]))  # µ counts by difference
    ends = norm(VISCOUS[1], deviation).interval(0.9)
    assert (found.after[1].low, found.after[1].high) == pytest.approx(ends, abs=1e-9)
    assert not any(one.informed for one in found.before)
    assert all(one.informed for one in found.after)
    more = design(FILM, VISCOUS, SENSOR, 1, choice=FEW, known=found.matrix - base)
    for before, after, then in zip(found.after, more.before, more.after, strict=True):
        assert (after.low, after.high) == pytest.approx((before.low, before.high))
        assert then.high - then.low < after.high - after.low


def test_what_no_motion_shows_stays_unknown() -> None:
    few = Candidates(places=3, angles=(0.0, 30 * DEG))
    found = design(POINTS, P1, SENSOR, 4, choice=few)
    informed = {one.key: one.informed for one in found.after}
    assert not informed.pop("mu_s")
    assert all(informed.values())
    page = experiment_page(found.experiment, found, POINTS.model)
    assert page.count("its range only") == 8 + 1
    assert '<td class="nowrap">−563.3</td>' in page
    values = json.loads(experiment_files(found.experiment, found, POINTS.model)["experiment.json"])
    expected = {row["parameter"]: row for row in values["expected"]}
    assert expected["mu_s"] == {
        "parameter": "mu_s",
        "value": 0.757,
        "before": None,
        "after": None,
    }
    row = expected["point1_x_um"]
    assert row["value"] == pytest.approx(-563.3)
    assert row["after"][0] < -563.3 < row["after"][1]


def test_a_design_can_be_written_down_with_its_repeats(found: Design) -> None:
    names = [push.name for push in found.experiment.pushes]
    assert len(set(names)) == 8
    assert any(name.endswith("_2") for name in names)
    text = experiment_files(found.experiment)["set.toml"]
    assert all(f'"{name}_1.csv"' in text for name in names)


def test_designed_pushes_give_smaller_actual_errors_than_the_eight_tests(found: Design) -> None:
    """Refits of noisy data of the event-driven engine; µ and ρ differ from those designed for."""
    plans = {"tests": TESTS.pushes, "designed": found.experiment.pushes}
    fine = replace(FILM, model=replace(FILM.model, step=FINER * FILM.model.step))
    result, failed = compare(fine, VISCOUS, np.array([0.05, 0.03]), plans, sets=3, seed=5)
    assert not failed
    ratio, mu = result["designed"].rms / result["tests"].rms
    assert mu < 0.5
    assert ratio < 1.3
    for outcomes in result.values():  # errors are of the size that the fits claim
        assert np.all(np.abs(outcomes.errors) < 5.0 * outcomes.deviations)


def test_the_refit_returns_the_truth_of_data_without_noise() -> None:
    pushes = TESTS.pushes[:2]
    truth = VISCOUS * [1.04, 0.95]
    seen = rollout(FILM, pushes, start_of(pushes), truth, intervals=60).path
    assert refit(FILM, pushes, seen, VISCOUS).values == pytest.approx(truth, rel=1e-5)


def test_wrong_wishes_are_refused() -> None:
    few = Candidates(places=1, angles=(30 * DEG,), repeats=1)
    with pytest.raises(InputError, match=r"99 pushes; must be 1 to \d"):
        design(FILM, VISCOUS, SENSOR, 99, choice=few)
    with pytest.raises(InputError, match="criterion: 'mu_s'; must be determinant or"):
        design(POINTS, P1, SENSOR, 2, criterion="mu_s")
    with pytest.raises(InputError, match="must be known"):
        design(FILM, VISCOUS, SensorInfo(frame_rate=30.0), 2, choice=few)
    for known in (np.eye(3), -np.eye(2), np.full((2, 2), np.nan)):
        with pytest.raises(InputError, match="known: shape"):
            design(FILM, VISCOUS, SENSOR, 2, choice=replace(few, places=4), known=known)
    with pytest.raises(InputError, match="at least 1"):
        Candidates(places=0)
    assert DETERMINANT not in FILM.model.keys
