"""``model.toml``: written, read back, and refused where it breaks a rule."""

import tomllib
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from meso_robust.errors import InputError
from meso_robust.identification.answer import document, summary
from meso_robust.identification.document import ModelDocument, read_model
from meso_robust.identification.identify import Identification
from meso_robust.recordings import RecordingSet
from meso_robust.recordings.fingerprint import set_hash
from meso_robust.toml_files import toml_of
from tests.identification.sets import first


@pytest.fixture(scope="module")
def answer(film_set: RecordingSet, film_fit: Identification) -> ModelDocument:
    return document(film_set, film_fit, "0.0.test")


def test_what_is_written_is_read_back(
    answer: ModelDocument, film_fit: Identification, tmp_path: Path
) -> None:
    path = tmp_path / "model.toml"
    path.write_text(toml_of(answer), encoding="utf-8")
    again = read_model(path)
    assert again == answer
    np.testing.assert_allclose(again.values, film_fit.best, rtol=1e-11)
    section = tomllib.loads(toml_of(answer))["parameters"]["rho_um2"]
    assert section["low"] < section["value"] < section["high"]


@pytest.mark.parametrize(
    ("old", "new", "rule"),
    [
        ("[parameters.mu]", "[parameters.nu]", "must be those of model viscous"),
        ("seed = 0", "seed = -1", "provenance.seed = -1"),
        ("confidence = 0.9", "confidence = 0.9\ncolour = 1", "key colour is unknown"),
        ('model = "viscous"', "", "key model is missing"),
        ("open_low = false", "open_low = 0", "parameters.rho_um2.open_low"),
        ("chi2 = ", "chi2 = nan #", "quality.chi2"),
        ('schema = "', 'schema = "x', "schema"),
        ("[part]", "[part", "not a TOML file"),
    ],
)
def test_a_broken_rule_is_named(
    answer: ModelDocument, tmp_path: Path, old: str, new: str, rule: str
) -> None:
    path = tmp_path / "model.toml"
    path.write_text(toml_of(answer).replace(old, new, 1), encoding="utf-8")
    with pytest.raises(InputError, match=r"model\.toml") as caught:
        read_model(path)
    assert rule in str(caught.value)


def test_the_hash_knows_every_value(film_set: RecordingSet) -> None:
    assert set_hash(film_set) == set_hash(film_set)
    assert set_hash(first(film_set, 5)) != set_hash(film_set)
    one = film_set.recordings[0]
    poses = one.poses.copy()
    poses[7, 1] += 1e-12
    other = replace(film_set, recordings=(replace(one, poses=poses), *film_set.recordings[1:]))
    assert set_hash(other) != set_hash(film_set)


def test_the_answer_in_words_has_the_intervals(answer: ModelDocument) -> None:
    said = summary(answer)
    assert "90% intervals by profile likelihood" in said
    assert f"{answer.parameters['mu'].low:.6g}" in said
    assert "force_scale" in said
