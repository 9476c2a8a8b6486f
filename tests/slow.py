"""What only ``make test-all`` runs, and the code that each line is about.

A line is about tests that take long and repeat, at length, what shorter ones say as well. Where the code
of a line differs from the last commit, ``make test`` runs its tests too.
"""

from __future__ import annotations

import subprocess
from collections.abc import Mapping
from pathlib import Path

ROOT = Path(__file__).parents[1]

SLOW: Mapping[str, tuple[str, ...]] = {
    "tests/api/test_story.py": ("meso_robust/api",),
    "tests/blind": ("reports/blind", "meso_robust/diagnosis", "meso_robust/simulator"),
    "tests/campaigns": ("meso_robust/campaigns", "meso_robust/laboratory", "meso_robust/checker"),
    "tests/certificates/test_design.py": ("meso_robust/certificates", "meso_robust/planning"),
    "tests/cli/test_bad_input.py": ("meso_robust/api", "meso_robust/cli", "meso_robust/reading.py"),
    "tests/cli/test_campaign.py": ("meso_robust/campaigns", "meso_robust/cli"),
    "tests/cli/test_drive.py": ("meso_robust/policy", "meso_robust/cli"),
    "tests/cli/test_manners.py": ("meso_robust/cli", "meso_robust/files.py"),
    "tests/cli/test_terminal.py": ("meso_robust/cli",),
    "tests/cli/test_track.py": ("meso_robust/tracking", "meso_robust/cli"),
    "tests/derivations": ("derivations", "meso_robust/_generated"),
    "tests/guide/test_extending.py": ("meso_robust/guide", "meso_robust/identification"),
    "tests/guide/test_tutorial.py": ("meso_robust/guide", "meso_robust/cli", "meso_robust/example"),
    "tests/laboratory/test_misalignment.py": ("meso_robust/laboratory", "meso_robust/policy"),
    "tests/packaging/test_package.py": ("pyproject.toml", "Makefile"),
    "tests/reporting/test_browser.py": ("meso_robust/reporting",),
    "tests/reporting/test_view_page.py": ("meso_robust/reporting",),
    "tests/reporting/test_view_polygons.py": ("meso_robust/reporting",),
    "tests/reproduction": ("meso_robust/reproduction",),
    "tests/test_browser.py": ("meso_robust/reporting",),
    "tests/test_reality.py": ("meso_robust/tracking", "meso_robust/identification"),
    "tests/tracking/test_accuracy.py": ("meso_robust/tracking", "meso_robust/microscope"),
    "tests/tracking/test_frames.py": ("meso_robust/tracking", "meso_robust/microscope"),
    "tests/tracking/test_pose.py": ("meso_robust/tracking", "meso_robust/microscope"),
    "tests/tracking/test_probes.py": ("meso_robust/tracking", "meso_robust/microscope"),
    "tests/tracking/test_track.py": ("meso_robust/tracking", "meso_robust/microscope"),
}
"""Tests by path, and the paths of the code that they are about."""

LONGEST = (
    "tests/checker/test_replay.py",
    "tests/blind/test_subset.py",
    "tests/derivations/test_derive.py",
    "tests/guide/test_tutorial.py",
    "tests/checker/test_walls.py",
    "tests/foreign_plant/test_plant.py",
    "tests/planning/test_headings.py",
    "tests/transfer/test_small.py",
    "tests/checker/test_check.py",
    "tests/checker/test_real_parts.py",
    "tests/checker/test_slip.py",
    "tests/feasible_regions/test_maps.py",
    "tests/cli/test_drive.py",
    "tests/live/test_virtual.py",
)
"""Files of half a minute and more, the longest first: begun last, one would keep a worker busy alone."""


def changed() -> tuple[str, ...]:
    """Paths that differ from the last commit; nothing where git does not answer."""
    paths: list[str] = []
    for command in (
        ("diff", "--name-only", "HEAD"),
        ("ls-files", "--others", "--exclude-standard"),
    ):
        done = subprocess.run(
            ["git", *command], cwd=ROOT, capture_output=True, text=True, check=False
        )
        paths += done.stdout.splitlines() if done.returncode == 0 else []
    return tuple(paths)


def is_slow(test: str, touched: tuple[str, ...]) -> bool:
    """Whether a test, by its path, waits for ``make test-all``.

    Parameters
    ----------
    test
        Path of its file below the repository.
    touched
        Paths that have changed.
    """
    return any(
        _within(test, slow)
        and not any(_within(path, one) for one in (*code, slow) for path in touched)
        for slow, code in SLOW.items()
    )


def _within(path: str, folder: str) -> bool:
    return path == folder or path.startswith(f"{folder}/")
