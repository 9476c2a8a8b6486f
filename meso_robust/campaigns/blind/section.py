"""The keys of a part of the kind *blind*."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from meso_robust.campaigns.kind import Section


class BlindSection(Section):
    """A corpus of recording sets in which something is concealed, each diagnosed once."""

    kind: Literal["blind"]
    """The kind: recordings are diagnosed whose labels are opened afterwards."""
    corpus: Annotated[str, Field(min_length=1)]
    """Folder of the corpus, relative to the campaign file; every worker must reach it."""
    quick: bool = False
    """Whether the quick form of the diagnosis is asked for."""
