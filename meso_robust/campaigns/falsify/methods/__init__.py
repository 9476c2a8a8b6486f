"""Ways to search; a new one is a file here and a line in ``SEARCHES``."""

from __future__ import annotations

from collections.abc import Mapping

from meso_robust.campaigns.falsify.budgeted_search import Method
from meso_robust.campaigns.falsify.methods.climb import coordinate_climb
from meso_robust.campaigns.falsify.methods.cma_es import cma_es
from meso_robust.campaigns.falsify.methods.corner_walk import corner_walk
from meso_robust.campaigns.falsify.methods.face_walk import face_walk
from meso_robust.campaigns.falsify.methods.splitting import splitting

SEARCHES: Mapping[str, Method] = {
    "climb": coordinate_climb,
    "corner-walk": corner_walk,
    "face-walk": face_walk,
    "cma-es": cma_es,
    "splitting": splitting,
}
