"""What the README and the pages beside it show runs."""

import re
from pathlib import Path

import numpy as np

ROOT = Path(__file__).parent.parent
README, SIMULATOR = ROOT / "README.md", ROOT / "meso_robust" / "guide" / "simulator.md"


def test_the_example_of_the_simulator_runs_and_turns_the_part() -> None:
    blocks = re.findall(r"```python\n(.*?)```", SIMULATOR.read_text(encoding="utf-8"), re.DOTALL)
    (code,) = [block for block in blocks if "meso_robust.simulator" in block]
    names: dict[str, object] = {}
    exec(code, names)
    result = names["result"]
    assert result.outcomes.tolist() == [0]  # type: ignore[attr-defined]
    # Pushed above its centre towards -x, the part turns counter-clockwise and follows.
    assert result.poses[0, 2] > np.radians(5)  # type: ignore[attr-defined]
    assert -600e-6 < result.poses[0, 0] < -300e-6  # type: ignore[attr-defined]


def test_files_that_the_readme_points_to_exist() -> None:
    links = re.findall(r"\]\(([\w./-]+)\)", README.read_text(encoding="utf-8"))
    assert len(links) >= 5
    for link in links:
        assert (README.parent / link).exists(), link
