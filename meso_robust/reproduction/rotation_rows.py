"""Table IV side by side: rotation between an active and a passive tip."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from meso_robust.reproduction.item import Row, Value, span
from meso_robust.reproduction.primitive_runs import turned_deg
from meso_robust.reproduction.rotation_runs import (
    CORRECTED_UM,
    PRINTED_SEPARATION_UM,
    PUSH_UM,
    Rotations,
)
from meso_robust.types import Floats

TRIALS = {"x": (370.0, 434.0), "y": (14.0, 34.0), "theta": (88.0, 90.0)}
"""Smallest and largest of the printed trials: um, um, deg."""
SIMULATED = (295.0, 0.05, 90.0)
"""The printed simulation: um, um, deg."""


def table_4(found: Rotations) -> tuple[Row, ...]:
    """Rows of Table IV."""
    stuck, good = found.printed, found.corrected
    return (
        Row(
            quantity="Table IV: least separation without jam, mu = 0.30 to 0.36",
            unit="um",
            printed=PRINTED_SEPARATION_UM,
            ours=found.least_um,
            why="d_w sqrt(1 + mu^2); eq. (10) and the remark after it ask for less.",
        ),
        Row(
            quantity="Table IV: share of trials with 857 um that jam",
            unit="%",
            printed=0.0,
            ours=100.0 * float((~stuck.completed).mean()),
            why="All stated uncertainties. The experiments ended near 90 deg, so their friction or "
            "their separation was not as printed.",
        ),
        Row(
            quantity="Table IV: turn at which they jam",
            unit="deg",
            printed=SIMULATED[2],
            ours=span(stuck.true[:, 2]),
            why="The tips close on the part; no contact mode has a solution. "
            f"{int(np.sum(~np.isfinite(stuck.true[:, 2])))} of {len(stuck.true)} runs leave the "
            "simulator's range there, with no last pose.",
        ),
        Row(
            quantity="Table IV: friction below which 857 um does not jam",
            ours=found.without_jam,
            why="Section X-A: 0.30 to 0.36.",
        ),
        *_three_rows(
            "857 um, push 1100 um, if friction were 0.05 to 0.20",
            SIMULATED,
            found.frictionless,
            "Not the paper's friction: what the printed separation would do if it did not jam.",
        ),
        *_three_rows(
            "separation 890 to 930 um, push 1100 um, no errors",
            SIMULATED,
            found.nominal,
            "Range over separation, gap at the start (1 to 60 um) and friction (0.30 to 0.36): none "
            "is printed for a rotation that does not jam. Theta is kinematic: it follows from the "
            "separation and the push. Y is small only if the part ends level.",
        ),
        *_three_rows(
            "trials with 930 um, push 1100 um, as the camera sees them",
            tuple(TRIALS.values()),
            good.seen,
            f"All stated uncertainties; {100 * float(good.completed.mean()):g} % complete the push.",
        ),
        *_push_rows(found),
    )


def _three_rows(what: str, printed: Sequence[Value], found: Floats, why: str) -> tuple[Row, ...]:
    """Sizes of X, Y and theta."""
    return sizes("Table IV: {}, " + what, printed, [span(size) for size in np.abs(found.T)], why)


def sizes(
    quantity: str,
    printed: Sequence[Value],
    ours: Sequence[Value],
    why: str | Sequence[str],
    names: tuple[str, str, str] = ("X", "Y", "theta"),
    *,
    loose: bool = False,
) -> tuple[Row, ...]:
    """A row for X, Y and theta each, um and deg.

    Parameters
    ----------
    quantity
        In words, with braces for the name.
    printed, ours, why, loose
        As of a `Row`, by axis; one reason for all if it is a text.
    names
        Of the axes.
    """
    reasons = [why] * 3 if isinstance(why, str) else why
    return tuple(
        Row(quantity=quantity.format(name), unit=unit, printed=p, ours=o, why=w, loose=loose)
        for name, unit, p, o, w in zip(
            names, ("um", "um", "deg"), printed, ours, reasons, strict=True
        )
    )


def _push_rows(found: Rotations) -> tuple[Row, ...]:
    return (
        Row(
            quantity="Table IV: turn with 857 um when the push is 1100 um, kinematic",
            unit="deg",
            printed=SIMULATED[2],
            ours=float(turned_deg(PUSH_UM, PRINTED_SEPARATION_UM)),
            why="The turn follows from the push; eq. (11), 89.3 deg, holds only when the tips reach "
            "opposite corners, which a longer push is needed for.",
        ),
        Row(
            quantity="Table IV: largest turn with 930 um, however long the push",
            unit="deg",
            printed=SIMULATED[2],
            ours=float(found.longest[2]),
            why="The part slides along between the tips, so that one of them runs off its edge before "
            "both reach the corners.",
        ),
        Row(
            quantity="Table IV: push that 930 um needs for a lean which t² rights",
            unit="um",
            printed=PUSH_UM,
            ours=found.enough_um,
            why=f"Without errors t² rights the lying part from {found.righted_deg:g} deg; 930 um "
            f"leave {90.0 - float(turned_deg(PUSH_UM, CORRECTED_UM)):.1f} deg after 1100 um.",
        ),
    )
