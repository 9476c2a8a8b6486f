"""The blind benchmark: ``python -m reports.blind.campaign --help``.

First all sets are made and their labels committed to; then each set is diagnosed once by a process
that is given the set's folder and nothing else. It can be ended at any time and called again.
"""

from __future__ import annotations

import argparse
import shlex
import shutil
import signal
import sys
import tempfile
import threading
import time
from collections.abc import Callable, Generator, Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from queue import Empty, SimpleQueue
from typing import Any

from meso_robust.campaigns.blind.sealing import (
    RESULTS,
    Commitment,
    SealError,
    append,
    digest,
    read_commitment,
    read_results,
)
from reports.blind.blind_report import write_report
from reports.blind.committing import Setting, commit, set_folder, sources
from reports.blind.corpus import QUICK, Corpus, entries
from reports.blind.generator import UNIDENTIFIABLE
from reports.blind.outside import OUTSIDE
from reports.blind.serve import Command, Diagnoser, Document, NoAnswerError, Service

ESSENTIAL = (
    "verdict",
    "effects",
    "ambiguous_with",
    "not_identifiable",
    "baseline",
    "noise",
    "catch_all_sigma",
)
GRACE = 10.0  # s for a thread to remove its scratch folder
FIRST = 5  # spans and candidates kept of each document

Values = Mapping[str, Any]


def run(
    folder: Path,
    diagnosers: Sequence[Diagnoser],
    hash_now: Callable[[], str] = sources,
    until: float = float("inf"),
) -> Generator[Values, None, None]:
    """Diagnose what has no result yet, each case once; yields each result when it is on the disk.

    Parameters
    ----------
    folder
        Of the campaign, committed to.
    diagnosers
        Asked side by side; all are closed at the end, however it comes.
    hash_now
        Hash of the diagnoser; held against the commitment before and after every case.
    until
        `time.monotonic` after which no case is begun.

    Raises
    ------
    SealError
        The diagnoser is not the one that the commitment names.
    """
    commitment = read_commitment(folder)
    known = read_results(folder)
    left: SimpleQueue[int] = SimpleQueue()
    for index in range(len(commitment.cases)):
        if index not in known:
            left.put(index)
    answers: SimpleQueue[Values | Exception | None] = SimpleQueue()
    stop = threading.Event()

    def work(diagnoser: Diagnoser) -> None:
        try:
            while not stop.is_set() and time.monotonic() < until:
                index = left.get_nowait()
                _check_unchanged(commitment, hash_now())
                answer = _diagnosed(folder, index, diagnoser, commitment.quick)
                _check_unchanged(commitment, hash_now())  # else two versions may have answered
                answers.put(answer)
        except Empty:
            pass
        except Exception as error:
            answers.put(error)
        finally:
            diagnoser.close()
            answers.put(None)

    threads = [threading.Thread(target=work, args=(one,), daemon=True) for one in diagnosers]
    for thread in threads:
        thread.start()
    try:
        yield from _kept(answers, len(threads), folder / RESULTS)
    finally:
        stop.set()
        for diagnoser in diagnosers:
            diagnoser.stop()
        for thread in threads:
            thread.join(timeout=GRACE)


def _kept(
    answers: SimpleQueue[Values | Exception | None], working: int, path: Path
) -> Iterator[Values]:
    while working:
        answer = answers.get()
        if isinstance(answer, Exception):
            raise answer
        if answer is None:
            working -= 1
        else:
            append(path, answer)
            yield answer


def _check_unchanged(commitment: Commitment, now: str) -> None:
    if now != commitment.diagnoser:
        raise SealError(
            f"the diagnoser's sources (hash {now[:12]}) are not those committed to "
            f"({commitment.diagnoser[:12]}); restore them, or begin again in another folder (--out)"
        )


def _diagnosed(folder: Path, index: int, diagnoser: Diagnoser, quick: bool) -> Values:
    with tempfile.TemporaryDirectory() as scratch:
        copy = Path(scratch) / "recordings"  # its path tells nothing of the case
        shutil.copytree(set_folder(folder, index), copy)
        head = {"index": index, "recordings": digest(copy)}
        begun = time.perf_counter()
        try:
            answer: Values = {"document": essential(diagnoser.ask(copy, quick=quick, seed=0))}
        except NoAnswerError as error:
            answer = {"error": str(error)}
        return {**head, "seconds": time.perf_counter() - begun, **answer}


def essential(document: Document) -> Document:
    """What the scoring needs of a ``diagnosis.json``, and the best candidates.

    Raises
    ------
    NoAnswerError
        A section that every diagnosis has is missing.
    """
    if not {"verdict", "mismatch", "held_out"} <= set(document):
        raise NoAnswerError(f"not a diagnosis document; its keys are {sorted(document)}")
    mismatch = document["mismatch"]
    return {
        **{key: document[key] for key in ESSENTIAL if key in document},
        "held_out": {key: v for key, v in document["held_out"].items() if key != "each"},
        "mismatch": {
            "detected": mismatch["detected"],
            "p_value": mismatch["p_value"],
            "where": mismatch["where"][:FIRST],
        },
        "candidates": document.get("candidates", [])[:FIRST],
    }


def main() -> None:
    """Commit if that has not been done, diagnose what is missing, score what is there."""
    asked = _arguments()
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    until = time.monotonic() + 3600.0 * asked.hours
    try:
        _campaign(asked, until)
    except SealError as error:
        sys.stderr.write(f"{error}\n")
        sys.exit(2)
    except KeyboardInterrupt:
        sys.stderr.write("\ninterrupted; the same command goes on from here\n")
        sys.exit(130)


def _campaign(asked: argparse.Namespace, until: float) -> None:
    corpus = QUICK if asked.quick else Corpus(master_seed=asked.seed, repeats=asked.repeats)
    cases = entries(corpus, tuple(OUTSIDE), tuple(UNIDENTIFIABLE))
    setting = Setting(corpus=corpus, cases=cases, quick=asked.quick_diagnosis)
    _follow(commit(asked.out, setting, asked.workers), len(cases), "sealed")
    if not asked.commit_only:
        diagnosers = [_diagnoser(asked.command) for _ in range(asked.workers)]
        left = len(cases) - len(read_results(asked.out))
        _follow(run(asked.out, diagnosers, until=until), left, "diagnosed")
        write_report(asked.out)


def _diagnoser(template: str | None) -> Diagnoser:
    return Service() if template is None else Command(shlex.split(template))


def _follow(steps: Iterable[object], count: int, what: str) -> None:
    begun = time.monotonic()
    for k, _ in enumerate(steps, 1):
        each = (time.monotonic() - begun) / k
        ahead = (count - k) * each / 60.0
        sys.stderr.write(f"{k}/{count} {what}, {each:.1f} s each, {ahead:.0f} min left\n")


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m reports.blind.campaign", description=__doc__)
    parser.add_argument("--out", type=Path, default=Path("reports/blind"))
    parser.add_argument("--quick", action="store_true", help="a dozen cases instead of all")
    parser.add_argument("--quick-diagnosis", action="store_true", help="ask for the quick form")
    parser.add_argument("--repeats", type=int, default=1, help="cases of each effect and size")
    parser.add_argument("--seed", type=int, default=Corpus().master_seed, help="of the corpus")
    parser.add_argument("--workers", type=int, default=2, help="processes, one thread each")
    parser.add_argument("--hours", type=float, default=float("inf"), help="begin no case after")
    parser.add_argument("--commit-only", action="store_true", help="stop before any diagnosis")
    parser.add_argument("--command", help="instead of the service, with {folder} and {seed}")
    return parser.parse_args()


if __name__ == "__main__":
    main()
