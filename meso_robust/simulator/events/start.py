"""Start of a run: take the part out of what it overlaps by a rounding error, refuse more."""

from meso_robust.simulator.events.balance import fill
from meso_robust.simulator.events.choice import add_row
from meso_robust.simulator.events.contact import gap, list_touching, place_of
from meso_robust.simulator.events.fused import sealed
from meso_robust.simulator.events.phase import project
from meso_robust.simulator.events.scene import (
    FIRST,
    HELD,
    KIND,
    POINT,
    SECOND,
    TOUCHING,
    Scene,
    Work,
)
from meso_robust.simulator.events.search import clearance

_DEEP = 1e-5  # overlap that is taken back
_LEFT = 1e-10  # and what may be left of it
_ROUNDS = 4  # of pushing back: out of one wall may be into another


@sealed
def settle(scene: Scene, work: Work) -> bool:
    """Take the part back by small overlaps, and tell whether nothing overlaps then."""
    for _ in range(_ROUNDS):
        place = place_of(work)
        list_touching(scene, work, place, 0.0, (0.0, _DEEP))
        if work.count[TOUCHING] == 0:
            break
        work.count[HELD] = 0
        for c in range(work.count[TOUCHING]):
            kind, i, j = work.contact[c, KIND], work.contact[c, FIRST], work.contact[c, SECOND]
            if kind != POINT and gap(scene, kind, i, j, place, 0.0) < 0.0:
                fill(scene, work, c, place, 0.0)
                add_row(work, 2 * c)
        project(scene, work, 0.0)
    work.count[HELD] = 0
    return _is_free(scene, work)


@sealed
def _is_free(scene: Scene, work: Work) -> bool:
    """Tell whether no tip is in the part and no corner in the fixture."""
    place = place_of(work)
    scene.left_out[:] = False
    for body in range(scene.clear.shape[0]):
        if not clearance(scene, work, body, place, 0.0) >= -_LEFT:
            return False
    return True
