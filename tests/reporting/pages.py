"""Every kind of report, made from little, in the name of a user who means harm."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np
from markupsafe import Markup
from matplotlib.figure import Figure as Drawn

from derivations.generate import derive_one
from derivations.report.figures import pictures
from derivations.report.page import page
from derivations.report.register import chapters
from meso_robust import __version__
from meso_robust.identification.answer import document as model_document
from meso_robust.identification.identify import identify
from meso_robust.laboratory.simulation import player_of, simulated
from meso_robust.laboratory.simulation_answer import document as simulation_document
from meso_robust.pipeline import Planned
from meso_robust.planning.document import PlanDocument
from meso_robust.primitives.setup import setup_of
from meso_robust.recordings import Recording
from meso_robust.reporting.animation import animation
from meso_robust.reporting.campaign import campaign_report
from meso_robust.reporting.diagnosis import diagnosis_report
from meso_robust.reporting.experiment import experiment_page
from meso_robust.reporting.identification import identification_report
from meso_robust.reporting.pages import Figure
from meso_robust.reporting.plan import report
from meso_robust.reporting.recordings import recordings_report
from meso_robust.reporting.svg import style, to_svg
from meso_robust.reporting.tracking import tracking_report
from meso_robust.reproduction.document import Made
from meso_robust.reproduction.item import Found, Item, Row, Setting
from meso_robust.reproduction.page import reproduction_report
from meso_robust.simulator import Film
from meso_robust.tracking.track import Track
from meso_robust.tracking.track_document import (
    LostDocument,
    ProbeDocument,
    TrackDocument,
    VideoDocument,
)
from tests.identification.sets import random_pushes, recorded
from tests.identification.table_one import TESTS
from tests.paper import paper_task
from tests.recordings.planted import clean, one, planted, poses
from tests.reporting import test_campaign as campaigns
from tests.reporting.diagnoses import document as diagnosis_document, evidence
from tests.reporting.test_recordings import checked

ROOT = Path(__file__).parents[2]
MARK = "mwmwmw"
EVIL = (
    '<script>document.title="run"</script>"><img src=x onerror=\'document.title="run"\'>'
    f" & $x_1$ \u05e9\u05dc\u05d5\u05dd \u0645\u0631\u062d\u0628\u0627 \U0001f52c {MARK * 30}"
)
"""Elements and quotes that would run, a formula, words from the right, a sign few fonts have, and a
word longer than a line."""
FILE = f"a' onload=alert(1) & $x_1$ \u05e9\u05dc\u05d5\u05dd \U0001f52c {MARK * 20}.csv"
"""The same as a name of a file."""
DERIVED = ("printed_numbers", "one_point_sticking", "final_orientation")
"""Files of the register that is shown: quick ones, with every verdict."""


def plan_page(result: Planned) -> str:
    """The page of a plan whose task has the evil name."""
    task = result.task.model_copy(update={"name": EVIL})
    certificate = result.certificate.model_copy(update={"task": EVIL})
    return report(replace(result, task=task, certificate=certificate))


def campaign_page() -> str:
    views = (campaigns.BARS, campaigns.COVERAGE, campaigns.PATHS)
    tube = campaigns.part(
        EVIL,
        campaigns.told("broken", *views, answer=EVIL),
        done=235,
        failed=2,
        shown=(campaigns.shown(44, campaigns.WITNESS, EVIL), campaigns.shown(45, {})),
    )
    found = campaigns.answer(
        tube,
        campaigns.part("rate", campaigns.told("measured", campaigns.TABLE)),
        troubles=(campaigns.trouble(4, 1, EVIL, given_up=True),),
        sessions=(campaigns.session(ended=None), campaigns.session(seconds=90.0, crew=EVIL)),
    )
    found = replace(found, campaign=replace(found.campaign, name=EVIL, text=EVIL))
    return campaign_report(found, {EVIL: (4, 17)})


def diagnosis_page() -> str:
    return diagnosis_report(diagnosis_document("named"), evidence("named"), EVIL)


def recordings_page() -> str:
    changed = poses()
    changed[[50, 51]] = 0.0
    first, middle, last = planted(poses=changed).recordings
    made = clean(recordings=(first, replace(middle, file=FILE), last))
    return recordings_report(checked(made, source=EVIL, notes=(EVIL,)))


def identification_page() -> str:
    rng = np.random.default_rng(11)
    pushes = recorded(random_pushes(rng, 3), Film.ratio(np.full(3, 0.3769e-6)), 0.33, rng)
    first, *others = pushes.recordings
    pushes = replace(pushes, recordings=(replace(first, file=FILE), *others))
    found = identify(pushes, starts=1)
    return identification_report(model_document(pushes, found, __version__, ()), found, EVIL)


def experiment_report() -> str:
    return experiment_page(replace(TESTS, left_out=((EVIL, EVIL),)))


def reproduction_page() -> str:
    with style():
        figure = Drawn(figsize=(5, 3))
        figure.add_subplot().plot([0.0, 1.0])
        svg = to_svg(figure, "trial", EVIL)
    rows = (Row(quantity=EVIL, unit="um", printed=(18.0, 20.0), ours=11.0, why=EVIL),)
    found = Found(
        answer=EVIL,
        rows=rows,
        missing=(EVIL,),
        figures=(Figure(svg=Markup(svg), caption=EVIL),),
        data={},
    )
    item = Item(title="Table III", where="Section X-C", run=lambda _: found)
    two = {
        name: Made(name=name, item=item, found=replace(found, figures=figures), seconds=1.0)
        for name, figures in (("one", found.figures), ("two", ()))
    }
    return reproduction_report(two, Setting())


class _Seen:
    """What the page reads of a track."""

    def __init__(self, recording: Recording) -> None:
        count = recording.times.size
        self.times, self.names = recording.times, (EVIL,)
        self.covariances = np.tile(np.diag([1e-14, 2e-14, 1e-6]), (count, 1, 1))
        self.tip_covariances = np.tile(np.eye(2) * 1e-14, (count, 1, 1, 1))


def tracking_page() -> str:
    recording = one(FILE)
    video = VideoDocument(
        video=EVIL,
        sha256="0" * 64,
        file=FILE,
        frames=200,
        promised=200,
        frame_rate_hz=30.0,
        width_px=640,
        height_px=480,
        found=190,
        lost_share=0.05,
        states={"found": 190, "occluded": 10},
        lost=[LostDocument(first=7, last=16, state="occluded", reason=EVIL)],
        rms_px=0.02,
        rms_um=0.1,
        rms_deg=None,
        mean_score=0.9,
        probes=[ProbeDocument(name=EVIL, found=190, sigma_px=0.1, lost={})],
        notes=[EVIL],
    )
    calibration = {"pixel_um": 5.0, "rotation_deg": 0.0, "k1": 0.0}
    answer = TrackDocument(
        tracked=True,
        commanded=False,
        most_lost=0.1,
        videos=[video],
        calibration=calibration,
        grid=None,
        provenance={"meso_robust": __version__, "asked": {"pitch": EVIL}},
    )
    seen: list[Track] = [_Seen(recording)]  # type: ignore[list-item]
    return tracking_report(answer, seen, clean(recordings=(recording,)))


def simulation_page() -> str:
    text = (ROOT / "reports" / "paper_task" / "plan.json").read_text(encoding="utf-8")
    plan, task = PlanDocument.model_validate_json(text), paper_task()
    player = player_of(plan, setup_of(task))
    found = simulated(task, plan, player, samples=8, seed=4, adversarial=False)
    found = replace(found, task=task.model_copy(update={"name": EVIL}))
    return animation(found, simulation_document(found))


def register_page() -> str:
    derived = tuple(derive_one(name) for name in DERIVED)
    return page(chapters(derived), pictures())


MAKERS: Mapping[str, Callable[[], str]] = {
    "campaign": campaign_page,
    "diagnosis": diagnosis_page,
    "recordings": recordings_page,
    "identification": identification_page,
    "experiment": experiment_report,
    "reproduction": reproduction_page,
    "tracking": tracking_page,
    "simulation": simulation_page,
    "register": register_page,
}
"""Those that need no plan."""
