"""What only ``make test-all`` runs, and the code that each line is about.

A line is about tests that take long and repeat, at length, what shorter ones say as well. Where the code
of a line differs from the last commit, ``make test`` runs its tests too. CI asks for ``--recent``: what has
changed within some hours of commits, or some of it where that is nearly everything, and of the other slow tests some,
others with each commit.
"""

from __future__ import annotations

import hashlib
import subprocess
from collections.abc import Mapping
from pathlib import Path

ROOT = Path(__file__).parents[1]

_CHECKED = ("meso_robust/checker", "meso_robust/certificates", "meso_robust/primitives")

SLOW: Mapping[str, tuple[str, ...]] = {
    "tests/api/test_story.py": ("meso_robust/api",),
    "tests/blind": ("reports/blind", "meso_robust/diagnosis", "meso_robust/simulator"),
    "tests/bounds/test_bulk.py::test_bounds_in_bulk_hold_exact_values_inside_on_faces_and_at_corners": (
        "meso_robust/bounds",
        "meso_robust/_generated",
    ),
    "tests/campaigns/blind": ("meso_robust/campaigns", "meso_robust/diagnosis"),
    "tests/campaigns/falsify": ("meso_robust/campaigns", "meso_robust/primitives"),
    "tests/campaigns/mutation": ("meso_robust/campaigns", "meso_robust/checker"),
    "tests/campaigns/property": ("meso_robust/campaigns", "meso_robust/laboratory"),
    "tests/campaigns/test_cluster.py": ("meso_robust/campaigns",),
    "tests/campaigns/test_work.py": ("meso_robust/campaigns",),
    "tests/certificates/test_design.py": ("meso_robust/certificates", "meso_robust/planning"),
    "tests/checker/test_check.py::test_a_refuted_certificate_must_keep_within_the_bounds": _CHECKED,
    "tests/checker/test_guide.py": _CHECKED,
    "tests/checker/test_names.py::test_a_forged_sentence_changes_nothing_that_is_told": _CHECKED,
    "tests/checker/test_real_parts.py": _CHECKED,
    "tests/checker/test_replay.py::test_a_probe_that_starts_inside_the_part_is_found": _CHECKED,
    "tests/checker/test_replay.py::test_no_refutation_exits_as_a_proof_does": _CHECKED,
    "tests/checker/test_replay.py::test_runs_end_where_the_event_driven_engine_takes_them": _CHECKED,
    "tests/checker/test_room.py": _CHECKED,
    "tests/checker/test_rotate.py": _CHECKED,
    "tests/checker/test_slide.py::test_motions_stay_between_the_barriers": _CHECKED,
    "tests/checker/test_slip.py": _CHECKED,
    "tests/checker/test_turned_polygons.py": _CHECKED,
    "tests/checker/test_turns.py": _CHECKED,
    "tests/checker/test_walls.py": _CHECKED,
    "tests/cli/test_bad_input.py": ("meso_robust/api", "meso_robust/cli", "meso_robust/reading.py"),
    "tests/cli/test_campaign.py": ("meso_robust/campaigns", "meso_robust/cli"),
    "tests/cli/test_drive.py": ("meso_robust/policy", "meso_robust/cli"),
    "tests/cli/test_manners.py": ("meso_robust/cli", "meso_robust/files.py"),
    "tests/cli/test_plan.py::test_a_plan_that_fails_is_checked_too": (
        "meso_robust/cli",
        "meso_robust/api",
    ),
    "tests/cli/test_plan_model.py": ("meso_robust/cli", "meso_robust/transfer"),
    "tests/cli/test_plan_polygon.py": ("meso_robust/cli", "meso_robust/planning"),
    "tests/cli/test_terminal.py": ("meso_robust/cli",),
    "tests/cli/test_track.py": ("meso_robust/tracking", "meso_robust/cli"),
    "tests/derivations": ("derivations", "meso_robust/_generated"),
    "tests/diagnosis/test_each_push.py": ("meso_robust/diagnosis", "meso_robust/identification"),
    "tests/diagnosis/test_forms.py": ("meso_robust/diagnosis", "meso_robust/identification"),
    "tests/diagnosis/test_residual.py": ("meso_robust/diagnosis", "meso_robust/identification"),
    "tests/diagnosis/test_stages.py": ("meso_robust/diagnosis", "meso_robust/identification"),
    "tests/feasible_regions/test_maps.py": (
        "meso_robust/feasible_regions",
        "meso_robust/primitives",
    ),
    "tests/feasible_regions/test_turning.py": (
        "meso_robust/feasible_regions",
        "meso_robust/primitives",
    ),
    "tests/foreign_plant": (
        "reports/foreign_plant",
        "meso_robust/motion",
        "meso_robust/primitives",
    ),
    "tests/guide/test_columns.py": ("meso_robust/guide", "meso_robust/recordings"),
    "tests/guide/test_extending.py": ("meso_robust/guide", "meso_robust/identification"),
    "tests/guide/test_tutorial.py": ("meso_robust/guide", "meso_robust/cli", "meso_robust/example"),
    "tests/identification/test_tip_noise.py": ("meso_robust/identification",),
    "tests/laboratory/test_misalignment.py": ("meso_robust/laboratory", "meso_robust/policy"),
    "tests/live/test_virtual.py": ("meso_robust/live", "meso_robust/policy"),
    "tests/motion/test_barrier.py::test_bounds_hold_at_every_point_of_a_stretch": (
        "meso_robust/motion",
    ),
    "tests/motion/test_dry_turn.py": ("meso_robust/motion",),
    "tests/motion/test_two_sided.py::test_a_wrong_sign_is_seen": ("meso_robust/motion",),
    "tests/motion/test_two_sided.py::test_the_tube_of_point_tips_is_not_much_wider_than_the_motions": (
        "meso_robust/motion",
    ),
    "tests/packaging/test_package.py": ("pyproject.toml", "Makefile"),
    "tests/planning/test_headings.py::test_a_plan_with_a_heading_that_the_task_has_no_probe_for_is_refused": (
        "meso_robust/planning",
    ),
    "tests/planning/test_headings.py::test_a_policy_keeps_to_the_stated_headings": (
        "meso_robust/planning",
        "meso_robust/policy",
    ),
    "tests/planning/test_headings.py::test_the_sweep_tells_what_one_start_needs": (
        "meso_robust/planning",
    ),
    "tests/planning/test_unplanned.py::test_what_is_said_to_give_a_plan_gives_one": (
        "meso_robust/planning",
    ),
    "tests/policy/test_build.py::test_the_moves_to_go_fall_whatever_is_sensed": (
        "meso_robust/policy",
        "meso_robust/planning",
    ),
    "tests/example/test_example.py::test_logs_are_of_the_motion_that_the_videos_show": (
        "meso_robust/example",
        "meso_robust/microscope",
    ),
    "tests/policy/test_build.py::test_all_orientations_and_both_kinds_of_move_are_there": (
        "meso_robust/policy",
        "meso_robust/planning",
    ),
    "tests/policy/test_controller.py::test_a_policy_judges_the_next_part_by_its_own_pose": (
        "meso_robust/policy",
    ),
    "tests/recordings/direct": ("meso_robust/recordings",),
    "tests/recordings/test_concealed.py": ("meso_robust/recordings", "meso_robust/diagnosis"),
    "tests/recordings/test_judgement.py": ("meso_robust/recordings",),
    "tests/recordings/test_real_sets.py": ("meso_robust/recordings",),
    "tests/reporting/test_browser.py": ("meso_robust/reporting",),
    "tests/reporting/test_view_page.py": ("meso_robust/reporting",),
    "tests/reporting/test_view_polygons.py": ("meso_robust/reporting",),
    "tests/reporting/test_view_runs.py": ("meso_robust/reporting",),
    "tests/reproduction": ("meso_robust/reproduction",),
    "tests/simulator/test_ambiguity.py": ("meso_robust/simulator",),
    "tests/simulator/test_campaign.py": ("meso_robust/simulator",),
    "tests/simulator/test_guess.py": ("meso_robust/simulator",),
    "tests/test_browser.py": ("meso_robust/reporting",),
    "tests/test_reality.py": ("meso_robust/tracking", "meso_robust/identification"),
    "tests/tracking/test_accuracy.py": ("meso_robust/tracking", "meso_robust/microscope"),
    "tests/tracking/test_frames.py": ("meso_robust/tracking", "meso_robust/microscope"),
    "tests/tracking/test_pose.py": ("meso_robust/tracking", "meso_robust/microscope"),
    "tests/tracking/test_probes.py": ("meso_robust/tracking", "meso_robust/microscope"),
    "tests/tracking/test_track.py": ("meso_robust/tracking", "meso_robust/microscope"),
    "tests/transfer/test_dry.py": ("meso_robust/transfer", "meso_robust/motion"),
    "tests/transfer/test_gradient.py": ("meso_robust/transfer", "meso_robust/motion"),
    "tests/transfer/test_promise.py": ("meso_robust/transfer", "meso_robust/motion"),
    "tests/transfer/test_thinning.py": ("meso_robust/transfer", "meso_robust/motion"),
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


HOURS = 4
"""What has changed within so many hours before the last commit is recent: about half a day of work."""

FOR_ALL = ("requirements.lock", "pyproject.toml", "conftest.py", "tests/conftest.py")
"""What every test rests on."""

EMPTY = "4b825dc642cb6eb9a060e54bf8d69288fbee4904"
"""Git's name of the tree that holds nothing."""

ONE_IN = 12
"""By turns, one in so many slow tests of unchanged code is run."""

MOST = 6
"""Lines of the table that CI runs for what has changed; of more of them it draws about so many."""


def changed(recent: bool = False) -> tuple[str, ...]:
    """Paths that differ from the last commit; nothing where git does not answer.

    Parameters
    ----------
    recent
        From what was committed `HOURS` before the last commit, instead; from nothing, where that is not
        known, as in a clone without its history.
    """
    base = "HEAD"
    if recent:
        before = int(_git("log", "-1", "--format=%ct") or 0) - HOURS * 3600
        base = _git("rev-list", "-1", f"--before={before}", "HEAD") or EMPTY
    return (
        *_git("diff", "--name-only", "--no-renames", base).splitlines(),
        *_git("ls-files", "--others", "--exclude-standard").splitlines(),
    )


def last_commit() -> str:
    """Its name, by which turns are drawn."""
    return _git("rev-parse", "HEAD")


def _git(*command: str) -> str:
    try:
        done = subprocess.run(
            ["git", *command], cwd=ROOT, capture_output=True, text=True, check=False
        )
    except OSError:  # no git
        return ""
    return done.stdout.strip() if done.returncode == 0 else ""


def is_slow(test: str, touched: tuple[str, ...], turn: str = "") -> bool:
    """Whether a test, by its path, waits for ``make test-all``.

    Parameters
    ----------
    test
        Path of its file below the repository, or its file and name: ``tests/x.py::test_y``.
    touched
        Paths that have changed.
    turn
        What draws the tests that are run though nothing of theirs has changed; none are, by default.
    """
    return any(
        _within(test, slow) and not _is_run(_drawn(test, slow), slow, touched, turn)
        for slow in SLOW
    )


def _is_run(drawn: str, slow: str, touched: tuple[str, ...], turn: str) -> bool:
    """Whether the tests of a line are run for what has changed, or by their turn."""
    fresh = _is_touched(slow, touched)
    if not turn:
        return fresh
    share = 1.0 / ONE_IN
    if fresh:
        share = MOST / max(MOST, sum(_is_touched(one, touched) for one in SLOW))
    number = int.from_bytes(hashlib.sha256(f"{turn} {drawn}".encode()).digest()[:4], "big")
    return number < share * 2.0**32


def _is_touched(slow: str, touched: tuple[str, ...]) -> bool:
    own = (*SLOW[slow], slow.split("::")[0], *FOR_ALL)
    return any(_within(path, one) for one in own for path in touched)


def _drawn(test: str, slow: str) -> str:
    """What a turn is drawn for: the file of a test, or the test where the table has it by itself."""
    return test if "::" in slow else test.split("::")[0]


def _within(path: str, folder: str) -> bool:
    return path == folder or path.startswith(f"{folder}/")
