"""``derive --check`` compares what is kept with the sources; the page is built where it is wanted."""

from __future__ import annotations

from pathlib import Path

import pytest
from typer.testing import CliRunner

from derivations import generate, report
from meso_robust.cli import app

KEPT = ("README.md", "register.json", "index.html")


@pytest.fixture
def checkout(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A checkout with the three files, all as they are derived."""
    files = {tmp_path / name: f"{name} as derived" for name in KEPT}
    for path, text in files.items():
        path.write_text(text, encoding="utf-8")
    (tmp_path / "pyproject.toml").touch()
    monkeypatch.setattr(generate, "ROOT", tmp_path)
    monkeypatch.setattr(generate, "on_disk", lambda: {path for path in files if path.exists()})
    monkeypatch.setattr(report, "PAGE", tmp_path / "index.html")
    monkeypatch.setattr(generate, "derive_all", tuple)
    monkeypatch.setattr(generate, "code", lambda _: {})
    monkeypatch.setattr(report, "render", lambda _: files)
    return tmp_path


def test_a_checkout_without_the_page_is_as_derived(checkout: Path) -> None:
    assert CliRunner().invoke(app, ["derive", "--check", "--quiet"]).exit_code == 0
    (checkout / "index.html").unlink()
    done = CliRunner().invoke(app, ["derive", "--check", "--quiet"])
    assert done.exit_code == 0, done.output
    assert not (checkout / "index.html").exists()  # a check writes nothing
    assert CliRunner().invoke(app, ["derive", "--quiet"]).exit_code == 0
    assert (checkout / "index.html").read_text(encoding="utf-8") == "index.html as derived"


@pytest.mark.parametrize("name", KEPT)
def test_a_file_that_is_there_must_be_as_derived(name: str, checkout: Path) -> None:
    (checkout / name).write_text("of another time", encoding="utf-8")
    done = CliRunner().invoke(app, ["derive", "--check", "--quiet"])
    assert done.exit_code == 1
    assert f"differs from what is derived: {name};" in done.output


@pytest.mark.parametrize("name", KEPT[:2])
def test_a_file_that_is_kept_must_be_there(name: str, checkout: Path) -> None:
    (checkout / name).unlink()
    done = CliRunner().invoke(app, ["derive", "--check", "--quiet"])
    assert done.exit_code == 1
    assert name in done.output
