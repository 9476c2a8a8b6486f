"""Where the named physics should not help: spans in which both models predict the same.

There the error cannot change by more than the models differ; what it says is its size. At the noise
floor, the plain model was right where the named physics is not at work; above it, something else is
missing there.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from meso_robust.diagnosis.detect import Span
from meso_robust.diagnosis.validation import Errors
from meso_robust.types import Floats

SAME = 0.2
"""σ: predictions that differ by less in every frame of a span are the same."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Control:
    """Errors of both models in the spans where they predict the same.

    Attributes
    ----------
    spans
        Their number.
    sigma_before, sigma_after
        Root mean squares of seen less predicted, in σ.
    """

    spans: int
    sigma_before: float
    sigma_after: float


def control(
    pairs: Sequence[tuple[tuple[Span, ...], Errors, Errors]], sigma: Floats
) -> Control | None:
    """Compare both models where they predict the same; None if they do so nowhere.

    Parameters
    ----------
    pairs
        Of each group of recordings its spans, and the errors of the plain and of the extended model.
    sigma
        (3,) standard deviations of the noise, m and rad.
    """
    squares, count, spans = np.zeros(2), 0, 0
    for own, before, after in pairs:
        seen = before.prepared.seen
        for span in own:
            at = (span.recording, slice(span.first, span.last))
            models = [before.poses[at] / sigma, after.poses[at] / sigma]
            apart = np.abs(models[0] - models[1])
            known = np.isfinite(apart)
            if not np.any(known) or np.max(apart[known]) >= SAME:
                continue
            away = [(seen[at] / sigma - one)[known] for one in models]
            squares += [one @ one for one in away]
            count += int(known.sum())
            spans += 1
    if not spans:
        return None
    before_sigma, after_sigma = np.sqrt(squares / count)
    return Control(spans=spans, sigma_before=float(before_sigma), sigma_after=float(after_sigma))
