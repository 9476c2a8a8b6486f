"""The third blind trial: independence, laws, commitment, scoring."""

from __future__ import annotations

import ast
import hashlib
import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from meso_robust.recordings import read_set
from meso_robust.simulator.catalogue import CATALOGUE, stage_of
from reports.blind3 import generate, laws
from reports.blind3.__main__ import again, kept, run
from reports.blind3.beyond import LEARNT
from reports.blind3.cases import (
    COMMITMENT,
    Case,
    checked,
    commit,
    digest,
    generator_hash,
    listed,
    renew,
)
from reports.blind3.generate import Change, World, Wrongs, clear_norm, filmed, pushes, small_wrongs
from reports.blind3.laws import FAMILIES, OUTSIDE
from reports.blind3.score import Scored, page, results_text
from tests.nightly import at_night

ROOM = Path(generate.__file__).parent


def imports(path: Path) -> set[str]:
    found = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            found.add(str(node.module))
    return {name for name in found if name.split(".")[0] in ("meso_robust", "reports")}


def test_the_generator_uses_the_plant_and_the_writer_of_recordings_only() -> None:
    allowed = ("meso_robust.plant.", "reports.blind3.")
    for module in ("generate.py", "laws.py", "cases.py"):
        others = {name for name in imports(ROOM / module) if not name.startswith(allowed)}
        assert others <= {"meso_robust.recordings"}, module


def test_families_are_the_catalogues_and_what_is_outside_is_not() -> None:
    for name, family in FAMILIES.items():
        assert stage_of(name).name == family.stage
        assert all(other in CATALOGUE for other in family.alike)
        law = CATALOGUE[name]
        assert family.form not in law.forms
    assert not (set(OUTSIDE) - set(LEARNT)) & set(CATALOGUE)  # one has had its name since


def test_every_truth_is_a_number_of_the_catalogue() -> None:
    for family in FAMILIES.values():
        for key in family.make(family.guess, np.random.default_rng(0)).truth:
            name, parameter = key.split(".")
            assert parameter in {one.key for one in CATALOGUE[name].parameters}


def test_small_wrongs_are_never_nothing() -> None:
    for seed in range(20):
        wrongs = small_wrongs(np.random.default_rng(seed))
        assert all(getattr(wrongs, key) > 0.0 for key in Wrongs.__dataclass_fields__)


@pytest.fixture(scope="module")
def plan() -> list[generate.Push]:
    return pushes(np.random.default_rng(5), count=2)


@pytest.fixture(scope="module")
def norm(plan: list[generate.Push]) -> Any:
    return clear_norm(World(), plan)


@pytest.mark.parametrize("name", [*FAMILIES, *OUTSIDE])
def test_every_law_changes_what_is_seen(name: str, plan: list[generate.Push], norm: Any) -> None:
    family = {**FAMILIES, **OUTSIDE}[name]
    size = family.most
    drawn = (family.make(size, np.random.default_rng(k)) for k in range(6))
    # a place or an edge may be drawn where no push goes
    assert any(norm([filmed(World(changes=(one,)), push) for push in plan]) > 1.0 for one in drawn)


def test_a_start_and_a_friction_that_a_model_fits_are_no_change(
    plan: list[generate.Push], norm: Any
) -> None:
    seen = [filmed(World(), push) for push in plan]
    shifted = [poses + np.array([3.0, -2.0, 0.01]) for poses in seen]
    assert norm(shifted) < 1e-9
    slipperier = [filmed(World(mu=generate.MU + 0.002), push) for push in plan]
    turned = [
        poses + np.linspace(0.0, 1.0, len(poses))[:, None] * [3.0, 0.0, 0.0] for poses in seen
    ]
    assert norm(slipperier) < 0.2 * norm(turned)


def test_an_exposure_delays_by_its_half() -> None:
    times = np.linspace(0.0, 4.0, 321)
    poses = np.outer(times, [10.0, -5.0, 0.1])
    see = laws.long_exposure(50.0, np.random.default_rng(0)).see
    assert see is not None
    np.testing.assert_allclose(see(times, poses)[100:], poses[100:] - [0.5, -0.25, 0.005])


def test_a_round_play_lags_by_its_half_and_stands_still_when_it_turns() -> None:
    drive = laws.round_play(6.0, np.random.default_rng(0)).drive
    assert drive is not None
    way = np.column_stack([np.r_[np.arange(0.0, 21.0), 18.0], np.zeros(22)])
    true = drive(np.zeros(22), way)
    assert true[20, 0] == pytest.approx(17.0)
    assert true[21, 0] == pytest.approx(17.0)


def test_one_edge_stands_out() -> None:
    change = laws.one_edge_out(8.0, np.random.default_rng(1))
    plain, grown = generate.corners_of(World()), generate.corners_of(World(changes=(change,)))
    (key,) = change.truth
    axis = "xy".index(key.split(".")[1][0])
    assert sorted(np.abs(grown - plain)[:, axis]) == pytest.approx([0.0, 0.0, 8.0, 8.0])
    growth = np.ptp(grown[:, axis]) - np.ptp(plain[:, axis])
    assert growth == pytest.approx(2.0 * change.truth[key])


def test_the_list_interleaves_kinds_and_draws_sizes_from_1_to_300() -> None:
    cases = listed()
    assert len(cases) == 400
    assert [case.id for case in cases] == list(range(400))
    for k in range(0, 400, 20):
        kinds = [case.kind for case in cases[k : k + 20]]
        counts = [kinds.count(kind) for kind in ("single", "null", "pair", "outside")]
        assert counts == [10, 4, 3, 3]
    sizes = np.array([size for case in cases for size in case.multiples])
    assert sizes.min() >= 1.0
    assert sizes.max() <= 300.0
    assert np.mean(np.log(sizes) / np.log(300.0)) == pytest.approx(0.5, abs=0.06)


def test_the_commitment_is_to_this_list_and_this_generator() -> None:
    promised = json.loads(COMMITMENT.read_text(encoding="utf-8"))
    text = COMMITMENT.with_name("cases.json").read_bytes()
    assert hashlib.sha256(text).hexdigest() == promised["cases_sha256"]
    assert [case["seed"] for case in json.loads(text)] == [case.seed for case in listed()]
    assert promised["generator_sha256"] == generator_hash()
    assert {f"{one['id']:03d}" for one in kept()} <= set(promised["sets"])


@pytest.fixture(scope="module")
def promised(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("trial")
    commit(0, 1, folder / "sets", folder / "commitment.json")
    return folder


@at_night
def test_another_generator_is_promised_only_if_it_makes_the_same_sets(
    promised: Path, tmp_path: Path
) -> None:
    commitment = tmp_path / "commitment.json"
    before = json.loads((promised / "commitment.json").read_text(encoding="utf-8"))
    sha = before["sets"]["000"]["sha256"]
    for sealed, differ in ((sha[::-1], ["000"]), (sha, [])):
        before["sets"]["000"]["sha256"] = sealed
        text = json.dumps(before | {"generator_sha256": "another"})
        commitment.write_text(text, encoding="utf-8")
        assert renew(tmp_path / "sets", commitment) == differ
        now = json.loads(commitment.read_text(encoding="utf-8"))["generator_sha256"]
        assert now == ("another" if differ else generator_hash())


def test_a_set_that_was_altered_is_not_diagnosed(promised: Path) -> None:
    sets, commitment = promised / "sets", promised / "commitment.json"
    case = listed()[0]
    folder = checked(case, sets, commitment)
    assert len(read_set(folder).recordings) == generate.PUSHES
    file = folder / "push_03.csv"
    text = file.read_text(encoding="utf-8")
    file.write_text(text[:-2] + ("1" if text[-2] != "1" else "2") + "\n", encoding="utf-8")
    with pytest.raises(ValueError, match="differs"):
        checked(case, sets, commitment)
    file.write_text(text, encoding="utf-8")
    assert checked(case, sets, commitment) == folder
    (folder / "push_08.csv").write_text("", encoding="utf-8")
    with pytest.raises(ValueError, match="differs"):
        checked(case, sets, commitment)
    (folder / "push_08.csv").unlink()
    with pytest.raises(ValueError, match="commit to it first"):
        checked(listed()[1], sets, commitment)
    listing = promised / "cases.json"
    whole = listing.read_text(encoding="utf-8")
    listing.write_text(whole.replace('"null"', '"pair"', 1), encoding="utf-8")
    with pytest.raises(ValueError, match="list"):
        checked(case, sets, commitment)
    listing.write_text(whole, encoding="utf-8")


def test_a_set_is_the_same_made_again(promised: Path, tmp_path: Path) -> None:
    commit(0, 1, tmp_path / "sets", tmp_path / "commitment.json")
    assert digest(tmp_path / "sets" / "000") == digest(promised / "sets" / "000")


def test_a_run_goes_on_where_it_was_stopped(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: list[int] = []

    def answer(case: Case) -> dict[str, Any]:
        asked.append(case.id)
        return {"id": case.id, "verdict": "consistent"}

    monkeypatch.setattr("reports.blind3.__main__.answered", answer)
    path = tmp_path / "results.jsonl"
    run(listed()[:2], 1, path)
    run(listed()[:4], 1, path)
    assert asked == [0, 1, 2, 3]
    assert [one["id"] for one in kept(path)] == [0, 1, 2, 3]


def test_cases_that_have_an_answer_are_answered_again_and_no_others(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def answer(case: Case) -> dict[str, Any]:
        told: dict[str, Any] = {
            "verdict": "consistent",
            "effects": {},
            "explained": None,
            "stage": None,
        }
        return {"id": case.id, "seconds": 1.0, "cpu_seconds": 1.0, **told}

    made: list[int] = []
    monkeypatch.setattr("reports.blind3.__main__.answered", answer)
    monkeypatch.setattr("reports.blind3.__main__.SETS", tmp_path)
    monkeypatch.setattr("reports.blind3.__main__.sealed", lambda case, folder: made.append(case.id))
    before, last = kept(), max(one["id"] for one in kept())
    path = tmp_path / "again.jsonl"
    text = again(listed()[last - 1 : last + 3], 1, path)
    assert made == [one["id"] for one in kept(path)] == [last - 1, last]
    assert kept() == before
    assert text.startswith("# Results of 2 cases")


def made_up(
    kind: str, families: tuple[str, ...], verdict: str, *effects: str, **more: Any
) -> Scored:
    size = more.pop("size", 20.0)
    case = Case(id=7, kind=kind, families=families, multiples=(size,) * len(families), seed=0)
    told: dict[str, Any] = {
        name: {"share": None, "stage": "x", "parameters": {}} for name in effects
    }
    told.update(more.pop("told", {}))
    answer = {"id": 7, "verdict": verdict, "effects": told, "stage": None, "explained": None}
    label = {"measured": [size] * len(families), "small": 1.0, "truth": more.pop("truth", {})}
    return Scored(
        case=case, label=label, answer={**answer, "seconds": 9.0, "cpu_seconds": 8.0, **more}
    )


@pytest.mark.parametrize(
    ("scored", "right", "wrong", "wanted"),
    [
        (made_up("single", ("dry_friction",), "named", "dry_friction"), True, False, True),
        (made_up("single", ("dry_friction",), "partial", "dry_friction"), True, False, True),
        (made_up("single", ("dry_friction",), "unknown", "dry_friction"), False, False, False),
        (made_up("single", ("dry_friction",), "named", "backlash"), False, True, False),
        (made_up("single", ("dry_friction",), "partial", "backlash"), False, False, False),
        (
            made_up("single", ("dry_friction",), "named", "dry_friction", "backlash"),
            True,
            True,
            False,
        ),
        (
            made_up("single", ("dry_friction",), "named", "dry_friction", "probe_compliance"),
            True,
            False,
            True,
        ),
        (made_up("single", ("body_force",), "named", "film_flow"), True, False, True),
        (made_up("single", ("body_force",), "none"), False, False, False),
        (made_up("null", (), "consistent"), False, False, True),
        (made_up("null", (), "named", "backlash"), False, True, False),
        (made_up("null", (), "named", "anisotropic_drag"), False, False, False),
        (
            made_up("pair", ("dry_friction", "backlash"), "named", "dry_friction", "backlash"),
            True,
            False,
            True,
        ),
        (
            made_up("pair", ("dry_friction", "backlash"), "named", "dry_friction"),
            False,
            False,
            False,
        ),
        (made_up("outside", ("shake",), "unknown", stage="observation"), False, False, True),
        (made_up("outside", ("shake",), "unknown", stage="support"), False, False, False),
        (made_up("outside", ("shake",), "named", "camera_drift"), False, True, False),
        (
            made_up("outside", ("shake",), "partial", "camera_drift", stage="observation"),
            False,
            False,
            True,
        ),
    ],
)
def test_classes(scored: Scored, right: bool, wrong: bool, wanted: bool) -> None:
    if scored.case.families and scored.case.kind != "outside":
        assert scored.right is right
    assert scored.wrong is wrong
    assert scored.wanted is wanted


@pytest.mark.parametrize(
    ("families", "told", "right", "physics"),
    [
        (("breakaway_friction",), ("breakaway_friction",), True, True),
        (("breakaway_friction",), ("stribeck_friction",), False, True),
        (("breakaway_friction",), ("uneven_support",), False, False),
        (("breakaway_friction", "backlash"), ("stribeck_friction",), False, False),
        (("body_force",), ("film_flow",), True, True),
    ],
)
def test_another_law_of_the_same_physics_is_counted_apart(
    families: tuple[str, ...], told: tuple[str, ...], right: bool, physics: bool
) -> None:
    one = made_up("pair" if len(families) > 1 else "single", families, "partial", *told)
    assert one.right is right
    assert one.right_physics is physics
    assert not made_up("single", families[:1], "ambiguous", *told).right_physics


def test_coverage_and_share() -> None:
    told = {"camera_latency": {"parameters": {"time_ms": [50.0, 45.0, 55.0]}}}
    explained = {"share": 0.9, "low": 0.8, "high": 1.0, "folds": 4}
    hit = made_up(
        "single", ("camera_latency",), "named", told=told, explained=explained, size=3.0,
        truth={"camera_latency.time_ms": 54.0},
    )  # fmt: skip
    assert hit.covered == [True]
    assert hit.share_error == pytest.approx(0.9 - 9.0 / 10.0)
    off = replace(hit, label={**hit.label, "truth": {"camera_latency.time_ms": 56.0}})
    assert off.covered == [False]
    assert made_up("null", (), "consistent", truth={}).covered == []


def test_the_page_counts_by_size_and_lists_every_miss_and_leaves_opened_cases_out() -> None:
    near = made_up("single", ("backlash",), "named", "backlash", size=3.9)
    miss = made_up("single", ("backlash",), "unknown", why="a | b", size=4.0)
    other = replace(miss, case=replace(miss.case, id=8))
    text = results_text([near, miss, other], opened=frozenset({8}))
    assert "Results of 2 cases" in text
    assert "≥ 4× | ≥ 85 % | 0 of 1, 0 %" in text
    assert "< 4× |  | 1 of 1, 100 %" in text
    blind, opened = text.split("## Opened")
    assert "| 7 | single | backlash 4.0× | unknown |" in blind
    assert "a / b" in blind
    assert "| 8 | single" not in blind
    assert "| 8 | single" in opened


def test_a_mended_diagnoser_is_scored_apart() -> None:
    miss = made_up("single", ("backlash",), "unknown", size=4.0)
    first, later = (replace(miss, case=replace(miss.case, id=k)) for k in (71, 72))
    text = page([first, later])
    assert text.count("Results of 1 cases") == 2
    assert text.index("Cases 72 to 72") < text.index("Cases 0 to 71")


def test_a_hook_acts_where_it_is_put() -> None:
    push = pushes(np.random.default_rng(5), count=1)[0]
    pulled = World(changes=(Change(force=lambda now: np.array([2.0, 0.0])),))
    early = filmed(pulled, push)[:6, 0]
    # a free part on a film of unit drag drifts at the force
    assert early[5] - early[0] == pytest.approx(2.0 * 5 / generate.RATE, rel=0.02)
