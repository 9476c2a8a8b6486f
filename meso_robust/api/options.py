"""What may be given for an argument, stated once: calls check it, and options of the command line follow.

A signature of a call names its argument's type, such as :data:`Samples`; the argument's meaning stands
in the docstring. Nothing here imports what takes long, since the command line reads all signatures
before it answers ``--help``. So a class that a value may be of is known by its name.
"""

from __future__ import annotations

from dataclasses import dataclass
from os import PathLike
from typing import TYPE_CHECKING, Annotated, Literal, TypeAlias, Union

if TYPE_CHECKING:
    from meso_robust.task import Task


@dataclass(frozen=True, slots=True, kw_only=True)
class Option:
    """What a type does not say of an argument.

    Attributes
    ----------
    low, high
        The least and the largest number; None: any.
    flag
        Its name on the command line, where that is another than the argument's.
    words
        What the command line tells of it, where the docstring tells what only a call can be given.
    """

    low: float | None = None
    high: float | None = None
    flag: str = ""
    words: str = ""


# The largest numbers are there against slips: what is beyond them would fill the memory, or never end.
Samples: TypeAlias = Annotated[int, Option(low=1, high=1_000_000)]
Seed: TypeAlias = Annotated[int, Option(low=0)]
Starts: TypeAlias = Annotated[int, Option(low=1, high=10_000)]
Pushes: TypeAlias = Annotated[int, Option(low=0, high=100)]
Workers: TypeAlias = Annotated[int, Option(low=1, high=1024)]
Confidence: TypeAlias = Annotated[float, Option(low=0.5, high=0.999)]
Share: TypeAlias = Annotated[float, Option(low=0, high=1)]
Dropout: TypeAlias = Annotated[float, Option(low=0, high=0.99)]
Noise: TypeAlias = Annotated[float, Option(low=0)]
Latency: TypeAlias = Annotated[float, Option(low=0, high=1000)]
Objective: TypeAlias = Literal["likelihood", "printed"]

StrPath: TypeAlias = str | PathLike[str]
Folder: TypeAlias = Annotated[StrPath, Option(flag="out")]
TaskGiven: TypeAlias = Annotated[
    Union["Task", str, PathLike[str]], Option(words="Task file (TOML).")
]
