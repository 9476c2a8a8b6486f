"""Making the sets of a campaign, sealing their labels and publishing the commitment."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable, Generator, Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import asdict, dataclass
from datetime import UTC, datetime
from multiprocessing import get_context
from pathlib import Path
from typing import Any

from meso_robust.campaigns.blind import judging
from meso_robust.campaigns.blind.sealing import (
    COMMITMENT,
    SEALED,
    SETS,
    SOURCES,
    Commitment,
    Sealed,
    SealError,
    append,
    canonical,
    digest,
    merkle_root,
    new_salt,
    read_sealed,
    seed_of,
    sha256,
    whole_lines,
)
from reports.blind.corpus import Corpus, Entry
from reports.blind.generator import Case, make, write
from reports.blind.serve import ROOT

Values = Mapping[str, Any]
Conceal = Callable[[Entry, int, Path], Values]
Job = tuple[int, Entry, int, Path]


def set_folder(folder: Path, index: int) -> Path:
    """Where the recordings of a case are."""
    return folder / SETS / f"{index:04d}"


def concealed(entry: Entry, seed: int, folder: Path) -> Values:
    """Write the recording set of a case and return what is concealed in it."""
    made = make(Case(**asdict(entry), seed=seed))
    write(made, folder)
    return made.label


def sources(root: Path = ROOT) -> str:
    """Hash of everything that the diagnoser's behaviour may depend on."""
    return digest(root / "meso_robust", SOURCES)


def benchmark() -> str:
    """Hash of the generator, the scoring and the rest of the benchmark, but for its tests."""
    folder = Path(__file__).parent
    modules = (path.name for path in folder.glob("*.py") if not path.stem.startswith("test_"))
    rules = digest(Path(judging.__file__).parent, SOURCES)
    return sha256(canonical([digest(folder, tuple(modules)), rules]))


@dataclass(frozen=True, slots=True, kw_only=True)
class Setting:
    """What a campaign needs besides its folder."""

    corpus: Corpus
    cases: Sequence[Entry]
    """In the order in which they are run."""
    quick: bool
    diagnoser: Callable[[], str] = sources
    """Hash of the diagnoser as it is now."""
    conceal: Conceal = concealed


def commit(folder: Path, setting: Setting, workers: int = 1) -> Generator[int, None, None]:
    """Make and seal every case that is not yet, then write the commitment; yields their indices.

    Raises
    ------
    SealError
        The folder's labels were begun for another diagnoser or another corpus.
    """
    folder.mkdir(parents=True, exist_ok=True)
    diagnoser = setting.diagnoser()
    master = _begun(folder, setting, diagnoser)
    (folder / SETS).mkdir(exist_ok=True)
    (folder / SETS / ".gitignore").write_text("*\n", encoding="utf-8")
    _, done = read_sealed(folder)
    left = sorted(set(range(len(setting.cases))) - {case.index for case in done})
    jobs = [
        (k, setting.cases[k], seed_of(diagnoser, master, k), set_folder(folder, k)) for k in left
    ]
    for case in _sealed(jobs, setting.conceal, workers):
        append(folder / SEALED, asdict(case))
        yield case.index
    if not (folder / COMMITMENT).exists():
        _publish(folder, setting, diagnoser, master)


def _begun(folder: Path, setting: Setting, diagnoser: str) -> str:
    """The master salt, from the head of the file of labels or drawn now."""
    about = {"diagnoser": diagnoser, "corpus": asdict(setting.corpus), "quick": setting.quick}
    lines = whole_lines(folder / SEALED)
    if not lines:
        master = new_salt()
        append(folder / SEALED, {"master": master, **about})
        return master
    known = {key: lines[0][key] for key in about}
    if canonical(known) != canonical(about):
        changed = [key for key in about if canonical(known[key]) != canonical(about[key])]
        raise SealError(
            f"{folder}: holds a campaign with another {' and '.join(changed)}; "
            "a diagnoser has one shot at a corpus: give another folder with --out"
        )
    return str(lines[0]["master"])


def _sealed(jobs: Sequence[Job], conceal: Conceal, workers: int) -> Iterator[Sealed]:
    if workers == 1:
        yield from (_seal(job, conceal) for job in jobs)
        return
    with ProcessPoolExecutor(workers, mp_context=get_context("spawn")) as pool:
        try:
            for future in as_completed([pool.submit(_seal, job, conceal) for job in jobs]):
                yield future.result()
        finally:
            pool.shutdown(cancel_futures=True)


def _seal(job: Job, conceal: Conceal) -> Sealed:
    index, entry, seed, folder = job
    shutil.rmtree(folder, ignore_errors=True)  # of a campaign that was ended while writing it
    truth = conceal(entry, seed, folder)
    label = canonical({**asdict(entry), "seed": seed, "truth": truth})
    return Sealed(index, json.loads(label), digest(folder), new_salt())


def _publish(folder: Path, setting: Setting, diagnoser: str, master: str) -> None:
    hashes = tuple(case.hash for case in read_sealed(folder)[1])
    commitment = Commitment(
        date=datetime.now(UTC).isoformat(timespec="seconds"),
        diagnoser=diagnoser,
        generator=benchmark(),
        master=sha256(bytes.fromhex(master)),
        corpus=asdict(setting.corpus),
        quick=setting.quick,
        cases=hashes,
        root=merkle_root(hashes),
    )
    draft = folder / f".{COMMITMENT}.part"
    draft.write_text(commitment.text(), encoding="utf-8")
    draft.replace(folder / COMMITMENT)
