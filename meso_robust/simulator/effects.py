"""The physics that a simulated run has beyond the plain model: values for named effects."""

from __future__ import annotations

from dataclasses import InitVar, dataclass, field

import numpy as np

from meso_robust.simulator.catalogue import Values, table_of, values_in_si
from meso_robust.types import Floats


@dataclass(frozen=True, slots=True, eq=False)
class Effects:
    """Values of the effects of N runs; without arguments, the plain model.

    Parameters
    ----------
    stated
        ``{effect: {parameter: value}}``, each value in the unit that its parameter's name ends in; a
        number for all runs or an array (N,). What is not named is off.

    Attributes
    ----------
    values
        The same in SI.
    table
        (1, SLOTS) or (N, SLOTS) in SI, made from the values.

    Raises
    ------
    ValueError
        If an effect or parameter is unknown, or a value is not finite or out of its range.
    """

    stated: InitVar[Values | None] = None
    values: Values = field(init=False)
    table: Floats = field(init=False)

    def __post_init__(self, stated: Values | None) -> None:
        """Check the values and write the table."""
        self._hold(values_in_si(stated or {}))

    @classmethod
    def in_si(cls, values: Values) -> Effects:
        """Effects of values in SI: what a fit or another run has; a user states units.

        Raises
        ------
        ValueError
            As the class.
        """
        made = object.__new__(cls)
        made._hold(values)
        return made

    def without(self, effect: str) -> Effects:
        """All of them but one."""
        return Effects.in_si({name: of for name, of in self.values.items() if name != effect})

    def _hold(self, values: Values) -> None:
        table = table_of(values)
        table.flags.writeable = False
        object.__setattr__(self, "values", values)
        object.__setattr__(self, "table", table)

    def is_on(self, *slots: int) -> bool:
        """Whether any of the columns differs from zero in any run."""
        return bool(self.values) and bool(np.any(self.table[:, list(slots)] != 0.0))
