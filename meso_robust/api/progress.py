"""How a call reports what it is doing: silently, unless something that shows it is given."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import AbstractContextManager, nullcontext
from typing import Protocol, TypeAlias

Step: TypeAlias = tuple[int, int, str]
"""Runs and failures of a step of a campaign, and what a run is called."""
Rated: TypeAlias = Callable[[str, tuple[int, int], Step | None], None]
"""Called with a part, its chunks done and planned, and a step of it; None as the part begins."""
Told: TypeAlias = Callable[[str, int, int], None]
"""Called with a stage of the work, how much of it is done, and how much there is."""


class Progress(Protocol):
    """What shows progress; ``meso_robust.Reporter`` does so on stderr."""

    def doing(self, what: str, /) -> AbstractContextManager[None]:
        """Show ``what`` while a block runs."""

    def counting(
        self, what: str, total: int | None, /
    ) -> AbstractContextManager[Callable[[], object]]:
        """Show ``what`` while a block runs that calls what it is given after each step."""

    def following(self) -> AbstractContextManager[Told]:
        """Show the stages that a block tells of."""

    def rating(self) -> AbstractContextManager[Rated]:
        """Show how fast the parts of a campaign go."""


class _Silent:
    """Shows nothing."""

    def doing(self, _: str, /) -> AbstractContextManager[None]:
        """Show nothing."""
        return nullcontext()

    def counting(self, _: str, __: int | None, /) -> AbstractContextManager[Callable[[], object]]:
        """Show nothing."""
        return nullcontext(lambda: None)

    def following(self) -> AbstractContextManager[Told]:
        """Show nothing."""
        return nullcontext(lambda *_: None)

    def rating(self) -> AbstractContextManager[Rated]:
        """Show nothing."""
        return nullcontext(lambda *_: None)


SILENT: Progress = _Silent()
"""What a call is given if it is given nothing."""
