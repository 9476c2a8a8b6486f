"""The guide to adding an effect adds one."""

from __future__ import annotations

import json
from pathlib import Path

from meso_robust.simulator.catalogue import CATALOGUE
from reports.guide.adding_an_effect import TOY, followed, run, steps

_LOOK = """
import json
import numpy as np
import meso_robust
from meso_robust.diagnosis.trials import tried
from meso_robust.transfer.lines import LINES
from meso_robust.simulator.catalogue import CATALOGUE, stage_of
from meso_robust.simulator.effects import Effects
from meso_robust.simulator.observation import observe

poses = np.array([[[1e-3, 2e-3, 0.5], [1e-3, 2e-3, 0.5]]])
seen, _ = observe(
    np.array([0.0, 1.0]), poses, np.zeros((1, 2, 0, 2)),
    Effects({"camera_aspect": {"percent": 1.0}}).table, probes_seen_by_camera=False,
)
print(json.dumps({
    "file": meso_robust.__file__,
    "effects": len(CATALOGUE),
    "stage": stage_of("camera_aspect").name,
    "shown_by": tried("camera_aspect").shown_by,
    "premise": "camera_aspect" in LINES,
    "seen": seen[0, 0].tolist(),
}))
"""


def test_a_toy_effect_is_added_by_the_steps_of_the_guide(tmp_path: Path) -> None:
    assert len(steps()) == 4
    followed(tmp_path)
    found = json.loads(run(_LOOK, tmp_path))
    assert found["file"].startswith(str(tmp_path))
    assert found["effects"] == len(CATALOGUE) + 1
    assert found["stage"] == "observation"
    assert found["shown_by"] == "long pushes along x and along y"
    assert found["premise"] is False
    assert (
        max(abs(a - b) for a, b in zip(found["seen"], [1.01e-3, 1.98e-3, 0.5], strict=True)) < 1e-15
    )


def test_the_toy_is_not_in_the_catalogue() -> None:
    assert TOY not in CATALOGUE
