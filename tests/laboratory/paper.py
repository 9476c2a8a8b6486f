"""The paper's plan and what is claimed of it, for tests."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import numpy.typing as npt

from meso_robust.certificates.chain import certify
from meso_robust.laboratory.claims import Claims, claims_of
from meso_robust.laboratory.replay import Feedback
from meso_robust.laboratory.simulation import player_of
from meso_robust.planning.document import PlanDocument
from meso_robust.primitives.setup import setup_of
from tests.paper import paper_task

Floats = npt.NDArray[np.float64]

REPORT = Path(__file__).parents[2] / "reports" / "paper_task"


def paper_plan_document() -> PlanDocument:
    return PlanDocument.model_validate_json((REPORT / "plan.json").read_text(encoding="utf-8"))


def paper_player() -> Feedback:
    player = player_of(paper_plan_document(), setup_of(paper_task()))
    assert isinstance(player, Feedback)
    return player


@cache
def paper_claims() -> Claims:
    """All that is proved of the paper's plan."""
    player = paper_player()
    return claims_of(certify(player.rules, player.setup), player.rules)


def exactly(factor: float = 1.0) -> Feedback:
    """The paper's plan by the event-driven engine, all uncertainties scaled."""
    setup = setup_of(paper_task(), factor)
    return replace(paper_player(), engine="events", setup=setup)


def shrunk(boxes: Floats, share: float) -> Floats:
    """(..., 2, 3) boxes about their middles."""
    middle = boxes.mean(axis=-2, keepdims=True)
    return np.asarray(middle + share * (boxes - middle))
