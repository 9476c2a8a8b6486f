"""A real diagnosis as a call gives it: the files of the command line, and a card."""

from __future__ import annotations

from pathlib import Path
from xml.etree import ElementTree

import pytest
from typer.testing import CliRunner

import meso_robust as mr
from meso_robust.cli import app
from meso_robust.diagnosis.diagnose import Diagnosis
from meso_robust.recordings import write_set


def test_a_diagnosis_by_call_and_by_word(
    late: Diagnosis, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    room = tmp_path / "Prüfung µ"
    write_set(room / "set", late.recordings)
    # what is diagnosed is another test's matter, and takes long
    monkeypatch.setattr("meso_robust.diagnosis.diagnose.diagnose", lambda *_, **__: late)

    found = mr.diagnose(str(room / "set"), quick=True)
    found.save(room / "ours")
    words = ("diagnose", str(room / "set"), "--quick", "--out", str(room / "theirs"))
    done = CliRunner().invoke(app, words)

    assert done.exit_code == (0 if found.explained else 1), done.output
    assert done.stdout == f"{found}\nreport: {room / 'theirs' / 'report.html'}\n"
    names = sorted(path.name for path in (room / "ours").iterdir())
    assert names == ["diagnosis.json", "model.toml", "report.html"]
    for name in names:
        assert (room / "ours" / name).read_bytes() == (room / "theirs" / name).read_bytes(), name
    assert found.effects == ("camera_latency",)
    assert repr(found) == f"<Diagnosed {found.verdict}: camera_latency>"
    card = found._repr_html_()
    assert found.verdict.upper() in " ".join(ElementTree.fromstring(card).itertext())
    with pytest.raises(mr.InputError, match="is the folder of the recordings"):
        found.save(room / "set")
