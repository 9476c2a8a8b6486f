"""Numbers that no proof rests on must still be ones that can be: counts of runs among each other."""

from __future__ import annotations

from meso_robust.checker.document import Certificate
from meso_robust.checker.ids import place
from meso_robust.checker.refusal import Refused


def check_evidence(certificate: Certificate) -> None:
    """Compare counts that are parts of each other.

    Raises
    ------
    Refused
        A part exceeds its whole.
    """
    told, moves = certificate.simulation, len(certificate.policy)
    proved = certificate.verdict == "PROVED"  # then the box lies in the goal
    for part, whole in (
        ("completed", "samples"),
        ("in_goal", "completed"),
        ("in_certified_box", "in_goal" if proved else "samples"),
    ):
        most, own = getattr(told, whole), getattr(told, part)
        if own is not None and own > most:
            raise Refused(
                place(f"simulation.{part}"), own, f"at most {most}, of simulation.{whole}"
            )
    count = len(told.largest_excess_um_um_deg)
    if count > moves:
        raise Refused(place("simulation.largest_excess_um_um_deg"), count, f"at most {moves}")
    undecided = certificate.undecided
    if undecided is not None and undecided.move > moves:
        raise Refused(place("undecided.move"), undecided.move, f"1 to {moves}")
