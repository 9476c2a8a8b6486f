"""A guest's manners: any folder and locale, nothing written elsewhere, no network, quick to answer."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path

import pytest

from meso_robust.caches import kernels, prepare, user_folder
from meso_robust.tasks import PAPER
from tests.nightly import at_night
from tests.recordings.examples import folder_of

ROOT = Path(__file__).parents[2]
MAIN = "from meso_robust.cli import main; main()"
HEAVY = {"numpy", "scipy", "numba", "casadi", "sympy", "flint", "cv2", "matplotlib", "pydantic"}


def ran(
    *words: object, cwd: Path, environ: Mapping[str, str | None]
) -> subprocess.CompletedProcess[str]:
    """A command in a process of its own; an environment variable that is None is taken away."""
    given = {**os.environ, "PYTHONPATH": str(ROOT), **environ}
    return subprocess.run(
        [sys.executable, "-c", MAIN, *map(str, words)],
        cwd=cwd,
        env={name: value for name, value in given.items() if value is not None},
        capture_output=True,
        encoding="utf-8",
        check=False,
    )


@pytest.fixture(scope="module")
def abroad(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with spaces and letters of other languages."""
    folder = tmp_path_factory.mktemp("abroad") / "Prüfung µ 試験" / "été à Orsay"
    folder.mkdir(parents=True)
    return folder


def events(log: Path) -> list[list[str]]:
    return [line.split("\t") for line in log.read_text(encoding="utf-8").splitlines()]


COMMANDS = {
    "plan": ("plan", "task µ.toml", "--samples", "20", "--out", "out/µ plan"),
    "check": ("check", ROOT / "reports" / "paper_task" / "certificate.json"),
    "recordings": ("recordings", "set é", "--out", "out/recordings"),
    "schema": ("schema", "campaign"),
    "identify": ("identify", "--plan", "task µ.toml", "--out", "out/tests"),
    "--version": ("--version",),
}


@pytest.mark.parametrize(
    "verb",
    [one if one == "plan" else pytest.param(one, marks=at_night) for one in COMMANDS],
)
def test_nothing_is_written_elsewhere_and_nothing_is_sent(
    verb: str, abroad: Path, tmp_path: Path
) -> None:
    """Also: from a folder with any name, a home with any name, and an output that takes ASCII only."""
    shutil.copy(PAPER, abroad / "task µ.toml")
    (abroad / "set é").mkdir(exist_ok=True)
    folder_of(abroad / "set é")
    home, log = tmp_path / "Zuhause ß", tmp_path / "log"
    home.mkdir()
    log.touch()
    hook = tmp_path / "hook"
    hook.mkdir()
    shutil.copy(Path(__file__).with_name("watched.py"), hook / "sitecustomize.py")

    environ = {
        "PYTHONPATH": f"{hook}{os.pathsep}{ROOT}",
        "MESO_WATCHED": str(log),
        "HOME": str(home),
        "LC_ALL": "C",
        "PYTHONIOENCODING": "ascii:strict",
    }
    own = ("XDG_CACHE_HOME", "MPLCONFIGDIR", "HYPOTHESIS_STORAGE_DIRECTORY")
    done = ran(*COMMANDS[verb], cwd=abroad, environ=environ | dict.fromkeys(own))

    assert "Traceback" not in done.stderr
    assert done.returncode in (0, 1), done.stderr  # the two rows of the set are too few
    assert (done.stdout + done.stderr).isascii()
    allowed = (str(abroad / "out"), str(home / ".cache"), "/dev/", str(ROOT / "meso_robust"))
    for event, *what in events(log):
        assert not event.startswith(("socket", "urllib")), (event, what)
        for path in what:
            inside = path.startswith(allowed)
            # whether a folder can be made is found out by making one beside it
            tried = Path(path).parent == abroad and Path(path).name.startswith(".")
            kernel = "__pycache__" in path  # where Python and Numba keep what they compiled
            assert inside or tried or kernel, (event, path)
    assert {path.name for path in abroad.iterdir()} <= {"task µ.toml", "set é", "out"}
    assert {path.name for path in home.iterdir()} <= {".cache"}


def test_the_watch_sees_what_it_should(tmp_path: Path) -> None:
    """A write beside the results and a connection would have been noted."""
    log = tmp_path / "log"
    log.touch()
    shutil.copy(Path(__file__).with_name("watched.py"), tmp_path / "sitecustomize.py")
    code = (
        "import pathlib, socket; pathlib.Path('stray').write_text('x'); pathlib.Path('d').mkdir()\n"
        "s = socket.socket()\n"
        "try: s.connect(('127.0.0.1', 9))\nexcept OSError: pass"
    )
    environ = os.environ | {"PYTHONPATH": str(tmp_path), "MESO_WATCHED": str(log)}
    subprocess.run([sys.executable, "-c", code], cwd=tmp_path, env=environ, check=True)

    found = events(log)
    assert ["write", str(tmp_path / "stray")] in found
    assert ["os.mkdir", str(tmp_path / "d")] in found
    assert any(event[0] == "socket.connect" for event in found)


KERNEL = (
    "from meso_robust.caches import prepare; prepare(); "
    "from meso_robust.bounds import arithmetic; "
    "f = next(v for v in vars(arithmetic).values() if hasattr(v, 'py_func') and v._cache); "
    "print(f._cache.cache_path)"
)


def test_kernels_compile_where_nothing_can_be_written(tmp_path: Path) -> None:
    """A package that only its administrator may write to, used by somebody whose home is closed."""
    # root may write anywhere, unless it gives up that right
    plain = ["setpriv", "--bounding-set=-dac_override"] if os.geteuid() == 0 else []
    if plain and shutil.which("setpriv") is None:
        pytest.skip("root cannot give up its rights without setpriv")
    package, home = tmp_path / "package", tmp_path / "home"
    ignore = shutil.ignore_patterns("__pycache__")
    shutil.copytree(ROOT / "meso_robust", package / "meso_robust", ignore=ignore)
    home.mkdir()
    for path in (home, package, *package.rglob("*")):
        path.chmod(0o555 if path.is_dir() else 0o444)
    done = subprocess.run(
        [*plain, sys.executable, "-B", "-c", KERNEL],
        cwd="/",
        env={"PATH": os.environ["PATH"], "PYTHONPATH": str(package), "HOME": str(home)},
        capture_output=True,
        text=True,
        check=False,
    )
    for path in (package, *package.rglob("*")):
        path.chmod(0o755)
    assert done.returncode == 0, done.stderr
    assert "/meso-robust-" in done.stdout
    assert str(tmp_path) not in done.stdout
    assert not Path(done.stdout.strip()).exists()  # a temporary folder goes with the process
    assert list(home.iterdir()) == []


def test_what_the_user_has_set_stays(tmp_path: Path) -> None:
    environ = {
        "HOME": str(tmp_path),
        "MPLCONFIGDIR": "/mine",
        "XDG_CACHE_HOME": str(tmp_path / "c"),
    }

    prepare(environ)

    assert environ["MPLCONFIGDIR"] == "/mine"
    assert "NUMBA_CACHE_DIR" not in environ
    assert environ["HYPOTHESIS_STORAGE_DIRECTORY"].startswith(str(tmp_path / "c"))
    assert user_folder(environ) == tmp_path / "c"
    assert kernels({"NUMBA_CACHE_DIR": "/there"}) == "/there"


def test_completion_offers_verbs_options_and_names(tmp_path: Path) -> None:
    script = (
        f"#!{sys.executable}\nimport sys\nsys.argv[0] = 'meso-robust'\n"
        "from meso_robust.cli import main\nmain()\n"
    )
    command = tmp_path / "meso-robust"
    command.write_text(script, encoding="utf-8")
    command.chmod(0o755)

    def offered(line: str) -> set[str]:
        count = len(line.split()) - (0 if line.endswith(" ") else 1)
        done = subprocess.run(
            [command],
            cwd=tmp_path,
            env=os.environ
            | {"PYTHONPATH": str(ROOT), "_MESO_ROBUST_COMPLETE": "complete_bash"}
            | {"COMP_WORDS": line, "COMP_CWORD": str(count)},
            capture_output=True,
            text=True,
            check=False,
        )
        return set(done.stdout.split())

    assert offered("meso-robust re") == {"recordings", "reproduce"}
    assert {"--samples", "--seed"} <= offered("meso-robust plan --s")
    assert "--samples" not in offered("meso-robust diagnose --s")
    assert offered("meso-robust schema ca") == {"campaign"}
    # asking changes nothing
    assert [path.name for path in tmp_path.iterdir()] == ["meso-robust"]


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
def test_the_script_of_a_shell_is_shown_and_installed_on_demand_only(
    shell: str, tmp_path: Path
) -> None:
    environ = {"HOME": str(tmp_path), "_TYPER_COMPLETE_TEST_DISABLE_SHELL_DETECTION": "1"}

    shown = ran("--show-completion", shell, cwd=tmp_path, environ=environ)
    assert shown.returncode == 0, shown.stderr
    assert "COMPLETE" in shown.stdout
    assert list(tmp_path.iterdir()) == []

    installed = ran("--install-completion", shell, cwd=tmp_path, environ=environ)
    assert installed.returncode == 0, installed.stderr
    assert list(tmp_path.iterdir()) != []


@pytest.mark.parametrize(
    ("words", "heavy"),
    [
        (["--help"], HEAVY),
        (["plan", "--help"], HEAVY - {"pydantic"}),  # Typer itself can load it
        (["schema", "task"], HEAVY - {"pydantic"}),
        (["--version"], HEAVY - {"numpy"}),
    ],
)
def test_quick_answers_load_nothing_heavy(
    words: list[str], heavy: set[str], tmp_path: Path
) -> None:
    code = (
        f"import sys; from meso_robust.cli import app; app({words!r}, standalone_mode=False); "
        f"print(sorted({heavy!r} & set(sys.modules)))"
    )
    environ = os.environ | {"PYTHONPATH": str(ROOT)}
    done = subprocess.run(
        [sys.executable, "-c", code],
        cwd=tmp_path, env=environ, capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    assert done.stdout.splitlines()[-1] == "[]"
