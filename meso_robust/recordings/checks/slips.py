"""Signs, axes and clocks that, put right, bring the tips to the part that they push."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from meso_robust.recordings.checks.view import View
from meso_robust.recordings.direct.causes import Cause, likely_cause
from meso_robust.recordings.document import SET_FILE
from meso_robust.recordings.problem import Problem


def slip_of(views: Sequence[View]) -> Cause | None:
    """What would bring the tips to the part while it moves, in all recordings of a set.

    Parameters
    ----------
    views
        Without poses that are no measurement.

    Returns
    -------
    Cause or None
        None where nothing would, or nothing need.
    """
    if not views:
        return None
    recordings = tuple(view.recording for view in views)
    return likely_cause(replace(views[0].recordings, recordings=recordings))


def slip_problems(cause: Cause | None) -> list[Problem]:
    """Say what would bring the tips to the part while it moves.

    A mirrored or exchanged axis is an error; a delay or a shift is a warning, as a fit can find it.

    Parameters
    ----------
    cause
        From `slip_of`.

    Returns
    -------
    list of Problem
        One or none.
    """
    if cause is None:
        return []
    return [
        Problem(
            file=SET_FILE,
            kind="frames",
            severity="warning" if cause.fitted else "error",
            value=f"while the part moves, the nearest tip is {1e6 * cause.before:.4g} µm from its "
            "outline, median of all recordings",
            rule=f"it would be {1e6 * cause.after:.3g} µm if {cause.words}",
            advice=cause.advice,
        )
    ]
