"""The verbs of the loop: what is asked wrongly is refused at once."""

from __future__ import annotations

import pytest
from typer.testing import CliRunner

from meso_robust.cli import app
from meso_robust.tasks import MICROSCOPE


@pytest.mark.parametrize(
    ("given", "said"),
    [
        (["run", str(MICROSCOPE)], "give either a plan.json"),
        (["run", str(MICROSCOPE), "nowhere.json", "--experiment", "also.json"], "give either"),
        (["calibrate", "--lab", "nowhere.toml"], "nowhere.toml"),
    ],
)
def test_what_is_given_wrongly_is_refused(given: list[str], said: str) -> None:
    found = CliRunner().invoke(app, given)
    assert found.exit_code == 2, found.output
    assert said in found.stderr
