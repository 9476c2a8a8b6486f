"""A campaign as a user states it, checked, with everything that its files hold."""

from __future__ import annotations

import functools
import operator
from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Annotated, Any, Literal, Self

from pydantic import BaseModel, ConfigDict, Field, create_model, model_validator

from meso_robust.campaigns.encoding import canonical, digest, slug
from meso_robust.campaigns.kind import Part, Section, Values
from meso_robust.campaigns.kinds import KINDS, kind_of, section_of
from meso_robust.toml_files import checked, read_toml

_ADVICE = "give a campaign file"
_KEYS = "`meso-robust schema campaign`"


class Stated(BaseModel):
    """A campaign as its file states it, whatever the keys of its parts."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True)

    schema_: Annotated[Literal["meso-robust/campaign/1"], Field(alias="schema")]
    """Name and version of the format."""
    name: Annotated[str, Field(min_length=1, max_length=200)]
    """What the campaign is called in answers and reports."""
    seed: Annotated[int, Field(ge=0, lt=2**63)] = 0
    """Seed of all random numbers."""
    confidence: Annotated[float, Field(gt=0.5, lt=1)] = 0.95
    """Confidence level of all intervals."""
    chunk_limit_s: Annotated[float, Field(gt=0, le=1e6)] = 3600.0
    """Time limit of a chunk, s: one that takes longer is stopped, tried again, and then reported."""
    part: tuple[Section, ...]
    """The parts of the campaign, run one after another."""

    @model_validator(mode="after")
    def _each_name_once(self) -> Self:
        slugs = [slug(part.name) for part in self.part]
        twice = [part.name for part in self.part if slugs.count(slug(part.name)) > 1]
        if twice:
            raise ValueError(
                f"part name {twice[0]!r} is given twice, or another one has the same letters and "
                "digits; give each part its own name"
            )
        return self


def campaign_document(kinds: Iterable[str] = KINDS) -> type[Stated]:
    """The model of a campaign file whose parts are of some kinds."""
    # annotations made at run time, which no type checker can follow
    annotated: Any = Annotated
    series: Any = tuple
    each = functools.reduce(operator.or_, map(section_of, sorted(kinds)))
    parts = series[annotated[each, Field(discriminator="kind")], ...]
    one_or_more = Field(min_length=1)
    found: type[Stated] = create_model(
        "CampaignDocument",
        __base__=Stated,
        __doc__="``CAMPAIGN.toml``.",
        part=(parts, one_or_more),
    )
    return found


@dataclass(frozen=True, slots=True, kw_only=True)
class Campaign:
    """A campaign with everything that its chunks need."""

    name: str
    seed: int
    confidence: float
    chunk_limit_s: float
    parts: tuple[Part, ...]
    text: str
    """The file as its author wrote it."""

    @property
    def values(self) -> Values:
        """What the results depend on, as JSON values."""
        return {"parts": [asdict(part) for part in self.parts]}

    @property
    def hash(self) -> str:
        """SHA-256 of ``values``."""
        return digest(canonical(self.values))


def read_campaign(path: Path, seed: int | None = None) -> Campaign:
    """Read a campaign and all files that it names.

    Parameters
    ----------
    path
        The campaign file; files it names are relative to its folder.
    seed
        Instead of the one in the file.

    Returns
    -------
    Campaign
        Its parts with all that their chunks need: no file is read after this.

    Raises
    ------
    InputError
        A file cannot be read or a value breaks a rule.
    """
    values = read_toml(path, _ADVICE)
    model = campaign_document(_kinds_in(values) or KINDS)
    stated = checked(model, values, str(path), whole="campaign", keys=_KEYS)
    chosen = stated.seed if seed is None else seed
    return Campaign(
        name=stated.name,
        seed=chosen,
        confidence=stated.confidence,
        chunk_limit_s=stated.chunk_limit_s,
        parts=tuple(
            _part(section, chosen, stated.confidence, path.parent) for section in stated.part
        ),
        text=path.read_text(encoding="utf-8"),
    )


def _kinds_in(values: Values) -> set[str]:
    """The kinds that a campaign file names, all of them if it names an unknown one."""
    parts = values.get("part")
    if not isinstance(parts, list):
        return set()
    named = {str(part.get("kind")) for part in parts if isinstance(part, dict)}
    return named if named <= set(KINDS) else set()


def _part(section: Section, seed: int, confidence: float, folder: Path) -> Part:
    asked: Mapping[str, Any] = section.model_dump(mode="json")
    kind = kind_of(asked["kind"])
    return Part(
        name=section.name,
        kind=kind.name,
        # by name, so that parts may be moved, added and left out
        seed=int(digest(f"{seed}\0{section.name}")[:15], 16),
        confidence=confidence,
        asked=asked,
        given=kind.given(section, folder),
    )
