"""Wheel and sdist: what is in them, what is not, and that the wheel works away from the checkout."""

from __future__ import annotations

import email
import os
import subprocess
import sys
import tarfile
import tomllib
import zipfile
from email.message import Message
from pathlib import Path

import pydantic
import pytest

from tests.nightly import at_night

ROOT = Path(__file__).parents[2]
DATA = (".json", ".j2", ".css", ".js", ".html", ".toml", ".md", ".typed", ".png", ".mp4", ".csv")


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder with both, built without the network by what is installed."""
    folder = tmp_path_factory.mktemp("dist")
    offline = ("--offline", "--no-build-isolation", f"--python={sys.executable}", "--quiet")
    subprocess.run(
        [
            sys.executable,
            "-m",
            "uv",
            "build",
            *offline,
            "--wheel",
            "--sdist",
            f"--out-dir={folder}",
            str(ROOT),
        ],
        check=True,
    )
    return folder


@pytest.fixture(scope="module")
def installed(built: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder with the wheel's files, in a place that has spaces and letters of other languages."""
    target = tmp_path_factory.mktemp("Prüfung µ 試験") / "été"
    with zipfile.ZipFile(next(built.glob("*.whl"))) as wheel:
        wheel.extractall(target)
    return target


def tracked(*folders: str) -> set[str]:
    """Files of the project that are sources or data, by their path."""
    found = (path for folder in folders for path in (ROOT / folder).rglob("*") if path.is_file())
    return {
        path.relative_to(ROOT).as_posix()
        for path in found
        if "__pycache__" not in path.parts and path.suffix in {".py", *DATA}
    }


def test_the_wheel_holds_every_source_and_data_file_and_nothing_else(built: Path) -> None:
    with zipfile.ZipFile(next(built.glob("*.whl"))) as wheel:
        names = {name for name in wheel.namelist() if ".dist-info/" not in name}
    assert names == tracked("meso_robust", "derivations")
    assert {"meso_robust/py.typed", "meso_robust/tasks/paper.toml"} <= names
    assert "meso_robust/diagnosis/ADDING_AN_EFFECT.md" in names


def test_the_sdist_holds_what_one_needs_to_build_and_test(built: Path) -> None:
    with tarfile.open(next(built.glob("*.tar.gz"))) as sdist:
        names = {name.split("/", 1)[1] for name in sdist.getnames()}
    assert tracked("meso_robust", "derivations", "tests") <= names
    for file in ("pyproject.toml", "README.md", "LICENSE", "CHANGELOG.md", "CITATION.cff"):
        assert file in names
    assert {"SECURITY.md", "Makefile", "requirements.lock"} <= names
    programs = {name for name in names if name.startswith("reports/")}
    assert programs == {
        *(name for name in tracked("reports") if name.endswith(".py")),
        "reports/benchmarks/requirements.txt",
        "reports/benchmarks/requirements.lock",
    }  # and nothing that they wrote
    for unwanted in (".hypothesis/", ".git/", ".venv/", ".ci/"):
        assert not any(name.startswith(unwanted) for name in names)
    assert not any(name.endswith((".pyc", ".nbi", ".nbc")) for name in names)


def metadata(built: Path) -> Message:
    with zipfile.ZipFile(next(built.glob("*.whl"))) as wheel:
        name = next(name for name in wheel.namelist() if name.endswith("/METADATA"))
        return email.message_from_bytes(wheel.read(name))


def test_the_metadata_say_what_the_project_says(built: Path) -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    told = metadata(built)

    assert told["Version"] == project["version"]
    assert told["License-Expression"] == "Apache-2.0"
    assert told["Requires-Python"] == ">=3.11"
    assert sorted(told.get_all("Provides-Extra", [])) == [
        "cluster",
        "derive",
        "dev",
        "lab",
        "tables",
    ]
    plain = [line for line in told.get_all("Requires-Dist", []) if "extra ==" not in line]
    assert sorted(plain) == sorted(project["dependencies"])
    assert not told.get_all("Project-URL")  # none is known
    assert str(told.get_payload()).startswith("# meso-robust")


def ran(installed: Path, *words: str) -> subprocess.CompletedProcess[str]:
    code = "from meso_robust.cli import main; main()"
    return subprocess.run(
        [sys.executable, "-B", "-c", code, *words],
        cwd=installed.parent,
        env=os.environ | {"PYTHONPATH": str(installed)},
        capture_output=True,
        text=True,
        check=False,
    )


def test_the_wheel_works_away_from_the_checkout(installed: Path) -> None:
    told = ran(installed, "--version")
    assert told.returncode == 0, told.stderr
    assert f"installed in{' ' * 17}{installed}" in told.stdout or str(installed) in told.stdout
    assert "not a checkout" in told.stdout

    schema = ran(installed, "schema", "task")
    assert schema.returncode == 0, schema.stderr
    assert '"film_ratio_um2"' in schema.stdout

    helped = ran(installed, "plan", "--help")
    assert helped.returncode == 0
    assert "--samples" in helped.stdout

    checked = ran(installed, "check", str(ROOT / "reports" / "paper_task" / "certificate.json"))
    assert checked.returncode == 0, checked.stderr
    assert "VERIFIED" in checked.stdout or "PROVED" in checked.stdout

    derived = ran(installed, "derive", "--check")
    assert derived.returncode == 2
    assert "checkout" in derived.stderr


def checked(project: Path, venv: Path) -> str:
    """What mypy says of a project whose environment is another one than this."""
    done = subprocess.run(
        [
            *(sys.executable, "-m", "mypy", "--strict", "--config-file="),
            *(f"--python-executable={venv / 'bin' / 'python'}", "--follow-imports=silent"),
            *(f"--cache-dir={project / 'cache'}", str(project / "user.py")),
        ],
        cwd=project,
        env={name: value for name, value in os.environ.items() if name != "PYTHONPATH"},
        capture_output=True,
        text=True,
        check=False,
    )
    return done.stdout


@at_night
def test_a_project_that_uses_the_package_type_checks(built: Path, tmp_path: Path) -> None:
    venv = tmp_path / "venv"
    subprocess.run([sys.executable, "-m", "venv", "--without-pip", venv], check=True)
    site = next(venv.glob("lib/python*/site-packages"))
    with zipfile.ZipFile(next(built.glob("*.whl"))) as wheel:
        wheel.extractall(site)
    (site / "others.pth").write_text(str(Path(pydantic.__file__).parents[1]), encoding="utf-8")
    (tmp_path / "user.py").write_text(
        "from pathlib import Path\n"
        "from meso_robust.task import Task, load_task\n"
        "task: Task = load_task(Path('task.toml'))\n"
        "reveal_type(task.uncertainty.sensed_position_um)\n",
        encoding="utf-8",
    )

    told = checked(tmp_path, venv)
    assert 'Revealed type is "float"' in told or "builtins.float" in told
    assert "error" not in told

    next(site.glob("meso_robust/py.typed")).unlink()
    assert "py.typed" in checked(tmp_path, venv)  # else the test above could not fail
