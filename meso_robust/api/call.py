"""What all calls share: arguments of the right type, and messages that speak of arguments, not options."""

from __future__ import annotations

import functools
import inspect
import re
import types
from collections.abc import Callable, Mapping, Sequence
from numbers import Integral, Real
from os import PathLike
from typing import Any, Literal, ParamSpec, TypeVar, Union, get_args, get_origin, get_type_hints

from meso_robust.errors import ArgumentError, InputError
from meso_robust.reading import shown

_P = ParamSpec("_P")
_R = TypeVar("_R")

_ARGUMENTS = {"out": "folder", "set": "set_file", "probe": "probes"}
"""Options whose argument has another name."""
_WORDS: Mapping[Any, str] = {
    bool: "True or False",
    int: "a whole number",
    float: "a number",
    str: "a text",
    type(None): "None",
}


def call(function: Callable[_P, _R]) -> Callable[_P, _R]:
    """Check the types of a call's arguments; say what is wrong in the names of its arguments.

    The rooms below know the options of the command line only; the command line tells the cause of the
    error, which has their words.

    Raises
    ------
    InputError
        An argument is of a wrong type, or the call raises one.
    """
    signature = inspect.signature(function)

    @functools.wraps(function)
    def checked(*args: _P.args, **kwargs: _P.kwargs) -> _R:
        try:
            bound = signature.bind_partial(*args, **kwargs)
        except TypeError as error:
            raise TypeError(f"{function.__qualname__}() {error}") from None
        for name, value in bound.arguments.items():
            kind = _kind(signature.parameters[name].annotation, function)
            if not _fits(value, kind):
                raise InputError(
                    f"{name} = {shown(value)}: must be {_in_words(kind)}; help(meso_robust."
                    f"{function.__qualname__}) describes it"
                )
        try:
            return function(*args, **kwargs)
        except InputError as error:
            words = _of_arguments(str(error), set(signature.parameters))
            if words == str(error):
                raise
            raise ArgumentError(words) from error

    return checked


def _of_arguments(message: str, names: set[str]) -> str:
    """A message with ``workers=`` for ``--workers``; commands in back quotes stay as they are."""

    def argument(option: re.Match[str]) -> str:
        name = option[1].replace("-", "_")
        name = _ARGUMENTS.get(name, name)
        return f"{name}=" if name in names else option[0]

    return "`".join(
        part if k % 2 else re.sub(r"--([a-z][a-z-]*[a-z])", argument, part)
        for k, part in enumerate(message.split("`"))
    )


@functools.cache
def _kind(annotation: Any, function: Callable[..., object]) -> Any:
    """The type of an argument; anything where its module imports the names for type checkers only."""
    if annotation is inspect.Parameter.empty:  # `self`
        return Any
    try:
        named = types.SimpleNamespace(__annotations__={"it": annotation})
        return get_type_hints(named, vars(inspect.getmodule(function)))["it"]
    except NameError:
        return Any


def _fits(value: object, kind: Any) -> bool:
    origin = get_origin(kind)
    if kind is Any or origin is tuple:
        return True  # what a tuple holds is checked by those that read it
    if origin in (Union, types.UnionType):
        return any(_fits(value, one) for one in get_args(kind))
    if origin is Literal:
        return isinstance(value, str)  # which of them is told with its own message
    if origin is Sequence:
        return isinstance(value, Sequence) and all(_fits(one, *get_args(kind)) for one in value)
    if kind in (int, float):
        wide = Integral if kind is int else Real
        return isinstance(value, wide) and not isinstance(value, bool)
    if getattr(kind, "_is_protocol", False):
        return all(hasattr(value, name) for name in vars(kind) if not name.startswith("_"))
    return isinstance(value, origin or kind)


def _in_words(kind: Any) -> str:
    """What may be given, as `a number or None`."""
    origin = get_origin(kind)
    if origin in (Union, types.UnionType):
        return " or ".join(dict.fromkeys(_in_words(one) for one in get_args(kind)))
    if origin is Literal:
        return _WORDS[str]
    if origin is Sequence:
        return f"a sequence of which each is {_in_words(get_args(kind)[0])}"
    return "a path" if origin is PathLike else _WORDS.get(kind, f"a {kind.__name__}")
