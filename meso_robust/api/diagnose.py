"""``diagnose``: what physics the plain model leaves out of recordings."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

from meso_robust import __version__
from meso_robust.api.call import call
from meso_robust.api.inputs import path_of
from meso_robust.api.options import Relevant, Seed, StrPath
from meso_robust.api.progress import SILENT, Progress
from meso_robust.api.recordings import RecordingsGiven, given_of, name_of
from meso_robust.api.result import Result

if TYPE_CHECKING:
    from meso_robust.diagnosis.diagnose import Diagnosis
    from meso_robust.diagnosis.document import DiagnosisDocument
    from meso_robust.recordings.direct.run import DirectTests

Verdict = Literal["consistent", "named", "partial", "ambiguous", "unknown"]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Diagnosed(Result):
    """What the plain model leaves out of recordings.

    Attributes
    ----------
    diagnosis
        Everything that was found out.
    document
        The content of ``diagnosis.json``.
    warnings
        What to keep in mind about the recordings, a line each.
    direct
        What the tests say that need no simulation.
    """

    diagnosis: Diagnosis
    document: DiagnosisDocument
    warnings: tuple[str, ...]
    direct: DirectTests | None = None

    @property
    def verdict(self) -> Verdict:
        """Consistent, named, partial, ambiguous or unknown."""
        return self.document.verdict

    @property
    def positive(self) -> bool:
        """Whether nothing is left out, or what is left out has one name."""
        return self.verdict in ("consistent", "named")

    explained = positive

    @property
    def effects(self) -> tuple[str, ...]:
        """Names of the effects of the extended model."""
        return tuple(effect.name for effect in self.document.effects)

    def __str__(self) -> str:
        from meso_robust.reporting.diagnosis_words import summary

        return "\n".join([summary(self.document), *(f"  {line}" for line in self.warnings)])

    def __repr__(self) -> str:
        return f"<Diagnosed {self.verdict}: {', '.join(self.effects) or 'no effects'}>"

    def _repr_html_(self) -> str:
        from meso_robust.diagnosis import evidence
        from meso_robust.reporting.cards import diagnosed_card

        return diagnosed_card(self.document, evidence.evidence(self.diagnosis), str(self))

    @property
    def model_toml(self) -> str:
        """The extended model, for ``plan(..., model=...)``."""
        from meso_robust.diagnosis import answer

        return answer.model_toml(self.diagnosis, __version__)

    def files(self) -> dict[str, str]:
        """The texts of all result files by name."""
        from meso_robust.diagnosis import evidence
        from meso_robust.diagnosis.document import FILE
        from meso_robust.reporting import diagnosis as page

        drawn = evidence.evidence(self.diagnosis)
        return {
            FILE: self.text(),
            "model.toml": self.model_toml,
            "report.html": page.diagnosis_report(
                self.document, drawn, name_of(self.source), self.direct
            ),
        }


@call
def diagnose(
    recordings: RecordingsGiven,
    *,
    model: str = "viscous",
    quick: bool = False,
    relevant_um: Relevant | None = None,
    seed: Seed = 0,
    store: StrPath | None = None,
    progress: Progress = SILENT,
) -> Diagnosed:
    """Say what physics a plain model leaves out of recordings: where, what, how much it helps.

    Parameters
    ----------
    recordings
        A recording set, or the name of its folder.
    model
        The plain model: viscous, for a film; three_point, uniform_pressure or limit_surface for a dry part.
    quick
        Fewer simulated sets and candidates; a coarser answer.
    relevant_um
        Error of prediction in µm below which a mismatch does not matter; by default a fifth of the
        noise, or 0.1 where that is not known; of a tracker that states more noise than frames at
        rest scatter, what that rest of it makes of a prediction.
    seed
        Seed of all random numbers.
    store
        Folder for intermediate results, from which an interrupted diagnosis resumes.
    progress
        Shows what is being done.

    Returns
    -------
    Diagnosed
        Whatever the verdict.

    Raises
    ------
    InputError
        A file or a value breaks a rule, or the recordings have bad poses.

    Examples
    --------
    Even the quick form takes longer than a doctest should; ``tests/api`` runs it.

    >>> import meso_robust as mr
    >>> diagnosed = mr.diagnose("set", quick=True)  # doctest: +SKIP
    >>> diagnosed.verdict, diagnosed.effects  # doctest: +SKIP
    ('named', ('dry_friction',))
    >>> diagnosed.save("diagnosis")  # doctest: +SKIP
    >>> mr.plan("task.toml", model="diagnosis/model.toml")  # doctest: +SKIP
    """
    given = given_of(recordings)

    from meso_robust.diagnosis import answer, diagnose as diagnosing
    from meso_robust.identification.identify import check_model
    from meso_robust.recordings.direct.document import words
    from meso_robust.recordings.direct.run import direct_tests

    check_model(model)
    with progress.doing("checking the recordings"):
        usable = given.usable()
        direct = direct_tests(usable.recordings)
    with progress.following() as told:
        diagnosis = diagnosing.diagnose(
            usable.recordings,
            model=model,
            quick=quick,
            seed=seed,
            relevant=None if relevant_um is None else 1e-6 * relevant_um,
            store=path_of(store),
            told=told,
            findings=direct.findings,
        )
    made = answer.document(diagnosis, __version__, ())
    chosen = {one.name for one in made.effects} if made.verdict == "named" else None
    seen = tuple(
        f"direct test: {line}{_beside(one.effect, chosen)}"
        for line, one in zip(words(direct), direct.findings, strict=True)
    )
    warnings = (*usable.warnings, *seen, *diagnosis.doubts)
    return Diagnosed(
        diagnosis=diagnosis,
        document=answer.document(diagnosis, __version__, warnings),
        warnings=warnings,
        direct=direct,
        source=given.source,
    )


def _beside(effect: str, named: set[str] | None) -> str:
    """What is said of a finding that is not what was named by all frames of all recordings."""
    return "" if named is None or effect in named else "; the answer above is another one"
