"""The third blind trial, case by case: ``python -m reports.blind3 --help``."""

from __future__ import annotations

import argparse
import json
import sys
import tempfile
from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path

from reports.blind3.answering import Values, answered
from reports.blind3.cases import HERE, SETS, Case, commit, listed, renew, sealed
from reports.blind3.score import page, results_text, scored_cases

RESULTS = HERE / "results.jsonl"


def kept(path: Path = RESULTS) -> list[Values]:
    """The answers so far, a line each."""
    if not path.exists():
        return []
    return [json.loads(line) for line in path.read_text(encoding="utf-8").splitlines() if line]


def run(cases: Sequence[Case], workers: int, path: Path = RESULTS) -> None:
    """Diagnose the cases that have no answer yet, and append one line for each."""
    done = {answer["id"] for answer in kept(path)}
    for answer in _answers([case for case in cases if case.id not in done], workers):
        with path.open("a", encoding="utf-8") as file:
            file.write(json.dumps(answer) + "\n")
        print(answer["id"], answer["verdict"], *answer.get("effects", ()), flush=True)


def again(cases: Sequence[Case], workers: int, path: Path) -> str:
    """Answer cases that have an answer once more, into another file; its results in Markdown.

    They are no blind evidence any more: this shows what a change of the diagnoser does. Other cases are left alone.
    """
    known = {answer["id"] for answer in kept()}
    asked = [case for case in cases if case.id in known]
    for case in asked:
        folder = SETS / f"{case.id:03d}"
        if not folder.exists():
            sealed(case, folder)
    run(asked, workers, path)
    return results_text(scored_cases(kept(path)), frozenset())


def _answers(cases: Sequence[Case], workers: int) -> Iterator[Values]:
    if workers == 1:
        yield from map(answered, cases)
        return
    with ProcessPoolExecutor(workers, mp_context=get_context("spawn")) as pool:
        yield from pool.map(answered, cases)


def main(arguments: Sequence[str] | None = None) -> None:
    """Commit to sets, diagnose them, or write the page."""
    parser = argparse.ArgumentParser(prog="python -m reports.blind3", description=__doc__)
    parser.add_argument("--cases", type=int, default=400, help="the first N of the list")
    parser.add_argument("--first", type=int, default=0, help="leave out those before")
    parser.add_argument("--workers", type=int, default=1)
    parser.add_argument("--commit", action="store_true", help="make sets and commit to them only")
    parser.add_argument(
        "--renew", action="store_true", help="promise the same sets of this generator"
    )
    parser.add_argument(
        "--again", type=Path, metavar="FILE", help="diagnose those with an answer anew, into FILE"
    )
    parser.add_argument("--score", action="store_true", help="write results.md only")
    given = parser.parse_args(arguments)
    if given.commit:
        commit(given.first, given.cases)
        return
    if given.renew:
        with tempfile.TemporaryDirectory() as folder:
            sys.exit(1 if renew(Path(folder)) else 0)
    if given.again:
        sys.stdout.write(again(listed()[given.first : given.cases], given.workers, given.again))
        return
    if not given.score:
        run(listed()[given.first : given.cases], given.workers)
    (HERE / "results.md").write_text(page(scored_cases(kept())), encoding="utf-8")


if __name__ == "__main__":
    main(sys.argv[1:])
