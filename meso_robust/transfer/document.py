"""``premises.json``: what a fitted model made of a task, and whether the promise still holds."""

from __future__ import annotations

from typing import Literal

from pydantic import BaseModel, ConfigDict, Field

from meso_robust.bounds import VerdictWord
from meso_robust.transfer.assumption_check import Word

Pair = tuple[float, float]


class _Model(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class ModelMade(_Model):
    """The model."""

    name: str
    """Base and effects, as in `model.toml`."""
    sha256: str
    """SHA-256 of its values, independent of layout."""
    recordings_sha256: str
    """SHA-256 of the recordings that the model was fitted to."""
    confidence: float | None
    """Confidence level of each interval, taken alone."""


class ChangeMade(_Model):
    """A value of the task before and after."""

    key: str
    """Key of the task."""
    before: str
    """Its value as the task stated it."""
    after: str
    """Its value with the model."""
    because: str
    """Parameter or effect that changed it."""


class StandingMade(_Model):
    """A parameter or an effect, and the premise that it affects."""

    name: str
    """The parameter or effect."""
    standing: Word
    """What becomes of it in the proof."""
    premise: str | None
    """Id of the premise of the proof; null if none is concerned."""
    premise_words: str
    """The premise in words."""
    claim: str
    """Key in the register of claims (``meso-robust derive``)."""
    derivation: str
    """File in which the claim is derived."""
    said: str
    """The bound that absorbs it, or why it cannot be absorbed."""


class BeyondMade(_Model):
    """What is claimed beyond the changed task, proved by ``plan`` and not looked at by ``check``."""

    claim: str
    """The claim in words."""
    verdict: VerdictWord
    """Verdict on this claim."""
    open: str
    """The first inequality that is not proved; empty if it is PROVED."""


class EvidenceMade(_Model):
    """Runs in the simulator under the model's own physics: evidence, not proof."""

    runs: int
    """Random runs."""
    seed: int
    """Seed of all draws."""
    completed: int
    """Runs that carried out all moves."""
    in_goal: int
    """Runs that ended in the goal."""
    worst_miss_um: float
    """Largest distance of a completed run's x or y outside the goal, um."""
    worst_miss_deg: float
    """Largest distance of a completed run's orientation outside the goal, deg."""
    endings: dict[str, int]
    """Number of the other runs by how they ended."""


class PremisesDocument(_Model):
    """Result of re-certification with a fitted model."""

    schema_: Literal["meso-robust/premises/1"] = Field(
        default="meso-robust/premises/1", alias="schema"
    )
    """Name and version of the format."""
    verdict: VerdictWord
    """Verdict on the plan with the model."""
    why: str
    """Why it is not PROVED; empty if it is."""
    model: ModelMade
    """The model."""
    task_hash_before: str
    """Hash of the task as it was stated."""
    task_hash: str
    """Hash of the changed task, which the certificate is about."""
    changes: tuple[ChangeMade, ...]
    """What the model changed in the task."""
    standings: tuple[StandingMade, ...]
    """What becomes of each parameter and effect in the proof."""
    conditions: tuple[str, ...]
    """What the laboratory must also observe, besides the certificate's premises."""
    beyond: BeyondMade | None
    """A claim for a range of parts; null if the model leaves the part as it is."""
    evidence: EvidenceMade | None
    """Runs under the model's own physics; null if there were none."""
    no_evidence: str
    """Why there were no runs under the model's own physics."""
    caution: tuple[str, ...]
    """What to keep in mind, one sentence each."""
