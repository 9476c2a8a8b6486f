"""What may be given for an argument, stated once: calls check it, and options of the command line follow.

A call's signature names the type of each argument, such as :data:`Samples`; the docstring gives its
meaning. There are no slow imports here, since the command line reads all signatures before it answers
``--help``; so classes that a value may have are given by name.
"""

from __future__ import annotations

from dataclasses import dataclass
from os import PathLike
from typing import TYPE_CHECKING, Annotated, Literal, TypeAlias, Union

if TYPE_CHECKING:
    from meso_robust.task import Task


@dataclass(frozen=True, slots=True, kw_only=True)
class Option:
    """What a type does not say about an argument.

    Attributes
    ----------
    low, high
        The least and the largest number; None: any.
    flag
        Its name on the command line, if that differs from the argument's.
    words
        Its help on the command line, where the docstring also names what only a call can be given.
    """

    low: float | None = None
    high: float | None = None
    flag: str = ""
    words: str = ""


# The upper limits catch slips: anything beyond them would fill the memory, or never end.
Samples: TypeAlias = Annotated[int, Option(low=1, high=1_000_000)]
Seed: TypeAlias = Annotated[int, Option(low=0)]
SearchSeconds: TypeAlias = Annotated[float, Option(low=1, high=86_400)]
Starts: TypeAlias = Annotated[int, Option(low=1, high=10_000)]
Pushes: TypeAlias = Annotated[int, Option(low=0, high=100)]
Workers: TypeAlias = Annotated[int, Option(low=1, high=1024)]
Confidence: TypeAlias = Annotated[float, Option(low=0.5, high=0.999)]
Share: TypeAlias = Annotated[float, Option(low=0, high=1)]
Dropout: TypeAlias = Annotated[float, Option(low=0, high=0.99)]
Noise: TypeAlias = Annotated[float, Option(low=0)]
Relevant: TypeAlias = Annotated[float, Option(low=0)]
Latency: TypeAlias = Annotated[float, Option(low=0, high=1000)]
Objective: TypeAlias = Literal["likelihood", "printed"]

StrPath: TypeAlias = str | PathLike[str]
Folder: TypeAlias = Annotated[StrPath, Option(flag="out")]
TaskGiven: TypeAlias = Annotated[
    Union["Task", str, PathLike[str]], Option(words="Task file (TOML).")
]
