"""The pages of the guide that are made from the code: ``python -m reports.guide.pages``.

``formats.md`` comes from the models of the documents, the table of symbols in ``glossary.md`` from the
words of the reports.
"""

from __future__ import annotations

import ast
import inspect
import re
import textwrap
from collections.abc import Iterator
from functools import cache
from typing import Any, get_args

from pydantic import BaseModel

from meso_robust.cli.schema import documents
from meso_robust.files import write_all
from meso_robust.guide import GUIDE
from meso_robust.laboratory.simulation_document import SimulationDocument
from meso_robust.reporting.words import QUANTITIES
from meso_robust.tracking.calibration_document import CalibrationDocument
from meso_robust.tracking.track_document import TrackDocument
from reports.guide.columns import (
    CAMPAIGN,
    CHECK,
    COMMANDS,
    COVARIANCE,
    DRIVE,
    RECORDING,
    TRAJECTORIES,
    table,
)

FORMATS, GLOSSARY = GUIDE / "formats.md", GUIDE / "glossary.md"
MARKS = "<!-- symbols: made from the code -->\n", "<!-- end of symbols -->\n"
_FILES = {
    "task": "`task.toml`, written by you",
    "plan": "`plan.json`, written by `plan`",
    "policy": "`policy.json`, written by `plan --policy`",
    "certificate": "`certificate.json`, written by `plan` and `certify`",
    "campaign": "a campaign's TOML file, written by you",
    "witness": "`witness.json` of a campaign's failure, replayed by `simulate --witness`",
    "recordings": "`set.toml` of a recording set, written by `track`",
    "model": "`model.toml`, written by `identify` and `diagnose`",
    "experiment": "`experiment.json`, written by `identify --plan` and `--design`",
    "diagnosis": "`diagnosis.json`, written by `diagnose`",
    "premises": "`premises.json`, written by `plan --model`",
    "lab": "`lab.toml`, written by you, read by `run` and `calibrate`",
    "manipulators": "`calibration.json`, written by `calibrate`, named in `lab.toml`",
    "run": "`run.json`, written by `run`",
    "calibration": "`calibration.toml`, written by `track --grid`, read by `track --calibration`",
    "track": "`track.json`, written by `track`, printed by `track --json`",
    "simulation": "`simulation.json`, written by `simulate`, printed by `simulate --json`",
}
OTHERS: dict[str, type[BaseModel]] = {
    "calibration": CalibrationDocument,
    "track": TrackDocument,
    "simulation": SimulationDocument,
}
"""Models of the documents without a published schema."""
_BESIDE = {"recordings": (RECORDING, COMMANDS, COVARIANCE)}
_ALONE = (DRIVE, TRAJECTORIES, CAMPAIGN, CHECK)
_OTHERS = """# Other files

`meso-robust schema` does not know these: they are answers, and may gain keys.

"""
_HEAD = """# File formats

Made from the models that read and write the files (`python -m reports.guide.pages`). `meso-robust schema NAME` prints
each as JSON Schema, but for the [other files](#other-files) at the end. A key's unit is its ending: `_um`, `_deg`,
`_s`, `_hz`, `_un`, `_um2`; `_m`, `_rad` and `_m2` belong to exact numbers, doubles in hexadecimal. Keys that are not
listed are refused in files that you write. "=" gives the value of a key that may be left out; a named type has a
table of its own below.

"""


def formats() -> str:
    """The text of ``formats.md``."""
    parts = [_HEAD]
    for name, model in documents().items():
        parts.append(_section(name, model, model.model_json_schema(by_alias=True)))
        parts += [table(one) for one in _BESIDE.get(name, ())]
    parts.append(_OTHERS)
    for name, model in OTHERS.items():
        written = model.model_json_schema(by_alias=True, mode="serialization")
        parts.append(_section(name, model, written))
    parts += [table(one).removeprefix("#") for one in _ALONE]
    return "".join(parts).rstrip() + "\n"


def _section(name: str, model: type[BaseModel], schema: dict[str, Any]) -> str:
    """A document with all its tables."""
    parts = [f"## {name}\n\n{_FILES[name]}.\n\n"]
    classes = _classes(model)
    tables = {model.__name__: schema, **schema.get("$defs", {})}
    for title, one in tables.items():
        parts += _table(title, one, classes.get(title), title == model.__name__)
    return "".join(parts)


def symbols() -> str:
    """The table of symbols in ``glossary.md``."""
    rows = [f"| `{name}` | {one.meaning} | {one.unit} |" for name, one in QUANTITIES.items()]
    return "\n".join(["| symbol | meaning | shown in |", "|---|---|---|", *rows, ""])


def with_symbols(page: str) -> str:
    """The glossary with its table of symbols as it should be."""
    before, rest = page.split(MARKS[0])
    return before + MARKS[0] + "\n" + symbols() + "\n" + MARKS[1] + rest.split(MARKS[1])[1]


def _table(
    title: str, schema: dict[str, Any], model: type[BaseModel] | None, whole: bool
) -> Iterator[str]:
    if "enum" in schema:
        yield f"### {title}\n\n{_line(schema.get('description', ''))}\n\n{_type(schema)}\n\n"
    if "properties" not in schema:
        return
    meanings = _meanings(model) if model is not None else {}
    if not whole:
        yield f"### {title}\n\n"
    if schema.get("description"):
        about = _line(schema["description"].split("Attributes\n")[0])
        yield f"{about}\n\n"
    yield "| key | value | meaning |\n|---|---|---|\n"
    for key, value in schema["properties"].items():
        meaning = meanings.get(key, "")
        given = key in schema.get("required", ()) or "const" in value
        optional = "" if given else f" = {_plain(value.get('default'))}"
        yield f"| `{key}` | {_type(value)}{optional} | {_line(meaning)} |\n"
    yield "\n"


def _type(value: dict[str, Any]) -> str:
    """A schema in a few words."""
    if "$ref" in value:
        return str(value["$ref"].rsplit("/", 1)[1])
    if "const" in value:
        return f"`{value['const']}`"
    if "enum" in value:
        return ", ".join(f"`{one}`" for one in value["enum"])
    for many in ("anyOf", "oneOf"):
        if many in value:
            return " or ".join(dict.fromkeys(_type(one) for one in value[many]))
    if value.get("type") == "array":
        return _array(value)
    if value.get("type") == "object":
        inner = value.get("additionalProperties")
        return f"table of {_type(inner)}" if isinstance(inner, dict) else "table"
    return f"{value.get('type', 'any')}{_range(value)}"


def _array(value: dict[str, Any]) -> str:
    if "prefixItems" in value:
        return f"[{', '.join(_type(one) for one in value['prefixItems'])}]"
    return f"list of {_type(value['items'])}" if "items" in value else "list"


def _range(value: dict[str, Any]) -> str:
    words = {"minimum": "≥", "exclusiveMinimum": ">", "maximum": "≤", "exclusiveMaximum": "<"}
    said = [f"{sign} {value[key]:g}" for key, sign in words.items() if key in value]
    return f" {', '.join(said)}" if said else ""


def _plain(value: object) -> str:
    if value is None or value in ("", [], {}):
        return "nothing"
    return str(value).lower() if isinstance(value, bool) else str(value)


def _line(text: str) -> str:
    plain = re.sub(r":\w+:(?=`)", "", text).replace("``", "`")
    return re.sub(r"\s+", " ", plain).strip().replace("|", "\\|")


def _classes(model: type[BaseModel]) -> dict[str, type[BaseModel]]:
    """All models within a model, by name."""
    found: dict[str, type[BaseModel]] = {}
    waiting: list[Any] = [model]
    while waiting:
        one = waiting.pop()
        if isinstance(one, type) and issubclass(one, BaseModel) and one.__name__ not in found:
            found[one.__name__] = one
            waiting += [field.annotation for field in one.model_fields.values()]
        waiting += get_args(one)
    return found


@cache
def _meanings(model: type[BaseModel]) -> dict[str, str]:
    """Docstrings of a model's attributes, by key as in the file; those of its bases too."""
    found: dict[str, str] = {}
    for base in reversed(model.__mro__):
        if base in (BaseModel, object) or not issubclass(base, BaseModel):
            continue
        (tree,) = ast.parse(textwrap.dedent(_source(base))).body
        assert isinstance(tree, ast.ClassDef)
        for field, after in zip(tree.body, tree.body[1:], strict=False):
            if isinstance(field, ast.AnnAssign) and isinstance(field.target, ast.Name):
                found |= _told(model, field.target.id, after)
    return found


def _source(model: type[BaseModel]) -> str:
    try:
        return inspect.getsource(model)
    except (OSError, TypeError):  # made while running: it has no text
        return "class Made: ...\n"


def _told(model: type[BaseModel], name: str, after: ast.stmt) -> dict[str, str]:
    if not (isinstance(after, ast.Expr) and isinstance(after.value, ast.Constant)):
        return {}
    field = model.model_fields.get(name)
    key = (field and (field.alias or field.serialization_alias)) or name
    return {key: str(after.value.value)}


def main() -> None:
    """Write the pages."""
    glossary = with_symbols(GLOSSARY.read_text(encoding="utf-8"))
    write_all(GUIDE, {FORMATS.name: formats(), GLOSSARY.name: glossary})


if __name__ == "__main__":
    main()
