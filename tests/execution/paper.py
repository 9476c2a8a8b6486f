"""The paper's plan and what is claimed of it, for tests."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import numpy.typing as npt

from meso_robust.certificates.chain import certify
from meso_robust.execution.claims import Claims, claims_of
from meso_robust.execution.replay import Feedback
from meso_robust.primitives.setup import setup_of
from tests.conftest import paper_task
from tests.execution.test_replay import paper_player

Floats = npt.NDArray[np.float64]


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
