"""A search that may take so long at most."""

from __future__ import annotations

import subprocess
import sys
import time
from collections.abc import Sequence
from contextlib import nullcontext
from typing import Any

import pytest
from numba.core.event import trigger_event

from meso_robust.certificates.words import words
from meso_robust.errors import NotApplicableError
from meso_robust.planning import compose
from meso_robust.planning.effort import EffortSpentError, each, limited, spend
from tests.paper import paper_task

COPIES = """
import os, time
from meso_robust import copies
from meso_robust.planning.effort import EffortSpentError, each, limited, spend
copies.allow()
copies.threads = lambda: 2
here, begun = os.getpid(), time.process_time()
while time.process_time() < begun + 1.0:  # a copy's clock begins with none of this
    pass

def searched(k):
    ends = time.process_time() + 0.6
    while os.getpid() != here and time.process_time() < ends:
        spend()
    time.sleep(0.1)  # the copy gets one as well

try:
    with limited(0.2):
        each(searched, range(3))
except EffortSpentError:
    print("spent in a copy")
"""
SCALE = 3  # of the arguments of `_rules`


def test_a_limit_holds_within_its_block_only() -> None:
    spend()
    with limited(-1.0), pytest.raises(EffortSpentError):
        spend()
    spend()


def test_a_limit_within_another_is_no_longer() -> None:
    with limited(-1.0), limited(1e6), pytest.raises(EffortSpentError):
        spend()
    with limited(1e6), limited(None):
        spend()


@pytest.mark.parametrize("compiling", [True, False])
def test_what_compiling_takes_does_not_count(compiling: bool) -> None:
    begun = time.process_time()
    what = trigger_event("numba:compile") if compiling else nullcontext()
    with limited(0.2), nullcontext() if compiling else pytest.raises(EffortSpentError):
        with what:
            while time.process_time() < begun + 0.4:
                pass
        spend()


def test_of_searches_side_by_side_none_is_lost_and_none_takes_longer() -> None:
    with limited(1e6):
        assert each(lambda k: None if k == 1 else 2 * k, range(4)) == [0, None, 4, 6]

    def spends(_: int) -> None:
        spend()

    with limited(-1.0), pytest.raises(EffortSpentError):
        each(spends, range(4))


@pytest.mark.skipif(sys.platform in ("win32", "darwin"), reason="processes are not copied there")
def test_the_limit_of_a_search_is_that_of_its_copies_too() -> None:
    ended = subprocess.run(
        [sys.executable, "-c", COPIES], capture_output=True, text=True, timeout=60, check=False
    )
    assert ended.stdout == "spent in a copy\n", ended.stderr
    assert not ended.stderr


def test_a_search_without_time_says_how_to_look_longer() -> None:
    with pytest.raises(NotApplicableError, match=r"within 0.001 s .*--search-s"):
        compose.compose(paper_task(), 0.001)


def given(monkeypatch: pytest.MonkeyPatch, *ends: float) -> None:
    """Let searches at these scales end without an answer, and those at smaller ones find a plan."""

    def rules(*args: Any, **more: Any) -> Sequence[object] | None:
        if args[SCALE] in ends:
            raise EffortSpentError
        return None if args[SCALE] > 1.0 else ()

    monkeypatch.setattr(compose, "_rules", rules)


def test_a_plan_that_was_found_is_kept_when_one_with_more_in_hand_takes_too_long(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    given(monkeypatch, compose.IN_HAND[1])
    assert compose.compose(paper_task(), 60.0).scale == 1.0


def test_more_in_hand_is_looked_for_in_steps_and_the_last_one_found_is_kept(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    most, more, least = compose.IN_HAND
    scales: list[float] = []

    def rules(*args: Any, **_: Any) -> Sequence[object] | None:
        scales.append(args[SCALE])
        if args[SCALE] == most:
            raise EffortSpentError
        return ()

    monkeypatch.setattr(compose, "_rules", rules)
    assert compose.compose(paper_task(), 60.0).scale == more
    assert [one for one in scales if one >= least] == [most, least, more, most]


def test_what_would_settle_a_search_that_gave_up_names_its_time(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    given(monkeypatch, 1.0)
    found = compose.compose(paper_task(), 7.0)
    assert (found.scale, found.searched_s) == (compose.NARROWED, 7.0)
    told = words(found.settled_by)
    assert "about 7 s" in told
    assert "--search-s" in told
    assert str(found.only).replace("_", " ") in told.replace("_", " ")


def test_a_search_that_came_to_its_end_did_not_give_up(monkeypatch: pytest.MonkeyPatch) -> None:
    """What would settle the task is the closest plan that was found, though a closer one was not waited for."""

    def rules(*args: Any, **more: Any) -> Sequence[object] | None:
        if args[SCALE] == compose.NARROWED:
            raise EffortSpentError
        return () if args[SCALE] == compose.REDUCED[-1] else None

    monkeypatch.setattr(compose, "_rules", rules)
    found = compose.compose(paper_task(), 7.0)
    assert (found.scale, found.searched_s) == (compose.REDUCED[-1], None)
    assert "--search-s" not in words(found.settled_by)


def asked(monkeypatch: pytest.MonkeyPatch, least: float) -> list[tuple[float, int, bool]]:
    """What is searched for: scale, number of headings, and whether pushes in one will do.

    Only searches below the scale ``least`` are carried out; the others find nothing.
    """
    seen: list[tuple[float, int, bool]] = []
    searched = compose._rules

    def rules(*args: Any, **more: Any) -> Sequence[object] | None:
        seen.append((args[SCALE], len(args[2]), more.get("alone", True)))
        return searched(*args, **more) if args[SCALE] < least else None

    monkeypatch.setattr(compose, "_rules", rules)
    return seen


def test_a_task_without_any_plan_is_told_from_the_least_uncertainties(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Before all that a plan for the task's own would be looked for with: tips that must jam."""
    seen = asked(monkeypatch, 2.0)
    with pytest.raises(NotApplicableError, match=r"all uncertainties scaled by 0\.03"):
        compose.compose(paper_task(probe__tip_spacing_um=200.0))
    assert seen == [(1.2, 0, True), (0.03, 4, True)]


def test_nothing_is_searched_twice(monkeypatch: pytest.MonkeyPatch) -> None:
    """With other headings, pushes in one are left out, which failed; the last resort is looked for once."""
    seen = asked(monkeypatch, 0.05)
    compose.compose(paper_task())
    assert seen[:5] == [
        (1.2, 0, True),
        (0.03, 4, True),
        (1.0, 0, True),
        (1.2, 4, False),
        (1.0, 4, False),
    ]
    assert [one[0] for one in seen].count(0.03) == 1
