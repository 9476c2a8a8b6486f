"""Cases that come as films: ``python -m reports.blind3.filmed --help``.

Sets of the same kinds and laws as the others, drawn with another seed, but filmed (`film`) and tracked by
``track``; then diagnosed in the quick and in the full form.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from multiprocessing import get_context
from typing import Any

from reports.blind3.answering import diagnosed
from reports.blind3.cases import HERE, Case, digest, listed, text_hash
from reports.blind3.filming import SEED, tracked
from reports.blind3.score import Scored, results_text

OUT = HERE / "films"
SETS, COMMITMENT = OUT / "sets", OUT / "commitment.json"
COUNT = 120
FORMS = ("quick", "full")
BLOCKS: Sequence[tuple[int, int, str]] = (
    (0, 100, "the diagnoser that answered the last block of the others"),
    (100, COUNT, "what an error of the tracker that stays makes of a prediction does not matter"),
)
"""First case, the one after the last, and what answered them; see `score.BLOCKS`."""

Values = Mapping[str, Any]


def cases() -> list[Case]:
    """The list; it shares no seed with the others."""
    return listed(COUNT, SEED)


def generator_hash() -> str:
    """Hash of everything that the films follow from."""
    names = ("generate.py", "laws.py", "cases.py", "film.py", "filming.py")
    own = [HERE / name for name in names]
    return text_hash([*own, *sorted((HERE.parents[1] / "meso_robust" / "plant").glob("*.py"))])


def commit(wanted: Sequence[Case], workers: int) -> None:
    """Film and track, and promise the sets with what is true of them."""
    promised: dict[str, Any] = {"generator_sha256": generator_hash(), "sets": {}}
    if COMMITMENT.exists():
        before = json.loads(COMMITMENT.read_text(encoding="utf-8"))
        if before["generator_sha256"] != promised["generator_sha256"]:
            raise SystemExit(f"{COMMITMENT}: made with another generator")
        promised = before
    open_ = [case for case in wanted if f"{case.id:03d}" not in promised["sets"]]
    with ProcessPoolExecutor(workers, mp_context=get_context("spawn")) as pool:
        for case, label in zip(open_, pool.map(_made, open_), strict=True):
            key = f"{case.id:03d}"
            promised["sets"][key] = {"sha256": digest(SETS / key), **label}
            COMMITMENT.write_text(json.dumps(promised, indent=1) + "\n", encoding="utf-8")
            print(
                key,
                case.kind,
                *case.families,
                label["measured"],
                label["tracked"],
                f"{label['lost']:.2f}",
                flush=True,
            )


def _made(case: Case) -> Values:
    return tracked(case, SETS / f"{case.id:03d}")


def labels() -> Mapping[str, Values]:
    """What was promised, by the three digits of a case."""
    found: Mapping[str, Values] = json.loads(COMMITMENT.read_text(encoding="utf-8"))["sets"]
    return found


def answers(form: str) -> list[Values]:
    """The answers of a form so far."""
    path = OUT / f"{form}.jsonl"
    return (
        [json.loads(line) for line in path.read_text("utf-8").splitlines()] if path.exists() else []
    )


def run(wanted: Sequence[Case], form: str, workers: int) -> None:
    """Diagnose those that have no answer in this form, and append a line for each.

    Raises
    ------
    ValueError
        A file is another one than was promised.
    """
    promised, done = labels(), {one["id"] for one in answers(form)}
    open_ = [case for case in wanted if case.id not in done]
    for case in open_:
        if digest(SETS / f"{case.id:03d}") != promised[f"{case.id:03d}"]["sha256"]:
            raise ValueError(f"case {case.id}: a file differs from what {COMMITMENT.name} promises")
    folders = [SETS / f"{case.id:03d}" for case in open_]
    with ProcessPoolExecutor(workers, mp_context=get_context("spawn")) as pool:
        given = pool.map(partial(diagnosed, quick=form == "quick"), folders)
        for case, answer in zip(open_, given, strict=True):
            with (OUT / f"{form}.jsonl").open("a", encoding="utf-8") as file:
                file.write(json.dumps({"id": case.id, **answer}) + "\n")
            print(case.id, form, answer["verdict"], *answer.get("effects", ()), flush=True)


def page() -> str:
    """Results of each block in both forms, the latest first, in Markdown."""
    promised, by_id = labels(), {case.id: case for case in cases()}
    parts = []
    for first, end, what in reversed(BLOCKS):
        for form in FORMS:
            scored = [
                Scored(case=by_id[one["id"]], label=promised[f"{one['id']:03d}"], answer=one)
                for one in sorted(answers(form), key=lambda one: int(one["id"]))
                if first <= one["id"] < end
            ]
            if scored:
                head = f"Cases {first} to {scored[-1].case.id}, {form} form: {what}."
                parts.append(f"{head}\n\n{results_text(scored, frozenset())}")
    return "\n".join(parts)


def main(arguments: Sequence[str] | None = None) -> None:
    """Commit to sets, diagnose them, or write the page."""
    parser = argparse.ArgumentParser(prog="python -m reports.blind3.filmed", description=__doc__)
    parser.add_argument("--cases", type=int, default=COUNT, help="the first N of the list")
    parser.add_argument("--first", type=int, default=0, help="leave out those before")
    parser.add_argument("--workers", type=int, default=1)
    parser.add_argument("--commit", action="store_true", help="film, track and promise only")
    parser.add_argument("--form", choices=FORMS, action="append", help="both by default")
    parser.add_argument("--score", action="store_true", help="write results.md only")
    given = parser.parse_args(arguments)
    wanted = cases()[given.first : given.cases]
    if given.commit:
        commit(wanted, given.workers)
        return
    for form in () if given.score else given.form or FORMS:
        run(wanted, form, given.workers)
    (OUT / "results.md").write_text(page(), encoding="utf-8")


if __name__ == "__main__":
    main()
