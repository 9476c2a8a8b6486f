"""Sets and fits that several tests look at."""

from __future__ import annotations

import numpy as np
import pytest

from meso_robust.identification.identify import Identification, identify
from meso_robust.recordings import RecordingSet
from meso_robust.simulator import Film
from tests.identification.sets import random_pushes, recorded

RHO, MU = 0.3769e-6, 0.33


@pytest.fixture(scope="session")
def film_set() -> RecordingSet:
    """Six pushes on a film, with noise and lost frames, by the event-driven engine."""
    rng = np.random.default_rng(11)
    return recorded(random_pushes(rng, 6), Film.ratio(np.full(6, RHO)), MU, rng)


@pytest.fixture(scope="session")
def film_fit(film_set: RecordingSet) -> Identification:
    """The viscous model fitted to it."""
    return identify(film_set, starts=4)
