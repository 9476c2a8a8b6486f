"""Small sets and their quick diagnoses, which many tests look at."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from meso_robust.diagnosis.baseline import Baseline, fitted_baseline
from meso_robust.diagnosis.diagnose import Diagnosis, diagnose
from meso_robust.diagnosis.noise import noise_of
from meso_robust.recordings import RecordingSet
from tests.diagnosis.designs import Given, random_plans, recorded_plans
from tests.identification.sets import UM


def small_set(effects: Given | None, count: int = 8, seed: int = 3) -> RecordingSet:
    """Pushes of 3 s and of 6 s."""
    rng = np.random.default_rng(seed)
    return recorded_plans(random_plans(rng, count, (75 * UM, 225 * UM)), rng, effects)


@pytest.fixture(scope="session")
def null_set() -> RecordingSet:
    """A film and Coulomb's friction at the tip, nothing else, by the event-driven engine."""
    return small_set(None)


@pytest.fixture(scope="session")
def null_store(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Where the diagnosis of that set keeps its long steps."""
    return tmp_path_factory.mktemp("diagnosis") / "store"


@pytest.fixture(scope="session")
def null(null_set: RecordingSet, null_store: Path) -> Diagnosis:
    """Its diagnosis."""
    return diagnose(null_set, quick=True, store=null_store)


@pytest.fixture(scope="session")
def late() -> Diagnosis:
    """Diagnosis of pushes that the camera shows 60 ms late."""
    return diagnose(small_set({"camera_latency": {"time_ms": 60.0}}), quick=True)


@pytest.fixture(scope="session")
def pulled() -> Baseline:
    """The plain model fitted to pushes of a part that a force drags along x."""
    recordings = small_set({"body_force": {"x_um_s": 3.0}}, 5)
    return baseline_of(recordings)


def baseline_of(recordings: RecordingSet) -> Baseline:
    """The plain model fitted to all recordings."""
    noise = noise_of(recordings)
    return fitted_baseline(recordings, noise, "viscous", quick=True, seed=0, told=lambda *_: None)


def coloured(baseline: Baseline, correlation: float, freedom: float = np.inf) -> Baseline:
    """The same fit with noise of a known colour, and of a σ known so well."""
    return replace(
        baseline,
        noise=replace(
            baseline.noise, correlation=correlation, correlation_error=0.0, freedom=freedom
        ),
        tangent=replace(baseline.tangent, correlation=correlation),
    )


def regraded(found: Diagnosis, **changes: Any) -> Diagnosis:
    """The diagnosis with another verdict on what is explained out of fold."""
    return replace(found, grade=replace(found.grade, **changes))
