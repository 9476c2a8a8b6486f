"""Do the fast tests notice a line that is wrong? Each break of ``breaks.toml``, one at a time.

``python -m reports.planted_breaks [NAME ...]`` applies each break (or those that are named) to a copy
of the tree, runs the fast tests that the list names for it, and notes which test fails. That test then
runs on a copy without the break, where it must pass. ``--list`` only says whether the list still fits
the code. Results are kept in ``noticed.json``, and ``noticed.md`` shows them.
"""

from __future__ import annotations

import argparse
import json
import os
import shutil
import subprocess
import sys
import tempfile
import time
import tomllib
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import asdict, dataclass
from pathlib import Path

from tests.slow import is_slow

FOLDER = Path(__file__).parent
ROOT = FOLDER.parents[1]
SECONDS = 1200.0  # a break after which the tests do not end is not noticed
LEFT_OUT = shutil.ignore_patterns(
    ".git", ".venv", ".mypy_cache", ".ruff_cache", ".pytest_cache", ".hypothesis", "demo"
)


@dataclass(frozen=True, slots=True, kw_only=True)
class Break:
    """One line put wrong."""

    name: str
    promise: str
    """What must not be said any more once the line is wrong."""
    file: str
    old: str
    new: str
    tests: tuple[str, ...]
    """Paths whose fast tests must notice it."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Result:
    """What became of one break."""

    noticed_by: str | None
    """The first test that failed, and that passes without the break."""
    why: str
    """The failure in one line, or why there was none."""
    seconds: float


def listed() -> tuple[Break, ...]:
    """The breaks of the list."""
    values = tomllib.loads((FOLDER / "breaks.toml").read_text(encoding="utf-8"))
    return tuple(
        Break(name=name, **{**entry, "tests": tuple(entry["tests"])})
        for name, entry in values.items()
    )


def stale(breaks: Sequence[Break]) -> Iterator[str]:
    """What in the list does not fit the code any more."""
    for item in breaks:
        path = ROOT / item.file
        count = path.read_text(encoding="utf-8").count(item.old) if path.is_file() else 0
        if count != 1:
            yield f"{item.name}: the old text stands {count} times in {item.file}; mend the list"
        for test in item.tests:
            if not (ROOT / test).exists() or is_slow(test, ()):
                yield f"{item.name}: {test} is not among the fast tests; name others"


def planted(item: Break) -> Result:
    """Plant one break and run its tests."""
    begun = time.monotonic()
    with tempfile.TemporaryDirectory() as folder:
        tree = Path(folder) / "tree"
        # times are copied too: compiled kernels are kept beside the sources, by their times
        shutil.copytree(ROOT, tree, ignore=LEFT_OUT)
        path = tree / item.file
        text = path.read_text(encoding="utf-8")
        path.write_text(text.replace(item.old, item.new), encoding="utf-8")
        test, why = _first_failure(tree, item.tests)
        if test is not None:
            shutil.copy2(ROOT / item.file, path)
            if _first_failure(tree, (test,))[0] is not None:
                test, why = None, f"{test} fails without the break as well"
    return Result(noticed_by=test, why=why, seconds=round(time.monotonic() - begun, 1))


def _first_failure(tree: Path, tests: Sequence[str]) -> tuple[str | None, str]:
    """The first test that fails in a tree, with what it says."""
    command = [sys.executable, "-m", "pytest", "-q", "-x", "--fast", "--tb=line", *tests]
    try:
        done = subprocess.run(
            [*command, "-p", "no:cacheprovider", "-p", "no:xdist"],
            cwd=tree,
            env={**os.environ, "PYTHONPATH": str(tree), "COLUMNS": "200"},
            capture_output=True,
            text=True,
            check=False,
            timeout=SECONDS,
        )
    except subprocess.TimeoutExpired:
        return None, f"the tests did not end within {SECONDS:.0f} s"
    if done.returncode == 0:
        return None, "all tests passed"
    for line in done.stdout.splitlines():
        if line.startswith(("FAILED ", "ERROR ")):
            test, _, why = line.split(" ", 1)[1].partition(" - ")
            return test, why
    return None, f"the tests did not run: {done.stdout[-300:]}{done.stderr[-300:]}"


def table(breaks: Sequence[Break], results: dict[str, Result]) -> str:
    """The results as a page."""
    noticed = sum(results[b.name].noticed_by is not None for b in breaks if b.name in results)
    rows = []
    for item in breaks:
        result = results.get(item.name)
        by = "not run" if result is None else result.noticed_by or f"**nothing**: {result.why}"
        rows.append(f"| {item.promise} | `{item.file}`: {item.name} | {by.replace('|', '∣')} |")
    return (
        "# What notices a broken line\n\n"
        f"{noticed} of {len(breaks)} breaks are noticed by the fast tests. Command: "
        "`python -m reports.planted_breaks`; [`breaks.toml`](breaks.toml) holds the lines.\n\n"
        "| promise | break | first test that fails |\n|---|---|---|\n" + "\n".join(rows) + "\n"
    )


def main() -> int:
    """Run what is asked for."""
    parser = argparse.ArgumentParser(prog="python -m reports.planted_breaks", description=__doc__)
    parser.add_argument("names", nargs="*", help="breaks of breaks.toml; default: all")
    parser.add_argument("--list", action="store_true", help="only say whether the list is stale")
    parser.add_argument("--workers", type=int, default=1, help="breaks at a time")
    given = parser.parse_args()
    breaks = listed()
    unknown = set(given.names) - {item.name for item in breaks}
    faults = [*stale(breaks), *(f"{name}: is not in breaks.toml" for name in sorted(unknown))]
    print("\n".join(faults or [f"{len(breaks)} breaks fit the code"]), flush=True)
    if faults or given.list:
        return 2 if faults else 0
    os.nice(10)
    kept = FOLDER / "noticed.json"
    values = json.loads(kept.read_text(encoding="utf-8")) if kept.is_file() else {}
    results = {b.name: Result(**values[b.name]) for b in breaks if b.name in values}
    wanted = [item for item in breaks if item.name in given.names or not given.names]
    with ThreadPoolExecutor(given.workers) as pool:
        running = {pool.submit(planted, item): item for item in wanted}
        for done in as_completed(running):
            item, result = running[done], done.result()
            results[item.name] = result
            print(f"{item.name}: {result.noticed_by or f'NOT NOTICED ({result.why})'}", flush=True)
            ordered = {b.name: asdict(results[b.name]) for b in breaks if b.name in results}
            kept.write_text(json.dumps(ordered, indent=1, ensure_ascii=False) + "\n", "utf-8")
            (FOLDER / "noticed.md").write_text(table(breaks, results), encoding="utf-8")
    return 0 if all(results[item.name].noticed_by for item in wanted) else 1


if __name__ == "__main__":
    sys.exit(main())
