"""The report on a campaign as one HTML page that needs nothing else."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from meso_robust import __version__
from meso_robust.campaigns import provenance
from meso_robust.campaigns.answer import Answer
from meso_robust.campaigns.kind import Bars, Coverage, Paths, Table
from meso_robust.campaigns.store import Session
from meso_robust.provenance import commit
from meso_robust.reporting import campaign_figures as figures, campaign_words as words, pages

MOST_RUNS = 6
"""Runs of one view that are drawn."""
MOST_TROUBLES = 100
"""Rows of the table of troubles, the last ones."""

_COLOURS: Mapping[str, pages.Colour] = {
    "held": "PROVED",
    "broken": "REFUTED",
    "open": "UNKNOWN",
    "measured": "NEUTRAL",
    "incomplete": "UNKNOWN",
}
_MACROS: Mapping[type, str] = {Table: "table", Bars: "bars", Coverage: "coverage", Paths: "paths"}


def campaign_report(answer: Answer, missing: Mapping[str, Sequence[int]] | None = None) -> str:
    """One self-contained HTML page: the verdict first, then part by part, then how it was done.

    Parameters
    ----------
    answer
        The outcome of the campaign.
    missing
        Indices of the chunks that were not done, rising, by the name of their part; without it the
        page says only how many they are.

    Returns
    -------
    str
        The page; it asks for nothing from outside.
    """
    sessions = answer.sessions
    undone = any(part.done < part.planned for part in answer.parts)
    body = pages.prose(
        "campaign.html.j2",
        answer=answer,
        missing=missing or {},
        speeds=_speeds(sessions),
        worked=sum(session.seconds for session in sessions),
        did=sum(session.runs for session in sessions),
        given_up=sum(trouble.given_up for trouble in answer.troubles),
        most_troubles=MOST_TROUBLES,
        macro=lambda view: _MACROS[type(view)],
        tools=_TOOLS,
        words=words,
    )
    incomplete = pages.section(body, "missing", "Not everything was done", "", "notice")
    again = (
        ", with the file above; the same campaign and code give the same totals, however the work "
        "is split and however often it ends"
    )
    return pages.page(
        pages.Report(
            banner=pages.Banner(
                verb="campaign",
                subject=answer.campaign.name,
                word=answer.verdict.upper(),
                colour=_COLOURS[answer.verdict],
                meaning=_meaning(answer),
                figures=_figures(answer),
                answers=body.answers(),
            ),
            sections=(
                *[incomplete] * undone,
                pages.section(body, "parts", "Parts"),
                *(
                    pages.Section(
                        f"part-{number}",
                        body.title(part),
                        link=part.part.name,
                        body=(body.part(part, number),),
                        look="",
                    )
                    for number, part in enumerate(answer.parts, start=1)
                ),
                pages.section(body, "throughput", "Throughput"),
                pages.section(body, "troubles", "Troubles"),
                pages.section(body, "stated", "Campaign file"),
            ),
            made=pages.made(
                f"meso-robust campaign CAMPAIGN.toml --seed {answer.campaign.seed}",
                ("totals", pages.code(answer.totals_digest)),
                ("campaign", pages.code(answer.campaign.hash)),
                ("code", pages.code(provenance.code())),
                after=again,
                using={"meso-robust": __version__, **provenance.versions(), "commit": commit()},
            ),
            styles=("diagnosis.css", "campaign.css"),
        )
    )


def _meaning(answer: Answer) -> str:
    """The verdict over all in a sentence or two."""
    parts = answer.parts
    held = [part for part in parts if part.told.verdict == "held"]
    broken = [f"“{part.part.name}”" for part in parts if part.told.verdict == "broken"]
    unanswered = [f"“{part.part.name}”" for part in parts if part.told.verdict == "open"]
    runs = sum(part.runs for part in held)
    planned, done = sum(part.planned for part in parts), sum(part.done for part in parts)
    return {
        "held": f"{len(held)} of {words.parts(len(parts))} made a claim and looked for what breaks "
        f"it in {runs:,} runs; nothing did. That is evidence, not a proof.",
        "broken": f"{len(broken)} of {words.parts(len(parts))} found that something does not hold: "
        f"{', '.join(broken)}. The findings are listed there, with what is needed to reproduce them.",
        "open": f"{len(unanswered)} of {words.parts(len(parts))} asked for something that what was "
        f"done neither shows nor refutes: {', '.join(unanswered)}.",
        "measured": "Rates were measured; no claim was at stake.",
        "incomplete": f"{planned - done:,} of {planned:,} chunks were not done. The results below "
        "rest on the others.",
    }[answer.verdict]


def _figures(answer: Answer) -> tuple[tuple[str, str], ...]:
    """Name and value of what stands under the headline."""
    parts, sessions = answer.parts, answer.sessions
    done, planned = sum(part.done for part in parts), sum(part.planned for part in parts)
    took = sum(session.seconds for session in sessions)
    broken = sum(part.told.verdict == "broken" for part in parts)
    return (
        ("runs", f"{sum(part.runs for part in parts):,}"),
        ("parts that are broken", f"{broken} of {len(parts)}"),
        ("chunks done", f"{done:,} of {planned:,}"),
        ("runs/s, over all sessions", words.rate(sum(session.runs for session in sessions), took)),
        ("of work, summed over the workers", words.duration(sum(part.seconds for part in parts))),
    )


def _speeds(sessions: tuple[Session, ...]) -> Bars | None:
    """Runs a second of each session, if there is something to compare."""
    timed = [
        (number, session)
        for number, session in enumerate(sessions, start=1)
        if session.seconds > 0.0
    ]
    if len(timed) < 2:
        return None
    return Bars(
        title="Runs a second, by session",
        unit="runs/s",
        labels=tuple(f"session {number}" for number, _ in timed),
        values=tuple(session.runs / session.seconds for _, session in timed),
    )


def _drawings(view: Paths, name: str) -> list[pages.Figure]:
    return figures.drawings(view, MOST_RUNS, name)


_TOOLS = {
    "words": words,
    "scale": figures.scale,
    "strips": figures.strips,
    "shades": figures.SHADES,
    "drawings": _drawings,
    "most_runs": MOST_RUNS,
}
"""What the macros of the views use."""
