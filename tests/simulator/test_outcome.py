"""Outcomes."""

from meso_robust.simulator import Outcome


def test_values_and_messages() -> None:
    assert [int(outcome) for outcome in Outcome] == [0, 1, 2, 3, 4]
    messages = [outcome.message for outcome in Outcome]
    assert len(set(messages)) == 5
    assert "jammed" in Outcome.JAM.message
    assert "solver failed" in Outcome.SOLVER_FAILURE.message
    assert "more than one motion" in Outcome.NON_UNIQUE.message
    assert "too many contacts" in Outcome.OUT_OF_RANGE.message
