"""What to record next: the push that would tell apart what these recordings do not."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from meso_robust.diagnosis.rival_pushes import Rival, best_push
from meso_robust.diagnosis.trials import tried

if TYPE_CHECKING:
    from meso_robust.diagnosis.candidates import Candidate
    from meso_robust.diagnosis.diagnose import Diagnosis

UM = 1e6
ALIKE = 3.0
"""σ of all frames together, below which no push is said to tell two answers apart."""


def next_experiment(found: Diagnosis) -> dict[str, object]:
    """Section ``next_experiment`` of the document."""
    answers = found.naming.answers if found.naming else ()
    if len(answers) > 1:
        return _telling(found, answers[0], answers[1])
    if found.naming is not None and not answers:
        worst = next((t for t in found.detection.tests if t.recording >= 0), None)
        file = found.baseline.prepared.files[worst.recording] if worst else "the worst push"
        what = f"repeat {file} at another speed, at another place, and with the part turned by 180°"
        return {"why": "to see which invariance the unknown effect breaks", "push": {"what": what}}
    unseen = sorted((one for one in found.visible if not one.seen), key=lambda one: one.sigma)
    if unseen:
        effect = unseen[0].effect
        return {
            "why": f"these recordings could not show {effect}",
            "push": {"what": tried(effect).shown_by},
        }
    return {"why": "nothing is open", "push": {"what": ""}}


def _telling(found: Diagnosis, first: Candidate, second: Candidate) -> dict[str, object]:
    """The push on which the two best answers differ most, if they do on any."""
    names = [" + ".join(one.effects) for one in (first, second)]
    rival = best_push(
        found.baseline.prepared,
        (
            (first.refit.model, first.refit.fits.values[0]),
            (second.refit.model, second.refit.fits.values[0]),
        ),
        found.noise.sigma,
        found.noise.correlation,
    )
    if rival is not None and rival.sigma >= ALIKE:
        why = (
            f"to tell {names[0]} from {names[1]}, which would differ by {rival.sigma:.2g} σ on "
            f"this push"
        )
        return {"why": why, "push": _push(rival)}
    effect = next((e for e in first.effects if e not in second.effects), first.effects[0])
    if rival is None:
        why = f"to tell {names[0]} from {names[1]}; no push could be simulated under both"
    else:
        why = (
            f"no push on this stage tells {names[0]} from {names[1]}: of those simulated none makes "
            f"a difference of more than {max(rival.sigma, 0.01):.2g} σ"
        )
    return {"why": why, "push": {"what": tried(effect).shown_by}}


def _push(one: Rival) -> dict[str, object]:
    x, y, theta = UM * one.start[0], UM * one.start[1], np.degrees(one.start[2])
    return {
        "edge": one.edge,
        "place": one.place,
        "slant_deg": round(float(np.degrees(one.slant)), 6),
        "speed_um_s": round(UM * one.speed, 3),
        "travel_um": round(UM * one.travel, 3),
        "what": (
            f"push edge {one.edge} with the part at x = {x:.0f} µm, y = {y:.0f} µm, θ = {theta:.0f}°; "
            "leave the camera running for a second before, and after drawing the tip back"
        ),
    }
