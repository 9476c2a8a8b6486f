"""The fast tests on the oldest and on the newest dependencies that ``pyproject.toml`` allows.

``python -m reports.release.compatibility oldest`` resolves, installs into an environment of its own,
runs the tests that are listed here, and keeps what came of it in ``reports/release/``, beside a page
that tells all runs. ``--python`` names another interpreter.
"""

from __future__ import annotations

import argparse
import json
import os
import platform
import re
import subprocess
import sys
import tomllib
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parents[2]
REPORTS = ROOT / "reports" / "release"
RESOLUTIONS = {"oldest": "lowest-direct", "newest": "highest"}
EXTRAS = ("cluster", "derive")
TOOLS = ("pytest", "pytest-xdist", "mini-racer", "hatchling", "editables", "uv")

TESTS = {
    "numpy, casadi, numba": ("tests/conditions", "tests/bounds/test_interval.py"),
    "sympy, z3": ("tests/derivations/test_replay.py", "tests/derivations/test_invariances.py"),
    "python-flint": ("tests/checker/test_check.py",),
    "opencv": ("tests/microscope", "tests/tracking/test_frames.py", "tests/tracking/test_pose.py"),
    "pydantic": (
        *("tests/test_task.py", "tests/planning/test_reading.py"),
        *("tests/recordings/test_reading.py", "tests/recordings/test_writing.py"),
    ),
    "scipy": ("tests/identification/test_likelihood.py", "tests/diagnosis/test_noise.py"),
    "cma": ("tests/campaigns/falsify/test_methods.py",),
    "hypothesis": ("tests/campaigns/property/test_search.py", "tests/test_units.py"),
    "distributed": ("tests/campaigns/test_cluster.py",),
    "jinja2, matplotlib": ("tests/reporting",),
    "typer, rich": ("tests/cli/test_certify.py", "tests/cli/test_recordings.py"),
    "the main job": ("tests/test_main_job.py",),
}
"""Tests by what they exercise first."""

# What a dependency of another year warns of is not a fault of this package.
WARNINGS = ("-W", "ignore::DeprecationWarning", "-W", "ignore::PendingDeprecationWarning")


@dataclass(frozen=True, slots=True, kw_only=True)
class Run:
    """The outcome of one run."""

    dependencies: str
    python: str
    platform: str
    versions: dict[str, str]
    passed: int
    failed: int
    skipped: int
    seconds: float
    failures: tuple[str, ...]
    tests: tuple[str, ...]

    @property
    def name(self) -> str:
        """Of its file."""
        return f"{self.dependencies}-python-{'.'.join(self.python.split('.')[:2])}"


def uv(*arguments: str) -> None:
    """Run uv."""
    subprocess.run([sys.executable, "-m", "uv", *arguments, "--quiet"], cwd=ROOT, check=True)


def environment(folder: Path, dependencies: str, python: str) -> Path:
    """Interpreter of a fresh environment with the dependencies and the package."""
    pins = folder / "pins.txt"
    extras = [f"--extra={extra}" for extra in EXTRAS]
    sort = ["--no-header", "--no-annotate", "--no-emit-index-url", f"--python={python}"]
    how = f"--resolution={RESOLUTIONS[dependencies]}"
    uv(
        "pip",
        "compile",
        how,
        "--upgrade",
        *extras,
        *sort,
        "pyproject.toml",
        f"--output-file={pins}",
    )
    uv("venv", "--clear", f"--python={python}", str(folder / "venv"))
    interpreter = folder / "venv" / "bin" / "python"
    uv("pip", "install", f"--python={interpreter}", f"--requirement={pins}", *TOOLS)
    editable = ("--no-deps", "--no-build-isolation", "--editable", ".")
    uv("pip", "install", f"--python={interpreter}", *editable)
    return interpreter


def run(folder: Path, dependencies: str, python: str) -> Run:
    """Install and test."""
    interpreter = environment(folder, dependencies, python)
    tests = [one for group in TESTS.values() for one in group]
    report = folder / "junit.xml"
    done = subprocess.run(
        [
            *(interpreter, "-m", "pytest", "-q", "-n", "2", "--dist", "loadfile"),
            *("-p", "no:cacheprovider", f"--junitxml={report}", *WARNINGS, *tests),
        ],
        cwd=ROOT,
        # compiled code of one set of versions must not displace that of another
        env=os.environ | {"PYTHONPATH": str(ROOT), "NUMBA_CACHE_DIR": str(folder / "kernels")},
        capture_output=True,
        text=True,
        check=False,
    )
    (folder / "output.txt").write_text(done.stdout + done.stderr, encoding="utf-8")
    return _told(done.stdout, dependencies, interpreter)


def _told(output: str, dependencies: str, interpreter: Path) -> Run:
    """The closing line of pytest, and the versions that were tested."""
    closing = next((line for line in reversed(output.splitlines()) if " in " in line), "")
    count = {word: int(number) for number, word in re.findall(r"(\d+) (\w+)", closing)}
    seconds = re.search(r" in ([0-9.]+)s", closing)
    found = subprocess.run(
        [interpreter, "-c", _ASK, *_names()], capture_output=True, text=True, check=True
    )
    about: dict[str, Any] = json.loads(found.stdout)
    return Run(
        dependencies=dependencies,
        python=about["python"],
        platform=about["platform"],
        versions=about["versions"],
        passed=count.get("passed", 0),
        failed=count.get("failed", 0) + count.get("error", 0) + count.get("errors", 0),
        skipped=count.get("skipped", 0),
        seconds=float(seconds.group(1)) if seconds else 0.0,
        failures=tuple(re.findall(r"^(?:FAILED|ERROR) (\S+)", output, re.MULTILINE)),
        tests=tuple(one for group in TESTS.values() for one in group),
    )


_ASK = """
import json, platform, sys
from importlib.metadata import version
print(json.dumps({"python": platform.python_version(), "platform": platform.platform(),
                  "versions": {name: version(name) for name in sys.argv[1:]}}))
"""


def _names() -> list[str]:
    """Names of the dependencies, of the extras too."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    extras = [one for extra in EXTRAS for one in project["optional-dependencies"][extra]]
    return [re.split(r"[<>=!~ ;\[]", one)[0] for one in [*project["dependencies"], *extras]]


def page(runs: list[Run]) -> str:
    """All runs in Markdown."""
    lines = [
        "# Versions that were tested",
        "",
        "The fast tests of `python -m reports.release.compatibility` (`make oldest`, `make newest`), each",
        "set of versions in an environment of its own. *oldest*: the lowest versions that",
        "`pyproject.toml` allows of what it names; *newest*: the highest of everything.",
        "",
        "| dependencies | Python | passed | failed | skipped | seconds | platform |",
        "|---|---|---|---|---|---|---|",
    ]
    lines += [
        f"| {one.dependencies} | {one.python} | {one.passed:,} | {one.failed} | {one.skipped} "
        f"| {one.seconds:.0f} | {one.platform} |"
        for one in runs
    ]
    heads = [f"{one.dependencies} {'.'.join(one.python.split('.')[:2])}" for one in runs]
    lines += ["", f"| package | {' | '.join(heads)} |", "|---|" + "---|" * len(runs)]
    for name in sorted({name for one in runs for name in one.versions}):
        cells = " | ".join(one.versions.get(name, "") for one in runs)
        lines.append(f"| {name} | {cells} |")
    failures = [f"- {one.name}: `{test}`" for one in runs for test in one.failures]
    if failures:
        lines += ["", "Failed:", "", *failures]
    lines += ["", "What was run, by what it exercises first:", ""]
    lines += [
        f"- {what}: {', '.join(f'`{one}`' for one in files)}" for what, files in TESTS.items()
    ]
    return "\n".join(lines) + "\n"


def main() -> None:
    """Run one set of versions and renew the page."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("dependencies", choices=[*RESOLUTIONS, "page"])
    parser.add_argument("--python", default=platform.python_version())
    parser.add_argument("--folder", type=Path, help="for the environment", default=ROOT / ".venv")
    asked = parser.parse_args()
    REPORTS.mkdir(parents=True, exist_ok=True)
    failed = 0
    if asked.dependencies != "page":
        folder = asked.folder / f"{asked.dependencies}-{Path(asked.python).name}"
        folder.mkdir(parents=True, exist_ok=True)
        done = run(folder.resolve(), asked.dependencies, asked.python)
        text = json.dumps(asdict(done), indent=1) + "\n"
        (REPORTS / f"{done.name}.json").write_text(text, encoding="utf-8")
        failed = done.failed or not done.passed
    kept = [json.loads(file.read_text(encoding="utf-8")) for file in sorted(REPORTS.glob("*.json"))]
    text = page([Run(**values) for values in kept])
    (REPORTS / "compatibility.md").write_text(text, encoding="utf-8")
    sys.exit(bool(failed))


if __name__ == "__main__":
    main()
