"""Files that users give: text, JSON and TOML, read as data within limits of size, depth and value.

A task, a plan or a recording may come from anybody. Nothing in it is run, and a file that is too large
or nested too deeply is refused before it can fill the memory or the stack.
"""

from __future__ import annotations

import difflib
import errno
import json
import re
import stat
import tomllib
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Annotated, Any

from pydantic import BaseModel, Field, FiniteFloat, ValidationError

from meso_robust.errors import InputError

MIB = 2**20
LARGEST_STATED = 4 * MIB
"""Bytes of a file that someone writes by hand: task, set.toml, model.toml, campaign. A thousand times the
longest that is shipped."""
LARGEST_DATA = 64 * MIB
"""Bytes of a file that a program writes: plan, policy, certificate, witness, table. A hundred times
the policy of the paper's task."""
DEEPEST = 64
"""Lists and sections within each other. No document has ten; far from a thousand, where Python's own
readers of JSON and TOML reach the end of the stack."""
_OTHER_MARKS = {";": "semicolons", "\t": "tabs"}
_DECIMAL_COMMA = re.compile(r"\s*[+-]?\d+,\d+\s*", re.ASCII)
LONGEST_SHOWN = 60
"""Characters of a wrong value in a message, which then stays readable in a line of a terminal or two."""
_ALIKE = (
    0.7  # share of letters in common: two slips in seven letters; a wrong guess is a question only
)


# Numbers of documents that programs write. A limit is far beyond all that is written in earnest; it
# is there since nothing else may look at a number that no proof rests on.
Count = Annotated[int, Field(ge=0, le=10**15)]
Seed = Annotated[int, Field(ge=0, le=10**80)]
PaperStep = Annotated[int, Field(ge=1, le=4)]
"""Of the paper's algorithm."""
MoveNumber = Annotated[int, Field(ge=1, le=1000)]
Um = Annotated[FiniteFloat, Field(ge=-1e7, le=1e7)]
Distance = Annotated[FiniteFloat, Field(ge=0, le=1e7)]
"""um or deg"""
Deg = Annotated[FiniteFloat, Field(ge=-3600, le=3600)]
Percent = Annotated[FiniteFloat, Field(ge=0, le=100)]
Factor = Annotated[FiniteFloat, Field(ge=0, le=10)]
"""Of uncertainties; 0: of a plan that is not proved."""


def bytes_of(path: Path, advice: str, largest: int = LARGEST_DATA) -> bytes:
    """Content of a file.

    Parameters
    ----------
    path
        The file.
    advice
        What to give instead of one that cannot be read.
    largest
        Bytes that it may have.

    Returns
    -------
    bytes
        All of it.

    Raises
    ------
    InputError
        There is no such file, it is a folder or no file at all (a device, a pipe), it cannot be read,
        or it is too large.
    """
    try:
        if not stat.S_ISREG(path.stat().st_mode) and not path.is_dir():
            # of a pipe or a device nobody knows the size, and reading it may never end
            raise OSError(errno.EINVAL, "not a plain file")
        with path.open("rb") as file:
            content = file.read(largest + 1)
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror}); {advice}") from error
    except ValueError as error:  # a name that no file can have
        raise InputError(f"{path}: cannot be read ({error}); {advice}") from error
    if len(content) > largest:
        raise InputError(
            f"{path}: is larger than {largest // MIB} MiB, the limit for such a file; {advice}"
        )
    return content


def text_of(path: Path, advice: str, form: str, largest: int = LARGEST_DATA) -> str:
    """Text of a file in UTF-8, without the mark that some editors begin it with.

    Parameters
    ----------
    path, advice, largest
        As for :func:`bytes_of`.
    form
        What the file should be, such as "a JSON file".

    Returns
    -------
    str
        All of it.

    Raises
    ------
    InputError
        As for :func:`bytes_of`, or the file is not in UTF-8.
    """
    try:
        return bytes_of(path, advice, largest).decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise InputError(f"{path}: is not {form} in UTF-8 ({error}); {advice}") from error


def json_values(text: str, source: str) -> Any:
    """Values of a JSON text; ``source`` names it in messages.

    Parameters
    ----------
    text
        The text.
    source
        Names it in messages.

    Returns
    -------
    Any
        Plain values.

    Raises
    ------
    InputError
        The text is not JSON, gives a key twice in one place, or is nested too deeply.
    """
    try:
        values = json.loads(text, object_pairs_hook=each_once)
        _check_depth(values)
    except (ValueError, RecursionError) as error:
        raise InputError(
            f"{source}: is not a JSON file in UTF-8 ({error}); correct or regenerate it"
        ) from error
    return values


def toml_values(text: str, source: str) -> dict[str, Any]:
    """Values of a TOML text; ``source`` names it in messages.

    Parameters
    ----------
    text
        The text.
    source
        Names it in messages.

    Returns
    -------
    dict
        Tables as nested dictionaries.

    Raises
    ------
    InputError
        The text is not TOML, has a number too long for Python, or is nested too deeply.
    """
    try:
        values = tomllib.loads(text)
        _check_depth(values)
    except (ValueError, RecursionError) as error:
        raise InputError(
            f"{source}: is not a TOML file in UTF-8 ({error}); correct it there"
        ) from error
    return values


def foreign_table(cells: Sequence[str], columns: int) -> str:
    """What to do about a line that looks like a table of another program or country; else empty.

    Parameters
    ----------
    cells
        Of the line, as commas part it.
    columns
        How many there should be.

    Returns
    -------
    str
        Begins with a small letter, to stand after the place.
    """
    apart = next((name for mark, name in _OTHER_MARKS.items() if any(mark in c for c in cells)), "")
    if len(cells) < columns and apart:
        return (
            f"its cells seem to be parted by {apart}: save the table with commas between the cells and "
            "points in the numbers"
        )
    if 2 * len(cells) > 3 * columns or any(map(_DECIMAL_COMMA.fullmatch, cells)):
        return "its numbers seem to have decimal commas: save the table with points in the numbers"
    return ""


def shown(value: object) -> str:
    """A wrong value as a message shows it, cut where it is long.

    Parameters
    ----------
    value
        What was given.

    Returns
    -------
    str
        At most ``LONGEST_SHOWN`` characters and an ellipsis.
    """
    text = repr(value)
    return text if len(text) <= LONGEST_SHOWN else f"{text[:LONGEST_SHOWN]}…"


def like(name: str, names: Iterable[str]) -> str:
    """The question whether the one of ``names`` that ``name`` resembles was meant; empty if none does.

    Parameters
    ----------
    name
        What was given.
    names
        What may be given.

    Returns
    -------
    str
        Ends with a space, to stand before further advice.
    """
    known = sorted(names)
    found = [one for one in known if one.startswith(f"{name}_")]  # its unit was left out
    found = found or difflib.get_close_matches(name, known, n=1, cutoff=_ALIKE)
    return f"did you mean {found[0]!r}? " if found else ""


def first_fault(
    error: ValidationError, model: type[BaseModel], *, whole: str, keys: str, index: str = ".{}"
) -> str:
    """What is wrong with a file first: key, value, rule and advice.

    A misspelt key goes before all else: what is wrong first otherwise is that the right one is missing.

    Parameters
    ----------
    error
        Everything that is wrong.
    model
        What the file was checked against.
    whole
        What a fault of no single key is a fault of.
    keys
        Where all keys are listed.
    index
        How a place in a list is written in a key.

    Returns
    -------
    str
        A line; the file is not named in it.
    """
    faults = error.errors(include_url=False)
    schema = model.model_json_schema()
    for fault in faults:
        if fault["type"] == "extra_forbidden":
            *section, name = fault["loc"]
            steps, known = _walked(schema, section)
            meant = like(str(name), known)
            if meant or fault is faults[0]:
                return f"key {_key([*steps, name], index)} is unknown; {meant}{keys} lists all keys"
    first = faults[0]
    key = _key(_walked(schema, first["loc"])[0], index) or whole
    if first["type"] == "union_tag_not_found":
        tag = first["ctx"]["discriminator"].strip("'")
        wrong = next((name for name in first["input"] if like(name, [tag])), None)
        if wrong is not None:
            return f"key {key}.{wrong} is unknown; {like(wrong, [tag])}{keys} lists all keys"
        return f"key {key}.{tag} is missing; {keys} lists all keys"
    if first["type"] == "union_tag_invalid":
        tag, expected = first["ctx"]["discriminator"].strip("'"), first["ctx"]["expected_tags"]
        value = first["input"][tag]
        advice = like(str(value), expected.replace("'", "").split(", ")) or "correct it; "
        return (
            f"key {key}.{tag} = {shown(value)}: must be one of {expected}; {advice}{keys} lists the "
            "allowed values"
        )
    rule = first["msg"].removeprefix("Value error, ").replace("Input should be", "must be")
    if first["type"] == "missing":
        return f"key {key} is missing; {keys} lists all keys"
    if first["type"] == "value_error":
        return f"key {key}: {rule}"
    return (
        f"key {key} = {shown(first['input'])}: {rule}; correct it; {keys} lists the allowed values"
    )


def _key(steps: Iterable[str | int], index: str) -> str:
    """Key as in ``recording[0].file`` or ``policy.0.side``."""
    text = "".join(index.format(step) if isinstance(step, int) else f".{step}" for step in steps)
    return text.removeprefix(".")


def _walked(
    schema: Mapping[str, Any], place: Iterable[str | int]
) -> tuple[list[str | int], set[str]]:
    """The steps to a place that are keys, not the tag of a form, and the keys that may stand there."""
    steps, forms = [], list(_forms(schema, schema))
    for step in place:
        inner = [form for one in forms for form in _below(one, step, schema)]
        steps += [step] if inner or isinstance(step, int) else []
        forms = inner or forms
    return steps, {key for form in forms for key in form.get("properties", {})}


def _below(form: Mapping[str, Any], step: str | int, schema: Mapping[str, Any]) -> Iterable[Any]:
    """Forms of the value of a key, or of an item of a list."""
    if isinstance(step, int):
        for items in (form.get("items"), *form.get("prefixItems", ())):
            yield from _forms(items or {}, schema)
    elif step in form.get("properties", {}):
        yield from _forms(form["properties"][step], schema)
    elif isinstance(form.get("additionalProperties"), Mapping):
        yield from _forms(form["additionalProperties"], schema)


def _forms(node: Mapping[str, Any], schema: Mapping[str, Any]) -> Iterable[Mapping[str, Any]]:
    """The plain schemas that a schema offers."""
    if "$ref" in node:
        yield from _forms(schema["$defs"][node["$ref"].rsplit("/", 1)[1]], schema)
    elif offered := node.get("anyOf") or node.get("oneOf") or node.get("allOf"):
        for one in offered:
            yield from _forms(one, schema)
    else:
        yield node


def each_once(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    """The section that JSON gives as pairs.

    Parameters
    ----------
    pairs
        Key and value, in the order of the text.

    Returns
    -------
    dict
        The section.

    Raises
    ------
    ValueError
        A key is given twice.
    """
    found = dict(pairs)
    if len(found) < len(pairs):
        names = [name for name, _ in pairs]
        twice = next(name for name in names if names.count(name) > 1)
        raise ValueError(f"key {twice} is given twice; give it once")
    return found


def _check_depth(values: Any) -> None:
    """Refuse values that are nested too deeply, level by level: recursion is what must not happen."""
    level = [values]
    for _ in range(DEEPEST):
        level = [inner for value in level for inner in _within(value)]
        if not level:
            return
    raise ValueError(f"lists or sections are nested more than {DEEPEST} deep")


def _within(value: Any) -> Iterable[Any]:
    """The lists and sections that lie directly in one."""
    inner = value.values() if isinstance(value, dict) else value if isinstance(value, list) else ()
    return (one for one in inner if isinstance(one, dict | list))
