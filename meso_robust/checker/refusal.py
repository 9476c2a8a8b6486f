"""How the checker says no."""

from __future__ import annotations

from meso_robust.checker.ids import Named
from meso_robust.checker.words import sentence


class Refused(Exception):  # noqa: N818  # not an error: the answer to the question
    """A claim that could not be verified.

    Attributes
    ----------
    name
        What was claimed.
    stated
        What the certificate states.
    found
        What the checker found instead.
    """

    def __init__(self, name: Named, stated: object, found: object) -> None:
        self.name, self.stated, self.found = name, str(stated), str(found)
        super().__init__(f"{self.claim}: stated {stated}, found {found}")

    @property
    def claim(self) -> str:
        """What was claimed, in words."""
        return sentence(self.name)
