"""``meso-robust --help``: the verbs in the order of use, in groups."""

from __future__ import annotations

from typing import Any

from typer.core import TyperGroup

LONGEST = 400  # characters of a verb's line, wrapped: the first sentence is never cut


class Verbs(TyperGroup):
    """Lists the verbs under the headings that they were registered with."""

    def format_commands(self, ctx: Any, formatter: Any) -> None:
        """Write each heading with its verbs."""
        groups: dict[str, list[tuple[str, str]]] = {}
        for name in self.list_commands(ctx):
            verb: Any = self.get_command(ctx, name)
            heading = verb.rich_help_panel or "Commands"
            groups.setdefault(heading, []).append((name, verb.get_short_help_str(LONGEST)))
        widest = max(len(name) for rows in groups.values() for name, _ in rows)
        for heading, rows in groups.items():
            with formatter.section(heading):
                formatter.write_dl([(name.ljust(widest), words) for name, words in rows])
