"""``identify``: a model fitted to recordings, and the pushes for it planned and designed."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING

from meso_robust import __version__
from meso_robust.api.call import call
from meso_robust.api.inputs import task_of
from meso_robust.api.options import Confidence, Objective, Pushes, Seed, Starts, TaskGiven
from meso_robust.api.progress import SILENT, Progress
from meso_robust.api.recordings import RecordingsGiven, given_of, name_of, set_of
from meso_robust.api.result import Result
from meso_robust.errors import InputError

if TYPE_CHECKING:
    from meso_robust.identification.document import FitWord, ModelDocument
    from meso_robust.identification.experiment import Bench, Experiment
    from meso_robust.identification.identify import Identification
    from meso_robust.recordings import RecordingSet


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Identified(Result):
    """A fitted model.

    Attributes
    ----------
    fit
        Everything that was found out.
    document
        The content of ``model.toml``: values, intervals, minima, what cannot be identified.
    remarks
        What to keep in mind about the recordings, a line each.
    more
        Texts of the files of the pushes that were designed, by name.
    """

    fit: Identification
    document: ModelDocument
    remarks: tuple[str, ...]
    more: Mapping[str, str] = field(default_factory=dict)

    @property
    def verdict(self) -> FitWord:
        """IDENTIFIED, PARTLY IDENTIFIED, NOT IDENTIFIED, FITTED (untested) or FIT REJECTED (by χ²)."""
        from meso_robust.identification.verdict import verdict

        return verdict(self.document)

    @property
    def positive(self) -> bool:
        """Whether something is identified, and the recordings do not reject the model."""
        from meso_robust.identification.verdict import NEGATIVE_WORDS

        return self.verdict not in NEGATIVE_WORDS

    @property
    def determined(self) -> tuple[str, ...]:
        """Parameters that the recordings determine."""
        return self.fit.determined

    def __str__(self) -> str:
        from meso_robust.identification.answer import summary

        return "\n".join([summary(self.document), *(f"  {line}" for line in self.remarks)])

    def __repr__(self) -> str:
        known = ", ".join(
            f"{key} = {one.value:.4g}" for key, one in self.document.parameters.items()
        )
        return f"<Identified {self.document.model}: {known}>"

    def _repr_html_(self) -> str:
        from meso_robust.reporting.cards import identified_card

        return identified_card(self.document, self.fit, str(self))

    def files(self) -> dict[str, str]:
        """The texts of all result files by name, such as ``model.toml``."""
        from meso_robust.reporting.identification import identification_report
        from meso_robust.toml_files import toml_of

        return {
            "model.toml": toml_of(self.document),
            "identification.json": self.text(),
            "report.html": identification_report(self.document, self.fit, name_of(self.source)),
            **self.more,
        }


@call
def identify(  # every option of the verb is an argument
    recordings: RecordingsGiven,
    *,
    model: str = "viscous",
    starts: Starts = 20,
    objective: Objective = "likelihood",
    confidence: Confidence = 0.9,
    design: Pushes = 0,
    seed: Seed = 0,
    progress: Progress = SILENT,
) -> Identified:
    """Fit a model to recorded pushes: values, intervals, and what cannot be known from them.

    Parameters
    ----------
    recordings
        A recording set, or the name of its folder.
    model
        ``viscous``, ``three_point`` …
    starts
        Random starts of the search.
    objective
        ``likelihood``, with intervals; ``printed``: the paper's objective alone.
    confidence
        Confidence level of the intervals.
    design
        Also propose this many of the most informative pushes.
    seed
        Seed of the random starts.
    progress
        Shows what is being done.

    Returns
    -------
    Identified
        Whatever the verdict.

    Raises
    ------
    InputError
        A file or a value breaks a rule, or the recordings have bad poses.

    Examples
    --------
    A simulation of the plan of :func:`meso_robust.plan`'s example, as a camera sees it:

    >>> runs = mr.simulate(task, planned, samples=1)
    >>> identified = mr.identify(runs.filmed(1), starts=2)
    >>> identified.determined
    ('rho_um2', 'mu')
    >>> print(identified)
    IDENTIFIED: viscous fitted to 4 recordings (90% intervals by profile likelihood)
      rho_um2 = ...   [..., ...]
      mu = 0.3...   [0.3..., 0.3...]
      ...
    """
    if design and objective == "printed":
        raise InputError("--design: needs the information of a likelihood; leave --objective out")
    given = given_of(recordings)

    from meso_robust.identification.answer import document
    from meso_robust.identification.identify import check_model
    from meso_robust.identification.usable import NOISE_IS_FITTED, pathological_of
    from meso_robust.identification.verdict import doubts
    from meso_robust.wording import counted

    check_model(model)
    with progress.doing("checking the recordings"):
        # of seen tips the noise must be known first
        by_camera = given.recordings.position_source == "camera"
        usable = given.usable(frozenset() if by_camera else NOISE_IS_FITTED)
        found, source = usable.recordings, given.source
    fit = _fitted(found, progress, (model, starts, objective), seed, confidence)
    with progress.doing("looking for pathological starts"):
        remarks = (
            *usable.warnings,
            *doubts(fit.model, fit.best),
            *pathological_of(found, fit.model, fit.best),
        )
    more = {}
    if design:
        with progress.doing(f"designing {counted(design, 'push', 'pushes')}"):
            more = _designed(found, fit, design)
    return Identified(
        fit=fit,
        document=document(found, fit, __version__, remarks),
        remarks=remarks,
        source=source,
        more=more,
    )


def _fitted(
    recordings: RecordingSet,
    progress: Progress,
    how: tuple[str, int, Objective],
    seed: int,
    confidence: float,
) -> Identification:
    """The fit, reporting the searches that have ended."""
    from meso_robust.identification import identify as fitting
    from meso_robust.wording import counted

    model, starts, objective = how
    with progress.counting(f"fitting {model} from {counted(starts, 'start')}", starts) as advance:
        ended = 0

        def told(_: str, done: int, total: int) -> None:
            nonlocal ended
            while total == starts and ended < done:
                advance()
                ended += 1

        return fitting.identify(
            recordings,
            model=model,
            starts=starts,
            objective=objective,
            seed=seed,
            confidence=confidence,
            told=told,
        )


def _designed(recordings: RecordingSet, found: Identification, count: int) -> dict[str, str]:
    """Files of the most informative pushes to add to the recordings."""
    from meso_robust.identification.design import DETERMINANT, design
    from meso_robust.identification.experiment import Bench
    from meso_robust.identification.experiment_document import experiment_files
    from meso_robust.identification.rollout import Setting
    from meso_robust.reporting.experiment import experiment_page

    settings, fitted, quality = found.settings, found.fitted, found.quality
    if settings is None or fitted is None or quality is None:
        return {}
    bench = Bench(tip_radius=recordings.tip_radius)
    sensor = replace(
        recordings.sensor,
        position_sigma=settings.position,
        orientation_sigma=settings.orientation,
    )
    made = design(
        Setting(part=recordings.part, bench=bench, model=found.model),
        found.best,
        sensor,
        count,
        known=fitted.information[0] / quality.widening,
        criterion=DETERMINANT,
    )
    page = experiment_page(made.experiment, made, found.model)
    return {**experiment_files(made.experiment, made, found.model), "experiment.html": page}


EITHER_SIDE = (0.2, 1.0, 2.0)
"""Speeds of the standard tests over the stated one. In the slow pushes, of which a recording left out leaves others, dry
friction differs most from one at the tip that falls with the speed; at half the speed they were not told apart."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class StandardTests(Result):
    """The paper's tests A-H for a part.

    Attributes
    ----------
    experiment
        The pushes.
    bench
        The bench they are planned for.
    """

    experiment: Experiment
    bench: Bench

    @property
    def positive(self) -> bool:
        """Always: the tests follow from the part."""
        return True

    @property
    def shown(self) -> dict[str, str]:
        """The page of the tests."""
        return {"drawing": "experiment.html"}

    def __str__(self) -> str:
        from meso_robust.wording import counted

        return f"{counted(len(self.experiment.pushes), 'push', 'pushes')}, {counted(self.bench.trials, 'time')} each"

    def __repr__(self) -> str:
        return f"<StandardTests: {self}>"

    def text(self) -> str:
        """The text of ``experiment.json``."""
        return self._documents()["experiment.json"]

    def files(self) -> dict[str, str]:
        """The texts of all result files by name, such as ``experiment.json``."""
        from meso_robust.reporting.experiment import experiment_page

        return {**self._documents(), "experiment.html": experiment_page(self.experiment)}

    def _documents(self) -> Mapping[str, str]:
        from meso_robust.identification.experiment_document import experiment_files

        return experiment_files(self.experiment)


@call
def standard_tests(source: TaskGiven) -> StandardTests:
    """The paper's tests A-H for the part of a task or of a recording set.

    Parameters
    ----------
    source
        A task, the name of its file, or the folder of a recording set.

    Returns
    -------
    StandardTests
        Places and travels of the pushes, for a bench with the stated speed or tips.

    Raises
    ------
    InputError
        A file cannot be read, or a value breaks a rule.

    Examples
    --------
    >>> import meso_robust as mr
    >>> print(mr.standard_tests(mr.Task.paper()))
    8 pushes, 3 times each
    """
    folder = None
    if isinstance(source, str | PathLike) and Path(source).is_dir():
        folder = Path(source)
    stated = task_of(source) if folder is None else set_of(folder)[0]

    from meso_robust.identification.experiment import Bench, standard_tests
    from meso_robust.laboratory.filming import recorded_part
    from meso_robust.task import Task

    if isinstance(stated, Task):
        speed = 1e-6 * stated.probe.speed_um_s
        part, bench = recorded_part(stated.part), Bench(speed=speed, rates=EITHER_SIDE)
    else:
        part, bench = stated.part, Bench(tip_radius=stated.tip_radius, rates=EITHER_SIDE)
    return StandardTests(experiment=standard_tests(part, bench), bench=bench, source=folder)
