"""The guide's way to a new support model and to a verb, to the letter in a copy of the package."""

from __future__ import annotations

import json
import re
import shutil
from pathlib import Path

import pytest

from meso_robust.certificates.premise import Premise
from meso_robust.guide import GUIDE
from reports.guide.adding_an_effect import PACKAGE, run

_PAGE = (GUIDE / "extending.md").read_text(encoding="utf-8")
_NEW = re.compile(r"New file\s`([^`]+)`:\n\n```python\n(.*?)^```", re.DOTALL | re.MULTILINE)
_LINE = re.compile(
    r"In\s+`([^`]+)`, after the\s+line `([^`]+)`:\n\n```text\n(.*?)^```", re.DOTALL | re.MULTILINE
)
_LOOK = """
import json
import numpy as np
import meso_robust
from meso_robust.identification.identify import identify
from meso_robust.identification.models import MODELS
from meso_robust.transfer.lines import BASES

corners = np.array([[-8e-4, -4e-4], [8e-4, -4e-4], [8e-4, 4e-4], [-8e-4, 4e-4]])
model = MODELS["two_drags"](corners)
drawn = model.draw(np.random.default_rng(0), 50)
tables = model.physics(np.array([[3e-7, 1.5, 0.3]])).support.tables()
print(json.dumps({
    "file": meso_robust.__file__,
    "keys": model.keys,
    "valid": bool(model.valid(drawn).all()),
    "film": tables.film[0].tolist(),
    "dry": tables.points.size,
    "premise": BASES["two_drags"].premise,
}))
"""


@pytest.fixture(scope="module")
def copy(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("copy")
    shutil.copytree(
        PACKAGE, folder / "meso_robust", ignore=shutil.ignore_patterns("__pycache__", "*.mp4")
    )
    for file, source in _NEW.findall(_PAGE):
        assert not (folder / file).exists()
        (folder / file).write_text(source, encoding="utf-8")
    for file, line, more in _LINE.findall(_PAGE):
        before = (folder / file).read_text(encoding="utf-8")
        assert before.count(f"{line}\n") == 1, f"{file}: {line!r} must stand there once"
        after = before.replace(f"{line}\n", f"{line}\n{more}")
        (folder / file).write_text(after, encoding="utf-8")
    return folder


def test_a_support_model_is_added_by_the_steps_of_the_guide(copy: Path) -> None:
    assert (len(_NEW.findall(_PAGE)), len(_LINE.findall(_PAGE))) == (3, 4)
    found = json.loads(run(_LOOK, copy))

    assert found["file"].startswith(str(copy))
    assert found["keys"] == ["rho_um2", "across", "mu"]
    assert found["valid"] is True
    # the upper triangle of diag(1, a, ρ), row by row
    assert found["film"] == pytest.approx([1.0, 0.0, 0.0, 1.5, 0.0, 3e-7])
    assert found["dry"] == 0
    assert found["premise"] == Premise.FILM_DRAG


def test_the_command_line_of_the_copy_knows_the_model(copy: Path) -> None:
    from meso_robust.identification.models import MODELS

    code = "from meso_robust.identification.models import MODELS; print(*MODELS)"

    assert "two_drags" in run(code, copy).split()
    assert "two_drags" not in MODELS


_CALLED = """
import sys
from typer.testing import CliRunner
from meso_robust.cli import app
for line in ("--help", "area --help", "area TASK --json", "area TASK --least-um2 2e6", "area TASK --least-um2 -1"):
    words = [sys.argv[-1] if word == "TASK" else word for word in line.split()]
    done = CliRunner().invoke(app, words)
    print(done.exit_code, " ".join(done.output.split()))
"""


def test_a_verb_is_added_by_the_steps_of_the_guide(
    copy: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    task = copy / "meso_robust" / "tasks" / "paper.toml"
    said = run(_CALLED.replace("sys.argv[-1]", repr(str(task))), copy).splitlines()

    listed, explained, printed, refuted, refused = said
    assert "Measures: area Tell how large a rectangular part is; write area.json." in listed
    assert (
        "--least-um2 <float range> The answer is no for a smaller part. [default: 0.0; x>=0]"
        in explained
    )
    assert printed == '0 {"area_um2": 1352592.0}'  # 1616 times 837
    assert refuted.startswith("1 ")
    assert refuted.endswith(f"1.35259e+06 µm² figures: {Path('meso-robust-area', 'area.json')}")
    assert refused.startswith("2 ")
    assert "--least-um2" in refused
