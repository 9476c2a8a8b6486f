"""The kinds of campaigns; a kind is its own file or folder, and one line here."""

from __future__ import annotations

from collections.abc import Mapping

from meso_robust.campaigns.blind.kind import BLIND
from meso_robust.campaigns.kind import Kind
from meso_robust.campaigns.monte_carlo import MONTE_CARLO
from meso_robust.campaigns.mutation.kind import MUTATION

KINDS: Mapping[str, Kind] = {kind.name: kind for kind in (MONTE_CARLO, MUTATION, BLIND)}
