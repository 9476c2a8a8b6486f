"""``import meso_robust`` is fast, offers what it says, and its calls are silent and write nothing."""

from __future__ import annotations

import ast
import inspect
import os
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

import meso_robust as mr
from meso_robust.api.progress import Rated, Told

PLAN = Path(__file__).parents[2] / "reports" / "paper_task" / "plan.json"
HEAVY = {"numpy", "casadi", "sympy", "numba", "scipy", "cv2", "matplotlib", "pydantic", "typer"}


def loaded_by(statement: str) -> set[str]:
    """First names of the modules that a statement loads in an interpreter of its own."""
    code = f"import sys; before = set(sys.modules); {statement}; print(*set(sys.modules) - before)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    return {name.partition(".")[0] for name in done.stdout.split()}


def test_importing_loads_nothing_but_the_package() -> None:
    assert loaded_by("import meso_robust") == {"__future__", "meso_robust"}


@pytest.mark.parametrize(("given", "taken"), [(None, "1"), ("3", "3")])
def test_linear_algebra_of_a_command_has_one_thread_unless_the_user_says_otherwise(
    given: str | None, taken: str
) -> None:
    name = "OPENBLAS_NUM_THREADS"
    environment = {key: value for key, value in os.environ.items() if key != name}
    if given is not None:
        environment[name] = given
    code = (
        "import meso_robust.cli, os, sys; ready = 'numpy' in sys.modules; sys.argv = ['meso-robust', 'plan', '-h']\n"
        f"try: meso_robust.cli.main()\nexcept SystemExit: print(ready, os.environ[{name!r}])"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True, env=environment
    )
    assert (
        done.stdout.splitlines()[-1] == f"False {taken}"
    )  # in time, as it is heard when NumPy is loaded


def test_a_task_is_read_without_the_numerical_libraries() -> None:
    loaded = loaded_by("import meso_robust as mr; mr.Task.paper()")
    assert loaded & HEAVY == {"pydantic"}


def test_a_check_loads_nothing_of_what_it_checks() -> None:
    certificate = PLAN.with_name("certificate.json")
    code = (
        f"import sys, meso_robust as mr; mr.check({str(certificate)!r}, mr.Task.paper()); "
        "print(*sys.modules)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    own = {name.split(".")[1] for name in done.stdout.split() if name.startswith("meso_robust.")}
    assert "checker" in own
    assert not own & {"bounds", "primitives", "planning", "certificates", "job", "simulator"}


def test_every_public_name_is_there_and_no_other() -> None:
    assert set(mr.__all__) <= set(dir(mr))
    for name in mr.__all__:
        assert inspect.getdoc(getattr(mr, name)), name
    with pytest.raises(AttributeError, match="has no attribute 'plam'"):
        mr.plam  # type: ignore[attr-defined]  # noqa: B018


def test_type_checkers_and_python_load_the_same_names() -> None:
    tree = ast.parse(Path(mr.__file__).read_text(encoding="utf-8"))
    typed = {
        alias.name: str(node.module)
        for node in ast.walk(tree)
        if isinstance(node, ast.ImportFrom) and str(node.module).startswith("meso_robust")
        for alias in node.names
    }
    assert set(typed) | {"__version__"} == set(mr.__all__)
    for name, module in typed.items():
        assert getattr(mr, name) is getattr(sys.modules[module], name)


@pytest.mark.parametrize("name", [name for name in mr.__all__ if name[0].islower()])
def test_every_call_documents_its_arguments_and_has_a_doctest(name: str) -> None:
    call = getattr(mr, name)
    words = inspect.getdoc(call) or ""
    for argument in inspect.signature(call).parameters:
        assert argument in words, argument
    assert "Raises" in words
    assert ">>>" in words


class Listening:
    """Progress that keeps what it is told."""

    def __init__(self) -> None:
        self.said: list[str] = []

    @contextmanager
    def doing(self, what: str) -> Iterator[None]:
        self.said.append(what)
        yield

    @contextmanager
    def counting(self, what: str, _: int | None) -> Iterator[Callable[[], object]]:
        self.said.append(what)
        yield lambda: None

    @contextmanager
    def following(self) -> Iterator[Told]:
        yield lambda stage, *_: self.said.append(stage)

    @contextmanager
    def rating(self) -> Iterator[Rated]:
        yield lambda part, *_: self.said.append(part)


def test_a_call_says_nothing_and_writes_nothing_unless_asked(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    mr.simulate(mr.Task.paper(), PLAN, samples=3)
    assert capfd.readouterr() == ("", "")
    assert list(tmp_path.iterdir()) == []

    listening = Listening()
    mr.certify(mr.Task.paper(), PLAN, samples=3, progress=listening)
    assert listening.said == ["certifying", "searching for the margin", "simulating 3 runs"]
    assert capfd.readouterr() == ("", "")
    mr.Reporter().doing("planning").__enter__()
    assert capfd.readouterr().err == "planning ...\n"
