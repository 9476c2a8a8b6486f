"""TOML files: read and checked against a pydantic model with one message, and written."""

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

    Parameters
    ----------
    path
        The file.
    advice
        What to give instead of one that cannot be read.

    Returns
    -------
    dict
        Tables as nested dictionaries.

    Raises
    ------
    InputError
        The file cannot be read (with the advice), is too large, or is not TOML.
    """
    text = text_of(path, advice, "a TOML file", LARGEST_STATED)
    return toml_values(text, str(path))


def checked(
    document: type[_Document],
    values: Mapping[str, Any],
    source: str,
    *,
    whole: str,
    keys: str,
    index: str = "[{}]",
) -> _Document:
    """The document that a user's values make.

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
    index
        How a place in a list is written in a key.

    Returns
    -------
    BaseModel
        An instance of the model.

    Raises
    ------
    InputError
        A value breaks a rule.
    """
    try:
        # as JSON, in which an array is what a file has: strict checking of Python's values would
        # refuse its list for a tuple, and tell the user of tuples
        return document.model_validate_json(json.dumps(dict(values), allow_nan=True))
    except ValidationError as error:
        fault = first_fault(error, document, whole=whole, keys=keys, index=index)
        raise InputError(f"{source}: {fault}") from error
    except (TypeError, ValueError) as error:
        raise InputError(
            f"{source}: has a date, a time, NaN or infinity ({error}); give plain values"
        ) from error


def toml_text(values: Mapping[str, Any]) -> str:
    """Values as a TOML file.

    Parameters
    ----------
    values
        Tables as nested mappings.

    Returns
    -------
    str
        The text of the file.
    """
    import tomlkit  # a task is read by runs that write no TOML

    return tomlkit.dumps(values)


def toml_of(document: BaseModel) -> str:
    """A document as a TOML file, without what is None.

    Parameters
    ----------
    document
        The document.

    Returns
    -------
    str
        Keys as the file format names them.
    """
    return toml_text(document.model_dump(mode="json", by_alias=True, exclude_none=True))
