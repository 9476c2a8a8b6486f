"""The kind *blind*: a corpus of concealed effects, diagnosed set by set."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from pathlib import Path

from meso_robust.campaigns.blind.asking import asked
from meso_robust.campaigns.blind.corpus import labels_hash, opened_labels, sets_of
from meso_robust.campaigns.blind.judging import Judged, judged
from meso_robust.campaigns.blind.scoring import answer_of, scores
from meso_robust.campaigns.blind.sealing import SETS
from meso_robust.campaigns.blind.section import BlindSection
from meso_robust.campaigns.blind.summary import tell
from meso_robust.campaigns.kind import Failure, Kind, Part, Result, Values


def given_corpus(section: BlindSection, folder: Path) -> Values:
    """Where the corpus is, the digest of each set, and a hash of what settles the labels.

    Raises
    ------
    InputError
        The folder holds no sets, or nothing that tells what is concealed.
    """
    corpus = (folder / section.corpus).resolve()
    return {"corpus": str(corpus), "sets": sets_of(corpus), "labels": labels_hash(corpus)}


def count(part: Part) -> int:
    """A chunk is a set."""
    return len(part.given["sets"])


def prepare(part: Part) -> None:
    """Nothing is shared."""


def execute(prepared: None, part: Part, chunk: int) -> Result:
    """Diagnose a set; what is concealed in it is not known here.

    Raises
    ------
    InputError
        Its recordings are not those that the campaign began with.
    """
    name = sorted(part.given["sets"])[chunk]
    folder = Path(part.given["corpus"]) / SETS / name
    answer = asked(folder, part.given["sets"][name], quick=bool(part.asked["quick"]))
    return Result(
        runs=1,
        failed=int("error" in answer),
        failures=(Failure(what="no answer", detail=f"set {name}: {answer['error']}", files={}),)
        if "error" in answer
        else (),
        values={"set": name, "answer": answer},
    )


def total(part: Part, results: Iterable[Result]) -> Values:
    """Open the labels and score what was answered."""
    answers = {one.values["set"]: one.values["answer"] for one in results}
    found = opened_labels(Path(part.given["corpus"]), part.given["sets"], str(part.given["labels"]))
    verdicts = Counter(one.get("document", {}).get("verdict", "none") for one in answers.values())
    values: Values = {
        "planned": len(part.given["sets"]),
        "verdicts": dict(sorted(verdicts.items())),
        "labels": {"state": found.state, "why": found.why},
    }
    if not found.labels:
        return values
    names = sorted(part.given["sets"])
    cases = [
        judged(names.index(name), found.labels[name], answers[name]) for name in sorted(answers)
    ]
    planned = Counter(str(label["kind"]) for label in found.labels.values())
    told = scores(cases, dict(sorted(planned.items())))
    return {**values, "scores": told, "ledger": [_row(names[one.index], one) for one in cases]}


def _row(name: str, case: Judged) -> Values:
    """A case as it is listed."""
    return {
        "set": name,
        "kind": case.kind,
        "concealed": "+".join(case.names),
        "multiple": case.multiple,
        "answer": answer_of(case),
        "as_wanted": case.as_wanted,
        "wrong": case.confident_and_wrong,
    }


BLIND = Kind(
    name="blind",
    unit="cases",
    given=given_corpus,
    count=count,
    prepare=prepare,
    execute=execute,
    total=total,
    tell=tell,
)
"""The benchmark of the diagnosis."""
