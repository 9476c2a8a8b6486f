"""The list of cases, their sets, and the commitment to both that is made before any diagnosis."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from reports.blind3.generate import (
    Change,
    World,
    clear_norm,
    filmed,
    pushes,
    recorded,
    small_wrongs,
    write,
)
from reports.blind3.laws import FAMILIES, OUTSIDE, Family

HERE = Path(__file__).parent
SETS, CASES, COMMITMENT = HERE / "sets", HERE / "cases.json", HERE / "commitment.json"
COUNT, SEED = 400, 20261124
LIMIT = 5.0
"""Norm in standard deviations at which a change of the poses is just detectable; see `clear_norm`."""
LARGEST = 300.0
"""Largest size over the just detectable one."""
_TWENTY = ("single",) * 10 + ("null",) * 4 + ("pair",) * 3 + ("outside",) * 3

Values = Mapping[str, Any]


@dataclass(frozen=True, slots=True, kw_only=True)
class Case:
    """What a set is to conceal."""

    id: int
    kind: str
    families: tuple[str, ...]
    multiples: tuple[float, ...]
    """Sizes over the just detectable ones, as drawn."""
    seed: int


def listed(count: int = COUNT, seed: int = SEED) -> list[Case]:
    """All cases, kinds interleaved so that any beginning of the list is a fair sample."""
    rng = np.random.default_rng(seed)
    decks: dict[str, list[str]] = {"in": [], "out": []}
    cases = []
    for k in range(count):
        if k % len(_TWENTY) == 0:
            order = rng.permutation(len(_TWENTY))
        kind = _TWENTY[order[k % len(_TWENTY)]]
        names: tuple[str, ...] = ()
        if kind in ("single", "pair"):
            names = (_drawn(decks, "in", FAMILIES, rng),)
        if kind == "pair":
            other = [n for n in FAMILIES if FAMILIES[n].stage != FAMILIES[names[0]].stage]
            names = (*names, str(rng.choice(other)))
        if kind == "outside":
            names = (_drawn(decks, "out", OUTSIDE, rng),)
        sizes = tuple(round(float(np.exp(rng.uniform(0.0, np.log(LARGEST)))), 3) for _ in names)
        cases.append(
            Case(id=k, kind=kind, families=names, multiples=sizes, seed=int(rng.integers(2**31)))
        )
    return cases


def _drawn(
    decks: dict[str, list[str]], deck: str, names: Mapping[str, Family], rng: np.random.Generator
) -> str:
    if not decks[deck]:
        decks[deck] = [str(name) for name in rng.permutation(list(names))]
    return decks[deck].pop()


def sealed(case: Case, folder: Path) -> Values:
    """Make the set of a case; return what is true of it, with measured sizes."""
    rng = np.random.default_rng(case.seed)
    plan, wrongs = pushes(rng), small_wrongs(rng)
    plain = World(mu=float(rng.uniform(0.2, 0.4)), rho=float(rng.uniform(430.0, 520.0)))
    norm = clear_norm(plain, plan)
    changes: list[Change] = []
    sizes: list[float] = []
    measured: list[float] = []
    truth: dict[str, float] = {}
    for name, multiple in zip(case.families, case.multiples, strict=True):
        family, shape = {**FAMILIES, **OUTSIDE}[name], int(rng.integers(2**31))

        def change(size: float, family: Family = family, shape: int = shape) -> Change:
            return family.make(size, np.random.default_rng(shape))

        def seen(size: float) -> float:
            world = World(changes=(change(size),), mu=plain.mu, rho=plain.rho)
            return norm([filmed(world, push) for push in plan])

        unit = family.guess * LIMIT / max(seen(family.guess), 1e-3)
        size = min(multiple * unit, family.most)
        changes.append(change(size))
        sizes.append(size)
        measured.append(seen(size) / LIMIT)
        truth.update(changes[-1].truth)
    small = World(wrongs=wrongs, mu=plain.mu, rho=plain.rho)
    small_norm = norm([filmed(small, push) for push in plan]) / LIMIT
    whole = World(changes=tuple(changes), wrongs=wrongs, mu=plain.mu, rho=plain.rho)
    poses = [filmed(whole, push) for push in plan]
    write(folder, recorded(whole, plan, poses, rng))
    return {
        "sizes": sizes,
        "measured": measured,
        "small": small_norm,
        "whole": norm(poses) / LIMIT,
        "truth": truth,
        "wrongs": asdict(wrongs),
        "mu": plain.mu,
        "rho": plain.rho,
    }


def digest(folder: Path) -> str:
    """Hash of the files of a set by name and content."""
    total = hashlib.sha256()
    for path in sorted(folder.iterdir()):
        total.update(path.name.encode() + b"\0" + path.read_bytes() + b"\0")
    return total.hexdigest()


def text_hash(paths: Sequence[Path]) -> str:
    """Hash of files by name and content, in the order given."""
    total = hashlib.sha256()
    for path in paths:
        total.update(path.name.encode() + b"\0" + path.read_bytes() + b"\0")
    return total.hexdigest()


def generator_hash() -> str:
    """Hash of everything that the sets follow from."""
    plant = sorted((HERE.parents[1] / "meso_robust" / "plant").glob("*.py"))
    return text_hash([HERE / "generate.py", HERE / "laws.py", HERE / "cases.py", *plant])


def commit(first: int, last: int, sets: Path = SETS, commitment: Path = COMMITMENT) -> None:
    """Make the sets of a range of cases and add their hashes to the commitment."""
    cases = [asdict(case) for case in listed()]
    text = "[\n" + ",\n".join(json.dumps(case) for case in cases) + "\n]\n"
    (commitment.parent / CASES.name).write_text(text, encoding="utf-8")
    promised: dict[str, Any] = {
        "cases_sha256": hashlib.sha256(text.encode()).hexdigest(),
        "generator_sha256": generator_hash(),
        "sets": {},
    }
    if commitment.exists():
        before = json.loads(commitment.read_text(encoding="utf-8"))
        if any(before[key] != promised[key] for key in ("cases_sha256", "generator_sha256")):
            raise SystemExit(f"{commitment}: made with other cases or another generator")
        promised = before
    for case in listed()[first:last]:
        key = f"{case.id:03d}"
        if key in promised["sets"]:
            continue
        label = sealed(case, sets / key)
        promised["sets"][key] = {"sha256": digest(sets / key), **label}
        print(key, case.kind, *case.families, [round(m, 1) for m in label["measured"]], flush=True)
        commitment.write_text(json.dumps(promised, indent=1) + "\n", encoding="utf-8")


def renew(sets: Path, commitment: Path = COMMITMENT) -> list[str]:
    """Make every promised set again; if each is the same to the last byte, promise them of this generator.

    For a generator that was made faster or clearer and gives what it gave. Returns the sets that differ: if
    there is one, the commitment stays as it is.
    """
    promised = json.loads(commitment.read_text(encoding="utf-8"))
    differ = []
    for case in listed():
        key = f"{case.id:03d}"
        before = promised["sets"].get(key)
        if before is None:
            continue
        label = sealed(case, sets / key)
        if before != json.loads(json.dumps({"sha256": digest(sets / key), **label})):
            differ.append(key)
        print(key, "differs" if key in differ else "is the same", flush=True)
    if not differ:
        promised["generator_sha256"] = generator_hash()
        commitment.write_text(json.dumps(promised, indent=1) + "\n", encoding="utf-8")
    return differ


def checked(case: Case, sets: Path = SETS, commitment: Path = COMMITMENT) -> Path:
    """The folder of a set that is as it was promised.

    Raises
    ------
    ValueError
        It was never promised, or a file of it is another one now.
    """
    key = f"{case.id:03d}"
    promised = json.loads(commitment.read_text(encoding="utf-8"))
    if key not in promised["sets"]:
        raise ValueError(f"case {key}: not in {commitment.name}; commit to it first")
    text = (commitment.parent / CASES.name).read_bytes()
    if hashlib.sha256(text).hexdigest() != promised["cases_sha256"]:
        raise ValueError(f"{CASES.name}: is not the list that {commitment.name} promises")
    if digest(sets / key) != promised["sets"][key]["sha256"]:
        raise ValueError(f"case {key}: a file differs from what {commitment.name} promises")
    return sets / key
