"""Results as text and back, the same text for the same result."""

from __future__ import annotations

import hashlib
import json
import re
from collections.abc import Sequence
from dataclasses import asdict

from meso_robust.campaigns.kind import Failure, Part, Result, Values


def canonical(values: object) -> str:
    """The one JSON text of some values: sorted keys, no spaces, every double to its last bit.

    Raises
    ------
    ValueError
        A number is not finite.
    """
    return json.dumps(
        values, sort_keys=True, separators=(",", ":"), ensure_ascii=False, allow_nan=False
    )


def digest(text: str) -> str:
    """SHA-256, hexadecimal."""
    return hashlib.sha256(text.encode()).hexdigest()


def result_text(result: Result) -> str:
    """A result as canonical text."""
    return canonical(asdict(result))


def result_of(text: str) -> Result:
    """A result from its text.

    Raises
    ------
    ValueError, KeyError, TypeError
        The text is no result.
    """
    values = json.loads(text)
    failures = tuple(Failure(**failure) for failure in values.pop("failures"))
    return Result(failures=failures, **values)


def part_text(part: Part) -> str:
    """A part as canonical text: all that its chunks need, wherever they are done."""
    return canonical(asdict(part))


def part_of(text: str) -> Part:
    """A part from its text."""
    return Part(**json.loads(text))


def slug(name: str) -> str:
    """A name as part of a file's path: letters, digits and dashes."""
    return re.sub(r"[^0-9A-Za-z]+", "-", name).strip("-").lower() or "part"


def first_difference(one: Values, other: Values, where: str = "") -> str:
    """The first key, in their order, at which two values of a campaign differ; empty if none does."""
    for key in sorted({*one, *other}):
        a, b = one.get(key), other.get(key)
        if a == b:
            continue
        path = f"{where}{key}"
        if isinstance(a, dict) and isinstance(b, dict):
            return first_difference(a, b, f"{path}.")
        if isinstance(a, list) and isinstance(b, list) and len(a) == len(b):
            return first_difference(_numbered(a), _numbered(b), f"{path}.")
        return path
    return ""


def _numbered(values: Sequence[object]) -> Values:
    return {str(number): value for number, value in enumerate(values)}
