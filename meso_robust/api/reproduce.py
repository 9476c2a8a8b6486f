"""``reproduce``: the paper's tables and figures, side by side with the printed values."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

from meso_robust.api.call import call
from meso_robust.api.options import Seed
from meso_robust.api.progress import SILENT, Progress
from meso_robust.api.result import Result

if TYPE_CHECKING:
    from meso_robust.reproduction.document import Made
    from meso_robust.reproduction.item import Setting


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Reproduced(Result):
    """Tables and figures of the paper, reproduced.

    Attributes
    ----------
    items
        What was found, by the name of the item.
    setting
        The options it was made with.
    """

    items: Mapping[str, Made]
    setting: Setting

    @property
    def positive(self) -> bool:
        """Always: the values are shown next to the printed ones, without a verdict."""
        return True

    @property
    def shown(self) -> dict[str, str]:
        """The page of all items."""
        return {"report": "index.html"}

    @property
    def document(self) -> dict[str, object]:
        """The content of ``reproduction.json``."""
        from meso_robust.reproduction.document import document

        return document(self.items, self.setting)

    def __str__(self) -> str:
        return "\n".join(f"{one.name}: {one.found.answer}" for one in self.items.values())

    def __repr__(self) -> str:
        return f"<Reproduced {', '.join(self.items)}>"

    def _repr_html_(self) -> str:
        from meso_robust.reporting.cards import reproduced_card

        rows = sum(len(one.found.rows) for one in self.items.values())
        return reproduced_card(tuple(self.items), rows, str(self))

    def text(self) -> str:
        """The text of ``reproduction.json``."""
        from meso_robust.reproduction.document import text

        return text(self.document)

    def files(self) -> dict[str, str]:
        """The texts of all result files by name."""
        from meso_robust.reproduction.page import reproduction_report

        return {
            "reproduction.json": self.text(),
            "index.html": reproduction_report(dict(self.items), self.setting),
        }


@call
def reproduce(
    item: str | None = None,
    *,
    quick: bool = False,
    seed: Seed = 0,
    progress: Progress = SILENT,
) -> Reproduced:
    """Reproduce the paper's tables and figures.

    Parameters
    ----------
    item
        One of them, such as ``table-1`` or ``rrt``; all by default (minutes).
    quick
        Fewer runs, for a first look.
    seed
        Seed of the random runs.
    progress
        Shows what is being done.

    Returns
    -------
    Reproduced
        The values that were found, next to the printed ones.

    Raises
    ------
    InputError
        There is no such item.

    Examples
    --------
    >>> import meso_robust as mr
    >>> mr.reproduce("table-9")
    Traceback (most recent call last):
    meso_robust.errors.InputError: ITEM: 'table-9'; must be one of tests, ..., or none for all
    """
    from meso_robust.reproduction.item import Setting
    from meso_robust.reproduction.items import asked, reproduced

    names = asked(item)
    with progress.following() as told:
        setting = Setting(quick=quick, seed=seed, told=told)
        return Reproduced(items=reproduced(names, setting), setting=setting)
