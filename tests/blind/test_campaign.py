"""The machinery of the blind benchmark, with a generator and diagnosers that are made up."""

from __future__ import annotations

import json
import sys
import textwrap
from collections import Counter
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from meso_robust.campaigns.blind.labels import KINDS
from meso_robust.campaigns.blind.sealing import (
    RESULTS,
    SETS,
    SealError,
    opened,
    read_results,
    whole_lines,
)
from reports.blind.blind_report import write_report
from reports.blind.campaign import run
from reports.blind.committing import Setting, commit, sources
from reports.blind.corpus import EFFECTS, QUICK, Corpus, Entry, entries
from reports.blind.serve import ROOT, Command, NoAnswerError, Service

OUTSIDE = tuple(f"kind_{k}" for k in range(9))
HIDDEN = (("backlash", "camera_latency"), ("drag_drift",))
FROZEN = 64 * "d"
SMALL = Corpus(
    nulls=2, effects=("backlash",), multiples=(8.0,), pairs=0, outside=1, unidentifiable=0
)

DIAGNOSER = """
import json, os, pathlib, sys, time
def diagnosed(folder, *, quick, seed):
    print("progress")
    told = json.loads((folder / "set.toml").read_text())
    if told == "dies":
        os._exit(3)
    if told == "hangs":
        time.sleep(60)
    if told == "raises":
        raise ValueError("no such thing")
    return dict(told, asked=[quick, seed], beside=sorted(os.listdir(folder.parent)))
if __name__ == "__main__":
    told = json.loads(pathlib.Path(sys.argv[1], "set.toml").read_text())
    sys.exit(2) if isinstance(told, str) else json.dump(dict(told, words=sys.argv[2:]), sys.stdout)
"""


def document(verdict: str, *names: str) -> dict[str, Any]:
    """A diagnosis in outline."""
    return {
        "verdict": verdict,
        "effects": [{"name": n, "probability": 0.8, "parameters": {}} for n in names],
        "ambiguous_with": [],
        "not_identifiable": [],
        "mismatch": {"detected": bool(names), "p_value": 0.5, "where": []},
        "held_out": {"recordings": []},
    }


def conceal(entry: Entry, seed: int, folder: Path) -> Mapping[str, Any]:
    """Recordings that hold the answer: right, but for what the catalogue does not have."""
    wrong = entry.kind == "outside"
    names = ("body_force",) if wrong else entry.names
    told = document("named" if names else "consistent", *names)
    folder.mkdir(parents=True)
    (folder / "set.toml").write_text(json.dumps(told), encoding="utf-8")
    count = len(entry.names)
    return {
        "parameters": [{}] * count,
        "stages": ["environment"] * count,
        "multiples": entry.multiples,
        "drawn": seed,
    }


@pytest.fixture
def diagnoser(tmp_path: Path) -> Path:
    """A folder with the module ``fake`` in it."""
    (tmp_path / "bin").mkdir()
    (tmp_path / "bin" / "fake.py").write_text(textwrap.dedent(DIAGNOSER), encoding="utf-8")
    return tmp_path / "bin"


def service(folder: Path) -> Service:
    return Service("fake:diagnosed", (ROOT, folder), longest=20.0)


def frozen() -> str:
    return FROZEN


def setting(corpus: Corpus) -> Setting:
    cases = entries(corpus, OUTSIDE, HIDDEN)
    return Setting(corpus=corpus, cases=cases, quick=True, diagnoser=frozen, conceal=conceal)


# ------------------------------------------------------------------------------------- corpus


def test_the_corpus_has_what_was_promised() -> None:
    cases = entries(Corpus(), OUTSIDE, HIDDEN)
    assert Counter(case.kind for case in cases) == {
        "null": 100,
        "effect": 140,
        "pair": 60,
        "outside": 40,
        "unidentifiable": 20,
    }
    singles = Counter((c.names[0], c.multiples[0]) for c in cases if c.kind == "effect")
    assert singles == dict.fromkeys(((e, m) for e in EFFECTS for m in (1, 2, 4, 8, 16)), 1)
    assert len({c.names for c in cases if c.kind == "outside"}) == 9
    assert {c.design for c in cases if c.kind == "unidentifiable"} == {"lazy"}
    assert len(entries(QUICK, OUTSIDE, HIDDEN)) == 12


def test_pairs_are_of_two_effects_and_all_effects_have_their_turn() -> None:
    for seed in range(20):
        drawn = entries(Corpus(master_seed=seed), OUTSIDE, HIDDEN)
        names = [case.names for case in drawn if case.kind == "pair"]
        assert all(one != other for one, other in names)
        counts = Counter(name for pair in names[8:] for name in pair)
        assert max(counts.values()) - min(counts.values()) <= 2


def test_the_first_quarter_is_a_fair_sample() -> None:
    cases = entries(Corpus(repeats=2), OUTSIDE, HIDDEN)
    whole, first = (Counter(c.kind for c in part) for part in (cases, cases[: len(cases) // 4]))
    assert all(abs(first[kind] - whole[kind] / 4) <= 1 for kind in KINDS)
    sizes = Counter(c.multiples[0] for c in cases[: len(cases) // 4] if c.kind == "effect")
    assert max(sizes.values()) - min(sizes.values()) <= 5
    names = Counter(c.names[0] for c in cases[: len(cases) // 4] if c.kind == "effect")
    assert set(names) == set(EFFECTS)
    assert max(names.values()) <= 3


def test_another_master_seed_is_another_order_of_as_many_cases() -> None:
    one, other = (entries(Corpus(master_seed=k), OUTSIDE, HIDDEN) for k in (1, 2))
    assert one == entries(Corpus(master_seed=1), OUTSIDE, HIDDEN)
    assert one != other
    assert Counter(c.kind for c in one) == Counter(c.kind for c in other)


# ----------------------------------------------------------------------------------- campaign


def test_a_campaign_from_commitment_to_report(tmp_path: Path, diagnoser: Path) -> None:
    corpus = replace(QUICK, nulls=5)
    list(commit(tmp_path, setting(corpus)))
    seeds = [case.label["truth"]["drawn"] for case in opened(tmp_path)[1]]
    assert len(set(seeds)) == 14
    asked = [service(diagnoser), service(diagnoser)]
    results = list(run(tmp_path, asked, frozen))
    assert {result["index"] for result in results} == set(range(14))
    write_report(tmp_path)
    found = json.loads((tmp_path / "results.json").read_text(encoding="utf-8"))
    assert found["nulls"]["alarms"]["hits"] == 0
    plain, wrong = found["naming"]["plain"]["right"], found["wrong_and_confident"]["all"]
    assert (plain["hits"], plain["count"]) == (5, 5)
    assert (wrong["hits"], wrong["count"]) == (2, 14)
    rows = (tmp_path / "cases.csv").read_text(encoding="utf-8").splitlines()
    assert len(rows) == 15
    assert sum(",yes,no," in row for row in rows) == 11  # the unidentifiable one was named
    assert sum(",outside," in row and ",named,body_force,no,yes," in row for row in rows) == 2
    text = (tmp_path / "README.md").read_text(encoding="utf-8")
    assert "**14 of the 14 cases of the corpus were run**" in text
    assert "| nothing concealed | 5 | 5 |" in text


def test_the_diagnoser_sees_a_folder_of_its_own_and_no_label(
    tmp_path: Path, diagnoser: Path
) -> None:
    list(commit(tmp_path, setting(SMALL)))
    seen: list[Path] = []

    class Watching(Service):
        def ask(self, folder: Path, *, quick: bool, seed: int) -> dict[str, Any]:
            seen.append(folder)
            told = Service.ask(self, folder, quick=quick, seed=seed)
            assert told["beside"] == ["recordings"]
            assert told["asked"] == [True, 0]
            return told

    list(run(tmp_path, [Watching("fake:diagnosed", (ROOT, diagnoser))], frozen))
    assert len(seen) == 4
    assert not any(path.is_relative_to(tmp_path) or path.exists() for path in seen)


def test_an_interrupted_campaign_goes_on_and_runs_no_case_twice(
    tmp_path: Path, diagnoser: Path
) -> None:
    list(commit(tmp_path, setting(QUICK)))
    begun = run(tmp_path, [service(diagnoser), service(diagnoser)], frozen)
    first = [next(begun) for _ in range(3)]
    begun.close()  # as an interrupt would
    path = tmp_path / RESULTS
    path.write_bytes(path.read_bytes()[:-9])  # and the power fails while the third is written
    rest = list(run(tmp_path, [service(diagnoser)], frozen))
    assert len(first) + len(rest) == 12 + 1
    assert sorted(line["index"] for line in whole_lines(path)) == list(range(12))


def test_a_report_says_how_much_was_run(tmp_path: Path, diagnoser: Path) -> None:
    list(commit(tmp_path, setting(SMALL)))
    write_report(tmp_path)
    page = tmp_path / "README.md"
    assert "**0 of the 4 cases" in page.read_text(encoding="utf-8")
    steps = run(tmp_path, [service(diagnoser)], frozen)
    next(steps)
    steps.close()
    write_report(tmp_path)
    assert "**1 of the 4 cases" in page.read_text(encoding="utf-8")


def test_time_that_is_up_begins_no_case(tmp_path: Path, diagnoser: Path) -> None:
    list(commit(tmp_path, setting(SMALL)))
    assert list(run(tmp_path, [service(diagnoser)], frozen, until=0.0)) == []
    assert len(list(run(tmp_path, [service(diagnoser)], frozen))) == 4


def test_a_changed_diagnoser_gets_no_second_shot(tmp_path: Path, diagnoser: Path) -> None:
    list(commit(tmp_path, setting(SMALL)))
    hashes = iter([FROZEN, FROZEN, FROZEN, 64 * "e"])
    steps = run(tmp_path, [service(diagnoser)], lambda: next(hashes))
    next(steps)  # the second case is answered too, but by which version?
    with pytest.raises(SealError, match="are not those committed to"):
        next(steps)
    with pytest.raises(SealError, match="another diagnoser"):
        list(commit(tmp_path, replace(setting(SMALL), diagnoser=lambda: 64 * "e")))
    with pytest.raises(SealError, match="another corpus"):
        list(commit(tmp_path, setting(QUICK)))
    assert len(read_results(tmp_path)) == 1


def test_an_interrupted_commitment_goes_on_with_what_is_sealed(tmp_path: Path) -> None:
    steps = commit(tmp_path, setting(SMALL))
    next(steps)
    before = whole_lines(tmp_path / "sealed.jsonl")
    steps.close()
    assert not (tmp_path / "commitment.json").exists()
    (tmp_path / SETS / "0001").mkdir()  # was being written
    list(commit(tmp_path, setting(SMALL)))
    assert whole_lines(tmp_path / "sealed.jsonl")[:2] == before
    assert len(opened(tmp_path)[1]) == 4


def test_recordings_changed_after_the_commitment_are_found(tmp_path: Path, diagnoser: Path) -> None:
    list(commit(tmp_path, setting(SMALL)))
    (tmp_path / SETS / "0002" / "more.csv").write_text("", encoding="utf-8")
    list(run(tmp_path, [service(diagnoser)], frozen))
    with pytest.raises(SealError, match="case 2: diagnosed on other recordings"):
        write_report(tmp_path)


# --------------------------------------------------------------------------- asking the diagnoser


@pytest.mark.parametrize(
    ("told", "longest", "message"),
    [
        ("dies", 20.0, "ended by 3"),
        ("hangs", 0.5, "took more than 0.5 s"),
        ("raises", 20.0, "no such thing"),
    ],
)
def test_a_diagnoser_that_fails_is_noted_and_the_next_case_is_answered(
    tmp_path: Path, diagnoser: Path, told: str, longest: float, message: str
) -> None:
    one = service(diagnoser)
    one.longest = longest
    (tmp_path / "set.toml").write_text(json.dumps(told), encoding="utf-8")
    with pytest.raises(NoAnswerError, match=message):
        one.ask(tmp_path, quick=False, seed=0)
    one.longest = 20.0
    (tmp_path / "set.toml").write_text('{"verdict": "unknown"}', encoding="utf-8")
    assert one.ask(tmp_path, quick=False, seed=0)["verdict"] == "unknown"
    one.close()
    with pytest.raises(NoAnswerError, match="closed"):
        one.ask(tmp_path, quick=False, seed=0)


def test_a_command_of_its_own_for_every_folder(tmp_path: Path, diagnoser: Path) -> None:
    template = [sys.executable, str(diagnoser / "fake.py"), "{folder}", "--seed", "{seed}"]
    one = Command(template)
    (tmp_path / "set.toml").write_text('{"verdict": "unknown"}', encoding="utf-8")
    assert one.ask(tmp_path, quick=True, seed=5)["words"] == ["--seed", "5", "--quick"]
    (tmp_path / "set.toml").write_text('"bad"', encoding="utf-8")
    with pytest.raises(NoAnswerError, match="exit status 2"):
        one.ask(tmp_path, quick=False, seed=5)


def test_the_hash_of_the_diagnoser_is_that_of_the_package(tmp_path: Path) -> None:
    package = tmp_path / "meso_robust" / "diagnosis"
    package.mkdir(parents=True)
    (package / "naming.py").write_text("LEVEL = 0.05\n", encoding="utf-8")
    before = sources(tmp_path)
    (package / "naming.py").write_text("LEVEL = 0.01\n", encoding="utf-8")
    assert sources(tmp_path) != before
    assert sources() != before


def test_the_package_does_not_know_the_benchmark() -> None:
    for path in (ROOT / "meso_robust").rglob("*.py"):
        assert "tests.blind" not in path.read_text(encoding="utf-8"), path.name
