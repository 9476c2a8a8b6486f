"""The properties; a new one is its own file below ``laws``, and one line here."""

from __future__ import annotations

from collections.abc import Mapping

from meso_robust.campaigns.property.law import Property
from meso_robust.campaigns.property.laws import (
    certified,
    certified_units,
    convergence,
    formulas,
    mirrored_task,
    same_path,
    sticking,
    two_sided,
)

PROPERTIES: Mapping[str, Property] = {
    one.name: one
    for one in (
        formulas.VALUES,
        formulas.INTERVALS,
        formulas.BALLS,
        sticking.STICKING,
        two_sided.ROTATION,
        convergence.CONVERGENCE,
        same_path.DRAG,
        same_path.UNITS,
        same_path.MIRRORED,
        certified.CERTIFIED,
        certified.FAILING,
        certified.PLANNED,
        mirrored_task.CERTIFICATE,
        mirrored_task.PLAN,
        certified_units.UNITS,
    )
}
