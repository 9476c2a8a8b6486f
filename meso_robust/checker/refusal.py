"""How the checker says no."""

from __future__ import annotations


class Refused(Exception):  # noqa: N818  # not an error: the answer to the question
    """A claim that could not be verified.

    Attributes
    ----------
    claim
        What was claimed.
    stated
        What the certificate states.
    found
        What the checker found instead.
    """

    def __init__(self, claim: str, stated: object, found: object) -> None:
        super().__init__(f"{claim}: stated {stated}, found {found}")
        self.claim, self.stated, self.found = claim, str(stated), str(found)
