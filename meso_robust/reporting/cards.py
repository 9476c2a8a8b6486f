"""Every kind of result as a card for notebooks; the whole story is in its report."""

from __future__ import annotations

import matplotlib
from markupsafe import Markup
from matplotlib.figure import Figure

from meso_robust.bounds import Verdict
from meso_robust.campaigns.answer import Answer as CampaignAnswer
from meso_robust.checker.document import Certificate
from meso_robust.checker.verdict import Answer as Checked
from meso_robust.diagnosis.document import DiagnosisDocument
from meso_robust.diagnosis.evidence import Evidence
from meso_robust.identification.document import ModelDocument
from meso_robust.identification.identify import Identification
from meso_robust.identification.verdict import COLOURS, meaning, verdict
from meso_robust.laboratory.simulation import Simulated
from meso_robust.laboratory.simulation_document import SimulationDocument
from meso_robust.pipeline import Planned
from meso_robust.recordings import RecordingSet
from meso_robust.recordings.phases import phases
from meso_robust.recordings.summary import Checked as CheckedSet
from meso_robust.reporting import card as cards, diagnosis_words
from meso_robust.reporting.answer import answer
from meso_robust.reporting.diagnosis_figures import held_out_figure, map_figure
from meso_robust.reporting.identification_figures import profile_figure, recording_figure
from meso_robust.reporting.plan_figures import overview_figure
from meso_robust.reporting.recording_figures import recording_svg
from meso_robust.reporting.run_figures import certificate_figure, runs_figure, shares_figure
from meso_robust.reporting.words import about, high_end, low_end, sentence, significant
from meso_robust.task import Task
from meso_robust.tracking.job import Found as Tracked
from meso_robust.transfer.promise import Promise
from meso_robust.wording import counted

MOST_ROWS = 12
"""Recordings in a picture."""
_CHECKED = {
    "VERIFIED": (
        "PROVED",
        "The certificate proves what it claims; what no check can confirm is listed below.",
    ),
    "MARGIN UNDECIDED": (
        "UNKNOWN",
        "The plan is proved for the uncertainties that the task states; that it bears as many times more as the "
        "certificate says was not shown.",
    ),
    "REJECTED": ("REFUTED", "Something that the certificate states was not confirmed."),
    "WITNESS CONFIRMED": (
        "REFUTED",
        "The plan fails: the certificate's run is proved to fail.",
    ),
    "WITNESS UNDECIDED": (
        "UNKNOWN",
        "The certificate says that the plan fails; only the simulator can follow the run, the checker cannot.",
    ),
    "NOTHING CLAIMED": ("UNKNOWN", "The certificate claims nothing that could be checked."),
}
_CAMPAIGN = {
    "held": ("PROVED", "What was claimed was tested, and nothing broke it: evidence, not a proof."),
    "broken": ("REFUTED", "Something that was claimed does not hold."),
    "open": ("UNKNOWN", "The results neither confirm nor refute everything that was asked."),
    "measured": ("NEUTRAL", "Rates were measured; no claim was at stake."),
    "incomplete": ("UNKNOWN", "Not everything that was planned was done."),
}
_RECORDINGS = {
    "CLEAN": ("PROVED", "No reason was found not to use these recordings."),
    "USABLE WITH CARE": ("UNKNOWN", "They can be used, but read the warnings first."),
    "NOT USABLE AS IT IS": ("REFUTED", "Some recordings cannot be used as they are."),
}


def planned_card(
    result: Planned, promise: Promise | None, checker: Checked | None, text: str
) -> str:
    """A judged plan: the way of the part from the start to the goal.

    Parameters
    ----------
    result
        The plan and all that is known of it.
    promise
        What a fitted model made of the task; None without one.
    checker
        What the checker says of the certificate; None if it was not asked.
    text
        The answer as it is printed.

    Returns
    -------
    str
        The card, HTML that can stand in any page.
    """
    said, label = answer(result, promise, checker), "The whole plan"
    return cards.card(
        word=said.verdict,
        colour=said.colour,
        about=result.task.name,
        meaning=said.meaning,
        figures=said.figures,
        picture=overview_figure(result).svg(cards.own_name(text, label), label),
        caption=f"0: the start; 1 to {len(result.found.rules)}: the part after each move of the "
        "nominal run; dashed: the goal.",
        text=text,
    )


def checked_card(checked: Checked, certificate: Certificate, task: Task, text: str) -> str:
    """A checked certificate: the boxes that it states.

    Parameters
    ----------
    checked
        The outcome of the check.
    certificate, task
        As read.
    text
        The answer as it is printed.

    Returns
    -------
    str
        The card, HTML that can stand in any page.
    """
    colour, meaning = _CHECKED[checked.verdict]
    proved = [item.verdict == "PROVED" for step in certificate.steps for item in step.obligations]
    holds = checked.positive and certificate.verdict == Verdict.PROVED.word
    return cards.card(
        word=checked.verdict,
        colour=colour,
        about=task.name,
        meaning=meaning,
        figures=(
            ("the certificate says", certificate.verdict),
            ("moves", str(len(certificate.policy))),
            ("inequalities stated as proved", f"{sum(proved)} of {len(proved)}"),
        ),
        picture=cards.picture(
            lambda: certificate_figure(certificate, task, holds=holds), text, "Stated boxes"
        ),
        caption="The part at the start and (dashed) in the goal; numbered boxes: where the "
        "certificate says its centre is before the first and after each move.",
        text=text,
    )


def simulated_card(found: Simulated, document: SimulationDocument, text: str) -> str:
    """Simulated runs: the nominal one, and where the others end.

    Parameters
    ----------
    found, document
        The runs, and their result document.
    text
        The answer as it is printed.

    Returns
    -------
    str
        The card, HTML that can stand in any page.
    """
    sampled = document.sampled
    figures = [
        ("sampled runs end in the goal", f"{sampled.in_goal} of {sampled.runs}"),
        ("completed", str(sampled.completed)),
    ]
    if sampled.largest_miss is not None:
        figures.append(("tolerances, the worst distance", significant(sampled.largest_miss, 3)))
    return cards.card(
        word="IN THE GOAL" if document.all_in_goal else "NOT ALL IN THE GOAL",
        colour="PROVED" if document.all_in_goal else "REFUTED",
        about=document.task,
        meaning="Simulated runs are evidence, not a proof.",
        figures=tuple(figures),
        picture=cards.picture(lambda: runs_figure(found), text, "Simulated runs"),
        caption="Outlines: the nominal run before the first and after each move; dots: last "
        "positions of the sampled runs, red crosses those outside the goal.",
        text=text,
    )


def identified_card(document: ModelDocument, found: Identification, text: str) -> str:
    """A fitted model: how the misfit rises along each parameter.

    Parameters
    ----------
    document, found
        The model as written and as found.
    text
        The answer as it is printed.

    Returns
    -------
    str
        The card, HTML that can stand in any page.
    """
    best, known = document.minima[0], len(found.determined)
    word = verdict(document)
    likely = found.fitted is not None
    return cards.card(
        word=word,
        colour=COLOURS[word],
        about=document.model,
        meaning=sentence(meaning(document))
        or f"The recordings determine {known} of {counted(len(found.profiles), 'parameter')}.",
        figures=(
            ("recordings", str(len(document.recording))),
            *(
                (key, f"{about(fitted.value)} [{low_end(fitted.low)}, {high_end(fitted.high)}]")
                for key, fitted in list(document.parameters.items())[:3]
            ),
            ("RMS of x · y", f"{best.x_um:.3g} · {best.y_um:.3g} µm"),
        ),
        picture=cards.picture(
            lambda: profile_figure(found) if likely else recording_figure(found, 0),
            text,
            "Rise of χ² along every parameter" if likely else "A recording with the model",
        ),
        caption="How the misfit rises on both sides of each fitted parameter."
        if likely
        else "The first recording with the model.",
        text=text,
    )


def diagnosed_card(document: DiagnosisDocument, evidence: Evidence, text: str) -> str:
    """A diagnosis: what the extended model does to the error on recordings held out.

    Parameters
    ----------
    document, evidence
        The diagnosis, and the motion that it is about.
    text
        The answer as it is printed.

    Returns
    -------
    str
        The card, HTML that can stand in any page.
    """
    look, mismatch, held = (
        diagnosis_words.LOOKS[document.verdict],
        document.mismatch,
        document.held_out,
    )
    worst = sorted(held.each, key=lambda recording: -recording.baseline_sigma)[:MOST_ROWS]
    figures = [("p-value of the plain model", significant(mismatch.p_value, 2))]
    if held.recordings:
        before, after = (significant(x, 3) for x in (held.baseline_sigma, held.extended_sigma))
        value = f"{before} → {after} σ" if document.extends else f"{before} σ"
        figures.append(("error on held-out recordings", value))

    def drawn() -> Figure:
        with matplotlib.rc_context({"text.parse_math": False}):  # names of files are no formulas
            if worst:
                return held_out_figure(
                    worst,
                    (held.noise_floor_sigma, held.repeatability_sigma),
                    document.extends,
                )
            return map_figure(evidence, list(range(len(evidence.files)))[:MOST_ROWS])

    return cards.card(
        word=document.verdict.upper(),
        colour=look.colour,
        about=diagnosis_words.answer(document),
        meaning=look.meaning,
        figures=tuple(figures),
        picture=cards.picture(drawn, text, "Errors of the models"),
        caption="Errors on the held-out recordings, before and after the effects were added."
        if worst
        else "Residuals by recording and time.",
        text=text,
    )


def recordings_card(checked: CheckedSet, text: str) -> str:
    """A checked recording set: its first recording.

    Parameters
    ----------
    checked
        The set and what was found in it.
    text
        The answer as it is printed.

    Returns
    -------
    str
        The card, HTML that can stand in any page.
    """
    colour, meaning = _RECORDINGS[checked.verdict]
    found = checked.recordings
    return cards.card(
        word=checked.verdict,
        colour=colour,
        about=checked.source,
        meaning=meaning,
        figures=(
            ("recordings", str(len(found.recordings))),
            ("rows", str(sum(recording.times.size for recording in found.recordings))),
            ("errors and warnings", str(len(checked.matters))),
            ("repairs", str(len(checked.repairs))),
        ),
        picture=_way(found),
        caption=f"{found.recordings[0].file}: the paths of part and tips; x, y, θ over time.",
        text=text,
    )


def tracked_card(found: Tracked, text: str) -> str:
    """Tracked videos: the way of part and tips in the first in which the part was found.

    Parameters
    ----------
    found
        The tracks and what was made of them.
    text
        The answer as it is printed.

    Returns
    -------
    str
        The card, HTML that can stand in any page.
    """
    videos, recordings = found.answer.videos, found.recordings
    frames, seen = sum(video.frames for video in videos), sum(video.found for video in videos)
    drawn = None
    if recordings is not None:
        drawn = _way(recordings)
    return cards.card(
        word="TRACKED" if found.answer.tracked else "LOST",
        colour="PROVED" if found.answer.tracked else "REFUTED",
        about=", ".join(video.video for video in videos),
        meaning="Frames that cannot be trusted stay empty, with the reason.",
        figures=(("videos", str(len(videos))), ("frames with a pose", f"{seen} of {frames}")),
        picture=drawn,
        caption="The first recording: the paths of part and tips; x, y, θ over time.",
        text=text,
    )


def _way(recordings: RecordingSet) -> Markup:
    first = recordings.recordings[0]
    shown = phases(recordings, first)
    return recording_svg(recordings, first, frozenset(), shown, "A recording")


def campaigned_card(found: CampaignAnswer, text: str) -> str:
    """The outcome of a campaign: runs and failures of its parts.

    Parameters
    ----------
    found
        The answer of the campaign.
    text
        The answer as it is printed.

    Returns
    -------
    str
        The card, HTML that can stand in any page.
    """
    colour, meaning = _CAMPAIGN[found.verdict]
    parts = found.parts
    done, planned = sum(part.done for part in parts), sum(part.planned for part in parts)
    return cards.card(
        word=found.verdict.upper(),
        colour=colour,
        about=found.campaign.name,
        meaning=meaning,
        figures=(
            ("runs", f"{sum(part.runs for part in parts):,}"),
            ("failed", f"{sum(part.failed for part in parts):,}"),
            ("chunks done", f"{done:,} of {planned:,}"),
        ),
        picture=cards.picture(lambda: shares_figure(parts), text, "Failures by part"),
        caption="Share of the runs of each part that failed.",
        text=text,
    )


def reproduced_card(names: tuple[str, ...], rows: int, text: str) -> str:
    """Tables and figures of the paper made again, in words.

    Parameters
    ----------
    names, rows
        The items, and how many values they hold.
    text
        The answer as it is printed.

    Returns
    -------
    str
        The card, HTML that can stand in any page.
    """
    return cards.card(
        word="REPRODUCED",
        colour="NEUTRAL",
        about=", ".join(names),
        meaning="The report shows printed values and ours side by side.",
        figures=(("items", str(len(names))), ("values", str(rows))),
        text=text,
    )
