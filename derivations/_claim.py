"""A claim of the register: what is printed, what is derived, and the verdict that follows.

The verdict is a property: it is computed from findings, and only the deciding functions of
``_statement.py`` make findings.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

from derivations._statement import DerivationError, Finding


class Verdict(Enum):
    """What the machine makes of a printed claim."""

    CONFIRMED = "the printed statement is proved"
    CONFIRMED_WITH_ADDED_HYPOTHESIS = (
        "the printed statement fails as it stands and is proved under the added hypotheses"
    )
    EMPTY = (
        "the printed statement is proved only under added hypotheses that exclude each other for the "
        "paper's numbers: it says nothing there"
    )
    SHARPENED = "the printed statement is proved, and so is a stronger one"
    REFUTED = "the printed statement is shown to fail"
    INCONSISTENT = "the printed statements cannot all be true"
    NEW = "not in the paper: derived and proved here"

    @property
    def words(self) -> str:
        """The verdict as readers see it."""
        return self.name.replace("_", " ")


@dataclass(frozen=True, slots=True, kw_only=True)
class Claim:
    """One entry of the register.

    Texts hold LaTeX between dollar signs.
    """

    key: str
    """Short name, unique in the register, stable: programs and links use it."""
    title: str
    place: str
    """Where the paper prints it; for a new result what it is for."""
    printed: str = ""
    """The statement as printed; empty for a new result."""
    derived: str
    """The statement as derived."""
    steps: tuple[str, ...] = ()
    """How a reader gets there from the balance; each was checked where it is made."""
    hypotheses: tuple[str, ...] = ()
    """What the derived statement needs."""
    added: tuple[str, ...] = ()
    """Hypotheses that the print lacks; readers see them with the others."""
    checks: tuple[Finding, ...] = ()
    """Findings on the derived statement; all must hold."""
    of_print: tuple[Finding, ...] = ()
    """Findings on the printed statement; it stands if all hold."""
    with_added: tuple[Finding, ...] = ()
    """Findings on the printed statement under the added hypotheses."""
    compatible: tuple[Finding, ...] = ()
    """Whether the added hypotheses can hold together."""
    sharper: tuple[Finding, ...] = ()
    """Findings that show the derived statement to be stronger than the printed one."""
    consistent: tuple[Finding, ...] = ()
    """Whether what is printed can be true together."""

    def __post_init__(self) -> None:
        """Refuse an entry whose own statement is not proved.

        Raises
        ------
        DerivationError
            Names the claim and the finding.
        """
        for finding in (*self.checks, *self.sharper, *self.with_added):
            if not finding.holds:
                raise DerivationError(
                    f"{self.key}: {finding.what}: {finding.how} {dict(finding.witness)}"
                )
        if not self.findings:
            raise DerivationError(f"{self.key}: nothing was checked")
        if not self.printed and self.findings != self.checks:
            raise DerivationError(f"{self.key}: findings on a print that is not given")
        if self.compatible and not self.added:
            raise DerivationError(f"{self.key}: no added hypotheses that could exclude each other")
        if bool(self.added) != bool(self.with_added):
            raise DerivationError(f"{self.key}: added hypotheses and findings under them differ")
        _ = self.verdict

    @property
    def findings(self) -> tuple[Finding, ...]:
        """All that was found, in the order a reader wants it."""
        return (
            *self.consistent, *self.of_print, *self.with_added, *self.compatible,
            *self.sharper, *self.checks,
        )  # fmt: skip

    @property
    def verdict(self) -> Verdict:
        """Computed from the findings.

        Raises
        ------
        DerivationError
            If the findings do not add up to a verdict.
        """
        if not self.printed:
            return Verdict.NEW
        if not all(finding.holds for finding in self.consistent):
            return Verdict.INCONSISTENT
        if self.of_print and all(finding.holds for finding in self.of_print):
            if self.added:
                raise DerivationError(f"{self.key}: hypotheses added to a print that stands")
            return Verdict.SHARPENED if self.sharper else Verdict.CONFIRMED
        if not self.of_print:
            raise DerivationError(f"{self.key}: nothing was found of the printed statement")
        if not self.with_added:
            return Verdict.REFUTED
        if not all(finding.holds for finding in self.compatible):
            return Verdict.EMPTY
        return Verdict.CONFIRMED_WITH_ADDED_HYPOTHESIS
