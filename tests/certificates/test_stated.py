"""How much of a proved bound a certificate states."""

from __future__ import annotations

import pytest

from meso_robust.certificates.document import step_document
from meso_robust.primitives.names import ObligationId, Which
from tests.strategies import paper_chain


def test_of_what_a_turn_leaves_less_is_stated() -> None:
    """The poses after a turn are enclosed otherwise by a checker, and more widely."""
    shares: dict[tuple[str, ...], float] = {}
    for step in paper_chain().steps:
        stated = step_document(step).obligations
        for proved, told in zip(step.obligations, stated, strict=True):
            if told.lower_bound is not None:
                name = (str(proved.name.id), *proved.name.about.values())
                shares[name] = float.fromhex(told.lower_bound) / proved.proof.lower
    withdraws = str(ObligationId.WITHDRAWS_FREE)
    assert shares[withdraws, Which.BOTH] == pytest.approx(0.5)
    assert shares[withdraws, Which.PAIR] == pytest.approx(0.9)
