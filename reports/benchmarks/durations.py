"""Where the tests' time goes: ``python -m reports.benchmarks.durations RUN.xml``.

Takes what ``pytest --junitxml RUN.xml`` wrote, and writes ``durations.md`` beside this file.
"""

from __future__ import annotations

import sys
import xml.etree.ElementTree as ElementTree
from collections import Counter, defaultdict
from pathlib import Path

from meso_robust.files import write_all
from tests.slow import is_slow

HERE = Path(__file__).parent
MOST = 60
"""Files that are listed."""


def page(run: Path) -> str:
    """The files that take longest, and what the others take together."""
    seconds: defaultdict[str, float] = defaultdict(float)
    tests: Counter[str] = Counter()
    for case in ElementTree.parse(run).getroot().iter("testcase"):
        file = case.get("classname", "").replace(".", "/") + ".py"
        seconds[file] += float(case.get("time", "0"))
        tests[file] += 1
    slow = sum(time for file, time in seconds.items() if is_slow(file, ()))
    longest = sorted(seconds.items(), key=lambda pair: -pair[1])
    rows = [
        f"| `{file}` | {tests[file]} | {time:.1f} | {'test-all' if is_slow(file, ()) else 'test'} |"
        for file, time in longest[:MOST]
    ]
    rest = sum(time for _, time in longest[MOST:])
    return "\n".join(
        [
            "# Where the tests' time goes",
            "",
            "Seconds of one worker, of two that share two cores, fixtures included. Command: `make test-all` with",
            "`--junitxml RUN.xml`, then `python -m reports.benchmarks.durations RUN.xml`.",
            "",
            f"{sum(tests.values())} tests, {sum(seconds.values()):.0f} s in all, {slow:.0f} s of it slow.",
            "",
            "| file | tests | s | by |",
            "|---|---|---|---|",
            *rows,
            f"| {len(longest[MOST:])} others | | {rest:.1f} | |",
            "",
        ]
    )


if __name__ == "__main__":
    write_all(HERE, {"durations.md": page(Path(sys.argv[1]))})
