"""A document as TOML."""

from __future__ import annotations

import json
from typing import Any

from pydantic import BaseModel


def toml_of(document: BaseModel) -> str:
    """The document as TOML, without what is None."""
    values = document.model_dump(mode="json", by_alias=True, exclude_none=True)
    plain = {key: value for key, value in values.items() if not _is_table(value)}
    lines = [f"{key} = {_literal(value)}" for key, value in plain.items()]
    for key, value in values.items():
        if key not in plain:
            lines += _tables([key], value)
    return "\n".join(lines) + "\n"


def _is_table(value: Any) -> bool:
    return isinstance(value, dict) or (
        isinstance(value, list) and bool(value) and isinstance(value[0], dict)
    )


def _tables(path: list[str], value: Any) -> list[str]:
    """A table, or an array of tables, with what is nested in it."""
    name = ".".join(_bare(part) for part in path)
    if isinstance(value, list):
        return [line for one in value for line in (f"\n[[{name}]]", *_body(path, one))]
    plain = any(not _is_table(inner) for inner in value.values()) or not value
    return [*([f"\n[{name}]"] if plain else []), *_body(path, value)]


def _body(path: list[str], value: dict[str, Any]) -> list[str]:
    own = [f"{_bare(k)} = {_literal(v)}" for k, v in value.items() if not _is_table(v)]
    nested = [_tables([*path, k], v) for k, v in value.items() if _is_table(v)]
    return own + [line for lines in nested for line in lines]


def _bare(key: str) -> str:
    simple = key.replace("_", "").replace("-", "")
    return key if simple.isascii() and simple.isalnum() else json.dumps(key)


def _literal(value: Any) -> str:
    if isinstance(value, str):
        return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
    if isinstance(value, list):
        return "[" + ", ".join(_literal(one) for one in value) + "]"
    return json.dumps(value)
