"""The guide to adding an effect, followed to the letter in a copy of the package.

``python -m reports.guide.adding_an_effect`` also looks for the toy effect in recordings of the blind generator
before and after; it compiles the simulator of the copy, which takes some minutes.
"""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import meso_robust

PACKAGE = Path(meso_robust.__file__).parent
GUIDE = PACKAGE / "diagnosis" / "ADDING_AN_EFFECT.md"
TOY = "camera_aspect"
_STEP = re.compile(r"In\s+`([^`]+)`, after the\s+line `([^`]+)`:\n\n```text\n(.*?)```", re.DOTALL)
_DIAGNOSE = """
import json, sys
from pathlib import Path
from meso_robust.diagnosis.answer import diagnosed
found = diagnosed(Path(sys.argv[1]), quick=True)
print(json.dumps({"verdict": found["verdict"], "effects": found["effects"]}))
"""


def steps() -> list[tuple[str, str, str]]:
    """File, line after which to insert, and text, of every step of the guide."""
    return _STEP.findall(GUIDE.read_text(encoding="utf-8"))


def followed(folder: Path) -> Path:
    """A copy of the package in a folder, with the steps of the guide taken."""
    copy = folder / "meso_robust"
    shutil.copytree(PACKAGE, copy, ignore=shutil.ignore_patterns("__pycache__"))
    for file, line, text in steps():
        path = folder / file
        before = path.read_text(encoding="utf-8")
        assert before.count(f"{line}\n") == 1, f"{file}: {line!r} must stand there once"
        path.write_text(before.replace(f"{line}\n", f"{line}\n{text}"), encoding="utf-8")
    return copy


def run(code: str, folder: Path | None, *arguments: str) -> str:
    """What a Python process prints that imports the package from a folder."""
    path = {} if folder is None else {"PYTHONPATH": str(folder)}
    done = subprocess.run(
        [sys.executable, "-c", code, *arguments],
        env={**os.environ, **path},
        cwd=folder,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


def main() -> None:
    """Conceal the toy effect; diagnose without and with it in the catalogue."""
    from reports.blind.generator import Case, make, write

    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        data = folder / "set"
        write(make(Case(kind="outside", names=(TOY,), multiples=(8.0,), seed=1)), data)
        sys.stdout.write(f"without: {run(_DIAGNOSE, None, str(data))}")
        followed(folder)
        found = json.loads(run(_DIAGNOSE, folder, str(data)))
        sys.stdout.write(f"with:    {json.dumps(found)}\n")


if __name__ == "__main__":
    main()
