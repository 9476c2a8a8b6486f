"""How a run ended: the outcomes of the simulator, each with a message.

A run never hides a step it could not take: a linear complementarity problem without a solution is
a jam of its own, told apart from a solver that failed on a problem that has one.
"""

from enum import IntEnum


class Outcome(IntEnum):
    """End of one run; the values are what the kernels write into ``PushResult.outcomes``."""

    COMPLETED = 0
    JAM = 1
    SOLVER_FAILURE = 2
    OUT_OF_RANGE = 3
    NON_UNIQUE = 4

    @property
    def word(self) -> str:
        """Its name as documents have it, such as ``solver failure``."""
        return self.name.lower().replace("_", " ")

    @property
    def message(self) -> str:
        """One sentence saying what the outcome means for the pose that is returned with it."""
        return _MESSAGES[self]


_MESSAGES = {
    Outcome.COMPLETED: "the move was completed",
    Outcome.JAM: (
        "the part jammed: no contact mode balances the support while the tips keep moving; "
        "the pose is that of the last step taken"
    ),
    Outcome.SOLVER_FAILURE: (
        "the solver failed on a step that has, or may have, a solution; "
        "the pose is that of the last step taken, try a smaller step"
    ),
    Outcome.OUT_OF_RANGE: (
        "a step was not finite, turned the part or let it in too far for contact taken as linear, or "
        "met too many contacts; the pose is that of the last step taken, try a smaller step"
    ),
    Outcome.NON_UNIQUE: (
        "the model allows more than one motion of the next step; "
        "the pose is that of the last step with one motion only"
    ),
}
