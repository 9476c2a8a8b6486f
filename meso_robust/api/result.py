"""What every verb gives: a value that prints, shows and saves itself.

The command line's ending follows from it: what is printed, noted and pointed to, and the exit status.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from meso_robust.api.call import call
from meso_robust.api.inputs import keep_apart
from meso_robust.api.options import Folder
from meso_robust.api.progress import SILENT, Progress
from meso_robust.files import write_all

if TYPE_CHECKING:
    from pydantic import BaseModel


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Result(ABC):
    """The answer of a verb; ``print`` it, show it in a notebook, or ``save`` it.

    Attributes
    ----------
    inputs
        Files that it was made from, which ``save`` never replaces.
    source
        Folder of the recordings that it was made from, which ``save`` never writes into.
    """

    inputs: tuple[Path, ...] = ()
    source: Path | None = None

    if TYPE_CHECKING:  # a field of some results, which must not find a default here

        @property
        def document(self) -> Any:
            """What was found out, as plain values."""

    @property
    @abstractmethod
    def positive(self) -> bool:
        """Whether the answer is yes: exit status 0, otherwise 1."""

    @abstractmethod
    def __str__(self) -> str:
        """The answer in a few lines, as the command line prints it."""

    def text(self) -> str:
        """The text of the result document, as its file has it and ``--json`` prints it."""
        return text_of(self.document)

    @abstractmethod
    def files(self) -> dict[str, str]:
        """The texts of all result files by name."""

    @property
    def notes(self) -> tuple[str, ...]:
        """What is not part of the answer but should be known; the command line writes it to stderr."""
        return ()

    @property
    def brief(self) -> str:
        """The answer as ``--quiet`` prints it: by default its first line."""
        return str(self).partition("\n")[0]

    @property
    def why_not(self) -> str:
        """Why the answer is no, if the answer itself does not say."""
        return ""

    @property
    def shown(self) -> dict[str, str]:
        """What the command line points to after the answer: words and the file's name."""
        return {"report": "report.html"}

    def _repr_html_(self) -> str | None:
        """The card that a notebook shows; None shows the answer in words."""
        return None

    def check_folder(self, folder: Path) -> None:
        """Refuse a folder in which results could go over what they come from.

        Raises
        ------
        InputError
            They could.
        """
        keep_apart(folder, self.source)

    @call
    def save(self, folder: Folder, *, progress: Progress = SILENT) -> None:
        """Write the result files into a folder, which is made if needed; all of them or none.

        Raises
        ------
        InputError
            They cannot be written, or would go over what the result was made from.
        """
        self.check_folder(Path(folder))
        with progress.doing("writing the results"):
            files = self.files()
        write_all(Path(folder), files, self.inputs)


def text_of(document: BaseModel) -> str:
    """A document as its file has it."""
    return document.model_dump_json(by_alias=True, indent=2) + "\n"
