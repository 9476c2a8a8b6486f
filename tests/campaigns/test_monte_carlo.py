"""Monte Carlo: counts by hand, exact intervals, and the same totals however the work is cut up."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from meso_robust.campaigns.document import Campaign, read_campaign
from meso_robust.campaigns.encoding import part_of, part_text, result_of, result_text
from meso_robust.campaigns.intervals import ends_told, percent, share_interval
from meso_robust.campaigns.kind import Coverage, Paths, Result, Table
from meso_robust.campaigns.monte_carlo.kind import MONTE_CARLO, drawn
from meso_robust.campaigns.planned import largest_factor, plan_of
from meso_robust.errors import InputError
from meso_robust.laboratory.replay import Feedback, limits
from meso_robust.laboratory.simulation import in_goal
from meso_robust.laboratory.witness import read_witness
from meso_robust.planning.reading import read_plan
from meso_robust.primitives.setup import setup_of
from meso_robust.task import load_task
from meso_robust.toml_files import toml_text
from tests.conftest import paper_task

PLAN = Path(__file__).parents[2] / "reports" / "paper_task" / "plan.json"
HEAD = 'schema = "meso-robust/campaign/1"\nname = "test"\nseed = 4\n'


def stated(folder: Path, **keys: Any) -> Campaign:
    """A campaign of one part on the paper's plan."""
    values = {"name": "success", "kind": "monte-carlo", "plan": str(PLAN), "executions": 700} | keys
    lines = [f"{key} = {json.dumps(value)}" for key, value in values.items()]
    path = folder / "campaign.toml"
    path.write_text(HEAD + "[[part]]\n" + "\n".join(lines) + "\n", encoding="utf-8")
    return read_campaign(path)


@cache
def failing() -> tuple[Campaign, tuple[Result, ...]]:
    """Uncertainties so large that the plan often fails; chunks of 300, 300 and 100."""
    import tempfile

    with tempfile.TemporaryDirectory() as folder:
        asked = stated(Path(folder), factor=3.0, chunk=300)
    part = asked.parts[0]
    ready = MONTE_CARLO.prepare(part)
    return asked, tuple(MONTE_CARLO.execute(ready, part, k) for k in range(3))


def test_chunks_cut_up_what_was_asked(tmp_path: Path) -> None:
    part = stated(tmp_path, chunk=300).parts[0]
    assert MONTE_CARLO.count(part) == 3
    assert MONTE_CARLO.count(stated(tmp_path, chunk=350).parts[0]) == 2
    assert [one.runs for one in failing()[1]] == [300, 300, 100]


def test_counts_are_those_of_the_runs() -> None:
    """By running the same draws without the kind."""
    asked, results = failing()
    given = plan_of(asked.parts[0])
    player = replace(given.feedback, engine="events")
    good = 0
    for k in range(3):
        rows = drawn(asked.parts[0], player, k, 300)
        good += int(in_goal(player.run(rows), player.setup).sum())
    totals = MONTE_CARLO.total(asked.parts[0], results)
    assert totals["in_goal"] == good
    assert 0 < good < 700
    assert sum(one.failed for one in results) == 700 - good - totals["unfinished"]
    assert sum(totals["outcomes"].values()) == 700 - good
    assert sum(totals["misses"]) == 700 - sum(
        n for code, n in totals["outcomes"].items() if code != "0"
    )


def test_draws_fill_the_box_and_corners_are_corners(tmp_path: Path) -> None:
    part = stated(tmp_path, chunk=350, draws="corners").parts[0]
    player = plan_of(part).player("events")
    low, high = limits(player)
    rows = drawn(part, player, 1, 350)
    assert rows.shape == (350, len(low))
    assert ((rows == low) | (rows == high)).all()
    uniform = drawn(stated(tmp_path, chunk=350).parts[0], player, 1, 350)
    assert ((uniform >= low) & (uniform <= high)).all()
    shares = (uniform - low) / np.where(high > low, high - low, 1.0)
    assert np.abs(shares.mean(axis=0)[high > low] - 0.5).max() < 0.08
    assert not np.array_equal(rows, drawn(part, player, 0, 350))


def test_a_chunk_depends_on_nothing_but_its_part_and_index() -> None:
    asked, results = failing()
    part = part_of(part_text(asked.parts[0]))
    again = MONTE_CARLO.execute(MONTE_CARLO.prepare(part), part, 1)
    assert result_text(again) == result_text(results[1])
    assert result_of(result_text(again)) == results[1]


def test_parts_have_seeds_by_their_names(tmp_path: Path) -> None:
    one, other = stated(tmp_path).parts[0], stated(tmp_path, name="other").parts[0]
    assert one.seed != other.seed
    assert one.seed == stated(tmp_path, executions=9).parts[0].seed


def test_the_answer_has_the_exact_interval() -> None:
    asked, results = failing()
    totals = MONTE_CARLO.total(asked.parts[0], results)
    told = MONTE_CARLO.tell(asked.parts[0], totals)
    low, high = share_interval(totals["in_goal"], 700)
    assert told.verdict == "measured"
    assert f"{totals['in_goal']} of 700" in told.answer
    ends = re.search(r"interval ([\d.]+) % to ([\d.]+) %", told.answer)
    assert ends is not None
    # told to four decimals, rounded outward
    assert 0.0 <= 100 * low - float(ends[1]) < 1e-4
    assert 0.0 <= float(ends[2]) - 100 * high < 1e-4
    assert {type(view) for view in told.views} >= {Table, Coverage, Paths}
    (covered,) = (view for view in told.views if isinstance(view, Coverage))
    assert all(sum(row) == 700 for row in covered.counts)


@pytest.mark.parametrize(("wanted", "verdict"), [(0.3, "held"), (0.7628, "open"), (0.95, "broken")])
def test_a_demanded_share_is_judged_by_the_interval(wanted: float, verdict: str) -> None:
    asked, results = failing()
    part = asked.parts[0]
    totals = MONTE_CARLO.total(part, results)
    demanding = replace(part, asked={**part.asked, "at_least": wanted})
    assert MONTE_CARLO.tell(demanding, totals).verdict == verdict


@pytest.mark.parametrize(
    ("share", "text"),
    [
        (1.0, "100 %"),
        (0.0, "0 %"),
        (0.5, "50 %"),
        (1.0 - 1e-7, "99.99999 %"),
        (1e-9, "0.0000001 %"),
        (9_999_999_999 / 10_000_000_000, "99.99999999 %"),
    ],
)
def test_less_than_all_is_never_told_as_all(share: float, text: str) -> None:
    assert percent(share) == text


def test_ends_are_told_outward() -> None:
    assert ends_told(0.123456789, 0.123456789) == ("12.3456 %", "12.3457 %")
    # 2 ** -22 is 2.384...e-7
    assert ends_told(1.0 - 2.0**-22, 1.0) == ("99.999976 %", "100 %")
    assert ends_told(2.0**-22, 0.0)[0] == "0.000023 %"


def test_what_could_not_be_finished_neither_shows_nor_refutes() -> None:
    asked, results = failing()
    part = replace(asked.parts[0], asked={**asked.parts[0].asked, "at_least": 0.8})
    totals = MONTE_CARLO.total(part, results)
    assert MONTE_CARLO.tell(part, totals).verdict == "broken"
    told = MONTE_CARLO.tell(part, {**totals, "unfinished": 60})
    assert told.verdict == "open"
    assert "could not finish 60" in told.answer


def test_uncertainties_are_not_scaled_beyond_what_friction_and_film_can_be(tmp_path: Path) -> None:
    # friction of 0.33 +- 0.03 is zero at 11 times its range, the film ratio +- 5 % at 20 times
    assert largest_factor(paper_task()) == pytest.approx(11.0, rel=2e-3)
    wide = paper_task(uncertainty__friction=[0.2, 0.5])
    assert largest_factor(wide) == pytest.approx(0.35 / 0.15, rel=2e-3)
    assert setup_of(wide, largest_factor(wide)).uncertainty.friction.lo > 0.0
    (tmp_path / "wide.toml").write_text(
        toml_text(wide.model_dump(mode="json", by_alias=True, exclude_none=True)), encoding="utf-8"
    )
    with pytest.raises(InputError, match=r"key factor = 3: must not exceed 2\.33"):
        stated(tmp_path, factor=3.0, task="wide.toml")


def test_a_failure_is_replayed_from_its_files(tmp_path: Path) -> None:
    _, results = failing()
    failure = next(f for one in results for f in one.failures)
    for name, text in failure.files.items():
        (tmp_path / name).write_text(text, encoding="utf-8")
    task = load_task(tmp_path / "task.toml")
    plan = read_plan(tmp_path / "plan.json", task)
    player = failing_player()
    witness = read_witness(tmp_path / "witness.json", task, plan, player)
    runs = replace(player, engine=witness.engine).run(witness.row)
    assert not in_goal(runs, player.setup)[0]
    assert witness.breaks == (failure.what,)


def failing_player() -> Feedback:
    return plan_of(failing()[0].parts[0]).feedback


def test_missing_chunks_are_left_out() -> None:
    asked, results = failing()

    def some() -> Iterator[Result]:
        yield results[2]

    totals = MONTE_CARLO.total(asked.parts[0], some())
    assert totals["executions"] == 100
    nothing = MONTE_CARLO.total(asked.parts[0], iter(()))
    assert MONTE_CARLO.tell(asked.parts[0], nothing).answer == "No chunk was done."


@pytest.mark.parametrize(
    ("keys", "words"),
    [
        ({"executions": 0}, "part[0].executions"),
        ({"engine": "magic"}, "engine"),
        ({"colour": "red"}, "colour is unknown"),
        ({"kind": "magic"}, "magic"),
        ({"plan": "nowhere.json"}, "nowhere.json"),
        ({"task": "nowhere.toml"}, "nowhere.toml"),
        ({"factor": -1.0}, "factor"),
        ({"at_least": 2.0}, "at_least"),
    ],
)
def test_bad_input_is_refused(tmp_path: Path, keys: dict[str, Any], words: str) -> None:
    with pytest.raises(InputError) as caught:
        stated(tmp_path, **keys)
    assert words in str(caught.value)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "schema is missing"),
        (HEAD, "part is missing"),
        (HEAD + "part = []\n", "part"),
        (HEAD + '[[part]]\nkind = "monte-carlo"\nexecutions = 5\n', "name is missing"),
        (
            HEAD + 2 * '[[part]]\nname = "a"\nkind = "monte-carlo"\nexecutions = 5\n',
            "given twice",
        ),
        (
            HEAD
            + "".join(
                f'[[part]]\nname = "{n}"\nkind = "monte-carlo"\nexecutions = 5\n'
                for n in ("a b", "a-b")
            ),
            "same letters",
        ),
        ("schema = 1", "schema"),
        ("[", "is not a TOML file"),
    ],
)
def test_bad_files_are_refused(tmp_path: Path, text: str, words: str) -> None:
    path = tmp_path / "campaign.toml"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(InputError) as caught:
        read_campaign(path)
    assert words in str(caught.value)
    assert str(path) in str(caught.value)
