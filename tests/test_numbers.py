"""Every number of a document that is read has limits: nothing absurd is believed as no proof needs it."""

from __future__ import annotations

import copy
import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from pydantic import BaseModel
from typer.testing import CliRunner

from meso_robust.campaigns.mutation.places import at, places
from meso_robust.checker.document import Certificate
from meso_robust.checker.reading import digest, parse_certificate
from meso_robust.checker.verdict import check
from meso_robust.cli import app
from meso_robust.cli.schema import documents
from meso_robust.errors import InputError
from tests.conftest import paper_task

Document = dict[str, Any]
REPORT = Path(__file__).parents[1] / "reports" / "paper_task"
READ = ("task", "plan", "policy", "certificate", "campaign", "witness", "recordings", "model")
"""Documents that are read back; the others are only written."""
MODELS: dict[str, type[BaseModel]] = {
    **{name: model for name, model in documents().items() if name in READ},
    "certificate, as `check` reads it": Certificate,
}
LOW, HIGH = {"minimum", "exclusiveMinimum"}, {"maximum", "exclusiveMaximum"}


def numbers(node: Any, definitions: Document, path: str, seen: set[str]) -> Iterator[Any]:
    """Every number of a schema with its path."""
    if isinstance(node, list):
        for one in node:
            yield from numbers(one, definitions, path, seen)
    if not isinstance(node, dict):
        return
    name = node.get("$ref", "").split("/")[-1]
    if name and name not in seen:
        seen.add(name)
        yield from numbers(definitions[name], definitions, name, seen)
    if node.get("type") in {"number", "integer"} and not {"enum", "const"} & set(node):
        yield path, set(node)
    for key, own in node.get("properties", {}).items():
        yield from numbers(own, definitions, f"{path}.{key}", seen)
    for key in ("items", "additionalProperties", "anyOf", "oneOf", "allOf", "prefixItems"):
        yield from numbers(node.get(key), definitions, path, seen)


@pytest.mark.parametrize("name", MODELS)
def test_every_number_of_a_document_that_is_read_has_limits(name: str) -> None:
    schema = MODELS[name].model_json_schema(by_alias=True)
    found = list(numbers(schema, schema.get("$defs", {}), name, set()))
    assert found
    assert [path for path, keys in found if not (keys & LOW and keys & HIGH)] == []


def shipped() -> Document:
    found: Document = json.loads((REPORT / "certificate.json").read_text(encoding="utf-8"))
    return found


def decimal_places() -> dict[str, tuple[Any, ...]]:
    """A place of each kind of a certificate's decimal numbers; ``side`` is one of three."""
    found = {}
    for where, value in places(shipped()):
        if isinstance(value, int | float) and not isinstance(value, bool) and where[-1] != "side":
            found[".".join(key for key in where if isinstance(key, str))] = where
    return found


@pytest.mark.parametrize("place", decimal_places().values(), ids=decimal_places())
def test_an_absurd_number_is_no_certificate(place: tuple[Any, ...]) -> None:
    document = shipped()
    old = at(document, place)
    for absurd in (10**400, -(10**400)) if isinstance(old, int) else (1e300, -1e300):
        changed = copy.deepcopy(document)
        at(changed, place[:-1])[place[-1]] = absurd
        changed["digest"] = digest(changed)
        with pytest.raises(InputError) as caught:
            parse_certificate(json.dumps(changed), "file", paper_task())
        told = str(caught.value)
        assert f"key {'.'.join(map(str, place))} = " in told
        assert ": must be " in told


@pytest.mark.parametrize(
    ("key", "value", "rule"),
    [
        ("margin.each_alone.friction", 1e300, "less than or equal to 10"),
        ("steps.0.obligations.0.boxes", -1, "greater than or equal to 0"),
        ("simulation.samples", 10**400, "less than or equal to"),
    ],
)
def test_the_message_names_key_value_and_rule(
    key: str, value: Any, rule: str, tmp_path: Path
) -> None:
    changed = shipped()
    where = [int(part) if part.isdigit() else part for part in key.split(".")]
    at(changed, tuple(where[:-1]))[where[-1]] = value
    changed["digest"] = digest(changed)
    file = tmp_path / "certificate.json"
    file.write_text(json.dumps(changed), encoding="utf-8")
    run = CliRunner().invoke(app, ["check", str(file)])
    assert run.exit_code == 2
    assert run.stderr.count("\n") == 1
    for part in (str(file), key, str(value)[:20], rule):
        assert part in run.stderr


@pytest.mark.parametrize(
    ("key", "value"),
    [("completed", 1001), ("in_goal", 1001), ("in_certified_box", 1001)],
)
def test_a_part_that_exceeds_its_whole_is_rejected(key: str, value: int) -> None:
    changed = shipped()
    changed["simulation"][key] = value
    changed["digest"] = digest(changed)
    answer = check(*parse_certificate(json.dumps(changed), "file", paper_task()), paper_task())
    assert answer.refused is not None
    assert answer.refused.name.at == f"simulation.{key}"


@pytest.mark.parametrize(
    ("key", "value"),
    [
        ("moves.0.step", 10**30),
        ("moves.0.expect.theta_deg.0", -1e300),
        ("moves.0.speed_um_s", 1e300),
        ("policy.0.step", 0),
        ("policy.0.dual_x.offset_um", 1e300),
        ("moves.0.travel_um.0", -1e300),
    ],
)
def test_an_absurd_number_is_no_plan(key: str, value: Any, tmp_path: Path) -> None:
    plan = json.loads((REPORT / "plan.json").read_text(encoding="utf-8"))
    where = [int(part) if part.isdigit() else part for part in key.split(".")]
    at(plan, tuple(where[:-1]))[where[-1]] = value
    file = tmp_path / "plan.json"
    file.write_text(json.dumps(plan), encoding="utf-8")
    task = str(Path(__file__).parents[1] / "meso_robust" / "tasks" / "paper.toml")
    run = CliRunner().invoke(app, ["certify", task, str(file), "--out", str(tmp_path / "out")])
    assert run.exit_code == 2
    assert f"key {key} = " in run.stderr
    assert not (tmp_path / "out").exists()
