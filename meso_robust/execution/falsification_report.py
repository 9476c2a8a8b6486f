"""The report of a falsification campaign, written from the totals of what was really run."""

from __future__ import annotations

import functools
from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from meso_robust import units
from meso_robust.execution.claims import Claims
from meso_robust.execution.falsification import (
    KINDS,
    Chunk,
    Extremes,
    Ledger,
    Totals,
    boxes_digest,
)
from meso_robust.execution.judging import EXACT_SLIP, HALVINGS, INSTANTS, ROUNDING, STEPPED_SLIP
from meso_robust.execution.running import STEP

Floats = npt.NDArray[np.float64]
Parts = Sequence[tuple[Chunk, Totals, str]]

NAMES = ("x", "y", "theta")
SCALES = (1.0 / units.UM, 1.0 / units.UM, float(np.degrees(1.0)))


def report(title: str, ledger: Ledger, claims: Claims, command: str) -> str:
    """Markdown: what was run, what was claimed, what broke, how near the runs came.

    Parameters
    ----------
    title
        Name of the plan.
    ledger
        The campaign's file.
    claims
        The certificate as it is now; the extremes of all runs are held against it.
    command
        How the campaign is run.
    """
    parts = list(ledger.chunks())
    blocks = [
        f"# Falsification: {title}",
        _intro(ledger, command),
        "## Executions",
        _executions(parts),
        *_broken_rows(parts),
        "## Claims",
        _claims(parts),
        _how(),
        "## Extremes of all executions",
        _provenance(parts, claims),
        _extremes(parts, claims),
        _drifts(parts, claims),
        "## The adversary",
        *_attacks(ledger),
        "## Uncertainty at which it first succeeds",
        *_thresholds(ledger),
    ]
    return "\n\n".join(block for block in blocks if block) + "\n"


def _intro(ledger: Ledger, command: str) -> str:
    return (
        f"Plan {ledger.identity[:12]} (hash of task and policy). Every execution runs the policy "
        "from sensing to command to motion with all errors drawn, and is held against every claim "
        f"of the certificate. Made by `{command}`; the totals grow with every further call."
    )


def _table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


def _sum(totals: Iterable[Totals]) -> Totals:
    return functools.reduce(Totals.plus, totals, Totals())


def _executions(parts: Parts) -> str:
    rows = []
    for engine in ("events", "stepper"):
        for kind in (*KINDS, "all"):
            found = _sum(
                t for chunk, t, _ in parts if chunk.engine == engine and kind in (chunk.kind, "all")
            )
            if found.runs:
                rows.append(
                    (
                        f"{'event-driven' if engine == 'events' else 'LCP stepper'}",
                        kind,
                        f"{found.runs:,}",
                        f"{sum(found.broken.values())}",
                        f"{found.unfinished}",
                        f"{found.repeated:,}",
                        f"{found.runs / found.seconds:,.0f}",
                    )
                )
    head = (
        "Engine",
        "Draws",
        "Executions",
        "Broken claims",
        "Not finished by the engine",
        "Repeated at smaller steps",
        "Executions/s per process",
    )
    return _table(head, rows)


def _broken_rows(parts: Parts) -> list[str]:
    """Rows that broke a claim, so that anybody can run them again."""
    rows = [
        f"- {chunk.engine}, {chunk.kind}, chunk {chunk.index}: `{' '.join(row)}`"
        for chunk, found, _ in parts
        for row in found.rows
    ]
    return ["Rows that broke a claim:\n\n" + "\n".join(rows)] if rows else []


def _claims(parts: Parts) -> str:
    both = {
        engine: _sum(t for chunk, t, _ in parts if chunk.engine == engine)
        for engine in ("events", "stepper")
    }
    names = {**both["events"].broken, **both["stepper"].broken}
    rows = [
        (
            name,
            *(
                f"{b.broken[name]} of {b.runs:,}" if name in b.broken else "-"
                for b in both.values()
            ),
        )
        for name in names
    ]
    return _table(("Claim", "Broken, event-driven", "Broken, LCP stepper"), rows)


def _how() -> str:
    return (
        f"Tubes are looked at {INSTANTS + 1} instants of every move. A pose of the event-driven "
        f"engine may lie {ROUNDING:g} m or rad outside a box (its rounding; some boxes are that "
        f"tight), and a contact that drifts less than {EXACT_SLIP:g} m sticks. A run of the stepper "
        f"(step {STEP * 1e6:g} um) that seems to break a claim is repeated at half the step, with the "
        "change of its own poses as their accuracy, and so on; it breaks the claim if it still does "
        f"after {HALVINGS} halvings. A contact that drifts less than "
        f"{STEPPED_SLIP:g} steps sticks (the step in which it closes slips). Contacts as claimed: "
        "tilt: the pushing tip meets first, sticks, the other one never touches; straighten: the "
        "first tip sticks until both touch, then both stick; rotate: both tips touch at the end, "
        "the idle one does not. A drift is the distance between where the tip met the part and "
        "where it is after the move; with no more phases than claimed (event-driven engine) it is "
        "zero only if every phase sticks."
    )


def _provenance(parts: Parts, claims: Claims) -> str:
    now = boxes_digest(claims)
    older = sum(found.runs for _, found, digest in parts if digest != now)
    if not older:
        return "All runs were held against the boxes of this certificate, run by run."
    return (
        f"{older:,} of the runs were held, run by run, against an earlier state of the boxes; the "
        "extremes below are those of all runs, held against the boxes of the certificate as it is "
        "now."
    )


def _extremes(parts: Parts, claims: Claims) -> str:
    rows = []
    for engine in ("events", "stepper"):
        found = _sum(t for chunk, t, _ in parts if chunk.engine == engine)
        for k, box in enumerate(claims.posts):
            if box is None or not found.after:
                continue
            rows += [_extreme(engine, k, axis, found, box) for axis in range(3)]
    return _table(
        (
            "Engine",
            "After move",
            "Coordinate",
            "Reached",
            "Certified",
            "Share of the half width, low and high",
            "During the move",
        ),
        rows,
    )


def _extreme(engine: str, k: int, axis: int, found: Totals, box: Floats) -> tuple[str, ...]:
    scale, unit = SCALES[axis], "deg" if axis == 2 else "um"
    reached = np.array(found.after[k])[:, axis]
    middle, half = box[:, axis].mean(), 0.5 * np.ptp(box[:, axis])
    shares = np.abs(reached - middle) / half
    return (
        engine,
        f"{k + 1}",
        f"{NAMES[axis]} ({unit})",
        _range(reached * scale),
        _range(box[:, axis] * scale),
        f"{shares[0]:.3f}, {shares[1]:.3f}",
        _range(_during(found.during, k, axis) * scale),
    )


def _drifts(parts: Parts, claims: Claims) -> str:
    """Largest slip of the contacts that are claimed to stick."""
    found = []
    for engine in ("events", "stepper"):
        slip = _sum(t for chunk, t, _ in parts if chunk.engine == engine).slip
        found += [
            f"{value:.2g} m ({engine}, move {k + 1})"
            for k, (rule, value) in enumerate(zip(claims.rules, slip, strict=False))
            if rule.action in ("tilt", "straighten")
        ]
    return f"Largest drift of a contact that is claimed to stick: {', '.join(found)}."


def _during(during: Extremes, k: int, axis: int) -> Floats:
    return np.asarray(np.array(during[k])[:, axis])


def _range(ends: Floats) -> str:
    return f"{ends[0]:.3f} ... {ends[1]:.3f}"


def _attacks(ledger: Ledger) -> list[str]:
    """For each engine the latest attack."""
    blocks = []
    latest = {line["engine"]: line for line in ledger.lines("attack")}
    for engine, line in latest.items():
        rows = [
            (
                reach["name"],
                f"{reach['value']:.6f} {reach['unit']}",
                f"{reach['limit']:g}",
                f"{reach['evaluations']:,}",
            )
            for reach in line["reaches"]
        ]
        blocks.append(
            f"Engine: {engine}. Each target was raised by itself from random corners, by steps along "
            "the coordinates and by differential evolution. Boxes: 1 is the certified end. `sticks`: "
            "friction that the first contact needs, minus mu. `grasp`: mu minus the friction at "
            f"which the grasp locks. Broken claims at the rows found: {line['broken'] or 'none'}."
        )
        blocks.append(_table(("Target", "Highest found", "Limit", "Executions"), rows))
    return blocks


def _thresholds(ledger: Ledger) -> list[str]:
    lines: dict[str, dict[str, Any]] = {line["wanted"]: line for line in ledger.lines("threshold")}
    rows = []
    for line in lines.values():
        at = line["fails"]
        share = f"{line['certified'] / at:.3f}" if at and line["certified"] else "-"
        rows.append(
            (
                line["wanted"],
                f"{line['holds']:.4f}",
                f"{at:.4f}" if at else "-",
                "; ".join(line["claims"]),
                line["told"],
                f"{line['certified']:.4f}" if line["certified"] else "-",
                share,
            )
        )
    if not rows:
        return []
    head = (
        "What is broken",
        "Nothing found at factor",
        "Found at factor",
        "Claim",
        "The run",
        "Certified margin",
        "Certified over found",
    )
    return [
        "All uncertainties are scaled about their middles at once; the factor is bisected, with an "
        "attack (event-driven engine) at every trial.",
        _table(head, rows),
    ]
