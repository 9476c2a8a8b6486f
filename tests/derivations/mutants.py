"""Does a flipped sign in a derivation get noticed? All of them, one at a time.

``python -m tests.derivations.mutants [FILE ...]`` flips every ``+`` and ``-`` of the derivation
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
SHARED = {"mechanics": ("one_point_sticking", "two_point_sticking", "two_sided_rotation"),
          "_arc": ("one_point_sticking",)}  # fmt: skip
"""Files that contribute through others: which of these show it."""
SECONDS = 120.0


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
        path = os.pathsep.join([name, str(ROOT)])
        for source in SHARED.get(mutant.file, (mutant.file,)):
            run = [sys.executable, "-m", "tests.derivations.mutants", "--contribution", source]
            try:
                done = subprocess.run(
                    run,
                    cwd=name,
                    env={**os.environ, "PYTHONPATH": path},
                    capture_output=True,
                    text=True,
                    timeout=SECONDS,
                    check=False,
                )
            except subprocess.TimeoutExpired:
                return "runs out of time"
            if done.returncode != 0:
                return done.stderr.strip().splitlines()[-1]
            if done.stdout != committed(source):
                return "what it contributes differs"
    return ""


def contribution(source: str) -> str:
    """What a derivation file adds to the register and the code, as text."""
    from derivations.generate import code, derive_one
    from derivations.report.register import as_json, chapters

    derivation = derive_one(source)
    modules = [text for path, text in code((derivation,)).items() if path.stem == source]
    claims = json.loads(as_json(chapters((derivation,))))["claims"]
    return json.dumps(claims, sort_keys=True) + "".join(modules)


def committed(source: str) -> str:
    """The same from the files on disk."""
    register = json.loads((report.FOLDER / "register.json").read_text(encoding="utf-8"))
    place = f"derivations/{source}.py"
    claims = [claim for claim in register["claims"] if claim["derivation"] == place]
    module = GENERATED / f"{source}.py"
    text = module.read_text(encoding="utf-8") if module.exists() else ""
    return json.dumps(claims, sort_keys=True) + text


def main(names: list[str]) -> int:
    """Run all mutants of the named files (default: all) and print what was not noticed."""
    chosen = [m for name in names or [*SHARED, *SOURCES] for m in mutants(name)]
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        outcomes = list(zip(chosen, pool.map(caught, chosen), strict=True))
    missed = [mutant for mutant, how in outcomes if not how]
    for name in dict.fromkeys(mutant.file for mutant in chosen):
        mine = [how for mutant, how in outcomes if mutant.file == name]
        print(f"{name:22} {len(mine):4} signs flipped, {sum(map(bool, mine)):4} noticed")
    for mutant in missed:
        print(f"not noticed: {mutant}")
    print(f"{len(chosen)} in all, {len(chosen) - len(missed)} noticed")
    return int(bool(missed))


if __name__ == "__main__":
    if sys.argv[1:2] == ["--contribution"]:
        print(contribution(sys.argv[2]), end="")
    else:
        sys.exit(main(sys.argv[1:]))
