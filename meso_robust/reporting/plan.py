"""The report as one HTML page that needs nothing else."""

from __future__ import annotations

from meso_robust.bounds import Verdict
from meso_robust.checker.verdict import Answer as Verified
from meso_robust.laboratory.running import excess
from meso_robust.pipeline import Planned
from meso_robust.planning.possible import remarks
from meso_robust.reporting import pages, rows
from meso_robust.reporting.answer import answer
from meso_robust.reporting.conditions import LETTERS_SAID, conditions
from meso_robust.reporting.plan_figures import move_figure, overview_figure
from meso_robust.reporting.reading import Standing, ending, endings, standings, through
from meso_robust.reporting.scene import Picture
from meso_robust.reporting.steps import step_rows, title
from meso_robust.reporting.tube_figures import (
    PATHS,
    final_figure,
    has_tube,
    spread_figure,
    tube_figure,
)
from meso_robust.reporting.view import engine, held, view
from meso_robust.reporting.words import MINUS, QUANTITIES, factor, number, small
from meso_robust.transfer.answer import document, worst_words
from meso_robust.transfer.promise import Promise
from meso_robust.wording import counted, do, up, worded


def report(result: Planned, promise: Promise | None = None, checker: Verified | None = None) -> str:
    """One self-contained HTML page on a plan: the answer first, then its grounds.

    Parameters
    ----------
    result
        Everything that ``meso-robust plan`` found out.
    promise
        What a fitted model made of the task, if the plan was made with one.
    checker
        What the checker says of the certificate, if it was asked.

    Returns
    -------
    str
        The page; it asks for nothing from outside.
    """
    certificate, said, ran = (
        result.certificate,
        answer(result, promise, checker),
        result.certificate.simulation,
    )
    within = "" if result.search_s is None else f" --search-s {result.search_s:g}"
    checked = "" if checker is None else " --check"
    pictures = {
        "moves": [_move(result, index) for index in range(len(result.found.rules))],
        "overview": _overview(result),
        "spreads": [_spread(result, index) for index in range(len(result.found.rules))],
        "tubes": _tubes(result),
        "end": _end(result),
    }
    body = pages.prose(
        "plan.html.j2",
        task=result.task,
        certificate=certificate,
        answer=said,
        remarks=remarks(result.task, () if promise is None else promise.changed.keys),
        promise=None if promise is None else document(promise),
        pictures=pictures,
        view=view(result),
        held=held(result.setup),
        engine=engine(),
        steps=step_rows(result),
        conditions=conditions(
            item.inequality for step in certificate.steps for item in step.obligations
        ),
        letters=LETTERS_SAID,
        margins=rows.margin_rows(result),
        excesses=rows.excess_rows(result),
        ends=rows.end_rows(result),
        endings=[(count, where, how) for where, how, count in endings(result.check)],
        policy=rows.policy_rows(result),
        nominal=rows.nominal_rows(result),
        quantities=QUANTITIES,
        proved=certificate.verdict == "PROVED",
        factor=factor,
        number=number,
        small=small,
        up=up,
        counted=counted,
        do=do,
        worded=worded,
        worst_words=worst_words,
    )
    sections = []
    if said.open is not None:
        title = f"What is open: {said.open.where}"
        sections.append(pages.section(body, "open", title, "", f"notice {said.verdict}"))
    if said.witness is not None:
        sections.append(pages.section(body, "witness", "A run that fails", "", "notice REFUTED"))
    if promise is not None:
        sections.append(pages.section(body, "model", "What the fitted model says", ""))
    return pages.page(
        pages.Report(
            banner=pages.Banner(
                verb="plan",
                subject=certificate.task,
                word=said.verdict,
                colour=said.colour,
                meaning=said.meaning,
                figures=said.figures,
            ),
            lead=body.claim(),
            sections=(
                *sections,
                pages.section(body, "plan", "The plan"),
                pages.section(body, "steps", "Proof move by move"),
                pages.section(body, "tubes", "Certified against simulated"),
                pages.section(body, "margin", "Margin"),
                pages.section(body, "simulation", "Simulation"),
                pages.section(body, "policy", "Commands"),
                pages.section(body, "assumptions", "Assumptions"),
                pages.section(body, "derivations", "Derivations"),
            ),
            made=pages.made(
                f"meso-robust plan TASK.toml --samples {ran.samples} --seed {ran.seed}{within}{checked}",
                ("task hash (SHA-256)", pages.code(certificate.task_hash)),
                after=" with the task file of this hash",
                using=certificate.made_with,
            ),
            styles=("plan.css", "player.css", "view.css"),
            scripted=True,
        )
    )


def _figure(name: str, title: str, caption: str, drawing: Picture) -> pages.Figure:
    return pages.Figure(svg=drawing.svg(name, title), title=title, caption=caption, wide=False)


def _move(result: Planned, index: int) -> pages.Figure:
    x, y = result.plan.moves[index].travel_um
    heading = result.found.rules[index].frame.heading.replace("-", MINUS)
    standing = standings(result.chain, len(result.found.rules))[index]
    caption = f"Active tips travel {number(abs(x) + abs(y))} µm along {heading}; "
    caption += f"{standing.value}."
    nominal = result.check.nominal
    if nominal.failed_in[0] == index:
        caption += f" The nominal run ends early here: {ending(int(nominal.outcomes[0]))}."
    elif nominal.failed_in[0] < index:
        caption += " The nominal run does not get this far."
    name = f"Move {index + 1}: {title(result, index)}"
    return _figure(f"move{index}", name, caption, move_figure(result, index))


def _overview(result: Planned) -> pages.Figure:
    last = len(result.found.rules)
    caption = f"0: the start; 1 to {last}: the part after each move of the nominal run."
    svg = overview_figure(result).svg("overview", "The whole plan from start to goal")
    return pages.Figure(svg=svg, title="The whole plan", caption=caption)


def _spread(result: Planned, index: int) -> pages.Figure:
    alive = through(result.check, index)
    caption = (
        f"{int(alive.sum())} of {counted(len(alive), 'run')} completed; {_inside(result, index)}."
    )
    name = f"After move {index + 1}: {title(result, index)}"
    return _figure(f"spread{index}", name, caption, spread_figure(result, index))


def _inside(result: Planned, index: int) -> str:
    """How many runs lie in the box after a move, and what that box is worth."""
    standing = standings(result.chain, len(result.found.rules))[index]
    post = None if standing is Standing.NOT_REACHED else result.chain.steps[index].post
    if post is None:
        return "no certified box"
    poses = result.check.sampled.moves[index].after[through(result.check, index)]
    count = int((excess(poses, post) == 0.0).all(axis=1).sum())
    if standing is not Standing.CERTIFIED:
        return f"{count} in the dashed box, which is only a candidate ({standing.value})"
    if count == len(poses):
        return "all in the certified box"
    less = rows.excess_rows(result)[index].judged == "within"
    return (
        f"{count} in the certified box, the others outside it by "
        f"{'less' if less else 'more'} than the simulator's error"
    )


def _tubes(result: Planned) -> list[pages.Figure]:
    pictures = []
    for index in range(len(result.found.rules)):
        if not has_tube(result, index):
            continue
        move = f"Move {index + 1}: {title(result, index)}"
        runs = min(PATHS, int(through(result.check, index).sum()))
        slices = len(result.chain.steps[index].tube)
        for side, letter in (("y", "y"), ("theta", "θ")):
            name = f"{move}, {letter} over x"
            caption = f"{slices} slices of the certified tube, {runs} simulated paths."
            drawing = tube_figure(result, index, "y" if side == "y" else "theta")
            pictures.append(_figure(f"tube{index}{side}", name, caption, drawing))
    return pictures


def _end(result: Planned) -> pages.Figure:
    done = int(result.check.sampled.completed.sum())
    name = "Final poses in the goal"
    box = "certified box in blue" if result.chain.verdict is Verdict.PROVED else "no certified box"
    missed = done - int(result.check.in_goal.sum())
    caption = f"{done} completed runs; goal in green, {box}."
    if missed:
        caption += f" Red: the {missed} that miss the goal."
    return _figure("final", name, caption, final_figure(result))
