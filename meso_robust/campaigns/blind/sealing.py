"""Labels committed to before the diagnoser runs, and opened after it has.

``commitment.json`` is written first: a hash of every label with a salt, their Merkle root, and a
hash of the diagnoser. Labels and salts stay in a second file, which the scoring opens and checks.
Every case draws its random numbers from a seed that is a hash of the diagnoser and of a salt drawn
when the commitment was made, so the diagnoser cannot have been fitted to the cases.
"""

from __future__ import annotations

import hashlib
import json
import os
import secrets
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

SCHEMA = "meso-robust/blind-commitment/1"
COMMITMENT, SEALED, RESULTS = "commitment.json", "sealed.jsonl", "results.jsonl"
SETS = "sets"
"""Folder of the recording sets, each a folder; their order is that of the cases."""
SOURCES = ("*.py", "*.json", "*.toml")
"""What the diagnoser's behaviour may depend on, below its folder."""

Values = Mapping[str, Any]


class SealError(Exception):
    """What is opened is not what was committed to, or a second shot is tried."""


@dataclass(frozen=True, slots=True)
class Sealed:
    """A case as it is sealed: its label, the digest of its recordings, and a salt."""

    index: int
    label: Values
    recordings: str
    """`digest` of the folder that was written."""
    salt: str
    """256 random bits, hexadecimal."""

    @property
    def hash(self) -> str:
        """What is committed to; hexadecimal."""
        content = {"label": self.label, "recordings": self.recordings}
        return sha256(canonical(content) + bytes.fromhex(self.salt))


@dataclass(frozen=True, slots=True, kw_only=True)
class Commitment:
    """What is published before the first diagnosis; all hashes SHA-256, hexadecimal."""

    schema: str = SCHEMA
    date: str
    diagnoser: str
    """`digest` of the diagnoser's sources."""
    generator: str
    """`digest` of the benchmark's own sources: generator, scoring and the rest."""
    master: str
    """Hash of the master salt, from which and from ``diagnoser`` the seeds follow."""
    corpus: Values
    quick: bool
    """Whether the diagnoser is asked for its quick form."""
    cases: tuple[str, ...]
    """`Sealed.hash` of every case, in the order in which they are run."""
    root: str
    """Merkle root of ``cases``."""

    def text(self) -> str:
        """The file's content."""
        return json.dumps(asdict(self), indent=1) + "\n"


def sha256(content: bytes) -> str:
    """Digest in hexadecimal."""
    return hashlib.sha256(content).hexdigest()


def canonical(value: object) -> bytes:
    """The one JSON text of a value: sorted keys, no spaces, UTF-8.

    Raises
    ------
    ValueError
        A number is not finite.
    """
    text = json.dumps(
        value, sort_keys=True, separators=(",", ":"), ensure_ascii=False, allow_nan=False
    )
    return text.encode()


def digest(folder: Path, patterns: Sequence[str] = ("*",)) -> str:
    """Hash of all files below a folder that match, by their names and contents."""
    found = {path for pattern in patterns for path in folder.rglob(pattern) if path.is_file()}
    kept = sorted(path for path in found if "__pycache__" not in path.parts)
    names = {str(path.relative_to(folder)): sha256(path.read_bytes()) for path in kept}
    return sha256(canonical(names))


def merkle_root(leaves: Sequence[str]) -> str:
    """Root of the binary tree over hashes; an odd one out moves up a level (as RFC 6962 has it)."""
    level = [bytes.fromhex(leaf) for leaf in leaves]
    while len(level) > 1:
        pairs = [level[k : k + 2] for k in range(0, len(level), 2)]
        level = [hashlib.sha256(b"\x01" + b"".join(p)).digest() if p[1:] else p[0] for p in pairs]
    return level[0].hex() if level else sha256(b"")


def new_salt() -> str:
    """256 random bits, hexadecimal."""
    return secrets.token_hex(32)


def seed_of(diagnoser: str, master: str, index: int) -> int:
    """Seed of a case, 48 bits; ``master`` is the master salt itself."""
    content = bytes.fromhex(diagnoser) + bytes.fromhex(master) + index.to_bytes(4, "big")
    return int(sha256(content)[:12], 16)


def opened(folder: Path) -> tuple[Commitment, list[Sealed]]:
    """Commitment and labels, each label held against its hash.

    Raises
    ------
    SealError
        A label, a salt, the root or a seed is not what was committed to.
    """
    commitment = read_commitment(folder)
    master, cases = read_sealed(folder)
    if sha256(bytes.fromhex(master)) != commitment.master:
        raise SealError(f"{folder / SEALED}: the master salt is not the one committed to")
    if [case.index for case in cases] != list(range(len(commitment.cases))):
        raise SealError(f"{folder / SEALED}: cases are missing, duplicated or out of order")
    for case, expected in zip(cases, commitment.cases, strict=True):
        _check(case, expected, seed_of(commitment.diagnoser, master, case.index))
    if merkle_root(commitment.cases) != commitment.root:
        raise SealError(f"{folder / COMMITMENT}: the root is not that of the hashes")
    return commitment, cases


def _check(case: Sealed, expected: str, seed: int) -> None:
    if case.hash != expected:
        raise SealError(f"case {case.index}: the label opened is not the label committed to")
    if case.label.get("seed", seed) != seed:
        raise SealError(f"case {case.index}: its seed does not follow from the commitment")


def read_commitment(folder: Path) -> Commitment:
    """The file as it stands."""
    values = json.loads((folder / COMMITMENT).read_text(encoding="utf-8"))
    return Commitment(**{**values, "cases": tuple(values["cases"])})


def read_sealed(folder: Path) -> tuple[str, list[Sealed]]:
    """Master salt and cases, unchecked, in the order of their indices."""
    head, *lines = whole_lines(folder / SEALED)
    return head["master"], sorted((Sealed(**line) for line in lines), key=lambda case: case.index)


def read_results(folder: Path) -> dict[int, Values]:
    """Results by the index of their case.

    Raises
    ------
    SealError
        A case has two results.
    """
    found: dict[int, Values] = {}
    for line in whole_lines(folder / RESULTS):
        if line["index"] in found:
            raise SealError(f"{folder / RESULTS}: case {line['index']} was diagnosed twice")
        found[line["index"]] = line
    return found


def whole_lines(path: Path) -> list[dict[str, Any]]:
    """All lines of a file of JSON lines, but for a last one that was cut short."""
    if not path.exists():
        return []
    *lines, _ = path.read_text(encoding="utf-8").split("\n")
    return [json.loads(line) for line in lines]


def append(path: Path, value: Values) -> None:
    """Add a line to a file of JSON lines, on the disk when this returns."""
    with path.open("a+b") as file:
        file.seek(0)
        file.truncate(file.read().rfind(b"\n") + 1)  # a truncated line is rewritten
        file.write(canonical(value) + b"\n")
        file.flush()
        os.fsync(file.fileno())
