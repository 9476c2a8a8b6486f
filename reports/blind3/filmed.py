"""Cases apart from the list: films, and more of what is short. ``python -m reports.blind3.filmed --help``.

Sets of the same kinds and laws as the others, drawn with other seeds. Films are made by `film` and tracked by ``track``,
then diagnosed in the quick and in the full form. Those of `SHORT` and of `LATE`, most of them outside the catalogue or a
pair, come as recordings; so do those of `WHOLE` and `LAST`, which have every kind in its share, and those of `BEYOND`,
which have other laws too. Those of `FRESH` are mostly pairs and laws that are new again, all of them well visible.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from functools import partial
from multiprocessing import get_context
from pathlib import Path
from typing import Any

from reports.blind3 import beyond, fresh
from reports.blind3.answering import diagnosed
from reports.blind3.cases import HERE, Case, digest, listed, sealed, text_hash
from reports.blind3.filming import SEED, tracked
from reports.blind3.score import Scored, results_text

FORMS = ("quick", "full")
AGAIN = "again"
"""The quick form once more, of cases that are known by then: no blind evidence."""
Values = Mapping[str, Any]


@dataclass(frozen=True, slots=True, kw_only=True)
class Trial:
    """Cases of one kind, what makes their sets, and where sets and answers are.

    Attributes
    ----------
    out
        Folder of the commitment, the sets and the answers.
    cases
        The list.
    made
        Makes the set of a case in a folder, and returns what is true of it.
    follows
        Modules of this folder that the sets follow from.
    blocks
        First case, the one after the last, and what answered them; see `score.BLOCKS`.
    forms
        In which they are diagnosed.
    """

    out: Path
    cases: Sequence[Case]
    made: Callable[[Case, Path], Values]
    follows: tuple[str, ...]
    blocks: Sequence[tuple[int, int, str]]
    forms: tuple[str, ...]

    @property
    def commitment(self) -> Path:
        """The file with what was promised."""
        return self.out / "commitment.json"

    def folder(self, case: Case) -> Path:
        """Of a set."""
        return self.out / "sets" / f"{case.id:03d}"

    def generator_hash(self) -> str:
        """Hash of everything that the sets follow from."""
        plant = (HERE.parents[1] / "meso_robust" / "plant").glob("*.py")
        return text_hash([*(HERE / name for name in self.follows), *sorted(plant)])

    def commit(self, wanted: Sequence[Case], workers: int) -> None:
        """Make sets that are not promised yet, and promise them with what is true of them."""
        promised: dict[str, Any] = {"generator_sha256": self.generator_hash(), "sets": {}}
        if self.commitment.exists():
            before = json.loads(self.commitment.read_text(encoding="utf-8"))
            if before["generator_sha256"] != promised["generator_sha256"]:
                raise SystemExit(f"{self.commitment}: made with another generator")
            promised = before
        open_ = [case for case in wanted if f"{case.id:03d}" not in promised["sets"]]
        with ProcessPoolExecutor(workers, mp_context=get_context("spawn")) as pool:
            for case, label in zip(open_, pool.map(self._made, open_), strict=True):
                key = f"{case.id:03d}"
                promised["sets"][key] = {"sha256": digest(self.folder(case)), **label}
                self.commitment.write_text(json.dumps(promised, indent=1) + "\n", encoding="utf-8")
                print(
                    key,
                    case.kind,
                    *case.families,
                    label["measured"],
                    *(f"{key} {label[key]:.2f}" for key in ("tracked", "lost") if key in label),
                    flush=True,
                )

    def _made(self, case: Case) -> Values:
        return self.made(case, self.folder(case))

    def labels(self) -> Mapping[str, Values]:
        """What was promised, by the three digits of a case."""
        found: Mapping[str, Values] = json.loads(self.commitment.read_text(encoding="utf-8"))[
            "sets"
        ]
        return found

    def answers(self, form: str) -> list[Values]:
        """The answers of a form so far."""
        path = self.out / f"{form}.jsonl"
        return (
            [json.loads(line) for line in path.read_text("utf-8").splitlines()]
            if path.exists()
            else []
        )

    def run(self, wanted: Sequence[Case], form: str, workers: int) -> None:
        """Diagnose those that have no answer in this form, and append a line for each.

        Raises
        ------
        ValueError
            A file is another one than was promised.
        """
        promised, done = self.labels(), {one["id"] for one in self.answers(form)}
        open_ = [case for case in wanted if case.id not in done]
        for case in open_:
            if digest(self.folder(case)) != promised[f"{case.id:03d}"]["sha256"]:
                raise ValueError(
                    f"case {case.id}: a file differs from what {self.commitment.name} promises"
                )
        folders = [self.folder(case) for case in open_]
        with ProcessPoolExecutor(workers, mp_context=get_context("spawn")) as pool:
            given = pool.map(partial(diagnosed, quick=form != "full"), folders)
            for case, answer in zip(open_, given, strict=True):
                with (self.out / f"{form}.jsonl").open("a", encoding="utf-8") as file:
                    file.write(json.dumps({"id": case.id, **answer}) + "\n")
                print(case.id, form, answer["verdict"], *answer.get("effects", ()), flush=True)

    def page(self) -> str:
        """Results of each block in every form, the latest first, in Markdown."""
        parts = []
        for first, end, what in reversed(self.blocks):
            for form in self.forms:
                if scored := self._scored(form, first, end):
                    head = f"Cases {first} to {scored[-1].case.id}, {form} form: {what}."
                    parts.append(f"{head}\n\n{results_text(scored, frozenset())}")
        if scored := self._scored(AGAIN, 0, self.cases[-1].id + 1):
            head = f"{len(scored)} cases asked again in the quick form, known by then: no blind evidence."
            parts.append(f"{head}\n\n{results_text(scored, frozenset())}")
        return "\n".join(parts)

    def _scored(self, form: str, first: int, end: int) -> list[Scored]:
        promised, by_id = self.labels(), {case.id: case for case in self.cases}
        return [
            Scored(case=by_id[one["id"]], label=promised[f"{one['id']:03d}"], answer=one)
            for one in sorted(self.answers(form), key=lambda one: int(one["id"]))
            if first <= one["id"] < end
        ]


FILMS = Trial(
    out=HERE / "films",
    cases=listed(120, SEED),
    made=tracked,
    follows=("generate.py", "laws.py", "cases.py", "film.py", "filming.py"),
    blocks=(
        (0, 100, "the diagnoser that answered the last block of the others"),
        (100, 120, "what an error of the tracker that stays makes of a prediction does not matter"),
    ),
    forms=FORMS,
)
SHORT = Trial(
    out=HERE / "short",
    cases=[case for case in listed(120, 20261128) if case.kind in ("outside", "pair")],
    made=sealed,
    follows=("generate.py", "laws.py", "cases.py"),
    blocks=((0, 120, "what a set leaves may be at the stage of its own effects"),),
    forms=("quick",),
)
LATE = Trial(
    out=HERE / "late",
    cases=[
        case
        for case in listed(120, 20261129)
        if case.kind in ("outside", "pair") or case.id < 40  # and some of every kind
    ],
    made=sealed,
    follows=("generate.py", "laws.py", "cases.py"),
    blocks=(
        (
            0,
            120,
            "stages are told by equal numbers of inputs, a second effect that surely leaves least is told",
        ),
    ),
    forms=("quick",),
)
WHOLE = Trial(
    out=HERE / "whole",
    cases=listed(60, 20261130),
    made=sealed,
    follows=("generate.py", "laws.py", "cases.py"),
    blocks=(
        (
            0,
            60,
            "what nothing explains is asked with other recordings held out, a pull of the tip is one physics",
        ),
    ),
    forms=("quick",),
)
LAST = Trial(
    out=HERE / "last",
    cases=listed(100, 20261201),
    made=sealed,
    follows=("generate.py", "laws.py", "cases.py"),
    blocks=(
        (0, 100, "friction of one tip, inertia, and a film that thins above a speed are known"),
    ),
    forms=("quick",),
)
BEYOND = Trial(
    out=HERE / "beyond",
    cases=beyond.listed(100, 20261202),
    made=beyond.sealed,
    follows=("generate.py", "laws.py", "cases.py", "beyond.py"),
    blocks=(
        (
            0,
            100,
            "six effects more are known: a sticky spot, a pull to a point, friction that drifts, "
            "pixels that lock, a lead screw, an angle that is off",
        ),
    ),
    forms=("quick",),
)
FRESH = Trial(
    out=HERE / "fresh",
    cases=fresh.listed(20261204),
    made=fresh.sealed,
    follows=("generate.py", "laws.py", "cases.py", "beyond.py", "fresh.py"),
    blocks=((0, 64, "a clock's rate, a part that is skewed and a tip that goes round are known"),),
    forms=("quick",),
)
PAIRS = Trial(
    out=HERE / "pairs",
    cases=[case for case in fresh.listed(20261206) if case.kind in ("pair", "null")],
    made=fresh.sealed,
    follows=("generate.py", "laws.py", "cases.py", "beyond.py", "fresh.py"),
    blocks=(
        (
            0,
            64,
            "what gains most beside the best effect is tried beside the next ones, drives creep",
        ),
    ),
    forms=("quick",),
)
TRIALS = {
    "films": FILMS,
    "short": SHORT,
    "late": LATE,
    "whole": WHOLE,
    "last": LAST,
    "beyond": BEYOND,
    "fresh": FRESH,
    "pairs": PAIRS,
}


def main(arguments: Sequence[str] | None = None) -> None:
    """Commit to sets, diagnose them, or write the page."""
    parser = argparse.ArgumentParser(prog="python -m reports.blind3.filmed", description=__doc__)
    parser.add_argument("--trial", choices=TRIALS, default="films")
    parser.add_argument("--cases", type=int, default=120, help="those before the Nth of the list")
    parser.add_argument("--first", type=int, default=0, help="leave out those before")
    parser.add_argument("--workers", type=int, default=1)
    parser.add_argument("--commit", action="store_true", help="make sets and promise them only")
    parser.add_argument(
        "--form", choices=(*FORMS, AGAIN), action="append", help="the trial's by default"
    )
    parser.add_argument("--score", action="store_true", help="write results.md only")
    given = parser.parse_args(arguments)
    trial = TRIALS[given.trial]
    wanted = [case for case in trial.cases if given.first <= case.id < given.cases]
    if given.commit:
        trial.commit(wanted, given.workers)
        return
    for form in () if given.score else given.form or trial.forms:
        trial.run(wanted, form, given.workers)
    (trial.out / "results.md").write_text(trial.page(), encoding="utf-8")


if __name__ == "__main__":
    main()
