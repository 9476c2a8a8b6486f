"""TOML files that users write: read, and checked against a pydantic model, with one message."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any, TypeVar

from pydantic import BaseModel, ValidationError

from meso_robust.errors import InputError
from meso_robust.reading import LARGEST_STATED, first_fault, text_of, toml_values

_Document = TypeVar("_Document", bound=BaseModel)


def read_toml(path: Path, advice: str) -> dict[str, Any]:
    """Values of a TOML file.

    Raises
    ------
    InputError
        The file cannot be read (with the advice), is too large, or is not TOML.
    """
    text = text_of(path, advice, "a TOML file", LARGEST_STATED)
    return toml_values(text, str(path))


def checked(
    document: type[_Document], values: Mapping[str, Any], source: str, *, whole: str, keys: str
) -> _Document:
    """The document that some values make.

    Parameters
    ----------
    document
        Its model.
    values
        As read.
    source
        Names them in messages.
    whole
        What a fault of no single key is a fault of.
    keys
        Where all keys are listed.

    Raises
    ------
    InputError
        A value breaks a rule.
    """
    try:
        # through JSON, because strict checking of a TOML array as a tuple would refuse the list
        return document.model_validate_json(json.dumps(values, allow_nan=True))
    except ValidationError as error:
        fault = first_fault(error, document, whole=whole, keys=keys, index="[{}]")
        raise InputError(f"{source}: {fault}") from error
    except (TypeError, ValueError) as error:
        raise InputError(
            f"{source}: has a date, a time or an endless number ({error}); give plain values"
        ) from error


def toml_text(values: Mapping[str, Any]) -> str:
    """Plain values and sections of them as TOML.

    Raises
    ------
    TypeError
        A section holds a section: no file of ours does.
    """
    plain = {key: value for key, value in values.items() if not isinstance(value, Mapping)}
    lines = [_line(key, value) for key, value in plain.items()]
    for name, section in values.items():
        if isinstance(section, Mapping):
            lines += ["", f"[{name}]", *(_line(key, value) for key, value in section.items())]
    return "\n".join(lines) + "\n"


def _line(key: str, value: object) -> str:
    if isinstance(value, Mapping):
        raise TypeError(f"{key}: a section within a section")
    # a JSON string, number, flag or list of these is the same in TOML
    return f"{key} = {json.dumps(value, ensure_ascii=False, allow_nan=False)}"
