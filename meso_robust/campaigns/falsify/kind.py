"""The kind *falsify*."""

from __future__ import annotations

from meso_robust.campaigns.falsify.adding import total
from meso_robust.campaigns.falsify.executing import execute
from meso_robust.campaigns.falsify.ready import given, prepare
from meso_robust.campaigns.falsify.section import count
from meso_robust.campaigns.falsify.summary import tell
from meso_robust.campaigns.kind import Kind

FALSIFY = Kind(
    name="falsify",
    unit="executions",
    given=given,
    count=count,
    prepare=prepare,
    execute=execute,
    total=total,
    tell=tell,
)
