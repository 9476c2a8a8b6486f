"""Outcomes."""

from meso_robust.simulator import Outcome


def test_values_and_messages() -> None:
    assert [int(outcome) for outcome in Outcome] == [0, 1, 2, 3]
    messages = [outcome.message for outcome in Outcome]
    assert len(set(messages)) == 4
    assert "jammed" in Outcome.JAM.message
    assert "solver failed" in Outcome.SOLVER_FAILURE.message
