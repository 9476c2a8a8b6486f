"""How an effect is declared: its name, its law, its parameters, and the stage that it belongs to.

The simulator is a chain of stages, as the experiment is: command, actuation, contact, support and
environment, pose, observation. Every effect belongs to the stage that it changes and is declared in
the file of that stage. Its parameters are numbers of a flat table, one row a run, which the
kernels read; a table of zeros is the plain model, exactly.

Forces are divided by the translational drag e_x of the film, and so are speeds: the speed at which
the force would drag the part along. Nothing else can be seen in motion alone.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

SLOTS = 168
"""Columns of the table of effects."""
FORM = "form"
"""Name of the parameter that says which form of its law an effect has."""
REFERENCE_SPEED = 75e-6
"""m/s, the middle one of the three speeds of the paper's Section V; drag ratios refer to it."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Parameter:
    """One number of a model or of an effect. All values are in SI; the unit is for people and files.

    Searches run in coordinates of about unit size: ``value / scale``, or ``log(value / scale)``.
    """

    key: str
    """Name with the unit of documents, such as ``rho_um2``; of an effect in a model,
    ``effect.width_um``."""
    unit: str
    """Unit for display, such as ``µm``; empty for a plain number."""
    to_si: float
    """Factor from the unit to SI."""
    meaning: str
    low: float = -np.inf
    """Least admissible value; write it as a product with `to_si`, so that whoever states the end of
    the range in its unit states the very same double."""
    high: float = np.inf
    """Largest admissible value, likewise."""
    default: float = 0.0
    """Of an effect: value where none is given."""
    size: bool = True
    """Of an effect: whether it is off where this parameter (and every other size) is zero."""
    scale: float = 1.0
    """A typical change; of a logarithmic parameter, a typical value. A search needs it."""
    log: bool = False
    """Whether the parameter is positive and counts by ratio."""
    farthest: float = 1.0
    """Largest step of a search, in coordinates."""
    likely: tuple[float, float] | None = None
    """Least and largest value that a part can have; None where every admissible one may be."""
    why_likely: str = ""
    """Why it has no other."""
    unseen: str = ""
    """Why no motion can show the parameter; empty for one that is fitted."""

    def shown(self, value: float) -> float:
        """A value in the unit of the name, to twelve digits.

        The last digits are what the conversion made of them: 1616.0000000000002 µm. Without them an
        end of the range is its decimal again, and is read back as the same double.
        """
        return float(f"{value / self.to_si:.12g}")


def waves() -> tuple[Parameter, ...]:
    """Sine and cosine of a wave on each axis."""
    return tuple(
        Parameter(
            key=f"{axis}_{wave}_um",
            unit="µm",
            to_si=1e-6,
            meaning=f"{wave[0]} of the {axis} axis",
        )
        for axis in "xy"
        for wave in ("sine", "cosine")
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class Effect:
    """A piece of physics that the plain model leaves out."""

    name: str
    """Name in `diagnosis.json`."""
    equation: str
    """The law, in plain text."""
    source: str
    """Where the law is from."""
    parameters: tuple[Parameter, ...]
    forms: tuple[str, ...] = ()
    """Forms of the law in words, where the family has several: nobody knows the decay of a real force. The
    first is that of the equation; a parameter ``form``, added here, is the number of the form."""

    def __post_init__(self) -> None:
        """Add the number of the form to the parameters."""
        if not self.forms:
            return
        words = ", ".join(f"{k}: {form}" for k, form in enumerate(self.forms))
        number = Parameter(
            key=FORM,
            unit="",
            to_si=1.0,
            high=len(self.forms) - 1.0,
            low=0.0,
            size=False,
            meaning=words,
        )
        object.__setattr__(self, "parameters", (*self.parameters, number))


@dataclass(frozen=True, slots=True, kw_only=True)
class Stage:
    """A stage of the chain, with its effects and its block of columns in the table."""

    name: str
    base: int
    """First column of the block."""
    effects: tuple[Effect, ...]
    slots: int = 16
    """Columns of the block."""

    def slot(self, effect: str, key: str) -> int:
        """Column of a parameter; the numbers are compiled into the kernels.

        Raises
        ------
        KeyError
            If the stage has no such parameter.
        """
        pairs = [(one.name, parameter.key) for one in self.effects for parameter in one.parameters]
        if len(pairs) > self.slots:
            raise KeyError(f"stage {self.name}: {len(pairs)} parameters exceed {self.slots} slots")
        if (effect, key) not in pairs:
            raise KeyError(f"stage {self.name} has no parameter {key} of {effect}")
        return self.base + pairs.index((effect, key))
