"""A verb made from a call: its options from the call's signature, its ending from the call's result.

The files of this folder say only what a command line has besides: a folder for the results, a default,
an option of its own.
"""

from __future__ import annotations

import inspect
import re
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import Annotated, Any, Literal, get_origin

import typer

from meso_robust.api.call import Argument, arguments, check_arguments
from meso_robust.api.result import Result
from meso_robust.cli.console import NEGATIVE, Reporter, negative, note
from meso_robust.cli.running import UNWRITTEN, guarded
from meso_robust.files import check_folder

_OF_CALLS_ONLY = {"self", "folder", "store", "attendance", "progress"}
"""Arguments that the command line gives by itself."""
_KEYWORD = inspect.Parameter.KEYWORD_ONLY


@dataclass(frozen=True, slots=True, kw_only=True)
class Run:
    """What was asked of a verb.

    Attributes
    ----------
    call
        Does the work.
    given
        Values of all options, by name.
    out
        Folder for the results.
    quiet
        Whether only the answer may be printed.
    say
        Shows what is being done.
    """

    call: Callable[..., Any]
    given: Mapping[str, Any]
    out: Path
    quiet: bool
    say: Reporter

    def of(self, call: Callable[..., object], **instead: Any) -> dict[str, Any]:
        """The given values that are arguments of a call, checked: no work is begun if one is wrong.

        Parameters
        ----------
        call
            The call.
        instead
            Values that are not those of the options of the same name.

        Raises
        ------
        InputError
            A value breaks the rule of its argument.
        """
        values = {name: self.given[name] for name in arguments(call) if name in self.given}
        check_arguments(call, values | instead)
        return values | instead

    def result(self, **instead: Any) -> Any:
        """What the call gives; ``instead`` as for :meth:`of`."""
        return self.call(**self.of(self.call, **instead), progress=self.say)

    def check_folder(self, names: Iterable[str] = (), inputs: Iterable[Path] = ()) -> None:
        """Refuse a folder for the results that cannot be one, before the work is begun.

        Parameters
        ----------
        names
            Files that will be written.
        inputs
            Files that are read, beside those that were given.

        Raises
        ------
        InputError
            It cannot be one, or a file would replace one that is read.
        """
        given = [value if isinstance(value, list) else [value] for value in self.given.values()]
        files = [file for several in given for file in several if isinstance(file, Path)]
        check_folder(self.out, names, [*files, *inputs])

    def saved(self, names: Iterable[str] = (), **instead: Any) -> Any:
        """What the call gives, written into the folder; ``names`` are the files that will be written."""
        self.check_folder(names)
        result = self.result(**instead)
        result.save(self.out, progress=self.say)
        return result


def verb(
    call: Callable[..., Any],
    *more: Callable[..., Any],
    document: str,
    out: str | None = None,
    quiet: str = "the result",
    interrupted: str = UNWRITTEN,
) -> Callable[[Callable[..., Result]], Callable[..., None]]:
    """Make a command of a function that carries out a run of a call.

    Parameters
    ----------
    call
        The call; its arguments are the command's.
    more
        Further calls whose arguments are options.
    document
        What ``--json`` prints.
    out
        The folder for the results unless another is given; None: the verb writes none.
    quiet
        What ``--quiet`` prints.
    interrupted
        What is said after Ctrl-C.

    Returns
    -------
    Callable
        Takes the function and gives the command. The function's first argument is the :class:`Run`;
        the others are options as Typer reads them, beside those of the calls or in their place. Its
        docstring is the command's.
    """

    def made(work: Callable[..., Result]) -> Callable[..., None]:
        def own() -> list[inspect.Parameter]:
            return list(inspect.signature(work, eval_str=True).parameters.values())[1:]

        def signature() -> inspect.Signature:
            options = {one.name: one for one in _options(call, *more)}
            options |= {one.name: one.replace(kind=_KEYWORD) for one in own()}
            for one in _endings(document, out, quiet):
                options.setdefault(one.name, one)
            return inspect.Signature(list(options.values()))

        def command(**given: Any) -> None:
            as_json, silent = given.pop("as_json"), given.pop("quiet")
            run = Run(
                call=call,
                given=given,
                out=given.get("out", Path()),
                quiet=silent,
                say=Reporter(silent or as_json),
            )
            result = work(run, **{one.name: given[one.name] for one in own()})
            end(result, run.out, as_json, silent)

        command.__name__, command.__doc__ = work.__name__, work.__doc__
        command.__annotations__ = {}  # Typer takes the types from the signature
        command.signature = signature  # type: ignore[attr-defined]  # the list of verbs needs none
        return guarded(command, interrupted)

    return made


def end(result: Result, out: Path, as_json: bool, quiet: bool) -> None:
    """Print an answer; end with exit status 1 if it is no."""
    if not quiet:
        for remark in result.notes:
            note(remark)
    if as_json:
        print(result.text(), end="")
    elif not quiet:
        print(result)
        for words, name in result.shown.items():
            print(f"{words}: {out / name}")
    elif result.brief:
        print(result.brief)
    if result.why_not:
        negative(result.why_not)
    if not result.positive:
        raise typer.Exit(NEGATIVE)


def _endings(document: str, out: str | None, quiet: str) -> Iterator[inspect.Parameter]:
    """The options that all verbs have."""
    if out is not None:
        folder = typer.Option(help="Folder for the results.")
        yield _parameter("out", Annotated[Path, folder], Path(out))
    as_json = typer.Option("--json", help=f"Print {document} only.")
    yield _parameter("as_json", Annotated[bool, as_json], False)
    silent = typer.Option("--quiet", help=f"Print only {quiet}.")
    yield _parameter("quiet", Annotated[bool, silent], False)


def _parameter(name: str, annotation: Any, default: Any) -> inspect.Parameter:
    return inspect.Parameter(name, _KEYWORD, annotation=annotation, default=default)


def _options(call: Callable[..., Any], *more: Callable[..., Any]) -> Iterator[inspect.Parameter]:
    """The arguments of calls, as Typer reads them."""
    for one in (call, *more):
        meant = _meanings(inspect.getdoc(one) or "")
        for name, argument in arguments(one).items():
            if name not in _OF_CALLS_ONLY:
                words = argument.option.words or meant.get(
                    name, ""
                )  # `python -OO` has no docstrings
                positional = argument.positional and one is call
                yield _option(argument, words, positional=positional)


def _option(argument: Argument, words: str, *, positional: bool) -> inspect.Parameter:
    limits: dict[str, Any] = {"min": argument.option.low, "max": argument.option.high}
    kind = _kind(argument.kinds)
    if type(None) in argument.kinds:
        kind = kind | None
    if positional:
        info: Any = typer.Argument(help=words)
    elif argument.default is True:  # Typer adds the option that says no
        info = typer.Option(help=words)
    else:
        info = typer.Option(argument.flag, help=words, **limits)
    return _parameter(argument.name, Annotated[kind, info], argument.default)


def _kind(kinds: tuple[Any, ...]) -> Any:
    """The type of an option: whatever can be named is given by its name."""
    origins = [get_origin(kind) for kind in kinds]
    if Literal in origins:  # which of them is told by the call
        return str
    if PathLike in origins:
        several = any(origin not in (None, PathLike) for origin in origins)
        return list[Path] if several else Path
    return kinds[0]


def _meanings(docstring: str) -> dict[str, str]:
    """What a numpydoc docstring says of each argument, in a line without its marks."""
    section = re.search(r"^Parameters\n-+\n(.*?)(?:\n\n\w+\n-+\n|\Z)", docstring, re.DOTALL | re.M)
    entries = re.findall(r"^(\w.*)\n((?:[ ]+.+\n?)+)", section[1] if section else "", re.M)
    return {
        name: " ".join(text.replace("``", "").split())
        for names, text in entries
        for name in names.split(", ")
    }
