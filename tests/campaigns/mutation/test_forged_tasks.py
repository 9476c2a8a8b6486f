"""Forgeries of real parts and tips: about every quantity, consistent, and believed only where they are true."""

from __future__ import annotations

import copy
import json
import random
from pathlib import Path

import numpy as np
import pytest

from meso_robust.campaigns.mutation.answer import answered
from meso_robust.campaigns.mutation.excuses import excuse
from meso_robust.campaigns.mutation.forged_tasks import (
    FORGED_TASKS,
    KEYS,
    other_task,
    told_of,
    true_of,
)
from meso_robust.campaigns.mutation.kind import Mutant, judged
from meso_robust.campaigns.mutation.memory import Remembered
from meso_robust.campaigns.mutation.original import RUNS, Original
from meso_robust.campaigns.mutation.places import sealed
from meso_robust.checker.prover import Prover
from meso_robust.task import SCHEMA_2_KEYS, load_task
from tests.nightly import by_day

REAL = Path(__file__).resolve().parents[3] / "reports" / "campaigns" / "real_parts"


@pytest.fixture(scope="module")
def pushed() -> Original:
    """A plate that is pushed along and across, with all that can be uncertain about it."""
    document = json.loads((REAL / "push.json").read_text(encoding="utf-8"))
    return Original(load_task(REAL / "push.toml"), document)


@pytest.fixture(scope="module")
def prover() -> Prover:
    return Remembered().prover


def test_every_quantity_of_real_parts_and_tips_is_forged() -> None:
    assert {*KEYS} == SCHEMA_2_KEYS | {"friction", "drag_un_s_per_um"}


def test_what_is_about_another_task_fits_it(pushed: Original) -> None:
    """Ranges of the claim and of the inequalities are those of the task that it is told of."""
    task = other_task(pushed.task, "drag_centre_um", 3.0)
    assert task is not None
    document = copy.deepcopy(pushed.document)
    told_of(document, pushed, task)
    assert document["task_hash"] == task.hash
    stated = [document["claim"]["uncertainties"]["drag_centre"]]
    stated += [
        one["over"]["drag_a"]
        for step in document["steps"]
        for one in step["obligations"]
        if "drag_a" in one["over"]
    ]
    assert len(stated) > 5
    for low, high in stated:
        # 5 um, three times as much
        assert (float.fromhex(low), float.fromhex(high)) == pytest.approx((-15e-6, 15e-6), rel=1e-9)


@pytest.mark.parametrize("key", by_day(len(KEYS) // 2, [*sorted(KEYS)[::2], *sorted(KEYS)[1::2]]))
def test_no_forgery_of_a_quantity_is_believed_unless_it_is_true(
    key: str, pushed: Original, prover: Prover
) -> None:
    rng, words = random.Random(f"forged {key}"), []
    for kind in ("of less", "copied", "invented"):
        made = FORGED_TASKS[f"{key}: {kind}"](pushed, rng)
        if made is None:
            continue
        assert made.task == pushed.task if kind == "of less" else made.task != pushed.task
        found = judged(Mutant((made.name,), sealed(made.document), made.task), pushed, prover)
        assert not found.missed
        words.append(found.word)
    assert words


@pytest.mark.parametrize("key", ["size_tolerance_um", "drag_centre_um", "travel_direction_deg"])
def test_a_certificate_told_of_far_more_is_rejected(
    key: str, pushed: Original, prover: Prover
) -> None:
    task = other_task(pushed.task, key, 30.0)
    assert task is not None
    document = copy.deepcopy(pushed.document)
    told_of(document, pushed, task)
    assert answered(sealed(document), task, prover).word == "REJECTED"


def test_a_force_is_judged_by_runs_and_what_it_leaves_below_the_cap(pushed: Original) -> None:
    """The cap is 1 mN; the film's drag of 1 uN s/um gives about 0.1 mN at 100 um/s."""
    task = other_task(pushed.task, "max_force_un", 1.1)
    assert task is not None
    true = true_of(pushed, task)
    assert true is not None
    because = f"a force that {RUNS} runs do not exceed, as far below the cap"
    runs, _ = true.paths(true.document["policy"])
    assert runs.moves[0].forces is not None
    most = 1e-4 * float(np.linalg.norm(runs.moves[0].forces, axis=-1).max())
    for force, left, reason in (
        (None, 0.8e-3, because),
        (None, 0.81e-3, None),  # more than the stated force leaves
        (1.003 * most, 0.8e-3, because),  # closer than the planner's bound
        (0.99 * most, 0.8e-3, None),
    ):
        document = copy.deepcopy(true.document)
        one = document["steps"][0]["obligations"][-1]
        assert one["id"] == "force_below_cap"
        one["lower_bound"] = left.hex()
        if force is not None:
            one["over"]["force"][1] = force.hex()
        assert excuse(true, document) == reason
