"""The walls of a slot: what the checker finds clear, by brute force and on a whole certificate."""

from __future__ import annotations

import json
from collections.abc import Iterator
from functools import cache
from typing import Any

import numpy as np
import pytest
from flint import arb, ctx

from meso_robust.certificates.chain import certify
from meso_robust.certificates.document import (
    CertificateDocument,
    SimulationDocument,
    claim_document,
    exact_box,
    margin_document,
    reading_document,
    step_document,
)
from meso_robust.certificates.margin import Margin
from meso_robust.checker import numbers
from meso_robust.checker.approach import approaches
from meso_robust.checker.dual import Dual
from meso_robust.checker.ids import place
from meso_robust.checker.inputs import ALWAYS_STATED, given
from meso_robust.checker.moves import verify_move
from meso_robust.checker.pair import Pair
from meso_robust.checker.passage import Sweep
from meso_robust.checker.ranges import Box
from meso_robust.checker.scene import Scene
from meso_robust.checker.verdict import BITS, Answer
from meso_robust.checker.walls import apart
from meso_robust.planning.compose import compose
from meso_robust.planning.document import goal_document, plan_document
from meso_robust.primitives.move import MoveRule
from meso_robust.primitives.setup import setup_of
from meso_robust.task import Slot, Task, load_task
from tests.checker.test_check import checked, relisted
from tests.nightly import at_night
from tests.slot import SLOT, point_slot

Document = dict[str, Any]


@pytest.fixture(scope="module", autouse=True)
def _as_the_checker_computes() -> Iterator[None]:
    with ctx.workprec(BITS):
        yield


@cache
def certificate(task: Task) -> str:
    """A certificate of a task with the slot."""
    return certificate_of(task, compose(task).rules)


def certificate_of(task: Task, rules: tuple[MoveRule, ...]) -> str:
    """What is certified of a plan; a margin of 1 saves the search of a wider one."""
    setup = setup_of(task)
    chain = certify(rules, setup)
    each = dict.fromkeys(setup.uncertainty.stated, 1.0)
    margin = Margin(factor=1.0, refused=None, binding=next(iter(each)), each=each, limit=None)
    none = (0.0, 0.0, 0.0)
    return CertificateDocument(
        verdict=chain.verdict.word,
        task=task.name,
        task_hash=task.hash,
        claim=claim_document(task, chain, len(rules)),
        goal=goal_document(setup.goal),
        goal_exact=exact_box(setup.goal),
        policy=plan_document(task, rules, [np.zeros(3)] * len(rules), [None] * len(rules)).policy,
        steps=tuple(map(step_document, chain.steps)),
        undecided=None,
        witness=None,
        margin=margin_document(margin),
        simulation=SimulationDocument(
            samples=0, seed=0, step_um=1.0, completed=0, in_goal=0, in_certified_box=0,
            largest_excess_um_um_deg=(), simulator_error_um_um_deg=none,
        ),
        made_with={},
        reading=reading_document(task, chain, len(rules)),
    ).model_dump_json(by_alias=True)  # fmt: skip


@pytest.fixture
def slot_document() -> Document:
    found: Document = json.loads(certificate(point_slot()))
    return found


def answer(document: Document, **changes: Any) -> Answer:
    """The answer for another slot, with all that names the task made to fit."""
    task = point_slot(**changes)
    return checked(document, task)


def refusal(found: Answer) -> str:
    assert found.verdict == "REJECTED"
    assert found.refused is not None
    return found.refused.name.key


def obligation(document: Document, move: int, id_: str) -> Document:
    """One inequality about the walls."""
    listed = document["steps"][move]["obligations"]
    found: Document = next(one for one in listed if one["id"] == id_)
    return found


def test_the_slot_tasks_certificate_is_verified(slot_document: Document) -> None:
    found = answer(slot_document)
    assert found.verdict == "VERIFIED"
    assert found.claims.endswith("neither the part nor a tip touches the slot's walls.")


@at_night
def test_round_tips_bring_the_part_into_the_shipped_slot_from_close_by() -> None:
    """It would lean in the mouth if it were straightened there: it is pushed back first."""
    task = load_task(SLOT)
    document = json.loads(certificate(task))
    assert "+x" in {rule["heading"] for rule in document["policy"]}
    found = checked(document, task)
    assert found.verdict == "VERIFIED"
    assert found.claims.endswith("neither the part nor a tip touches the slot's walls.")
    narrow = task.slot.model_copy(update={"width_um": 850.0}) if task.slot else None
    other = task.model_copy(update={"slot": narrow})
    assert refusal(checked(document, other)) == "part_clear_of_walls"


@pytest.mark.parametrize(
    "change",
    [
        {"width_um": 905.0},
        {"mouth_y_um": 40.0},
        {"depth_um": 1110.0},
    ],
)
def test_walls_in_the_way_are_rejected(slot_document: Document, change: Document) -> None:
    assert refusal(answer(slot_document, **change)) == "part_clear_of_walls"


def test_walls_in_the_way_of_a_tip_only_are_rejected(slot_document: Document) -> None:
    # above the part, where the upper tip starts its first travel
    above = {"mouth_x_um": 3750.0, "mouth_y_um": 905.0, "opens": "-y", "width_um": 1.0,
             "depth_um": 5.0, "wall_um": 5.0}  # fmt: skip
    assert refusal(answer(slot_document, **above)) == "tips_clear_of_walls"


def test_the_margin_includes_the_walls(slot_document: Document) -> None:
    slot_document["margin"] |= {"factor": 1.2, "each_alone": dict.fromkeys(ALWAYS_STATED, 1.2)}
    obligation(slot_document, 3, "part_clear_of_walls")["lower_bound"] = (1e-9).hex()
    found = answer(slot_document, width_um=913.0)
    assert found.verdict == "MARGIN UNDECIDED"
    assert "margin.factor is stated as 1.2, not shown: " in found.claims
    slot_document["margin"] |= {"factor": 1.0}
    assert answer(slot_document, width_um=913.0).verdict == "VERIFIED"


@pytest.mark.parametrize("about", ["part_clear_of_walls", "tips_clear_of_walls"])
def test_a_dropped_wall_inequality_is_rejected(slot_document: Document, about: str) -> None:
    listed = slot_document["steps"][3]["obligations"]
    listed.remove(obligation(slot_document, 3, about))
    relisted(slot_document)
    assert refusal(answer(slot_document)) == "obligations_listed"


@pytest.mark.parametrize("about", ["part_clear_of_walls", "tips_clear_of_walls"])
@pytest.mark.parametrize("move", [0, 1, 2, 3])
def test_an_exaggerated_distance_is_rejected(
    slot_document: Document, move: int, about: str
) -> None:
    one = obligation(slot_document, move, about)
    # a tenth less is stated than was proved
    one["lower_bound"] = (1.3 * float.fromhex(one["lower_bound"])).hex()
    assert refusal(answer(slot_document)) in {
        "part_clear_of_walls: lower_bound",
        "tips_clear_of_walls: lower_bound",
    }


def test_a_distance_of_a_box_elsewhere_is_rejected(slot_document: Document) -> None:
    one = obligation(slot_document, 3, "part_clear_of_walls")
    one["over"]["x"] = [(9.0).hex(), (9.0).hex()]
    one["lower_bound"] = (100e-6).hex()
    assert refusal(answer(slot_document)) in {
        "part_clear_of_walls: lower_bound",
        "tips_clear_of_walls: lower_bound",
    }


@pytest.mark.parametrize("opens", ["+x", "-x", "+y", "-y"])
def test_the_walls_are_those_of_the_task(opens: str) -> None:
    task = point_slot(opens=opens, mouth_y_um=70.0)
    assert isinstance(task.slot, Slot)
    blocks = given(task).blocks
    ends = [[float(end) * 1e6 for side in block for end in side] for block in blocks]
    rng = np.random.default_rng(0)
    points = rng.uniform(-1800, 2400, (4000, 2))

    def solid(walls: Any) -> Any:
        return np.any(
            [(w[0] < points[:, 0]) & (points[:, 0] < w[1]) & (w[2] < points[:, 1]) & (points[:, 1] < w[3])
             for w in walls], axis=0)  # fmt: skip

    assert solid(ends).any()
    np.testing.assert_array_equal(solid(ends), solid(np.array(task.slot.blocks_um, dtype=float)))


def test_what_is_apart_has_no_common_point() -> None:
    """Against points all over the part: none may lie in a wall, and few far parts stay undecided."""
    known, rng = given(point_slot()), np.random.default_rng(1)
    a, b = (float(side) for side in known.outline.hull[-1])
    own = np.array(np.meshgrid(np.linspace(-a, a, 41), np.linspace(-b, b, 41))).reshape(2, -1)
    decided = 0
    for _ in range(150):
        x, y, theta = rng.uniform([-3e-3, -2e-3, -3.2], [3e-3, 2e-3, 3.2])
        block = known.blocks[rng.integers(3)]
        box = {name: (arb(v), arb(v)) for name, v in (("x", x), ("y", y), ("theta", theta))}
        c, s = np.cos(theta), np.sin(theta)
        at = x + c * own[0] - s * own[1], y + s * own[0] + c * own[1]
        gaps = [
            np.maximum(float(low) - one, one - float(high))
            for one, (low, high) in zip(at, block, strict=True)
        ]
        nearest = np.maximum(*gaps).min()  # exact for points, a little too far for the rectangle
        is_apart = apart(box, block, known, pieces=2)
        assert not (is_apart and nearest <= 0.0)
        assert is_apart or nearest < 60e-6
        decided += is_apart
    assert 30 < decided < 140


def test_a_box_with_one_pose_in_a_wall_is_not_apart() -> None:
    known = given(point_slot())
    inside: Box = {"x": (arb(0), arb(0)), "y": (arb(-1e-5), arb(1e-5)), "theta": (arb(-0.01), arb(0.01))}  # fmt: skip
    assert all(apart(inside, block, known) for block in known.blocks)
    wider = {**inside, "y": (arb(-1e-5), arb(7e-5))}
    assert not all(apart(wider, block, known) for block in known.blocks)


def sweeps(document: Document) -> Iterator[tuple[Scene, Sweep]]:
    """All stages of all moves."""
    task = point_slot()
    certificate_ = CertificateDocument.model_validate(document)
    for rule, step in zip(certificate_.policy, certificate_.steps, strict=True):
        pre = numbers.box(step.pre_exact, place("pre"))  # type: ignore[arg-type]
        scene, passage = verify_move(rule, pre, given(task), None)  # type: ignore[arg-type]
        for sweep in passage.swept:
            yield scene, sweep


def at_random(box: Box, rng: np.random.Generator, **fixed: float) -> dict[str, Dual]:
    values = {name: float(low) + (float(high) - float(low)) * rng.random() for name, (low, high) in box.items()}  # fmt: skip
    return {name: Dual(arb(fixed.get(name, value))) for name, value in values.items()}


def test_swept_poses_keep_the_tips_on_the_edge(slot_document: Document) -> None:
    """While a tip sticks, the part's point under it moves with it: it keeps its height."""
    rng = np.random.default_rng(2)
    seen = 0
    for scene, sweep in sweeps(slot_document):
        if scene.rule.action not in {"tilt", "straighten"}:
            continue
        start = at_random(sweep.box, rng, share=1.0 if scene.rule.action == "tilt" else 0.0)
        poses = [
            [float(v.value) for v in sweep.pose({**start, "share": Dual(arb(share))})]
            for share in np.linspace(0, 1, 6)
        ]
        sides = (-scene.rule.side,) if scene.rule.side else (1, -1)
        offs = []
        for side in sides:
            height = float((start["y"] + scene.rise(start, side)).value)
            d1 = float(scene.d1)
            offs.append(np.ptp([
                (height - y + np.cos(theta) * d1) / np.sin(theta) for _, y, theta in poses
            ]))  # fmt: skip
        assert min(offs) < 1e-9
        seen += 1
    assert seen == 5


def test_the_approach_closes_the_gap_between_tip_and_far_edge(slot_document: Document) -> None:
    """Geometry of both tips on a part while the gap is open."""
    rng = np.random.default_rng(3)
    scene = next(scene for scene, _ in sweeps(slot_document) if scene.rule.action == "rotate")
    stages = approaches(Pair(scene))
    assert len(stages) > 1
    for stage in rng.choice(np.array(stages, dtype=object), 20):
        swept = stage.swept()
        at = at_random(swept.box, rng)
        x, y, theta = (float(v.value) for v in swept.pose(at))
        a, n = np.array([np.cos(theta), np.sin(theta)]), np.array([np.sin(theta), -np.cos(theta)])
        passive = np.array([
            float((at["x"] + scene.passive_ahead(at)).value),
            float((at["y"] + scene.passive_rise(at)).value),
        ])  # fmt: skip
        off = passive - (x, y)
        gap = float(at["open"].value)
        assert -off @ n == pytest.approx(gap + float(scene.d1), abs=1e-12)
        assert off @ a == pytest.approx(float(stage.state(at).b.value), abs=1e-12)
