"""Does a flipped sign in a derivation get noticed? All of them, one at a time.

``python -m reports.flipped_signs.mutants [FILE ...]`` flips every ``+`` and ``-`` of the derivation
files in turn, in a copy, and re-derives what that file contributes. A mutant is caught if the
derivation stops, or if the register's entries or the generated code differ from those committed:
either makes ``meso-robust derive --check`` fail.
"""

from __future__ import annotations

import ast
import json
import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

from derivations import report
from derivations.generate import GENERATED, ROOT, SOURCES

FOLDER = ROOT / "derivations"
SHOWN_BY = {
    "mechanics": ("one_point_sticking", "two_point_sticking", "two_sided_rotation"),
    "_arc": ("one_point_sticking",),
    "one_point_sticking": ("one_point_sticking", "t2_motion"),
    "two_point_sticking": ("two_point_sticking", "t2_motion"),
    "two_sided_rotation": ("two_sided_rotation", "rotation_existence"),
    "symmetries": ("symmetries", "sampling", "final_pose", "polygon_edge"),
}
"""Files whose formulas others use: which contributions show a change (default: the file's own)."""
SECONDS = 120.0
STOPS, DECIDES, SHOWS = "the derivation stops", "a finding changes", "a formula or witness changes"


@dataclass(frozen=True, slots=True)
class Mutant:
    """One flipped sign."""

    file: str
    line: int
    column: int
    """Of the operator, in bytes."""
    was: str

    def __str__(self) -> str:
        """Where it is."""
        return f"derivations/{self.file}.py:{self.line}:{self.column} {self.was!r} flipped"


def mutants(name: str) -> Iterator[Mutant]:
    """Every binary and unary plus and minus of one derivation file."""
    text = (FOLDER / f"{name}.py").read_text(encoding="utf-8")
    lines = [line.encode() for line in text.splitlines()]
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Add | ast.Sub):
            if _is_text(node):
                continue
            was = b"+" if isinstance(node.op, ast.Add) else b"-"
            yield Mutant(name, *_find(lines, node.left, was), was.decode())
        if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub):
            yield Mutant(name, node.lineno, node.col_offset, "-")


def _is_text(node: ast.BinOp) -> bool:
    sides = (node.left, node.right)
    return any(isinstance(side, ast.JoinedStr | ast.List | ast.Tuple) for side in sides) or any(
        isinstance(side, ast.Constant) and isinstance(side.value, str) for side in sides
    )


def _find(lines: list[bytes], left: ast.expr, was: bytes) -> tuple[int, int]:
    """Where the operator behind ``left`` stands; brackets and comments may be in between."""
    assert left.end_lineno is not None
    assert left.end_col_offset is not None
    row, column = left.end_lineno - 1, left.end_col_offset
    while True:
        rest = lines[row][column:].split(b"#")[0]
        if was in rest:
            return row + 1, column + rest.index(was)
        row, column = row + 1, 0


def flipped(mutant: Mutant) -> str:
    """Text of the file with the one sign flipped."""
    lines = (FOLDER / f"{mutant.file}.py").read_text(encoding="utf-8").splitlines()
    line = lines[mutant.line - 1].encode()
    new = b"-" if mutant.was == "+" else b"+"
    lines[mutant.line - 1] = (line[: mutant.column] + new + line[mutant.column + 1 :]).decode()
    return "\n".join(lines) + "\n"


def caught(mutant: Mutant) -> str:
    """How the mutant was noticed; empty if it was not."""
    with tempfile.TemporaryDirectory() as name:
        copy = Path(name) / "derivations"
        shutil.copytree(FOLDER, copy, ignore=shutil.ignore_patterns("__pycache__"))
        (copy / f"{mutant.file}.py").write_text(flipped(mutant), encoding="utf-8")
        for source in SHOWN_BY.get(mutant.file, (mutant.file,)):
            if how := _compared(source, Path(name)):
                return how
    return ""


def _compared(source: str, folder: Path) -> str:
    """How what a file contributes differs from what is committed, derived anew in ``folder``."""
    run = [sys.executable, "-m", "reports.flipped_signs.mutants", "--contribution", source]
    path = os.pathsep.join([str(folder), str(ROOT)])
    try:
        done = subprocess.run(
            run,
            cwd=folder,
            env={**os.environ, "PYTHONPATH": path},
            capture_output=True,
            text=True,
            timeout=SECONDS,
            check=False,
        )
    except subprocess.TimeoutExpired:
        return STOPS
    if done.returncode != 0:
        return STOPS
    expected = committed(source)
    if done.stdout == expected:
        return ""
    return SHOWS if _verdicts(done.stdout) == _verdicts(expected) else DECIDES


def _verdicts(text: str) -> list[object]:
    claims = json.loads(text.splitlines()[0])
    return [(claim["verdict"], [f["holds"] for f in claim["findings"]]) for claim in claims]


def contribution(source: str) -> str:
    """What a derivation file adds to the register and the code, as text."""
    from derivations.generate import code, derive_one
    from derivations.report.register import as_json, chapters, proof_files

    derivation = derive_one(source)
    modules = [text for path, text in code((derivation,)).items() if path.stem == source]
    register = chapters((derivation,))
    claims = json.loads(as_json(register))["claims"]
    proofs = proof_files(register)
    return json.dumps(claims, sort_keys=True) + "\n" + "".join([*proofs.values(), *modules])


def committed(source: str) -> str:
    """The same from the files on disk."""
    register = json.loads((report.FOLDER / "register.json").read_text(encoding="utf-8"))
    place = f"derivations/{source}.py"
    claims = [claim for claim in register["claims"] if claim["derivation"] == place]
    proofs = [report.FOLDER / f["proof"] for c in claims for f in c["findings"] if f["proof"]]
    module = GENERATED / f"{source}.py"
    files = [*proofs, *([module] if module.exists() else [])]
    texts = [path.read_text(encoding="utf-8") for path in files]
    return json.dumps(claims, sort_keys=True) + "\n" + "".join(texts)


def main(names: list[str]) -> int:
    """Run all mutants of the named files (default: all) and print what was not noticed."""
    missed: list[Mutant] = []
    total = 0
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        for name in names or dict.fromkeys([*SHOWN_BY, *SOURCES]):
            mine = list(mutants(name))
            outcomes = list(pool.map(caught, mine))
            counts = "; ".join(f"{outcomes.count(how)} {how}" for how in (STOPS, DECIDES, SHOWS))
            print(f"{name}: {len(mine)} signs flipped: {counts}", flush=True)
            for mutant, how in zip(mine, outcomes, strict=True):
                if not how:
                    missed.append(mutant)
                    print(f"    not noticed: {mutant}", flush=True)
            total += len(mine)
    print(f"{total} in all, {total - len(missed)} noticed")
    return int(bool(missed))


if __name__ == "__main__":
    if sys.argv[1:2] == ["--contribution"]:
        print(contribution(sys.argv[2]), end="")
    else:
        sys.exit(main(sys.argv[1:]))
