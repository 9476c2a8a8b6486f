"""``premises.json``: what a fitted model made of a task, and whether the promise still holds."""

from __future__ import annotations

from typing import Literal

from pydantic import BaseModel, ConfigDict, Field

from meso_robust.bounds import VerdictWord
from meso_robust.premises.standing import Word

Pair = tuple[float, float]


class _Model(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class ModelMade(_Model):
    """The model."""

    name: str
    sha256: str
    """Of its values, independent of layout."""
    recordings_sha256: str
    confidence: float | None
    """Of each interval, by itself."""


class ChangeMade(_Model):
    """A value of the task before and after."""

    key: str
    before: str
    after: str
    because: str


class StandingMade(_Model):
    """A parameter or an effect, and the premise that it bears on."""

    name: str
    standing: Word
    premise: str
    claim: str
    """Key in the register of claims (``meso-robust derive``)."""
    derivation: str
    said: str


class BeyondMade(_Model):
    """What is claimed beyond the changed task, proved by ``plan`` and not looked at by ``check``."""

    claim: str
    verdict: VerdictWord
    open: str
    """The first inequality that is not proved; empty if it is PROVED."""


class EvidenceMade(_Model):
    """Runs in the simulator under the model's own physics: evidence, not proof."""

    runs: int
    seed: int
    completed: int
    in_goal: int
    worst_miss_um: float
    worst_miss_deg: float
    endings: dict[str, int]


class PremisesDocument(_Model):
    """What became of the promise."""

    schema_: Literal["meso-robust/premises/1"] = Field(
        default="meso-robust/premises/1", alias="schema"
    )
    verdict: VerdictWord
    why: str
    """Why it is not PROVED; empty if it is."""
    model: ModelMade
    task_hash_before: str
    task_hash: str
    """Of the changed task, which the certificate is about."""
    changes: tuple[ChangeMade, ...]
    standings: tuple[StandingMade, ...]
    conditions: tuple[str, ...]
    """What the laboratory must keep to beside the certificate's assumptions."""
    beyond: BeyondMade | None
    evidence: EvidenceMade | None
    no_evidence: str
    """Why there were no runs under the model's own physics."""
    caution: tuple[str, ...]
