"""The physics that a simulated run has beyond the plain model: values for named effects."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from meso_robust.simulator.catalogue import table_of
from meso_robust.types import Floats


@dataclass(frozen=True, slots=True, eq=False)
class Effects:
    """Values of the effects of N runs; without arguments, the plain model.

    Attributes
    ----------
    values
        ``{effect: {parameter: value}}`` in the units of the catalogue; a value is a number for all
        runs or an array (N,). What is not named is off.
    table
        (1, SLOTS) or (N, SLOTS) in SI, made from the values.

    Raises
    ------
    ValueError
        If an effect or parameter is unknown, or a value is not finite or out of its range.
    """

    values: Mapping[str, Mapping[str, float | Floats]] = field(default_factory=dict)
    table: Floats = field(init=False)

    def __post_init__(self) -> None:
        """Check the values and write the table."""
        table = table_of(self.values)
        table.flags.writeable = False
        object.__setattr__(self, "table", table)

    def is_on(self, *slots: int) -> bool:
        """Whether any of the columns differs from zero in any run."""
        return bool(np.any(self.table[:, list(slots)] != 0.0))
