"""``reproduce``: the paper's tables and figures, side by side with the printed values."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from meso_robust.api.call import call
from meso_robust.api.inputs import StrPath, at_least
from meso_robust.api.progress import SILENT, Progress
from meso_robust.files import write_all
from meso_robust.reproduction.document import Made, document, text
from meso_robust.reproduction.item import Setting
from meso_robust.reproduction.items import asked, reproduced


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Reproduced:
    """Tables and figures of the paper, made again.

    Attributes
    ----------
    items
        What was found, by the name of the item.
    setting
        How it was asked for.
    """

    items: Mapping[str, Made]
    setting: Setting

    @property
    def document(self) -> dict[str, object]:
        """The content of ``reproduction.json``."""
        return document(self.items, self.setting)

    def __str__(self) -> str:
        """The answer in a few lines, as the command line prints it."""
        return "\n".join(f"{one.name}: {one.found.answer}" for one in self.items.values())

    def __repr__(self) -> str:
        return f"<Reproduced {', '.join(self.items)}>"

    def _repr_html_(self) -> str:
        from meso_robust.reporting.cards import reproduced_card

        rows = sum(len(one.found.rows) for one in self.items.values())
        return reproduced_card(tuple(self.items), rows, str(self))

    def text(self) -> str:
        """The text of ``reproduction.json``."""
        return text(self.document)

    def files(self) -> dict[str, str]:
        """The texts of all result files by name."""
        from meso_robust.reproduction.page import reproduction_report

        return {
            "reproduction.json": self.text(),
            "index.html": reproduction_report(dict(self.items), self.setting),
        }

    @call
    def save(self, folder: StrPath) -> None:
        """Write the result files into a folder, which is made if needed; all of them or none.

        Raises
        ------
        InputError
            They cannot be written.
        """
        write_all(Path(folder), self.files())


@call
def reproduce(
    item: str | None = None,
    *,
    quick: bool = False,
    seed: int = 0,
    progress: Progress = SILENT,
) -> Reproduced:
    """Make the paper's tables and figures again.

    Parameters
    ----------
    item
        One of them, such as ``table-1`` or ``rrt``; all if left out (minutes).
    quick
        Fewer runs: a first look.
    seed
        Of the random runs.
    progress
        Shows what is being done.

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
    at_least(0, seed=seed)
    names = asked(item)
    with progress.following() as told:
        setting = Setting(quick=quick, seed=seed, told=told)
        return Reproduced(items=reproduced(names, setting), setting=setting)
