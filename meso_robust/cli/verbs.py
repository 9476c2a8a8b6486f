"""The verbs in the order of use, in groups; each is a file of this folder, and a name in the table here."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from importlib import import_module
from typing import Any

import typer
from typer.core import TyperGroup

from meso_robust.cli.running import guarded

VERBS: Mapping[str, tuple[str, ...]] = {
    "To begin with": ("example",),
    "From a task to a certified plan": ("plan", "certify", "check", "simulate", "drive"),
    "From video to an identified model": ("track", "recordings", "identify", "diagnose"),
    "Evidence": ("campaign", "reproduce", "derive"),
    "Formats": ("schema",),
}
"""Names of verbs by the heading in ``--help``; also of their modules and of the functions in these."""


class Verbs(TyperGroup):
    """Imports a verb when it is asked for, and lists all under their headings."""

    def __init__(self, **stated: Any) -> None:
        super().__init__(**stated)
        self.commands: Any = _Commands()

    def list_commands(self, ctx: Any) -> list[str]:
        """The names in the order of the table; not one verb is imported."""
        return list(self.commands)

    def format_commands(self, ctx: Any, formatter: Any) -> None:
        """Write each heading with its verbs."""
        widest = max(map(len, self.commands))
        for heading, names in VERBS.items():
            rows = [
                (name.ljust(widest), (_function(name).__doc__ or "").partition("\n")[0])
                for name in names
            ]
            with formatter.section(heading):
                formatter.write_dl(rows)


def _function(name: str) -> Callable[..., None]:
    function: Callable[..., None] = getattr(import_module(f"{__package__}.{name}"), name)
    return function


class _Commands(Mapping[str, Any]):
    """Commands by name, each made when it is first looked up: no run needs the others."""

    def __init__(self) -> None:
        self._made: dict[str, Any] = {}

    def __getitem__(self, name: str) -> Any:
        if name not in self._made:
            if name not in list(self):
                raise KeyError(name)
            alone = typer.Typer(add_completion=False, rich_markup_mode=None)
            alone.command()(guarded(_function(name)))
            self._made[name] = typer.main.get_command(alone)
        return self._made[name]

    def __iter__(self) -> Iterator[str]:
        return (name for names in VERBS.values() for name in names)

    def __len__(self) -> int:
        return sum(map(len, VERBS.values()))
