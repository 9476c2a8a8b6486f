"""Reading a certificate: its form, its digest, and that it is about the task at hand."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from pydantic import BaseModel, ValidationError

from meso_robust.checker.document import Certificate
from meso_robust.checker.schema_one import SCHEMA, CertificateOne, certificate_of
from meso_robust.errors import InputError
from meso_robust.reading import each_once, first_fault, text_of
from meso_robust.task import Task


def read_certificate(path: Path, task: Task) -> tuple[Certificate, str]:
    """Read a certificate that was made for ``task``.

    Parameters
    ----------
    path
        Its JSON file, of schema 1 or 2.
    task
        The task that it must be about.

    Returns
    -------
    tuple[Certificate, str]
        The certificate, and the digest that its values have.

    Raises
    ------
    InputError
        The file cannot be read, is not a certificate, or is one for another task.
    """
    text = text_of(path, "give a certificate", "a JSON file")
    return parse_certificate(text, str(path), task)


def parse_certificate(text: str, source: str, task: Task) -> tuple[Certificate, str]:
    """Read a certificate from a text.

    Parameters
    ----------
    text
        JSON, of schema 1 or 2.
    source
        What messages call it.
    task
        The task that it must be about.

    Returns
    -------
    tuple[Certificate, str]
        The certificate in the form of schema 2, and the digest that the values as given have.

    Raises
    ------
    InputError
        It is not a certificate, or one for another task.
    """
    try:
        values = json.loads(text, object_pairs_hook=each_once, parse_constant=_no_constant)
    except (ValueError, RecursionError) as error:
        raise InputError(
            f"{source}: is not a JSON file in UTF-8 ({error}); give a certificate"
        ) from error
    model = CertificateOne if _is_one(values) else Certificate
    return _accepted(model, lambda: model.model_validate_json(text), source, task), digest(values)


def accepted_certificate(
    values: Mapping[str, Any], source: str, task: Task
) -> tuple[Certificate, str]:
    """Check the form of a certificate that is no file, and that it is about the task.

    Parameters
    ----------
    values
        The JSON object of a certificate.
    source
        Names it in messages.
    task
        What it must be about.

    Returns
    -------
    tuple
        The certificate, and its digest.
    """
    stated = _tuples(values)
    certificate = _accepted(Certificate, lambda: Certificate.model_validate(stated), source, task)
    return certificate, digest(values)


def _accepted(
    model: type[BaseModel],
    validated: Callable[[], Certificate | CertificateOne],
    source: str,
    task: Task,
) -> Certificate:
    """The certificate, if it has its form and is about the task."""
    try:
        found = validated()
        if found.task_hash != task.hash:
            raise InputError(
                f"{source}: key task_hash = {found.task_hash!r}: must be the hash {task.hash!r} of "
                f"the task; the certificate is about another task ({found.task!r}), give that one"
            )
        return certificate_of(found, task) if isinstance(found, CertificateOne) else found
    except ValidationError as error:
        keys = "`meso-robust schema certificate`"
        fault = first_fault(error, model, whole="certificate", keys=keys)
        raise InputError(f"{source}: {fault}; give a certificate") from error


def _tuples(value: Any) -> Any:
    """Lists as tuples, which a document has where JSON has arrays."""
    if isinstance(value, Mapping):
        return {key: _tuples(one) for key, one in value.items()}
    return tuple(map(_tuples, value)) if isinstance(value, list) else value


def _is_one(values: Any) -> bool:
    return isinstance(values, dict) and values.get("schema") == SCHEMA


def digest(values: Mapping[str, Any]) -> str:
    """The digest that a certificate's values have.

    Parameters
    ----------
    values
        Of the JSON object, ``digest`` itself left out of account.

    Returns
    -------
    str
        SHA-256 in hexadecimal of the JSON with sorted keys, without white space, in ASCII: what the
        lines and the order of a file are does not matter.
    """
    rest = {key: value for key, value in values.items() if key != "digest"}
    text = json.dumps(rest, sort_keys=True, separators=(",", ":"))
    return hashlib.sha256(text.encode()).hexdigest()


def _no_constant(name: str) -> float:
    raise ValueError(f"{name} is not a number of JSON")
