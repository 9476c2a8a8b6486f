"""Admissible sets: where a primitive may push, from which start, as proved pavings."""

from meso_robust.feasible_regions.maps import (
    PRIMITIVES as PRIMITIVES,
    Map as Map,
    Primitive as Primitive,
    admissible_offsets as admissible_offsets,
    map_of as map_of,
    moves_of as moves_of,
)
from meso_robust.feasible_regions.paving import (
    Axis as Axis,
    Paving as Paving,
    Region as Region,
    pave as pave,
    pave_line as pave_line,
)
