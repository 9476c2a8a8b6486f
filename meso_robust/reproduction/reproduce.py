"""Making items again, one after the other."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import replace

from meso_robust.reproduction.document import Made
from meso_robust.reproduction.item import Setting
from meso_robust.reproduction.items import item


def reproduced(names: Sequence[str], setting: Setting) -> dict[str, Made]:
    """The items of these names, in their order; each has the seed of the setting."""
    made = {}
    for name in names:
        one = item(name)
        begun = time.perf_counter()

        def told(what: str, done: int, of: int, of_item: str = name) -> None:
            setting.told(f"{of_item}: {what}", done, of)

        told("begins", 0, 1)
        found = one.run(replace(setting, told=told))
        made[name] = Made(name=name, item=one, found=found, seconds=time.perf_counter() - begun)
    return made
