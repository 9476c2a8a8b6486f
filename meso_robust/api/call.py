"""What all calls share: arguments are checked, and messages name arguments, not options."""

from __future__ import annotations

import functools
import inspect
import math
import re
import types
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from numbers import Integral, Real
from os import PathLike
from typing import (
    Annotated,
    Any,
    ForwardRef,
    Literal,
    ParamSpec,
    TypeVar,
    Union,
    get_args,
    get_origin,
)

from meso_robust.api.options import Option
from meso_robust.errors import ArgumentError, InputError

_P = ParamSpec("_P")
_R = TypeVar("_R")

_WORDS: Mapping[Any, str] = {
    bool: "True or False",
    int: "a whole number",
    float: "a number",
    str: "a text",
    type(None): "None",
}


@dataclass(frozen=True, slots=True, kw_only=True)
class Argument:
    """An argument of a call, as its signature states it.

    Attributes
    ----------
    name
        In the signature.
    kinds
        The types that it may have.
    option
        What else is stated about it.
    default
        Its default; ``inspect.Parameter.empty`` if it must be given.
    positional
        Whether it may be given without its name.
    """

    name: str
    kinds: tuple[Any, ...]
    option: Option
    default: Any
    positional: bool

    @property
    def flag(self) -> str:
        """The option of the command line: ``--most-lost`` of ``most_lost``."""
        return f"--{self.option.flag or self.name.replace('_', '-')}"

    def broken(self, value: Any) -> str:
        """The rule that a value of a right type breaks, and the way out; empty if it breaks none."""
        low, high = self.option.low, self.option.high
        choices = [
            name for kind in self.kinds if get_origin(kind) is Literal for name in get_args(kind)
        ]
        if choices and value is not None and value not in choices:
            return f"must be {' or '.join(choices)}; choose one"
        is_number = isinstance(value, Real)
        if low is None or not is_number:
            return ""
        if low <= value <= (math.inf if high is None else high) and value < math.inf:
            return ""  # asked this way round, so that NaN breaks the rule
        if high is not None and float in self.kinds:
            return f"must be from {low:g} to {high:g}; {self.default:g} is usual"
        if high is not None and value > high:
            return f"must be at most {high:,}; give a smaller number"
        if value < low:
            return f"must be at least {low:g}; give a larger number"
        return "must be finite; give a plain number"


@functools.cache
def arguments(call: Callable[..., object]) -> Mapping[str, Argument]:
    """The arguments of a call by name.

    Parameters
    ----------
    call
        A function, or what :func:`call` made of it, whose signature needs no module that takes long
        to import.

    Returns
    -------
    Mapping[str, Argument]
        In the order of the signature.
    """
    function: Any = inspect.unwrap(call)
    parameters = list(inspect.signature(function).parameters.values())
    texts = {one.name: one.annotation for one in parameters if one.annotation is not one.empty}
    # of a class, since that of the function has also what is returned, which need not be imported yet
    stated = type("Stated", (), {"__annotations__": texts})
    types_ = inspect.get_annotations(stated, globals=function.__globals__, eval_str=True)
    leaves = {one.name: tuple(_leaves(types_.get(one.name, Any))) for one in parameters}
    return {
        one.name: Argument(
            name=one.name,
            kinds=tuple(leaf for leaf in leaves[one.name] if not isinstance(leaf, Option)),
            option=next((leaf for leaf in leaves[one.name] if isinstance(leaf, Option)), Option()),
            default=one.default,
            positional=one.kind is not one.KEYWORD_ONLY,
        )
        for one in parameters
    }


def _leaves(stated: Any) -> Iterator[Any]:
    """The types of a union, and what they are annotated with."""
    if get_origin(stated) in (Annotated, Union, types.UnionType):
        for one in get_args(stated):
            yield from _leaves(one)
    else:
        yield stated


def check_arguments(call: Callable[..., object], values: Mapping[str, object]) -> None:
    """Refuse values that arguments of a call cannot have.

    Parameters
    ----------
    call
        The call.
    values
        What is given, by name of the argument.

    Raises
    ------
    InputError
        A value is of a wrong type, or breaks the rule of its argument.
    """
    stated = arguments(call)
    for name, value in values.items():
        kinds = stated[name].kinds
        if not any(_fits(value, kind) for kind in kinds):
            from meso_robust.reading import shown  # with pydantic, which is slow to import

            raise InputError(
                f"{name} = {shown(value)}: must be {_in_words(kinds)}; help(meso_robust."
                f"{call.__qualname__}) describes it"
            )
        if broken := stated[name].broken(value):
            on_the_command_line = InputError(f"{stated[name].flag} {value}: {broken}")
            raise ArgumentError(f"{name} = {value}: {broken}") from on_the_command_line


def call(function: Callable[_P, _R]) -> Callable[_P, _R]:
    """Check a call's arguments; say what is wrong in the names of its arguments.

    The packages below name the options of the command line only; the command line shows the cause of the
    error, which is in those words.

    Raises
    ------
    InputError
        An argument breaks a rule, or the call raises one.
    """
    signature = inspect.signature(function)

    @functools.wraps(function)
    def checked(*args: _P.args, **kwargs: _P.kwargs) -> _R:
        try:
            bound = signature.bind_partial(*args, **kwargs)
        except TypeError as error:
            raise TypeError(f"{function.__qualname__}() {error}") from None
        check_arguments(function, bound.arguments)
        try:
            return function(*args, **kwargs)
        except InputError as error:
            words = _of_arguments(str(error), arguments(function))
            if isinstance(error, ArgumentError) or words == str(error):
                raise
            raise ArgumentError(words) from error

    return checked


def _of_arguments(message: str, stated: Mapping[str, Argument]) -> str:
    """A message with ``workers=`` for ``--workers``; commands in back quotes stay as they are."""
    names = {one.flag: f"{one.name}=" for one in stated.values()}
    return "`".join(
        part
        if k % 2
        else re.sub(r"--[a-z][a-z-]*[a-z]", lambda flag: names.get(flag[0], flag[0]), part)
        for k, part in enumerate(message.split("`"))
    )


def _fits(value: object, kind: Any) -> bool:
    origin = get_origin(kind)
    if kind in (Any, inspect.Parameter.empty) or origin is tuple:
        return True  # what a tuple holds is checked by those that read it
    if isinstance(kind, ForwardRef):
        # the class may not be imported yet, but then nothing is of it
        package = __name__.partition(".")[0] + "."  # a caller's own class may have the same name
        return any(
            one.__name__ == kind.__forward_arg__ and one.__module__.startswith(package)
            for one in type(value).__mro__
        )
    if origin is Literal:
        return isinstance(value, str)
    if origin is Sequence:
        each = tuple(_leaves(get_args(kind)[0]))
        return isinstance(value, Sequence) and all(
            any(_fits(one, inner) for inner in each) for one in value
        )
    if kind in (int, float):
        wide = Integral if kind is int else Real
        return isinstance(value, wide) and not isinstance(value, bool)
    if getattr(kind, "_is_protocol", False):
        return all(hasattr(value, name) for name in vars(kind) if not name.startswith("_"))
    return isinstance(value, origin or kind)


def _in_words(kinds: Sequence[Any]) -> str:
    """What may be given, as `a number or None`."""
    return " or ".join(dict.fromkeys(_kind_in_words(kind) for kind in kinds))


def _kind_in_words(kind: Any) -> str:
    origin = get_origin(kind)
    if origin is Literal:
        return _WORDS[str]
    if origin is Sequence:
        return f"a sequence of which each is {_in_words(tuple(_leaves(get_args(kind)[0])))}"
    if isinstance(kind, ForwardRef):
        return f"a {kind.__forward_arg__}"
    return "a path" if origin is PathLike else _WORDS.get(kind, f"a {kind.__name__}")
