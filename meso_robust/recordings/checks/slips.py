"""Signs, axes and clocks that, put right, bring the tips to the part that they push."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from meso_robust.recordings.checks.view import View
from meso_robust.recordings.direct.causes import likely_cause
from meso_robust.recordings.document import SET_FILE
from meso_robust.recordings.problem import Problem


def slip_problems(views: Sequence[View]) -> list[Problem]:
    """Say what would bring the tips to the part while it moves.

    A mirrored or exchanged axis is an error; a delay or a shift is a warning, as a fit can find it.

    Parameters
    ----------
    views
        All recordings of a set, without poses that are no measurement.

    Returns
    -------
    list of Problem
        One or none.
    """
    if not views:
        return []
    recordings = tuple(view.recording for view in views)
    cause = likely_cause(replace(views[0].recordings, recordings=recordings))
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
