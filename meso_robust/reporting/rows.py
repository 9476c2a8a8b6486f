"""Rows of the page's tables, every cell a text or a plain number."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, NamedTuple

from markupsafe import Markup

from meso_robust.certificates.margin import LARGEST
from meso_robust.pipeline import Planned
from meso_robust.planning.document import RuleDocument
from meso_robust.planning.stated import errors_of, ranges_of, unit_of, widened
from meso_robust.reporting import pages
from meso_robust.reporting.canvas import COLUMN, Coordinate, ends, poses_shown
from meso_robust.reporting.reading import Standing, standings
from meso_robust.reporting.steps import title
from meso_robust.reporting.words import (
    MINUS,
    command,
    factor,
    outward,
    point,
    signed,
    significant,
    small,
)
from meso_robust.wording import down

Three = tuple[str, str, str]


@dataclass(frozen=True, slots=True)
class MarginRow:
    """The margin of one uncertainty, and its bar."""

    name: str
    stated: str
    budget: str
    """The range at that factor, rounded inward: what the laboratory may let it grow to."""
    factor: str
    """Empty where one value is stated, which no factor widens."""
    percent: float
    """Length of the bar."""
    binds: bool


@dataclass(frozen=True, slots=True)
class MarginRows:
    """All margins on one scale."""

    rows: tuple[MarginRow, ...]
    one_percent: float
    """Where factor 1 lies."""


def margin_rows(result: Planned) -> MarginRows:
    """Margins: all together first, then each alone, from the tightest to the widest."""
    margin = result.certificate.margin
    each = sorted(margin.each_alone.items(), key=lambda item: item[1])
    full = min(max([margin.factor, *margin.each_alone.values(), 1.0]) * 1.05, LARGEST)
    stated = _stated(result)
    exact = {name for name, (_, ends) in ranges_of(result.task).items() if ends[0] == ends[1]}
    exact |= {name for name, error in errors_of(result.task).items() if error == 0.0}
    together = factor(margin.factor)
    rows = [MarginRow("all together", "", "", together, 100 * margin.factor / full, False)]
    rows += [
        MarginRow(
            name.replace("_", " "),
            stated.get(name, ""),
            widened(result.task, name, value),
            factor(value),
            100 * value / full,
            name == margin.binds_first,
        )
        for name, value in each
        if name not in exact
    ]
    radii = result.margin.radii
    rows += [
        MarginRow(
            name.replace("_", " "),
            stated.get(name, ""),
            f"{radii[name][0]:.15g} … {radii[name][1]:.15g}{unit_of(name)}"
            if name in radii
            else "",
            "",
            0.0,
            False,
        )
        for name, _ in each
        if name in exact
    ]
    return MarginRows(tuple(rows), 100 / full)


def _stated(result: Planned) -> dict[str, str]:
    """The task's own ranges, in the words of its file."""
    u = result.task.uncertainty
    found = {
        name: " … ".join(dict.fromkeys(significant(end) for end in ends)) + unit_of(name)
        for name, (_, ends) in ranges_of(result.task).items()
    }
    found |= {name: f"± {value:g}{unit_of(name)}" for name, value in errors_of(result.task).items()}
    return found | {"film_ratio": f"{u.film_ratio_um2:g} µm² ± {u.film_ratio_percent:g} %"}


@dataclass(frozen=True, slots=True)
class ExcessRow:
    """How far runs lie outside the box after a move."""

    number: int
    title: str
    excess: Three | None
    standing: Standing
    judged: Literal["none", "within", "above"]
    """No excess, one within the simulator's own error, or one above it."""


def excess_rows(result: Planned) -> tuple[ExcessRow, ...]:
    """A row for every move; None where there is no box to leave."""
    simulation, moves = result.certificate.simulation, len(result.found.rules)
    largest, error = simulation.largest_excess_um_um_deg, simulation.simulator_error_um_um_deg
    known = standings(result.chain, moves)
    rows = []
    for index in range(moves):
        values = largest[index] if index < len(largest) else None
        shown = None if values is None else (small(values[0]), small(values[1]), small(values[2]))
        judged = "none" if values is None else _judge(values, error)
        rows.append(ExcessRow(index + 1, title(result, index), shown, known[index], judged))
    return tuple(rows)


def _judge(
    excess: tuple[float, ...], error: tuple[float, ...]
) -> Literal["none", "within", "above"]:
    if not any(excess):
        return "none"
    return "above" if any(a > b for a, b in zip(excess, error, strict=True)) else "within"


class EndRow(NamedTuple):
    """One coordinate of the last poses: goal, certified, simulated, and what is to spare."""

    name: str
    goal: str
    certified: str
    simulated: str
    spare: str
    """Distance of the certified end, else of the simulated ones, from the goal's limit."""


def end_rows(result: Planned) -> tuple[EndRow, ...]:
    """x, y and theta at the end of the plan."""
    goal, end = result.task.goal, result.chain.end
    final = poses_shown(result.check.sampled.final[result.check.sampled.completed])
    far, turn = goal.position_tolerance_um, goal.orientation_tolerance_deg
    wanted: tuple[tuple[Coordinate, str, float, float], ...] = (
        ("x", "x, µm", goal.x_um, far),
        ("y", "y, µm", goal.y_um, far),
        ("theta", "θ, deg", goal.theta_deg, turn),
    )
    rows = []
    for coordinate, name, middle, reach in wanted:
        digits = 2 if coordinate == "theta" else 1
        values = final[:, COLUMN[coordinate]]
        box = None if end is None else ends(end, coordinate)
        seen = (float(values.min()), float(values.max())) if len(values) else None
        limit = box or seen
        rows.append(
            EndRow(
                name=name,
                goal=f"{significant(middle)} ± {reach:g}",
                certified="—" if box is None else outward(*box, digits),
                simulated="—" if seen is None else outward(*seen, digits),
                spare="—" if limit is None else _spare(limit, middle, reach, digits),
            )
        )
    return tuple(rows)


def _spare(limit: tuple[float, float], middle: float, reach: float, digits: int) -> str:
    """Room between a range and the goal's limits, rounded down; negative if it leaves the goal."""
    room = min(limit[0] - (middle - reach), middle + reach - limit[1])
    return signed(down(room, digits))


def policy_rows(result: Planned) -> list[tuple[str, ...]]:
    """What to command in each move, from the pose sensed before it: the move, then five commands."""
    return [
        (
            " · ".join(filter(None, (str(number), title(result, number - 1), _axes(rule)))),
            command("x", rule.dual_x),
            command("y", rule.dual_y),
            command("x", rule.dual_end_x),
            command("x", rule.single_x),
            command("y", rule.single_y),
        )
        for number, rule in enumerate(result.certificate.policy, start=1)
    ]


def _axes(rule: RuleDocument) -> str:
    if rule.heading == "-x" and not rule.mirrored:
        return ""
    push = f"pushes along {rule.heading.replace('-', MINUS)} of the world"
    return f"{push}, y mirrored" if rule.mirrored else push


def nominal_rows(result: Planned) -> list[tuple[str, ...]]:
    """What the hardware does when every error is zero: move, probes, their starts, travel, speed."""
    line = Markup("<br>")
    return [
        (
            f"{number} · {title(result, number - 1)}",
            line.join(
                pages.code(f"{probe.name}{' (passive)' if probe.passive else ''}")
                for probe in move.probes
            ),
            line.join(point(probe.start_um) for probe in move.probes),
            point(move.travel_um),
            f"{move.speed_um_s:g}",
        )
        for number, move in enumerate(result.plan.moves, start=1)
    ]
