"""A corpus on the disk: which recording sets there are, and what is concealed in each."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

from pydantic import ValidationError

from meso_robust.campaigns.blind.labels import Label
from meso_robust.campaigns.blind.sealing import (
    COMMITMENT,
    SEALED,
    SETS,
    SealError,
    digest,
    opened,
    sha256,
)
from meso_robust.errors import InputError

LABELS = "labels.jsonl"
Values = Mapping[str, Any]
State = Literal["committed", "stated", "withheld", "broken"]


def sets_of(corpus: Path) -> dict[str, str]:
    """Digest of every recording set by the name of its folder, in their order.

    Raises
    ------
    InputError
        There is none.
    """
    folder = corpus / SETS
    found = sorted(path for path in folder.glob("*") if path.is_dir())
    if not found:
        raise InputError(
            f"{folder}: holds no recording sets; a corpus needs a folder {SETS!r} with a folder for "
            "each set in it"
        )
    return {path.name: digest(path) for path in found}


def labels_hash(corpus: Path) -> str:
    """Hash of the file that settles what is concealed: the commitment, else the labels themselves.

    Raises
    ------
    InputError
        There is neither.
    """
    for name in (COMMITMENT, LABELS):
        if (corpus / name).is_file():
            return sha256((corpus / name).read_bytes())
    raise InputError(
        f"{corpus}: holds neither {COMMITMENT} nor {LABELS}; a corpus must state what is hidden in "
        f'each set: give {LABELS} with a line {{"set": NAME, "label": {{...}}}} for each'
    )


@dataclass(frozen=True, slots=True)
class Opened:
    """What is concealed, as far as it is known."""

    state: State
    """``committed``: every label is the one committed to; ``stated``: there is no commitment;
    ``withheld``: there is one, but the labels are not there; ``broken``: something is not as it
    was."""
    why: str
    """In words."""
    labels: Mapping[str, Values]
    """Label of each set by its name; none if they are withheld or broken."""


def opened_labels(corpus: Path, sets: Mapping[str, str], hashed: str) -> Opened:
    """Open the labels, after the diagnosis.

    Parameters
    ----------
    corpus, sets, hashed
        The folder, and what ``sets_of`` and ``labels_hash`` found when the campaign began.
    """
    try:
        if labels_hash(corpus) != hashed:
            raise SealError("the file that states the labels has changed since the campaign began")
        if not (corpus / COMMITMENT).is_file():
            return Opened("stated", "there is no commitment to the labels", _stated(corpus, sets))
        if not (corpus / SEALED).is_file():
            return Opened("withheld", f"{SEALED} is not there yet", {})
        return Opened("committed", "every label is the one committed to", _sealed(corpus, sets))
    except (SealError, InputError, OSError, ValueError, KeyError, TypeError) as error:
        return Opened("broken", f"{type(error).__name__}: {error}", {})


def _sealed(corpus: Path, sets: Mapping[str, str]) -> dict[str, Values]:
    _, cases = opened(corpus)
    names = sorted(sets)
    if len(cases) != len(names):
        raise SealError(f"{len(names)} recording sets, but {len(cases)} labels were committed to")
    for name, case in zip(names, cases, strict=True):
        if case.recordings != sets[name]:
            raise SealError(f"set {name}: its recordings are not the ones that were sealed")
    return {
        name: _checked(case.label, f"{SEALED}: case {case.index}")
        for name, case in zip(names, cases, strict=True)
    }


def _stated(corpus: Path, sets: Mapping[str, str]) -> dict[str, Values]:
    found: dict[str, Values] = {}
    for number, name, label in _lines(corpus / LABELS):
        where = f"{corpus / LABELS}, line {number}"
        if name not in sets or name in found:
            wrong = "twice" if name in found else "no folder"
            raise InputError(f"{where}: set = {name!r}: {wrong}; name each folder of {SETS} once")
        found[name] = _checked(label, where)
    missing = sorted(sets.keys() - found.keys())
    if missing:
        raise InputError(f"{corpus / LABELS}: no line for set {missing[0]!r}; give each set one")
    return found


def _lines(path: Path) -> Iterator[tuple[int, str, Values]]:
    for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
        try:
            values = json.loads(line)
            yield number, str(values["set"]), values["label"]
        except (ValueError, KeyError, TypeError) as error:
            raise InputError(
                f'{path}, line {number}: must be {{"set": NAME, "label": {{...}}}} ({error!r})'
            ) from error


def _checked(label: Any, where: str) -> Values:
    try:
        Label.model_validate(label)
    except ValidationError as error:
        first = error.errors(include_url=False)[0]
        key = ".".join(map(str, ("label", *first["loc"])))
        raise InputError(f"{where}: {key}: {first['msg']}") from error
    return dict(label)
