"""Tasks whose part is a polygon, and their certificates without margin and simulation."""

from __future__ import annotations

import json
import tomllib
from collections.abc import Sequence
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from meso_robust.certificates.chain import Chain, certify
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
from meso_robust.laboratory.geometry import gaps_to
from meso_robust.planning.compose import robust_at
from meso_robust.planning.document import goal_document, plan_document
from meso_robust.primitives.move import MoveRule
from meso_robust.primitives.setup import setup_of
from meso_robust.task import Task, parse_task
from meso_robust.tasks import HEXAGON, L_SHAPE

SHIPPED = {"hexagon": HEXAGON, "L-shape": L_SHAPE}
UNCERTAINTIES = (
    "sensed_position", "sensed_orientation", "probe_position", "friction", "film_ratio",
    "misalignment",
)  # fmt: skip


def inside(
    points: npt.NDArray[np.float64], corners: npt.NDArray[np.float64]
) -> npt.NDArray[np.bool_]:
    """(N,) whether points (N, 2) lie in a polygon (V, 2) or on its outline."""
    at_rest, none = np.zeros((1, 3)), np.zeros((1, len(points)))
    return np.asarray(gaps_to(points[None], at_rest, corners[None], none)[0] <= 0.0)


def values_of(path: Path) -> dict[str, Any]:
    """The values of a task file, to be changed."""
    return tomllib.loads(path.read_text(encoding="utf-8"))


@cache
def planned(name: str) -> tuple[Task, tuple[MoveRule, ...], Chain]:
    """A shipped task of a polygon, a plan with something in hand, and its certified chain."""
    task = parse_task(values_of(SHIPPED[name]), name)
    rules = robust_at(task, 1.1)
    assert rules is not None
    return task, rules, certify(rules, setup_of(task))


def certificate(task: Task, rules: Sequence[MoveRule], chain: Chain) -> dict[str, Any]:
    """What a certificate would say, with a margin of 1 and no simulated runs."""
    stated = list(chain.setup.uncertainty.stated)
    margin = Margin(
        factor=1.0,
        refused=None,
        binding=stated[0],
        each=dict.fromkeys(stated, 1.0),
        limit=None,
    )
    made = CertificateDocument(
        verdict=chain.verdict.word,
        task=task.name,
        task_hash=task.hash,
        claim=claim_document(task, chain, len(rules)),
        goal=goal_document(chain.setup.goal),
        goal_exact=exact_box(chain.setup.goal),
        policy=plan_document(task, rules, [np.zeros(3)] * len(rules), [None] * len(rules)).policy,
        steps=tuple(map(step_document, chain.steps)),
        undecided=None,
        witness=None,
        margin=margin_document(margin),
        simulation=SimulationDocument(
            samples=0,
            seed=0,
            step_um=1.0,
            completed=0,
            in_goal=0,
            in_certified_box=0,
            largest_excess_um_um_deg=(),
            simulator_error_um_um_deg=(0.0, 0.0, 0.0),
        ),
        made_with={},
        reading=reading_document(task, chain, len(rules)),
    )
    found: dict[str, Any] = json.loads(made.model_dump_json(by_alias=True))
    return found
