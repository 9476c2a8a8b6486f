"""What is the same for every verb: how errors, Ctrl-C and narrow encodings end."""

from __future__ import annotations

import codecs
import functools
import signal
import sys
from collections.abc import Callable
from io import TextIOWrapper
from typing import ParamSpec, TypeVar

import typer

from meso_robust.cli.console import INTERRUPTED, refuse
from meso_robust.errors import InputError

_P = ParamSpec("_P")
_R = TypeVar("_R")
_ESCAPED = "meso-robust-escaped"


UNWRITTEN = "no result was written"


def guarded(verb: Callable[_P, _R], interrupted: str = UNWRITTEN) -> Callable[_P, _R]:
    """The verb; a user's error ends it with exit status 2 and Ctrl-C with 130, both with one line.

    Parameters
    ----------
    verb
        Does the work.
    interrupted
        What is said after Ctrl-C.
    """

    @functools.wraps(verb)
    def run(*args: _P.args, **kwargs: _P.kwargs) -> _R:
        try:
            return verb(*args, **kwargs)
        except InputError as error:
            refuse(error)
        except typer.Exit:
            raise
        except (KeyboardInterrupt, Exception) as error:
            if not is_interruption(error):
                raise
            print(f"meso-robust: interrupted; {interrupted}", file=sys.stderr)
            raise typer.Exit(INTERRUPTED) from None

    return run


def is_interruption(error: BaseException | None) -> bool:
    """Whether Ctrl-C is at the root of an error: compiled code hands it on as an error of its own.

    Parameters
    ----------
    error
        The error.

    Returns
    -------
    bool
        True if it is Ctrl-C, or follows from it.
    """
    while error is not None:
        if isinstance(error, KeyboardInterrupt):
            return True
        error = error.__cause__ or error.__context__
    return False


def end_by_a_signal_as_by_ctrl_c() -> None:
    """Let ``kill`` and a closed terminal end a verb like Ctrl-C, so that no half file stays."""
    for number in (signal.SIGTERM, signal.SIGHUP):
        if signal.getsignal(number) == signal.SIG_DFL:  # not where nohup has it ignored
            signal.signal(number, signal.default_int_handler)


def escape_what_cannot_be_shown() -> None:
    r"""Print µ as ``\u00b5`` where the terminal or pipe takes ASCII only, instead of failing.

    Within a string of JSON this escape means the same letter.
    """
    codecs.register_error(_ESCAPED, _escaped)
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, TextIOWrapper):
            stream.reconfigure(errors=_ESCAPED)


def _escaped(error: UnicodeError) -> tuple[str, int]:
    if not isinstance(error, UnicodeEncodeError):
        raise error
    units = error.object[error.start : error.end].encode("utf-16-be", "surrogatepass")
    pairs = (units[k : k + 2].hex() for k in range(0, len(units), 2))
    return "".join(f"\\u{pair}" for pair in pairs), error.end
