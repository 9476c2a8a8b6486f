"""What to record next: the push that would tell apart what these recordings do not."""

from __future__ import annotations

from typing import TYPE_CHECKING

from meso_robust.diagnosis.trials import tried

if TYPE_CHECKING:
    from meso_robust.diagnosis.diagnose import Diagnosis


def next_experiment(found: Diagnosis) -> dict[str, object]:
    """Section ``next_experiment`` of the document."""
    answers = found.naming.answers if found.naming else ()
    if len(answers) > 1:
        names = " from ".join(" + ".join(one.effects) for one in answers[:2])
        effect = next(
            (e for e in answers[0].effects if e not in answers[1].effects), answers[0].effects[0]
        )
        return {"why": f"to tell {names}", "push": {"what": tried(effect).shown_by}}
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
