"""The verbs in the order of use, in groups; each is a file of this folder, and a name in the table here."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from importlib import import_module
from typing import Any

import typer
from typer.core import TyperGroup

from meso_robust.cli.running import guarded

VERBS: Mapping[str, tuple[str, ...]] = {
    "Getting started": ("example",),
    "From a task to a certified plan": ("plan", "certify", "check", "simulate", "drive"),
    "At the microscope": ("calibrate", "run"),
    "From video to an identified model": ("track", "recordings", "identify", "diagnose"),
    "Evidence": ("campaign", "reproduce", "derive"),
    "Formats": ("schema",),
}
"""Names of verbs by the heading in ``--help``; also of their modules and of the functions in these."""


class Verbs(TyperGroup):
    """Imports a verb when it is asked for, and lists all under their headings."""

    def __init__(self, **stated: Any) -> None:
        super().__init__(**stated)
        # names alone, which Click searches when one is misspelt
        self.commands: Any = dict.fromkeys(name for names in VERBS.values() for name in names)

    def list_commands(self, ctx: Any) -> list[str]:
        """The names in the order of the table; not one verb is imported."""
        return list(self.commands)

    def get_command(self, ctx: Any, name: str) -> Any:
        """A verb; None if there is none of this name."""
        if name not in self.commands:
            return None
        function: Any = _function(name)
        if hasattr(function, "signature"):  # of a call: made now, since it is asked for
            function.__signature__ = function.signature()
        alone = typer.Typer(add_completion=False, rich_markup_mode=None)
        alone.command()(guarded(function))
        return typer.main.get_command(alone)

    def format_commands(self, ctx: Any, formatter: Any) -> None:
        """Write each heading with its verbs."""
        widest = max(map(len, self.commands))
        for heading, names in VERBS.items():
            with formatter.section(heading):
                formatter.write_dl([(name.ljust(widest), _sentence(name)) for name in names])


def _function(name: str) -> Callable[..., None]:
    function: Callable[..., None] = getattr(import_module(f"{__package__}.{name}"), name)
    return function


def _sentence(name: str) -> str:
    """The first sentence on a verb, without the options, which take long to make."""
    return (_function(name).__doc__ or "").partition("\n")[0]
